//! Description + mass properties → Model.

mod axis;
mod soften;

use super::chain::chains;
use super::membership::memberships;
use super::rig::rigs;
use super::{
    AxisSlot, Bodies, Body, Deactivation, Effects, EulerFrame, JointType, LinkFrame, LinkInfo, Model, Softness,
};
use crate::description::{Description, GroupKind, Joint, JointKind, Link};
use crate::mass::MassProperties;
use crate::math::{M3, Mat3, Pose, Quat, S3, V3, Vec3};
use nalgebra::{Rotation3, Translation3, UnitQuaternion};
use soften::{BETWEEN, HINGE, POINT, SLIDE, WELD, facing};
use std::collections::HashMap;

/// How the root link is held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Base {
    /// On a test stand.
    #[default]
    Fixed,
    /// Six free degrees of freedom.
    Free,
}

impl Model {
    /// Builds the model of a checked description; `masses[i]` belongs to `links[i]`. `base_pose` places the root link
    /// of a fixed base in the world; a free base starts where the state puts it.
    /// Whether each axis carries inertia is checked by `dynamics::singular_axes`.
    pub fn build(d: &Description, masses: &[MassProperties], base: Base, base_pose: Pose) -> Self {
        let mut b = Builder::new(d, masses, base);
        b.attach_root(base_pose);
        let root = b.model.root_link;
        b.descend(root);
        b.collect_axes();
        b.model
    }
}

/// Where a link sits: on which body, and its frame in the body's frame.
type Seat = (usize, Pose);

struct Builder<'a> {
    d: &'a Description,
    masses: &'a [MassProperties],
    link_index: HashMap<&'a str, usize>,
    children: Vec<Vec<usize>>,
    seats: Vec<Seat>,
    slots: HashMap<usize, AxisSlot>,
    model: Model,
}

impl<'a> Builder<'a> {
    fn new(d: &'a Description, masses: &'a [MassProperties], base: Base) -> Self {
        let link_index: HashMap<&str, usize> = d.links.iter().enumerate().map(|(i, l)| (l.name.as_str(), i)).collect();
        let mut children = vec![vec![]; d.links.len()];
        let mut has_parent = vec![false; d.links.len()];
        for (k, j) in d.joints.iter().enumerate() {
            children[link_index[j.parent.as_str()]].push(k);
            has_parent[link_index[j.child.as_str()]] = true;
        }
        let root_link = has_parent.iter().position(|p| !p).unwrap_or(0);
        let model = Model {
            name: d.name.clone(),
            axes: vec![],
            links: vec![],
            bodies: Bodies::default(),
            eulers: vec![],
            base,
            base_pose: Pose::identity(),
            root_link,
            nq: 0,
            nv: 0,
            balls: 0,
            softs: vec![],
            couplings: vec![],
            breakables: vec![],
            chains: chains(d),
            joints: vec![],
            rigs: vec![],
            dampings: vec![],
            joined: vec![],
            colliders: vec![],
            excluded_pairs: vec![],
            effects: Effects::NONE,
        };
        let seats = vec![(0, Pose::identity()); d.links.len()];
        Self { d, masses, link_index, children, seats, slots: HashMap::new(), model }
    }

    fn attach_root(&mut self, base_pose: Pose) {
        let (d, masses) = (self.d, self.masses);
        self.model.bodies.push(world());
        self.model.links = (d.links.iter().zip(masses).zip(memberships(d)))
            .map(|((l, m), membership)| LinkInfo {
                name: l.name.clone(),
                parent: None,
                fixed: false,
                monitor: l.monitor,
                mass: m.mass,
                center: m.center,
                inertia: m.inertia,
                membership,
                deactivation: deactivation(l),
                frame: LinkFrame::OnBody { body: 0, offset: Pose::identity() },
                removed: false,
            })
            .collect();
        let root = self.model.root_link;
        match self.model.base {
            Base::Fixed => {
                self.model.base_pose = base_pose;
                self.seat(root, (0, base_pose));
            }
            Base::Free => {
                let body = self.add_body(0, JointType::Floating, Pose::identity());
                self.seat(root, (body, Pose::identity()));
            }
        }
        self.model.links[root].fixed = self.model.base == Base::Fixed;
    }

