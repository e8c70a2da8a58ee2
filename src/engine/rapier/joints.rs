//! Joints: what holds the bodies together, and the rows of the axes.
//!
//! rapier's generic joint measures and turns about the axes of its *first* body's frame, and what it calls an angle is that of a
//! quaternion. So a joint of the model is several of rapier's, each of which is exact:
//!
//! | joint | held by | rows of its axes |
//! |---|---|---|
//! | revolute | 3 shifts, 2 turns | z of (parent, child) |
//! | prismatic | 2 shifts, 3 turns | shift along z of (parent, child) |
//! | universal | 3 shifts; a point on the child's second axis stays in the plane across the first | x of (parent, child), z of (child, parent) |
//! | spherical | 3 shifts | x of (child, parent), turned along the gradient of the angle in every step |
//!
//! Hinges and slides have motor and stops in the joint that holds them; the other axes have one joint for their motor, and one for their stops if they are hard.

use super::convert::{facing, frame};
use super::pairs::Pair;
use super::parts::{Parts, is_carried, is_soft};
use super::sim::{Sim, hard};
use crate::dynamics::{Kinematics, joint_transform, universal_axis};
use crate::engine::State;
use crate::engine::actuation::Actuation;
use crate::math::{M3, V3, sin_cos};
use crate::model::{AxisSlot, JointType, Model};
use crate::solver::Piece;
use rapier3d_f64::math::Pose;
use rapier3d_f64::prelude::{GenericJoint, ImpulseJointHandle, JointAxesMask, JointAxis, JointMotor, MotorModel};

/// A stop further away than this is out of reach of a step, rad: rapier measures angles up to half a turn.
const REACH: f64 = 1.0;

/// A stop further away than this, and than so many substeps at the present speed, is not looked at, rad or m.
const MARGIN: f64 = 0.05;
const AHEAD: f64 = 4.0;

/// All axes.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    rows: Vec<Option<Row>>,
    pairs: Vec<Pair>,
}

/// One axis in rapier.
#[derive(Clone, Debug)]
struct Row {
    along: Along,
    axis: JointAxis,
    /// The child is rapier's first body: speeds and torques have the other sign.
    swapped: bool,
    /// Bodies of the model.
    parent: usize,
    child: usize,
    motor: ImpulseJointHandle,
    stop: Option<ImpulseJointHandle>,
    /// Of a 3DOF angle: length of its gradient in this step; else 1.
    length: f64,
}

/// The direction along which the torque of an axis acts on the child, in the child's frame.
#[derive(Clone, Copy, Debug)]
enum Along {
    /// z.
    Last,
    /// First axis of a universal joint: turned back by the second angle, `q[..]`.
    First(usize),
    /// Gradient of an angle.
    Angle { group: usize, angle: usize },
    /// A force along z.
    Slide,
}

/// The next body that rapier has, towards the world, and the frame of a body's joint on it; `through`: behind the joint.
pub(super) fn seat(m: &Model, q: &[f64], body: usize, through: bool) -> (usize, Pose) {
    let b = &m.bodies[body];
    let own = if through { joint_transform(b, q) } else { (b.tree_r, b.tree_p) };
    let (mut parent, mut at) = (b.parent, frame(&own.0, own.1));
    while parent != 0 && is_carried(m, parent) {
        let (r, p) = joint_transform(&m.bodies[parent], q);
        at = frame(&r, p) * at;
        parent = m.bodies[parent].parent;
    }
    (parent, at)
}

/// Holds the bodies together as their joints do. Returns per body the joint that holds it.
fn hold_together(m: &Model, sim: &mut Sim, parts: &Parts, q: &[f64]) -> Vec<Option<ImpulseJointHandle>> {
    let mut holds = vec![None; m.bodies.len()];
    for i in (1..m.bodies.len()).filter(|i| !is_carried(m, *i)) {
        let soft = is_soft(m, i);
        let (parent, at) = seat(m, q, i, soft);
        let (lin, ang) = (JointAxesMask::LIN_AXES, JointAxesMask::ANG_AXES);
        let locked = match m.bodies[i].joint {
            _ if soft => lin | ang,
            JointType::Revolute => lin | JointAxesMask::ANG_X | JointAxesMask::ANG_Y,
            JointType::Prismatic => JointAxesMask::LIN_X | JointAxesMask::LIN_Y | ang,
            JointType::Universal | JointType::Spherical => lin,
            JointType::Floating => continue,
        };
        holds[i] = insert(sim, parts, (parent, at), (i, Pose::IDENTITY), locked);
        if m.bodies[i].joint == JointType::Universal {
            // z of the child stays across x of the parent: a point on it does.
            let point = frame(&M3::identity(), V3::new(0.0, 0.0, parts.gyration(i)));
            insert(sim, parts, (parent, at), (i, point), JointAxesMask::LIN_X);
        }
    }
    holds
}

