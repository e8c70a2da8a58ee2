//! One XML element with the name by which findings call it, and the reading of its attributes.

use super::finding::{Finding, Place};
use super::report::Report;
use roxmltree::Node;

/// An element of the text.
#[derive(Clone, Debug)]
pub(super) struct Element<'a> {
    pub node: Node<'a, 'a>,
    /// `joint 'left_knee'`: the nearest named element around it.
    owner: String,
    /// `joint 'left_knee' <limit>`.
    pub label: String,
}

/// What a number may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Domain {
    Any,
    Positive,
    NonNegative,
    Unit,
    /// From 0.
    UpTo(f64),
    AtLeast(f64),
    OneOf(&'static [f64]),
    /// A whole number between these two.
    Whole(u32, u32),
    /// A whole number of either sign, with at most two digits.
    Exponent,
}

impl Domain {
    fn holds(self, x: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Positive => x > 0.0,
            Self::NonNegative => x >= 0.0,
            Self::Unit => (0.0..=1.0).contains(&x),
            Self::UpTo(most) => (0.0..=most).contains(&x),
            Self::AtLeast(least) => x >= least,
            Self::OneOf(list) => list.contains(&x),
            Self::Whole(least, most) => x.fract() == 0.0 && (f64::from(least)..=f64::from(most)).contains(&x),
            Self::Exponent => x.fract() == 0.0 && x.abs() < 100.0,
        }
    }

    /// In words, for messages and documents.
    pub fn words(self) -> String {
        match self {
            Self::Any => "a finite number".into(),
            Self::Positive => "greater than 0".into(),
            Self::NonNegative => "0 or greater".into(),
            Self::Unit => "from 0 to 1".into(),
            Self::UpTo(most) => format!("from 0 to {most}"),
            Self::AtLeast(least) => format!("at least {least}"),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Exponent => "a whole number with at most two digits".into(),
            Self::OneOf(list) => {
                format!("one of {}", list.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

impl<'a> Element<'a> {
    /// The root element.
    pub fn root(node: Node<'a, 'a>) -> Self {
        let owner = node.tag_name().name().to_string();
        Self { node, label: owner.clone(), owner }
    }

    /// Tag name without prefix.
    pub fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Does it belong to URDF (or to us), that is, not to a foreign namespace?
    pub fn is_plain(&self) -> bool {
        let root = self.node.document().root_element().tag_name();
        self.node.tag_name().namespace() == root.namespace()
    }

    /// All child elements, also foreign ones.
    pub fn children(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        let owner = self.owner.clone();
        self.node.children().filter(Node::is_element).map(move |node| Self::child(node, &owner))
    }

    fn child(node: Node<'a, 'a>, parent_owner: &str) -> Self {
        let tag = node.tag_name().name();
        match node.attribute("name").filter(|_| NAMED.contains(&tag)) {
            Some(name) => {
                let owner = format!("{tag} '{name}'");
                Self { node, label: owner.clone(), owner }
            }
            None => Self { node, label: format!("{parent_owner} <{tag}>"), owner: parent_owner.to_string() },
        }
    }

    /// The plain children of that name.
    pub fn all(&self, tag: &'static str) -> impl Iterator<Item = Element<'a>> + use<'a> {
        self.children().filter(move |e| e.is_plain() && e.tag() == tag)
    }

    /// The first plain child of that name; warns about further ones.
    pub fn first(&self, tag: &'static str, report: &mut Report) -> Option<Element<'a>> {
        let mut found = self.all(tag);
        let first = found.next()?;
        for further in found {
            let line = first.place(report).at.line;
            let message = format!("a second <{tag}>; the first one (line {line}) counts");
            report.add(Finding::warning("duplicate-element", further.place(report), message, "keep one of them"));
        }
        Some(first)
    }

    /// The start of the element: the tag, with its name attribute where it has one.
    pub fn place(&self, report: &Report) -> Place {
        let range = self.node.range();
        let text = self.node.document().input_text();
        let tag_length = text[range.clone()].find([' ', '\t', '\r', '\n', '>', '/']).unwrap_or(range.len());
        let tag_end = range.start + tag_length;
        let named = self.node.attribute_node("name").filter(|_| NAMED.contains(&self.tag()));
        let end = named.map(|a| a.range().end).filter(|&end| !text[range.start..end].contains('\n'));
        Place { element: self.label.clone(), at: report.position(range.start..end.unwrap_or(tag_end)) }
    }

    /// The value of an attribute, or the start of the element if it has none of that name.
    pub fn place_of(&self, attribute: &str, report: &Report) -> Place {
        match self.node.attribute_node(attribute) {
            Some(a) => Place { element: self.label.clone(), at: report.position(a.range_value()) },
            None => self.place(report),
        }
    }

    /// The text of an attribute.
    pub fn value(&self, attribute: &str) -> Option<&'a str> {
        self.node.attribute(attribute)
    }

    /// The text of an attribute that must be there and not blank.
    pub fn required(&self, attribute: &str, report: &mut Report) -> Option<&'a str> {
        match self.value(attribute) {
            Some(value) if !value.trim().is_empty() => Some(value),
            Some(_) => {
                let message = format!("attribute `{attribute}` is empty");
                report.add(Finding::error("empty-value", self.place_of(attribute, report), message, "give a value"));
                None
            }
            None => {
                let message = format!("attribute `{attribute}` is missing");
                let mend = format!("write <{} {attribute}=\"…\" …>", self.tag());
                report.add(Finding::error("missing-attribute", self.place(report), message, mend));
                None
            }
        }
    }

    /// One number of the attribute; `None` if it is not there, or wrong (then it is reported).
    pub fn number(&self, attribute: &str, domain: Domain, report: &mut Report) -> Option<f64> {
        self.vector::<1>(attribute, domain, report).map(|[x]| x)
    }

    /// `N` numbers separated by blanks; `None` if it is not there, or wrong (then it is reported).
    pub fn vector<const N: usize>(&self, attribute: &str, domain: Domain, report: &mut Report) -> Option<[f64; N]> {
        self.numbers(attribute, N, domain, report)?.try_into().ok()
    }

    /// `count` numbers separated by blanks; `None` if it is not there, or wrong (then it is reported).
    pub fn numbers(&self, attribute: &str, count: usize, domain: Domain, report: &mut Report) -> Option<Vec<f64>> {
        let value = self.value(attribute)?;
        let wrong = match parse_numbers(value).and_then(|numbers| of_length(numbers, count)) {
            Ok(numbers) => match numbers.iter().find(|x| !domain.holds(**x)) {
                None => return Some(numbers),
                Some(x) => Wrong {
                    code: "out-of-range",
                    message: format!("{attribute} = {x} is out of range"),
                    mend: format!("it must be {}", domain.words()),
                },
            },
            Err(wrong) => Wrong { message: format!("{attribute}: {}", wrong.message), ..wrong },
        };
        self.report_wrong(attribute, wrong, report);
        None
    }

    /// Any count of finite numbers separated by blanks; `None` if it is not there, or wrong (then it is reported).
    pub fn any_numbers(&self, attribute: &str, report: &mut Report) -> Option<Vec<f64>> {
        let wrong = match parse_numbers(self.value(attribute)?) {
            Ok(numbers) => return Some(numbers),
            Err(wrong) => Wrong { message: format!("{attribute}: {}", wrong.message), ..wrong },
        };
        self.report_wrong(attribute, wrong, report);
        None
    }

    fn report_wrong(&self, attribute: &str, wrong: Wrong, report: &mut Report) {
        report.add(Finding::error(wrong.code, self.place_of(attribute, report), wrong.message, wrong.mend));
    }
}

/// Elements whose `name` is their identity.
const NAMED: [&str; 6] = ["link", "joint", "robot", "joint_group", "separate_rig", "material"];

struct Wrong {
    code: &'static str,
    message: String,
    mend: String,
}

fn parse_numbers(value: &str) -> Result<Vec<f64>, Wrong> {
    let wrong = |code, message, mend: &str| Err(Wrong { code, message, mend: mend.into() });
    if value.contains("${") || value.contains("$(") {
        return wrong("xacro-not-expanded", format!("'{value}' is an xacro expression"), super::RUN_XACRO);
    }
    let mut numbers = vec![];
    for word in value.split_whitespace() {
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() => numbers.push(x),
            Ok(_) => return wrong("not-finite", format!("'{word}' is not a finite number"), "give the real value"),
            Err(_) if word.contains(',') => {
                let mend = "numbers take a decimal point and are separated by blanks: \"0.5 0 1\"";
                return wrong("bad-number", format!("'{word}' is not a number"), mend);
            }
            Err(_) => {
                return wrong("bad-number", format!("'{word}' is not a number"), "write a decimal number in SI units");
            }
        }
    }
    Ok(numbers)
}

fn of_length(numbers: Vec<f64>, count: usize) -> Result<Vec<f64>, Wrong> {
    if numbers.len() == count {
        return Ok(numbers);
    }
    let plural = if count == 1 { "number is" } else { "numbers are" };
    let message = format!("{count} {plural} needed here, there are {}", numbers.len());
    let mend = if count == 1 { "give one number" } else { "separate them by blanks: \"0 0 1\"" };
    Err(Wrong { code: "wrong-length", message, mend: mend.into() })
}
