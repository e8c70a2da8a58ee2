//! How single axes answer to a torque while all axes are free: what engines that do not solve the laws need to know.

use super::seat::Seat;
use crate::dynamics::{BallIn, CHUNK, DofIn, Push, Response, Workspace, aba_hybrid};
use crate::model::{AxisSlot, EulerRates, Model};

/// Accelerations and responses of a model whose axes are all free. Makes its memory once.
#[derive(Clone, Debug)]
pub struct FreeMobility {
    ws: Workspace<f64>,
    response: Response,
    numbers: Vec<f64>,
    /// Per axis: where it is, and the chunks of its response; `None` if its joint has come apart.
    seats: Vec<Option<(Seat, Vec<u32>)>>,
    /// Velocities (nv): none.
    still: Vec<f64>,
    qdd: Vec<f64>,
}

impl FreeMobility {
    /// Room for this model.
    pub fn new(m: &Model) -> Self {
        let response = Response::new(m);
        let numbers = vec![0.0; response.layout.width() + CHUNK];
        let seat = |axis| Seat::of(m, axis).map(|s| (s, response.layout.chunks(s.body()).to_vec()));
        let seats = (0..m.axes.len()).map(seat).collect();
        Self { ws: Workspace::new(m), response, numbers, seats, still: vec![0.0; m.nv], qdd: vec![0.0; m.nv] }
    }

    /// Factors the mass matrix at the coordinates `q` (nq), with these inertias of rotors (per axis) beside; directions in which
    /// joints yield are locked.
    pub fn refresh(&mut self, m: &Model, q: &[f64], rotors: impl Iterator<Item = f64>) {
        self.ws.dofs.fill(DofIn::free(0.0));
        self.ws.ball_in.fill(BallIn::default());
        for soft in &m.softs {
            self.ws.dofs[soft.v] = DofIn::locked(0.0);
        }
        for (axis, rotor) in m.axes.iter().zip(rotors) {
            if let AxisSlot::Scalar { v, .. } = axis.slot {
                self.ws.dofs[v] = DofIn::implicit(0.0, rotor);
            }
        }
        // Only the factor counts: without velocities, the accelerations say nothing.
        aba_hybrid(m, &mut self.ws, (q, &self.still), [0.0; 3], &mut self.qdd);
        self.response.refresh(m, &self.ws);
    }

    /// Acceleration of an axis per torque on it, 1/(kg·m²) or 1/kg. `q` and the rates of the 3DOF groups are those of the last
    /// [`FreeMobility::refresh`].
    pub fn of(&mut self, m: &Model, q: &[f64], rates: &[EulerRates], axis: usize) -> f64 {
        let Some((seat, chunks)) = &self.seats[axis] else { return 0.0 };
        let push = seat.push(&m.axes[axis].slot, rates, 1.0);
        let room = (&chunks[..], &mut self.numbers[..]);
        self.response.row(m, &self.ws, q, &[push, Push::default()], room).free
    }
}
