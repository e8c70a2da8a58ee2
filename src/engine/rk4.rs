//! The classical Runge–Kutta method of order 4.

use super::rbx::{Rbx, StepSettings, normalize_all};
use crate::dynamics::{aba_hybrid, coordinate_rates, damping_power};
use crate::model::Model;
use crate::solver::CouplingStage;

/// Buffers of the stages; made only when RK4 is chosen.
#[derive(Clone, Debug, Default)]
pub(super) struct Stages {
    rates: Vec<f64>,
    sum_q: Vec<f64>,
    sum_v: Vec<f64>,
}

impl Stages {
    pub fn new(m: &Model) -> Self {
        Self { rates: vec![0.0; m.nq], sum_q: vec![0.0; m.nq], sum_v: vec![0.0; m.nv] }
    }
}

impl Rbx {
    /// Quaternions are integrated as four numbers and made unit again at the end, which keeps the order. False if the step
    /// turned out not to be smooth; the state is then neither the old nor the new one.
    pub(super) fn rk4_stages(&mut self, m: &Model, s: &StepSettings, st: &mut Stages) -> bool {
        st.sum_q.fill(0.0);
        st.sum_v.fill(0.0);
        let mut damped = 0.0;
        for (stage, (ahead, weight)) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)].into_iter().enumerate() {
            if stage > 0 {
                go(&mut self.state.q, &self.before.q, ahead * s.h, &st.rates);
                go(&mut self.state.v, &self.before.v, ahead * s.h, &self.qdd);
                self.state.read_angles(m);
            }
            self.axes.write_smooth(m, &mut self.ws, self.state.as_ref());
            self.ws.frugal = stage > 0 && !self.axes.is_coupled();
            aba_hybrid(m, &mut self.ws, (&self.state.q, &self.state.v), s.gravity, &mut self.qdd);
            let at = CouplingStage { h: s.h, first: stage == 0 };
            let coupled = self.axes.couple_smooth(m, &mut self.ws, self.state.as_ref(), at, &mut self.qdd);
            if self.whirls_in(stage, s.h) {
                return false;
            }
            let soft_enough = stage > 0 || self.axes.is_soft_enough(m, &self.ws, &self.state.q, s.h);
            if !coupled || !soft_enough || !self.axes.stage_fits(m, &self.ws, &self.qdd) {
                return false;
            }
            coordinate_rates(m, &self.state.q, &self.state.v, &mut st.rates);
            accumulate(&mut st.sum_q, &st.rates, weight);
            accumulate(&mut st.sum_v, &self.qdd, weight);
            damped += weight * damping_power(&self.ws);
        }
        go(&mut self.state.q, &self.before.q, s.h / 6.0, &st.sum_q);
        go(&mut self.state.v, &self.before.v, s.h / 6.0, &st.sum_v);
        normalize_all(m, &mut self.state.q);
        self.state.read_angles(m);
        if !self.axes.stayed_smooth(m, self.state.as_ref()) {
            return false;
        }
        self.axes.books.work.losses -= s.h / 6.0 * damped;
        self.axes.finish_smooth(m, &self.ws, (self.state.as_ref(), s.h), &self.qdd);
        true
    }

    /// Do the accelerations of the first three stages change faster than the rule can follow?
    fn whirls_in(&mut self, stage: usize, h: f64) -> bool {
        let Some(whirl) = &mut self.whirl else { return false };
        match stage {
            0 => whirl.note(&self.qdd),
            1 => whirl.follow(&self.qdd),
            2 => return whirl.turns(&self.qdd, &self.state.v, (h, WHIRLS)),
            _ => {}
        }
        false
    }
}

/// RK4 is stable up to h |λ| = 2.8 and has lost its order long before; the changes of its stages are h / 2 apart.
const WHIRLS: f64 = 0.5;

fn go(x: &mut [f64], from: &[f64], h: f64, rates: &[f64]) {
    for (x, (x0, r)) in x.iter_mut().zip(from.iter().zip(rates)) {
        *x = x0 + h * r;
    }
}

fn accumulate(sum: &mut [f64], x: &[f64], weight: f64) {
    for (s, x) in sum.iter_mut().zip(x) {
        *s += weight * x;
    }
}
