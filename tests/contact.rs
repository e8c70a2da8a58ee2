//! Contacts with known answers (facts/references.md).
#![allow(clippy::unwrap_used)] // a test may panic

mod touching;
use realnoid::engine::State;
use realnoid::math::Vec3;
use realnoid::world::{Integrator, World};
use touching::*;

fn start(w: &mut World, z: f64, angular: Vec3, linear: Vec3) {
    let m = w.model().clone();
    let mut s = State::initial(&m);
    s.set_base_pose(&m, [0.0, 0.0, z], [0.0, 0.0, 0.0, 1.0]);
    s.set_base_twist(&m, angular, linear);
    w.set_initial_state(s);
}

#[test]
fn explore() {
    for integrator in [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler, Integrator::Rk4] {
        for h in [5e-3, 1e-3] {
            // incline by tilted gravity
            let mut s = settings(h, integrator);
            let th: f64 = 20f64.to_radians();
            s.gravity = [9.81 * th.sin(), 0.0, -9.81 * th.cos()];
            let mut w = world(ball(1.0, 0.1, surface(1.0), ground(0.5)), s);
            start(&mut w, 0.1, Vec3::zeros(), Vec3::zeros());
            let n = (1.0 / h).round() as usize;
            for _ in 0..n {
                w.advance();
            }
            let x = w.state().q[0];
            let exact = 0.5 * 5.0 / 7.0 * 9.81 * th.sin();
            println!(
                "{integrator:?} {h} roll {:e} z {:e} pen {:e}",
                x / exact - 1.0,
                w.state().q[2] - 0.1,
                w.stats().worst_penetration
            );
            let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(0.3)), settings(h, integrator));
            start(&mut w, 0.02, Vec3::zeros(), Vec3::new(0.6, 0.8, 0.0));
            for _ in 0..n {
                w.advance();
            }
            let d = w.state().q[0].hypot(w.state().q[1]);
            let exact = 1.0 / (2.0 * 0.3 * 9.81);
            println!(
                "   slide {:e} side {:e} z {:e} {:?}",
                d / exact - 1.0,
                w.state().q[0] * 0.8 - w.state().q[1] * 0.6,
                w.state().q[2] - 0.02,
                w.stats()
            );
        }
    }
}

#[test]
fn explore2() {
    let s = settings(1e-3, Integrator::ImplicitMidpoint);
    // bounce
    for e in [0.5, 0.8, 1.0] {
        let own = realnoid::model::Surface { restitution: e, ..surface(0.0) };
        let mut floor = ground(0.0);
        floor.surface.restitution = 1.0;
        let mut w = world(ball(1.0, 0.1, own, floor), s);
        start(&mut w, 1.1, Vec3::zeros(), Vec3::zeros());
        let mut apex = vec![];
        let mut last = 0.0;
        let mut rest = 0.0;
        for i in 0..8000 {
            w.advance();
            let v = w.state().v[5];
            if last > 0.0 && v <= 0.0 {
                apex.push(w.state().q[2] - 0.1);
            }
            if v != 0.0 {
                rest = i as f64 * 1e-3;
            }
            last = v;
        }
        let t = (2.0f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e);
        println!(
            "bounce e {e}: {:?} rest {rest} exact {t} z {:e} pen {:e} n {}",
            &apex[..apex.len().min(5)],
            w.state().q[2] - 0.1,
            w.stats().worst_penetration,
            apex.len()
        );
    }
    // stick
    for (deg, mu) in [(20.0f64, 0.5), (26.0, 0.5), (27.0, 0.5)] {
        let th = deg.to_radians();
        let mut s = s;
        s.gravity = [9.81 * th.sin(), 0.0, -9.81 * th.cos()];
        let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(mu)), s);
        start(&mut w, 0.02, Vec3::zeros(), Vec3::zeros());
        for _ in 0..10000 {
            w.advance();
        }
        println!(
            "stick {deg}: x {:e} exact {:e} {:?}",
            w.state().q[0],
            50.0 * 9.81 * (th.sin() - mu * th.cos()),
            w.stats().unsettled_steps
        );
    }
    // tumbling cuboid
    for h in [5e-3, 1e-3, 2.5e-4] {
        let s = settings(h, Integrator::ImplicitMidpoint);
        let mut w = world(cuboid(1.0, [0.1, 0.05, 0.02], surface(1.0), ground(0.5)), s);
        start(&mut w, 0.4, Vec3::new(5.0, 3.0, 1.0), Vec3::new(1.0, 0.0, 0.0));
        let mut e = w.energy();
        let (mut grown, mut most) = (0.0f64, 0.0f64);
        let c = std::time::Instant::now();
        for _ in 0..(5.0 / h) as usize {
            w.advance();
            let f = w.energy();
            let d = f.kinetic + f.potential - e.kinetic - e.potential;
            grown += d.max(0.0);
            most = most.max(d);
            e = f;
        }
        println!(
            "tumble {h}: grown {grown:e} most {most:e} rest {:e} us {} {:?}",
            e.kinetic,
            c.elapsed().as_secs_f64() * h / 5.0 * 1e6,
            w.stats()
        );
    }
}

