//! Parts of a mesh that are closed by themselves: which lie in which, and whether each faces outwards.

use super::edges::{Edges, net};
use super::winding::{Side, side_of};
use super::{LEAST_VOLUME, count};
use crate::math::Vec3;
use crate::shape::TriMesh;

/// Bounds of what comparing parts may cost: a comparison of boxes is 1, a triangle seen from a point `LOOK`.
const MOST_WORK: usize = 500_000_000;
const LOOK: usize = 20;
/// Corners of a part that are looked for in another one.
const PROBES: usize = 8;

/// Turns parts that are inside out. A part that faces inwards within one that faces outwards is a cavity, and stays.
pub(super) fn face_outwards(mesh: &mut TriMesh, edges: &Edges, told: &mut Vec<String>) {
    let mut parts = split(mesh, edges);
    parts.sort_by(|a, b| b.volume.abs().total_cmp(&a.volume.abs()));
    let mut nesting = Nesting::default();
    let mut turned = vec![false; parts.len()];
    let mut twice = 0;
    for i in 0..parts.len() {
        let around = nesting.containers(mesh, &parts, i);
        // What a part is turned by, turns what lies in it as well: the two belong together.
        turned[i] = around.iter().filter(|q| nesting.itself[**q]).count() % 2 == 1;
        let faces = |q: usize, turned: &[bool]| if turned[q] { -parts[q].sign() } else { parts[q].sign() };
        let outside: i32 = around.iter().map(|q| faces(*q, &turned)).sum();
        let inside_out = outside + faces(i, &turned) < 0;
        turned[i] ^= inside_out;
        nesting.itself.push(inside_out);
        twice += usize::from(parts[i].sign() != 0 && outside + faces(i, &turned) > 1);
    }
    turn(mesh, &parts, &turned, told);
    nesting.look_for_crossings(mesh, &parts);
    nesting.tell(twice, told);
}

/// A closed surface.
struct Part {
    triangles: Vec<u32>,
    /// Six times what it encloses, m³; negative: it faces inwards.
    volume: f64,
    min: Vec3,
    max: Vec3,
}

/// Triangles joined at edges that just two share make a patch; patches that are closed only together make a part.
fn split(mesh: &TriMesh, edges: &Edges) -> Vec<Part> {
    let mut groups = Groups((0..mesh.triangles.len() as u32).collect());
    for sides in edges.iter().filter(|sides| sides.len() == 2) {
        groups.join(sides[0].triangle, sides[1].triangle);
    }
    for sides in edges.iter().filter(|sides| sides.len() > 2) {
        let mut by_patch: Vec<_> = sides.iter().map(|s| (groups.root(s.triangle), *s)).collect();
        by_patch.sort_by_key(|(patch, _)| *patch);
        let open = by_patch.chunk_by(|a, b| a.0 == b.0).filter(|patch| {
            let sides: Vec<_> = patch.iter().map(|(_, side)| *side).collect();
            net(&sides, |_| false) != 0
        });
        let open: Vec<u32> = open.map(|patch| patch[0].0).collect();
        open.windows(2).for_each(|pair| groups.join(pair[0], pair[1]));
    }
    let mut triangles: Vec<(u32, u32)> = (0..mesh.triangles.len() as u32).map(|t| (groups.root(t), t)).collect();
    triangles.sort_unstable();
    triangles.chunk_by(|a, b| a.0 == b.0).map(|part| Part::of(mesh, part.iter().map(|(_, t)| *t).collect())).collect()
}

impl Part {
    fn of(mesh: &TriMesh, triangles: Vec<u32>) -> Self {
        let mut part =
            Self { triangles, volume: 0.0, min: Vec3::repeat(f64::INFINITY), max: Vec3::repeat(f64::NEG_INFINITY) };
        let origin = part.corners(mesh).next().map_or(Vec3::zeros(), |[a, _, _]| a);
        let six_volumes = |corners: [Vec3; 3]| {
            let [a, b, c] = corners.map(|p| p - origin);
            a.dot(&b.cross(&c))
        };
        part.volume = part.corners(mesh).map(six_volumes).sum();
        let (min, max) =
            part.corners(mesh).flatten().fold((part.min, part.max), |(min, max), p| (min.inf(&p), max.sup(&p)));
        (part.min, part.max) = (min, max);
        part
    }

    fn corners<'m>(&'m self, mesh: &'m TriMesh) -> impl Iterator<Item = [Vec3; 3]> + 'm {
        self.triangles.iter().map(|t| mesh.corners(mesh.triangles[*t as usize]))
    }

    /// 1: it faces outwards; -1: inwards; 0: it encloses nothing.
    fn sign(&self) -> i32 {
        let least = LEAST_VOLUME * (self.max - self.min).norm().powi(3);
        if self.volume > least { 1 } else { -i32::from(self.volume < -least) }
    }

