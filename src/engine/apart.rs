//! A joint comes apart: the model and the state that are left, with every link where it was and moving as it did.

use super::{Integrator, Rbx, State};
use crate::dynamics::{Kinematics, body_pose, kinematics, link_pose};
use crate::math::{M3, V3};
use crate::model::{AxisSlot, Body, EulerFrame, JointType, LinkFrame, Model, SoftDof};

/// The model without the joint of `body`, and its state.
///
/// The body goes on as a floating one on the world, with all that hangs on it. The axes of the joint are
/// [`AxisSlot::Apart`], at their last positions. Bodies without mass on which nothing hangs any more (what a soft joint adds,
/// links inside a group) are taken out; their links stay where they are on what carried them. The order of axes, links
/// and of the other bodies stays. Poses, twists, momentum and energy are those of before, but for rounding.
///
/// Allocates: a joint comes apart once.
pub fn come_apart(m: &Model, s: &State, body: usize) -> (Model, State) {
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &s.q, &s.v);
    Cut::new(m, body).made(s, &k)
}

/// No body.
const NONE: usize = usize::MAX;

/// Which bodies stay, and where they are afterwards.
pub(super) struct Cut<'a> {
    m: &'a Model,
    /// The one whose joint comes apart; [`NONE`]: no joint does.
    body: usize,
    /// Per body: its index afterwards.
    index: Vec<Option<usize>>,
}

impl<'a> Cut<'a> {
    fn new(m: &'a Model, body: usize) -> Self {
        let mut stays = vec![false; m.bodies.len()];
        stays[0] = true;
        for (i, b) in m.bodies.iter().enumerate().skip(1).rev() {
            stays[i] |= b.mass > 0.0 || b.inertia.xx + b.inertia.yy + b.inertia.zz > 0.0;
            stays[b.parent] |= stays[i] && i != body;
        }
        Self { m, body, index: numbers(&stays) }
    }

    /// The bodies that do not stay are gone, with their axes.
    pub fn without(m: &'a Model, stays: &[bool]) -> Self {
        Self { m, body: NONE, index: numbers(stays) }
    }

    /// The model afterwards and its state; `k` belongs to the state before.
    pub fn made(&self, s: &State, k: &Kinematics) -> (Model, State) {
        let mut left = Model { nq: 0, nv: 0, balls: 0, ..self.m.clone() };
        left.bodies = self.bodies(&mut left).into();
        let state = self.state(&left, s, k);
        left.eulers = self.m.eulers.iter().filter_map(|e| self.euler(&left, e)).collect();
        left.softs = self.m.softs.iter().filter_map(|soft| self.soft(&left, soft)).collect();
        left.dampings.retain_mut(|d| self.index[d.body].map(|new| d.body = new).is_some());
        left.breakables.retain_mut(|b| self.intact(b.body).map(|new| b.body = new).is_some());
        for axis in 0..self.m.axes.len() {
            left.axes[axis].slot = self.slot(&left, axis, s);
        }
        let apart = |axis: usize| matches!(left.axes[axis].slot, AxisSlot::Apart { .. });
        left.couplings.retain(|c| !apart(c.follower) && !apart(c.leader));
        self.reseat(&mut left, s, k);
        (left, state)
    }

    /// Index afterwards of a body that stays and whose joint does not come apart.
    fn intact(&self, body: usize) -> Option<usize> {
        self.index[body].filter(|_| body != self.body)
    }

    /// The bodies afterwards; counts the coordinates of `left`.
    fn bodies(&self, left: &mut Model) -> Vec<Body> {
        let staying = self.m.bodies.iter().enumerate().filter(|(i, _)| self.index[*i].is_some());
        staying
            .map(|(i, b)| {
                if i == 0 {
                    return b.clone();
                }
                let mut b = if i == self.body { set_free(b) } else { b.clone() };
                b.parent = self.index[b.parent].unwrap_or(0);
                (b.q, b.v, b.ball) = (left.nq, left.nv, left.balls);
                left.nq += b.joint.nq();
                left.nv += b.joint.nv();
                left.balls += usize::from(b.joint == JointType::Spherical);
                b
            })
            .collect()
    }

