//! Colliders as Bullet takes them (tables 6-12 and 6-13 of the source).

use super::bridge::{ShapeKind, ShapeSpec};
use super::plan::{array, number};
use crate::engine::principal::Principal;
use crate::math::Pose;
use crate::model::{Collider, Model, Surface};
use crate::shape::ContactForm;

/// One for each collider of the model, in its order.
///
/// # Errors
/// Names the collider that Bullet cannot take.
pub(super) fn specs(m: &Model, bodies: &[Principal], index: &[Option<usize>]) -> Result<Vec<ShapeSpec>, String> {
    m.colliders.iter().map(|c| spec(m, c, bodies, index)).collect()
}

fn spec(m: &Model, c: &Collider, bodies: &[Principal], index: &[Option<usize>]) -> Result<ShapeSpec, String> {
    let (body, x_bl) = m.seat_of(c);
    let seat = match index[body] {
        Some(i) => bodies[i].frame,
        None if body == 0 => Pose::identity(),
        None => return Err(format!("'{}' collides, but has no mass: bullet cannot take that", c.name)),
    };
    let mut spec = ShapeSpec {
        kind: ShapeKind::Plane,
        body: index[body].map_or(-1, number),
        link: c.link.map_or(-1, number),
        pose: array(&(seat.inverse() * x_bl)),
        size: [0.0; 4],
        numbers: vec![],
        triangles: vec![],
        margin: c.margin,
        surface: surface(&c.surface),
    };
    shape(&c.form, &mut spec);
    if body != 0 && matches!(spec.kind, ShapeKind::Plane | ShapeKind::Mesh) {
        return Err(format!("'{}' moves, and a plane or a surface cannot: give it another shape", c.name));
    }
    Ok(spec)
}

/// Friction, rolling and spinning friction, restitution. Where nothing rolls with friction Bullet does not look at spinning
/// friction either.
fn surface(s: &Surface) -> [f64; 4] {
    const LEAST: f64 = 1e-15;
    let rolling = if s.spinning > 0.0 { s.rolling.max(LEAST) } else { s.rolling };
    [s.friction, rolling, s.spinning, s.restitution]
}

fn shape(form: &ContactForm, spec: &mut ShapeSpec) {
    match form {
        ContactForm::HalfSpace => {}
        ContactForm::Ball { radius } => balls(spec, &[[0.0, 0.0, 0.0, *radius]]),
        ContactForm::Cuboid { half } => (spec.kind, spec.size) = (ShapeKind::Box, [half[0], half[1], half[2], 0.0]),
        ContactForm::RoundCuboid { half, radius } => {
            let sign = |k: usize, axis: usize| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let corner = |k: usize| [sign(k, 0) * half[0], sign(k, 1) * half[1], sign(k, 2) * half[2], *radius];
            balls(spec, &[0, 1, 2, 3, 4, 5, 6, 7].map(corner));
        }
        ContactForm::Capsule { bottom, top, half } => {
            balls(spec, &[[0.0, 0.0, -half, *bottom], [0.0, 0.0, *half, *top]]);
        }
        ContactForm::Ellipsoid { radii } => {
            (spec.kind, spec.size) = (ShapeKind::Ellipsoid, [radii[0], radii[1], radii[2], 0.0]);
        }
        ContactForm::Cylinder { radius, half } => {
            (spec.kind, spec.size) = (ShapeKind::Cylinder, [*radius, *half, 0.0, 0.0]);
        }
        ContactForm::Cone { radius, half } => (spec.kind, spec.size) = (ShapeKind::Cone, [*radius, *half, 0.0, 0.0]),
        ContactForm::Frustum { radii, top, half } => {
            (spec.kind, spec.size) = (ShapeKind::Frustum, [radii[0], radii[1], *top, *half]);
        }
        ContactForm::Hull(corners) => {
            spec.kind = ShapeKind::Hull;
            spec.numbers = corners.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        }
        ContactForm::Surface(mesh) => {
            spec.kind = ShapeKind::Mesh;
            spec.numbers = mesh.vertices.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
            spec.triangles = mesh.triangles.iter().flatten().map(|i| number(*i as usize)).collect();
        }
    }
}

/// x, y, z, radius of each.
fn balls(spec: &mut ShapeSpec, balls: &[[f64; 4]]) {
    spec.kind = ShapeKind::Balls;
    spec.numbers = balls.concat();
}
