//! The embedded humanoid on the ground: it stands on its servos, and it falls, from many poses and at many steps.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;
mod touching;

use realnoid::cli::load::{Source, load};
use realnoid::dynamics::{Kinematics, kinematics};
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, Integrator, World};
use support::Random;
use touching::*;

fn humanoid(path: Option<&str>) -> Model {
    let path = path.map(std::path::PathBuf::from);
    let source = Source { urdf: path.as_deref(), packages: &[] };
    let mut m = Model::clone(&load(source, Base::Free).unwrap_or_else(|e| panic!("{e}")).model);
    let mut all = std::mem::take(&mut m.colliders);
    all.push(ground(1.0));
    m.set_colliders(all);
    m
}

/// The base so high that the lowest point of anything that collides is `gap` above the ground.
fn place(m: &Model, s: &mut State, gap: f64) {
    let at = s.q[2];
    let (mut low, mut high) = (at - 3.0, at + 3.0);
    let mut detector = realnoid::contact::Detector::new(m).unwrap();
    let floor = m.colliders.len() as u32 - 1;
    let mut k = Kinematics::new(m);
    for _ in 0..60 {
        s.q[2] = 0.5 * (low + high);
        kinematics(m, &mut k, &s.q, &vec![0.0; m.nv]);
        let mut touches = vec![];
        detector.find(&k, 0.0, &mut touches);
        let near = touches.iter().filter(|t| t.pair[1] == floor).map(|t| t.placed(&k).gap);
        if near.fold(f64::INFINITY, f64::min) < 1e-9 { low = s.q[2] } else { high = s.q[2] }
    }
    s.q[2] = high + gap;
}

fn total(w: &World) -> f64 {
    w.energy().kinetic + w.energy().potential
}

fn center(w: &World) -> Vec3 {
    w.momentum().center
}

#[test]
fn explore_stand() {
    let mut m = humanoid(None);
    rest(&mut m, 0.005, 0.01, 0.5);
    m.effects.deactivation = false;
    let mut w = world(m, settings(1e-3, Integrator::ImplicitMidpoint));
    let m = w.model().clone();
    let mut s = State::initial(&m);
    place(&m, &mut s, 0.0);
    w.set_initial_state(s.clone());
    let commands: Vec<_> = (0..m.axes.len()).map(|i| AxisCommand::servo(s.axis(&m, i).0)).collect();
    w.set_commands(&commands).unwrap();
    for i in 0..10000 {
        if i % 500 == 0 {
            println!(
                "{i} com {:?} kin {:e} contacts {} {:?}",
                center(&w).as_slice(),
                w.energy().kinetic,
                w.contacts().len(),
                w.stats()
            );
        }
        w.advance();
    }
}

/// A random pose within two thirds of each range, in which no two links overlap.
fn pose(m: &Model, random: &mut Random) -> State {
    let mut detector = realnoid::contact::Detector::new(m).unwrap();
    let mut k = Kinematics::new(m);
    loop {
        let mut s = State::initial(m);
        for axis in 0..m.axes.len() {
            let a = &m.axes[axis];
            let (low, high) = (a.lower.max(-1.0), a.upper.min(1.0));
            s.set_axis(m, axis, 0.5 * (low + high) + 0.33 * (high - low) * random.unit(), 0.0);
        }
        let q = random.rotation().coords;
        s.set_base_pose(m, [0.0, 0.0, 3.0], [q.x, q.y, q.z, q.w]);
        kinematics(m, &mut k, &s.q, &vec![0.0; m.nv]);
        let mut touches = vec![];
        detector.find(&k, 0.0, &mut touches);
        if touches.iter().all(|t| t.placed(&k).gap > 0.0) {
            s.q[2] = 1.0;
            return s;
        }
    }
}

#[test]
#[ignore]
fn explore_drops() {
    let args: Vec<String> = std::env::var("DROP").unwrap_or("0.001 3 5".into()).split(' ').map(String::from).collect();
    let (h, seconds, n): (f64, f64, u64) =
        (args[0].parse().unwrap(), args[1].parse().unwrap(), args[2].parse().unwrap());
    let integrator = if args.get(4).is_some_and(|a| a == "euler") {
        Integrator::SemiImplicitEuler
    } else {
        Integrator::ImplicitMidpoint
    };
    let mut m = humanoid(args.get(3).map(|s| s.as_str()).filter(|s| s.len() > 1));
    m.effects.drives = false;
    let steps = (seconds / h) as usize;
    let only: Option<u64> = std::env::var("SEED").ok().map(|s| s.parse().unwrap());
    for seed in (0..n).filter(|s| only.is_none_or(|o| o == *s)) {
        let mut w = world(m.clone(), settings(h, integrator));
        let m = w.model().clone();
        let mut s = if seed == 0 { State::initial(&m) } else { pose(&m, &mut Random(seed)) };
        place(&m, &mut s, 0.1);
        w.set_initial_state(s);
        let (mut e, mut grown, mut cpu, mut deep, mut last) = (total(&w), 0.0, 0.0, 0.0_f64, 0.0_f64);
        for i in 0..steps {
            let t = std::time::Instant::now();
            let before = (w.stats(), total(&w), w.clone());
            w.advance();
            if only.is_some() {
                let (a, b) = (before.0, w.stats());
                let d = total(&w) - before.1;
                if b.trimmed_energy - a.trimmed_energy > 0.02
                    || d > 1e-6
                    || b.worst_penetration - a.worst_penetration > 1e-4
                {
                    println!(
                        "step {i}: residual {:.1e} energy {:.6} by {d:.1e} trimmed {:.1e} contacts {} kin {:.3} -> {:.3}",
                        b.worst_residual,
                        before.1,
                        b.trimmed_energy - a.trimmed_energy,
                        w.contacts().len(),
                        before.2.energy().kinetic,
                        w.energy().kinetic
                    );
                }
            }
            cpu += t.elapsed().as_secs_f64();
            grown += (total(&w) - e).max(0.0);
            e = total(&w);
            if i > steps * 9 / 10 {
                deep = w.contacts().iter().map(|c| c.depth).fold(deep, f64::max);
                last = last.max(w.energy().kinetic);
            }
        }
        let s = w.stats();
        println!(
            "h {h} seed {seed}: worst {:.4} mm, at rest {:.6} mm, grown {grown:.1e} J, kinetic at end {last:.1e}, trimmed {:.2e}, us {:.0}, contacts {}, halvings {}, unsettled {}, guarded {} stop {:.3} residual {:.1e}",
            s.worst_penetration * 1e3,
            deep * 1e3,
            s.trimmed_energy,
            cpu / steps as f64 * 1e6,
            w.contacts().len(),
            s.halvings,
            s.unsettled_steps,
            s.guarded_pieces,
            s.worst_stop_violation,
            s.worst_residual
        );
    }
}
