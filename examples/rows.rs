//! What constraint rows cost: `cargo run --release --example rows [FILE.urdf]` (default: the embedded humanoid).
//!
//! Eight contact points on the two longest limbs (24 rows), equality rows on all axes for the direct finish, and a step with
//! and without couplings if the robot has any. Medians of the thread's CPU time.

use realnoid::cli::bench::cpu_seconds;
use realnoid::cli::load::{Source, load};
use realnoid::dynamics::{CHUNK, DofIn, Push, Response, Workspace, aba_hybrid};
use realnoid::engine::State;
use realnoid::math::V3;
use realnoid::model::{AxisSlot, Base, Model};
use realnoid::solver::{Kind, Rows};
use realnoid::world::{Settings, World};
use std::path::PathBuf;
use std::sync::Arc;

const POINTS: usize = 4;
const ROUNDS: usize = 31;
const CALLS: usize = 200;

fn main() -> Result<(), String> {
    let path = std::env::args_os().nth(1).map(PathBuf::from);
    let m = load(Source { urdf: path.as_deref(), packages: &[] }, Base::Free)?.model;
    let q = State::initial(&m).q;
    let (v, mut qdd) = (vec![0.1; m.nv], vec![0.0; m.nv]);
    let mut ws = Workspace::new(&m);
    ws.dofs.fill(DofIn::implicit(0.1, 0.01));
    let hybrid = time(|| aba_hybrid(&m, &mut ws, (&q, &v), [0.0, 0.0, -9.81], &mut qdd));
    let mut response = Response::new(&m);
    println!("{}, {} velocities, {} numbers in w; ns", m.name, m.nv, response.layout.width());
    println!("hybrid ABA                              {hybrid:9.0}");
    println!("factor                                  {:9.0}", time(|| response.refresh(&m, &ws)));
    contacts(&m, &ws, &q, &mut response);
    finish(&m, &ws, &q, &mut response);
    let applied = time(|| {
        (1..m.bodies.len()).rev().take(2).for_each(|body| response.push(&Push { body, ..Push::default() }, 1.0));
        response.apply(&m, &mut ws, &q, &mut qdd);
    });
    println!("impulses back to accelerations          {applied:9.0}");
    couplings(&m)
}

/// Four points on each of the two bodies that are farthest from the root.
fn contacts(m: &Model, ws: &Workspace<f64>, q: &[f64], response: &mut Response) {
    let mut bodies: Vec<usize> = (1..m.bodies.len()).collect();
    bodies.sort_by_key(|b| std::cmp::Reverse(response.layout.chunks(*b).len()));
    let mut rows = Rows::new(response.layout.width());
    let mut pushes = vec![];
    for body in [bodies[0], bodies[1]] {
        for n in 0..POINTS {
            let ids = response.layout.chunks(body).to_vec();
            let block = rows.add(Kind::Cone { friction: 0.8 }, 3, &ids);
            let p = V3::new(0.1 * (n % 2) as f64, 0.05 * (n / 2) as f64, -0.05);
            for (k, f) in
                [V3::new(0.0, 0.0, 1.0), V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0)].into_iter().enumerate()
            {
                pushes.push((block, k, Push { body, torque: p.cross(f), force: f, ..Push::default() }));
                rows.row(block, k).bias = if k == 0 { -0.05 } else { 0.01 * n as f64 };
                rows.row(block, k).softness = 1e-9;
            }
        }
    }
    let none = |body| Push { body, ..Push::default() };
    let set_up = time(|| {
        for (block, k, push) in &pushes {
            response.row(m, ws, q, &[*push, none(push.body)], rows.response(*block, *k));
        }
        (0..2 * POINTS).for_each(|block| rows.seal(block));
    });
    let mut solve = |sweeps| {
        time(|| {
            rows.reset();
            rows.solve(sweeps, 0.0);
        })
    };
    let sweep = (solve(110) - solve(10)) / 100.0;
    println!("rows of {} contacts, each of {} rows     {:9.0}", 2 * POINTS, pushes.len(), set_up / pushes.len() as f64);
    println!("a sweep of {} contacts                   {sweep:9.0}", 2 * POINTS);
}

/// Equalities between neighbouring axes: as many rows as fit.
fn finish(m: &Model, ws: &Workspace<f64>, q: &[f64], response: &mut Response) {
    let mut rows = Rows::new(response.layout.width());
    let own = |v: usize| {
        let body =
            (1..m.bodies.len()).find(|b| (m.bodies[*b].v..m.bodies[*b].v + m.bodies[*b].joint.nv()).contains(&v));
        body.map(|body| {
            let mut push = Push { body, ..Push::default() };
            push.own[v - m.bodies[body].v] = 1.0;
            push
        })
    };
    let scalar = |a: &realnoid::model::Axis| if let AxisSlot::Scalar { v, .. } = a.slot { own(v) } else { None };
    for push in m.axes.iter().filter_map(scalar) {
        let ids = response.layout.chunks(push.body).to_vec();
        let block = rows.add(Kind::EQUALITY, 1, &ids);
        response.row(m, ws, q, &[push, Push { body: push.body, ..Push::default() }], rows.response(block, 0));
        rows.row(block, 0).bias = 1.0;
        rows.seal(block);
    }
    let mut solve = |aim| {
        time(|| {
            rows.reset();
            rows.solve(1, aim);
        })
    };
    let (swept, finished) = (solve(f64::INFINITY), solve(1e-9));
    rows.reset();
    let solved = rows.solve(1, 1e-9);
    let (n, width) = (rows.rows().len(), CHUNK * rows.rows().len());
    println!("one try of the finish, {n:2} equality rows  {:9.0}", (finished - swept) / f64::from(solved.tries.max(1)));
    println!(
        "  residual {:.1e} of {:.1e} after it, {} tries, {width} numbers at least",
        solved.residual, solved.scale, solved.tries
    );
}

fn couplings(m: &Arc<Model>) -> Result<(), String> {
    let mut off = Model::clone(m);
    off.effects.mimic = false;
    for (name, m) in [("with", m.clone()), ("without", Arc::new(off))] {
        let settings = Settings { steps_per_interval: 1, ..Settings::default() };
        let mut world = World::new(m.clone(), settings)?;
        let fresh = world.clone();
        let mut n = 0;
        let step = time(|| {
            if n % CALLS == 0 {
                world = fresh.clone();
            }
            world.advance();
            n += 1;
        });
        println!("a step {name:7} its {:2} couplings            {step:9.0}", m.couplings.len());
        if m.couplings.is_empty() {
            break;
        }
    }
    Ok(())
}

/// ns per call.
fn time(mut call: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = cpu_seconds();
            (0..CALLS).for_each(|_| call());
            (cpu_seconds() - start) * 1e9 / CALLS as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}
