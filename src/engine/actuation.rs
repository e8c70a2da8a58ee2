//! What acts on the axes, for engines with a body for each link: drives, damping, friction and soft stops by the same laws as
//! in rbx ([`Law`]), as constant torques and velocity motors of the engine ([`Piece`]); hard stops as the engine's limits.
//!
//! One piece of the law is chosen for each axis and step, from its speed, its last acceleration and whether it stood. An axis
//! that leaves its piece within a step is seen at the end of it, so a change of piece comes up to one step late; within a
//! piece the engine's implicit motor neither rings nor creeps.
//!
//! Inertia of rotors is part of the motor: a damping J/h about the speed at the start of the step, which is implicit Euler. It
//! is exact only if the engine makes the step in one go.

use super::State;
use crate::math::V3;
use crate::model::{Axis, AxisSlot, DriveLimits, Effects, EulerRates, Model};
use crate::solver::{AxisCommand, AxisInput, Books, Brakes, FreeMobility, Law, Mode, Piece, Reach};

/// Laws, pieces and books of all axes. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Actuation {
    /// The drives, and what became of them.
    pub books: Books,
    rates: Vec<EulerRates>,
    axes: Vec<AxisState>,
    mobility: FreeMobility,
    gain: f64,
}

#[derive(Clone, Debug)]
struct AxisState {
    law: Law,
    piece: Piece,
    /// Kinds of the riser that it stands on, 0 if it slides.
    memory: u8,
    /// At the start of the step, rad or m and rad/s or m/s.
    q: f64,
    v: f64,
    /// In the last step, rad/s² or m/s².
    acceleration: f64,
    brakes: Brakes,
    /// What the engine's iteration leaves of the speed of its riser is taken back by the motor of the next step, rad/s or m/s.
    correction: f64,
    /// And what it leaves of the torque of a segment, N·m or N.
    missing: f64,
    /// Inertia of the rotor that counts, kg·m² or kg.
    rotor: f64,
    /// Way to the lower (≤ 0 inside) and to the upper stop, if they are hard and in force.
    stop: Option<[f64; 2]>,
}

/// What a step starts from.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// State.
    pub state: &'a State,
    /// Of all axes.
    pub commands: &'a [AxisCommand],
    /// What is simulated.
    pub effects: Effects,
    /// The step, s, and the one that it is a part of.
    pub h: (f64, f64),
}

impl Actuation {
    /// Room for this model.
    pub fn new(m: &Model) -> Self {
        let axis = AxisState {
            law: Law::default(),
            piece: Piece::NONE,
            memory: 0,
            q: 0.0,
            v: 0.0,
            acceleration: 0.0,
            brakes: Brakes::default(),
            correction: 0.0,
            missing: 0.0,
            rotor: 0.0,
            stop: None,
        };
        Self {
            books: Books::new(m),
            rates: vec![EulerRates::default(); m.eulers.len()],
            axes: vec![axis; m.axes.len()],
            mobility: FreeMobility::new(m),
            gain: GAIN,
        }
    }

    /// For an engine whose motors start from what they gave in the last step: it takes back most of what its iteration leaves by
    /// itself, and both in full would overshoot.
    pub fn of_warm_motors(m: &Model) -> Self {
        Self { gain: 0.1, ..Self::new(m) }
    }

    /// Forgets the steps so far.
    pub fn reset(&mut self) {
        self.forget();
        self.books.reset();
    }

    /// Forgets what the axes did in the last step; the books go on.
    pub fn forget(&mut self) {
        for axis in &mut self.axes {
            (axis.memory, axis.acceleration) = (0, 0.0);
            (axis.correction, axis.missing) = (0.0, 0.0);
            axis.brakes = Brakes::default();
        }
    }

    /// Goes on with a model of the same axes; those that have come apart give no torque. Allocates.
    pub fn refit(&mut self, m: &Model) {
        self.rates = vec![EulerRates::default(); m.eulers.len()];
        self.mobility = FreeMobility::new(m);
        for (i, axis) in m.axes.iter().enumerate() {
            if let AxisSlot::Apart { .. } = axis.slot {
                self.books.effort[i] = 0.0;
                (self.axes[i].memory, self.axes[i].stop, self.axes[i].piece) = (0, None, Piece::NONE);
            }
        }
    }

    /// Before a step that may have several parts.
    pub fn open_books(&mut self) {
        self.books.effort.fill(0.0);
    }

    /// Sets up laws and pieces. True if a 3DOF group is at its pole.
    pub fn prepare(&mut self, m: &Model, start: &Start) -> bool {
        let at_pole = m.write_rates(&start.state.angles, &mut self.rates);
        self.learn_mobilities(m, start);
        for (i, axis) in m.axes.iter().enumerate() {
            let at = &mut self.axes[i];
            (at.q, at.v) = start.state.axis(m, i);
            at.rotor = self.books.rotor(i, start.effects);
            at.stop = hard_stop(axis, at.q, start.effects);
            if start.effects.limits {
                self.books.watch_stop(axis, at.q);
            }
            if axis.is_graspable(&self.rates) {
                at.set(axis, (&self.books.drives[i], start.commands[i]), start);
            } else {
                at.law.clear();
                (at.piece, at.stop, at.rotor) = (Piece::NONE, None, 0.0);
            }
        }
        at_pole
    }

