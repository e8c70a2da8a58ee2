//! Near the pole of a 3DOF group.
#![allow(clippy::unwrap_used)] // a test may panic

mod support;

use realnoid::engine::State;
use realnoid::model::{Base, Model};
use realnoid::world::{AxisCommand, EngineKind, Settings, World};
use std::sync::Arc;

#[test]
fn probe() {
    let m = Arc::new(
        support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed).as_ref().clone(),
    );
    for engine in EngineKind::built() {
        for bits in 0..8 {
            if std::env::var("TRACE").is_ok_and(|t| t != format!("{} {bits}", engine.name())) {
                continue;
            }
            one(&m, engine, bits);
        }
    }
}

fn one(m: &Arc<Model>, engine: EngineKind, bits: usize) {
    let mut w = World::new(m.clone(), Settings { engine, ..Settings::default() }).unwrap();
    let mut start = State::initial(m);
    let sign = |k: usize| if bits >> k & 1 == 1 { 1.0 } else { -1.0 };
    let axes: Vec<Option<usize>> = m
        .axes
        .iter()
        .map(|a| {
            a.name
                .contains("shoulder")
                .then(|| ["yaw", "pitch", "roll"].iter().position(|n| a.name.contains(n)).unwrap())
        })
        .collect();
    for (i, k) in axes.iter().enumerate() {
        if let Some(k) = k {
            let a = &m.axes[i];
            let q = if *k == 1 { -1.5 } else { 0.5 * (a.lower + a.upper) };
            start.set_axis(m, i, q, 0.0);
        }
    }
    w.set_initial_state(start);
    let commands: Vec<_> =
        axes.iter().map(|k| k.map_or(AxisCommand::torque(0.0), |k| AxisCommand::torque(10.0 * sign(k)))).collect();
    w.set_commands(&commands).unwrap();
    let mut worst = [0.0f64; 3];
    let mut fast = [0.0f64; 3];
    let mut excess = f64::NEG_INFINITY;
    let energy = |w: &World| {
        let e = w.new_snapshot();
        e.kinetic_energy + e.potential_energy
    };
    let e0 = energy(&w);
    let q0: Vec<f64> = (0..m.axes.len()).map(|i| w.state().axis(m, i).0).collect();
    for at in 0..2000 {
        w.advance();
        let mut work = 0.0;
        for (i, k) in axes.iter().enumerate() {
            let Some(k) = *k else { continue };
            let (q, v) = w.state().axis(m, i);
            let a = &m.axes[i];
            worst[k] = worst[k].max(a.lower - q).max(q - a.upper);
            fast[k] = fast[k].max(v.abs());
            work += 10.0 * sign(k) * (q - q0[i]);
        }
        excess = excess.max(energy(&w) - e0 - work);
        if std::env::var("TRACE").is_ok_and(|t| t == format!("{} {bits}", engine.name())) {
            let of = |n: &str| {
                w.state().axis(
                    m,
                    m.axis(&format!("{}_shoulder_{n}", std::env::var("SIDE").unwrap_or("left".into()))).unwrap(),
                )
            };
            let (h, p, b) = (of("yaw"), of("pitch"), of("roll"));
            println!(
                "{at:4} H {:9.4} {:9.3}  P {:8.5} {:8.3}  B {:9.4} {:9.3}  E {:.3} {:.3}",
                h.0,
                h.1,
                p.0,
                p.1,
                b.0,
                b.1,
                energy(&w) - e0,
                energy(&w) - e0 - work
            );
        }
    }
    let end: Vec<f64> =
        axes.iter().enumerate().filter(|(_, k)| k.is_some()).map(|(i, _)| w.state().axis(m, i).0).collect();
    let cpu = 0;
    println!(
        "{:7} {bits:03b} beyond {worst:.4?} fast {fast:.1?} excess {excess:.3} end {end:.3?} div {} {cpu}",
        engine.name(),
        w.stats().diverged_steps
    );
}

#[test]
fn books() {
    let m = support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    for engine in EngineKind::built() {
        let mut w = World::new(m.clone(), Settings { engine, ..Settings::default() }).unwrap();
        let knee = m.axis("left_knee").unwrap();
        let mut commands = vec![AxisCommand::torque(0.0); m.axes.len()];
        for (i, a) in m.axes.iter().enumerate() {
            let _ = a;
            commands[i] = AxisCommand::IDLE;
        }
        commands[knee] = AxisCommand::servo(0.8);
        w.set_commands(&commands).unwrap();
        let energy = |w: &World| {
            let e = w.new_snapshot();
            e.kinetic_energy + e.potential_energy
        };
        let e0 = energy(&w);
        let mut last = 0.0;
        for at in 0..1000 {
            let before: Vec<f64> = (0..m.axes.len()).map(|i| w.state().axis(&m, i).1).collect();
            w.advance();
            let work = w.work();
            let un = energy(&w) - e0 - work.drives + work.losses + work.contacts;
            if (un - last).abs() > 0.02 && std::env::var("BOOKS").is_ok() {
                let jumps: Vec<String> = m
                    .axes
                    .iter()
                    .enumerate()
                    .filter_map(|(i, a)| {
                        let (q, v) = w.state().axis(&m, i);
                        ((v - before[i]).abs() > 1.0).then(|| format!("{} {q:.3} {:.2}->{v:.2}", a.name, before[i]))
                    })
                    .collect();
                println!("{} {at} {:.4} {jumps:?}", engine.name(), un - last);
            }
            last = un;
        }
        let work = w.work();
        println!(
            "{:7} drives {:.4} losses {:.4} contacts {:.4} unaccounted {last:.4}",
            engine.name(),
            work.drives,
            work.losses,
            work.contacts
        );
    }
}

