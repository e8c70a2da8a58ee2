//! What to take for which accuracy: derived from the figures by one rule, the cheapest run that is good enough.

use super::measure::{Curve, Measured, Run};
use super::page::shown;
use super::report::{figure, setting};
use super::rung::Ladder;

/// Greatest errors that are asked for, in the unit of the case.
pub const LEVELS: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// The cheapest run of some curves whose greatest error is not above a level. Ladders of iterations do not count.
pub(super) fn cheapest<'a>(curves: impl Iterator<Item = &'a Curve>, level: f64) -> Option<(&'a Curve, &'a Run)> {
    let all = curves.filter(|c| c.ladder != Ladder::Iterations).flat_map(|c| c.runs.iter().map(move |r| (c, r)));
    all.filter(|(_, r)| r.max <= level).min_by(|a, b| a.1.cpu.total_cmp(&b.1.cpu))
}

/// One sentence for each level that something reaches, and what nothing does.
pub(super) fn advice(m: &Measured) -> String {
    let unit = m.case.unit;
    let mut sentences = vec![];
    let mut before: Option<(String, f64)> = None;
    for level in LEVELS {
        let own = cheapest(m.curves.iter().filter(|c| !c.peer), level);
        let peer = cheapest(m.curves.iter().filter(|c| c.peer), level);
        let Some((curve, run)) = own else {
            let other = peer.map_or(String::new(), |(c, r)| {
                format!(", but {} {} does ({} CPU s per s)", c.label, setting(c, r), figure(r.cpu))
            });
            sentences.push(format!("Nothing measured of ours comes within {} {unit}{other}.", plain(level)));
            break;
        };
        let beside = peer.map_or_else(
            || if m.curves.iter().any(|c| c.peer) { "; no peer does".into() } else { String::new() },
            |(c, r)| {
                format!(
                    "; the cheapest peer is {} {}, with {} times the CPU time",
                    c.label,
                    setting(c, r),
                    ratio(r.cpu / run.cpu)
                )
            },
        );
        let name = format!("{} {}", curve.label, setting(curve, run));
        let said = match &before {
            Some((same, _)) if *same == name => format!("It is also within {} {unit}{beside}.", plain(level)),
            Some((_, cpu)) => {
                format!("For {} {unit}: **{name}**, {} times that price{beside}.", plain(level), ratio(run.cpu / cpu))
            }
            None => format!("For {} {unit}: **{name}** ({} CPU s per s){beside}.", plain(level), figure(run.cpu)),
        };
        sentences.push(said);
        before = Some((name, run.cpu));
    }
    sentences.extend(equal_price(m));
    sentences.join(" ")
}

/// At the price of the most accurate peer at the step that tables show: what the best of ours errs by that costs no more.
fn equal_price(m: &Measured) -> Option<String> {
    let peers = m.curves.iter().filter(|c| c.peer).filter_map(|c| shown(c).map(|r| (c, r)));
    let (curve, peer) = peers.filter(|(_, r)| !r.diverged).min_by(|a, b| a.1.max.total_cmp(&b.1.max))?;
    let ours = m.curves.iter().filter(|c| !c.peer && c.ladder != Ladder::Iterations);
    let ours = ours.flat_map(|c| c.runs.iter().map(move |r| (c, r))).filter(|(_, r)| r.cpu <= peer.cpu && !r.diverged);
    let (best, run) = ours.min_by(|a, b| a.1.max.total_cmp(&b.1.max))?;
    Some(format!(
        "At the price of {} {} ({}; greatest error {} {unit}) {} {} errs by {} {unit}.",
        curve.label,
        setting(curve, peer),
        figure(peer.cpu),
        figure(peer.max),
        best.label,
        setting(best, run),
        figure(run.max),
        unit = m.case.unit
    ))
}

/// A power of ten as people write it.
pub(super) fn plain(level: f64) -> String {
    format!("{level:e}")
}

fn ratio(x: f64) -> String {
    if x >= 9.95 { format!("{x:.0}") } else { format!("{x:.1}") }
}
