//! The comparison as text.

use super::contender::{Contender, Course};
use super::difference::{MEASURES, exists, name_of};
use super::{Contest, FINER, notes};
use crate::engine::{Shortfall, by_kind};
use std::fmt::Write;

/// Everything, for people.
pub(super) fn tables(c: &Contest) -> String {
    let mut text = head(c);
    for (measure, about) in MEASURES.iter().enumerate() {
        if exists(&c.model, &c.links, measure) {
            let beyond = format!("beyond {} at", c.within);
            let title = format!("{}, {}", about.name, about.unit);
            let _ = writeln!(
                text,
                "\n{title:<28} {:>10} {:>10}  {:<20} {:>9}  {beyond}",
                "at the end", "greatest", "of", "at, s"
            );
            c.others.iter().for_each(|run| text += &course_row(c, run, measure));
        }
    }
    text += &balance(c);
    c.engines().iter().for_each(|run| text += &about_engine(c, run));
    if !c.warnings.is_empty() {
        text += "\nwarnings\n";
        text.extend(c.warnings.iter().map(|w| format!("  {w}\n")));
    }
    text
}

fn head(c: &Contest) -> String {
    let (r, s) = (&c.reference, &c.settings);
    let stats = r.world.stats();
    let mut text = format!(
        "{}: {} s{}, control interval {} s, {} steps in each\n",
        c.model.name,
        seconds(c.time()),
        if c.stopped { " (stopped by a signal)" } else { "" },
        s.control_interval_ns as f64 * 1e-9,
        s.steps_per_interval
    );
    let _ = writeln!(
        text,
        "reference: rbx, {}, steps of {:.4e} s, {FINER} times finer; {} of {} steps were made by implicit_midpoint",
        r.world.settings().integrator.name(),
        r.step(),
        stats.fallback_steps,
        stats.steps
    );
    text + "reference/2 has steps twice as long: a difference no greater than its own says nothing about an engine\n"
}

fn course_row(c: &Contest, run: &Contender, measure: usize) -> String {
    let Course { last, greatest, greatest_at, beyond } = run.record.measures[measure];
    let of = |index| name_of(&c.model, measure, index);
    let beyond = beyond.map_or("-".into(), |(at, w)| format!("{} s, {}", seconds(at), of(w.index)));
    let (element, at) = match greatest.value == 0.0 {
        true => ("-", "-".into()),
        false => (of(greatest.index), seconds(greatest_at).to_string()),
    };
    let (name, last, greatest) = (&run.name, figure(last.value), figure(greatest.value));
    format!("  {name:<26} {last:>10} {greatest:>10}  {element:<20} {at:>9}  {beyond}\n")
}

/// Whole nanoseconds, as the clock of a world counts them.
fn seconds(t: f64) -> f64 {
    (t * 1e9).round() / 1e9
}

fn figure(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.3e}") }
}

/// Energy, momentum and the rest.
fn balance(c: &Contest) -> String {
    let mut text = format!(
        "\n{:<28} {:>10} {:>12} {:>14} {:>13} {:>10} {:>9}\n",
        "", "energy", "momentum", "angular mom.", "penetration", "drift", "CPU"
    );
    let _ = writeln!(
        text,
        "{:<28} {:>10} {:>12} {:>14} {:>13} {:>10} {:>9}",
        "greatest since the start", "diff., J", "diff., N·s", "diff., N·m·s", "m", "m", "s per s"
    );
    for (i, run) in c.all().enumerate() {
        let if_any = |shown: bool, x: f64| if shown { figure(x) } else { "-".into() };
        let (other, r) = (i > 0, &run.record);
        let _ = writeln!(
            text,
            "  {:<26} {:>10} {:>12} {:>14} {:>13} {:>10} {:>9}",
            run.name,
            if_any(other, r.energy),
            if_any(other && c.floats, r.momentum),
            if_any(other && c.floats, r.angular),
            figure(run.snapshot.stats.worst_penetration),
            figure(run.world.joint_drift()),
            c.cpu(run).map_or("-".into(), |x| format!("{x:.4}"))
        );
    }
    if !c.floats {
        text += "nothing floats freely: there is no momentum to compare\n";
    }
    text
}

/// Why an engine parts from the reference, as far as it is known.
fn about_engine(c: &Contest, run: &Contender) -> String {
    let mut lines: Vec<String> =
        grouped(&c.shortfalls(run)).into_iter().map(|s| format!("not honoured: {s}")).collect();
    lines.extend(notes(&run.world));
    let stop = run.world.stats().worst_stop_violation;
    if stop > c.reference.world.stats().worst_stop_violation + c.within {
        lines.push(format!("an axis was outside its range by {stop:.3e} rad or m, further than in the reference"));
    }
    if !run.finite {
        lines.push("a value is not finite".into());
    }
    let told: String = lines.iter().map(|line| format!("  {line}\n")).collect();
    if told.is_empty() { told } else { format!("\n{}\n{told}", run.name) }
}

/// Items of the same kind together: the first one, and how many others there are.
fn grouped(shortfalls: &[Shortfall]) -> Vec<String> {
    let told = |(s, others): (&Shortfall, usize)| match others {
        0 => s.to_string(),
        n => {
            let element = format!("{} and {n} other{}", s.element, if n == 1 { "" } else { "s" });
            Shortfall { element, ..s.clone() }.to_string()
        }
    };
    by_kind(shortfalls.iter(), |s| s).into_iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortfalls_of_one_kind_share_a_line() {
        let s =
            |element: &str, item: &str| Shortfall { element: element.into(), item: item.into(), instead: "so".into() };
        let lines = grouped(&[s("joint 'a'", "x"), s("joint 'b'", "x"), s("joint 'c'", "x"), s("link 'd'", "y")]);
        assert_eq!(lines, ["x of joint 'a' and 2 others: so", "y of link 'd': so"]);
    }
}