    /// Depth first, so that the velocities of a limb are consecutive.
    fn descend(&mut self, link: usize) {
        for joint in self.children[link].clone() {
            let end = self.attach(link, joint);
            self.descend(end);
        }
    }

    /// Attaches what hangs on a joint and returns the link at its end.
    fn attach(&mut self, link: usize, joint: usize) -> usize {
        match self.group_from(joint) {
            Some((GroupKind::ThreeDof, joints)) => self.attach_spherical(link, &joints),
            Some((GroupKind::Cardan, joints)) => self.attach_universal(link, &joints),
            _ => self.attach_single(link, joint),
        }
    }

    /// The joints of the 3DOF or cardan group that begins with this joint, if they share one body: all three of a 3DOF, or
    /// H and P. What is missing or fixed (J-6) leaves a joint of fewer axes; any other rest is a chain of hinges, which
    /// moves alike.
    fn group_from(&self, joint: usize) -> Option<(GroupKind, Vec<usize>)> {
        let name = Some(self.d.joints[joint].name.as_str());
        let g = self.d.groups.iter().find(|g| g.h.as_deref() == name)?;
        let moving = |n: &Option<String>| {
            let index = self.d.joints.iter().position(|j| Some(&j.name) == n.as_ref())?;
            (self.d.joints[index].kind != JointKind::Fixed).then_some(index)
        };
        match (g.kind, moving(&g.h), moving(&g.p), moving(&g.b)) {
            (GroupKind::ThreeDof, Some(h), Some(p), Some(b)) => Some((GroupKind::ThreeDof, vec![h, p, b])),
            (GroupKind::ThreeDof | GroupKind::Cardan, Some(h), Some(p), _) => Some((GroupKind::Cardan, vec![h, p])),
            _ => None,
        }
    }

    fn attach_single(&mut self, link: usize, index: usize) -> usize {
        let j = &self.d.joints[index];
        let child = self.link_index[j.child.as_str()];
        let (body, offset) = self.seats[link];
        let frame = offset * j.origin.pose();
        let joint = match j.kind {
            JointKind::Fixed => return self.attach_fixed(link, index, (body, frame)),
            JointKind::Floating => JointType::Floating,
            JointKind::Spherical => JointType::Spherical,
            JointKind::Prismatic => JointType::Prismatic,
            JointKind::Revolute | JointKind::Continuous | JointKind::Planar => JointType::Revolute,
        };
        let turn = if joint.nv() == 1 { along_z(Vec3::from(j.axis)) } else { Quat::identity() };
        let constrained = match joint {
            JointType::Revolute => HINGE,
            JointType::Prismatic => SLIDE,
            _ => &[],
        };
        let (body, frame) = self.soften((body, frame * turn), constrained, self.softness(&[index]));
        let new = self.add_body(body, joint, frame);
        if joint != JointType::Floating {
            self.note_threshold(new, &[index]);
        }
        if joint.nv() == 1 {
            let b = &self.model.bodies[new];
            self.slots.insert(index, AxisSlot::Scalar { q: b.q, v: b.v });
        }
        self.hang(link, child, (new, Pose::from_parts(Translation3::identity(), turn.inverse())));
        child
    }

    /// Rigidly, unless the joint yields or may break.
    fn attach_fixed(&mut self, link: usize, index: usize, seat: Seat) -> usize {
        let child = self.link_index[self.d.joints[index].child.as_str()];
        let softness = self.softness(&[index]);
        let mut end = self.soften(seat, WELD, softness);
        if softness.is_none() && self.may_break(&[index]) {
            end = self.hold(seat);
        }
        self.hang(link, child, end);
        self.model.links[child].fixed = end == seat;
        if end != seat {
            self.note_threshold(end.0, &[index]);
        }
        child
    }

