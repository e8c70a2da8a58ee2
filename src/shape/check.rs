//! Which sizes make a shape.

use super::outline::{Corner, fits, profile};
use crate::description::{Finish, Geometry};

/// Why sizes make no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeFault {
    /// A size that encloses nothing.
    #[error("{0} encloses no volume: {1}")]
    NoVolume(&'static str, String),
    /// A fillet wider than the edge's neighbourhood.
    #[error("a fillet of {0} m does not fit on this <{1}>")]
    Fillet(f64, &'static str),
    /// A quad whose edges cross, or that is folded over.
    #[error("this <quad> crosses itself or is folded over: its corners must go around it in order")]
    Crossing,
    /// No length ratio.
    #[error("scale factor {0} deforms nothing into a shape")]
    Scale(f64),
    /// A slice of nothing, or of more than the whole.
    #[error("a slice from {0} to {1} rad is no part of a turn")]
    Slice(f64, f64),
}

/// Every length must be a positive number; the ends of a capsule or frustum may shrink to a point.
pub(super) fn check(geometry: &Geometry, finish: &Finish) -> Result<(), ShapeFault> {
    sizes(geometry)?;
    if let Some([from, to]) = finish.slice
        && !(to > from && to - from < std::f64::consts::TAU)
    {
        return Err(ShapeFault::Slice(from, to));
    }
    let kind = geometry.kind();
    let widest = finish.fillet.max(finish.top_fillet.unwrap_or(0.0));
    let not_negative = |f: f64| f >= 0.0 && f.is_finite();
    if !(not_negative(finish.fillet) && finish.top_fillet.is_none_or(not_negative)) {
        return Err(ShapeFault::Fillet(finish.fillet, kind));
    }
    let room = match geometry {
        Geometry::Box { size } => widest <= size.iter().fold(f64::INFINITY, |a, b| a.min(*b)) / 2.0,
        _ => profile(geometry, finish).is_none_or(|corners: Vec<Corner>| fits(&corners)),
    };
    if room { Ok(()) } else { Err(ShapeFault::Fillet(widest, kind)) }
}

fn sizes(geometry: &Geometry) -> Result<(), ShapeFault> {
    match *geometry {
        Geometry::Box { size: [x, y, z] } => positive("a box", &[("x", x), ("y", y), ("z", z)]),
        Geometry::Sphere { radius } => positive("a sphere", &[("radius", radius)]),
        Geometry::Ellipsoid { radii: [x, y, z] } => {
            positive("an ellipsoid", &[("x radius", x), ("y radius", y), ("z radius", z)])
        }
        Geometry::Cylinder { radius, length } => positive("a cylinder", &[("radius", radius), ("length", length)]),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => {
            positive("an elliptic cylinder", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])
        }
        Geometry::Capsule { radius_top, radius_bottom, length } => {
            not_negative("a capsule", &[("radius_top", radius_top), ("radius_bottom", radius_bottom)])?;
            not_negative("a capsule", &[("length", length)])?;
            positive("a capsule", &[("larger radius", radius_top.max(radius_bottom))])
        }
        Geometry::Tube { outer_radius, inner_radius, length } => {
            positive("a tube", &[("inner_radius", inner_radius), ("length", length)])?;
            positive("a tube", &[("wall, outer_radius − inner_radius,", outer_radius - inner_radius)])
        }
        Geometry::Cone { radius_x, radius_y, length } => {
            positive("a cone", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])
        }
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
            positive("a frustum", &[("radius_x", radius_x), ("radius_y", radius_y), ("length", length)])?;
            not_negative("a frustum", &[("top_scale", top_scale)])
        }
        _ => rarer_sizes(geometry),
    }
}

fn rarer_sizes(geometry: &Geometry) -> Result<(), ShapeFault> {
    match *geometry {
        Geometry::Hemisphere { radius } => positive("a hemisphere", &[("radius", radius)]),
        Geometry::Torus { ring_radius, pipe_radius } => {
            positive("a torus", &[("pipe_radius", pipe_radius)])?;
            not_negative("a torus", &[("hole, ring_radius − pipe_radius,", ring_radius - pipe_radius)])
        }
        Geometry::OilTank { radius, length, cap_height } => {
            positive("an oil tank", &[("radius", radius), ("cap_height", cap_height)])?;
            not_negative("an oil tank", &[("length", length), ("radius − cap_height", radius - cap_height)])
        }
        Geometry::Pyramid { size: [x, y, z] } => positive("a pyramid", &[("x", x), ("y", y), ("z", z)]),
        Geometry::Polyhedron { faces, radius } => {
            positive("a polyhedron", &[("radius", radius)])?;
            let known = [4, 6, 8, 12, 20].contains(&faces);
            positive("a polyhedron", &[("number of faces (4, 6, 8, 12 or 20)", if known { 1.0 } else { f64::NAN })])
        }
        Geometry::Disc { outer_radius, inner_radius } => {
            not_negative("a disc", &[("inner_radius", inner_radius)])?;
            positive("a disc", &[("width, outer_radius − inner_radius,", outer_radius - inner_radius)])
        }
        Geometry::Plane { size: [x, y] } => positive("a plane", &[("x", x), ("y", y)]),
        Geometry::Terrain { size: [x, y, z], .. } => positive("a terrain", &[("x", x), ("y", y), ("z", z)]),
        Geometry::SphericalTerrain { radius, height, .. } => {
            positive("a terrain", &[("radius", radius), ("height", height)])
        }
        Geometry::Mesh { scale: [x, y, z], .. } => {
            refuse_unless("a mesh", &[("x", x), ("y", y), ("z", z)], |v| v != 0.0 && v.is_finite())
        }
        _ => Ok(()),
    }
}

fn positive(what: &'static str, sizes: &[(&str, f64)]) -> Result<(), ShapeFault> {
    refuse_unless(what, sizes, |v| v > 0.0 && v.is_finite())
}

fn not_negative(what: &'static str, sizes: &[(&str, f64)]) -> Result<(), ShapeFault> {
    refuse_unless(what, sizes, |v| v >= 0.0 && v.is_finite())
}

fn refuse_unless(what: &'static str, sizes: &[(&str, f64)], fits: fn(f64) -> bool) -> Result<(), ShapeFault> {
    match sizes.iter().find(|(_, value)| !fits(*value)) {
        Some((name, value)) => Err(ShapeFault::NoVolume(what, format!("its {name} is {value}"))),
        None => Ok(()),
    }
}
