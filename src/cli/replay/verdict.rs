//! What came out of a replay.

use crate::record::story::{Lost, Program};
use crate::world::EngineKind;
use std::fmt::Write;
use std::path::Path;

/// The first thing that is not the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Control interval.
    pub interval: u64,
    /// Simulated time, ns.
    pub stamp_ns: i64,
    /// What, and both values.
    pub what: String,
}

/// What came out.
#[derive(Clone, Debug, Default)]
pub struct Verdict {
    /// Control intervals made.
    pub intervals: u64,
    /// States compared, those after orders and during pauses included.
    pub states: u64,
    /// Published messages compared.
    pub messages: u64,
    /// Orders done.
    pub orders: u64,
    /// Simulated time at the end, ns.
    pub stamp_ns: i64,
    /// The first difference.
    pub difference: Option<Difference>,
    /// Why the rest could not be compared.
    pub gap: Option<String>,
    /// What the bag says it has lost.
    pub lost: Lost,
    /// The bag has no end.
    pub cut_off: bool,
    /// By a signal.
    pub stopped: bool,
    /// The bag cannot be read further.
    pub damage: Option<String>,
    /// Engines that the run used.
    pub engines: Vec<EngineKind>,
    /// Who recorded.
    pub recorder: Option<Program>,
    /// Who replays.
    pub this_program: Option<Program>,
}

impl Verdict {
    /// Is every recorded bit the same?
    pub fn same(&self) -> bool {
        self.difference.is_none() && self.gap.is_none() && self.damage.is_none() && !self.stopped && self.states > 0
    }
}

/// For people.
pub fn told(v: &Verdict, file: &Path) -> String {
    let seconds = |ns: i64| ns as f64 * 1e-9;
    let mut text = format!(
        "{}: {} control intervals replayed, up to {:.6} s of simulated time; {} states, {} published messages and {} orders\n",
        file.display(),
        v.intervals,
        seconds(v.stamp_ns),
        v.states,
        v.messages,
        v.orders
    );
    // Writing to a string cannot fail.
    let _ = match (&v.difference, v.states) {
        (Some(d), _) => writeln!(
            text,
            "DIFFERENT from control interval {} on ({:.6} s): {}",
            d.interval,
            seconds(d.stamp_ns),
            d.what
        ),
        (None, 0) => writeln!(text, "NOTHING was compared: the bag holds no state"),
        (None, _) if v.same() => writeln!(text, "SAME: all bits"),
        _ => writeln!(text, "INCOMPLETE: the same bits as far as it goes"),
    };
    if let Some(reason) = v.gap.as_ref().or(v.damage.as_ref()) {
        let _ = writeln!(text, "not compared from there on: {reason}");
    }
    notes(v).iter().for_each(|note| text += &format!("note: {note}\n"));
    text
}

fn notes(v: &Verdict) -> Vec<String> {
    let mut notes = vec![];
    if v.stopped {
        notes.push("stopped by a signal before the end of the bag".into());
    }
    if v.cut_off {
        notes.push("the bag was cut off: it has no end (realnoid recover completes it for other tools)".into());
    }
    if v.lost != Lost::default() {
        let Lost { messages, snapshots } = v.lost;
        notes.push(format!(
            "the bag says that it has lost {messages} messages and {snapshots} states while it was recorded: a difference may come from that"
        ));
    }
    if v.difference.is_some() {
        if let (Some(then), Some(now)) = (&v.recorder, &v.this_program)
            && then != now
        {
            notes.push(format!("recorded by {}; this is {}", shown(then), shown(now)));
        }
        let inexact = v.engines.iter().filter(|e| !e.capabilities().exact_copy);
        notes.extend(
            inexact
                .map(|e| format!("engine {} keeps things that it cannot be asked for; see docs/engines.md", e.name())),
        );
    }
    notes
}

fn shown(p: &Program) -> String {
    format!("realnoid {} on {} with {} (engines {})", p.version, p.target, p.cpu.join(", "), p.engines.join(", "))
}
