//! An entry of `vary`: which value, and what it takes.

use super::draw::Draw;
use serde::{Deserialize, Serialize};
use serde_json::{Number, Value};

/// Values of a range at most.
const MOST_STEPS: usize = 1_000_000;
/// Whole numbers up to here are exact.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// One entry. Just one of `values`, `from` with `to`, `uniform`, `log_uniform` and `normal` is given.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Vary {
    /// The path of the value: `scene.…` or `run.…`.
    pub at: String,
    /// Name of the column; the path, if none is given.
    pub name: Option<String>,
    /// A list, of numbers, words or whatever stands there.
    pub values: Option<Vec<Value>>,
    /// A range with both ends.
    pub from: Option<f64>,
    /// Its end.
    pub to: Option<f64>,
    /// How many values, ends included.
    pub steps: Option<usize>,
    /// linear or log.
    #[serde(default)]
    pub scale: Scale,
    /// Drawn evenly between two ends.
    pub uniform: Option<[f64; 2]>,
    /// Drawn so that its logarithm is even.
    pub log_uniform: Option<[f64; 2]>,
    /// Mean and standard deviation.
    pub normal: Option<[f64; 2]>,
}

/// Of a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

impl Vary {
    /// Of its column.
    pub fn name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.at)
    }

    /// # Errors
    /// What makes no sense.
    pub fn check(&self) -> Result<(), String> {
        let given = [
            self.values.is_some(),
            self.from.is_some() || self.to.is_some(),
            self.uniform.is_some(),
            self.log_uniform.is_some(),
            self.normal.is_some(),
        ];
        if given.iter().filter(|g| **g).count() != 1 {
            return Err("give just one of: values, from with to, uniform, log_uniform, normal".into());
        }
        if !(self.at.starts_with("scene.") || self.at.starts_with("run.")) {
            return Err("the path must begin with scene. or run.".into());
        }
        if self.values.as_ref().is_some_and(Vec::is_empty) {
            return Err("values is an empty list: there would be no world".into());
        }
        match (self.from, self.to, self.steps) {
            (Some(from), Some(to), Some(steps)) => self.check_range(from, to, steps)?,
            (None, None, None) if self.scale == Scale::Linear => {}
            (None, None, None) => return Err("scale is for a range: from, to, steps; see log_uniform".into()),
            _ => return Err("a range needs from, to and steps".into()),
        }
        for (name, [a, b]) in
            [("uniform", self.uniform), ("log_uniform", self.log_uniform)].into_iter().filter_map(known)
        {
            if !(a.is_finite() && b.is_finite() && a <= b) || (name == "log_uniform" && a <= 0.0) {
                return Err(format!(
                    "{name}: [{a}, {b}]: must be two finite numbers in rising order, above 0 for log_uniform"
                ));
            }
        }
        match self.normal {
            Some([m, s]) if !(m.is_finite() && s.is_finite() && s >= 0.0) => {
                Err(format!("normal: [{m}, {s}]: must be a mean and a standard deviation of 0 or more"))
            }
            _ => Ok(()),
        }
    }

    fn check_range(&self, from: f64, to: f64, steps: usize) -> Result<(), String> {
        if !(from.is_finite() && to.is_finite()) {
            return Err(format!("from {from} to {to}: must be finite"));
        }
        if steps == 0 || steps > MOST_STEPS {
            return Err(format!("steps is {steps}; it must be from 1 to {MOST_STEPS}"));
        }
        if self.scale == Scale::Log && (from <= 0.0 || to <= 0.0) {
            return Err(format!("from {from} to {to}: a logarithmic scale needs both ends above 0"));
        }
        Ok(())
    }

    /// The values of a list or a range; none if they are drawn.
    pub fn list(&self) -> Option<Vec<Value>> {
        if let Some(values) = &self.values {
            return Some(values.clone());
        }
        let (from, to, steps) = (self.from?, self.to?, self.steps?);
        let last = steps.saturating_sub(1).max(1);
        // The ends are just the numbers that were given.
        let value = |k: usize| match k {
            0 => number(from),
            k if k == last => number(to),
            k => number(self.between(from, to, k as f64 / last as f64)),
        };
        Some((0..steps).map(value).collect())
    }

    fn between(&self, from: f64, to: f64, share: f64) -> f64 {
        match self.scale {
            Scale::Linear => from + (to - from) * share,
            Scale::Log => libm::exp(libm::log(from) + (libm::log(to) - libm::log(from)) * share),
        }
    }

    /// One value; of a range, anything in it.
    pub fn draw(&self, draw: &mut Draw) -> Value {
        if let Some(values) = &self.values {
            let k = (draw.unit() * values.len() as f64) as usize;
            return values[k.min(values.len() - 1)].clone();
        }
        if let (Some(from), Some(to)) = (self.from, self.to) {
            return number(self.between(from, to, draw.unit()));
        }
        let spread = |[a, b]: [f64; 2], share: f64| a + (b - a) * share;
        number(match (self.uniform, self.log_uniform, self.normal) {
            (Some(ends), ..) => spread(ends, draw.unit()),
            (_, Some(ends), _) => libm::exp(spread(ends.map(libm::log), draw.unit())),
            (.., Some([mean, deviation])) => mean + deviation * draw.normal(),
            _ => 0.0,
        })
    }
}

