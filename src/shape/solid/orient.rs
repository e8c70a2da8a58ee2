//! Triangles that face the other way than their neighbours.

use super::SolidFault;
use super::edges::{Edges, Side, net};
use crate::shape::TriMesh;

/// Turns triangles until neighbours agree, where there is one way only: within a patch (triangles joined at edges that
/// have just two) as most of its area faces already, then outwards elsewhere.
pub(super) fn agree(mesh: &mut TriMesh, edges: &Edges, told: &mut Vec<String>) -> Result<(), SolidFault> {
    let neighbours = Neighbours::of(mesh.triangles.len(), edges);
    let mut turned: Vec<Option<bool>> = vec![None; mesh.triangles.len()];
    for start in 0..mesh.triangles.len() {
        if turned[start].is_none() {
            let patch = neighbours.walk(start as u32, &mut turned).map_err(|t| {
                let [a, b, c] = mesh.corners(mesh.triangles[t as usize]);
                SolidFault::NotOrientable { at: (a + b + c) / 3.0 }
            })?;
            follow_majority(mesh, &patch, &mut turned);
        }
    }
    let is_turned = |t: u32| turned[t as usize] == Some(true);
    let mut wrong = edges.iter().filter(|sides| net(sides, is_turned) != 0).map(|sides| sides[0]);
    if let Some(first) = wrong.next() {
        let [a, b] = first.ends().map(|i| mesh.vertices[i as usize]);
        return Err(SolidFault::Contradiction { edges: 1 + wrong.count(), at: (a + b) / 2.0 });
    }
    let mut count = 0;
    for (triangle, turned) in mesh.triangles.iter_mut().zip(&turned) {
        if *turned == Some(true) {
            triangle.swap(1, 2);
            count += 1;
        }
    }
    let all = mesh.triangles.len();
    told.push(format!("triangles that faced the other way than their neighbours were turned: {count} of {all}"));
    Ok(())
}

/// The neighbours of each triangle over edges that just the two share, and whether they agree.
struct Neighbours {
    of: Vec<[Option<(u32, bool)>; 3]>,
}

impl Neighbours {
    fn of(triangles: usize, edges: &Edges) -> Self {
        let mut of = vec![[None; 3]; triangles];
        let mut add = |from: &Side, to: &Side| {
            let free = of[from.triangle as usize].iter_mut().find(|slot| slot.is_none());
            if let Some(slot) = free {
                *slot = Some((to.triangle, from.forward != to.forward));
            }
        };
        for sides in edges.iter() {
            if let [a, b] = sides {
                add(a, b);
                add(b, a);
            }
        }
        Self { of }
    }

    /// Marks all triangles of a patch as turned or not, against `start`; Err: one that would have to be both.
    fn walk(&self, start: u32, turned: &mut [Option<bool>]) -> Result<Vec<u32>, u32> {
        turned[start as usize] = Some(false);
        let mut patch = vec![start];
        let mut next = 0;
        while let Some(&here) = patch.get(next) {
            next += 1;
            let own = turned[here as usize] == Some(true);
            for &(there, agrees) in self.of[here as usize].iter().flatten() {
                let needed = own == agrees;
                match turned[there as usize] {
                    None => {
                        turned[there as usize] = Some(needed);
                        patch.push(there);
                    }
                    Some(set) if set == needed => (),
                    Some(_) => return Err(there),
                }
            }
        }
        Ok(patch)
    }
}

/// Of the two ways in which a patch agrees with itself, the one that turns the lesser area.
fn follow_majority(mesh: &TriMesh, patch: &[u32], turned: &mut [Option<bool>]) {
    let signed = |t: &u32| {
        let [a, b, c] = mesh.corners(mesh.triangles[*t as usize]);
        let area = (b - a).cross(&(c - a)).norm();
        if turned[*t as usize] == Some(true) { area } else { -area }
    };
    if patch.iter().map(signed).sum::<f64>() > 0.0 {
        patch.iter().for_each(|t| turned[*t as usize] = turned[*t as usize].map(|is| !is));
    }
}
