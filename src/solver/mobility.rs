//! How an axis answers to a torque with the whole robot free to move, its base too.

use super::AxisSet;
use crate::dynamics::{CHUNK, Push, Response, Workspace};
use crate::model::{AxisSlot, Model};

/// Responses of single axes. Makes its memory once.
#[derive(Clone, Debug)]
pub(super) struct Answers {
    response: Response,
    numbers: Vec<f64>,
    /// Per axis: body that carries it, and where its response lies.
    bodies: Vec<usize>,
    chunks: Vec<Vec<u32>>,
    /// The factor is that of the last pass.
    fresh: bool,
}

impl Answers {
    pub fn new(m: &Model) -> Self {
        let carrier = |v: usize| m.bodies.iter().rposition(|b| b.v <= v && v < b.v + b.joint.nv()).unwrap_or(0);
        let body = |axis: &crate::model::Axis| match axis.slot {
            AxisSlot::Scalar { v, .. } => carrier(v),
            AxisSlot::Euler { group, .. } => m.eulers[group].body,
            AxisSlot::Apart { .. } => 0,
        };
        let response = Response::new(m);
        let numbers = vec![0.0; response.layout.width() + CHUNK];
        let bodies: Vec<usize> = m.axes.iter().map(body).collect();
        let chunks = bodies.iter().map(|b| response.layout.chunks(*b).to_vec()).collect();
        Self { response, numbers, bodies, chunks, fresh: false }
    }

    /// Another pass has been made.
    pub fn forget(&mut self) {
        self.fresh = false;
    }
}

impl AxisSet {
    /// Acceleration of a sliding axis per torque: the diagonal of M̂⁻¹ with the laws of all axes at work. `q` (nq) is the state
    /// of the last pass.
    pub(super) fn whole_mobility(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], i: usize) -> f64 {
        let Some(mut answers) = self.answers.take() else { return 0.0 };
        let body = answers.bodies[i];
        let mut push = Push { body, ..Push::default() };
        match m.axes[i].slot {
            AxisSlot::Scalar { v, .. } => push.own[v - m.bodies[body].v] = 1.0,
            AxisSlot::Euler { group, angle } => {
                let g = self.rates[group].gradient[angle];
                (push.own[0], push.own[1], push.own[2]) = (g.x, g.y, g.z);
            }
            AxisSlot::Apart { .. } => {}
        }
        if !std::mem::replace(&mut answers.fresh, true) {
            answers.response.refresh(m, ws);
        }
        let Answers { response, numbers, chunks, .. } = &mut *answers;
        let to = (&chunks[i][..], &mut numbers[..]);
        let free = response.row(m, ws, q, &[push, Push::default()], to).free;
        self.answers = Some(answers);
        free
    }
}