/// A joint of two bodies of the model, each with its frame. Whether the two touch is not its business.
pub(super) fn insert(
    sim: &mut Sim,
    parts: &Parts,
    (first, frame1): (usize, Pose),
    (second, frame2): (usize, Pose),
    locked: JointAxesMask,
) -> Option<ImpulseJointHandle> {
    let joint = GenericJoint {
        local_frame1: frame1,
        local_frame2: frame2,
        locked_axes: locked,
        softness: hard(),
        contacts_enabled: true,
        ..GenericJoint::default()
    };
    Some(sim.joints.insert(parts.handles[first]?, parts.handles[second]?, joint, false))
}

impl Rows {
    /// Makes the rows of all axes whose joints are whole.
    pub fn new(m: &Model, sim: &mut Sim, parts: &Parts, q: &[f64]) -> Self {
        let holds = hold_together(m, sim, parts, q);
        let rows = (0..m.axes.len()).map(|axis| Row::new(m, sim, parts, (q, axis, &holds))).collect();
        let pairs = (0..m.eulers.len()).filter_map(|group| Pair::new(m, sim, parts, (q, group))).collect();
        Self { rows, pairs }
    }

    /// Sets the motors and stops of a step of `h` seconds at these poses; adds the constant torques to `loads`, per body.
    pub fn set(
        &mut self,
        m: &Model,
        sim: &mut Sim,
        laws: &Actuation,
        at: (&Kinematics, &State, f64),
        loads: &mut [Load],
    ) {
        let (k, state, h) = at;
        for (i, row) in self.rows.iter_mut().enumerate() {
            let Some(row) = row else { continue };
            let g = row.direction(laws, &state.q);
            row.length = g.dot(g).sqrt();
            let piece = laws.motor(i, h);
            row.set_motor(sim, g, &piece);
            match laws.stop(i) {
                Some(stop) if !is_near(stop, state.axis(m, i).1, h) => row.lift_stop(sim),
                Some(stop) => row.set_stop(sim, k, g, (state.axis(m, i).0, stop)),
                None => row.lift_stop(sim),
            }
            row.push(k, g * piece.torque, loads);
        }
        for pair in &self.pairs {
            pair.set(sim, laws, k, state);
        }
    }

    /// Per axis: what its motor and its stops gave in the last substep, which lasted `h` seconds and began with `state`, N·m or N.
    pub fn read(&self, sim: &Sim, (h, state): (f64, &State), motors: &mut [f64], stops: &mut [f64]) {
        for ((motor, stop), row) in motors.iter_mut().zip(stops.iter_mut()).zip(&self.rows) {
            (*motor, *stop) = row.as_ref().map_or((0.0, 0.0), |row| (row.torque(sim, h), row.reaction(sim, h)));
        }
        for pair in &self.pairs {
            pair.read(sim, h, state, stops);
        }
    }
}

/// May an axis come to a stop within a few substeps of `h` seconds?
fn is_near([low, high]: [f64; 2], v: f64, h: f64) -> bool {
    low.max(-high) > -(MARGIN + AHEAD * h * v.abs())
}

/// Sets the range in which a body may turn about `turned`'s x from where it is: the child is rapier's first body.
pub(super) fn watch(joint: &mut GenericJoint, relative: &M3<f64>, turned: &M3<f64>, [from, to]: [f64; 2]) {
    let range = |x: f64| x.clamp(-REACH, REACH);
    joint.limit_axes = JointAxesMask::ANG_X;
    joint.local_frame1.rotation = frame(turned, V3::default()).rotation;
    joint.local_frame2.rotation = frame(&relative.mm(turned), V3::default()).rotation;
    let own = &mut joint.limits[JointAxis::AngX as usize];
    (own.min, own.max) = (range(-to), range(-from));
}

/// What acts on a body, about its origin, along the world's axes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    pub force: V3<f64>,
    pub torque: V3<f64>,
}

impl Row {
    fn new(
        m: &Model,
        sim: &mut Sim,
        parts: &Parts,
        at: (&[f64], usize, &[Option<ImpulseJointHandle>]),
    ) -> Option<Self> {
        let (q, axis, holds) = at;
        let child = m.carrier(axis)?;
        let b = &m.bodies[child];
        let (along, row_axis, swapped) = match (m.axes[axis].slot, b.joint) {
            (AxisSlot::Euler { group, angle }, _) => (Along::Angle { group, angle }, JointAxis::AngX, true),
            (AxisSlot::Scalar { v, .. }, JointType::Universal) if v == b.v => {
                (Along::First(b.q + 1), JointAxis::AngX, false)
            }
            (_, JointType::Universal) => (Along::Last, JointAxis::AngZ, true),
            (_, JointType::Prismatic) => (Along::Slide, JointAxis::LinZ, false),
            _ => (Along::Last, JointAxis::AngZ, false),
        };
        let (parent, at) = seat(m, q, child, false);
        let (first, second) = ((parent, at), (child, Pose::IDENTITY));
        let (first, second) = if swapped { (second, first) } else { (first, second) };
        let joint = |sim: &mut Sim| insert(sim, parts, first, second, JointAxesMask::empty());
        // A hinge turns about the same axis as its joint: one joint for all. Its stops are solved with its locks then.
        let hinge = holds[child].filter(|_| matches!(b.joint, JointType::Revolute | JointType::Prismatic));
        let motor = hinge.or_else(|| joint(sim))?;
        let stop = if m.axes[axis].has_hard_stops() { hinge.or_else(|| joint(sim)) } else { None };
        Some(Self { along, axis: row_axis, swapped, parent, child, motor, stop, length: 1.0 })
    }

