//! What the narrow phase says of two shapes, against closed forms and against bounds that certify it.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "contact/scene.rs"]
mod scene;
mod support;

use realnoid::contact::{Detector, Touch};
use realnoid::math::{Pose, V3, Vec3};
use realnoid::shape::ContactForm;
use scene::{Scene, forms, pose, separation, support as reach_of};
use support::Random;

/// Rounding of a few operations on coordinates of about 1 m.
const ROUNDING: f64 = 1e-13;

fn least(scene: &Scene, touches: &[Touch]) -> f64 {
    touches.iter().map(|t| t.placed(&scene.k).gap).fold(f64::INFINITY, f64::min)
}

/// Runs `n` random poses of two forms; gives what was found and the two poses to `check`.
fn poses(pair: [ContactForm; 2], n: usize, seed: u64, mut check: impl FnMut(f64, &Pose, &Pose)) {
    let mut rng = Random(seed);
    let mut scene = Scene::new(&pair);
    let mut detector = Detector::new(&scene.model).unwrap();
    for _ in 0..n {
        let (a, b) = (pose(&mut rng, 0.3), pose(&mut rng, 0.3));
        scene.place(0, a);
        scene.place(1, b);
        let touches = scene.all(&mut detector);
        check(least(&scene, &touches), &a, &b);
    }
}

fn center(x: &Pose) -> Vec3 {
    x.translation.vector
}

/// Distance of a point from the line piece of a capsule.
fn to_axis(x: &Pose, half: f64, p: &Vec3) -> f64 {
    let local = x.inverse_transform_point(&(*p).into()).coords;
    (local - Vec3::new(0.0, 0.0, local.z.clamp(-half, half))).norm()
}

#[test]
fn balls_and_capsules_are_closed_forms() {
    let ball = |radius| ContactForm::Ball { radius };
    let capsule = |half| ContactForm::Capsule { bottom: 0.05, top: 0.05, half };
    poses([ball(0.1), ball(0.2)], 20_000, 1, |gap, a, b| {
        assert!((gap - ((center(a) - center(b)).norm() - 0.3)).abs() < ROUNDING);
    });
    poses([ball(0.1), capsule(0.2)], 20_000, 2, |gap, a, b| {
        assert!((gap - (to_axis(b, 0.2, &center(a)) - 0.15)).abs() < ROUNDING);
    });
    poses([capsule(0.2), ball(0.1)], 20_000, 3, |gap, a, b| {
        assert!((gap - (to_axis(a, 0.2, &center(b)) - 0.15)).abs() < ROUNDING);
    });
    // Golden section over one axis of the distance from the other one, which is convex along it. Its own error is the
    // square root of rounding squared, times a curvature of 1/distance.
    poses([capsule(0.2), capsule(0.15)], 20_000, 4, |gap, a, b| {
        let f = |t: f64| to_axis(a, 0.2, &(b * nalgebra::Point3::new(0.0, 0.0, t)).coords);
        let (mut low, mut high) = (-0.15, 0.15);
        for _ in 0..80 {
            let (p, q) = (high - 0.618_034 * (high - low), low + 0.618_034 * (high - low));
            if f(p) < f(q) { high = q } else { low = p }
        }
        let truth = f(0.5 * (low + high)) - 0.1;
        assert!((gap - truth).abs() < 1e-8, "{gap} {truth}");
    });
}

#[test]
fn a_ball_and_a_box_are_a_closed_form() {
    let half = [0.1, 0.2, 0.15];
    let truth = |x: &Pose, p: &Vec3| {
        let c = x.inverse_transform_point(&(*p).into()).coords.abs() - Vec3::from(half);
        let outside = c.map(|x| x.max(0.0)).norm();
        outside + c.max().min(0.0) - 0.05
    };
    let pair = [ContactForm::Cuboid { half }, ContactForm::Ball { radius: 0.05 }];
    poses(pair.clone(), 10_000, 5, |gap, a, b| assert!((gap - truth(a, &center(b))).abs() < ROUNDING));
    let [a, b] = pair;
    poses([b, a], 10_000, 6, |gap, a, b| assert!((gap - truth(b, &center(a))).abs() < ROUNDING));
}

