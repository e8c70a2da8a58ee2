//! Height fields, flat and around a sphere.

use crate::description::Heights;
use crate::math::{Vec3, sin_cos};
use crate::shape::{HeightGrid, MeshFault, Meshes, TriMesh};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// A height field over the XY plane, facing up; open.
pub(super) fn field(size: [f64; 3], heights: &Heights, meshes: &Meshes) -> Result<TriMesh, MeshFault> {
    let Grid { heights, columns, rows } = Grid::of(heights, meshes, 2)?;
    let across = |i: usize, n: usize| i as f64 / (n - 1) as f64 - 0.5;
    let at = |(i, height): (usize, &f64)| {
        Vec3::new(size[0] * across(i % columns, columns), -size[1] * across(i / columns, rows), size[2] * height)
    };
    let index = |row: usize, column: usize| (row * columns + column) as u32;
    let mut mesh = TriMesh { vertices: heights.values.iter().enumerate().map(at).collect(), triangles: vec![] };
    for row in 1..rows {
        for column in 1..columns {
            let (north_west, north_east) = (index(row - 1, column - 1), index(row - 1, column));
            let (south_west, south_east) = (index(row, column - 1), index(row, column));
            mesh.triangles.push([south_west, south_east, north_east]);
            mesh.triangles.push([south_west, north_east, north_west]);
        }
    }
    Ok(mesh)
}

/// A sphere with heights; closed. The first and the last row are the poles: each takes the mean of its row.
pub(super) fn globe(radius: f64, height: f64, heights: &Heights, meshes: &Meshes) -> Result<TriMesh, MeshFault> {
    let Grid { heights, columns, rows } = Grid::of(heights, meshes, 3)?;
    let distance = |value: f64| radius + height * value;
    if let Some(deepest) = heights.values.iter().copied().map(distance).find(|d| *d <= 0.0) {
        return Err(MeshFault::Terrain(format!(
            "the terrain is {deepest} m from the centre of its sphere at one place; radius + height × value must stay above 0"
        )));
    }
    let row_of = |row: usize| &heights.values[row * columns..(row + 1) * columns];
    let pole = |row: usize| distance(row_of(row).iter().sum::<f64>() / columns as f64);
    let mut vertices = vec![Vec3::new(0.0, 0.0, pole(0)), Vec3::new(0.0, 0.0, -pole(rows - 1))];
    for row in 1..rows - 1 {
        let (up, out) = sin_cos(FRAC_PI_2 - PI * row as f64 / (rows - 1) as f64);
        for (column, value) in row_of(row).iter().enumerate() {
            let (sine, cosine) = sin_cos(TAU * column as f64 / columns as f64);
            vertices.push(Vec3::new(out * cosine, out * sine, up) * distance(*value));
        }
    }
    Ok(TriMesh { vertices, triangles: globe_triangles(rows, columns) })
}

fn globe_triangles(rows: usize, columns: usize) -> Vec<[u32; 3]> {
    let index = |row: usize, column: usize| (2 + (row - 1) * columns + column % columns) as u32;
    let mut triangles = Vec::with_capacity(2 * columns * (rows - 2));
    for west in 0..columns {
        let east = west + 1;
        triangles.push([0, index(1, west), index(1, east)]);
        for south in 2..rows - 1 {
            let north = south - 1;
            triangles.push([index(south, west), index(south, east), index(north, east)]);
            triangles.push([index(south, west), index(north, east), index(north, west)]);
        }
        triangles.push([1, index(rows - 2, east), index(rows - 2, west)]);
    }
    triangles
}

/// Values known to be finite and in whole rows.
struct Grid {
    heights: Arc<HeightGrid>,
    columns: usize,
    rows: usize,
}

impl Grid {
    fn of(heights: &Heights, meshes: &Meshes, least: usize) -> Result<Self, MeshFault> {
        let heights = match heights {
            Heights::Written { columns, values } => Arc::new(HeightGrid { columns: *columns, values: values.clone() }),
            Heights::File { filename } => meshes.heights(filename)?,
        };
        let (columns, count) = (heights.columns, heights.values.len());
        let rows = count.checked_div(columns).unwrap_or(0);
        if columns < least || rows < least || rows * columns != count {
            return Err(MeshFault::Terrain(format!(
                "{count} heights in rows of {columns} make no surface: this terrain needs whole rows, at least {least} of \
                 at least {least} values"
            )));
        }
        if let Some(i) = heights.values.iter().position(|v| !v.is_finite()) {
            let value = heights.values[i];
            return Err(MeshFault::Terrain(format!(
                "height {} in row {} is {value}",
                i % columns + 1,
                i / columns + 1
            )));
        }
        Ok(Self { heights, columns, rows })
    }
}
