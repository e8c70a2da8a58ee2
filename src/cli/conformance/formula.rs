//! Small arithmetic in case files: `9 - g * t^2 / 2`.

use exmex::{Express, FlatEx, FloatOpsFactory, MatchLiteral};
use serde_json::Value;
use std::collections::BTreeMap;

/// Numbers as Rust writes them: exmex alone does not know 1e-6.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Literal;

impl MatchLiteral for Literal {
    fn is_literal(text: &str) -> Option<&str> {
        let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
        let is = |at: usize, those: &[u8]| text.as_bytes().get(at).is_some_and(|b| those.contains(b));
        let whole = digits(0);
        let point = usize::from(is(whole, b"."));
        let mantissa = whole + point + if point > 0 { digits(whole + point) } else { 0 };
        if mantissa == point {
            return None;
        }
        let sign = mantissa + 1 + usize::from(is(mantissa + 1, b"+-"));
        let exponent = if is(mantissa, b"eE") && sign <= text.len() { digits(sign) } else { 0 };
        Some(&text[..if exponent > 0 { sign + exponent } else { mantissa }])
    }
}

type Expression = FlatEx<f64, FloatOpsFactory<f64>, Literal>;

/// Values by name.
#[derive(Clone, Debug, Default)]
pub(super) struct Names(BTreeMap<String, f64>);

impl Names {
    /// Gives a name a value.
    pub fn set(&mut self, name: &str, value: f64) {
        self.0.insert(name.into(), value);
    }

    /// Is it one of them?
    pub fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }
}

/// A formula whose names are all known.
#[derive(Clone, Debug)]
pub(super) struct Formula {
    text: String,
    expression: Expression,
}

impl Formula {
    /// Reads a number or a formula in these names.
    ///
    /// # Errors
    /// Says what of the text makes no sense.
    pub fn read(value: &Value, names: &Names) -> Result<Self, String> {
        let text = match value {
            Value::Number(n) => n.to_string(),
            Value::String(s) => s.trim().to_owned(),
            other => return Err(format!("{other}: must be a number or a formula")),
        };
        // The reader of formulas is for ASCII.
        if let Some(c) = text.chars().find(|c| !(c.is_ascii_graphic() || *c == ' ')) {
            return Err(format!("'{text}': '{c}' is no part of a formula"));
        }
        let expression = Expression::parse(&text).map_err(|said| format!("'{text}' is no formula: {said}"))?;
        if let Some(name) = expression.var_names().iter().find(|name| !names.has(name)) {
            let known: Vec<&str> = names.0.keys().map(String::as_str).collect();
            return Err(format!("'{text}': there is no '{name}'; the names are {}", known.join(", ")));
        }
        Ok(Self { text, expression })
    }

    /// Its value; not a number where it has none.
    pub fn value(&self, names: &Names) -> f64 {
        let value = |name: &String| names.0.get(name).copied().unwrap_or(f64::NAN);
        let values: Vec<f64> = self.expression.var_names().iter().map(value).collect();
        self.expression.eval(&values).unwrap_or(f64::NAN)
    }

    /// As it is written.
    pub fn text(&self) -> &str {
        &self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, String> {
        let mut names = Names::default();
        names.set("t", 3.0);
        Formula::read(&Value::String(text.into()), &names).map(|f| f.value(&names))
    }

    #[test]
    fn formulas_are_those_of_a_pocket_calculator() {
        for (text, should) in [
            ("1e-6", 1e-6),
            ("2 * 1.5E+3 - .5", 2999.5),
            ("9 - t^2 / 2", 4.5),
            ("1-1e-3", 0.999),
            ("sqrt(t + 1) * exp(0)", 2.0),
            ("max(2*3, t+1)", 6.0),
            ("(t)^-1 * 3", 1.0),
            ("cos(PI)", -1.0),
        ] {
            assert_eq!(value(text), Ok(should), "{text}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "1..2", "(", "t t", "x + 1", "1 +", "2e", "„t“"] {
            assert!(value(text).is_err(), "{text}");
        }
        assert!(value("v * t").unwrap_err().contains("there is no 'v'; the names are t"));
    }
}