    fn state(&self, left: &Model, s: &State, k: &Kinematics) -> State {
        let mut state = State { q: vec![0.0; left.nq], v: vec![0.0; left.nv], angles: vec![] };
        for (i, old) in self.m.bodies.iter().enumerate().skip(1) {
            let Some(new) = self.index[i].map(|n| &left.bodies[n]) else { continue };
            let (q, v) = (&mut state.q[new.q..][..new.joint.nq()], &mut state.v[new.v..][..new.joint.nv()]);
            if i == self.body {
                let (p, r) = (k.p[i], body_pose(k, i).rotation);
                q.copy_from_slice(&[p.x, p.y, p.z, r.w, r.i, r.j, r.k]);
                v.copy_from_slice(&[k.w[i].x, k.w[i].y, k.w[i].z, k.v[i].x, k.v[i].y, k.v[i].z]);
            } else {
                q.copy_from_slice(&s.q[old.q..][..old.joint.nq()]);
                v.copy_from_slice(&s.v[old.v..][..old.joint.nv()]);
            }
        }
        let groups = self.m.eulers.iter().zip(&s.angles).filter(|(e, _)| self.intact(e.body).is_some());
        state.angles = groups.map(|(_, angles)| *angles).collect();
        state
    }

    fn euler(&self, left: &Model, e: &EulerFrame) -> Option<EulerFrame> {
        let body = self.intact(e.body)?;
        Some(EulerFrame { body, q: left.bodies[body].q, v: left.bodies[body].v, ..e.clone() })
    }

    fn soft(&self, left: &Model, soft: &SoftDof) -> Option<SoftDof> {
        let body = &left.bodies[self.intact(self.m.body_of(soft.v)?)?];
        Some(SoftDof { q: body.q, v: body.v, ..*soft })
    }

    /// Where the coordinates of an axis are afterwards.
    fn slot(&self, left: &Model, axis: usize, s: &State) -> AxisSlot {
        let slot = match self.m.axes[axis].slot {
            AxisSlot::Scalar { q, v } => {
                let owner = self.m.body_of(v).unwrap_or(0);
                let (old, new) = (&self.m.bodies[owner], self.intact(owner).map(|n| &left.bodies[n]));
                new.map(|new| AxisSlot::Scalar { q: new.q + q - old.q, v: new.v + v - old.v })
            }
            AxisSlot::Euler { group, angle } => {
                let body = self.intact(self.m.eulers[group].body);
                let group = body.and_then(|body| left.eulers.iter().position(|e| e.body == body));
                group.map(|group| AxisSlot::Euler { group, angle })
            }
            AxisSlot::Apart { .. } => None,
        };
        slot.unwrap_or(AxisSlot::Apart { position: s.axis(self.m, axis).0 })
    }

    /// Puts the links on the bodies that are left. What the joint carried has no parent any more.
    fn reseat(&self, left: &mut Model, s: &State, k: &Kinematics) {
        for (i, (link, old)) in left.links.iter_mut().zip(&self.m.links).enumerate() {
            let carried = |l: &LinkFrame| matches!(l, LinkFrame::OnBody { body, .. } if *body == self.body);
            if carried(&old.frame) && !old.parent.is_some_and(|p| carried(&self.m.links[p].frame)) {
                link.parent = None;
            }
            let at = match &mut link.frame {
                LinkFrame::OnBody { body, .. } => self.index[*body].map(|new| *body = new).ok_or(*body),
                LinkFrame::InGroup { body, .. } => {
                    let group = *body;
                    self.intact(group).map(|new| *body = new).ok_or(self.m.bodies[group].parent)
                }
            };
            if let Err(from) = at {
                let (body, index) = self.nearest(from);
                let offset = body_pose(k, body).inv_mul(&link_pose(self.m, k, &s.q, &s.angles, i));
                link.frame = LinkFrame::OnBody { body: index, offset };
            }
        }
    }

    /// The body itself, or the nearest that carried it, that stays; and its index afterwards.
    fn nearest(&self, mut body: usize) -> (usize, usize) {
        loop {
            match self.index[body] {
                Some(index) => return (body, index),
                None if body == self.body => body = 0,
                None => body = self.m.bodies[body].parent,
            }
        }
    }
}

/// Indices of what stays, in the same order.
fn numbers(stays: &[bool]) -> Vec<Option<usize>> {
    let mut count = 0;
    let number = |stays: &bool| {
        count += usize::from(*stays);
        stays.then(|| count - 1)
    };
    stays.iter().map(number).collect()
}

/// The body as a floating one on the world.
fn set_free(b: &Body) -> Body {
    Body {
        parent: 0,
        joint: JointType::Floating,
        tree_r: M3::identity(),
        tree_p: V3::default(),
        along: None,
        ..b.clone()
    }
}

impl Rbx {
    /// Goes on with what is left of the model; what it remembers of each axis stays. Allocates.
    pub fn refit(&mut self, left: &Model, state: State, integrator: Integrator) {
        let mut next = Self::new(left);
        next.state = state;
        next.axes = self.axes.clone();
        next.axes.refit(left);
        next.prepare(left, integrator);
        *self = next;
    }
}
