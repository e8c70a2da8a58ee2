//! How an axis answers to a torque with the whole robot free to move, its base too.

use super::AxisSet;
use super::seat::Seat;
use crate::dynamics::{CHUNK, Push, Response, Workspace};
use crate::model::Model;

/// Responses of single axes. Makes its memory once.
#[derive(Clone, Debug)]
pub(super) struct Answers {
    response: Response,
    numbers: Vec<f64>,
    /// Per axis: where it is, and the chunks of its response; `None` if its joint has come apart.
    seats: Vec<Option<(Seat, Vec<u32>)>>,
    /// The factor is that of the last pass.
    fresh: bool,
}

impl Answers {
    pub fn new(m: &Model) -> Self {
        let response = Response::new(m);
        let numbers = vec![0.0; response.layout.width() + CHUNK];
        let seat = |axis| Seat::of(m, axis).map(|s| (s, response.layout.chunks(s.body()).to_vec()));
        let seats = (0..m.axes.len()).map(seat).collect();
        Self { response, numbers, seats, fresh: false }
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
        let Answers { response, numbers, seats, fresh } = &mut *answers;
        if !std::mem::replace(fresh, true) {
            response.refresh(m, ws);
        }
        let free = seats[i].as_ref().map_or(0.0, |(seat, chunks)| {
            let push = self.push_of(m, i, *seat, 1.0);
            response.row(m, ws, q, &[push, Push::default()], (chunks, &mut numbers[..])).free
        });
        self.answers = Some(answers);
        free
    }
}
