//! A [`Model`] as Bullet takes it (tables 6-11 to 6-14 of the source): a body for each body that has mass, and one
//! btGeneric6DofSpring2Constraint for all that lies between two of them.

use super::bridge::{BodySpec, JointSpec, Motor, Moving, PairSpec, Spec};
use super::shapes;
use crate::engine::EngineKind;
use crate::engine::honour::name_of;
use crate::engine::pairs::Pair;
use crate::engine::principal::Principal;
use crate::math::{Mat3, Pose, Quat, V3, Vec3};
use crate::model::{Axis, AxisSlot, Body, JointType, Model, Softness};
use nalgebra::{Rotation3, Translation3, UnitQuaternion};

/// Share of the error of a hard joint that a step takes back: Bullet's own default.
const ERP: f64 = 0.2;
/// Bullet knows angles within ±π only, and wraps limits; ranges up to here are given to it, rad.
const WIDEST: f64 = 3.1;
/// Stands for no end, m.
const FAR: f64 = 1e9;
/// Two directions whose cosine is below this are perpendicular.
const SQUARE: f64 = 1e-9;
/// Degrees of freedom of a constraint that turn about z, y, x, in this order.
const TURNS: [usize; 3] = [5, 4, 3];
/// The one along x.
const ALONG_X: usize = 0;

/// What of the model is what of Bullet.
#[derive(Clone, Debug)]
pub struct Plan {
    /// For the C++ side; where the bodies are is written in before each use.
    pub spec: Spec,
    /// Per body of Bullet.
    pub bodies: Vec<Principal>,
    /// Per constraint.
    pub links: Vec<Link>,
    /// Per axis; `None`: nothing that Bullet moves.
    pub axes: Vec<Option<Driven>>,
    /// Groups with three axes whose stops need a row more near the pole, in the order of `Spec::pairs`.
    pub pairs: Vec<Pair>,
    /// Bodies without mass, ascending: where others put them.
    pub carried: Vec<usize>,
}

/// A constraint.
#[derive(Clone, Debug)]
pub struct Link {
    /// Index into `Model::bodies`; 0: the world.
    pub parent: usize,
    /// Index into `Model::bodies`.
    pub child: usize,
    /// The child's centre of mass in its frame, m.
    pub center: V3<f64>,
    /// Its frame in the parent's frame, and in the child's.
    pub frames: [Pose; 2],
    /// If it is more than one joint of the model: their bodies from the root outwards, with degree of freedom and sense.
    pub turns: Vec<(usize, usize, f64)>,
}

/// An axis that Bullet drives.
#[derive(Clone, Copy, Debug)]
pub struct Driven {
    /// Index into `Spec::motors`.
    pub motor: usize,
    /// +1, or −1 if the axis is the opposite of Bullet's.
    pub sense: f64,
}

