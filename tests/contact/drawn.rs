//! Scenes of two random bodies that mostly fly at each other.

use crate::scene::{self, Scene, forms, separation};
use crate::standing::Standing;
use crate::support::Random;
use crate::touching::{balls, ground, on_link, settings};
use realnoid::contact::Detector;
use realnoid::math::{Pose, Vec3};
use realnoid::model::{Collider, Model, Surface};
use realnoid::shape::ContactForm;
use realnoid::world::{Settings, World};

/// Overlap at the start at most, m.
pub const START: f64 = 5e-3;

/// What one scene is made of; printed where it fails.
#[derive(Clone, Debug)]
pub struct Draw {
    pub forms: [ContactForm; 2],
    pub masses: [f64; 2],
    pub surface: Surface,
    pub standing: Standing,
    pub gravity: bool,
    pub h: f64,
    pub steps: usize,
    pub poses: [Pose; 2],
    pub twists: [(Vec3, Vec3); 2],
}

fn share(rng: &mut Random) -> f64 {
    0.5 * (rng.unit() + 1.0)
}

/// Two bodies in the air or over a floor, overlapping by [`START`] at most.
pub fn draw(seed: u64) -> Draw {
    drawn(seed, |grounded| if grounded { Standing::Floor } else { Standing::Nothing })
}

/// The same over surfaces of triangles.
pub fn draw_on_surfaces(seed: u64) -> Draw {
    drawn(seed, |_| Standing::draw(&mut Random(!seed)))
}

fn drawn(seed: u64, standing: impl FnOnce(bool) -> Standing) -> Draw {
    let mut rng = Random(seed);
    let list = forms(&mut rng);
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
    let standing = standing(grounded);
    let (height, slide) = (standing.top() + 0.3 * share(&mut rng), rng.vec3(0.1));
    let at = |distance: f64| {
        let low = 0.2 + height + (-way.z).max(0.0) * distance;
        let first = Vec3::new(0.0, 0.0, low);
        [
            Pose::from_parts(first.into(), turned[0]),
            Pose::from_parts((first + way * distance + slide).into(), turned[1]),
        ]
    };
    let mut d = Draw { forms, masses, surface, standing, gravity, h, steps, poses: at(0.0), twists };
    let corners = d.standing.corners();
    let mut touching = Touching::new(&d);
    let mut distance = 0.15;
    while distance < 2.0 {
        d.poses = at(distance);
        d.poses.iter_mut().for_each(|p| p.translation.vector.z += 0.5 * (distance - 0.15));
        if touching.overlap(&d, &corners) < START {
            break;
        }
        distance += 0.05;
    }
    d
}

/// The scene as the detector sees it.
struct Touching {
    scene: Scene,
    detector: Option<Detector>,
}

impl Touching {
    fn new(d: &Draw) -> Self {
        let mut scene = Scene::new(&d.forms);
        let standing = d.standing.forms().into_iter().map(|form| scene::collider(form, None, Pose::identity()));
        scene.model.colliders.extend(standing);
        let detector = Detector::new(&scene.model);
        Self { scene, detector }
    }

    fn overlap(&mut self, d: &Draw, corners: &[Vec3]) -> f64 {
        let mut touches = vec![];
        (0..2).for_each(|k| self.scene.place(k, d.poses[k]));
        if let Some(detector) = &mut self.detector {
            detector.find(&self.scene.k, 0.0, &mut touches);
        }
        let told = touches.iter().map(|t| -t.placed(&self.scene.k).gap).fold(0.0, f64::max);
        (0..2).filter_map(|k| d.standing.sunk(corners, &d.forms[k], &d.poses[k])).fold(told, f64::max)
    }
}

impl Draw {
    /// Colliders of the world come before those of the two bodies.
    pub fn first(&self) -> usize {
        self.standing.forms().len()
    }

