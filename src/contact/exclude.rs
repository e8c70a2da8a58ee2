//! Which links never touch.

use super::{Detector, Touch};
use crate::dynamics::{Kinematics, kinematics};
use crate::math::V3;
use crate::model::{JointType, Model};

/// Links that overlap by more than this where all joints are at 0 never touch, m.
pub const OVERLAP: f64 = 1e-4;

/// Two links (ascending) that overlap, and by how much, m.
pub type Overlap = ([usize; 2], f64);

/// Pairs of links that never touch, ascending: those of one body or of bodies that a joint connects, and those of a chain
/// without self-collision (J-9). Bodies without mass, which soft joints and groups add, do not come between. The second
/// list holds the pairs that would be allowed, but overlap by more than [`OVERLAP`] where all joints are at 0, and by how
/// much; `m.colliders` must be filled.
pub fn excluded(m: &Model) -> (Vec<[usize; 2]>, Vec<Overlap>) {
    let mut links: Vec<usize> = m.colliders.iter().filter_map(|c| c.link).collect();
    links.sort_unstable();
    links.dedup();
    let mut pairs = vec![];
    for (i, a) in links.iter().enumerate() {
        for b in &links[i + 1..] {
            if neighbours(m, *a, *b) || chained(m, *a, *b) {
                pairs.push([*a, *b]);
            }
        }
    }
    let overlapping = overlaps(&Model { excluded_pairs: pairs.clone(), ..m.clone() });
    pairs.extend(overlapping.iter().map(|(pair, _)| *pair));
    pairs.sort_unstable();
    (pairs, overlapping)
}

fn neighbours(m: &Model, a: usize, b: usize) -> bool {
    let (a, b) = (m.links[a].frame.body(), m.links[b].frame.body());
    a == b || carrier(m, a) == Some(b) || carrier(m, b) == Some(a)
}

/// The next body with mass, or the world, that carries this one by joints; `None` for one that floats.
fn carrier(m: &Model, body: usize) -> Option<usize> {
    let mut at = body;
    while at != 0 {
        if m.bodies[at].joint == JointType::Floating {
            return None;
        }
        at = m.bodies[at].parent;
        if at == 0 || m.bodies[at].mass > 0.0 {
            return Some(at);
        }
    }
    None
}

fn chained(m: &Model, a: usize, b: usize) -> bool {
    m.chain_of(a).is_some_and(|chain| !chain.self_collision && chain.links.binary_search(&b).is_ok())
}

fn overlaps(m: &Model) -> Vec<Overlap> {
    let Some(mut detector) = Detector::new(m) else { return vec![] };
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &m.neutral(), &vec![0.0; m.nv]);
    // Where things stand, not how they move.
    k.v.iter_mut().chain(&mut k.w).for_each(|v| *v = V3::default());
    let mut touches: Vec<Touch> = vec![];
    detector.find(&k, 0.0, &mut touches);
    let mut found: Vec<Overlap> = vec![];
    for touch in &touches {
        let [Some(a), Some(b)] = touch.pair.map(|c| m.colliders[c as usize].link) else { continue };
        let (pair, depth) = ([a.min(b), a.max(b)], -touch.placed(&k).gap);
        match found.iter_mut().find(|(known, _)| *known == pair) {
            _ if depth <= OVERLAP => {}
            Some((_, most)) => *most = most.max(depth),
            None => found.push((pair, depth)),
        }
    }
    found.sort_unstable_by_key(|(pair, _)| *pair);
    found
}
