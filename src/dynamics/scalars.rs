//! The algorithm of [`super::aba`] in other numbers.

use super::Workspace;
use super::aba::kernel;
use crate::math::{Fma, Twofold, V3};
use crate::model::Model;

/// As [`super::aba`], in numbers of twice the digits: some fifty times slower.
pub fn aba_twofold(
    m: &Model,
    ws: &mut Workspace<Twofold>,
    state: (&[Twofold], &[Twofold]),
    tau: &[Twofold],
    gravity: [f64; 3],
    qdd: &mut [Twofold],
) {
    kernel::<Twofold, false>(m, ws, state, tau, V3::of(V3::from(gravity)), qdd);
}

/// As [`super::aba`], with fused multiply-add: about a tenth faster, other last bits. `false` if the machine has no FMA; nothing
/// is computed then.
#[must_use]
pub fn aba_fused(
    m: &Model,
    ws: &mut Workspace<Fma>,
    state: (&[f64], &[f64]),
    tau: &[f64],
    gravity: [f64; 3],
    qdd: &mut [f64],
) -> bool {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
        let (q, v) = (fma_slice(state.0), fma_slice(state.1));
        // SAFETY: the machine has just been asked for both features.
        unsafe { fused(m, ws, (q, v), fma_slice(tau), gravity, fma_slice_mut(qdd)) };
        return true;
    }
    false
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fused(m: &Model, ws: &mut Workspace<Fma>, state: (&[Fma], &[Fma]), tau: &[Fma], gravity: [f64; 3], qdd: &mut [Fma]) {
    kernel::<Fma, false>(m, ws, state, tau, V3::of(V3::from(gravity)), qdd);
}

fn fma_slice(x: &[f64]) -> &[Fma] {
    // SAFETY: Fma is repr(transparent) over f64.
    unsafe { std::slice::from_raw_parts(x.as_ptr().cast(), x.len()) }
}

fn fma_slice_mut(x: &mut [f64]) -> &mut [Fma] {
    // SAFETY: Fma is repr(transparent) over f64, and the borrow is exclusive.
    unsafe { std::slice::from_raw_parts_mut(x.as_mut_ptr().cast(), x.len()) }
}
