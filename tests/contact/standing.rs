//! What stands in a scene: a floor, or a surface of triangles; and how far something is inside of it, by formulas of its own.

use crate::scene::support;
use crate::support::Random;
use realnoid::math::{Pose, Vec3};
use realnoid::shape::{ContactForm, TriMesh};
use std::sync::Arc;

/// Segments of a turn, as many as a URDF's shapes get.
const AROUND: u32 = 48;
/// Heights per side of a terrain.
const SIDE: usize = 13;
/// Edge of a cell of it, m.
const CELL: f64 = 0.5;

/// What stands.
#[derive(Clone, Debug)]
pub enum Standing {
    Nothing,
    Floor,
    /// Heights, m, in rows along x; the middle is at 0.
    Terrain(Vec<f64>),
    /// About z, on the floor of a terrain of no height: radius of the ring and of its section, m.
    Torus(f64, f64),
    /// A pipe about z that stands on z = 0: inner and outer radius, height, m; with a floor below.
    Pipe(f64, f64, f64),
}

impl Standing {
    pub fn draw(rng: &mut Random) -> Self {
        let share = |rng: &mut Random| 0.5 * (rng.unit() + 1.0);
        match rng.next() % 3 {
            0 => {
                let rough = 0.25 * share(rng);
                Self::Terrain((0..SIDE * SIDE).map(|_| rough * share(rng)).collect())
            }
            1 => Self::Torus(0.15 + 0.35 * share(rng), 0.05 + 0.1 * share(rng)),
            _ => {
                let inner = 0.05 + 0.4 * share(rng);
                Self::Pipe(inner, inner + 0.02 + 0.1 * share(rng), 0.1 + 0.2 * share(rng))
            }
        }
    }

    /// Colliders of the world.
    pub fn forms(&self) -> Vec<ContactForm> {
        let surface = |mesh: TriMesh| ContactForm::Surface(Arc::new(mesh));
        match self {
            Self::Nothing => vec![],
            Self::Floor => vec![ContactForm::HalfSpace],
            Self::Terrain(heights) => vec![surface(terrain(heights))],
            Self::Torus(ring, section) => {
                let around = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(AROUND);
                let section: Vec<[f64; 2]> = (0..AROUND)
                    .map(|k| [ring + section * around(k).cos(), section * (1.0 + around(k).sin())])
                    .collect();
                vec![ContactForm::HalfSpace, surface(turned(&section))]
            }
            Self::Pipe(inner, outer, height) => {
                let section = [[*outer, 0.0], [*outer, *height], [*inner, *height], [*inner, 0.0]];
                vec![ContactForm::HalfSpace, surface(turned(&section))]
            }
        }
    }

    /// How much lower than 0 a body may be placed, m.
    pub fn top(&self) -> f64 {
        match self {
            Self::Nothing | Self::Floor => 0.0,
            Self::Terrain(heights) => heights.iter().copied().fold(0.0, f64::max),
            Self::Torus(_, section) => 2.0 * section,
            Self::Pipe(_, _, height) => *height,
        }
    }

    /// Corners of the surface.
    pub fn corners(&self) -> Vec<Vec3> {
        let of = |form: ContactForm| if let ContactForm::Surface(mesh) = form { mesh.vertices.clone() } else { vec![] };
        self.forms().into_iter().flat_map(of).collect()
    }

    /// How far a body is inside, m: at points of its boundary, and at these corners of the surface. `None` where an open surface
    /// does not reach.
    pub fn sunk(&self, corners: &[Vec3], form: &ContactForm, x: &Pose) -> Option<f64> {
        let mut most = 0.0f64;
        if let Self::Terrain(_) = self {
            let reach = 0.5 * CELL * (SIDE - 1) as f64 - 0.6;
            if x.translation.vector.x.abs().max(x.translation.vector.y.abs()) > reach {
                return None;
            }
        }
        let down = x.inverse_transform_vector(&-Vec3::z());
        let lowest = (x * nalgebra::Point3::from(support(form, &down))).coords.z;
        match self {
            Self::Nothing => return Some(0.0),
            Self::Floor => return Some(-lowest),
            Self::Terrain(_) => {}
            _ => most = most.max(-lowest),
        }
        for d in around() {
            most = most.max(self.depth((x * nalgebra::Point3::from(support(form, &d))).coords));
        }
        // What stands may poke into a body between those points.
        for corner in corners.iter().filter(|c| (*c - x.translation.vector).norm() < 0.45) {
            most = most.max(covered(form, &x.inverse_transform_point(&(*corner).into()).coords, most));
        }
        Some(most.max(self.depth(x.translation.vector)))
    }

    /// Of a point, m.
    fn depth(&self, p: Vec3) -> f64 {
        let r = p.x.hypot(p.y);
        match self {
            Self::Nothing | Self::Floor => 0.0,
            Self::Terrain(heights) => under(heights, p),
            Self::Torus(ring, section) => section - (r - ring).hypot(p.z - section),
            Self::Pipe(inner, outer, height) => (r - inner).min(outer - r).min(height - p.z),
        }
    }
}