    /// In the child's frame: its length is 1, or that of the gradient of a 3DOF angle.
    fn direction(&self, laws: &Actuation, q: &[f64]) -> V3<f64> {
        match self.along {
            Along::Last | Along::Slide => V3::new(0.0, 0.0, 1.0),
            Along::First(second) => universal_axis(sin_cos(q[second])),
            Along::Angle { group, angle } => laws.gradient(group, angle),
        }
    }

    fn sign(&self) -> f64 {
        if self.swapped { -1.0 } else { 1.0 }
    }

    fn set_motor(&self, sim: &mut Sim, g: V3<f64>, piece: &Piece) {
        let Some(joint) = sim.joints.get_mut(self.motor, false) else { return };
        let mask = JointAxesMask::from(self.axis);
        // A motor without damping would be an infinitely stiff one.
        joint.data.motor_axes = if piece.damping > 0.0 && self.length > 0.0 { mask } else { JointAxesMask::empty() };
        let (l, finite) = (self.length, |x: f64| x.min(f64::MAX));
        joint.data.motors[self.axis as usize] = JointMotor {
            target_vel: self.sign() * piece.speed / l,
            target_pos: 0.0,
            stiffness: 0.0,
            damping: finite(piece.damping * l * l),
            max_force: finite(piece.bound * l),
            impulse: 0.0,
            model: MotorModel::ForceBased,
        };
        if let Along::Angle { .. } = self.along {
            joint.data.local_frame1 = frame(&facing(g * (1.0 / l)), V3::default());
        }
    }

    /// The range about the present position `q` that rapier watches, in its measure.
    fn set_stop(&self, sim: &mut Sim, k: &Kinematics, g: V3<f64>, (q, [low, high]): (f64, [f64; 2])) {
        let Some(joint) = self.stop.and_then(|stop| sim.joints.get_mut(stop, false)) else { return };
        if self.stop != Some(self.motor) {
            // It knows that the bodies turn about the joint, not each about its centre.
            joint.data.locked_axes = JointAxesMask::LIN_AXES;
        }
        if let Along::Angle { .. } = self.along {
            let turned = facing(g * (1.0 / self.length));
            let relative = k.r[self.parent].tmm(&k.r[self.child]);
            watch(&mut joint.data, &relative, &turned, [low / self.length, high / self.length]);
            return;
        }
        joint.data.limit_axes = JointAxesMask::from(self.axis);
        let reach = if let Along::Slide = self.along { f64::INFINITY } else { REACH };
        let (from, to) = (q + low.max(-reach).min(reach), q + high.min(reach).max(-reach));
        let limits = if self.swapped { [-to, -from] } else { [from, to] };
        let own = &mut joint.data.limits[self.axis as usize];
        (own.min, own.max) = (limits[0].max(f64::MIN), limits[1].min(f64::MAX));
    }

    /// No stop in this step: none is near, or it is that of H at the pole, where it is no axis of its own.
    fn lift_stop(&self, sim: &mut Sim) {
        if let Some(joint) = self.stop.and_then(|stop| sim.joints.get_mut(stop, false)) {
            joint.data.limit_axes = JointAxesMask::empty();
            if self.stop != Some(self.motor) {
                joint.data.locked_axes = JointAxesMask::empty();
            }
        }
    }

    /// Adds a constant torque, in the child's frame, to child and parent.
    fn push(&self, k: &Kinematics, torque: V3<f64>, loads: &mut [Load]) {
        let (child, parent) = (self.child, self.parent);
        let along = k.r[child].mv(torque);
        if let Along::Slide = self.along {
            // Both feel it at the child's origin.
            loads[child].force += along;
            loads[parent].force += -along;
            loads[parent].torque += -(k.p[child] - k.p[parent]).cross(along);
        } else {
            loads[child].torque += along;
            loads[parent].torque += -along;
        }
    }

    fn torque(&self, sim: &Sim, h: f64) -> f64 {
        let Some(joint) = sim.joints.get(self.motor) else { return 0.0 };
        if joint.data.motor_axes.is_empty() {
            return 0.0;
        }
        // rapier's impulse acts on its second body against the axis.
        -self.sign() * joint.data.motors[self.axis as usize].impulse / (h * self.length)
    }

    /// Of the stops.
    fn reaction(&self, sim: &Sim, h: f64) -> f64 {
        let Some(joint) = self.stop.and_then(|stop| sim.joints.get(stop)) else { return 0.0 };
        if joint.data.limit_axes.is_empty() {
            return 0.0;
        }
        -self.sign() * joint.data.limits[self.axis as usize].impulse / (h * self.length)
    }
}
