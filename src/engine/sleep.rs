//! Bodies at rest leave the computation (B-9), tree by tree: a tree that rests is neither moved nor asked for forces. It comes
//! back when a command of one of its axes changes, gravity changes, something that moves touches it, or a tree that it
//! touches comes back.

use super::rbx::{Rbx, StepSettings};
use crate::dynamics::{Kinematics, kinematics};
use crate::math::V3;
use crate::model::{Deactivation, LinkFrame, Model};
use crate::solver::AxisCommand;

/// A touch counts for waking if it would close within this many steps.
const AHEAD: f64 = 2.0;

/// The trees of a model and how long each has been slow. Makes its memory once.
#[derive(Clone, Debug)]
pub(super) struct Sleep {
    trees: Vec<Tree>,
    /// Per body: its tree; of the world, none.
    tree_of: Vec<usize>,
    kinematics: Kinematics,
    /// Those that the resting trees came to rest with.
    commands: Vec<AxisCommand>,
    gravity: [f64; 3],
}

#[derive(Clone, Debug)]
struct Tree {
    bodies: Vec<usize>,
    axes: Vec<usize>,
    /// Per body that has mass: when it is slow; empty if the tree never rests.
    limits: Vec<(usize, Deactivation)>,
    /// How long all its bodies have been slow, s.
    slow: f64,
    after: f64,
    rests: bool,
}

impl Sleep {
    /// `None` if no tree ever rests.
    pub fn new(m: &Model) -> Option<Self> {
        if !m.effects.deactivation {
            return None;
        }
        let (trees, tree_of) = trees(m);
        trees.iter().any(|t| !t.limits.is_empty()).then(|| Self {
            trees,
            tree_of,
            kinematics: Kinematics::new(m),
            commands: vec![AxisCommand::IDLE; m.axes.len()],
            gravity: [0.0; 3],
        })
    }

    pub fn reset(&mut self) {
        for tree in &mut self.trees {
            (tree.slow, tree.rests) = (0.0, false);
        }
    }

    /// Does nothing move at all?
    fn is_all(&self) -> bool {
        self.trees.iter().all(|t| t.rests)
    }

    /// Adds the time to trees that are slow; those that are not start anew.
    fn observe(&mut self, m: &Model, h: f64) {
        let k = &self.kinematics;
        for tree in &mut self.trees {
            let slow = |(body, limit): &(usize, Deactivation)| {
                let b = &m.bodies[*body];
                let center = k.v[*body] + k.w[*body].cross(b.mc * (1.0 / b.mass));
                size(center) <= limit.linear && size(k.w[*body]) <= limit.angular
            };
            let still = !tree.limits.is_empty() && tree.limits.iter().all(slow);
            tree.slow = if still { tree.slow + h } else { 0.0 };
        }
    }

    /// Trees that touch each other rest, and come back, together.
    fn settle(&mut self, touches: impl Iterator<Item = [usize; 2]> + Clone) {
        for tree in &mut self.trees {
            tree.rests = !tree.limits.is_empty() && tree.slow > tree.after;
        }
        self.spread(touches, |tree| tree.rests = false);
    }

