//! Random trees for the physics tests: any mixture of joints, bodies with proper inertias.
#![allow(dead_code)]

pub mod urdf;

use realnoid::math::{M3, Mat3, Quat, S3, V3, Vec3};
use realnoid::model::{
    Axis, AxisKind, AxisSlot, Base, Bodies, Body, DriveLimits, Effects, JointType, LinkFrame, LinkInfo, Model, Softness,
};

/// A small generator with the same numbers everywhere (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Uniform in −1 … 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub fn vec3(&mut self, scale: f64) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * scale
    }
    pub fn rotation(&mut self) -> Quat {
        Quat::from_scaled_axis(self.vec3(3.0))
    }
    pub fn many(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| self.unit() * scale).collect()
    }
}

pub const ALL: [JointType; 5] =
    [JointType::Revolute, JointType::Prismatic, JointType::Universal, JointType::Spherical, JointType::Floating];

/// A tree of these joints; `chain`: each hangs on the one before.
pub fn tree(joints: &[JointType], chain: bool, seed: u64) -> Model {
    let mut rng = Random(seed);
    let mut m = Model {
        name: "random".into(),
        axes: vec![],
        links: vec![],
        bodies: Bodies::default(),
        eulers: vec![],
        base: Base::Fixed,
        base_pose: realnoid::math::Pose::identity(),
        root_link: 0,
        nq: 0,
        nv: 0,
        balls: 0,
        softs: vec![],
        couplings: vec![],
        breakables: vec![],
        chains: vec![],
        joints: vec![],
        rigs: vec![],
        dampings: vec![],
        joined: vec![],
        colliders: vec![],
        excluded_pairs: vec![],
        effects: Effects { gravity: true, drives: true, ..Effects::NONE },
    };
    m.bodies.push(body(&mut rng, 0, JointType::Revolute));
    m.bodies[0].mass = 0.0;
    for (i, joint) in joints.iter().enumerate() {
        let parent = if chain { i } else { rng.next() as usize % (i + 1) };
        let mut b = body(&mut rng, parent, *joint);
        (b.q, b.v, b.ball) = (m.nq, m.nv, m.balls);
        m.nq += joint.nq();
        m.nv += joint.nv();
        m.balls += usize::from(*joint == JointType::Spherical);
        m.bodies.push(b);
    }
    add_axes(&mut m);
    m
}

fn body(rng: &mut Random, parent: usize, joint: JointType) -> Body {
    let mass = 1.5 + rng.unit();
    let c = rng.vec3(0.1);
    // The inertia of a few points, so that the triangle inequality holds.
    let mut i = Mat3::zeros();
    for _ in 0..4 {
        let x = rng.vec3(0.15);
        i += 0.25 * mass * (Mat3::identity() * x.norm_squared() - x * x.transpose());
    }
    i += mass * (Mat3::identity() * c.norm_squared() - c * c.transpose());
    Body {
        parent,
        joint,
        q: 0,
        v: 0,
        ball: 0,
        tree_r: M3::from(*rng.rotation().to_rotation_matrix().matrix()),
        tree_p: V3::from(rng.vec3(0.3)),
        along: None,
        mass,
        mc: V3::from(c * mass),
        inertia: S3::from(i),
    }
}

/// Mass and inertia of a body times f.
pub fn scale(m: &mut Model, body: usize, f: f64) {
    let b = &mut m.bodies[body];
    (b.mass, b.mc) = (b.mass * f, b.mc * f);
    let i = &mut b.inertia;
    for x in [&mut i.xx, &mut i.xy, &mut i.xz, &mut i.yy, &mut i.yz, &mut i.zz] {
        *x *= f;
    }
}

fn add_axes(m: &mut Model) {
    m.links.push(LinkInfo {
        name: "root".into(),
        parent: None,
        fixed: true,
        monitor: None,
        membership: None,
        deactivation: None,
        mass: 0.0,
        removed: false,
        center: Vec3::zeros(),
        inertia: Mat3::zeros(),
        frame: LinkFrame::OnBody { body: 0, offset: realnoid::math::Pose::identity() },
    });
    for b in &m.bodies[1..] {
        if b.joint.nq() == 1 || b.joint == JointType::Universal {
            for k in 0..b.joint.nv() {
                m.axes.push(axis(b, k));
            }
        }
    }
}

fn axis(b: &Body, k: usize) -> Axis {
    Axis {
        name: format!("axis_{}", b.v + k),
        kind: if b.joint == JointType::Prismatic { AxisKind::Linear } else { AxisKind::Rotary },
        slot: AxisSlot::Scalar { q: b.q + k, v: b.v + k },
        direction: Vec3::z(),
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        stop: Softness { erp: 0.2, cfm: 0.0 },
        drive: DriveLimits::default(),
        damping: 0.0,
        friction: 0.0,
        mode: realnoid::description::DriveMode::Idle,
        switchable: true,
    }
}

/// A random state: unit quaternions, angles and speeds of this scale.
pub fn state(m: &Model, rng: &mut Random, scale: f64) -> (Vec<f64>, Vec<f64>) {
    let mut q = rng.many(m.nq, scale);
    for b in &m.bodies[1..] {
        let at = match b.joint {
            JointType::Spherical => b.q,
            JointType::Floating => b.q + 3,
            _ => continue,
        };
        let r = rng.rotation();
        q[at..at + 4].copy_from_slice(&[r.w, r.i, r.j, r.k]);
    }
    (q, rng.many(m.nv, scale))
}
