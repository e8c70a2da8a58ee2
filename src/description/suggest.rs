//! "Did you mean": the known name nearest to an unknown one.

/// Edits (insert, delete, change, swap) up to which two names are taken for the same word misspelt.
const NEAR: usize = 2;

/// The nearest of `known`, if it is near enough to be a misspelling.
pub(super) fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let name = name.to_lowercase();
    let near = |k: &str| NEAR.min(k.len() / 3);
    let scored = known.into_iter().map(|k| (strsim::damerau_levenshtein(&name, &k.to_lowercase()), k));
    scored.filter(|(distance, k)| *distance <= near(k)).min_by_key(|(distance, _)| *distance).map(|(_, k)| k)
}

/// A mend that names the nearest known name, or all of them if they are few.
pub(super) fn mend<'k>(name: &str, known: impl IntoIterator<Item = &'k str> + Clone, what: &str) -> String {
    let list = known.clone().into_iter().collect::<Vec<_>>().join(", ");
    match nearest(name, known) {
        Some(near) => format!("did you mean `{near}`? {what}: {list}"),
        None if list.is_empty() => format!("take it out, there is no {what} here"),
        None => format!("{what}: {list}"),
    }
}
