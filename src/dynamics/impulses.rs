//! The reverse of the rows: what forces on several bodies together do to all accelerations, in one inward and one outward
//! pass over the bodies that it concerns.

use super::articulated::Spatial;
use super::joint::universal_axis;
use super::response::{Walk, add, eliminate, spatial, to_parent};
use super::{Push, Response, Workspace, aba::joint_transform_p};
use crate::math::{Real, V3};
use crate::model::{JointType, Model};

/// What is kept per body between [`Response::push`] and the end of the passes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    force: Spatial<f64>,
    /// Forces along the coordinates of its joint; after the inward pass the whole load of each.
    own: [f64; 6],
    /// Does a force act on it or on what it carries?
    pushed: bool,
    /// What the acceleration of its parent does to the load of its joint.
    reach: [f64; 6],
    /// Change of its acceleration.
    change: Spatial<f64>,
    moves: bool,
}

impl Response {
    /// Notes a force for [`Response::apply`] or [`Response::velocity`].
    pub fn push(&mut self, push: &Push, factor: f64) {
        let load = &mut self.load[push.body];
        load.pushed = true;
        load.force.a += push.torque * factor;
        load.force.l += push.force * factor;
        for (to, from) in load.own.iter_mut().zip(push.own) {
            *to += from * factor;
        }
    }

    /// Adds what the forces noted since the last call do: to the accelerations `qdd` (nv) and to the workspace, which
    /// afterwards is as if they had been among the inputs of the dynamics. The reaction of a lock is what it has to
    /// give beside them.
    pub fn apply(&mut self, m: &Model, ws: &mut Workspace<f64>, q: &[f64], qdd: &mut [f64]) {
        self.passes(m, ws, q, qdd);
        for i in 1..m.bodies.len() {
            if self.load[i].moves {
                self.book(m, ws, i);
            }
        }
        self.load.fill(Load::default());
    }

    /// Adds `M̂⁻¹ φ` of the forces noted since the last call to `out` (nv), and leaves the workspace as it is: the change of
    /// velocity if they are impulses.
    pub fn velocity(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], out: &mut [f64]) {
        self.passes(m, ws, q, out);
        self.load.fill(Load::default());
    }

    fn passes(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], out: &mut [f64]) {
        for i in (1..m.bodies.len()).rev() {
            if self.load[i].pushed {
                self.inward(m, ws, q, i);
            }
        }
        for i in 1..m.bodies.len() {
            if self.load[i].pushed || self.load[m.bodies[i].parent].moves {
                self.outward(m, ws, q, i, out);
            }
        }
    }

    fn inward(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], i: usize) {
        let parent = m.bodies[i].parent;
        let walk = Walk { body: i, force: self.load[i].force, own: self.load[i].own };
        let (u, rest) = eliminate(m, ws, q, &walk);
        self.load[i].own = u;
        if parent != 0 {
            let given = to_parent(m, ws, q, i, rest);
            let parent = &mut self.load[parent];
            parent.pushed = true;
            parent.force.a += given.a;
            parent.force.l += given.l;
        }
    }

    fn outward(&mut self, m: &Model, ws: &Workspace<f64>, q: &[f64], i: usize, out: &mut [f64]) {
        let b = &m.bodies[i];
        let (from, u, mut reach) = (self.load[b.parent].change, self.load[i].own, [0.0; 6]);
        let (r, p) = (ws.kin[i].r, joint_transform_p(b, q));
        let mut change = Spatial { a: r.tv(from.a), l: r.tv(from.a.cross_add(p, from.l)) };
        let mut scalar = |k: usize, a: Spatial<f64>| {
            let d = &ws.dof[b.v + k];
            reach[k] = d.ua.dot(a.a) + d.ul.dot(a.l);
            let change = d.d * (u[k] - reach[k]);
            out[b.v + k] += change;
            change
        };
        match b.joint {
            JointType::Revolute => change.a.z += scalar(0, change),
            JointType::Prismatic => change.l.z += scalar(0, change),
            JointType::Universal => {
                change.a = universal_axis(Real::sin_cos(q[b.q + 1])).mad(scalar(0, change), change.a);
                change.a.z += scalar(1, change);
            }
            JointType::Spherical => {
                let ball = &ws.balls[b.ball];
                let held = ball.reach(change);
                let x = ball.yielding(V3::new(u[0], u[1], u[2])).0 - ball.yielding(held).0;
                reach[..3].copy_from_slice(&[held.x, held.y, held.z]);
                add(&mut out[b.v..b.v + 3], [x.x, x.y, x.z]);
                change.a += x;
            }
            JointType::Floating => {
                let x = self.floats[self.float_of[i]].acceleration(spatial(&u));
                let (a, l) = (x.a - change.a, x.l - change.l);
                add(&mut out[b.v..b.v + 6], [a.x, a.y, a.z, l.x, l.y, l.z]);
                change = x;
            }
        }
        let load = &mut self.load[i];
        (load.reach, load.change, load.moves) = (reach, change, true);
    }

    /// Writes what a body's load and motion came to into the workspace.
    fn book(&mut self, m: &Model, ws: &mut Workspace<f64>, i: usize) {
        let (b, load) = (&m.bodies[i], &self.load[i]);
        ws.acc[i].n -= load.force.a;
        ws.acc[i].f -= load.force.l;
        ws.kin[i].w += load.change.a;
        ws.kin[i].v += load.change.l;
        let (u, reach) = (load.own, load.reach);
        match b.joint {
            JointType::Revolute | JointType::Prismatic | JointType::Universal => {
                for (k, v) in (b.v..b.v + b.joint.nv()).enumerate() {
                    ws.dof[v].x += ws.dof[v].d * u[k];
                    ws.dof[v].own -= u[k];
                    ws.reaction[v] += reach[k] - u[k];
                }
            }
            JointType::Spherical => {
                let ball = &mut ws.balls[b.ball];
                ball.add(V3::new(u[0], u[1], u[2]), V3::new(reach[0], reach[1], reach[2]));
                ws.ball_in[b.ball].react(ball);
            }
            JointType::Floating => {
                let x = self.floats[self.float_of[i]].acceleration(spatial(&u));
                add_to(&mut ws.dof[b.v..b.v + 6], [x.a.x, x.a.y, x.a.z, x.l.x, x.l.y, x.l.z]);
            }
        }
    }
}

fn add_to(dof: &mut [super::Dof<f64>], x: [f64; 6]) {
    for (d, x) in dof.iter_mut().zip(x) {
        d.x += x;
    }
}