#[test]
fn explore3() {
    for ratio in [1.0, 1000.0] {
        for h in [5e-3, 1e-3] {
            let s = settings(h, Integrator::ImplicitMidpoint);
            let mut list = vec![(1.0, 0.1); 5];
            list[4].0 = ratio;
            let mut w = world(balls(&list, surface(1.0), ground(0.5)), s);
            let m = w.model().clone();
            let mut st = State::initial(&m);
            for k in 0..5 {
                st.q[7 * k + 2] = 0.1 + 0.2 * k as f64;
            }
            w.set_initial_state(st);
            let c = std::time::Instant::now();
            let n = (10.0 / h) as usize;
            for _ in 0..n {
                w.advance();
            }
            println!(
                "tower {ratio} {h}: x {:e} z {:e} top {:e} kin {:e} us {} {:?}",
                w.state().q[28],
                w.state().q[2] - 0.1,
                w.state().q[30] - 0.9,
                w.energy().kinetic,
                c.elapsed().as_secs_f64() * 1e6 / n as f64,
                w.stats()
            );
        }
    }
}

#[test]
fn explore4() {
    // sleeping
    let s = settings(1e-3, Integrator::ImplicitMidpoint);
    let mut m = balls(&[(1.0, 0.1), (1.0, 0.1)], surface(1.0), ground(0.5));
    for l in &mut m.links {
        l.deactivation = Some(realnoid::model::Deactivation { linear: 0.01, angular: 0.01, after: 0.2 });
    }
    m.effects.deactivation = true;
    let mut w = world(m, s);
    let m = w.model().clone();
    let mut st = State::initial(&m);
    st.q[2] = 0.1;
    st.q[7] = 0.19;
    st.q[9] = 1.0;
    w.set_initial_state(st);
    for i in 0..6000 {
        w.advance();
        if i % 200 == 0 {
            println!("{i} q {:?} {:?} n {}", &w.state().q[0..3], &w.state().q[7..10], w.contacts().len());
        }
    }
}

#[test]
fn explore5() {
    let g1 = "/work/main/.venv/lib/python3.12/site-packages/cmeel.prefix/share/example-robot-data/robots/g1_description/urdf/g1_29dof_rev_1_0.urdf";
    for integrator in [Integrator::ImplicitMidpoint, Integrator::SemiImplicitEuler] {
        for h in [5e-3, 1e-3, 2.5e-4] {
            let mut m = feet(g1, 1.0);
            println!("colliders {} {:?}", m.colliders.len(), m.effects);
            m.effects.drives = false;
            let mut w = world(m, settings(h, integrator));
            start(&mut w, 0.9, Vec3::zeros(), Vec3::zeros());
            let mut e = w.energy();
            let (mut grown, mut most) = (0.0f64, 0.0f64);
            let n = (0.6 / h) as usize;
            let (mut cpu, mut ncont) = (0.0, 0);
            for _ in 0..n {
                let c = std::time::Instant::now();
                w.advance();
                cpu += c.elapsed().as_secs_f64();
                ncont += w.contacts().len();
                let f = w.energy();
                let d = f.kinetic + f.potential - e.kinetic - e.potential;
                grown += d.max(0.0);
                most = most.max(d);
                e = f;
            }
            println!(
                "{integrator:?} {h}: grown {grown:e} most {most:e} kin {:e} us {} contacts {} {:?}",
                e.kinetic,
                cpu / n as f64 * 1e6,
                ncont as f64 / n as f64,
                w.stats()
            );
        }
    }
}
