//! Several robots and free bodies in one world: one [`Model`] is a forest on the world, so the dynamics need not know.

use super::{Axis, AxisSlot, Base, Body, Coupling, Effects, JointSet, LinkFrame, LinkInfo, Membership, Model, Rig};
use crate::math::Pose;
use std::ops::Range;

/// A robot or body that stands in the world beside the first robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// Name in the scene.
    pub name: String,
    /// How its root is held.
    pub base: Base,
    /// Root link of a fixed base in the world.
    pub base_pose: Pose,
    /// Index of its root link.
    pub root_link: usize,
    /// Its links.
    pub links: Range<usize>,
    /// Its axes.
    pub axes: Range<usize>,
}

/// What has to be added to the indices of a model that goes into another one.
struct Shift {
    body: usize,
    q: usize,
    v: usize,
    ball: usize,
    axis: usize,
    link: usize,
    euler: usize,
}

impl Model {
    /// Appends another model, which shares the world with this one: all indices of `other` grow, those of `self` stay. Axes,
    /// links, chains and rigs of `other` are called `name/…` afterwards, but for a lone link of that name itself. States
    /// join likewise (`State::join`). The effects are those that the whole calls for.
    pub fn join(&mut self, other: Self, name: &str) {
        let shift = self.shift();
        let alone = other.links.len() == 1 && other.links[0].name == name;
        let named = |own: &str| if alone { own.to_owned() } else { format!("{name}/{own}") };
        self.joined.push(Joined {
            name: name.to_owned(),
            base: other.base,
            base_pose: other.base_pose,
            root_link: shift.link + other.root_link,
            links: shift.link..shift.link + other.links.len(),
            axes: shift.axis..shift.axis + other.axes.len(),
        });
        // What joined the other one before has a name there.
        self.joined.extend(other.joined.iter().map(|j| shift.joined(j, &named)));
        let static_mass = &other.bodies[0];
        self.bodies[0].mass += static_mass.mass;
        self.bodies[0].mc += static_mass.mc;
        self.bodies[0].inertia += static_mass.inertia;
        self.bodies.extend(other.bodies.iter().skip(1).map(|b| shift.body(b)));
        self.axes.extend(other.axes.iter().map(|a| shift.axis(a, &named)));
        let is_link = |link: &str| other.links.iter().any(|l| l.name == link);
        self.chains.extend(other.chains.iter().map(|c| super::LinkChain {
            root: named(&c.root),
            joint: named(&c.joint),
            anchor: c.anchor.as_ref().map(|a| if is_link(a) { named(a) } else { a.clone() }),
            links: c.links.iter().map(|l| l + shift.link).collect(),
            ..c.clone()
        }));
        self.links.extend(other.links.iter().map(|l| shift.link(l, &named)));
        self.joints.extend(other.joints.iter().map(|j| shift.joint(j, &named)));
        self.rigs.extend(other.rigs.iter().map(|r| shift.rig(r, &named)));
        self.append_rest(&other, &shift, &named);
        (self.nq, self.nv, self.balls) = (self.nq + other.nq, self.nv + other.nv, self.balls + other.balls);
        self.effects = Effects::called_for(self);
    }

    fn shift(&self) -> Shift {
        Shift {
            body: self.bodies.len() - 1,
            q: self.nq,
            v: self.nv,
            ball: self.balls,
            axis: self.axes.len(),
            link: self.links.len(),
            euler: self.eulers.len(),
        }
    }

    fn append_rest(&mut self, other: &Self, by: &Shift, named: &dyn Fn(&str) -> String) {
        self.eulers.extend(other.eulers.iter().map(|e| super::EulerFrame {
            body: by.on(e.body),
            q: e.q + by.q,
            v: e.v + by.v,
            ..e.clone()
        }));
        self.softs.extend(other.softs.iter().map(|s| super::SoftDof { q: s.q + by.q, v: s.v + by.v, ..*s }));
        let coupling = |c: &Coupling| Coupling { follower: c.follower + by.axis, leader: c.leader + by.axis, ..*c };
        self.couplings.extend(other.couplings.iter().map(coupling));
        self.breakables.extend(other.breakables.iter().map(|b| super::Breakable {
            body: by.on(b.body),
            joint: named(&b.joint),
            ..b.clone()
        }));
        self.dampings.extend(other.dampings.iter().map(|d| super::BodyDamping { body: by.on(d.body), ..*d }));
        // What comes later has greater indices: the list stays ascending.
        self.excluded_pairs.extend(other.excluded_pairs.iter().map(|pair| pair.map(|l| l + by.link)));
        self.colliders.extend(other.colliders.iter().map(|c| super::Collider {
            name: named(&c.name),
            link: c.link.map(|l| l + by.link),
            ..c.clone()
        }));
    }

