//! Forward dynamics of many robots of one model, four or eight of them in one pass.
//!
//! The kernel is that of [`super::aba`] over a scalar of several lanes, so every robot gets the bits that it gets alone; the
//! fused variants have those of [`super::aba_fused`].

use super::Workspace;
use super::aba::kernel;
use crate::math::{Lane, Lanes4, V3};
#[cfg(target_arch = "x86_64")]
use crate::math::{X4, X8};
use crate::model::Model;

/// How robots are put side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneKind {
    /// Four robots, on any machine.
    Portable,
    /// Four robots in AVX2 registers.
    Four,
    /// The same, with fused multiply-add.
    FourFused,
    /// Eight robots in AVX-512 registers.
    Eight,
    /// The same, with fused multiply-add.
    EightFused,
}

impl LaneKind {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Portable, Self::Four, Self::FourFused, Self::Eight, Self::EightFused];

    /// Has this machine what it needs?
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Four | Self::FourFused => X4::<false>::is_available(),
            #[cfg(target_arch = "x86_64")]
            Self::Eight | Self::EightFused => X8::<false>::is_available(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The widest that this machine has and that keeps the bits of [`super::aba`].
    pub fn best() -> Self {
        [Self::Eight, Self::Four].into_iter().find(|kind| kind.is_available()).unwrap_or(Self::Portable)
    }

    /// Robots per pass.
    pub fn width(self) -> usize {
        match self {
            Self::Portable | Self::Four | Self::FourFused => 4,
            Self::Eight | Self::EightFused => 8,
        }
    }
}

/// States, torques and accelerations of robots of one model, kept in lanes.
#[derive(Clone, Debug)]
pub struct AbaBatch {
    robots: usize,
    packs: Packs,
}

/// Invariant: a variant exists only if its lanes are available.
#[derive(Clone, Debug)]
enum Packs {
    Portable(Pack<Lanes4>),
    #[cfg(target_arch = "x86_64")]
    Four(Pack<X4<false>>),
    #[cfg(target_arch = "x86_64")]
    FourFused(Pack<X4<true>>),
    #[cfg(target_arch = "x86_64")]
    Eight(Pack<X8<false>>),
    #[cfg(target_arch = "x86_64")]
    EightFused(Pack<X8<true>>),
}

macro_rules! each {
    ($packs:expr, $pack:ident => $call:expr) => {
        match $packs {
            Packs::Portable($pack) => $call,
            #[cfg(target_arch = "x86_64")]
            Packs::Four($pack) => $call,
            #[cfg(target_arch = "x86_64")]
            Packs::FourFused($pack) => $call,
            #[cfg(target_arch = "x86_64")]
            Packs::Eight($pack) => $call,
            #[cfg(target_arch = "x86_64")]
            Packs::EightFused($pack) => $call,
        }
    };
}

impl AbaBatch {
    /// Room for so many robots, at the neutral pose, at rest and without torques. What the machine does not have is taken
    /// as [`LaneKind::Portable`].
    pub fn new(m: &Model, robots: usize, kind: LaneKind) -> Self {
        let kind = if kind.is_available() { kind } else { LaneKind::Portable };
        let packs = match kind {
            #[cfg(target_arch = "x86_64")]
            LaneKind::Four => Packs::Four(Pack::new(m, robots)),
            #[cfg(target_arch = "x86_64")]
            LaneKind::FourFused => Packs::FourFused(Pack::new(m, robots)),
            #[cfg(target_arch = "x86_64")]
            LaneKind::Eight => Packs::Eight(Pack::new(m, robots)),
            #[cfg(target_arch = "x86_64")]
            LaneKind::EightFused => Packs::EightFused(Pack::new(m, robots)),
            _ => Packs::Portable(Pack::new(m, robots)),
        };
        Self { robots, packs }
    }

    /// Robots.
    pub fn robots(&self) -> usize {
        self.robots
    }

    /// Robots per pass.
    pub fn width(&self) -> usize {
        each!(&self.packs, pack => pack.width())
    }

