//! Faces of more than three corners as triangles.
//!
//! Own code: `earcut` leaves out corners on straight edges, which the neighbours of the face have, and so tears a closed
//! mesh open.

use super::builder::Builder;
use super::fault::Inside;
use crate::math::Vec3;

/// Tests of a corner against an ear for one file; cutting a face takes the square or cube of its corners.
const MOST_TESTS: usize = 1 << 30;

/// Cuts polygons into triangles that use every corner.
#[derive(Default)]
pub(super) struct Polygons {
    flat: Vec<[f64; 2]>,
    tests: usize,
}

impl Polygons {
    /// Adds a face to a mesh; one of fewer than three corners is none.
    pub(super) fn add(&mut self, builder: &mut Builder, face: &[u32]) -> Result<(), Inside> {
        match *face {
            [] | [_] | [_, _] => Ok(()),
            [a, b, c] => builder.triangle([a, b, c]),
            _ => {
                self.flatten(builder, face);
                if self.is_convex() { fan(builder, face) } else { self.clip(builder, face) }
            }
        }
    }

    /// The corners along two axes of the plane that fits them best (Newell's normal), anticlockwise.
    fn flatten(&mut self, builder: &Builder, face: &[u32]) {
        let places: Vec<Vec3> = face.iter().map(|c| builder.place(*c)).collect();
        let origin = places[0];
        let normal = (0..places.len())
            .fold(Vec3::zeros(), |sum, i| sum + (places[i] - origin).cross(&(places[(i + 1) % places.len()] - origin)));
        let drop = normal.iamax();
        let (u, v) = ((drop + 1) % 3, (drop + 2) % 3);
        let hand = if normal[drop] < 0.0 { -1.0 } else { 1.0 };
        self.flat = places.iter().map(|p| [(p[u] - origin[u]) * hand, p[v] - origin[v]]).collect();
    }

    fn is_convex(&self) -> bool {
        let n = self.flat.len();
        let left = (0..n).all(|i| turn(self.flat[i], self.flat[(i + 1) % n], self.flat[(i + 2) % n]) >= 0.0);
        // A star turns left everywhere too, but goes around more than once: then its x rises and falls more than once.
        let steps = (0..n).map(|i| self.flat[(i + 1) % n][0] - self.flat[i][0]).filter(|dx| *dx != 0.0);
        let rising: Vec<bool> = steps.map(|dx| dx > 0.0).collect();
        let valleys = (0..rising.len()).filter(|&i| rising[i] && !rising[(i + rising.len() - 1) % rising.len()]);
        left && valleys.take(2).count() <= 1
    }

    /// Cuts off one ear after the other; where there is none, as in a face that crosses itself, the rest becomes a fan.
    fn clip(&mut self, builder: &mut Builder, face: &[u32]) -> Result<(), Inside> {
        let mut rest: Vec<usize> = (0..face.len()).collect();
        while rest.len() > 3 {
            let n = rest.len();
            let ear = (0..n).find(|&i| self.is_ear(&rest, i));
            self.tests += n * (1 + ear.unwrap_or(n));
            if self.tests > MOST_TESTS {
                let reason = format!("a face of {} corners, not convex, after others of the kind", face.len());
                return Err(Inside::TooLarge(reason + ": cut the faces into triangles in a mesh editor"));
            }
            let Some(ear) = ear else { break };
            builder.triangle([rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]].map(|i| face[i]))?;
            rest.remove(ear);
        }
        let rest: Vec<u32> = rest.into_iter().map(|i| face[i]).collect();
        fan(builder, &rest)
    }

    fn is_ear(&self, rest: &[usize], i: usize) -> bool {
        let n = rest.len();
        let [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map(|k| self.flat[rest[k]]);
        let covers = |p: [f64; 2]| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
        turn(a, b, c) > 0.0 && !rest.iter().map(|k| self.flat[*k]).any(|p| p != a && p != b && p != c && covers(p))
    }
}

/// Twice the area of a triangle; positive: anticlockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn fan(builder: &mut Builder, face: &[u32]) -> Result<(), Inside> {
    for pair in face[1..].windows(2) {
        builder.triangle([face[0], pair[0], pair[1]])?;
    }
    Ok(())
}
