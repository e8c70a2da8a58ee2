//! Free bodies with colliders, placed by hand; support functions written anew.
#![allow(dead_code)]

use crate::support::{Random, tree};
use realnoid::contact::{Detector, Touch};
use realnoid::dynamics::Kinematics;
use realnoid::math::{M3, Pose, Quat, V3, Vec3};
use realnoid::model::{Collider, JointType, LinkFrame, Model, Surface};
use realnoid::shape::ContactForm;

/// One free body (or the world, for `None`) per form.
pub struct Scene {
    pub model: Model,
    pub k: Kinematics,
    pub poses: Vec<Pose>,
}

pub fn collider(form: ContactForm, link: Option<usize>, pose: Pose) -> Collider {
    Collider { name: "c".into(), link, pose, form, surface: Surface::default(), margin: 0.0 }
}

impl Scene {
    /// Each form on its own free body, in that body's frame.
    pub fn new(forms: &[ContactForm]) -> Self {
        let mut model = tree(&vec![JointType::Floating; forms.len()], false, 1);
        let first = model.links[0].clone();
        model.links = (0..forms.len())
            .map(|i| {
                let mut link = first.clone();
                link.frame = LinkFrame::OnBody { body: i + 1, offset: Pose::identity() };
                link
            })
            .collect();
        model.colliders =
            forms.iter().enumerate().map(|(i, f)| collider(f.clone(), Some(i), Pose::identity())).collect();
        let k = Kinematics::new(&model);
        Self { k, model, poses: vec![Pose::identity(); forms.len()] }
    }

    pub fn place(&mut self, i: usize, pose: Pose) {
        self.poses[i] = pose;
        self.k.r[i + 1] = M3::from(*pose.rotation.to_rotation_matrix().matrix());
        self.k.p[i + 1] = V3::from(pose.translation.vector);
    }

    /// Touches at any distance up to about 100 m: bodies are told to be that fast.
    pub fn all(&mut self, detector: &mut Detector) -> Vec<Touch> {
        self.k.v.iter_mut().skip(1).step_by(2).for_each(|v| *v = V3::new(100.0, 0.0, 0.0));
        let mut out = vec![];
        detector.find(&self.k, 1.0, &mut out);
        self.k.v.iter_mut().for_each(|v| *v = V3::default());
        out
    }
}

pub fn pose(rng: &mut Random, scale: f64) -> Pose {
    Pose::from_parts(rng.vec3(scale).into(), rng.rotation())
}

pub fn turned(rng: &mut Random) -> Quat {
    rng.rotation()
}

/// The furthest point of a convex form, in its own frame.
pub fn support(form: &ContactForm, d: &Vec3) -> Vec3 {
    let best =
        |points: &[Vec3]| points.iter().copied().max_by(|a, b| a.dot(d).total_cmp(&b.dot(d))).unwrap_or(Vec3::zeros());
    let ring = |a: f64, b: f64, z: f64| {
        let l = (a * d.x).hypot(b * d.y);
        if l > 0.0 { Vec3::new(a * a * d.x / l, b * b * d.y / l, z) } else { Vec3::new(0.0, 0.0, z) }
    };
    let box_corner = |h: &[f64; 3]| Vec3::new(h[0] * d.x.signum(), h[1] * d.y.signum(), h[2] * d.z.signum());
    match form {
        ContactForm::Ball { radius } => d.normalize() * *radius,
        ContactForm::Cuboid { half } => box_corner(half),
        ContactForm::RoundCuboid { half, radius } => box_corner(half) + d.normalize() * *radius,
        ContactForm::Capsule { bottom, top, half } => {
            let u = d.normalize();
            best(&[Vec3::z() * *half + u * *top, Vec3::z() * -half + u * *bottom])
        }
        ContactForm::Ellipsoid { radii } => {
            let s = Vec3::from(*radii);
            let n = s.component_mul(d).norm();
            s.component_mul(&s).component_mul(d) / n
        }
        ContactForm::Cylinder { radius, half } => best(&[ring(*radius, *radius, *half), ring(*radius, *radius, -half)]),
        ContactForm::Cone { radius, half } => best(&[Vec3::z() * *half, ring(*radius, *radius, -half)]),
        ContactForm::Frustum { radii: [a, b], top, half } => {
            best(&[ring(a * top, b * top, *half), ring(*a, *b, -half)])
        }
        ContactForm::Hull(corners) => best(corners),
        ContactForm::HalfSpace | ContactForm::Surface(_) => panic!("not convex and bounded"),
    }
}

/// How far two forms are apart along a direction from a to b; never more than their distance.
pub fn separation(a: (&ContactForm, &Pose), b: (&ContactForm, &Pose), n: &Vec3) -> f64 {
    let at = |(f, x): (&ContactForm, &Pose), n: &Vec3| {
        (x * nalgebra::Point3::from(support(f, &x.inverse_transform_vector(n)))).coords
    };
    n.dot(&(at(b, &-n) - at(a, n)))
}

/// One of each bounded convex kind, of random size.
pub fn forms(rng: &mut Random) -> Vec<ContactForm> {
    let mut size = || 0.05 + 0.1 * (rng.unit() + 1.0);
    let mut list = vec![
        ContactForm::Ball { radius: size() },
        ContactForm::Cuboid { half: [size(), size(), size()] },
        ContactForm::RoundCuboid { half: [size(), size(), size()], radius: 0.2 * size() },
        ContactForm::Capsule { bottom: 0.07, top: 0.07, half: size() },
        ContactForm::Capsule { bottom: 0.05, top: 0.09, half: size() },
        ContactForm::Ellipsoid { radii: [size(), size(), size()] },
        ContactForm::Cylinder { radius: size(), half: size() },
        ContactForm::Cone { radius: size(), half: size() },
        ContactForm::Frustum { radii: [size(), size()], top: 0.6, half: size() },
    ];
    let corners: Vec<Vec3> = (0..20).map(|_| rng.vec3(1.0).normalize() * 0.15).collect();
    list.push(ContactForm::Hull(corners.into()));
    list
}
