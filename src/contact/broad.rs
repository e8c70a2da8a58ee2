//! Which pairs are near: a list that holds as long as nothing has moved further than its margin allows (Verlet's).

use super::part::{Part, Shape};
use super::vector::norm;
use crate::dynamics::Kinematics;
use crate::math::{M3, V3};

/// Pairs are listed up to this distance, and further if things are fast, m.
const MARGIN: f64 = 0.05;

/// Pairs that may touch, and those of them that are near.
#[derive(Clone, Debug)]
pub(super) struct Broad {
    /// Bit b of row a: may these parts touch?
    allowed: Vec<u64>,
    words: usize,
    /// Bodies with parts that move, and how far the furthest point of them is from the body's origin.
    bodies: Vec<(usize, f64)>,
    /// Where the bodies were when the list was made.
    then: Vec<(M3<f64>, V3<f64>)>,
    margin: f64,
    fresh: bool,
    list: Vec<[u32; 2]>,
    /// Per part: where it begins and ends along x.
    spans: Vec<(f64, f64, u32)>,
    centers: Vec<V3<f64>>,
}

impl Broad {
    /// `None` if no pair may touch.
    pub(super) fn new(parts: &[Part], may: impl Fn(usize, usize) -> bool) -> Option<Self> {
        let words = parts.len().div_ceil(64);
        let mut allowed = vec![0; words * parts.len()];
        let mut any = false;
        for a in 0..parts.len() {
            for b in (a + 1..parts.len()).filter(|b| may(a, *b)) {
                allowed[a * words + b / 64] |= 1 << (b % 64);
                any = true;
            }
        }
        let mut bodies: Vec<(usize, f64)> = vec![];
        for part in parts.iter().filter(|p| p.body != 0) {
            let far = norm(part.middle) + part.radius;
            match bodies.iter_mut().find(|(body, _)| *body == part.body) {
                Some((_, most)) => *most = most.max(far),
                None => bodies.push((part.body, far)),
            }
        }
        let then = vec![(M3::identity(), V3::default()); bodies.len()];
        let n = parts.len();
        let (list, spans, centers) = (vec![], Vec::with_capacity(n), Vec::with_capacity(n));
        any.then_some(Self { allowed, words, bodies, then, margin: MARGIN, fresh: false, list, spans, centers })
    }

    fn may(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a.min(b) as usize, a.max(b) as usize);
        self.allowed[a * self.words + b / 64] >> (b % 64) & 1 == 1
    }

    /// The pairs that are nearer than `reach` plus what two bodies may approach in `h` seconds, and some that are not; in
    /// ascending order.
    pub(super) fn near(&mut self, parts: &[Part], k: &Kinematics, (reach, h): (f64, f64)) -> &[[u32; 2]] {
        let mut fastest: f64 = 0.0;
        let mut moved: f64 = 0.0;
        for ((body, far), (r, p)) in self.bodies.iter().zip(&self.then) {
            let (now_r, now_p) = (&k.r[*body], k.p[*body]);
            let turn: f64 = (0..3).map(|i| now_r.r[i] - r.r[i]).map(|d| d.dot(d)).sum();
            moved = larger(moved, norm(now_p - *p) + far * turn.sqrt());
            fastest = larger(fastest, norm(k.v[*body]) + far * norm(k.w[*body]));
        }
        let needed = reach + 2.0 * h * fastest;
        let holds = self.fresh && 2.0 * moved + needed <= self.margin;
        if !holds {
            self.margin = MARGIN.max(4.0 * needed);
            self.search(parts, k);
        }
        &self.list
    }

    /// Sweeps along x.
    fn search(&mut self, parts: &[Part], k: &Kinematics) {
        self.fresh = true;
        for (then, (body, _)) in self.then.iter_mut().zip(&self.bodies) {
            *then = (k.r[*body], k.p[*body]);
        }
        self.centers.clear();
        self.centers.extend(parts.iter().map(|p| p.center(k)));
        self.spans.clear();
        for (i, part) in parts.iter().enumerate() {
            let endless = matches!(part.shape, Shape::HalfSpace);
            let wide = if endless { f64::INFINITY } else { part.radius };
            self.spans.push((self.centers[i].x - wide, self.centers[i].x + wide, i as u32));
        }
        self.spans.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        self.list.clear();
        for (i, (_, end, a)) in self.spans.iter().enumerate() {
            for (_, _, b) in self.spans[i + 1..].iter().take_while(|s| s.0 <= end + self.margin) {
                let pair = [*a.min(b), *a.max(b)];
                if self.may(*a, *b) && distance(parts, pair, k) <= self.margin {
                    self.list.push(pair);
                }
            }
        }
        self.list.sort_unstable();
    }
}

/// The larger one; what is not a number stays, so that the list is made anew.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// Two parts are at least this far apart, m.
pub(super) fn distance(parts: &[Part], [a, b]: [u32; 2], k: &Kinematics) -> f64 {
    let (x, y) = (&parts[a as usize], &parts[b as usize]);
    match (&x.shape, &y.shape) {
        (Shape::HalfSpace, _) => above(x, y, k),
        (_, Shape::HalfSpace) => above(y, x, k),
        _ => {
            let (p, q) = (x.center(k), y.center(k));
            let balls = norm(q - p) - x.radius - y.radius;
            let (large, small, center) = if x.radius >= y.radius { (x, y, q) } else { (y, x, p) };
            balls.max(outside(large, center, k) - small.radius)
        }
    }
}

fn above(ground: &Part, part: &Part, k: &Kinematics) -> f64 {
    let frame = ground.placed(k);
    frame.r.col2().dot(part.center(k) - frame.p) - part.radius - ground.margin
}

/// Distance of a point from the box around a part.
fn outside(part: &Part, point: V3<f64>, k: &Kinematics) -> f64 {
    let c = part.placed(k).inside(point) - part.extent.0;
    let h = part.extent.1;
    let beyond = |c: f64, h: f64| (c.abs() - h).max(0.0);
    norm(V3::new(beyond(c.x, h.x), beyond(c.y, h.y), beyond(c.z, h.z)))
}