    /// H, P, B → one body with a quaternion.
    fn attach_spherical(&mut self, link: usize, joints: &[usize]) -> usize {
        let [h, p, b] = [0, 1, 2].map(|k| &self.d.joints[joints[k]]);
        let (rp, rb) = (p.origin.rotation(), b.origin.rotation());
        let axes = [Vec3::from(h.axis), rp * Vec3::from(p.axis), rp * rb * Vec3::from(b.axis)];
        let (frame, sense) = EulerFrame::frame(&axes);
        let basis = quat(&frame);
        let (parent, offset) = self.seats[link];
        let seat = (parent, offset * h.origin.pose() * basis);
        let (parent, frame) = self.soften(seat, POINT, self.softness(joints));
        let body = self.add_body(parent, JointType::Spherical, frame);
        self.note_threshold(body, joints);
        let (q, v) = (self.model.bodies[body].q, self.model.bodies[body].v);
        let group = self.model.eulers.len();
        self.model.eulers.push(EulerFrame { body, q, v, sense });
        for (angle, joint) in joints.iter().enumerate() {
            self.slots.insert(*joint, AxisSlot::Euler { group, angle });
        }
        let back = basis.inverse();
        let ends = [back, back * rp, back * rp * rb];
        self.hang_group(link, body, &[h, p, b], &ends)
    }

    /// H, P → one body with two angles.
    fn attach_universal(&mut self, link: usize, joints: &[usize]) -> usize {
        let [h, p] = [0, 1].map(|k| &self.d.joints[joints[k]]);
        let rp = p.origin.rotation();
        let (x, z) = (Vec3::from(h.axis), rp * Vec3::from(p.axis));
        let basis = quat(&Mat3::from_columns(&[x, z.cross(&x), z]));
        let (parent, offset) = self.seats[link];
        let seat = (parent, offset * h.origin.pose() * basis);
        let back = basis.inverse();
        if let Some(softness) = self.softness(joints) {
            return self.attach_soft_universal(link, joints, seat, (softness, [back, back * rp]));
        }
        let body = self.add_body(parent, JointType::Universal, seat.1);
        self.note_threshold(body, joints);
        let (q, v) = (self.model.bodies[body].q, self.model.bodies[body].v);
        self.slots.insert(joints[0], AxisSlot::Scalar { q, v });
        self.slots.insert(joints[1], AxisSlot::Scalar { q: q + 1, v: v + 1 });
        self.hang_group(link, body, &[h, p], &[back, back * rp])
    }

    /// H, P → two hinges with what yields before and between them: in every position of H, the turn that a cardan joint
    /// constrains is about the line perpendicular to both.
    fn attach_soft_universal(
        &mut self,
        link: usize,
        joints: &[usize],
        seat: Seat,
        (softness, ends): (Softness, [Quat; 2]),
    ) -> usize {
        let [h, p] = [0, 1].map(|k| &self.d.joints[joints[k]]);
        let (between, tip) = (self.link_index[h.child.as_str()], self.link_index[p.child.as_str()]);
        let (parent, frame) = self.soften(seat, POINT, Some(softness));
        let turned = Pose::from_parts(Translation3::identity(), facing(0).inverse());
        let first = self.add_body(parent, JointType::Revolute, frame * facing(0));
        self.hang(link, between, (first, turned * ends[0]));
        let (parent, frame) = self.soften((first, turned), BETWEEN, Some(softness));
        let second = self.add_body(parent, JointType::Revolute, frame);
        self.hang(between, tip, (second, Pose::from_parts(Translation3::identity(), ends[1])));
        self.note_threshold(second, joints);
        for (joint, body) in joints.iter().zip([first, second]) {
            let (q, v) = (self.model.bodies[body].q, self.model.bodies[body].v);
            self.slots.insert(*joint, AxisSlot::Scalar { q, v });
        }
        tip
    }

