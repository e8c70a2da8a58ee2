//! All axes at once: which of them stand on a riser of their law, which slide on a flat.
//!
//! A standing axis is locked to the speed of its riser by the hybrid dynamics, exactly; a sliding one gets the torque of
//! its flat. After each pass the axes whose reaction or speed does not fit move to the neighbouring part of their law. All
//! that do not fit move at once while that helps; else only the last of them (block principal pivoting with Murty's rule
//! as the fallback; Júdice and Pires 1994), which ends because the mass matrix is positive definite.

use super::couplings::Couplings;
use super::law::{Law, law};
use super::{AxisCommand, AxisInput};
use crate::dynamics::{DofIn, Workspace, aba_hybrid};
use crate::math::V3;
use crate::model::{Axis, AxisSlot, Effects, EulerRates, Model};

/// Relative tolerance of the fit.
const FIT: f64 = 1e-11;
/// Passes that may move all axes at once without getting better.
const PATIENCE: u32 = 3;

/// What a solve came to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// Passes of the hybrid dynamics.
    pub passes: u32,
    /// Every axis fits its law.
    pub settled: bool,
}

/// A state as the solver sees it.
#[derive(Clone, Copy, Debug)]
pub struct StateRef<'a> {
    /// Coordinates.
    pub q: &'a [f64],
    /// Velocities.
    pub v: &'a [f64],
    /// H, P, B of each 3DOF group.
    pub angles: &'a [[f64; 3]],
}

/// Laws and places of all axes. Makes its memory once.
#[derive(Clone, Debug)]
pub struct AxisSet {
    pub(super) laws: Vec<Law>,
    /// Per axis: 2 j on flat j, 2 k + 1 on riser k.
    pub(super) place: Vec<usize>,
    /// Kinds of the riser an axis stood on at the end of the last step; 0 = it slid.
    pub(super) memory: Vec<u8>,
    moves: Vec<isize>,
    /// Per axis of a 3DOF group: which of its group's locks is its own, while it is locked.
    lock: Vec<usize>,
    pub(super) rates: Vec<EulerRates>,
    pub(super) speed: Vec<f64>,
    /// Per axis: drive torque really applied.
    pub effort: Vec<f64>,
    /// Rows that hold followers to their leaders, if there are any.
    pub(super) couplings: Option<Box<Couplings>>,
}

impl AxisSet {
    /// Room for this model.
    pub fn new(model: &Model) -> Self {
        let n = model.axes.len();
        Self {
            laws: vec![Law::default(); n],
            place: vec![0; n],
            memory: vec![0; n],
            moves: vec![0; n],
            lock: vec![0; n],
            rates: vec![EulerRates::default(); model.eulers.len()],
            speed: vec![0.0; n],
            effort: vec![0.0; n],
            couplings: Couplings::new(model),
        }
    }

    /// Forgets the last step.
    pub fn reset(&mut self) {
        self.memory.fill(0);
        self.effort.fill(0.0);
        if let Some(couplings) = &mut self.couplings {
            couplings.reset();
        }
    }

    /// Sets up the laws of a step of `h` seconds and the first guess of each axis' place. True if a 3DOF group is at its
    /// pole.
    pub fn prepare(&mut self, m: &Model, s: StateRef, commands: &[AxisCommand], effects: Effects, h: f64) -> bool {
        let at_pole = self.update_rates(m, s);
        for (i, axis) in m.axes.iter().enumerate() {
            let (q, v) = self.axis_state(m, axis, s);
            let input = AxisInput { axis, command: commands[i], q, v };
            self.speed[i] = v;
            self.laws[i] = if self.ungraspable(axis) { Law::default() } else { law(&input, effects, h) };
            self.place[i] = self.laws[i].guess(v, self.memory[i]);
        }
        at_pole
    }

    /// At the pole of a group, H has no torque of its own: it turns about the same line as B.
    fn ungraspable(&self, axis: &Axis) -> bool {
        matches!(axis.slot, AxisSlot::Euler { group, angle: 0 } if self.rates[group].at_pole)
    }

