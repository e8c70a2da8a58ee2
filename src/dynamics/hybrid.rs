//! Hybrid dynamics (Featherstone 2008, §9.2): a joint gets a torque or an acceleration. Here is who is computed beside whom.

use super::Workspace;
use super::aba::{Dof, kernel};
use super::articulated::Acc;
use super::eliminate::{eliminate_axis, revolute, revolute_root};
use super::joint::{axis_z, turning_bias};
use super::limbs::hybrid_limbs;
use super::together::{Asking, asking};
use crate::math::{Flat, Real, V3};
use crate::model::{Body, Model};

/// Hybrid dynamics: torques, implicit diagonals and locks from `ws.dofs` and `ws.ball_in`; reactions of locked
/// coordinates to `ws.reaction` and `ws.ball_in`.
#[inline]
pub fn aba_hybrid(m: &Model, ws: &mut Workspace<f64>, state: (&[f64], &[f64]), gravity: [f64; 3], qdd: &mut [f64]) {
    let asking = asking();
    if asking.is_none() && ws.limbs.is_none() {
        hybrid_in_turn(m, ws, state, gravity, qdd);
    } else {
        hybrid_side_by_side(asking, m, ws, state, gravity, qdd);
    }
}

/// Robots or limbs side by side, if all bodies take part and none is damped.
#[inline(never)]
fn hybrid_side_by_side(
    asking: Option<Asking>,
    m: &Model,
    ws: &mut Workspace<f64>,
    state: (&[f64], &[f64]),
    gravity: [f64; 3],
    qdd: &mut [f64],
) {
    let whole = ws.damped.is_empty() && ws.active == [(1, m.bodies.len())];
    if whole && asking.is_some_and(|asking| asking.ask(m, ws, state, gravity, qdd)) {
        return;
    }
    match ws.limbs.take() {
        Some(mut limbs) if whole => {
            hybrid_limbs(m, (ws, &mut limbs), state, gravity, qdd);
            ws.bare = ws.frugal;
            ws.limbs = Some(limbs);
        }
        limbs => {
            ws.limbs = limbs;
            hybrid_in_turn(m, ws, state, gravity, qdd);
        }
    }
}

/// One body after the other. By itself, so that the compiler sees the kernel alone.
#[inline(never)]
fn hybrid_in_turn(m: &Model, ws: &mut Workspace<f64>, state: (&[f64], &[f64]), gravity: [f64; 3], qdd: &mut [f64]) {
    ws.bare = false;
    kernel::<f64, true>(m, ws, state, &[], V3::from(gravity), qdd);
}

/// A revolute joint that is plain in the lanes of `mask`, and has a diagonal or is locked in others.
#[inline(always)]
pub(super) fn mixed<T: Real>(b: &Body, ws: &mut Workspace<T>, (i, k): (usize, &mut Acc<T>), v: &[T], mask: T) {
    let kin = ws.kin[i];
    let (mut loaded, mut dof) = (*k, Dof::default());
    eliminate_axis(&mut loaded, axis_z(), &mut dof, &ws.dofs[b.v]);
    let t = ws.dofs[b.v].tau;
    if b.parent == 0 {
        revolute_root(k, (&mut ws.dof[b.v], t));
    } else {
        let p = V3::of(b.tree_p);
        loaded.push(turning_bias(v[b.v], (kin.w, kin.v)));
        loaded = loaded.to_parent(&kin.r, p);
        *k = revolute(k, (&kin.r, p), (kin.w, kin.v), v[b.v], (&mut ws.dof[b.v], t));
        k.numbers_of_mut().iter_mut().zip(loaded.numbers_of()).for_each(|(x, other)| *x = x.blend(*other, mask));
    }
    ws.dof[b.v].numbers_of_mut().iter_mut().zip(dof.numbers_of()).for_each(|(x, other)| *x = x.blend(*other, mask));
}