#[test]
fn a_half_space_meets_the_lowest_point_of_everything() {
    let mut rng = Random(7);
    for round in 0..500 {
        for form in forms(&mut rng) {
            let mut scene = Scene::new(std::slice::from_ref(&form));
            let ground = pose(&mut rng, 0.2);
            let plane = scene::collider(ContactForm::HalfSpace, None, ground);
            let at = if round % 2 == 0 { 0 } else { 1 };
            scene.model.colliders.insert(at, plane);
            let mut detector = Detector::new(&scene.model).unwrap();
            let x = pose(&mut rng, 0.3);
            scene.place(0, x);
            let touches = scene.all(&mut detector);
            let up = ground.rotation * Vec3::z();
            let lowest = (x * nalgebra::Point3::from(reach_of(&form, &x.inverse_transform_vector(&-up)))).coords;
            let truth = up.dot(&(lowest - center(&ground)));
            let gap = least(&scene, &touches);
            // 1e-9: a point of a rim that is lower than its neighbours by less is not told.
            assert!((gap - truth).abs() < 2e-9, "{form:?}: {gap} {truth}");
            let to = if at == 0 { up } else { -up };
            assert!(touches.iter().all(|t| (Vec3::from(t.placed(&scene.k).normal) - to).norm() < ROUNDING));
        }
    }
}

/// For every pair of kinds: no direction separates better than the one that was found, and the gap is what that direction
/// says. Where they are apart the two points prove the distance from above.
#[test]
fn every_pair_is_certified_by_its_normal() {
    let mut rng = Random(8);
    let mut overlaps = 0;
    for _ in 0..60 {
        let list = forms(&mut rng);
        for (i, a) in list.iter().enumerate() {
            for b in &list[i..] {
                let mut scene = Scene::new(&[a.clone(), b.clone()]);
                let mut detector = Detector::new(&scene.model).unwrap();
                let (x, y) = (pose(&mut rng, 0.15), pose(&mut rng, 0.15));
                scene.place(0, x);
                scene.place(1, y);
                let touches = scene.all(&mut detector);
                let placed = touches.iter().map(|t| t.placed(&scene.k));
                let best = placed.min_by(|p, q| p.gap.total_cmp(&q.gap)).unwrap_or_else(|| panic!("{a:?} {b:?}"));
                let n = Vec3::from(best.normal);
                assert!((n.norm() - 1.0).abs() < ROUNDING);
                let says = separation((a, &x), (b, &y), &n);
                let scale = 1e-6 * 0.3 + 0.02 * (-says).max(0.0);
                // One tolerance for the face that is taken, one for its points, where the deepest lies beside it.
                assert!(
                    (best.gap - says).abs() < if says > 0.0 { 1e-6 } else { 2.0 * scale },
                    "{a:?}\n{b:?}\n{} {says}",
                    best.gap
                );
                overlaps += usize::from(says < 0.0);
                for _ in 0..200 {
                    let other = (n + rng.vec3(0.3)).normalize();
                    let better = separation((a, &x), (b, &y), &other);
                    assert!(better <= says + 2.0 * scale, "{a:?}\n{b:?}\n{better} > {says}");
                }
            }
        }
    }
    assert!(overlaps > 300, "{overlaps}");
}

/// Shapes that are apart, moved along their nearest line until they just touch: the gap is what is left, the direction
/// stays. This is where things rest, and where a search for nearest points has the least to go by.
#[test]
fn touching_shapes_have_the_gap_that_was_left() {
    let mut rng = Random(12);
    for _ in 0..60 {
        let list = forms(&mut rng);
        for (i, a) in list.iter().enumerate() {
            for b in &list[i..] {
                let mut scene = Scene::new(&[a.clone(), b.clone()]);
                let mut detector = Detector::new(&scene.model).unwrap();
                let (x, mut y) = (pose(&mut rng, 0.1), pose(&mut rng, 0.1));
                y.translation.vector += rng.vec3(1.0).normalize() * 0.8;
                scene.place(0, x);
                scene.place(1, y);
                let nearest = |scene: &mut Scene, detector: &mut Detector| {
                    let touches = scene.all(detector);
                    let placed = touches.iter().map(|t| t.placed(&scene.k));
                    placed.min_by(|p, q| p.gap.total_cmp(&q.gap)).unwrap()
                };
                let far = nearest(&mut scene, &mut detector);
                let n = Vec3::from(far.normal);
                for left in [1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-7, -1e-5, -1e-4] {
                    let mut at = y;
                    at.translation.vector -= n * (far.gap - left);
                    scene.place(1, at);
                    let here = nearest(&mut scene, &mut detector);
                    // A face is preferred up to 1e-6 of the size of the smaller shape, which is below 0.5 m, and its points stand
                    // for the nearest one up to as much again.
                    let slack = 1e-6;
                    let error = here.gap - left;
                    // A gap changes by at most what the shapes move. Beyond the touch of two tips that is a gap again: they have
                    // passed each other. (The lower bound holds always: the direction they came from is still one.)
                    let more = if left < 0.0 { -2.0 * left } else { 0.02 * left };
                    let fine = error > -slack - 0.02 * left.abs() && error < slack + more;
                    assert!(fine, "{a:?}\n{b:?}\n{left}: {}", here.gap);
                    // At a corner a direction that is off by θ changes a gap g by g·θ²/2 alone.
                    let off = (Vec3::from(here.normal) - n).norm();
                    if left > 1e-6 {
                        assert!(off < 1e-3 + (2.0 * slack / left).sqrt(), "{a:?}\n{b:?}\n{left}: {off} {}", here.gap);
                    }
                }
            }
        }
    }
}

