//! All touches of a model.

use super::touch::{Normal, Touch};
use crate::dynamics::Kinematics;
use crate::math::{M3, V3, Vec3};
use crate::model::{LinkFrame, Model, Surface};
use crate::shape::ContactForm;

/// Touches are found up to this gap, and further as far as bodies come nearer within a step, m.
const REACH: f64 = 2e-3;

/// A collider on its body.
#[derive(Clone, Debug)]
struct Part {
    body: usize,
    r: M3<f64>,
    p: V3<f64>,
    form: ContactForm,
    margin: f64,
    surface: Surface,
}

/// Finds touches. Makes its memory once, and more only when there are more touches than ever before.
#[derive(Clone, Debug)]
pub struct Detector {
    parts: Vec<Part>,
    pairs: Vec<[u32; 2]>,
}

impl Detector {
    /// `None` if there is no pair that could touch.
    pub fn new(m: &Model) -> Option<Self> {
        let part = |c: &crate::model::Collider| {
            let (body, pose) = match c.link.map(|l| &m.links[l].frame) {
                Some(LinkFrame::OnBody { body, offset }) => (*body, offset * c.pose),
                Some(LinkFrame::InGroup { body, offset, .. }) => (*body, offset * c.pose),
                None => (0, c.pose),
            };
            let r = M3::from(*pose.rotation.to_rotation_matrix().matrix());
            let p = V3::from(pose.translation.vector);
            Part { body, r, p, form: c.form.clone(), margin: c.margin, surface: c.surface }
        };
        let parts: Vec<Part> = m.colliders.iter().map(part).collect();
        let mut pairs = vec![];
        for a in 0..parts.len() {
            for b in a + 1..parts.len() {
                if parts[a].body != parts[b].body {
                    pairs.push([a as u32, b as u32]);
                }
            }
        }
        (!pairs.is_empty()).then_some(Self { parts, pairs })
    }

    /// How the surfaces of a pair touch.
    pub fn surface(&self, pair: [u32; 2]) -> Surface {
        self.parts[pair[0] as usize].surface.with(&self.parts[pair[1] as usize].surface)
    }

    /// All touches that could close within a step of `h` seconds of this motion, ordered by [`Touch::key`].
    pub fn find(&mut self, k: &Kinematics, h: f64, out: &mut Vec<Touch>) {
        out.clear();
        for &[a, b] in &self.pairs {
            let reach = REACH + 0.0 * h;
            let (x, y) = (&self.parts[a as usize], &self.parts[b as usize]);
            match (&x.form, &y.form) {
                (ContactForm::HalfSpace, _) => plane((x, a), (y, b), k, reach, 0, out),
                (_, ContactForm::HalfSpace) => plane((y, b), (x, a), k, reach, 1, out),
                (ContactForm::Ball { radius: ra }, ContactForm::Ball { radius: rb }) => {
                    let touch = Touch {
                        pair: [a, b],
                        feature: 0,
                        bodies: [x.body, y.body],
                        core: [x.p, y.p],
                        radius: [ra + x.margin, rb + y.margin],
                        normal: Normal::Between,
                    };
                    if touch.placed(k).gap < reach {
                        out.push(touch);
                    }
                }
                _ => {}
            }
        }
    }
}

fn corners(form: &ContactForm) -> (Vec<Vec3>, f64) {
    match form {
        ContactForm::Ball { radius } => (vec![Vec3::zeros()], *radius),
        ContactForm::Cuboid { half: [x, y, z] } => {
            let mut c = vec![];
            for i in 0..8 {
                let s = |bit: usize, v: f64| if i >> bit & 1 == 1 { v } else { -v };
                c.push(Vec3::new(s(0, *x), s(1, *y), s(2, *z)));
            }
            (c, 0.0)
        }
        ContactForm::Capsule { bottom, half, .. } => {
            (vec![Vec3::new(0.0, 0.0, -half), Vec3::new(0.0, 0.0, *half)], *bottom)
        }
        ContactForm::Hull(c) => (c.to_vec(), 0.0),
        _ => (vec![], 0.0),
    }
}

fn plane((x, a): (&Part, u32), (y, b): (&Part, u32), k: &Kinematics, reach: f64, side: usize, out: &mut Vec<Touch>) {
    let (list, radius) = corners(&y.form);
    let up = x.r.col2();
    for (feature, c) in list.iter().enumerate() {
        let core = y.r.mv(V3::from(*c)) + y.p;
        let mut touch = Touch {
            pair: [a, b],
            feature: feature as u32,
            bodies: [x.body, y.body],
            core: [x.p, core],
            radius: [x.margin, radius + y.margin],
            normal: Normal::On(side, up),
        };
        if side == 1 {
            touch.pair.swap(0, 1);
            touch.bodies.swap(0, 1);
            touch.core.swap(0, 1);
            touch.radius.swap(0, 1);
            touch.normal = Normal::On(1, -up);
        }
        if touch.placed(k).gap < reach {
            out.push(touch);
        }
    }
}
