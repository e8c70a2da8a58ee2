//! Who is computed together.

use super::Request;
use super::lanes::Lanes;
use crate::dynamics::LaneKind;
use crate::math::{Lane, Lanes4};
#[cfg(target_arch = "x86_64")]
use crate::math::{X4, X8};
use crate::model::Model;

/// Tasks at a time: bits of an answer.
pub(super) const MOST: usize = 32;
/// Lanes of the widest kind.
pub(super) const WIDEST: usize = 8;

/// Scratch of the lanes that this machine has. Invariant: a variant exists only if its lanes are available.
pub(super) enum Pass {
    Portable(Lanes<Lanes4>),
    #[cfg(target_arch = "x86_64")]
    Four(Lanes<X4<false>>),
    #[cfg(target_arch = "x86_64")]
    Eight(Lanes<X8<false>>),
}

impl Pass {
    /// Fused lanes would have other bits: they are taken as those that are not.
    pub fn new(kind: LaneKind) -> Self {
        match kind {
            #[cfg(target_arch = "x86_64")]
            LaneKind::Eight | LaneKind::EightFused if kind.is_available() => Self::Eight(Lanes::new()),
            #[cfg(target_arch = "x86_64")]
            LaneKind::Four | LaneKind::FourFused if kind.is_available() => Self::Four(Lanes::new()),
            _ => Self::Portable(Lanes::new()),
        }
    }

    /// Computes for all who find somebody to be computed with; a bit for each of them.
    pub fn serve(&mut self, requests: &[Request]) -> u32 {
        let (mut served, mut seen) = (0, 0);
        for (k, first) in requests.iter().enumerate() {
            let mut pack = Pack { all: [first; WIDEST], count: 0, bits: 0 };
            for (j, other) in requests.iter().enumerate().skip(k) {
                if seen & (1 << j) == 0 && pack.count < self.width() && first.fits(other) {
                    pack.add(j, other);
                }
            }
            seen |= pack.bits;
            if pack.count > 1 {
                self.solve(first.model(), &pack.all[..pack.count]);
                served |= pack.bits;
            }
        }
        served
    }

    fn width(&self) -> usize {
        match self {
            Self::Portable(_) => Lanes4::COUNT,
            #[cfg(target_arch = "x86_64")]
            Self::Four(_) => X4::<false>::COUNT,
            #[cfg(target_arch = "x86_64")]
            Self::Eight(_) => X8::<false>::COUNT,
        }
    }

    fn solve(&mut self, m: &Model, requests: &[&Request]) {
        match self {
            Self::Portable(lanes) => lanes.solve(m, requests),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the machine has the features.
            Self::Four(lanes) => unsafe { four(lanes, m, requests) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Self::Eight(lanes) => unsafe { eight(lanes, m, requests) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn four(lanes: &mut Lanes<X4<false>>, m: &Model, requests: &[&Request]) {
    lanes.solve(m, requests);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn eight(lanes: &mut Lanes<X8<false>>, m: &Model, requests: &[&Request]) {
    lanes.solve(m, requests);
}

/// Those that are computed in one pass.
struct Pack<'a> {
    all: [&'a Request; WIDEST],
    count: usize,
    bits: u32,
}

impl<'a> Pack<'a> {
    fn add(&mut self, index: usize, request: &'a Request) {
        self.all[self.count] = request;
        self.count += 1;
        self.bits |= 1 << index;
    }
}

impl Request {
    fn model(&self) -> &Model {
        // SAFETY: who waits borrows it.
        unsafe { self.m.as_ref() }
    }

    /// Can both be computed in one pass? Worlds of one model have the very same bodies, mostly: see `World::share`.
    fn fits(&self, other: &Self) -> bool {
        let (a, b) = (&self.model().bodies, &other.model().bodies);
        if !a.is_shared_with(b) && a != b {
            return false;
        }
        // SAFETY: who waits borrows them.
        let (a, b) = unsafe { (self.ws.as_ref(), other.ws.as_ref()) };
        a.ball_in.iter().zip(&b.ball_in).all(|(a, b)| a.locks == b.locks)
    }
}