    fn reaches_around(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.min[i] && self.max[i] >= other.max[i])
    }

    fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] < other.max[i] && self.max[i] > other.min[i])
    }

    /// Some of its corners that lie within the box of another part.
    fn within<'m>(&'m self, other: &'m Self, mesh: &'m TriMesh) -> impl Iterator<Item = Vec3> + 'm {
        let inside = |p: &Vec3| (0..3).all(|i| (other.min[i]..=other.max[i]).contains(&p[i]));
        let all = self.corners(mesh).flatten();
        all.step_by(1 + self.triangles.len() / 64).filter(inside).take(PROBES)
    }

    /// The points that reach farthest along the axes.
    fn tips(&self, mesh: &TriMesh) -> Vec<Vec3> {
        let along = |axis: usize, sign: f64| {
            let points = self.corners(mesh).flatten();
            points.max_by(|a, b| (sign * a[axis]).total_cmp(&(sign * b[axis])))
        };
        (0..3).flat_map(|axis| [along(axis, 1.0), along(axis, -1.0)]).flatten().collect()
    }
}

#[derive(Default)]
struct Nesting {
    /// Per part: was it turned for its own sake?
    itself: Vec<bool>,
    crossing: usize,
    work: usize,
    left_out: usize,
}

impl Nesting {
    /// Which of the larger parts, the first `i`, hold part `i`.
    fn containers(&mut self, mesh: &TriMesh, parts: &[Part], i: usize) -> Vec<usize> {
        let part = &parts[i];
        self.work += i;
        if self.work > MOST_WORK {
            self.left_out += 1;
            return vec![];
        }
        let near: Vec<usize> = (0..i).filter(|q| parts[*q].reaches_around(part)).collect();
        let tips = if near.is_empty() { vec![] } else { part.tips(mesh) };
        let mut around = Vec::new();
        for q in near {
            self.work += LOOK * tips.len() * parts[q].triangles.len();
            if self.work > MOST_WORK {
                self.left_out += 1;
                return around;
            }
            let sides: Vec<Side> = tips.iter().map(|tip| side_of(*tip, parts[q].corners(mesh))).collect();
            match (sides.contains(&Side::Inside), sides.contains(&Side::Outside)) {
                (true, false) => around.push(q),
                (true, true) => self.crossing += 1,
                _ => (),
            }
        }
        around
    }

    /// Parts of which no box holds the other: some corners of each are looked for in the other one. What crosses with
    /// its edges alone is not found.
    fn look_for_crossings(&mut self, mesh: &TriMesh, parts: &[Part]) {
        for (i, part) in parts.iter().enumerate() {
            for other in &parts[..i] {
                self.work += 1;
                if self.work > MOST_WORK {
                    return;
                }
                if part.overlaps(other) && !other.reaches_around(part) && self.cross(mesh, part, other) {
                    self.crossing += 1;
                    break;
                }
            }
        }
    }

    fn cross(&mut self, mesh: &TriMesh, a: &Part, b: &Part) -> bool {
        let mut found = false;
        for (one, two) in [(a, b), (b, a)] {
            for probe in one.within(two, mesh) {
                self.work += LOOK * two.triangles.len();
                found |= side_of(probe, two.corners(mesh)) == Side::Inside;
            }
        }
        found
    }

    fn tell(&self, twice: usize, told: &mut Vec<String>) {
        let doubled = "the space that they share counts twice in the mass";
        let parts = |n| count(n, "part of the mesh", "parts of the mesh");
        if twice > 0 {
            told.push(format!("inside others, and no cavities: {}; {doubled}", parts(twice)));
        }
        if self.crossing > 0 {
            told.push(format!("cutting into others: {}; {doubled}", parts(self.crossing)));
        }
        if self.left_out > 0 {
            let n = parts(self.left_out);
            told.push(format!("not compared with the others, because there are too many: {n}; {doubled}, if any"));
        }
    }
}

fn turn(mesh: &mut TriMesh, parts: &[Part], turned: &[bool], told: &mut Vec<String>) {
    let inside_out = || parts.iter().zip(turned).filter(|(_, turned)| **turned).map(|(part, _)| part);
    let mut triangles = 0;
    for triangle in inside_out().flat_map(|part| &part.triangles) {
        mesh.triangles[*triangle as usize].swap(1, 2);
        triangles += 1;
    }
    let (all, some) = (parts.len(), inside_out().count());
    if some > 0 && some == all {
        told.push(format!("the mesh was inside out: all its {triangles} triangles were turned"));
    } else if some > 0 {
        told.push(format!(
            "parts of the mesh that were inside out were turned: {some} of {all}, {triangles} triangles"
        ));
    }
}

/// Union-find.
struct Groups(Vec<u32>);

impl Groups {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
