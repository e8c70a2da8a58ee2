//! The price list for people, as Markdown, and for programs.

use super::measure::Error;
use super::{Prices, Row};
use crate::cli::inspect::effect;
use crate::model::Kind;
use serde_json::{Value, json};

/// Two numbers nearer than this are the same in a comparison of positions, rad or m.
const SAME: f64 = 1e-12;

struct Cells {
    name: String,
    by: String,
    instructions: String,
    ns: String,
    error: String,
}

fn cells(p: &Prices, row: &Row) -> Cells {
    let l = &row.listed;
    let none = || "-".to_owned();
    let (by, error) = match l.effect.kind {
        Kind::Switched if l.is_switched_off() => (format!("switched off; {}", l.by), none()),
        Kind::Derived(why) if l.called_for => (l.by.clone(), format!("no switch: {why}")),
        _ => (l.by.clone(), row.error.as_ref().map_or_else(none, said)),
    };
    let instructions = match (row.instructions, &p.uncounted) {
        (Some(n), _) => grouped(n),
        (None, Some(_)) if l.effect.kind == Kind::Switched => "?".into(),
        _ => none(),
    };
    let ns = row.time.map_or_else(none, |t| format!("{:.0} ({:.0} … {:.0})", t.median, t.quartiles[0], t.quartiles[1]));
    Cells { name: l.effect.name.to_owned(), by, instructions, ns, error }
}

fn said(e: &Error) -> String {
    let number = |x: f64| if x < SAME { "0".into() } else { format!("{x:.2e}") };
    match e {
        Error::Lost(why) => why.clone(),
        Error::Apart { axis, base } => {
            let of_axis = axis.as_ref().map(|a| match a.by < SAME {
                true => "0".to_owned(),
                false => format!("{} {} ({})", number(a.by), a.unit, a.name),
            });
            let of_base =
                base.as_ref().map(|(way, angle, link)| format!("{link}: {} m, {} rad", number(*way), number(*angle)));
            let both: Vec<String> = of_axis.into_iter().chain(of_base).collect();
            both.join("; ")
        }
    }
}

/// 12 345.
fn grouped(n: f64) -> String {
    let digits = format!("{:.0}", n.abs());
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    if n < 0.0 && digits != "0" { format!("−{text}") } else { text }
}

/// Rows of effects that belong to steps.
fn rows(p: &Prices) -> impl Iterator<Item = &Row> {
    p.rows.iter().filter(|r| !matches!(r.listed.effect.kind, Kind::OnDemand(_)))
}

fn title(p: &Prices) -> String {
    let counted = match (p.instructions, &p.uncounted) {
        (Some(n), _) => format!("{} instructions", grouped(n)),
        (None, Some(why)) => format!("instructions not counted ({why})"),
        _ => String::new(),
    };
    format!("a step with all of it: {counted}, {:.0} ns; {} steps, errors after {} s", p.ns, p.steps, p.seconds)
}

pub(super) fn table(p: &Prices) -> String {
    let mut text = format!("{}: {}\n\n", p.scene, title(p));
    text +=
        &format!("{:<21} {:>12} {:>22}  {}\n", "effect", "instructions", "ns (quartiles)", "error when switched off");
    for row in rows(p) {
        let c = cells(p, row);
        text += &format!("{:<21} {:>12} {:>22}  {}\n", c.name, c.instructions, c.ns, c.error);
        text += &format!("{:<21} called for by {}\n", "", c.by);
    }
    text
}

pub(super) fn markdown(p: &Prices) -> String {
    let mut text = format!("{}: {}.\n\n", p.scene, title(p));
    text += "| effect | called for by | instructions per step | ns per step (quartiles) | error when switched off |\n|---|---|---:|---:|---|\n";
    for row in rows(p) {
        let c = cells(p, row);
        let by = c.by.replace('|', "\\|").replace('<', "\\<");
        text += &format!("| `{}` | {by} | {} | {} | {} |\n", c.name, c.instructions, c.ns, c.error);
    }
    text
}

pub(super) fn json(p: &Prices) -> String {
    let error = |e: &Error| match e {
        Error::Lost(why) => json!({"lost": why}),
        Error::Apart { axis, base } => json!({
            "axis": axis.as_ref().map(|a| json!({"name": a.name, "by": a.by, "unit": a.unit})),
            "base": base.as_ref().map(|(way, angle, link)| json!({"link": link, "m": way, "rad": angle})),
        }),
    };
    let row = |r: &Row| {
        let mut all = effect(&r.listed);
        all["instructions_per_step"] = json!(r.instructions);
        all["ns_per_step"] = json!(r.time.map(|t| t.median));
        all["ns_quartiles"] = json!(r.time.map(|t| t.quartiles));
        all["error_when_off"] = r.error.as_ref().map_or(Value::Null, error);
        all
    };
    let all = json!({"scene": p.scene, "steps": p.steps, "seconds": p.seconds, "instructions_per_step": p.instructions,
                     "ns_per_step": p.ns, "uncounted": p.uncounted, "effects": p.rows.iter().map(row).collect::<Vec<_>>()});
    format!("{all:#}\n")
}

#[cfg(test)]
mod tests {
    #[test]
    fn digits_are_grouped() {
        let shown = [0.0, -0.2, 12.0, 999.6, 12_345.0, -1_234_567.0].map(super::grouped);
        assert_eq!(shown, ["0", "0", "12", "1 000", "12 345", "−1 234 567"]);
    }
}
