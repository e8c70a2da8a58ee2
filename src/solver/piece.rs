//! The law of an axis for an engine that knows constant torques and velocity motors.
//!
//! Every part of a law is exactly one of each: on a segment the torque at the present speed, and a motor whose damping is the
//! slope; on a riser the torque at its middle, and a stiff motor to its speed that is bounded by half its width. Where the
//! segments on both sides of a riser are level, one piece is all three, and the engine's solver finds out which it is.

use super::law::{FRICTION, Law};

/// `torque + motor`, where the motor gives `damping · (speed − v)`, at most ± `bound`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// N·m or N.
    pub torque: f64,
    /// What the motor wants, rad/s or m/s.
    pub speed: f64,
    /// N·m·s/rad or N·s/m; ∞: as stiff as can be; 0: no motor.
    pub damping: f64,
    /// N·m or N, maybe infinite.
    pub bound: f64,
    /// The riser that it stands for.
    pub(crate) riser: Option<usize>,
}

impl Piece {
    /// No torque.
    pub const NONE: Self = Self { torque: 0.0, speed: 0.0, damping: 0.0, bound: 0.0, riser: None };
}

/// How far the speed of an axis may change in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reach {
    /// As it did in the last steps, rad/s or m/s.
    pub change: f64,
    /// By another torque, per torque.
    pub per_torque: f64,
}

impl Law {
    /// The piece for a step from the speed `v`; `memory` is of what kinds the riser was that the axis stood on, 0 if it slid;
    /// `level`: may a riser stand for the segments beside it, if they are level?
    pub(crate) fn piece(&self, v: f64, reach: &Reach, memory: u8, level: bool) -> Piece {
        let place = self.guess(v, memory);
        let between = |k: &usize| {
            let (left, right) = self.held(*k);
            (self.knots[*k].speed - v).abs() <= reach.change + reach.per_torque * (left - right)
        };
        let distance = |k: &usize| (self.knots[*k].speed - v).abs();
        let nearest =
            |risers: &mut dyn Iterator<Item = usize>| risers.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let risers = || (0..self.count).filter(|k| self.is_riser(*k));
        if place % 2 == 1 {
            return self.on_riser(place / 2);
        }
        if let Some(k) = nearest(&mut risers().filter(between)) {
            return self.on_riser(k);
        }
        let level = |j: usize| level && self.segments[j].slope == 0.0;
        let (j, beside) = (place / 2, |k: &usize| *k == place / 2 || *k + 1 == place / 2);
        match nearest(&mut risers().filter(beside)) {
            Some(k) if level(k) && level(k + 1) => self.on_riser(k),
            _ => self.along(j, v),
        }
    }

    fn on_riser(&self, k: usize) -> Piece {
        let (left, right) = self.held(k);
        let speed = self.knots[k].speed;
        let (torque, bound) = match (left.is_finite(), right.is_finite()) {
            (true, true) => (0.5 * (left + right), 0.5 * (left - right)),
            (true, false) => (left, f64::INFINITY),
            (false, true) => (right, f64::INFINITY),
            (false, false) => (0.0, f64::INFINITY),
        };
        Piece { torque, speed, damping: f64::INFINITY, bound, riser: Some(k) }
    }

    fn along(&self, j: usize, v: f64) -> Piece {
        let damping = self.segments[j].slope;
        let bound = if damping > 0.0 { f64::INFINITY } else { 0.0 };
        Piece { torque: self.on_segment(j, v), speed: v, damping, bound, riser: None }
    }

    /// After a step in which the piece and its motor gave `torque` on average: the torque of the drive, and of what kinds the riser
    /// was that the axis stands on, 0 if it slides. `mean` is the mean speed in the step.
    pub(crate) fn outcome(&self, piece: &Piece, torque: f64, mean: f64) -> (f64, u8) {
        match piece.riser.filter(|k| self.is_inside(*k, torque)) {
            Some(k) => (self.drive_torque(piece.speed, Some((k, torque))), self.knots[k].kinds),
            None => (self.drive_torque(mean, None), 0),
        }
    }

