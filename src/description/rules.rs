//! What may stand in our tags: one row per attribute, and the reading of a tag by its rows.

use super::element::{Domain, Element};
use super::finding::Finding;
use super::report::Report;
use super::suggest;

/// What an attribute holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// One number.
    Number(Domain),
    /// So many numbers, each in the domain.
    Vector(usize, Domain),
    /// Any count of numbers.
    Numbers,
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// Any text that is not blank.
    Text,
}

/// One attribute of a tag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attribute {
    pub name: &'static str,
    pub kind: Kind,
    pub required: bool,
}

impl Attribute {
    pub const fn required(name: &'static str, kind: Kind) -> Self {
        Self { name, kind, required: true }
    }
    pub const fn optional(name: &'static str, kind: Kind) -> Self {
        Self { name, kind, required: false }
    }
}

/// One tag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tag {
    pub name: &'static str,
    pub attributes: &'static [Attribute],
    /// Elements that may stand inside.
    pub children: &'static [&'static str],
}

enum Value<'a> {
    Numbers(Vec<f64>),
    Flag(bool),
    Word(&'a str),
}

/// The values of a tag that passed their checks.
pub(super) struct Values<'a>(Vec<(&'static str, Value<'a>)>);

impl<'a> Values<'a> {
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name).and_then(|n| n.first().copied())
    }

    pub fn number_or(&self, name: &str, default: f64) -> f64 {
        self.number(name).unwrap_or(default)
    }

    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        self.find(name).and_then(|value| if let Value::Numbers(n) = value { Some(n.as_slice()) } else { None })
    }

    pub fn flag_or(&self, name: &str, default: bool) -> bool {
        self.find(name).map_or(default, |value| if let Value::Flag(flag) = value { *flag } else { default })
    }

    pub fn word(&self, name: &str) -> Option<&'a str> {
        self.find(name).and_then(|value| if let Value::Word(word) = value { Some(*word) } else { None })
    }

    /// Have all attributes that the rule requires been given, and given right?
    pub fn complete(&self, tag: &Tag) -> bool {
        tag.attributes.iter().filter(|a| a.required).all(|a| self.find(a.name).is_some())
    }

    fn find(&self, name: &str) -> Option<&Value<'a>> {
        self.0.iter().find(|(n, _)| *n == name).map(|(_, value)| value)
    }
}

impl Tag {
    /// Reads and checks all attributes of `element`; unknown attributes and children are reported.
    pub fn read<'a>(&self, element: &Element<'a>, report: &mut Report) -> Values<'a> {
        self.refuse_unknown_children(element, report);
        self.read_attributes(element, report)
    }

    /// The same for an element whose children are read elsewhere.
    pub fn read_attributes<'a>(&self, element: &Element<'a>, report: &mut Report) -> Values<'a> {
        self.refuse_unknown_attributes(element, report);
        let value = |a: &Attribute, report: &mut Report| a.read(element, report).map(|value| (a.name, value));
        Values(self.attributes.iter().filter_map(|a| value(a, report)).collect())
    }

    fn refuse_unknown_attributes(&self, element: &Element, report: &mut Report) {
        let known = self.attributes.iter().map(|a| a.name);
        for attribute in element.node.attributes() {
            let name = attribute.name();
            if attribute.namespace().is_none() && known.clone().any(|k| k == name) {
                continue;
            }
            let mut place = element.place(report);
            place.at = report.position(attribute.range_qname());
            let message = format!("<{}> has no attribute `{name}`", self.name);
            let mend = suggest::mend(name, known.clone(), "known attributes");
            report.add(Finding::error("unknown-attribute", place, message, mend));
        }
    }

    fn refuse_unknown_children(&self, element: &Element, report: &mut Report) {
        for child in element.children() {
            let known = child.is_plain() && self.children.contains(&child.tag());
            if !known {
                let message = format!("<{}> does not belong into <{}>", child.tag(), self.name);
                let mend = suggest::mend(child.tag(), self.children.iter().copied(), "known elements");
                report.add(Finding::error("unknown-element", child.place(report), message, mend));
            }
        }
    }
}

impl Attribute {
    fn read<'a>(&self, element: &Element<'a>, report: &mut Report) -> Option<Value<'a>> {
        if self.required {
            element.required(self.name, report)?;
        }
        let text = element.value(self.name)?.trim();
        match self.kind {
            Kind::Number(domain) => element.numbers(self.name, 1, domain, report).map(Value::Numbers),
            Kind::Vector(count, domain) => element.numbers(self.name, count, domain, report).map(Value::Numbers),
            Kind::Numbers => element.any_numbers(self.name, report).map(Value::Numbers),
            Kind::Text => Some(Value::Word(text)),
            Kind::Flag => self.word(&["true", "false"], text, element, report).map(|word| Value::Flag(word == "true")),
            Kind::Word(words) => self.word(words, text, element, report).map(Value::Word),
        }
    }

    fn word<'a>(
        &self,
        words: &[&'static str],
        text: &'a str,
        element: &Element,
        report: &mut Report,
    ) -> Option<&'a str> {
        if words.contains(&text) {
            return Some(text);
        }
        let message = format!("{} = '{text}' is not known", self.name);
        let mend = suggest::mend(text, words.iter().copied(), "known values");
        report.add(Finding::error("unknown-value", element.place_of(self.name, report), message, mend));
        None
    }
}
