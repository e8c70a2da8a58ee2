//! Two random bodies, again and again: numbers stay finite, contacts make no energy, nothing sinks in or passes through.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "contact/scene.rs"]
mod scene;
mod support;
mod touching;

use realnoid::math::{Pose, Vec3};
use realnoid::model::{Model, Surface};
use realnoid::shape::ContactForm;
use realnoid::world::{Settings, World};
use support::Random;
use touching::{balls, ground, on_link, settings};

/// Overlap at the start at most, m.
const START: f64 = 5e-3;

/// What one scene is made of; printed where it fails.
#[derive(Debug)]
struct Draw {
    forms: [ContactForm; 2],
    masses: [f64; 2],
    surface: Surface,
    grounded: bool,
    gravity: bool,
    h: f64,
    steps: usize,
    poses: [Pose; 2],
    twists: [(Vec3, Vec3); 2],
}

fn share(rng: &mut Random) -> f64 {
    0.5 * (rng.unit() + 1.0)
}

/// Two bodies that mostly fly at each other, and overlap by [`START`] at most.
fn draw(seed: u64) -> Draw {
    let mut rng = Random(seed);
    let list = scene::forms(&mut rng);
    let mut form = || list[(rng.next() % list.len() as u64) as usize].clone();
    let forms = [form(), form()];
    let masses = [1.0, 10f64.powf(3.0 * rng.unit())];
    let some = |rng: &mut Random, most: f64| if rng.next().is_multiple_of(2) { most * share(rng) } else { 0.0 };
    let surface = Surface {
        friction: some(&mut rng, 2.0),
        rolling: some(&mut rng, 0.05),
        spinning: some(&mut rng, 0.05),
        restitution: some(&mut rng, 1.0),
    };
    let h = [1e-3, 1e-3, 1e-3, 1e-2, 1e-4][(rng.next() % 5) as usize];
    let steps = 50 + (rng.next() % 151) as usize;
    let way = rng.vec3(1.0).normalize();
    let turned = [rng.rotation(), rng.rotation()];
    let (turn, speed) = (50.0 * share(&mut rng).powi(2), 10.0 * share(&mut rng).powi(2));
    let aim = if !rng.next().is_multiple_of(4) { way * speed } else { Vec3::zeros() };
    let twists = [0, 1].map(|k| {
        let v = aim * (0.5 - f64::from(k)) + rng.vec3(0.25 * speed);
        (rng.vec3(turn / 3f64.sqrt()), turned[k as usize].inverse() * v)
    });
    let (grounded, gravity) = (rng.next().is_multiple_of(2), rng.next().is_multiple_of(2));
    let (height, slide) = (0.3 * share(&mut rng), rng.vec3(0.1));
    let at = |distance: f64| {
        let low = 0.2 + height + (-way.z).max(0.0) * distance;
        let first = Vec3::new(0.0, 0.0, low);
        [
            Pose::from_parts(first.into(), turned[0]),
            Pose::from_parts((first + way * distance + slide).into(), turned[1]),
        ]
    };
    let mut d = Draw { forms, masses, surface, grounded, gravity, h, steps, poses: at(0.0), twists };
    let mut distance = 0.15;
    while distance < 2.0 {
        d.poses = at(distance);
        d.poses.iter_mut().for_each(|p| p.translation.vector.z += 0.5 * (distance - 0.15));
        if overlap(&d) < START {
            break;
        }
        distance += 0.05;
    }
    d
}

fn overlap(d: &Draw) -> f64 {
    let mut forms = d.forms.to_vec();
    forms.push(ContactForm::HalfSpace);
    let mut s = scene::Scene::new(&forms[..if d.grounded { 3 } else { 2 }]);
    let mut detector = realnoid::contact::Detector::new(&s.model).unwrap();
    (0..2).for_each(|k| s.place(k, d.poses[k]));
    let mut touches = vec![];
    detector.find(&s.k, 0.0, &mut touches);
    touches.iter().map(|t| -t.placed(&s.k).gap).fold(0.0, f64::max)
}

fn build(d: &Draw) -> World {
    let list: Vec<(f64, f64)> = d.masses.iter().map(|m| (*m, 0.15)).collect();
    let mut m: Model = balls(&list, d.surface, ground(1.0));
    let mut colliders = if d.grounded { vec![ground(1.0)] } else { vec![] };
    for (k, form) in d.forms.iter().enumerate() {
        colliders.push(on_link(&m, &format!("b{k}"), form.clone(), d.surface));
    }
    m.set_colliders(colliders);
    let base = settings(d.h, Default::default());
    let gravity = if d.gravity { base.gravity } else { [0.0; 3] };
    let mut w = World::new(m.into(), Settings { gravity, ..base }).unwrap();
    let mut s = w.state().clone();
    for (k, body) in w.model().bodies[1..].iter().enumerate() {
        let (p, (turn, speed)) = (&d.poses[k], d.twists[k]);
        let r = p.rotation.quaternion();
        s.q[body.q..body.q + 3].copy_from_slice(p.translation.vector.as_slice());
        s.q[body.q + 3..body.q + 7].copy_from_slice(&[r.w, r.i, r.j, r.k]);
        s.v[body.v..body.v + 3].copy_from_slice(turn.as_slice());
        s.v[body.v + 3..body.v + 6].copy_from_slice(speed.as_slice());
    }
    w.set_initial_state(s);
    w
}

/// What a run of one scene came to, as multiples of what is allowed.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    contacts: usize,
    gain: f64,
    deep: f64,
}

/// Fastest turn of the two bodies, rad/s.
fn turning(w: &World) -> f64 {
    let v = &w.state().v;
    w.model().bodies[1..].iter().map(|b| v[b.v..b.v + 3].iter().map(|x| x * x).sum::<f64>().sqrt()).sum()
}

