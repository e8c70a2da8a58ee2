//! States in which every follower is where its leader puts it.

use super::State;
use crate::model::Model;

/// Difference of a follower from where its leader puts it that counts as none, rad or m, relative.
const AGREES: f64 = 1e-9;

impl State {
    /// Moves the followers (`<mimic>`) to where their leaders put them, with their speeds. Nothing happens if the effect is
    /// off.
    pub fn couple(&mut self, m: &Model) {
        for c in m.couplings_in_force() {
            let (q, v) = self.axis(m, c.leader);
            self.set_axis(m, c.follower, c.position(q), c.ratio * v);
        }
    }

    /// Moves the leaders to where they and their followers are inside their ranges, next to where they are.
    pub(super) fn couple_in_range(&mut self, m: &Model) {
        for c in m.couplings_in_force() {
            let (lower, upper) = m.common_range(c.leader);
            let (q, v) = self.axis(m, c.leader);
            let inside = q.min(upper).max(lower);
            if inside != q && c.leader != c.follower {
                self.set_axis(m, c.leader, inside, v);
            }
        }
        self.couple(m);
    }

    /// As [`State::couple`], after the axes `given` have been set: a follower among them moves its leader, unless that is
    /// given as well.
    ///
    /// # Errors
    /// Names two axes that are given and contradict each other, with what the coupling asks for.
    pub fn couple_given(&mut self, m: &Model, given: &[usize]) -> Result<(), String> {
        let mut led = given.to_vec();
        for c in m.couplings_in_force() {
            if given.contains(&c.follower) && !led.contains(&c.leader) && c.ratio != 0.0 {
                let (q, v) = self.axis(m, c.follower);
                self.set_axis(m, c.leader, c.leader_position(q).unwrap_or(0.0), v / c.ratio);
                led.push(c.leader);
            }
        }
        let before = self.clone();
        self.couple(m);
        for c in m.couplings_in_force().iter().filter(|c| given.contains(&c.follower)) {
            let ((q, v), (has, speed)) = (self.axis(m, c.follower), before.axis(m, c.follower));
            let differs = |a: f64, b: f64| (a - b).abs() > AGREES * (1.0 + a.abs());
            if differs(q, has) || differs(v, speed) {
                let (follower, leader) = (&m.axes[c.follower].name, &m.axes[c.leader].name);
                return Err(format!(
                    "'{follower}' follows '{leader}': it would have to be at {q} with speed {v}, but is given {has} with \
                     speed {speed}; leave one of the two out"
                ));
            }
        }
        Ok(())
    }
}
