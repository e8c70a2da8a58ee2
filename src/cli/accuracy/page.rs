//! docs/accuracy.md, made of the figures.

use super::advice::{LEVELS, advice, cheapest, plain};
use super::measure::{Curve, Measured, Run};
use super::report::{at, figure, milliseconds};
use super::rung::Ladder;
use std::fmt::Write;

/// Folder of the diagrams, beside the page.
pub const IMAGES: &str = "images/accuracy";
/// Step at which the tables of the page look, s; else the middle of the ladder.
const SHOWN: f64 = 0.001;
/// The same of a ladder of accuracies.
const SHOWN_ACCURACY: f64 = 1e-9;

const HEAD: &str = "# What accuracy costs

Made by `COMMAND`; do not edit. ORIGIN

Each case is a scene whose outcome is known: by a closed form, or by a run of our own with far finer steps. A *rung* is an engine with an integrator; its ladder is the step
(at a control interval of 8 ms: W-5 is the ladder), of `extrapolation` its accuracy from 1e-3 to 1e-12 at a control interval of 40 ms, of 10 ms where commands come or the solver iterates. Errors are taken every 40 ms; *greatest* is the worst of them. CPU time is that of the thread in steps and commands, the fastest of
several runs; absolute times hold for this machine only, ratios travel better. In the diagrams cheap and accurate is below on the left; each curve goes upwards with finer steps.

- **order**: slope of the error over the step, by least squares over the longest stretch of at least three points in which it is steady (the slopes between neighbours within 0.3), with errors below
  a tenth of the motion, above rounding and above ten times what the reference itself errs by. Which points: the steps in parentheses. A dash: there is no such stretch.
- **diverges**: the finest step with which a value is not finite, or the error is as large as the motion itself.
- **fell back**: share of the steps that rk4 and extrapolation left to the implicit midpoint rule, as a whole or in part, because something touched, stood still or was stiff.
- The advice below each diagram follows from the figures by one rule: the cheapest run whose greatest error is within the level. [accuracy.csv](accuracy.csv) has all figures.
";

/// Where the figures come from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Command line that makes the page.
    pub command: String,
    /// Machine, date and commit.
    pub about: String,
}

/// The page.
pub fn page(all: &[Measured], origin: &Origin) -> String {
    let mut text = HEAD.replace("COMMAND", &origin.command).replace("ORIGIN", &origin.about);
    text += "\n## All cases\n\nThe cheapest run of each rung that comes within a level; a rung without a mark does not come there.\n\n";
    let _ = writeln!(text, "![CPU time of each rung to come within a level]({IMAGES}/summary.svg)\n");
    let levels: Vec<String> = LEVELS.iter().map(|l| format!("within {}", plain(*l))).collect();
    let _ = writeln!(text, "| case | unit | {} |\n|---|---|{}", levels.join(" | "), "---|".repeat(LEVELS.len()));
    for m in all {
        let cell = |level: &f64| match cheapest(m.curves.iter().filter(|c| !c.peer), *level) {
            Some((c, r)) => format!("{}, {}: {}", c.label, at(c, r), figure(r.cpu)),
            None => "-".into(),
        };
        let cells: Vec<String> = LEVELS.iter().map(cell).collect();
        let _ = writeln!(text, "| [{0}](#{0}) | {1} | {2} |", m.case.name, m.case.unit, cells.join(" | "));
    }
    text += "\nCells: rung, step, CPU s per simulated s; of our engines.\n";
    all.iter().for_each(|m| text += &of_case(m));
    text
}

fn of_case(m: &Measured) -> String {
    let c = &m.case;
    let mut text =
        format!("\n## {}\n\n{}\nCompared: {} ({}), {} s.\n", c.name, c.shows, c.compared, c.unit, c.duration());
    let own = if m.reference.own > 0.0 {
        format!("; by a run with half as many steps it errs by {} {} (RMS)", figure(m.reference.own), c.unit)
    } else {
        String::new()
    };
    let _ = writeln!(text, "Reference: {}{own}.\n", m.reference.words);
    let _ = writeln!(text, "![{0}: CPU time against error]({IMAGES}/{0}.svg)\n", c.name);
    let _ = writeln!(text, "{}\n", advice(m));
    let _ = writeln!(
        text,
        "| rung | order | at | RMS | greatest | CPU s per s | diverges | notes |\n|---|---|---|---|---|---|---|---|"
    );
    m.curves.iter().filter(|c| c.ladder != Ladder::Iterations).for_each(|curve| text += &row(m, curve));
    let iterated: Vec<&Curve> = m.curves.iter().filter(|c| c.ladder == Ladder::Iterations).collect();
    if !iterated.is_empty() {
        text += &iterations(&iterated);
    }
    if let Some(differs) = c.peer_differs.filter(|_| m.curves.iter().any(|c| c.peer)) {
        let _ = writeln!(text, "\nMuJoCo: {differs}.");
    }
    text.extend(m.left_out.iter().map(|reason| format!("\nLeft out: {reason}.\n")));
    text
}

fn row(m: &Measured, c: &Curve) -> String {
    let Some(r) = shown(c) else { return String::new() };
    let order = c.fit(m.case.size, m.reference.own).map_or("-".into(), |f| {
        format!("{:.2} ({} … {})", f.order, milliseconds(f.steps[0]), milliseconds(f.steps[1]))
    });
    let diverges = c.diverges().map_or("-".into(), |h| format!("≥ {}", milliseconds(h)));
    format!(
        "| {} | {order} | {} | {} | {} | {} | {diverges} | {} |\n",
        c.label,
        at(c, r),
        figure(r.rms),
        figure(r.max),
        figure(r.cpu),
        notes(r)
    )
}

/// The run at 1 ms, or that in the middle of the ladder.
pub(super) fn shown(c: &Curve) -> Option<&Run> {
    let near = |r: &&Run| match c.ladder {
        Ladder::Accuracy => r.point.accuracy == SHOWN_ACCURACY,
        _ => (r.point.step() / SHOWN - 1.0).abs() < 1e-6,
    };
    c.runs.iter().find(near).or(c.runs.get(c.runs.len() / 2))
}

fn notes(r: &Run) -> String {
    let s = &r.stats;
    let mut notes = vec![];
    if s.fallback_steps > 0 {
        let share = 100.0 * s.fallback_steps as f64 / s.steps.max(1) as f64;
        let told = if share < 1.0 { format!("{} times", s.fallback_steps) } else { format!("in {share:.0} %") };
        notes.push(format!("fell back {told}"));
    }
    if s.halvings > 0 {
        notes.push(format!("{} halvings", s.halvings));
    }
    if s.guarded_pieces > 0 {
        notes.push(format!("{} guarded", s.guarded_pieces));
    }
    if s.worst_penetration > 0.0 {
        notes.push(format!("penetration {} m", figure(s.worst_penetration)));
    }
    notes.join(", ")
}

/// Greatest errors over the iterations of the solver.
fn iterations(curves: &[&Curve]) -> String {
    let counts: Vec<String> = curves[0].runs.iter().map(|r| r.point.iterations.to_string()).collect();
    let mut text = format!(
        "\nGreatest error and, in parentheses, CPU s per s over the iterations of the solver (W-6; of rapier, substeps), at 1 ms:\n\n| | {} |\n|---|{}\n",
        counts.join(" | "),
        "---|".repeat(counts.len())
    );
    for c in curves {
        let cells: Vec<String> = c.runs.iter().map(|r| format!("{} ({})", figure(r.max), figure(r.cpu))).collect();
        let _ = writeln!(text, "| {} | {} |", c.label, cells.join(" | "));
    }
    text
}
