//! Time of a step with and without an effect, and how far a run without it gets from the full one.

use crate::cli::bench::cpu_seconds;
use crate::model::{AxisKind, JointType, LinkFrame, Model};
use crate::world::World;

/// What an effect takes, ns per step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    /// Median of the differences.
    pub median: f64,
    /// The first and the third quartile.
    pub quartiles: [f64; 2],
}

/// How far a run without an effect is from the full one at its end.
#[derive(Clone, Debug)]
pub(super) enum Error {
    /// The greatest difference of an axis and of a body that floats.
    Apart { axis: Option<Apart>, base: Option<(f64, f64, String)> },
    /// A run did not stay finite, or its joints came apart, so that positions cannot be compared.
    Lost(String),
}

/// Of an axis.
#[derive(Clone, Debug)]
pub(super) struct Apart {
    /// rad or m.
    pub by: f64,
    pub unit: &'static str,
    pub name: String,
}

/// ns per step of the full world, and what each of the others saves: all in turns, from the same start.
pub(super) fn times(full: &World, others: &[World], intervals: u64, rounds: u32) -> (f64, Vec<Time>) {
    let steps = intervals as f64 * f64::from(full.settings().steps_per_interval);
    let timed = |fresh: &World| {
        let mut world = fresh.clone();
        let start = cpu_seconds();
        (0..intervals).for_each(|_| world.advance());
        (cpu_seconds() - start) * 1e9 / steps
    };
    let (mut whole, mut saved) = (vec![], vec![vec![]; others.len()]);
    for _ in 0..rounds {
        whole.push(timed(full));
        for (other, saved) in others.iter().zip(&mut saved) {
            // Both neighbours: what changes steadily meanwhile cancels.
            let (before, without, after) = (timed(full), timed(other), timed(full));
            whole.extend([before, after]);
            saved.push(0.5 * (before + after) - without);
        }
    }
    let time = |mut all: Vec<f64>| Time {
        median: quantile(&mut all, 0.5),
        quartiles: [0.25, 0.75].map(|share| quantile(&mut all, share)),
    };
    (quantile(&mut whole, 0.5), saved.into_iter().map(time).collect())
}

fn quantile(all: &mut [f64], share: f64) -> f64 {
    all.sort_by(f64::total_cmp);
    let at = (all.len().saturating_sub(1)) as f64 * share;
    all.get(at.round() as usize).copied().unwrap_or(f64::NAN)
}

/// Of each of the others against the full world, after so many seconds.
pub(super) fn errors(full: &World, others: &[World], seconds: f64) -> Vec<Error> {
    let end = |fresh: &World| {
        let mut world = fresh.clone();
        while world.time() < seconds && world.stats().diverged_steps == 0 {
            world.advance();
        }
        world
    };
    let full = end(full);
    others.iter().map(|other| error(&full, &end(other))).collect()
}

fn error(full: &World, other: &World) -> Error {
    for (world, which) in [(full, "the full run"), (other, "the run without it")] {
        if world.stats().diverged_steps > 0 {
            return Error::Lost(format!("{which} does not stay finite"));
        }
    }
    if full.broken().len() != other.broken().len() {
        return Error::Lost("other joints have come apart".into());
    }
    let m = full.model();
    let position = |world: &World, axis: usize| world.state().axis(m, axis).0;
    let apart = (0..m.axes.len()).map(|i| (i, (position(full, i) - position(other, i)).abs()));
    let axis = apart.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, by)| {
        let unit = if m.axes[i].kind == AxisKind::Linear { "m" } else { "rad" };
        Apart { by, unit, name: m.axes[i].name.clone() }
    });
    let bases = floating(m).map(|b| base(m, b, &full.state().q, &other.state().q));
    Error::Apart { axis, base: bases.max_by(|a, b| a.0.total_cmp(&b.0)) }
}

fn floating(m: &Model) -> impl Iterator<Item = usize> {
    (1..m.bodies.len()).filter(|b| m.bodies[*b].joint == JointType::Floating)
}

/// How far a body that floats is from itself in the other run: way (m), angle (rad), the link on it.
fn base(m: &Model, body: usize, a: &[f64], b: &[f64]) -> (f64, f64, String) {
    let at = m.bodies[body].q;
    let way = (0..3).map(|k| (a[at + k] - b[at + k]).powi(2)).sum::<f64>().sqrt();
    // |q_a − q_b| = 2 sin(angle / 4), on the nearer of the two quaternions of a pose.
    let chord = |sign: f64| (3..7).map(|k| (a[at + k] - sign * b[at + k]).powi(2)).sum::<f64>().sqrt();
    let angle = 4.0 * (0.5 * chord(1.0).min(chord(-1.0))).min(1.0).asin();
    let on = |l: &&crate::model::LinkInfo| matches!(l.frame, LinkFrame::OnBody { body: own, .. } if own == body);
    (way, angle, m.links.iter().find(on).map_or_else(String::new, |l| l.name.clone()))
}

#[cfg(test)]
mod tests {
    #[test]
    fn quantiles_are_of_the_sorted_numbers() {
        let mut all = [3.0, 1.0, 2.0, 5.0, 4.0];
        assert_eq!([0.0, 0.5, 1.0].map(|share| super::quantile(&mut all, share)), [1.0, 3.0, 5.0]);
        assert!(super::quantile(&mut [], 0.5).is_nan());
    }
}
