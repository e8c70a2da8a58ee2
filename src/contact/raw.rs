//! A point of contact in the frame in which the narrow phase works: the world's axes, any origin.

use super::Touch;
use super::touch::Normal;
use super::vector::{Frame, norm, unit};
use crate::math::V3;

/// What becomes a [`Touch`]. Side 0 is the first shape that the narrow phase was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raw {
    pub feature: u32,
    pub core: [V3<f64>; 2],
    pub radius: [f64; 2],
    /// As in [`Touch`], in this frame.
    pub normal: Normal,
    /// Distance of the surfaces, m.
    pub gap: f64,
}

/// Cores nearer than this say nothing about a direction, m.
pub(super) const SAME: f64 = 1e-9;

impl Raw {
    /// Two round surfaces; where their cores coincide, `otherwise` (a unit vector from side 0 to 1) is the direction.
    pub(super) fn between(feature: u32, core: [V3<f64>; 2], radius: [f64; 2], otherwise: V3<f64>) -> Self {
        let length = norm(core[1] - core[0]);
        if length > SAME {
            let gap = length - radius[0] - radius[1];
            Self { feature, core, radius, normal: Normal::Between, gap }
        } else {
            Self::on(feature, (0, otherwise), core, radius)
        }
    }

    /// Against the tangent plane of one side; the normal is a unit vector from side 0 to side 1.
    pub(super) fn on(feature: u32, (side, n): (usize, V3<f64>), core: [V3<f64>; 2], radius: [f64; 2]) -> Self {
        let gap = n.dot(core[1] - core[0]) - radius[0] - radius[1];
        Self { feature, core, radius, normal: Normal::On(side, n), gap }
    }

    /// From side 0 to side 1.
    pub(super) fn direction(&self) -> V3<f64> {
        match self.normal {
            Normal::On(_, n) => n,
            Normal::Between => unit(self.core[1] - self.core[0]).unwrap_or(V3::new(0.0, 0.0, 1.0)),
        }
    }

    /// Half-way between the surfaces.
    pub(super) fn point(&self) -> V3<f64> {
        match self.normal {
            Normal::On(0, n) => self.core[1] - n * (self.radius[1] + 0.5 * self.gap),
            _ => self.core[0] + self.direction() * (self.radius[0] + 0.5 * self.gap),
        }
    }

    /// The same with its sides swapped.
    pub(super) fn swapped(mut self) -> Self {
        self.core.swap(0, 1);
        self.radius.swap(0, 1);
        if let Normal::On(side, n) = self.normal {
            self.normal = Normal::On(1 - side, -n);
        }
        self
    }

    /// Fixed to its bodies; `frames` are theirs in the frame in which this is told.
    pub(super) fn fixed(&self, pair: [u32; 2], bodies: [usize; 2], frames: &[Frame; 2]) -> Touch {
        Touch {
            pair,
            feature: self.feature,
            bodies,
            core: [frames[0].inside(self.core[0]), frames[1].inside(self.core[1])],
            radius: self.radius,
            normal: match self.normal {
                Normal::On(side, n) => Normal::On(side, frames[side].r.tv(n)),
                Normal::Between => Normal::Between,
            },
        }
    }
}

/// Most points of one manifold.
pub(super) const MOST: usize = 6;

/// Keeps the points that matter of `list[from..]`: drops repetitions closer than `same` with one normal, then, while there
/// are more than [`MOST`] points, keeps the deepest and those that lie furthest from the ones already kept.
pub(super) fn reduce(list: &mut Vec<Raw>, from: usize, same: f64) {
    let mut kept = from;
    for i in from..list.len() {
        let new = list[i];
        let twin = (from..kept)
            .find(|k| norm(list[*k].point() - new.point()) < same && list[*k].direction().dot(new.direction()) > 0.999);
        match twin {
            Some(k) if new.gap < list[k].gap - 1e-12 => list[k] = new,
            Some(_) => {}
            None => {
                list[kept] = new;
                kept += 1;
            }
        }
    }
    list.truncate(kept);
    if kept - from > MOST {
        spread(&mut list[from..]);
        list.truncate(from + MOST);
    }
}

/// Moves the [`MOST`] points that matter to the front: the deepest first, then greedily the one whose nearest kept point is
/// furthest.
fn spread(points: &mut [Raw]) {
    for place in 0..MOST {
        let worth = |i: usize| {
            let nearest = points[..place].iter().map(|p| norm(p.point() - points[i].point()));
            if place == 0 { -points[i].gap } else { nearest.fold(f64::INFINITY, f64::min) }
        };
        let mut best = (place, worth(place));
        for i in place + 1..points.len() {
            let w = worth(i);
            // Rounding must not decide between points that are worth the same.
            if w > best.1 + 1e-9 {
                best = (i, w);
            }
        }
        points.swap(place, best.0);
    }
}