    /// Seats the links of a group: those inside move with a part of the turns, the last one is the body's.
    fn hang_group(&mut self, link: usize, body: usize, joints: &[&Joint], ends: &[Quat]) -> usize {
        let mut parent = link;
        for (k, (joint, end)) in joints.iter().zip(ends).enumerate() {
            let child = self.link_index[joint.child.as_str()];
            let offset = Pose::from_parts(Translation3::identity(), *end);
            if k + 1 == joints.len() {
                self.hang(parent, child, (body, offset));
            } else {
                self.model.links[child].parent = Some(parent);
                self.model.links[child].frame = LinkFrame::InGroup { body, turns: k + 1, offset };
            }
            parent = child;
        }
        parent
    }

    fn hang(&mut self, parent: usize, child: usize, seat: Seat) {
        self.model.links[child].parent = Some(parent);
        self.seat(child, seat);
    }

    /// Puts a link on a body and adds its inertia there (J-6: sum with parallel axes and rotated tensors).
    fn seat(&mut self, link: usize, (body, offset): Seat) {
        self.seats[link] = (body, offset);
        self.model.links[link].frame = LinkFrame::OnBody { body, offset };
        let m = self.masses[link].placed(&offset);
        let b = &mut self.model.bodies[body];
        b.mass += m.mass;
        b.mc += V3::from(m.center * m.mass);
        b.inertia += S3::from(m.inertia_at_origin());
    }

    fn add_body(&mut self, parent: usize, joint: JointType, tree: Pose) -> usize {
        let m = &mut self.model;
        let mut body = Body { parent, joint, q: m.nq, v: m.nv, ball: m.balls, ..world() };
        body.put((M3::from(*tree.rotation.to_rotation_matrix().matrix()), V3::from(tree.translation.vector)));
        m.bodies.push(body);
        m.nq += joint.nq();
        m.nv += joint.nv();
        m.balls += usize::from(joint == JointType::Spherical);
        m.bodies.len() - 1
    }

    fn collect_axes(&mut self) {
        for (k, j) in self.d.joints.iter().enumerate() {
            if let Some(slot) = self.slots.get(&k) {
                self.model.axes.push(axis::axis(j, *slot));
            }
        }
        self.model.joints = super::joint_set::joint_sets(self.d, &self.model);
        self.model.rigs = rigs(self.d, &self.model);
        self.model.couplings = super::coupling::couplings(self.d, &self.model);
        self.model.dampings = super::damping::dampings(self.d, &self.model);
        self.model.effects = Effects::called_for(&self.model);
    }
}

/// All three 0: never (B-9).
fn deactivation(link: &Link) -> Option<Deactivation> {
    let d = link.deactivate.as_ref().filter(|d| d.linear > 0.0 || d.angular > 0.0 || d.after > 0.0)?;
    Some(Deactivation { linear: d.linear, angular: d.angular, after: d.after })
}

fn world() -> Body {
    Body {
        parent: 0,
        joint: JointType::Revolute,
        q: 0,
        v: 0,
        ball: 0,
        tree_r: M3::identity(),
        tree_p: V3::default(),
        along: None,
        mass: 0.0,
        mc: V3::default(),
        inertia: S3::default(),
    }
}

fn quat(m: &Mat3) -> Quat {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*m))
}

/// A rotation that carries z to the axis; for the coordinate axes a permutation of axes, without rounding.
fn along_z(axis: Vec3) -> Quat {
    let k = axis.iamin();
    let mut side = Vec3::zeros();
    side[k] = 1.0;
    let x = side.cross(&axis).normalize();
    quat(&Mat3::from_columns(&[x, axis.cross(&x), axis]))
}
