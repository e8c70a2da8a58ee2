//! What numbers a scene may hold: beyond these limits poses and speeds drown in rounding.

/// Places, sizes, speeds and turns: m, m/s or rad/s. A place of 10⁶ m is resolved to 10⁻¹⁰ m.
const MOST: f64 = 1e6;

/// A number as people write it.
pub(super) fn shown(x: f64) -> String {
    let plain = x == 0.0 || (1e-6..1e9).contains(&x.abs()) || !x.is_finite();
    if plain { x.to_string() } else { format!("{x:e}") }
}

/// # Errors
/// Names the first of some values that is not finite or beyond the limit.
pub(super) fn within(name: &str, unit: &str, values: &[f64]) -> Result<(), String> {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match values.iter().find(|x| !(-MOST..=MOST).contains(*x)) {
        Some(x) if !x.is_finite() => Err(format!("{name}: {x} is not a finite number")),
        Some(x) => Err(format!("{name} is {}{unit}; it must be from -{MOST} to {MOST}{unit}", shown(*x))),
        None => Ok(()),
    }
}

/// What a YAML reader says, in words for people who write scenes.
pub(in crate::cli) fn plain(said: &str) -> String {
    let words = [
        ("error: line ", "line "),
        (", set DuplicateKeyPolicy in Options if acceptable", ""),
        (" rejected by the configured policy", ": write a finite number"),
        (
            "; use from_str_multiple or from_str_multiple_with_options",
            "; a scene file holds one: leave out what begins with ---",
        ),
        ("invalid u32", "must be a whole number, 0 or greater"),
        ("invalid floating point", "must be a number"),
        ("expected string scalar", "must be one value, not a list"),
        ("cannot deserialize null into string; use Option<String>", "must be a word"),
        ("invalid type: null, expected f64", "must be a number"),
        ("invalid boolean", "must be true or false"),
        ("expected mapping start", "expected `key: value` pairs, as in {key: value}"),
    ];
    words.iter().fold(said.to_string(), |text, (from, to)| text.replace(from, to))
}