impl Plan {
    /// # Errors
    /// Names the body or joint that Bullet cannot take, and why.
    pub fn new(m: &Model) -> Result<Self, String> {
        let mut plan = Self {
            spec: Spec { excluded: excluded(m), ..Spec::default() },
            bodies: vec![],
            links: vec![],
            axes: vec![None; m.axes.len()],
            carried: vec![],
            pairs: vec![],
        };
        let mut index = vec![None; m.bodies.len()];
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            if b.mass > 0.0 {
                index[i] = Some(plan.bodies.len());
                plan.add_body(m, i)?;
            } else {
                plan.carried.push(i);
            }
        }
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            if b.mass > 0.0 {
                plan.add_joint(m, i, &index)?;
            }
        }
        if m.effects.contact {
            plan.spec.shapes = shapes::specs(m, &plan.bodies, &index)?;
        }
        Ok(plan)
    }

    fn add_body(&mut self, m: &Model, body: usize) -> Result<(), String> {
        let own = Principal::of(m, body, EngineKind::Bullet)?;
        let damping = m.dampings.iter().find(|d| d.body == body && m.effects.body_damping);
        let rest = crate::engine::sleep::limit(m, body);
        self.spec.bodies.push(BodySpec {
            mass: m.bodies[body].mass,
            inertia: own.moments.into(),
            moving: Moving::default(),
            damping: damping.map_or([0.0; 2], |d| [d.linear, d.angular]),
            sleep: rest.map_or([0.0, 0.0, -1.0], |r| [r.linear, r.angular, r.after]),
        });
        self.bodies.push(own);
        Ok(())
    }

    fn add_joint(&mut self, m: &Model, child: usize, index: &[Option<usize>]) -> Result<(), String> {
        let chain = chain(m, child)?;
        let turning: Vec<usize> = chain.iter().copied().filter(|i| softness(m, *i).is_none()).collect();
        if turning.iter().any(|i| m.bodies[*i].joint == JointType::Floating) {
            let alone = if chain.len() == 1 {
                Ok(())
            } else {
                Err(format!("{} floats on a body without mass", name_of(m, child)))
            };
            return alone;
        }
        let parent = m.bodies[chain[0]].parent;
        let shape = Shape::of(m, &chain, &turning)?;
        let x_pi = chain.iter().fold(Pose::identity(), |x, i| x * tree(&m.bodies[*i]));
        let frames = [shape.frame, x_pi.inverse() * shape.frame];
        let own = |slot: Option<usize>| slot.map_or(Pose::identity(), |i| self.bodies[i].frame);
        let (above, below) = (own(index[parent]), own(index[child]));
        let (lower, upper) = ([0.0; 6], [0.0; 6]);
        let soft = chain.iter().find_map(|i| softness(m, *i)).filter(|s| m.effects.compliance && s.cfm > 0.0);
        let mut joint = JointSpec {
            parent: index[parent].map_or(-1, number),
            child: index[child].map_or(-1, number),
            frame_in_parent: array(&(above.inverse() * frames[0])),
            frame_in_child: array(&(below.inverse() * frames[1])),
            lower,
            upper,
            erp: [soft.map_or(ERP, |s| s.erp); 6],
            cfm: [soft.map_or(0.0, |s| s.cfm); 6],
        };
        for free in &shape.free {
            (joint.lower[free.dof], joint.upper[free.dof]) = (1.0, -1.0);
            self.add_axis(m, (free, shape.free.len() > 1), &mut joint);
        }
        self.add_pair(m, turning.first().copied());
        self.spec.joints.push(joint);
        let turns = if turning.len() > 1 { shape.turns() } else { vec![] };
        self.links.push(Link { parent, child, center: V3::from(below.translation.vector), frames, turns });
        Ok(())
    }

    /// For the constraint that comes next, if it is that of a 3DOF group.
    fn add_pair(&mut self, m: &Model, body: Option<usize>) {
        let group = m.eulers.iter().position(|e| Some(e.body) == body);
        if let Some(pair) = group.and_then(|g| Pair::of(m, g)).filter(|_| m.effects.limits) {
            self.spec.pairs.push(PairSpec { joint: self.spec.joints.len() as u32, erp: m.axes[pair.roll].stop.erp });
            self.pairs.push(pair);
        }
    }

    fn add_axis(&mut self, m: &Model, (free, several): (&Free, bool), joint: &mut JointSpec) {
        let Some(axis) = free.axis else { return };
        let a = &m.axes[axis];
        // Soft ones are part of the law of the axis.
        let stops = m.effects.limits && a.has_hard_stops();
        let far = stops && !native(a, several);
        if stops {
            (joint.erp[free.dof], joint.cfm[free.dof]) = (a.stop.erp, 0.0);
        }
        if stops && !far {
            let ends = [free.sense * a.lower.max(-FAR), free.sense * a.upper.min(FAR)];
            joint.lower[free.dof] = ends[0].min(ends[1]);
            joint.upper[free.dof] = ends[0].max(ends[1]);
        }
        self.axes[axis] = Some(Driven { motor: self.spec.motors.len(), sense: free.sense });
        self.spec.motors.push(Motor { joint: self.spec.joints.len() as u32, dof: free.dof as u32, far });
    }
}

