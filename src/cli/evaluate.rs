//! `realnoid evaluate`: forward dynamics of single states.

use super::args::{EvaluateArgs, numbers};
use super::base_by_name;
use super::load::load;
use crate::dynamics::{BallIn, DofIn, Workspace, aba, aba_hybrid};
use crate::engine::State;
use crate::math::{V3, Vec3};
use crate::model::{Base, JointType, Model};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};
use std::process::ExitCode;

/// One line in.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
    base_pose: Option<[f64; 7]>,
    base_twist: Option<[f64; 6]>,
}

/// One line out.
#[derive(Debug, Serialize)]
struct Output {
    acceleration: Vec<f64>,
    /// Rate of the base twist in the base frame, angular first.
    base_acceleration: Vec<f64>,
}

/// Reads states until the input ends. Exit code 1 if the URDF cannot be loaded, 2 for wrong arguments or a line that makes
/// no sense.
pub fn run(args: &EvaluateArgs) -> ExitCode {
    match evaluate(args) {
        Ok(()) => ExitCode::SUCCESS,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

fn evaluate(args: &EvaluateArgs) -> Result<(), (u8, String)> {
    let gravity = numbers("--gravity", "X,Y,Z in m/s²", &args.gravity).map_err(|e| (2, e))?;
    let model = load(args.packages.source(Some(&args.urdf)), base_by_name(&args.base)).map_err(|e| (1, e))?.model;
    let mut ws = Workspace::new(&model);
    let mut out = std::io::stdout().lock();
    for (n, line) in std::io::stdin().lock().lines().enumerate() {
        let wrong = |e: &dyn std::fmt::Display| (2, format!("standard input, line {}: {e}", n + 1));
        let line = line.map_err(|e| wrong(&e))?;
        let input: Input = serde_json::from_str(&line).map_err(|e| wrong(&e))?;
        let output = one(&model, &mut ws, &input, gravity).map_err(|e| wrong(&e))?;
        let text = serde_json::to_string(&output).map_err(|e| wrong(&e))?;
        writeln!(out, "{text}").map_err(|e| wrong(&e))?;
    }
    Ok(())
}

fn one(m: &Model, ws: &mut Workspace<f64>, input: &Input, gravity: [f64; 3]) -> Result<Output, String> {
    let n = m.axes.len();
    if [&input.position, &input.velocity, &input.effort].iter().any(|x| x.len() != n) {
        return Err(format!("position, velocity and effort must have {n} values each"));
    }
    let mut s = State::initial(m);
    if let Some(p) = input.base_pose {
        s.set_base_pose(m, [p[0], p[1], p[2]], [p[3], p[4], p[5], p[6]]);
    }
    if let Some(t) = input.base_twist {
        s.set_base_twist(m, Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
    }
    for axis in 0..n {
        s.set_axis(m, axis, input.position[axis], 0.0);
    }
    for axis in 0..n {
        s.set_axis(m, axis, input.position[axis], input.velocity[axis]);
    }
    let (mut tau, mut vdot) = (vec![0.0; m.nv], vec![0.0; m.nv]);
    for axis in 0..n {
        s.add_axis_torque(m, axis, input.effort[axis], &mut tau);
    }
    accelerations(m, ws, &s, (&tau, gravity), &mut vdot);
    Ok(Output {
        acceleration: (0..n).map(|axis| s.axis_acceleration(m, axis, &vdot)).collect(),
        base_acceleration: if m.base == Base::Free { vdot[..6].to_vec() } else { vec![] },
    })
}

/// Soft joints are hard here: their force depends on a step, and there is none.
fn accelerations(m: &Model, ws: &mut Workspace<f64>, s: &State, (tau, gravity): (&[f64], [f64; 3]), vdot: &mut [f64]) {
    if m.softs.is_empty() {
        return aba(m, ws, (&s.q, &s.v), tau, gravity, vdot);
    }
    for (input, torque) in ws.dofs.iter_mut().zip(tau) {
        *input = DofIn::free(*torque);
    }
    for b in m.bodies.iter().filter(|b| b.joint == JointType::Spherical) {
        ws.ball_in[b.ball] = BallIn { tau: V3::new(tau[b.v], tau[b.v + 1], tau[b.v + 2]), ..BallIn::default() };
    }
    m.softs.iter().for_each(|soft| ws.dofs[soft.v] = DofIn::locked(0.0));
    aba_hybrid(m, ws, (&s.q, &s.v), gravity, vdot);
}
