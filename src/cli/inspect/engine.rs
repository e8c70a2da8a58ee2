//! What an engine makes of a model, and what it does not honour of it.

use crate::engine::{EngineKind, by_kind, shape_name, shortfalls};
use crate::model::Model;
use serde_json::{Value, json};

/// Each kind of item with the first element that has it; shapes that have another name there.
pub(super) fn table(kind: EngineKind, m: &Model) -> String {
    let name = kind.name();
    let found = by_kind(shortfalls(kind, m).into_iter(), |s| s);
    let mut text = match found.is_empty() {
        true => format!("\nthe engine {name} honours all of it\n"),
        false => format!("\nthe engine {name} does not honour\n"),
    };
    for (shortfall, others) in found {
        let more = if others > 0 { format!(" (and of {others} more)") } else { String::new() };
        text += &format!("  {shortfall}{more}\n");
    }
    let mut shapes: Vec<(String, usize)> = vec![];
    for c in &m.colliders {
        let Some(theirs) = shape_name(kind, &c.form) else { continue };
        let row = format!("{} -> {theirs}", c.form.name());
        match shapes.iter_mut().find(|(known, _)| *known == row) {
            Some((_, count)) => *count += 1,
            None => shapes.push((row, 1)),
        }
    }
    let told: Vec<String> = shapes.into_iter().map(|(row, count)| format!("{row} ({count})")).collect();
    text + &if told.is_empty() { String::new() } else { format!("shapes in {name}: {}\n", told.join(", ")) }
}

/// Each item of each element.
pub(super) fn json(kind: EngineKind, m: &Model) -> Value {
    let item = |s: crate::engine::Shortfall| json!({"element": s.element, "item": s.item, "instead": s.instead});
    let shape = |c: &crate::model::Collider| {
        shape_name(kind, &c.form).map(|theirs| json!({"name": c.name, "form": c.form.name(), "shape": theirs}))
    };
    json!({"name": kind.name(), "not_honoured": shortfalls(kind, m).into_iter().map(item).collect::<Vec<_>>(),
           "shapes": m.colliders.iter().filter_map(shape).collect::<Vec<_>>()})
}
