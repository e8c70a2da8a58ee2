//! Which pairs are near: a list that holds as long as nothing has moved further than its margin allows (Verlet's).

use super::part::{Part, Shape};
use super::vector::{Frame, norm};
use crate::dynamics::Kinematics;
use crate::math::{M3, V3};

/// Pairs are listed up to this distance, and further if things are fast, m.
const MARGIN: f64 = 0.05;

/// A pair, and what its two parts were apart at least when the list was made, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed {
    pub pair: [u32; 2],
    distance: f64,
}

/// The pairs that are near: those of a list that were nearer than a limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near<'a> {
    list: &'a [Listed],
    limit: f64,
}

impl<'a> Near<'a> {
    /// In ascending order.
    pub(super) fn pairs(self) -> impl Iterator<Item = [u32; 2]> + 'a {
        self.list.iter().filter(move |l| l.distance < self.limit).map(|l| l.pair)
    }
}

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
    list: Vec<Listed>,
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
    pub(super) fn near(&mut self, parts: &[Part], k: &Kinematics, (reach, h): (f64, f64)) -> Near<'_> {
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
        if holds {
            return Near { list: &self.list, limit: needed + 2.0 * moved };
        }
        self.margin = MARGIN.max(4.0 * needed);
        self.search(parts, k);
        Near { list: &self.list, limit: needed }
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
                if self.may(*a, *b) {
                    let [x, y] = pair.map(|i| &parts[i as usize]);
                    let distance = distance([x, y], &[x.placed(k), y.placed(k)]);
                    if distance <= self.margin {
                        self.list.push(Listed { pair, distance });
                    }
                }
            }
        }
        self.list.sort_unstable_by_key(|l| l.pair);
    }
}

/// The larger one; what is not a number stays, so that the list is made anew.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// Two parts at these frames are at least this far apart, m.
pub(super) fn distance([x, y]: [&Part; 2], [f, g]: &[Frame; 2]) -> f64 {
    let (p, q) = (f.at(x.extent.0), g.at(y.extent.0));
    match (&x.shape, &y.shape) {
        (Shape::HalfSpace, _) => f.r.col2().dot(q - f.p) - x.margin - wide(g, y.extent.1, f.r.col2()).min(y.radius),
        (_, Shape::HalfSpace) => g.r.col2().dot(p - g.p) - y.margin - wide(f, x.extent.1, g.r.col2()).min(x.radius),
        _ => {
            let way = q - p;
            let balls = norm(way) - x.radius - y.radius;
            balls.max(beside((f, x), (g, y), way)).max(beside((g, y), (f, x), way))
        }
    }
}

/// Half the width of a box along a unit vector.
fn wide(frame: &Frame, half: V3<f64>, n: V3<f64>) -> f64 {
    let local = frame.r.tv(n);
    local.x.abs() * half.x + local.y.abs() * half.y + local.z.abs() * half.z
}

/// How far the box or ball around a part lies beside the box around another one, along the axes of that; `way` leads from
/// middle to middle.
fn beside((f, x): (&Frame, &Part), (g, y): (&Frame, &Part), way: V3<f64>) -> f64 {
    let local = f.r.tv(way);
    let (axes, half) = ([f.r.col0(), f.r.col1(), f.r.col2()], x.extent.1);
    let along = |axis: usize, c: f64, h: f64| c.abs() - h - wide(g, y.extent.1, axes[axis]).min(y.radius);
    along(0, local.x, half.x).max(along(1, local.y, half.y)).max(along(2, local.z, half.z))
}