    /// How each axis answers to a torque, for servos and for the choice of the pieces.
    fn learn_mobilities(&mut self, m: &Model, start: &Start) {
        let q = &start.state.q;
        let rotors = (0..m.axes.len()).map(|axis| self.books.rotor(axis, start.effects));
        self.mobility.refresh(m, q, rotors);
        for (i, at) in self.axes.iter_mut().enumerate() {
            at.brakes.mobility = self.mobility.of(m, q, &self.rates, i);
        }
    }

    /// Torque and motor of an axis in the step that was prepared, rotor included; of a 3DOF angle along its gradient.
    pub fn motor(&self, axis: usize, h: f64) -> Piece {
        self.axes[axis].motor(h)
    }

    /// How far it is to the lower (≤ 0 inside) and the upper stop (≥ 0 inside), rad or m; infinite where there is none. `None`:
    /// no hard stop.
    pub fn stop(&self, axis: usize) -> Option<[f64; 2]> {
        self.axes[axis].stop
    }

    /// Of a 3DOF group: rate of the angle per angular velocity in the child's frame; torque about the angle acts along it.
    pub fn gradient(&self, group: usize, angle: usize) -> V3<f64> {
        self.rates[group].gradient[angle]
    }

    /// Books what hard stops gave in a part of a step of `h` seconds that ends with this state, before [`Actuation::finish`]: per
    /// axis `stops`, N·m or N. Impulses along the mean of the speeds at both ends, which is exact for impacts.
    pub fn book_stops(&mut self, m: &Model, h: f64, state: &State, stops: &[f64]) {
        for (i, (at, stop)) in self.axes.iter().zip(stops).enumerate() {
            if *stop != 0.0 {
                self.books.work.losses -= 0.5 * h * stop * (at.v + state.axis(m, i).1);
            }
        }
    }

    /// Ends a step, or a part of it, with this state. `motors`: per axis, what its motor gave on average, N·m or N.
    pub fn finish(&mut self, m: &Model, start: (f64, f64), state: &State, motors: &[f64]) {
        let (h, whole) = start;
        for (i, (at, motor)) in self.axes.iter_mut().zip(motors).enumerate() {
            let (q, v) = state.axis(m, i);
            let (way, mean) = (q - at.q, (q - at.q) / h);
            at.acceleration = (v - at.v) / h;
            let total = at.motor(h).torque + motor + at.rotor * at.acceleration;
            let (effort, memory) = at.law.outcome(&at.piece, total, mean);
            at.missing = at.still_missing(total, v);
            at.memory = memory;
            at.correction = if memory == 0 { 0.0 } else { at.correction + self.gain * (at.piece.speed - mean) };
            at.brakes.drift = at.acceleration - at.brakes.mobility * effort;
            self.books.effort[i] += effort * h / whole;
            self.books.work.book(effort, total, way);
        }
    }
}

impl AxisState {
    fn set(&mut self, axis: &Axis, (limits, mut command): (&DriveLimits, AxisCommand), start: &Start) {
        let unbounded = limits.max_torque == f64::INFINITY && !command.torque.is_finite();
        if self.stop.is_some() && command.mode == Mode::Servo && unbounded {
            // Nothing would keep it from pushing through the engine's limit.
            command.target = command.target.max(axis.lower).min(axis.upper);
        }
        let input = AxisInput { axis, limits, command, q: self.q, stuck: self.stuck(), brakes: self.brakes };
        // Hard stops are limits of the engine.
        let effects = Effects { limits: start.effects.limits && self.stop.is_none(), ..start.effects };
        self.law.set(&input, effects, start.h);
        let h = start.h.0;
        let reach = Reach { change: AHEAD * self.acceleration.abs() * h, per_torque: h * self.brakes.mobility };
        self.piece = self.law.piece(self.v, &reach, self.memory, self.rotor == 0.0);
    }

    fn motor(&self, h: f64) -> Piece {
        let (piece, inert) = (self.piece, self.rotor / h);
        match piece.riser {
            Some(_) => {
                let (torque, speed) = (piece.torque - inert * (piece.speed - self.v), piece.speed + self.correction);
                Piece { torque, speed, ..piece }
            }
            None if inert + piece.damping == 0.0 => piece,
            None => Piece {
                torque: piece.torque + self.missing,
                damping: piece.damping + inert,
                speed: self.v,
                bound: f64::INFINITY,
                ..piece
            },
        }
    }

    /// In the next step. `total`: torque of the law in this one, which ended with the speed `v`.
    fn still_missing(&self, total: f64, v: f64) -> f64 {
        match self.piece.riser {
            Some(_) => 0.0,
            None => self.missing + GAIN * (self.piece.torque - self.piece.damping * (v - self.v) - total),
        }
    }

    fn stuck(&self) -> bool {
        self.law.sticks(self.memory) || self.v == 0.0
    }
}

/// Share of what is left of a speed or a torque that the next step's motor takes back.
const GAIN: f64 = 0.5;
/// Steps within which the present acceleration must bring an axis to a riser so that it is looked for there.
const AHEAD: f64 = 2.0;

fn hard_stop(axis: &Axis, q: f64, effects: Effects) -> Option<[f64; 2]> {
    (effects.limits && axis.has_hard_stops()).then_some([axis.lower - q, axis.upper - q])
}