    pub fn build(&self) -> World {
        let list: Vec<(f64, f64)> = self.masses.iter().map(|m| (*m, 0.15)).collect();
        let mut m: Model = balls(&list, self.surface, ground(1.0));
        let standing = self.standing.forms().into_iter().map(|form| Collider { form, ..ground(1.0) });
        let mut colliders: Vec<Collider> = standing.collect();
        for (k, form) in self.forms.iter().enumerate() {
            colliders.push(on_link(&m, &format!("b{k}"), form.clone(), self.surface));
        }
        m.set_colliders(colliders);
        let base = settings(self.h, Default::default());
        let gravity = if self.gravity { base.gravity } else { [0.0; 3] };
        let mut w = World::new(m.into(), Settings { gravity, ..base }).unwrap();
        let mut s = w.state().clone();
        for (k, body) in w.model().bodies[1..].iter().enumerate() {
            let (p, (turn, speed)) = (&self.poses[k], self.twists[k]);
            let r = p.rotation.quaternion();
            s.q[body.q..body.q + 3].copy_from_slice(p.translation.vector.as_slice());
            s.q[body.q + 3..body.q + 7].copy_from_slice(&[r.w, r.i, r.j, r.k]);
            s.v[body.v..body.v + 3].copy_from_slice(turn.as_slice());
            s.v[body.v + 3..body.v + 6].copy_from_slice(speed.as_slice());
        }
        w.set_initial_state(s);
        w
    }
}

/// Where the two bodies are.
pub fn poses(w: &World) -> [Pose; 2] {
    [1, 2].map(|k| pose(&w.state().q[w.model().bodies[k].q..]))
}

/// Of a floating body's coordinates.
pub fn pose(q: &[f64]) -> Pose {
    let turn = nalgebra::Quaternion::new(q[3], q[4], q[5], q[6]);
    Pose::from_parts(Vec3::new(q[0], q[1], q[2]).into(), nalgebra::Unit::new_normalize(turn))
}

/// How far two bodies are apart at least, m.
pub fn apart(d: &Draw, x: &[Pose; 2]) -> f64 {
    -Inside::new(d).pair(d, x, f64::NEG_INFINITY)
}

/// How far two bodies and what stands are inside each other, found without the detector.
pub struct Inside {
    way: Vec3,
    rng: Random,
    corners: Vec<Vec3>,
    /// Has a body gone beyond the end of an open surface?
    gone: [bool; 2],
}

impl Inside {
    pub fn new(d: &Draw) -> Self {
        Self { way: Vec3::z(), rng: Random(1), corners: d.standing.corners(), gone: [false; 2] }
    }

    /// At most as much as `enough`, or what it is at most, m: each direction in which two convex bodies are apart proves that.
    pub fn most(&mut self, d: &Draw, x: &[Pose; 2], enough: f64) -> f64 {
        let mut most = self.pair(d, x, enough);
        for (k, gone) in self.gone.iter_mut().enumerate() {
            match d.standing.sunk(&self.corners, &d.forms[k], &x[k]) {
                Some(depth) if !*gone => most = most.max(depth),
                _ => *gone = true,
            }
        }
        most
    }

    fn pair(&mut self, d: &Draw, x: &[Pose; 2], enough: f64) -> f64 {
        let apart = |n: &Vec3| separation((&d.forms[0], &x[0]), (&d.forms[1], &x[1]), n);
        let mut best = apart(&self.way);
        let mut tries = 0;
        let (mut wide, line) = (1.0, x[1].translation.vector - x[0].translation.vector);
        while -best > enough && tries < 2000 {
            let n = match tries {
                0 => line,
                // All around, then nearer and nearer to the best one.
                1..500 => self.rng.vec3(1.0),
                _ => self.way + self.rng.vec3(wide),
            };
            tries += 1;
            let n = n.try_normalize(1e-6).unwrap_or(self.way);
            let s = apart(&n);
            if s > best {
                (best, self.way) = (s, n);
            } else if tries > 500 {
                wide = (0.99f64 * wide).max(1e-4);
            }
        }
        -best
    }
}