fn known<T>((name, value): (&str, Option<T>)) -> Option<(&str, T)> {
    value.map(|v| (name, v))
}

/// Whole numbers without a point, so that they can stand where whole numbers must.
fn number(x: f64) -> Value {
    match x {
        x if x.fract() == 0.0 && x.abs() < EXACT => Value::from(x as i64),
        x => Number::from_f64(x).map_or(Value::Null, Value::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn vary(value: Value) -> Vary {
        serde_json::from_value(value).unwrap()
    }

    #[test]
    fn ranges_have_both_ends_and_equal_steps() {
        let linear = vary(json!({"at": "run.x", "from": 0.0, "to": 1.0, "steps": 5}));
        assert_eq!(linear.list(), Some(vec![json!(0), json!(0.25), json!(0.5), json!(0.75), json!(1)]));
        let log = vary(json!({"at": "run.x", "from": 0.5, "to": 50.5, "steps": 3, "scale": "log"})).list().unwrap();
        assert_eq!((&log[0], &log[2]), (&json!(0.5), &json!(50.5)));
        assert!((log[1].as_f64().unwrap() - (0.5_f64 * 50.5).sqrt()).abs() < 1e-12);
        assert_eq!(vary(json!({"at": "run.x", "from": 3.0, "to": 9.0, "steps": 1})).list(), Some(vec![json!(3)]));
    }

    #[test]
    fn draws_stay_where_they_must() {
        let log = vary(json!({"at": "run.x", "log_uniform": [0.01, 10.0]}));
        let list = vary(json!({"at": "run.x", "values": ["a", "b"]}));
        let mut seen = std::collections::BTreeSet::new();
        for i in 0..200 {
            let x = log.draw(&mut Draw::of(1, i, "x")).as_f64().unwrap();
            assert!((0.01..=10.0).contains(&x));
            seen.insert(list.draw(&mut Draw::of(1, i, "x")).to_string());
        }
        assert_eq!(seen.len(), 2);
    }

    #[test]
    fn nonsense_is_refused_with_the_reason() {
        let cases = [
            (json!({"at": "run.x"}), "just one of"),
            (json!({"at": "run.x", "values": [1], "uniform": [0.0, 1.0]}), "just one of"),
            (json!({"at": "gravity", "values": [1]}), "must begin with scene. or run."),
            (json!({"at": "run.x", "values": []}), "empty list"),
            (json!({"at": "run.x", "from": 1.0, "to": 2.0}), "needs from, to and steps"),
            (json!({"at": "run.x", "from": 0.0, "to": 2.0, "steps": 3, "scale": "log"}), "above 0"),
            (json!({"at": "run.x", "uniform": [2.0, 1.0]}), "rising order"),
            (json!({"at": "run.x", "normal": [2.0, -1.0]}), "standard deviation"),
        ];
        for (value, reason) in cases {
            let told = vary(value.clone()).check().unwrap_err();
            assert!(told.contains(reason), "{value}: {told}");
        }
    }
}
