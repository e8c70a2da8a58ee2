//! Which bodies of one robot are computed side by side.

use super::{LANES, X};
use crate::math::{M3, S3, V3};
use crate::model::{Body, JointType, Model};

/// Where the motion of a parent is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A body that is computed alone, or the world: index into `Model::bodies`.
    Alone(usize),
    /// Step and lane.
    Lane(usize, usize),
}

/// What a step collects from the bodies that hang on its own.
#[derive(Clone, Debug)]
pub(super) enum Below {
    /// Every lane from the same lane of the next step.
    Straight,
    /// Lane, and the step and lane of a child; of the children of one body the one with the highest index first, as in
    /// [`super::super::aba`].
    Some(Vec<(usize, usize, usize)>),
}

/// Four bodies with revolute joints, none above another. A lane that is left over repeats another one of the step.
#[derive(Clone, Debug)]
pub(super) struct Step {
    /// Frame at angle 0 in the parent's.
    pub r: M3<X>,
    pub p: V3<X>,
    /// Mass, first moment, inertia.
    pub mass: (X, V3<X>, S3<X>),
    pub body: [usize; LANES],
    pub q: [usize; LANES],
    pub v: [usize; LANES],
    /// Lanes that are no repetitions.
    pub own: [bool; LANES],
    pub from: [Place; LANES],
    /// All parents are in the same lane of the step before.
    pub straight: bool,
    /// Some stand on the world.
    on_world: bool,
    pub below: Below,
}

/// The order in which a robot is computed: steps outwards, and what is computed alone.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    pub steps: Vec<Step>,
    /// Bodies on the world whose joints are not revolute.
    pub alone: Vec<usize>,
    /// Bodies (step, lane) that hang on one that is computed alone (first), highest index first.
    pub hang: Vec<(usize, usize, usize)>,
}

impl Schedule {
    /// `None` if a body that hangs on another one has a joint that is not revolute. Only where [`X`] is available.
    pub fn new(m: &Model) -> Option<Self> {
        let is_lane = |i: usize| m.bodies[i].joint == JointType::Revolute;
        if (1..m.bodies.len()).any(|i| !is_lane(i) && m.bodies[i].parent != 0) {
            return None;
        }
        let mut height = vec![0usize; m.bodies.len()];
        for i in (1..m.bodies.len()).rev() {
            height[m.bodies[i].parent] = height[m.bodies[i].parent].max(height[i] + 1);
        }
        let (mut place, mut steps) = (vec![None; m.bodies.len()], vec![]);
        let alone: Vec<usize> = (1..m.bodies.len()).filter(|i| !is_lane(*i)).collect();
        place[0] = Some(Place::Alone(0));
        alone.iter().for_each(|i| place[*i] = Some(Place::Alone(*i)));
        loop {
            let ready = |i: &usize| place[*i].is_none() && place[m.bodies[*i].parent].is_some();
            let mut next: Vec<usize> = (1..m.bodies.len()).filter(ready).collect();
            if next.is_empty() {
                break;
            }
            next.sort_by_key(|i| (std::cmp::Reverse(height[*i]), *i));
            next.truncate(LANES);
            let lanes = seats(m, &next, &place, steps.len());
            for (lane, body) in lanes.iter().enumerate() {
                if let Some(body) = body {
                    place[*body] = Some(Place::Lane(steps.len(), lane));
                }
            }
            steps.push(step(m, lanes, &place, steps.len()));
        }
        let mut schedule = Self { steps, alone, hang: vec![] };
        schedule.connect(m, &place);
        Some(schedule)
    }

    /// What stands on the world may have been moved since the last time.
    #[inline(always)]
    pub fn look(&mut self, m: &Model) {
        for step in self.steps.iter_mut().filter(|step| step.on_world) {
            (step.r, step.p) = frames(m, &step.body);
        }
    }