/// A ball is a cuboid of no size with a radius, a capsule one of no width: the search must say what the closed forms say.
#[test]
fn search_and_closed_forms_agree() {
    let round = |half: [f64; 3], radius| ContactForm::RoundCuboid { half, radius };
    let (ball, fake_ball) = (ContactForm::Ball { radius: 0.1 }, round([0.0; 3], 0.1));
    let (rod, fake_rod) = (ContactForm::Capsule { bottom: 0.05, top: 0.05, half: 0.2 }, round([0.0, 0.0, 0.2], 0.05));
    let block = ContactForm::Cuboid { half: [0.1, 0.12, 0.14] };
    let corners: Vec<Vec3> = (0..8)
        .map(|i| {
            let s = |k: i32, x: f64| if i >> k & 1 == 1 { x } else { -x };
            Vec3::new(s(0, 0.1), s(1, 0.12), s(2, 0.14))
        })
        .collect();
    let hull = ContactForm::Hull(corners.into());
    let pairs = [
        ([ball.clone(), ball.clone()], [fake_ball.clone(), round([0.0; 3], 0.1)]),
        ([ball.clone(), rod.clone()], [fake_ball.clone(), fake_rod.clone()]),
        ([rod.clone(), rod.clone()], [fake_rod.clone(), fake_rod.clone()]),
        ([block.clone(), ball.clone()], [hull.clone(), fake_ball.clone()]),
        ([block.clone(), rod], [hull, fake_rod]),
    ];
    for (seed, (exact, search)) in pairs.into_iter().enumerate() {
        let mut truth = vec![];
        poses(exact, 4000, 20 + seed as u64, |gap, _, _| truth.push(gap));
        let mut i = 0;
        poses(search, 4000, 20 + seed as u64, |gap, _, _| {
            // Cores that overlap: a face is taken where it is within 2 % of the depth of the best direction.
            let tolerance = if truth[i] > -0.05 { 1e-9 } else { 0.02 * -truth[i] };
            assert!((gap - truth[i]).abs() < tolerance, "pair {seed}: {gap} {}", truth[i]);
            i += 1;
        });
    }
}

/// Sides swapped: the same gaps, points and opposite normals.
#[test]
fn sides_may_be_swapped() {
    let mut rng = Random(9);
    for _ in 0..20 {
        let list = forms(&mut rng);
        for a in &list {
            for b in &list {
                let (x, y) = (pose(&mut rng, 0.25), pose(&mut rng, 0.25));
                let told = |forms: [&ContactForm; 2], at: [Pose; 2]| {
                    let mut scene = Scene::new(&forms.map(Clone::clone));
                    let mut detector = Detector::new(&scene.model).unwrap();
                    scene.place(0, at[0]);
                    scene.place(1, at[1]);
                    let touches = scene.all(&mut detector);
                    let placed: Vec<_> = touches.iter().map(|t| t.placed(&scene.k)).collect();
                    placed.into_iter().min_by(|p, q| p.gap.total_cmp(&q.gap)).unwrap()
                };
                let (p, q) = (told([a, b], [x, y]), told([b, a], [y, x]));
                // Deep overlaps may come out through either of two faces that are nearly as near.
                let tolerance = 1e-6 + 0.05 * (-p.gap).max(0.0);
                assert!((p.gap - q.gap).abs() < tolerance, "{a:?}\n{b:?}\n{} {}", p.gap, q.gap);
                if p.gap > 0.01 {
                    assert!((Vec3::from(p.normal) + Vec3::from(q.normal)).norm() < 1e-3, "{a:?}\n{b:?}");
                }
            }
        }
    }
}

