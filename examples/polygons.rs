//! What polygons cost in accuracy, and exact shapes in time: the tables of docs/polygons.md.
//!
//! `cargo run --release --example polygons > docs/polygons.md`

use realnoid::description::{Dimension, Geometry, Scaling, Subdivision, Substance};
use realnoid::mass::{Refusal, ShapeMass, of_shape};
use realnoid::shape::{Meshes, Shape};
use std::time::Instant;

const SEGMENTS: [u32; 6] = [8, 16, 36, 64, 128, 512];
const WALL: Dimension = Dimension::Hollow { thickness: 0.003 };

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{HEAD}");
    println!("| shape | {} |", SEGMENTS.map(|n| n.to_string()).join(" | "));
    println!("|---|{}", "---|".repeat(SEGMENTS.len()));
    for (name, geometry) in solids() {
        println!("| {name} | {} |", errors(&Shape::new(geometry)?)?.join(" | "));
    }
    println!("{MIDDLE}");
    for (name, geometry) in solids() {
        let shape = Shape::new(geometry)?;
        let stretched = Shape::finished(shape.geometry.clone(), shape.finish, unequal())?;
        let times = [
            time(|| weigh(&shape, Dimension::Solid, None))?,
            time(|| weigh(&shape, WALL, None))?,
            time(|| weigh(&stretched, WALL, None))?,
            time(|| weigh(&shape, Dimension::Solid, Some(36)))?,
            time(|| weigh(&shape, Dimension::Solid, Some(512)))?,
        ];
        println!(
            "| {name} | {} |",
            times.map(|t| if t < 10.0 { format!("{t:.2}") } else { format!("{t:.0}") }).join(" | ")
        );
    }
    Ok(())
}

const HEAD: &str = "# What polygons cost

Written by `cargo run --release --example polygons > docs/polygons.md`.

A `<shape polygonise=\"true\">` is the mesh inscribed in the primitive. It is lighter than the primitive; the error of the greatest moment of inertia, relative, by
`segments` of a full turn falls with their square. Take polygons only where another program does: the exact shape is the default, and costs less.
";

const MIDDLE: &str = "
Time to weigh one shape, µs, once when a robot is loaded (median of 15, on the machine that wrote this page); *stretched*: by 1, 1.5 and 2 along its axes, where the surface
has no formula and is integrated numerically.

| shape | solid | hollow | hollow, stretched | solid, 36 segments | solid, 512 segments |
|---|---|---|---|---|---|";

fn solids() -> Vec<(&'static str, Geometry)> {
    let (radius, length) = (0.1, 0.4);
    vec![
        ("sphere", Geometry::Sphere { radius }),
        ("cylinder", Geometry::Cylinder { radius, length }),
        ("capsule", Geometry::Capsule { radius_top: radius, radius_bottom: radius, length }),
        ("tapered capsule", Geometry::Capsule { radius_top: 0.06, radius_bottom: radius, length }),
        ("tube", Geometry::Tube { outer_radius: radius, inner_radius: 0.08, length }),
        ("cone", Geometry::Cone { radius_x: radius, radius_y: radius, length }),
        ("frustum", Geometry::Frustum { radius_x: radius, radius_y: radius, top_scale: 0.5, length }),
    ]
}

fn unequal() -> Scaling {
    Scaling { factors: [1.0, 1.5, 2.0], ..Scaling::default() }
}

fn weigh(shape: &Shape, dimension: Dimension, around: Option<u32>) -> Result<ShapeMass, Refusal> {
    let polygonise = around.map(|around| Subdivision { around, flat: 1 });
    of_shape(shape, &Substance { specific_gravity: 1.0, dimension, polygonise }, &Meshes::default())
}

/// Of the greatest principal moment, per number of segments.
fn errors(shape: &Shape) -> Result<Vec<String>, Refusal> {
    let greatest = |around| weigh(shape, Dimension::Solid, around).map(|m| m.properties.principal().moments[2]);
    let exact = greatest(None)?;
    SEGMENTS.iter().map(|n| Ok(format!("{:.1e}", greatest(Some(*n))? / exact - 1.0))).collect()
}

/// Median of 15 samples of at least a millisecond each, µs.
fn time<T>(work: impl Fn() -> Result<T, Refusal>) -> Result<f64, Refusal> {
    let sample = |calls: u32| -> Result<f64, Refusal> {
        let start = Instant::now();
        for _ in 0..calls {
            std::hint::black_box(work()?);
        }
        Ok(start.elapsed().as_secs_f64() * 1e6)
    };
    let mut calls = 1;
    while sample(calls)? < 1e3 {
        calls *= 2;
    }
    let mut times = Vec::new();
    for _ in 0..15 {
        times.push(sample(calls)? / f64::from(calls));
    }
    times.sort_by(f64::total_cmp);
    Ok(times[7])
}