    /// Coordinates (nq), velocities (nv) and torques (nv) of a robot, an index below [`AbaBatch::robots`].
    pub fn set(&mut self, robot: usize, (q, v): (&[f64], &[f64]), tau: &[f64]) {
        each!(&mut self.packs, pack => pack.set(robot, (q, v), tau));
    }

    /// Computes the accelerations of all robots of model `m`, that of [`AbaBatch::new`], under gravity (m/s², world).
    pub fn solve(&mut self, m: &Model, gravity: [f64; 3]) {
        match &mut self.packs {
            Packs::Portable(pack) => pack.solve(m, gravity),
            // SAFETY: the variants exist only on a machine that has the features (`AbaBatch::new`).
            #[cfg(target_arch = "x86_64")]
            Packs::Four(pack) => unsafe { four(pack, m, gravity) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Packs::FourFused(pack) => unsafe { four_fused(pack, m, gravity) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Packs::Eight(pack) => unsafe { eight(pack, m, gravity) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Packs::EightFused(pack) => unsafe { eight_fused(pack, m, gravity) },
        }
    }

    /// Accelerations (nv) of a robot after [`AbaBatch::solve`].
    pub fn accelerations(&self, robot: usize, qdd: &mut [f64]) {
        each!(&self.packs, pack => pack.accelerations(robot, qdd));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn four(pack: &mut Pack<X4<false>>, m: &Model, gravity: [f64; 3]) {
    pack.solve(m, gravity);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn four_fused(pack: &mut Pack<X4<true>>, m: &Model, gravity: [f64; 3]) {
    pack.solve(m, gravity);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn eight(pack: &mut Pack<X8<false>>, m: &Model, gravity: [f64; 3]) {
    pack.solve(m, gravity);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
fn eight_fused(pack: &mut Pack<X8<true>>, m: &Model, gravity: [f64; 3]) {
    pack.solve(m, gravity);
}

/// Robots in packs of as many as there are lanes, pack after pack: `q` has nq values per pack, the others nv. Lanes that are
/// left over compute a robot at rest.
#[derive(Clone, Debug)]
struct Pack<T> {
    /// The same scratch for every pack: it stays in the cache.
    ws: Workspace<T>,
    q: Vec<T>,
    v: Vec<T>,
    tau: Vec<T>,
    qdd: Vec<T>,
}

impl<T: Lane> Pack<T> {
    fn new(m: &Model, robots: usize) -> Self {
        let (packs, zero) = (robots.div_ceil(T::COUNT), T::of(0.0));
        let neutral: Vec<T> = m.neutral().into_iter().map(T::of).collect();
        let velocities = vec![zero; m.nv * packs];
        Self {
            ws: Workspace::new(m),
            q: neutral.repeat(packs),
            v: velocities.clone(),
            tau: velocities.clone(),
            qdd: velocities,
        }
    }

    fn width(&self) -> usize {
        T::COUNT
    }

    fn set(&mut self, robot: usize, (q, v): (&[f64], &[f64]), tau: &[f64]) {
        let (pack, lane) = (robot / T::COUNT, robot % T::COUNT);
        let put = |to: &mut [T], from: &[f64]| {
            for (to, from) in to[pack * from.len()..].iter_mut().zip(from) {
                to.numbers_mut()[lane] = *from;
            }
        };
        put(&mut self.q, q);
        put(&mut self.v, v);
        put(&mut self.tau, tau);
    }

    fn accelerations(&self, robot: usize, qdd: &mut [f64]) {
        let (pack, lane) = (robot / T::COUNT, robot % T::COUNT);
        let from = &self.qdd[pack * qdd.len()..];
        for (to, from) in qdd.iter_mut().zip(from) {
            *to = from.numbers()[lane];
        }
    }

    #[inline(always)]
    fn solve(&mut self, m: &Model, gravity: [f64; 3]) {
        let (nq, nv) = (m.nq.max(1), m.nv.max(1));
        let states = self.q.chunks_exact(nq).zip(self.v.chunks_exact(nv));
        let loads = self.tau.chunks_exact(nv).zip(self.qdd.chunks_exact_mut(nv));
        for (state, (tau, qdd)) in states.zip(loads) {
            kernel::<T, false>(m, &mut self.ws, state, tau, V3::of(V3::from(gravity)), qdd);
        }
    }
}
