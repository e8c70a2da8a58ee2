//! Is the mass matrix regular?

use super::{Workspace, aba};
use crate::model::{JointType, Model};

/// Inertia along a direction below this fraction of what the joint's subtree weighs is taken for none.
const NONE: f64 = 1e-13;

/// Bodies whose joint carries no inertia in some direction, in two unlike configurations: their acceleration would be
/// infinite.
pub fn singular_axes(m: &Model) -> Vec<usize> {
    let here = suspects(m, 0.0);
    if here.is_empty() {
        return here;
    }
    let there = suspects(m, 0.7);
    here.into_iter().filter(|b| there.contains(b)).collect()
}

fn suspects(m: &Model, shift: f64) -> Vec<usize> {
    let mut ws = Workspace::new(m);
    let mut q = m.neutral();
    for b in &m.bodies[1..] {
        if matches!(b.joint, JointType::Revolute | JointType::Universal) {
            for k in 0..b.joint.nq() {
                q[b.q + k] += shift * (1.0 + 0.1 * (b.q + k) as f64);
            }
        }
    }
    let (v, mut qdd) = (vec![0.0; m.nv], vec![0.0; m.nv]);
    aba(m, &mut ws, (&q, &v), &vec![1.0; m.nv], [0.0, 0.0, -9.81], &mut qdd);
    (1..m.bodies.len()).filter(|&i| !carries_inertia(m, &ws, i, &qdd)).collect()
}

fn carries_inertia(m: &Model, ws: &Workspace<f64>, i: usize, qdd: &[f64]) -> bool {
    let b = &m.bodies[i];
    let span = b.v..b.v + b.joint.nv();
    let scale = subtree_scale(m, i);
    match b.joint {
        JointType::Spherical | JointType::Floating => scale > 0.0 && qdd[span].iter().all(|a| a.is_finite()),
        _ => span.into_iter().all(|k| {
            let inertia = 1.0 / ws.dof[k].d;
            scale > 0.0 && inertia > NONE * scale && inertia.is_finite()
        }),
    }
}

/// An upper bound of the scale of the articulated inertia of a joint: masses and inertias of its subtree.
fn subtree_scale(m: &Model, i: usize) -> f64 {
    let mut inside = vec![false; m.bodies.len()];
    inside[i] = true;
    let mut sum = 0.0;
    for k in i..m.bodies.len() {
        let b = &m.bodies[k];
        inside[k] |= k > i && inside[b.parent];
        if inside[k] {
            sum += if m.bodies[i].joint == JointType::Prismatic {
                b.mass
            } else {
                b.inertia.xx + b.inertia.yy + b.inertia.zz
            };
        }
    }
    sum
}