/// Directions all around.
fn around() -> impl Iterator<Item = Vec3> {
    let digit = |i: i32, k: i32| f64::from(i / k % 5 - 2);
    (0..125).filter(|i| *i != 62).map(move |i| Vec3::new(digit(i, 1), digit(i, 5), digit(i, 25)).normalize())
}

/// How deep a point lies in a convex form, m; any less than `enough` where it is less.
fn covered(form: &ContactForm, p: &Vec3, enough: f64) -> f64 {
    let out = |n: &Vec3| n.dot(&(support(form, n) - p));
    let mut best = (f64::INFINITY, Vec3::z());
    for n in around() {
        best = if out(&n) < best.0 { (out(&n), n) } else { best };
        if best.0 <= enough {
            return best.0;
        }
    }
    let (mut rng, mut wide) = (Random(1), 0.5);
    for _ in 0..300 {
        let n = (best.1 + rng.vec3(wide)).normalize();
        if out(&n) < best.0 {
            best = (out(&n), n);
        } else {
            wide = (0.97 * wide).max(1e-4);
        }
    }
    best.0
}

fn terrain(heights: &[f64]) -> TriMesh {
    let at = |i: usize| 0.5 * CELL * (2.0 * i as f64 - (SIDE - 1) as f64);
    let vertices = heights.iter().enumerate().map(|(i, z)| Vec3::new(at(i % SIDE), at(i / SIDE), *z)).collect();
    let mut mesh = TriMesh { vertices, triangles: vec![] };
    for row in 0..SIDE as u32 - 1 {
        for column in 0..SIDE as u32 - 1 {
            let [a, b] = [0, 1].map(|up| (row + up) * SIDE as u32 + column);
            mesh.triangles.push([a, a + 1, b + 1]);
            mesh.triangles.push([a, b + 1, b]);
        }
    }
    mesh
}

/// How far a point is from the plane of the triangle above it, m; 0 where it is not below.
fn under(heights: &[f64], p: Vec3) -> f64 {
    let place = |x: f64| x / CELL + 0.5 * (SIDE - 1) as f64;
    let (u, v) = (place(p.x), place(p.y));
    let (i, j) = (u.floor(), v.floor());
    if i < 0.0 || j < 0.0 || i >= (SIDE - 1) as f64 || j >= (SIDE - 1) as f64 {
        return 0.0;
    }
    let z = |di: usize, dj: usize| heights[(j as usize + dj) * SIDE + i as usize + di];
    let (s, t) = (u - i, v - j);
    let (gx, gy) = if s > t { (z(1, 0) - z(0, 0), z(1, 1) - z(1, 0)) } else { (z(1, 1) - z(0, 1), z(0, 1) - z(0, 0)) };
    let below = z(0, 0) + gx * s + gy * t - p.z;
    (below / (1.0 + (gx * gx + gy * gy) / (CELL * CELL)).sqrt()).max(0.0)
}

/// A closed section (r, z), anticlockwise with r to the right, turned about z.
fn turned(section: &[[f64; 2]]) -> TriMesh {
    let n = section.len() as u32;
    let mut mesh = TriMesh::default();
    for k in 0..AROUND {
        let (s, c) = (f64::from(k) * std::f64::consts::TAU / f64::from(AROUND)).sin_cos();
        mesh.vertices.extend(section.iter().map(|[r, z]| Vec3::new(r * c, r * s, *z)));
        for i in 0..n {
            let (a, b) = (k * n + i, k * n + (i + 1) % n);
            let [c, d] = [a, b].map(|v| (v + n) % (AROUND * n));
            mesh.triangles.push([a, c, d]);
            mesh.triangles.push([a, d, b]);
        }
    }
    mesh
}

#[test]
fn meshes_enclose_what_the_formulas_say() {
    for standing in [Standing::Torus(0.4, 0.1), Standing::Pipe(0.2, 0.3, 0.25)] {
        let forms = standing.forms();
        let Some(ContactForm::Surface(mesh)) = forms.last() else { panic!("no surface") };
        let volume: f64 =
            mesh.triangles.iter().map(|t| mesh.corners(*t)).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum();
        let pi = std::f64::consts::PI;
        let exact = match standing {
            Standing::Torus(ring, section) => 2.0 * pi * pi * ring * section * section,
            Standing::Pipe(inner, outer, height) => pi * (outer * outer - inner * inner) * height,
            _ => 0.0,
        };
        // Chords of 48 segments take 2π²/3·48⁻² of a circle's area away, twice for the torus.
        assert!(volume < exact && volume > exact * (1.0 - 6e-3), "{standing:?}: {volume} of {exact}");
    }
}