    /// Does a riser of these kinds hold an axis by dry friction?
    pub(crate) fn sticks(&self, memory: u8) -> bool {
        memory & FRICTION != 0
    }

    /// Is this torque strictly between the ends of a riser?
    fn is_inside(&self, k: usize, torque: f64) -> bool {
        let (left, right) = self.held(k);
        let slack = BOUND * (left - right).min(1.0);
        torque < left - slack && torque > right + slack
    }
}

/// A motor this near to its bound, relative, is at it.
const BOUND: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Axis, AxisKind, AxisSlot, DriveLimits, Effects, Softness};
    use crate::solver::{AxisCommand, AxisInput, Brakes};

    fn axis() -> Axis {
        Axis {
            name: "a".into(),
            kind: AxisKind::Rotary,
            slot: AxisSlot::Scalar { q: 0, v: 0 },
            direction: crate::math::Vec3::z(),
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            stop: Softness::HELD,
            drive: DriveLimits::default(),
            damping: 0.3,
            friction: 0.5,
            mode: crate::description::DriveMode::Idle,
            switchable: true,
        }
    }

    fn law(axis: &Axis, limits: &DriveLimits, command: AxisCommand) -> Law {
        let mut law = Law::default();
        let effects = Effects { damping: true, friction: true, drives: true, limits: true, ..Effects::NONE };
        let input = AxisInput { axis, limits, command, q: 0.1, stuck: false, brakes: Brakes::default() };
        law.set(&input, effects, (1e-3, 1e-3));
        law
    }

    /// What a piece gives at a speed.
    fn torque(p: &Piece, v: f64) -> f64 {
        let motor = if p.damping == f64::INFINITY {
            if v == p.speed { 0.0 } else { (p.speed - v).signum() * p.bound }
        } else {
            (p.damping * (p.speed - v)).min(p.bound).max(-p.bound)
        };
        p.torque + if motor.is_nan() { 0.0 } else { motor }
    }

    /// The pieces of a law, taken at many speeds, give its torque there.
    #[test]
    fn a_piece_is_the_law_where_it_is_taken() {
        let limits = DriveLimits { max_torque: 10.0, no_load_speed: 6.0, max_speed: 6.0, ..DriveLimits::default() };
        let soft = Axis { lower: -0.2, upper: 0.1 + 1e-4, stop: Softness { erp: 0.2, cfm: 1e-3 }, ..axis() };
        let level = Axis { damping: 0.0, ..axis() };
        for axis in [axis(), soft, level] {
            for command in
                [AxisCommand::IDLE, AxisCommand::torque(3.0), AxisCommand::torque(-3.0), AxisCommand::servo(0.3)]
            {
                let law = law(&axis, &limits, command);
                for k in -70..70 {
                    let v = 0.1 * f64::from(k) + 0.05;
                    for level in [true, false] {
                        let piece = law.piece(v, &Reach::default(), 0, level);
                        let j = law.guess(v, 0) / 2;
                        let (is, should) = (torque(&piece, v), law.on_segment(j, v));
                        assert!((is - should).abs() < 1e-12, "{command:?} {v}: {is} {should} {piece:?}");
                    }
                }
            }
        }
    }

    /// On its way across a riser the axis gets the riser, with bounds that are the torques on both sides.
    #[test]
    fn a_riser_ahead_is_taken() {
        let law = law(&axis(), &DriveLimits::default(), AxisCommand::torque(2.0));
        let piece = law.piece(0.01, &Reach { change: 0.02, per_torque: 0.0 }, 0, false);
        assert_eq!((piece.speed, piece.bound, piece.torque), (0.0, 0.5, 2.0));
        assert_eq!(piece.riser, Some(0));
    }

    #[test]
    fn standing_and_sliding_are_told_apart() {
        let law = law(&axis(), &DriveLimits::default(), AxisCommand::IDLE);
        let piece = law.piece(0.0, &Reach::default(), 0, false);
        assert_eq!(law.outcome(&piece, 0.2, 0.0), (0.0, FRICTION));
        assert_eq!(law.outcome(&piece, -0.5, 0.2).1, 0);
    }
}
