//! Rows of contacts from the six columns of a body.

use super::response::{Case, cases};
use crate::support::Random;
use realnoid::dynamics::{CHUNK, Columns, Push, Response};
use realnoid::math::V3;

/// Sums of columns are the rows that are climbed one by one, for one body and for two, to 1e-13 of their size.
#[test]
fn columns_agree_with_rows() {
    let mut worst = 0.0f64;
    for (n, c) in cases().iter().enumerate() {
        let mut r = Response::new(&c.m);
        r.refresh(&c.m, &c.ws);
        let mut columns = [Columns::new(&r.layout), Columns::new(&r.layout)];
        let mut rng = Random(n as u64 + 14_000);
        for _ in 0..10 {
            let bodies: [usize; 2] = std::array::from_fn(|_| 1 + rng.next() as usize % (c.m.bodies.len() - 1));
            let mut push = |body| {
                let (torque, force) = (V3::from(rng.vec3(1.0)), V3::from(rng.vec3(1.0)));
                Push { body, torque, force, ..Push::default() }
            };
            let pushes = bodies.map(&mut push);
            let none = Push { body: bodies[0], ..Push::default() };
            for (pushes, count) in [(pushes, 2), ([pushes[0], none], 1)] {
                let mut ids = vec![];
                r.layout.join(pushes[0].body, pushes[1].body, &mut ids);
                let (mut sum, mut row) = (vec![0.0; ids.len() * CHUNK], vec![0.0; ids.len() * CHUNK]);
                for (columns, push) in columns.iter_mut().zip(&pushes[..count]) {
                    r.columns(&c.m, &c.ws, &c.q, push.body, columns);
                    columns.combine(push, &ids, &mut sum);
                }
                let mobility = r.row(&c.m, &c.ws, &c.q, &pushes, (&ids, &mut row));
                // Locks of a spherical joint leave rounding of what they hold.
                let size = mobility.unlocked.sqrt();
                let parts: f64 = pushes.iter().map(|p| alone(&mut r, c, p)).sum();
                for (a, b) in sum.iter().zip(&row) {
                    worst = worst.max((a - b).abs() / size.max(parts));
                }
            }
        }
        assert!(worst <= 1e-13, "model {n}: {worst:e}");
        r.columns(&c.m, &c.ws, &c.q, 0, &mut columns[0]);
        columns[0].combine(&Push::default(), &[], &mut []);
    }
    println!("worst relative difference {worst:e}");
}

/// Size of the response of one push: where two cancel, that is what rounding is relative to.
fn alone(r: &mut Response, c: &Case, push: &Push) -> f64 {
    let ids = r.layout.chunks(push.body).to_vec();
    let mut row = vec![0.0; ids.len() * CHUNK];
    let none = Push { body: push.body, ..Push::default() };
    r.row(&c.m, &c.ws, &c.q, &[*push, none], (&ids, &mut row)).unlocked.sqrt()
}

/// The change of velocity is what `apply` adds, to the bit, and the workspace stays as it was.
#[test]
fn velocity_is_apply_without_a_trace() {
    for (n, c) in cases().iter().enumerate() {
        let mut r = Response::new(&c.m);
        r.refresh(&c.m, &c.ws);
        let mut rng = Random(n as u64 + 15_000);
        let pushes: Vec<Push> = (0..4).map(|_| c.push(&mut rng)).collect();
        let mut out = [c.qdd.clone(), c.qdd.clone()];
        let mut ws = c.ws.clone();
        let before = format!("{ws:?}");
        pushes.iter().for_each(|p| r.push(p, 2.0));
        r.velocity(&c.m, &ws, &c.q, &mut out[0]);
        assert_eq!(format!("{ws:?}"), before);
        pushes.iter().for_each(|p| r.push(p, 2.0));
        r.apply(&c.m, &mut ws, &c.q, &mut out[1]);
        assert_eq!(out[0], out[1], "model {n}");
        assert_ne!(out[0], c.qdd, "model {n}");
    }
}
