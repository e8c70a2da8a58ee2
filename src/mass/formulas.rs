//! The exact moments of each primitive: its closed formula, or an integral over its outline.

use super::moments::Moments;
use super::of_shape::Method;
use super::{
    capsule, cuboid, cylinder, ellipsoid, flat, frustum, lathe_solid, lathe_surface, oil_tank, pyramid, torus,
};
use crate::description::{Finish, Geometry};
use crate::math::Vec3;
use crate::shape::{Shape, lathe};

type Exact = Option<(Moments, Method)>;

/// Of the inside. `None`: there is only its polygon mesh. The shape must not be open.
pub(super) fn solid(shape: &Shape) -> Exact {
    let stretch = shape.stretch;
    if let Some(moments) = solid_formula(&shape.geometry, &shape.finish) {
        return Some((moments.stretched(stretch, stretch.iter().product::<f64>().abs()), Method::Formula));
    }
    lathe(shape).map(|outline| (lathe_solid::solid(&outline), Method::Quadrature))
}

/// Has it its plain form, with neither fillet nor slice?
fn is_plain(finish: &Finish) -> bool {
    finish.slice.is_none() && finish.fillet == 0.0 && finish.top_fillet.is_none_or(|f| f == 0.0)
}

fn solid_formula(geometry: &Geometry, finish: &Finish) -> Option<Moments> {
    if let Geometry::Box { size } = *geometry {
        let rounded = finish.fillet > 0.0;
        return Some(if rounded { cuboid::solid_rounded(size, finish.fillet) } else { cuboid::solid(size) });
    }
    if !is_plain(finish) {
        return None;
    }
    Some(match *geometry {
        Geometry::Sphere { radius } => ellipsoid::solid([radius; 3]),
        Geometry::Ellipsoid { radii } => ellipsoid::solid(radii),
        Geometry::Cylinder { radius, length } => cylinder::solid(radius, radius, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => cylinder::solid(radius_x, radius_y, length),
        Geometry::Capsule { radius_top, radius_bottom, length } => capsule::solid(radius_top, radius_bottom, length),
        Geometry::Tube { outer_radius, inner_radius, length } => {
            cylinder::solid_tube(outer_radius, inner_radius, length)
        }
        Geometry::Cone { radius_x, radius_y, length } => frustum::solid(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            frustum::solid(radius_x, radius_y, top_scale, length)
        }
        Geometry::Torus { ring_radius, pipe_radius } => torus::solid(ring_radius, pipe_radius),
        Geometry::OilTank { radius, length, cap_height } => oil_tank::solid(radius, length, cap_height),
        Geometry::Pyramid { size } => pyramid::solid(size),
        _ => return None,
    })
}

/// Of the surface. `None`: there is only its polygon mesh.
pub(super) fn surface(shape: &Shape) -> Exact {
    let stretch = shape.stretch;
    let [x, y, z] = stretch.map(f64::abs);
    if let Some(plate) = plate(shape) {
        return Some((plate, Method::Formula));
    }
    if let Geometry::Box { size } = shape.geometry
        && shape.finish.fillet > 0.0
    {
        let method = if x == y && y == z { Method::Formula } else { Method::Quadrature };
        return Some((cuboid::surface_rounded(size, shape.finish.fillet, stretch), method));
    }
    if let Geometry::Box { size: [a, b, c] } = shape.geometry {
        return Some((cuboid::surface([a * x, b * y, c * z]), Method::Formula));
    }
    if x == y
        && y == z
        && is_plain(&shape.finish)
        && let Some((moments, method)) = surface_formula(&shape.geometry, shape.finish.open)
    {
        return Some((moments.stretched(stretch, x * x), method));
    }
    lathe(shape).map(|outline| (lathe_surface::surface(&outline), Method::Quadrature))
}

/// What is flat stays flat under any factors.
fn plate(shape: &Shape) -> Option<Moments> {
    let [x, y, _] = shape.stretch;
    let corner = |at: [f64; 3]| Vec3::from(at).component_mul(&Vec3::from(shape.stretch));
    let grown = |moments: Moments| moments.stretched(shape.stretch, (x * y).abs());
    match shape.geometry {
        Geometry::Disc { outer_radius, inner_radius } if shape.finish.slice.is_none() => {
            Some(grown(flat::disc(outer_radius, inner_radius)))
        }
        Geometry::Plane { size } => Some(grown(flat::rectangle(size))),
        Geometry::Triangle { corners } => Some(flat::triangle(corners.map(corner))),
        Geometry::Quad { corners } => {
            let [a, b, c, d] = corners.map(corner);
            Some(Moments::join([flat::triangle([a, b, c]), flat::triangle([a, c, d])]))
        }
        _ => None,
    }
}

fn surface_formula(geometry: &Geometry, open: bool) -> Option<(Moments, Method)> {
    let frustum_surface = |a: f64, b: f64, top_scale: f64, length: f64| {
        let round = if a == b { Method::Formula } else { Method::Quadrature };
        let whole = if open {
            frustum::mantle(a, b, [1.0, top_scale], length)
        } else {
            frustum::surface(a, b, top_scale, length)
        };
        (whole, round)
    };
    let formula = |moments: Moments| (moments, Method::Formula);
    Some(match *geometry {
        Geometry::Sphere { radius } => formula(ellipsoid::sphere_surface(radius)),
        Geometry::Ellipsoid { radii: [a, b, c] } if a == b && b == c => formula(ellipsoid::sphere_surface(a)),
        Geometry::Ellipsoid { radii } => (ellipsoid::surface(radii), Method::Quadrature),
        Geometry::Hemisphere { radius } => formula(ellipsoid::hemisphere_surface(radius)),
        Geometry::Cylinder { radius, length } => frustum_surface(radius, radius, 1.0, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => frustum_surface(radius_x, radius_y, 1.0, length),
        Geometry::Cone { radius_x, radius_y, length } => frustum_surface(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            frustum_surface(radius_x, radius_y, top_scale, length)
        }
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            formula(capsule::surface(radius_top, radius_bottom, length))
        }
        Geometry::Tube { outer_radius, inner_radius, length } => {
            formula(cylinder::tube_surface(outer_radius, inner_radius, length))
        }
        Geometry::Torus { ring_radius, pipe_radius } => formula(torus::surface(ring_radius, pipe_radius)),
        Geometry::OilTank { radius, length, cap_height } => formula(oil_tank::surface(radius, length, cap_height)),
        _ => return None,
    })
}