    pub(super) fn axis_state(&self, m: &Model, axis: &Axis, s: StateRef) -> (f64, f64) {
        match axis.slot {
            AxisSlot::Scalar { q, v } => (s.q[q], s.v[v]),
            AxisSlot::Euler { group, angle } => {
                let at = m.eulers[group].v;
                let w = V3::new(s.v[at], s.v[at + 1], s.v[at + 2]);
                (s.angles[group][angle], self.rates[group].gradient[angle].dot(w))
            }
            AxisSlot::Apart { position } => (position, 0.0),
        }
    }

    /// Accelerations of an implicit step of `h` seconds after [`AxisSet::prepare`], in at most `passes` passes.
    pub fn solve(
        &mut self,
        m: &Model,
        ws: &mut Workspace<f64>,
        s: StateRef,
        (gravity, h, passes): ([f64; 3], f64, u32),
        qdd: &mut [f64],
    ) -> Outcome {
        let (mut best, mut patience, mut done) = (usize::MAX, PATIENCE, 0);
        loop {
            self.write_inputs(m, ws, h);
            aba_hybrid(m, ws, (s.q, s.v), gravity, qdd);
            done += 1;
            let loose = self.couple(m, ws, s, (h, passes), qdd);
            let misfits = self.misfits(m, ws, (h, qdd)) + loose;
            if misfits == 0 || done >= passes.max(1) {
                self.finish(m, ws, (h, qdd));
                return Outcome { passes: done, settled: misfits == 0 };
            }
            if misfits < best {
                (best, patience) = (misfits, PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            self.apply(patience > 0);
        }
    }

    /// Takes the angles of a state; true if a 3DOF group is at its pole.
    pub fn update_rates(&mut self, m: &Model, s: StateRef) -> bool {
        let mut at_pole = false;
        for (rates, (group, angles)) in self.rates.iter_mut().zip(m.eulers.iter().zip(s.angles)) {
            *rates = group.rates(*angles);
            at_pole |= rates.at_pole;
        }
        at_pole
    }

    fn write_inputs(&mut self, m: &Model, ws: &mut Workspace<f64>, h: f64) {
        clear_balls(ws);
        for i in 0..m.axes.len() {
            let (law, place, v) = (&self.laws[i], self.place[i], self.speed[i]);
            let input = if place % 2 == 1 {
                Input::Locked((law.risers[place / 2].speed - v) / h)
            } else {
                Input::Sliding { torque: law.flat(place / 2) - law.slope * v, diagonal: law.slope * h }
            };
            self.write(m, ws, i, input);
        }
    }

    /// Hands one axis to the hybrid dynamics, through its own coordinate or the gradient of its angle.
    pub(super) fn write(&mut self, m: &Model, ws: &mut Workspace<f64>, i: usize, input: Input) {
        match (m.axes[i].slot, input) {
            (AxisSlot::Apart { .. }, _) => {}
            (AxisSlot::Scalar { v, .. }, Input::Locked(acceleration)) => ws.dofs[v] = DofIn::locked(acceleration),
            (AxisSlot::Scalar { v, .. }, Input::Sliding { torque, diagonal }) if diagonal > 0.0 => {
                ws.dofs[v] = DofIn::implicit(torque, diagonal);
            }
            (AxisSlot::Scalar { v, .. }, Input::Sliding { torque, .. }) => ws.dofs[v] = DofIn::free(torque),
            (AxisSlot::Euler { group, angle }, input) => {
                let g = self.rates[group].gradient[angle];
                let ball = &mut ws.ball_in[m.bodies[m.eulers[group].body].ball];
                match input {
                    Input::Locked(acceleration) => self.lock[i] = ball.add_lock(g, acceleration),
                    Input::Sliding { torque, diagonal } => {
                        ball.tau = g.mad(torque, ball.tau);
                        ball.inertia.sub_outer(g * -diagonal, g);
                    }
                }
            }
        }
    }

    /// Torque that keeps a locked axis to its acceleration.
    pub(super) fn reaction(&self, m: &Model, ws: &Workspace<f64>, i: usize) -> f64 {
        match m.axes[i].slot {
            AxisSlot::Apart { .. } => 0.0,
            AxisSlot::Scalar { v, .. } => ws.reaction[v],
            AxisSlot::Euler { group, .. } => {
                ws.ball_in[m.bodies[m.eulers[group].body].ball].lock[self.lock[i]].reaction
            }
        }
    }

    /// Speed at the end of the step, and the torque of the law (without slope) that goes with it where it is locked.
    fn end(&self, m: &Model, ws: &Workspace<f64>, i: usize, (h, qdd): (f64, &[f64])) -> (f64, f64) {
        let (law, place) = (&self.laws[i], self.place[i]);
        if place % 2 == 1 {
            let v = law.risers[place / 2].speed;
            return (v, self.reaction(m, ws, i) + law.slope * v);
        }
        let acceleration = match m.axes[i].slot {
            AxisSlot::Apart { .. } => 0.0,
            AxisSlot::Scalar { v: k, .. } => qdd[k],
            AxisSlot::Euler { group, angle } => {
                let at = m.eulers[group].v;
                self.rates[group].gradient[angle].dot(V3::new(qdd[at], qdd[at + 1], qdd[at + 2]))
            }
        };
        (self.speed[i] + h * acceleration, 0.0)
    }

    /// Notes for every axis to which side it leaves its part of the law; returns how many do.
    fn misfits(&mut self, m: &Model, ws: &Workspace<f64>, end: (f64, &[f64])) -> usize {
        for i in 0..self.laws.len() {
            self.moves[i] = 0;
            if !self.laws[i].smooth() {
                let (v, torque) = self.end(m, ws, i, end);
                self.moves[i] = self.laws[i].step(self.place[i], v, torque);
            }
        }
        self.moves.iter().filter(|s| **s != 0).count()
    }

    /// Moves all that do not fit, or only the last of them.
    fn apply(&mut self, all: bool) {
        for (place, step) in self.place.iter_mut().zip(&self.moves).rev() {
            *place = place.saturating_add_signed(*step);
            if !all && *step != 0 {
                return;
            }
        }
    }

    /// Remembers the places and writes the efforts.
    fn finish(&mut self, m: &Model, ws: &Workspace<f64>, end: (f64, &[f64])) {
        for i in 0..self.laws.len() {
            let (v, torque) = self.end(m, ws, i, end);
            let law = &self.laws[i];
            let riser = (self.place[i] % 2 == 1).then_some(self.place[i] / 2);
            self.memory[i] = riser.map_or(0, |k| law.risers[k].kinds);
            self.effort[i] = law.drive_torque(v, riser.map(|k| (k, torque)));
        }
    }
}

/// What the hybrid dynamics get of one axis.
pub(super) enum Input {
    /// Acceleration of the axis; for an angle of a group, gradient·ω̇.
    Locked(f64),
    /// Torque, and what is added to the diagonal of the mass matrix.
    Sliding { torque: f64, diagonal: f64 },
}

/// Axes add to the inputs of their group's joint, so these start from nothing.
pub(super) fn clear_balls(ws: &mut Workspace<f64>) {
    for input in &mut ws.ball_in {
        *input = Default::default();
    }
}

impl Law {
    /// First place: the riser it stood on, else by its speed.
    fn guess(&self, v: f64, memory: u8) -> usize {
        let risers = &self.risers[..self.count];
        if let Some(k) = risers.iter().position(|r| r.kinds & memory != 0) {
            return 2 * k + 1;
        }
        if let Some(k) = risers.iter().position(|r| r.speed == v) {
            return 2 * k + 1;
        }
        let flat = risers.iter().take_while(|r| r.speed < v).count();
        match (flat, risers.first(), risers.last()) {
            (0, Some(r), _) if r.left == f64::INFINITY => 1,
            (n, _, Some(r)) if n == self.count && r.right == f64::NEG_INFINITY => 2 * n - 1,
            (n, ..) => 2 * n,
        }
    }

    /// To which side the solution leaves this part of the law: −1 left, 0 not at all, +1 right.
    pub(super) fn step(&self, place: usize, v: f64, torque: f64) -> isize {
        let k = place / 2;
        if place % 2 == 1 {
            let r = &self.risers[k];
            let slack = FIT * (1.0 + torque.abs());
            return isize::from(torque < r.right - slack) - isize::from(torque > r.left + slack);
        }
        let slack = FIT * (1.0 + v.abs());
        let below = k > 0 && v < self.risers[k - 1].speed - slack;
        let above = k < self.count && v > self.risers[k].speed + slack;
        isize::from(above) - isize::from(below)
    }
}