/// Can Bullet hold an axis to its range by itself? Of several turns, its rows are not of the measure of their angles.
fn native(a: &Axis, several: bool) -> bool {
    a.kind == crate::model::AxisKind::Linear || (!several && a.lower >= -WIDEST && a.upper <= WIDEST)
}

/// A degree of freedom of a constraint that is not locked.
struct Free {
    /// The body of the model whose joint it is.
    body: usize,
    dof: usize,
    axis: Option<usize>,
    sense: f64,
}

/// What the constraint is to be: its frame at zero in the parent, and what is free.
struct Shape {
    frame: Pose,
    free: Vec<Free>,
}

impl Shape {
    /// Of a chain of joints, of which the `turning` ones are not merely soft.
    fn of(m: &Model, chain: &[usize], turning: &[usize]) -> Result<Self, String> {
        let at = |body: usize| {
            let up_to = chain.iter().take_while(|i| **i != body).chain([&body]);
            up_to.fold(Pose::identity(), |x, i| x * tree(&m.bodies[*i]))
        };
        let Some(first) = turning.first() else {
            return Ok(Self { frame: at(chain[chain.len() - 1]), free: vec![] });
        };
        if turning.len() > 1 {
            return Self::of_hinges(m, turning, &at);
        }
        let (body, frame) = (*first, at(*first));
        let free = |dof: usize, axis: Option<usize>, sense: f64| Free { body, dof, axis, sense };
        Ok(match m.bodies[body].joint {
            JointType::Revolute => Self { frame, free: vec![free(TURNS[0], scalar(m, body, 0), 1.0)] },
            JointType::Prismatic => {
                Self { frame: frame * x_along_z(), free: vec![free(ALONG_X, scalar(m, body, 0), 1.0)] }
            }
            JointType::Universal => {
                let [h, p] = [0, 1].map(|k| scalar(m, body, k));
                Self { frame: frame * z_along_x(), free: vec![free(TURNS[0], h, 1.0), free(TURNS[2], p, 1.0)] }
            }
            _ => {
                let group = m.eulers.iter().position(|e| e.body == body);
                let sense = group.map_or(1.0, |g| m.eulers[g].sense);
                let axis = |angle| group.and_then(|g| euler(m, g, angle));
                let turn = |k: usize| free(TURNS[k], axis(k), if k == 2 { sense } else { 1.0 });
                Self { frame, free: vec![turn(0), turn(1), turn(2)] }
            }
        })
    }

    /// Two or three hinges without mass between them: they must meet in one point, and each stand square on the next (and the
    /// third on the first, at zero).
    fn of_hinges(m: &Model, hinges: &[usize], at: &dyn Fn(usize) -> Pose) -> Result<Self, String> {
        let frames: Vec<Pose> = hinges.iter().map(|i| at(*i)).collect();
        let axes: Vec<Vec3> = frames.iter().map(|x| x.rotation * Vec3::z()).collect();
        let one_point = frames.iter().all(|x| (x.translation.vector - frames[0].translation.vector).norm() < SQUARE);
        let hinged = hinges.iter().all(|i| m.bodies[*i].joint == JointType::Revolute);
        let square = (1..axes.len()).all(|k| (0..k).all(|j| axes[j].dot(&axes[k]).abs() < SQUARE));
        if !(hinged && one_point && square && axes.len() <= 3) {
            let last = hinges[hinges.len() - 1];
            return Err(format!(
                "there is no mass between {} axes before {}; bullet can take that only of two or three hinges that meet in \
                 one point at right angles: give the links between them a mass",
                hinges.len(),
                name_of(m, last)
            ));
        }
        // Two: about z, then x. Three: about z, y, x.
        let (y, dofs) =
            if axes.len() == 2 { (axes[0].cross(&axes[1]), [TURNS[0], TURNS[2], 0]) } else { (axes[1], TURNS) };
        let x = y.cross(&axes[0]);
        let turned = quat(&Mat3::from_columns(&[x, y, axes[0]]));
        let frame = Pose::from_parts(frames[0].translation, turned);
        let free = |k: usize| {
            let along = if dofs[k] == TURNS[2] { x.dot(&axes[k]).signum() } else { 1.0 };
            Free { body: hinges[k], dof: dofs[k], axis: scalar(m, hinges[k], 0), sense: along }
        };
        Ok(Self { frame, free: (0..axes.len()).map(free).collect() })
    }