    /// Root links of the first robot and of all that joined it, with how they are held.
    pub fn roots(&self) -> impl Iterator<Item = (usize, Base)> {
        let joined = self.joined.iter().map(|j| (j.root_link, j.base));
        std::iter::once((self.root_link, self.base)).chain(joined)
    }

    /// True for the root link of the first robot or of one that joined it.
    pub fn is_root(&self, link: usize) -> bool {
        self.roots().any(|(root, _)| root == link)
    }

    /// Name and root link of everything that floats: `base` for the first robot, then what joined it.
    pub fn floating(&self) -> impl Iterator<Item = (&str, usize)> {
        let first = std::iter::once(("base", self.root_link, self.base));
        let joined = self.joined.iter().map(|j| (j.name.as_str(), j.root_link, j.base));
        first.chain(joined).filter(|(.., base)| *base == Base::Free).map(|(name, root, _)| (name, root))
    }

    /// The links of the robot that an axis is part of, and which of [`Model::joined`] it is; `None`: the first.
    pub fn robot_of(&self, axis: usize) -> (Range<usize>, Option<usize>) {
        match self.joined.iter().position(|j| j.axes.contains(&axis)) {
            Some(i) => (self.joined[i].links.clone(), Some(i)),
            None => (0..self.joined.first().map_or(self.links.len(), |j| j.links.start), None),
        }
    }
}

impl Shift {
    /// A body's index; the world is one for all.
    fn on(&self, body: usize) -> usize {
        if body == 0 { 0 } else { body + self.body }
    }

    fn body(&self, b: &Body) -> Body {
        Body { parent: self.on(b.parent), q: b.q + self.q, v: b.v + self.v, ball: b.ball + self.ball, ..b.clone() }
    }

    fn axis(&self, a: &Axis, named: &dyn Fn(&str) -> String) -> Axis {
        let slot = match a.slot {
            AxisSlot::Scalar { q, v } => AxisSlot::Scalar { q: q + self.q, v: v + self.v },
            AxisSlot::Euler { group, angle } => AxisSlot::Euler { group: group + self.euler, angle },
            AxisSlot::Apart { position } => AxisSlot::Apart { position },
        };
        Axis { name: named(&a.name), slot, ..a.clone() }
    }

    fn link(&self, l: &LinkInfo, named: &dyn Fn(&str) -> String) -> LinkInfo {
        let frame = match l.frame {
            LinkFrame::OnBody { body, offset } => LinkFrame::OnBody { body: self.on(body), offset },
            LinkFrame::InGroup { body, turns, offset } => LinkFrame::InGroup { body: self.on(body), turns, offset },
        };
        let membership =
            l.membership.as_ref().map(|m| Membership { joint: named(&m.joint), axis: named(&m.axis), root: m.root });
        LinkInfo { name: named(&l.name), parent: l.parent.map(|p| p + self.link), membership, frame, ..l.clone() }
    }

    fn joint(&self, j: &JointSet, named: &dyn Fn(&str) -> String) -> JointSet {
        JointSet { name: named(&j.name), axes: j.axes.map(|axis| axis.map(|a| a + self.axis)) }
    }

    fn rig(&self, r: &Rig, named: &dyn Fn(&str) -> String) -> Rig {
        Rig {
            name: named(&r.name),
            group: named(&r.group),
            axes: r.axes.map(|axis| axis.map(|a| a + self.axis)),
            carrier: r.carrier + self.link,
            reference: r.reference.map(|l| l + self.link),
            parent: r.parent + self.link,
            ..r.clone()
        }
    }

    fn joined(&self, j: &Joined, named: &dyn Fn(&str) -> String) -> Joined {
        Joined {
            name: named(&j.name),
            root_link: j.root_link + self.link,
            links: j.links.start + self.link..j.links.end + self.link,
            axes: j.axes.start + self.axis..j.axes.end + self.axis,
            ..j.clone()
        }
    }
}