/// The rate of a gap is the relative velocity of its points along the normal; cores move rigidly, so that it holds
/// along a motion without asking again.
#[test]
fn a_gap_opens_with_the_normal_velocity() {
    let mut rng = Random(10);
    for _ in 0..40 {
        let list = forms(&mut rng);
        for a in &list {
            let b = &list[(rng.next() % list.len() as u64) as usize];
            let mut scene = Scene::new(&[a.clone(), b.clone()]);
            let mut detector = Detector::new(&scene.model).unwrap();
            let (x, y) = (pose(&mut rng, 0.25), pose(&mut rng, 0.25));
            let (w, v) = (rng.vec3(1.0), rng.vec3(1.0));
            scene.place(0, x);
            scene.place(1, y);
            let touches = scene.all(&mut detector);
            for t in &touches {
                scene.place(1, y);
                let here = t.placed(&scene.k);
                if here.gap.abs() < 1e-3 && matches!(t.normal, realnoid::contact::Normal::Between) {
                    continue;
                }
                let arm = Vec3::from(here.point) - center(&y);
                // A turn about the point of contact's own side leaves a normal that hangs on that side: use what moves.
                let side_turns = matches!(t.normal, realnoid::contact::Normal::On(1, _));
                let spin = if side_turns { Vec3::zeros() } else { w };
                let rate = Vec3::from(here.normal).dot(&(v + spin.cross(&arm)));
                let e = 1e-6;
                let mut at = |s: f64| {
                    let turn = realnoid::math::Quat::from_scaled_axis(spin * s);
                    scene.place(1, Pose::from_parts((center(&y) + v * s).into(), turn * y.rotation));
                    t.placed(&scene.k).gap
                };
                let measured = (at(e) - at(-e)) / (2.0 * e);
                // Rounding of a metre over 2e-6, and third derivatives (curvature 1/gap³) times 1e-12.
                assert!((measured - rate).abs() < 1e-6, "{a:?}\n{b:?}\n{measured} {rate}");
            }
        }
    }
}

/// Equal centres and no sizes: no NaN, keys in order and each once.
#[test]
fn degenerate_input_gives_numbers() {
    let mut rng = Random(11);
    let mut list = forms(&mut rng);
    list.extend([
        ContactForm::Ball { radius: 0.0 },
        ContactForm::Cuboid { half: [0.0; 3] },
        ContactForm::Cuboid { half: [0.1, 0.1, 0.0] },
        ContactForm::Capsule { bottom: 0.0, top: 0.0, half: 0.0 },
        ContactForm::Capsule { bottom: 0.1, top: 0.05, half: 0.0 },
        ContactForm::Ellipsoid { radii: [0.1, 0.0, 0.1] },
        ContactForm::Cylinder { radius: 0.0, half: 0.1 },
        ContactForm::Cylinder { radius: 0.1, half: 0.0 },
        ContactForm::Cone { radius: 0.1, half: 0.0 },
        ContactForm::Hull(vec![Vec3::zeros(); 4].into()),
        ContactForm::Hull(vec![Vec3::x(), Vec3::y(), Vec3::zeros()].into()),
    ]);
    for a in &list {
        for b in &list {
            let mut scene = Scene::new(&[a.clone(), b.clone()]);
            let mut detector = Detector::new(&scene.model).unwrap();
            for turned in [false, true] {
                let mut at = Pose::identity();
                if turned {
                    at.rotation = rng.rotation();
                }
                scene.place(1, at);
                let touches = scene.all(&mut detector);
                for t in &touches {
                    let p = t.placed(&scene.k);
                    let all = [p.gap, p.normal.x, p.normal.y, p.normal.z, p.point.x, p.point.y, p.point.z];
                    assert!(all.iter().all(|x| x.is_finite()), "{a:?} {b:?} {p:?}");
                }
                assert!(touches.windows(2).all(|w| w[0].key() < w[1].key()), "{a:?} {b:?}");
            }
        }
    }
    let mut scene = Scene::new(&[list[0].clone(), list[1].clone()]);
    let mut detector = Detector::new(&scene.model).unwrap();
    scene.k.p[1] = V3::new(f64::NAN, 0.0, 0.0);
    assert!(scene.all(&mut detector).is_empty());
    scene.place(0, Pose::identity());
    scene.k.r[1].r[0].x = f64::NAN;
    assert!(scene.all(&mut detector).is_empty());
}