    /// Fills in what hangs on what.
    fn connect(&mut self, m: &Model, place: &[Option<Place>]) {
        let mut below: Vec<Vec<(usize, usize, usize)>> = vec![vec![]; self.steps.len()];
        for (i, b) in m.bodies.iter().enumerate().skip(1).rev() {
            match (place[b.parent], place[i]) {
                (Some(Place::Lane(s, lane)), Some(Place::Lane(step, from))) => below[s].push((lane, step, from)),
                (Some(Place::Alone(body)), Some(Place::Lane(step, from))) if body != 0 => {
                    self.hang.push((body, step, from));
                }
                _ => {}
            }
        }
        for (s, (step, mut below)) in self.steps.iter_mut().zip(below).enumerate() {
            let own = step.own.iter().filter(|own| **own).count();
            let next = below.iter().all(|(lane, from, from_lane)| *from == s + 1 && lane == from_lane);
            let mut lanes: Vec<usize> = below.iter().map(|b| b.0).collect();
            lanes.sort_unstable();
            lanes.dedup();
            step.below = if next && below.len() == own && lanes.len() == own {
                Below::Straight
            } else {
                below.shrink_to_fit();
                Below::Some(below)
            };
        }
    }
}

/// Lanes for these bodies, the parent's where it is in the step before and nobody else has it.
fn seats(m: &Model, bodies: &[usize], place: &[Option<Place>], step: usize) -> [Option<usize>; LANES] {
    let mut lanes = [None; LANES];
    let mut rest = vec![];
    for i in bodies {
        match place[m.bodies[*i].parent] {
            Some(Place::Lane(s, lane)) if s + 1 == step && lanes[lane].is_none() => lanes[lane] = Some(*i),
            _ => rest.push(*i),
        }
    }
    let free = lanes.iter_mut().filter(|lane| lane.is_none());
    free.zip(rest).for_each(|(lane, body)| *lane = Some(body));
    lanes
}

fn step(m: &Model, lanes: [Option<usize>; LANES], place: &[Option<Place>], index: usize) -> Step {
    let any = lanes.iter().flatten().next().copied().unwrap_or_default();
    let body = lanes.map(|body| body.unwrap_or(any));
    let of = |f: &dyn Fn(&Body) -> f64| X::from_numbers(body.map(|i| f(&m.bodies[i])));
    let v3 = |f: &dyn Fn(&Body) -> V3<f64>| V3::new(of(&|b| f(b).x), of(&|b| f(b).y), of(&|b| f(b).z));
    let inertia = S3 {
        xx: of(&|b| b.inertia.xx),
        xy: of(&|b| b.inertia.xy),
        xz: of(&|b| b.inertia.xz),
        yy: of(&|b| b.inertia.yy),
        yz: of(&|b| b.inertia.yz),
        zz: of(&|b| b.inertia.zz),
    };
    let (r, p) = frames(m, &body);
    let own = lanes.map(|body| body.is_some());
    let from = body.map(|i| place[m.bodies[i].parent].unwrap_or(Place::Alone(0)));
    let straight = (0..LANES).all(|lane| !own[lane] || (index > 0 && from[lane] == Place::Lane(index - 1, lane)));
    Step {
        r,
        p,
        mass: (of(&|b| b.mass), v3(&|b| b.mc), inertia),
        body,
        q: body.map(|i| m.bodies[i].q),
        v: body.map(|i| m.bodies[i].v),
        own,
        from,
        straight,
        on_world: body.iter().any(|i| m.bodies[*i].parent == 0),
        below: Below::Some(vec![]),
    }
}

/// Frames at angle 0 in those of the parents.
#[inline(always)]
pub(super) fn frames(m: &Model, body: &[usize; LANES]) -> (M3<X>, V3<X>) {
    let [a, b, c, d] = body.map(|i| &m.bodies[i]);
    let v3 = |a: V3<f64>, b: V3<f64>, c: V3<f64>, d: V3<f64>| {
        let of = |k: [f64; LANES]| X::from_numbers(k);
        V3::new(of([a.x, b.x, c.x, d.x]), of([a.y, b.y, c.y, d.y]), of([a.z, b.z, c.z, d.z]))
    };
    let row = |k: usize| v3(a.tree_r.r[k], b.tree_r.r[k], c.tree_r.r[k], d.tree_r.r[k]);
    (M3::rows(row(0), row(1), row(2)), v3(a.tree_p, b.tree_p, c.tree_p, d.tree_p))
}
