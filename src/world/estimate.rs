//! How far a run is off, seen by doing it again with finer steps (step doubling; Hairer, Nørsett, Wanner: *Solving Ordinary
//! Differential Equations I*, §II.4).
//!
//! With steps of half the length the error of a method of order p is 2⁻ᵖ of what it was, so the difference of the two runs is
//! 1 − 2⁻ᵖ of the error. That holds while the motion is smooth on the scale of a step. Where bodies touch, axes stop or begin to stand,
//! all methods that hand over to the default are of first order there, and the estimate is right to a factor of 4 at best; where motion
//! is chaotic it holds until the two runs have nothing to do with each other any more.

use super::{ACCURACY, EngineKind, Integrator, World};
use crate::model::{Base, JointType, Model};

/// The finer run of the extrapolation method has its accuracy divided by this, and half the step.
const FINER: f64 = 100.0;

/// A difference of one coordinate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// rad or m; rad/s or m/s.
    pub size: f64,
    /// The axis; beyond the axes, the link whose origin it is.
    pub place: usize,
}

/// The largest differences between two runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Of the positions of axes (rad, m) and of the origins of free bodies (m).
    pub position: Largest,
    /// Of their speeds.
    pub speed: Largest,
}

impl Largest {
    fn note(&mut self, size: f64, place: usize) {
        if size > self.size || size.is_nan() {
            (self.size, self.place) = (if size.is_nan() { f64::INFINITY } else { size }, place);
        }
    }

    /// Name of the axis or link.
    pub fn name<'a>(&self, m: &'a Model) -> &'a str {
        let link = || m.links.get(self.place - m.axes.len()).map_or("", |l| &l.name);
        m.axes.get(self.place).map_or_else(link, |a| &a.name)
    }
}

impl Deviation {
    /// Takes over what is larger in another one.
    pub fn widen(&mut self, other: &Self) {
        self.position.note(other.position.size, other.position.place);
        self.speed.note(other.speed.size, other.speed.place);
    }
}

impl World {
    /// A copy that goes on with half the step. Allocates.
    pub fn finer(&self) -> Self {
        let mut finer = self.clone();
        let s = &mut finer.settings;
        s.steps_per_interval = s.steps_per_interval.saturating_mul(2);
        s.accuracy = (s.accuracy / FINER).max(ACCURACY.0);
        finer
    }

    /// Order of its steps while nothing touches and no axis stops; engines with an integrator of their own are of first order. `None`:
    /// the finer run counts as exact.
    pub fn order(&self) -> Option<i32> {
        match (self.settings.engine, self.settings.integrator) {
            (EngineKind::Rbx, Integrator::Extrapolation) => None,
            (EngineKind::Rbx, Integrator::Rk4) => Some(4),
            (EngineKind::Rbx, Integrator::ImplicitMidpoint) => Some(2),
            _ => Some(1),
        }
    }

    /// The error that the difference from a run with finer steps stands for. All is infinite if joints have come apart in only one of
    /// them.
    pub fn error_by(&self, finer: &Self) -> Deviation {
        let (a, b, m) = (self.state(), finer.state(), &self.model);
        let mut found = Deviation::default();
        if self.broken().len() != finer.broken().len() || a.q.len() != b.q.len() {
            found.position.size = f64::INFINITY;
            found.speed.size = f64::INFINITY;
            return found;
        }
        let whole = self.order().map_or(1.0, |p| 1.0 / (1.0 - 0.5_f64.powi(p)));
        for axis in 0..m.axes.len() {
            let ((qa, va), (qb, vb)) = (a.axis(m, axis), b.axis(m, axis));
            found.position.note(whole * (qa - qb).abs(), axis);
            found.speed.note(whole * (va - vb).abs(), axis);
        }
        for (i, body) in m.bodies.iter().enumerate().skip(1).filter(|(_, b)| b.joint == JointType::Floating) {
            let place = m.axes.len() + link_of(m, i);
            let apart = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
            found.position.note(whole * apart(&a.q[body.q..body.q + 3], &b.q[body.q..body.q + 3]), place);
            found.speed.note(whole * apart(&a.v[body.v + 3..body.v + 6], &b.v[body.v + 3..body.v + 6]), place);
        }
        found
    }
}

/// The link on a body, or the root link.
fn link_of(m: &Model, body: usize) -> usize {
    let on =
        |l: &crate::model::LinkInfo| matches!(l.frame, crate::model::LinkFrame::OnBody { body: b, .. } if b == body);
    m.links.iter().position(on).unwrap_or(if m.base == Base::Free { m.root_link } else { 0 })
}

/// The error of single control intervals: each is made again, from the same state, with finer steps.
#[derive(Debug, Default)]
pub struct LocalEstimate {
    twin: Option<Box<World>>,
}

impl LocalEstimate {
    /// Before an interval of `world`, when its commands are set. Allocates a copy of it.
    pub fn begin(&mut self, world: &World) {
        self.twin = Some(Box::new(world.finer()));
    }

    /// After it: the error that it made. Costs about two intervals.
    pub fn end(&mut self, world: &World) -> Deviation {
        let Some(mut twin) = self.twin.take() else { return Deviation::default() };
        twin.advance();
        world.error_by(&twin)
    }
}