#[test]
fn fine() {
    let m = support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    for engine in [EngineKind::Rapier, EngineKind::Rbx] {
        let mut w = World::new(m.clone(), Settings { engine, ..Settings::default() }).unwrap();
        let knee = m.axis("left_knee").unwrap();
        let neck = m.axis("neck_pitch").unwrap();
        let mut commands = vec![AxisCommand::IDLE; m.axes.len()];
        commands[knee] = AxisCommand::servo(0.8);
        w.set_commands(&commands).unwrap();
        for _ in 0..364 {
            w.advance();
        }
        let s = w.settings().clone();
        w.set_settings(Settings { control_interval_ns: 20_000, steps_per_interval: 1, solver_iterations: 1, ..s })
            .unwrap();
        for at in 0..100 {
            let before = w.state().axis(&m, neck);
            w.advance();
            let now = w.state().axis(&m, neck);
            if (now.1 - before.1).abs() > 0.05 || now.0 > 0.8999 {
                println!(
                    "{} {at} {:.6} {:.4} -> {:.6} {:.4} roll {:.4} yaw {:.4} waist {:.4} E {:.4}",
                    engine.name(),
                    before.0,
                    before.1,
                    now.0,
                    now.1,
                    w.state().axis(&m, m.axis("neck_roll").unwrap()).1,
                    w.state().axis(&m, m.axis("neck_yaw").unwrap()).1,
                    w.state().axis(&m, m.axis("waist_pitch").unwrap()).1,
                    {
                        let e = w.new_snapshot();
                        e.kinetic_energy + e.potential_energy
                    }
                );
            }
        }
    }
}

fn script(w: &mut World, at: usize) {
    let m = w.model().clone();
    let commands: Vec<AxisCommand> = (m.axes.iter().enumerate())
        .map(|(i, a)| {
            let swing = 0.3 * (((at / 500 + i) % 5) as f64 - 2.0) / 2.0;
            let target = swing.max(a.lower + 0.05).min(a.upper - 0.05);
            let arm = ["shoulder", "elbow", "wrist", "gripper", "neck"].iter().any(|part| a.name.contains(part));
            if arm { AxisCommand::torque(2.0 * swing) } else { AxisCommand::servo(target) }
        })
        .collect();
    w.set_commands(&commands).unwrap();
}

#[test]
fn neck() {
    let m = support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    let base = Settings::default();
    let mut worlds: Vec<(String, World)> = vec![];
    for (name, engine, steps, its, bump) in [("rbx", EngineKind::Rbx, 5, 10, 0.0), ("rbx/8", EngineKind::Rbx, 40, 10, 0.0), ("rbx/64", EngineKind::Rbx, 320, 10, 0.0), ("rbx+1e-9", EngineKind::Rbx, 5, 10, 1e-9),
        ("rapier", EngineKind::Rapier, 5, 10, 0.0), ("rapier/4", EngineKind::Rapier, 20, 10, 0.0), ("rapier+1e-9", EngineKind::Rapier, 5, 10, 1e-9), ("bullet", EngineKind::Bullet, 5, 10, 0.0), ("bullet/8", EngineKind::Bullet, 40, 10, 0.0), ("bullet/8x5", EngineKind::Bullet, 40, 50, 0.0), ("bullet+1e-9", EngineKind::Bullet, 5, 10, 1e-9)] {
        let mut w = World::new(m.clone(), Settings { engine, steps_per_interval: steps, solver_iterations: its, ..base.clone() }).unwrap();
        let mut s = State::initial(&m);
        if bump != 0.0 { s.set_axis(&m, m.axis("neck_pitch").unwrap(), bump, 0.0); }
        w.set_initial_state(s);
        worlds.push((name.into(), w));
    }
    let n = m.axis("neck_pitch").unwrap();
    for (name, w) in &mut worlds {
        let mut line = format!("{name:12}");
        for at in 0..5000 {
            if at % 500 == 0 { script(w, at); }
            w.advance();
            if at % 500 == 499 { line += &format!(" {:8.5}", w.state().axis(&m, n).0); }
        }
        println!("{line}  drift {:.1e} stop {:.1e} un {:.3}", w.joint_drift(), w.stats().worst_stop_violation, { let e = w.new_snapshot(); e.kinetic_energy + e.potential_energy - w.work().drives + w.work().losses + w.work().contacts });
    }
}
