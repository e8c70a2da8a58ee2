//! Links are taken out of a world: the model and the state that are left (W-11).

use super::State;
use super::apart::Cut;
use crate::dynamics::{Kinematics, kinematics, link_pose};
use crate::model::{LinkFrame, Model};

/// The model without these links (per link), and its state. The order of axes and links stays: a link that is gone stands still where it was,
/// without mass and without anything that collides; its axes are [`crate::model::AxisSlot::Apart`].
///
/// What is gone must be whole bodies, with all that hangs on them: see [`part_of`]. Allocates.
pub fn without(m: &Model, s: &State, gone: &[bool]) -> (Model, State) {
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &s.q, &s.v);
    let cut = Cut::without(m, &bodies_left(m, gone));
    let (mut left, state) = cut.made(s, &k);
    for (i, link) in left.links.iter_mut().enumerate().filter(|(i, _)| gone[*i]) {
        let offset = link_pose(m, &k, &s.q, &s.angles, i);
        link.frame = LinkFrame::OnBody { body: 0, offset };
        (link.removed, link.mass, link.deactivation) = (true, 0.0, None);
    }
    left.colliders.retain(|c| c.link.is_none_or(|link| !gone[link]));
    (left, state)
}

/// A link, and all that hangs on it.
pub fn hanging_on(m: &Model, link: usize) -> Vec<bool> {
    let hangs = |i: usize| std::iter::successors(Some(i), |i| m.links[*i].parent).any(|i| i == link);
    (0..m.links.len()).map(hangs).collect()
}

/// The first link that is not gone and that shares a body with one that is: what is fixed to it, or in the middle of the same group.
pub fn part_of(m: &Model, gone: &[bool]) -> Option<usize> {
    let mut loses = vec![false; m.bodies.len()];
    for (link, _) in m.links.iter().zip(gone).filter(|(_, gone)| **gone) {
        loses[link.frame.body()] = true;
    }
    (0..m.links.len()).find(|i| !gone[*i] && m.links[*i].frame.body() != 0 && loses[m.links[*i].frame.body()])
}

/// Bodies that carry a link that stays, and what they hang on.
fn bodies_left(m: &Model, gone: &[bool]) -> Vec<bool> {
    let mut stays = vec![false; m.bodies.len()];
    stays[0] = true;
    for (link, _) in m.links.iter().zip(gone).filter(|(_, gone)| !**gone) {
        stays[link.frame.body()] = true;
    }
    for i in (1..m.bodies.len()).rev() {
        stays[m.bodies[i].parent] |= stays[i];
    }
    stays
}
