//! A block's own part of `Y Yᵀ + R`: how its rows move each other.

use super::cone::{ConeBlock, Plane, disc};
use super::dense::dot;
use super::rows::{Block, CHUNK, Rows};
use crate::math::{Lane, Lanes4, wide};

/// A visit of a block stays near what it had before, by this share of its trace: that moves no solution, and a block that is
/// held in some direction has one.
const NEAR: f64 = 1e-9;
/// A contact whose normal moves by less than this share of its tangents is held.
const DEAD: f64 = 1e-12;

/// The block's own part of `Y Yᵀ + R`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Inner {
    /// Nothing moves when it pushes: it takes no part.
    Off,
    Single(f64),
    Pair(Plane, f64),
    Cone(ConeBlock),
}

impl Rows {
    /// Takes the responses and softnesses of a block as they are now; it takes part from here on, unless nothing moves
    /// when it pushes.
    pub fn seal(&mut self, block: usize) {
        self.blocks[block].inner = self.inner(block);
    }

    fn inner(&self, block: usize) -> Inner {
        wide!(
            Self::inner_any::<Lanes4>,
            Rows::inner_any::<crate::math::X4<false>>,
            (this: &Rows = self, block: usize = block) -> Inner
        )
    }

    #[inline(always)]
    fn inner_any<L: Lane>(&self, block: usize) -> Inner {
        let b = &self.blocks[block];
        match b.rows {
            1 => single(self.own::<L>(b, 0, 0)),
            2 => pair([self.own::<L>(b, 0, 0), self.own::<L>(b, 0, 1), self.own::<L>(b, 1, 1)]),
            _ => cone([
                self.own::<L>(b, 0, 0),
                self.own::<L>(b, 0, 1),
                self.own::<L>(b, 0, 2),
                self.own::<L>(b, 1, 1),
                self.own::<L>(b, 1, 2),
                self.own::<L>(b, 2, 2),
            ]),
        }
    }

    #[inline(always)]
    fn own<L: Lane>(&self, b: &Block, i: usize, k: usize) -> f64 {
        let length = b.ids.len() * CHUNK;
        let y = |n: usize| &self.values[b.values + n * length..b.values + (n + 1) * length];
        let softness = if i == k { self.rows[b.first + i].softness } else { 0.0 };
        dot::<L>(y(i), y(k)) + softness
    }
}

fn single(h: f64) -> Inner {
    if h > 0.0 { Inner::Single(h) } else { Inner::Off }
}

fn pair([a, b, d]: [f64; 3]) -> Inner {
    let (trace, more) = (a + d, NEAR * (a + d));
    if trace > 0.0 { Inner::Pair(Plane::new(a + more, b, d + more), trace) } else { Inner::Off }
}

/// A contact that gives way along its normal takes part, also where it is held along a tangent.
fn cone(h: [f64; 6]) -> Inner {
    let trace = h[0] + h[3] + h[5];
    let more = NEAR * trace;
    let near = [h[0] + more, h[1], h[2], h[3] + more, h[4], h[5] + more];
    if h[0] > DEAD * trace { Inner::Cone(ConeBlock::new(near)) } else { Inner::Off }
}

/// A disc of a pair of rows, or ± the radius of one.
pub(super) fn within_disc(inner: &Inner, r: [f64; 2], radius: f64) -> [f64; 2] {
    match inner {
        Inner::Pair(plane, _) => disc(plane, r, radius),
        Inner::Single(h) => [(-r[0] / h).min(radius).max(-radius), 0.0],
        _ => [0.0; 2],
    }
}