/// Runs a scene.
///
/// Energy: a step all of whose bodies are in contact ends with at most the energy it began with (`engine/paid.rs`), up to
/// rounding (1e-9 of all energy there is), but for the weight that comes up as an overlap is taken back, and for a bounce whose
/// end lies e·v·h higher: where the motion has less energy than that, v²/2 < g·e·v·h, there is nothing to take it from, so that
/// at most 2 e² g h² of height is gained (seed 46: 5e-4 J of 350 J, a block of 17 kg that comes to rest at 10 ms).
/// Depth: the rows hold the points that were found at the start of a step; how far others come in meanwhile is bounded by what
/// the bodies turn, times their reach. A fifth of a depth is taken back per step, so that turns of five steps may add up.
fn run(d: &Draw) -> Result<Found, String> {
    let mut w = build(d);
    let mut f = Found::default();
    let mut before = w.energy();
    let weight = if d.gravity { d.masses.iter().sum::<f64>() * 9.81 } else { 0.0 };
    let scale = before.kinetic + 2.0 * weight;
    let mut turn = turning(&w);
    for step in 0..d.steps {
        let counted = w.stats();
        w.advance();
        if w.stats().diverged_steps > 0 || w.state().q.iter().chain(&w.state().v).any(|x| !x.is_finite()) {
            return Err(format!("not finite at {step}"));
        }
        let (now, stats) = (w.energy(), w.stats());
        turn = turn.max(turning(&w));
        let whole = stats.divided_steps == counted.divided_steps && stats.halvings == counted.halvings;
        let first = usize::from(d.grounded);
        let in_contact = |k: usize| w.contacts().iter().any(|c| c.colliders.contains(&(first + k)));
        if in_contact(0) && in_contact(1) && whole {
            f.contacts += 1;
            let bounce = 2.0 * 9.81 * (d.surface.restitution * d.h).powi(2);
            let bound = 1e-9 * scale + weight * (stats.worst_penetration + bounce);
            f.gain = f.gain.max((now.kinetic + now.potential - before.kinetic - before.potential) / bound);
        }
        before = now;
        f.deep = f.deep.max(stats.worst_penetration / (START + 5.0 * turn * d.h * 0.45 + 1e-6));
    }
    Ok(f)
}

fn scenes(seeds: std::ops::Range<u64>) {
    let (mut touched, mut worst) = (0, [(0.0, 0), (0.0, 0)]);
    for seed in seeds.clone() {
        let found = run(&draw(seed)).unwrap_or_else(|e| panic!("seed {seed}: {e}: {:?}", draw(seed)));
        touched += u64::from(found.contacts > 0);
        for (worst, new) in worst.iter_mut().zip([found.gain, found.deep]) {
            if new > worst.0 {
                *worst = (new, seed);
            }
        }
    }
    println!("{seeds:?}: {touched} with both bodies in contact; gain, depth / bound: {worst:?}");
    assert!(touched * 4 > seeds.end - seeds.start, "{touched}");
    for (claim, (most, seed)) in ["energy", "depth"].iter().zip(worst) {
        assert!(most <= 1.0, "{claim}: {most} of the bound: seed {seed}: {:?}", draw(seed));
    }
}

/// `SCENES` in the environment asks for more.
fn count() -> u64 {
    std::env::var("SCENES").ok().and_then(|n| n.parse().ok()).unwrap_or(8000)
}

#[test]
fn random_scenes_keep_energy_and_depth() {
    scenes(0..count() / 2);
}

#[test]
fn more_random_scenes_keep_energy_and_depth() {
    scenes(count() / 2..count());
}

#[test]
#[ignore = "looks at one scene"]
fn trace() {
    let seed = std::env::var("SEED").unwrap().parse().unwrap();
    let d = draw(seed);
    let mut w = build(&d);
    println!("{d:?}");
    let mut deep = 0.0;
    for step in 0..d.steps {
        let e = w.energy();
        let before = w.state().clone();
        w.advance();
        let s = w.stats();
        if s.worst_penetration > deep + 1e-4 {
            deep = s.worst_penetration;
            println!(
                "step {step} depth {deep} {s:?}\n before {:?} v {:?}\n after {:?} v {:?}\n e {e:?} {:?}\n {:?}",
                before.q,
                before.v,
                w.state().q,
                w.state().v,
                w.energy(),
                w.contacts()
            );
            let mut k = realnoid::dynamics::Kinematics::new(w.model());
            realnoid::dynamics::kinematics(w.model(), &mut k, &before.q, &before.v);
            let mut det = realnoid::contact::Detector::new(w.model()).unwrap();
            let mut t = vec![];
            det.find(&k, d.h, &mut t);
            t.iter().for_each(|t| println!("  start touch {t:?} {:?}", t.placed(&k)));
            realnoid::dynamics::kinematics(w.model(), &mut k, &w.state().q, &w.state().v);
            t.iter().for_each(|t| println!("  end {:?}", t.placed(&k)));
            det.find(&k, d.h, &mut t);
            t.iter().for_each(|t| println!("  end touch {t:?} {:?}", t.placed(&k)));
        }
    }
}

/// At 9 m/s and 10 ms a ball slides 9 cm over a cone, and a capsule over the edge of a hull, within a step: a direction that
/// followed one point of them swung round and said that they part (13 cm, 2.5 cm deep).
#[test]
fn what_slides_within_a_step_is_held() {
    for seed in [18313, 2874] {
        let found = run(&draw(seed)).unwrap();
        assert!(found.deep <= 1.0, "{seed}: {found:?}");
    }
}
