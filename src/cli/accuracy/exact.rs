//! The course of a smooth model in numbers of twice the digits: a reference that errs by less than any computation in f64.
//!
//! Gragg's midpoint rule, extrapolated to steps of zero (Hairer, Nørsett, Wanner: *Solving Ordinary Differential Equations I*, 1993, §II.9),
//! of fixed order and steps.

use crate::dynamics::{Workspace, aba_twofold};
use crate::math::{Real, Twofold};
use crate::model::{JointType, Model};

/// Rows of the extrapolation: the order is twice as much.
const ROWS: usize = 7;

/// Coordinates, then velocities.
type Course = Vec<Twofold>;

/// A model that nothing but gravity (m/s²) acts on.
pub(super) struct Exact<'a> {
    model: &'a Model,
    gravity: [f64; 3],
    ws: Workspace<Twofold>,
    /// None.
    tau: Vec<Twofold>,
}

impl<'a> Exact<'a> {
    /// Of the rule.
    pub const ORDER: usize = 2 * ROWS;

    /// # Errors
    /// Its coordinates are not integrals of its velocities.
    pub fn new(model: &'a Model, gravity: [f64; 3]) -> Result<Self, String> {
        let turns = |joint| matches!(joint, JointType::Spherical | JointType::Floating);
        if model.bodies.iter().skip(1).any(|b| turns(b.joint)) {
            return Err("a joint turns freely: its coordinates are no integrals of its velocities".into());
        }
        let tau = vec![Twofold::default(); model.nv];
        Ok(Self { model, gravity, ws: Workspace::new(model), tau })
    }

    /// Coordinates and velocities, rounded, after each of so many times `interval` seconds in so many steps.
    pub fn run(
        &mut self,
        (q, v): (&[f64], &[f64]),
        (instants, interval, steps): (usize, f64, u32),
    ) -> Vec<(Vec<f64>, Vec<f64>)> {
        let h = Twofold::of(interval) / Twofold::of(f64::from(steps));
        let mut y: Course = q.iter().chain(v).map(|x| Twofold::of(*x)).collect();
        let rounded = |y: &[Twofold]| y.iter().map(|x| x.value()).collect::<Vec<f64>>();
        let instant = |_| {
            (0..steps).for_each(|_| y = self.step(&y, h));
            let (q, v) = y.split_at(self.model.nq);
            (rounded(q), rounded(v))
        };
        (0..instants).map(instant).collect()
    }

    /// The rows of the table one after the other; of each only the last diagonal is kept.
    fn step(&mut self, y: &[Twofold], h: Twofold) -> Course {
        let mut diagonal: Vec<Course> = vec![];
        for row in 0..ROWS {
            diagonal.push(self.midpoints(y, h, substeps(row)));
            for k in (0..row).rev() {
                let ratio = Twofold::of(substeps(row)) / Twofold::of(substeps(k));
                let less = ratio * ratio - Twofold::of(1.0);
                let (coarse, fine) = diagonal.split_at_mut(k + 1);
                for (coarse, fine) in coarse[k].iter_mut().zip(&fine[0]) {
                    *coarse = *fine + (*fine - *coarse) / less;
                }
            }
        }
        diagonal.swap_remove(0)
    }

    /// The midpoint rule from one Euler step on: its error has even powers of the substep only.
    fn midpoints(&mut self, y: &[Twofold], h: Twofold, count: f64) -> Course {
        let part = h / Twofold::of(count);
        let along = |y: &[Twofold], rate: &[Twofold], h: Twofold| -> Course {
            y.iter().zip(rate).map(|(y, rate)| rate.mad(h, *y)).collect()
        };
        let mut before = y.to_vec();
        let mut now = along(y, &self.rate(y), part);
        for _ in 1..count as u32 {
            let next = along(&before, &self.rate(&now), part + part);
            before = std::mem::replace(&mut now, next);
        }
        now
    }

    fn rate(&mut self, y: &[Twofold]) -> Course {
        let (q, v) = y.split_at(self.model.nq);
        let mut rate = [v, &self.tau].concat();
        aba_twofold(self.model, &mut self.ws, (q, v), &self.tau, self.gravity, &mut rate[q.len()..]);
        rate
    }
}

/// 2, 4, 6 …
fn substeps(row: usize) -> f64 {
    2.0 * (row as f64 + 1.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test may panic

    use super::Exact;
    use crate::cli::accuracy::{Case, cases};

    fn chain() -> Case {
        cases().into_iter().find(|c| c.name == "chain5").unwrap()
    }

    /// Five links for 0.2 s: 2¹⁴ times nearer with half the step, until the digits of f64, in which it is told, end.
    #[test]
    fn it_has_its_order() {
        let world = (chain().make)().unwrap();
        let run = |steps| {
            let mut exact = Exact::new(world.model(), world.settings().gravity).unwrap();
            let (q, v) = exact.run((&world.state().q, &world.state().v), (1, 0.2, steps)).remove(0);
            [q, v].concat()
        };
        let right = run(32);
        let error = |steps| run(steps).iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let errors = [4, 6].map(error);
        let order = (errors[0] / errors[1]).ln() / 1.5_f64.ln();
        assert!((order - Exact::ORDER as f64).abs() < 2.0 && errors[1] > 1e-13, "{order}, {errors:?}");
        assert!(error(24) < 1e-14, "{:?}", error(24));
    }

    /// Two seconds of a chain that becomes chaotic: the energy stays to rounding, that of f64 in which it is computed from the state.
    #[test]
    fn energy_is_kept() {
        let case = chain();
        let mut world = (case.make)().unwrap();
        let mut state = world.state().clone();
        let energy = |w: &crate::world::World| w.energy().kinetic + w.energy().potential;
        let before = energy(&world);
        let model = world.model().clone();
        let mut exact = Exact::new(&model, world.settings().gravity).unwrap();
        for (q, v) in exact.run((&state.q, &state.v), (10, 0.2, 80)) {
            (state.q, state.v) = (q, v);
            world.set_initial_state(state.clone());
            let scale = world.energy().kinetic;
            assert!((energy(&world) - before).abs() < 1e-14 * (scale + 100.0), "{}", energy(&world) - before);
        }
    }

    #[test]
    fn what_turns_freely_is_refused() {
        let world = (cases().into_iter().find(|c| c.name == "torque_free").unwrap().make)().unwrap();
        assert!(Exact::new(world.model(), [0.0; 3]).is_err_and(|reason| reason.contains("turns freely")));
    }
}
