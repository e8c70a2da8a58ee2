//! The furthest corner of a hull of many corners: uphill along its edges from one that is near, as on a convex body every
//! corner without a higher neighbour is the highest (Gilbert, Johnson and Foo 1990, made GJK one of nearly constant time so).

use crate::math::V3;

/// Hulls of fewer corners are looked through.
const FEW: usize = 32;
/// Directions per edge of the cube around the origin for which the corner to start from is known.
const CELLS: usize = 6;
/// Heights that differ by less than this share of the size are the same.
const SAME: f64 = 1e-12;

/// Edges of a hull, and where to start.
#[derive(Clone, Debug)]
pub(super) struct Climb {
    /// Where the neighbours of each corner begin in `next`; one more at the end.
    starts: Vec<u32>,
    next: Vec<u32>,
    /// The highest corner of the direction in the middle of each cell of the cube.
    cells: Vec<u32>,
}

impl Climb {
    /// `None` where looking through all corners is as fast, or climbing does not find the highest of them: a hull that is not quite convex.
    pub(super) fn of<'a>(points: &[V3<f64>], faces: impl Iterator<Item = &'a [u32]>) -> Option<Self> {
        if points.len() < FEW {
            return None;
        }
        let (starts, next) = neighbours(points.len(), faces);
        let highest = |cell: usize| highest(points, middle(cell)).0 as u32;
        let made = Self { starts, next, cells: (0..6 * CELLS * CELLS).map(highest).collect() };
        made.is_right(points).then_some(made)
    }

    /// The furthest corner in a direction of any length.
    pub(super) fn support(&self, points: &[V3<f64>], d: V3<f64>) -> V3<f64> {
        self.climb(points, self.cells[cell(d)], d)
    }

    fn climb(&self, points: &[V3<f64>], from: u32, d: V3<f64>) -> V3<f64> {
        let mut at = points[from as usize];
        let (mut corner, mut reach) = (from as usize, at.dot(d));
        loop {
            let mut better = None;
            for i in &self.next[self.starts[corner] as usize..self.starts[corner + 1] as usize] {
                let p = points[*i as usize];
                let to = p.dot(d);
                if to > reach {
                    (reach, at, better) = (to, p, Some(*i as usize));
                }
            }
            match better {
                Some(next) => corner = next,
                None => return at,
            }
        }
    }

    /// Does every direction's highest corner turn out as high from the other side of the hull?
    fn is_right(&self, points: &[V3<f64>]) -> bool {
        let size = points.iter().fold(0.0_f64, |size, p| size.max(p.dot(*p))).sqrt();
        (0..self.cells.len()).all(|i| {
            let d = middle(i);
            let opposite = self.cells[cell(-d)];
            let found = self.climb(points, opposite, d).dot(d);
            points[self.cells[i] as usize].dot(d) - found <= SAME * size
        })
    }
}

/// Corners next to each other on a face.
fn neighbours<'a>(corners: usize, faces: impl Iterator<Item = &'a [u32]>) -> (Vec<u32>, Vec<u32>) {
    let mut lists = vec![vec![]; corners];
    for face in faces {
        for (k, a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            lists[*a as usize].push(b);
            lists[b as usize].push(*a);
        }
    }
    let mut starts = vec![0];
    let mut next = vec![];
    for list in &mut lists {
        list.sort_unstable();
        list.dedup();
        next.append(list);
        starts.push(next.len() as u32);
    }
    (starts, next)
}

/// The highest corner by looking through all of them, and its height.
fn highest(points: &[V3<f64>], d: V3<f64>) -> (usize, f64) {
    let higher = |best: (usize, f64), (i, p): (usize, &V3<f64>)| {
        let reach = p.dot(d);
        if reach > best.1 { (i, reach) } else { best }
    };
    points.iter().enumerate().fold((0, f64::NEG_INFINITY), higher)
}

/// The cell of the cube's surface in a direction; the first for none.
fn cell(d: V3<f64>) -> usize {
    let size = [d.x.abs(), d.y.abs(), d.z.abs()];
    let (axis, along, u, v) = if size[0] >= size[1] && size[0] >= size[2] {
        (0, d.x, d.y, d.z)
    } else if size[1] >= size[2] {
        (1, d.y, d.z, d.x)
    } else {
        (2, d.z, d.x, d.y)
    };
    let row = |x: f64| ((x / along.abs() + 1.0) * (0.5 * CELLS as f64)) as usize;
    let side = 2 * axis + usize::from(along < 0.0);
    (side * CELLS + row(u).min(CELLS - 1)) * CELLS + row(v).min(CELLS - 1)
}

/// The direction of the middle of a cell, length 1 to 1.7.
fn middle(cell: usize) -> V3<f64> {
    let (side, u, v) = (cell / (CELLS * CELLS), cell / CELLS % CELLS, cell % CELLS);
    let at = |row: usize| (row as f64 + 0.5) * 2.0 / CELLS as f64 - 1.0;
    let along = if side % 2 == 0 { 1.0 } else { -1.0 };
    match side / 2 {
        0 => V3::new(along, at(u), at(v)),
        1 => V3::new(at(v), along, at(u)),
        _ => V3::new(at(u), at(v), along),
    }
}

#[cfg(test)]
mod tests {
    use super::super::polytope::Polytope;
    use super::*;

    /// Corners on an ellipsoid, evenly spread (Fibonacci).
    fn ellipsoid(n: usize) -> Vec<V3<f64>> {
        let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let at = |i: usize| {
            let z = 1.0 - 2.0 * (i as f64 + 0.5) / n as f64;
            let (r, (s, c)) = ((1.0 - z * z).sqrt(), (turn * i as f64).sin_cos());
            V3::new(0.3 * r * c, 0.1 * r * s, 0.05 * z)
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn every_cell_holds_its_middle() {
        for i in 0..6 * CELLS * CELLS {
            assert_eq!(cell(middle(i)), i);
        }
        assert!(cell(V3::default()) < 6 * CELLS * CELLS);
        assert!(cell(V3::new(f64::NAN, 0.0, 0.0)) < 6 * CELLS * CELLS);
    }

    #[test]
    fn climbing_finds_what_looking_through_all_finds() {
        for n in [40, 300, 2000] {
            let hull = Polytope::of(&ellipsoid(n)).unwrap();
            let climb = hull.climb.as_ref().unwrap();
            for d in ellipsoid(5000) {
                let (_, reach) = highest(&hull.points, d);
                let found = climb.support(&hull.points, d).dot(d);
                assert!(reach - found <= SAME * 0.3 * 0.3, "{n}: {found} of {reach}");
            }
        }
    }

    #[test]
    fn where_climbing_is_not_right_all_are_looked_through() {
        let hull = Polytope::of(&ellipsoid(60)).unwrap();
        let faces: Vec<&[u32]> = (0..hull.normals.len()).map(|i| hull.face(i)).collect();
        assert!(Climb::of(&hull.points, faces.iter().copied()).is_some());
        // No way leads to the other side.
        assert!(Climb::of(&hull.points, faces[..faces.len() / 2].iter().copied()).is_none());
        assert!(Climb::of(&hull.points[..20], [].into_iter()).is_none());
    }
}
