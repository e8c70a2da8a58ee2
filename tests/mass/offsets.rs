//! The wall as the rate at which a solid grows: true where the surface moves along its normal everywhere, that is for
//! shapes without sharp edges.

use super::weigh::{WALL, weigh};
use proptest::prelude::*;
use realnoid::description::{Dimension, Finish, Geometry, Scaling};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Vec3};
use realnoid::shape::Shape;

/// Mass, first and second moments about the origin.
fn raw(p: &MassProperties) -> (f64, Vec3, Mat3) {
    (p.mass, p.center * p.mass, p.inertia_at_origin())
}

/// Moments of a solid are polynomials of degree five in the offset: the seven-point difference is exact for them.
fn wall_is_growth(shape: impl Fn(f64) -> Shape, step: f64) -> f64 {
    let (mut mass, mut first, mut second) = (0.0, Vec3::zeros(), Mat3::zeros());
    for (k, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        for sign in [1.0, -1.0] {
            let (m, f, s) = raw(&weigh(&shape(sign * k * step), Dimension::Solid));
            let w = sign * weight / (60.0 * step);
            mass += w * m;
            first += f * w;
            second += s * w;
        }
    }
    let Dimension::Hollow { thickness } = WALL else { unreachable!() };
    let (m, f, s) = raw(&weigh(&shape(0.0), WALL));
    let reach = (second.trace() / mass).sqrt();
    let mass_off = (m / thickness / mass - 1.0).abs();
    let first_off = (f / thickness - first).norm() / (mass * reach);
    mass_off.max(first_off).max((s / thickness - second).norm() / second.norm())
}

fn with(geometry: Geometry, fillet: f64) -> Shape {
    Shape::finished(geometry, Finish { fillet, ..Finish::default() }, Scaling::default()).unwrap()
}

/// A shape that has grown by so much on all sides, m.
type Grown<'a> = Box<dyn Fn(f64) -> Shape + 'a>;

proptest! {
    #![proptest_config(ProptestConfig { cases: 30, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_hollow_body_is_the_growth_of_the_solid(l in [0.2..1.0f64, 0.2..1.0, 0.2..1.0], part in 0.3..0.9f64) {
        let [a, b, c] = l;
        let f = part * 0.1;
        let step = f / 10.0;
        let grown = |e: f64| l.map(|s| s + 2.0 * e);
        let shapes: [(&str, Grown); 6] = [
            ("sphere", Box::new(|e| with(Geometry::Sphere { radius: a + e }, 0.0))),
            ("torus", Box::new(|e| with(Geometry::Torus { ring_radius: a + b, pipe_radius: a * part + e }, 0.0))),
            ("capsule", Box::new(|e| with(
                Geometry::Capsule { radius_top: a + e, radius_bottom: a + e, length: c }, 0.0))),
            ("box", Box::new(|e| with(Geometry::Box { size: grown(e) }, f + e))),
            ("cylinder", Box::new(|e| with(Geometry::Cylinder { radius: a + e, length: c + 2.0 * e }, f + e))),
            ("tube", Box::new(|e| with(
                Geometry::Tube { outer_radius: a + b + e, inner_radius: a - e, length: c + 2.0 * e }, f + e))),
        ];
        for (name, shape) in shapes {
            let off = wall_is_growth(shape, step);
            // Rounding of a difference over a step of f/10 of a shape of up to 20 f.
            prop_assert!(off < 1e-11, "{name}: {off:e}");
        }
    }
}