    fn turns(&self) -> Vec<(usize, usize, f64)> {
        self.free.iter().map(|f| (f.body, f.dof, f.sense)).collect()
    }
}

/// The bodies from the one after the next mass (or the world) down to this one.
fn chain(m: &Model, child: usize) -> Result<Vec<usize>, String> {
    let mut chain = vec![child];
    let mut parent = m.bodies[child].parent;
    while parent != 0 && m.bodies[parent].mass == 0.0 {
        let others = m.bodies.iter().skip(1).filter(|b| b.parent == parent).count() > 1;
        if others && softness(m, parent).is_none() {
            return Err(format!(
                "{} has no mass, but more than one body hangs on it; bullet cannot take that: give it a mass",
                name_of(m, parent)
            ));
        }
        chain.insert(0, parent);
        parent = m.bodies[parent].parent;
    }
    Ok(chain)
}

fn softness(m: &Model, body: usize) -> Option<Softness> {
    m.softs.iter().find(|s| s.v == m.bodies[body].v && m.bodies[body].joint.nv() == 1).map(|s| s.softness)
}

/// The axis with the coordinate `k` of a body's joint.
fn scalar(m: &Model, body: usize, k: usize) -> Option<usize> {
    let at = m.bodies[body].v + k;
    m.axes.iter().position(|a| matches!(a.slot, AxisSlot::Scalar { v, .. } if v == at))
}

fn euler(m: &Model, group: usize, angle: usize) -> Option<usize> {
    m.axes.iter().position(|a| a.slot == AxisSlot::Euler { group, angle })
}

fn excluded(m: &Model) -> Vec<i32> {
    m.excluded_pairs.iter().flatten().map(|link| number(*link)).collect()
}

/// Bullet counts in 32 bits.
pub(super) fn number(index: usize) -> i32 {
    i32::try_from(index).unwrap_or(i32::MAX)
}

fn tree(b: &Body) -> Pose {
    Pose::from_parts(Translation3::from(Vec3::from(b.tree_p)), quat(&Mat3::from(b.tree_r)))
}

pub(super) fn quat(m: &Mat3) -> Quat {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*m))
}

/// x, y, z and the quaternion x, y, z, w.
pub(super) fn array(x: &Pose) -> [f64; 7] {
    let (p, q) = (x.translation, x.rotation);
    [p.x, p.y, p.z, q.i, q.j, q.k, q.w]
}

/// The other way round.
pub(super) fn pose(a: &[f64; 7]) -> Pose {
    let q = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(a[6], a[3], a[4], a[5]));
    Pose::from_parts(Translation3::new(a[0], a[1], a[2]), q)
}

/// Table 6-14, E: Bullet's x is our z, its z our −x.
fn x_along_z() -> Pose {
    Pose::from_parts(Translation3::identity(), quat(&Mat3::from_columns(&[Vec3::z(), Vec3::y(), -Vec3::x()])))
}

/// Table 6-14, H and P of a cardan joint: Bullet's z is our x, its x our z, its y our −y.
fn z_along_x() -> Pose {
    Pose::from_parts(Translation3::identity(), quat(&Mat3::from_columns(&[Vec3::z(), -Vec3::y(), Vec3::x()])))
}