    /// As long as one of two trees that touch rests and the other does not, wakes both.
    fn spread(&mut self, touches: impl Iterator<Item = [usize; 2]> + Clone, wake: impl Fn(&mut Tree)) {
        for _ in 0..self.trees.len() {
            let mut changed = false;
            for pair in touches.clone().map(|bodies| bodies.map(|b| self.tree_of[b])) {
                let [Some(x), Some(y)] = pair.map(|tree| self.trees.get(tree)) else { continue };
                if x.rests != y.rests {
                    pair.iter().for_each(|tree| wake(&mut self.trees[*tree]));
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
    }
}

impl Rbx {
    /// Wakes the trees whose commands or weight have changed; true if nothing is left to be moved.
    pub(super) fn rests(&mut self, m: &Model, commands: &[AxisCommand], gravity: [f64; 3]) -> bool {
        let Some(mut sleep) = self.sleep.take() else { return false };
        let heavier = sleep.gravity != gravity;
        let mut woken = false;
        for tree in &mut sleep.trees {
            let ordered = |axis: &usize| !same(&sleep.commands[*axis], &commands[*axis]);
            if heavier || tree.axes.iter().any(ordered) {
                woken |= tree.rests;
                (tree.slow, tree.rests) = (0.0, false);
            }
        }
        sleep.gravity = gravity;
        sleep.commands.copy_from_slice(commands);
        if woken {
            // Those that touch a woken tree wake with it.
            let touches = self.axes.contacts().into_iter().flat_map(|c| c.touching_bodies());
            sleep.spread(touches, |tree| (tree.slow, tree.rests) = (0.0, false));
            self.take_part(m, &sleep);
        }
        let all = sleep.is_all();
        self.sleep = Some(sleep);
        all
    }

    /// After a step: which trees rest from here on.
    pub(super) fn observe(&mut self, m: &Model, s: &StepSettings) {
        let Some(mut sleep) = self.sleep.take() else { return };
        kinematics(m, &mut sleep.kinematics, &self.state.q, &self.state.v);
        let before: usize = sleep.trees.iter().filter(|t| t.rests).count();
        sleep.observe(m, s.h);
        let k = std::mem::take(&mut sleep.kinematics);
        let contacts = self.axes.contacts();
        sleep.settle(contacts.into_iter().flat_map(|c| c.near(&k, AHEAD * s.h)));
        sleep.kinematics = k;
        if before > 0 || sleep.trees.iter().any(|t| t.rests) {
            self.take_part(m, &sleep);
        }
        self.sleep = Some(sleep);
    }

    /// Tells the kernel and the axes who takes part; what rests stands still to the last bit.
    fn take_part(&mut self, m: &Model, sleep: &Sleep) {
        self.ws.active.clear();
        let rests = |body: usize| sleep.trees[sleep.tree_of[body]].rests;
        for body in 1..m.bodies.len() {
            if rests(body) {
                let b = &m.bodies[body];
                self.state.v[b.v..b.v + b.joint.nv()].fill(0.0);
                self.qdd[b.v..b.v + b.joint.nv()].fill(0.0);
            } else if let Some(last) = self.ws.active.last_mut().filter(|last| last.1 == body) {
                last.1 = body + 1;
            } else {
                self.ws.active.push((body, body + 1));
            }
        }
        for tree in &sleep.trees {
            for axis in &tree.axes {
                self.axes.resting[*axis] = tree.rests;
            }
        }
        self.axes.rest(|body| body > 0 && rests(body));
        self.forget();
    }
}

/// The trees, and of each body its own.
fn trees(m: &Model) -> (Vec<Tree>, Vec<usize>) {
    let mut trees: Vec<Tree> = vec![];
    let mut tree_of = vec![usize::MAX; m.bodies.len()];
    for (i, b) in m.bodies.iter().enumerate().skip(1) {
        if b.parent == 0 {
            tree_of[i] = trees.len();
            trees.push(Tree { bodies: vec![], axes: vec![], limits: vec![], slow: 0.0, after: 0.0, rests: false });
        } else {
            tree_of[i] = tree_of[b.parent];
        }
        trees[tree_of[i]].bodies.push(i);
    }
    for axis in 0..m.axes.len() {
        if let Some(body) = m.carrier(axis) {
            trees[tree_of[body]].axes.push(axis);
        }
    }
    for tree in &mut trees {
        let heavy = || tree.bodies.iter().filter(|b| m.bodies[**b].mass > 0.0);
        let limits: Vec<_> = heavy().filter_map(|b| Some((*b, limit(m, *b)?))).collect();
        if limits.len() == heavy().count() {
            tree.after = limits.iter().map(|(_, l)| l.after).fold(0.0, f64::max);
            tree.limits = limits;
        }
    }
    (trees, tree_of)
}

/// That of the link nearest the root on a body (J-6); none while the effect is off.
pub(super) fn limit(m: &Model, body: usize) -> Option<Deactivation> {
    let on_it = |l: &&crate::model::LinkInfo| matches!(l.frame, LinkFrame::OnBody { body: b, .. } if b == body);
    let links = || m.links.iter().filter(on_it);
    let nearest = links().find(|l| l.parent.is_none_or(|p| !on_it(&&m.links[p]))).or_else(|| links().next())?;
    nearest.deactivation.filter(|_| m.effects.deactivation)
}

fn size(v: V3<f64>) -> f64 {
    v.dot(v).sqrt()
}

/// NaN means "not given".
pub(super) fn same(a: &AxisCommand, b: &AxisCommand) -> bool {
    let equal = |x: f64, y: f64| x == y || (x.is_nan() && y.is_nan());
    a.mode == b.mode && equal(a.torque, b.torque) && equal(a.speed, b.speed) && equal(a.target, b.target)
}

impl Rbx {
    /// Something has changed from outside (a state, a drive): nothing rests.
    pub fn wake(&mut self, m: &Model) {
        if let Some(mut sleep) = self.sleep.take() {
            sleep.reset();
            self.take_part(m, &sleep);
            self.sleep = Some(sleep);
        }
    }

    /// Trees that rest, of all; for display.
    pub fn resting(&self) -> (usize, usize) {
        self.sleep.as_ref().map_or((0, 0), |s| (s.trees.iter().filter(|t| t.rests).count(), s.trees.len()))
    }
}
