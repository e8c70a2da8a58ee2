//! All touches of a model.

use super::broad::{Broad, distance};
use super::manifold::{Scratch, manifold};
use super::nearest::Placed;
use super::part::{Part, Shape};
use super::plane::{Ground, on_ground};
use super::raw::Raw;
use super::round::{Rod, cuboid_ball, rods};
use super::solid::{Kind, Solid};
use super::surface::{Query, on_surface};
use super::touch::Touch;
use super::vector::{Frame, norm};
use crate::dynamics::Kinematics;
use crate::model::{Model, Part as EffectPart, Surface};

/// Touches are found up to this gap, and further as far as bodies come nearer within a step, m.
const REACH: f64 = 2e-3;
/// Bodies may come nearer by so many times what their velocities at the start of the step say.
const FASTER: f64 = 1.5;

/// Finds touches. Makes its memory once, and more only when there are more touches than ever before.
#[derive(Clone, Debug)]
pub struct Detector {
    parts: Vec<Part>,
    broad: Broad,
    scratch: Scratch,
    raws: Vec<Raw>,
    fastest: f64,
    /// Is [`Detector::fastest`] asked for?
    watches: bool,
}

impl Detector {
    /// `None` if there is no pair that could touch: two colliders on one body, and pairs of links that
    /// `Model::excluded_pairs` names, cannot.
    pub fn new(m: &Model) -> Option<Self> {
        let parts: Vec<Part> = m.colliders.iter().map(|c| Part::of(m, c)).collect();
        let excluded = |a: &Part, b: &Part| match (a.link, b.link) {
            (Some(a), Some(b)) => m.excluded_pairs.binary_search(&[a.min(b), a.max(b)]).is_ok(),
            _ => false,
        };
        let convex = |p: &Part| matches!(p.shape, Shape::Convex(_));
        let may = |a: usize, b: usize| {
            let (a, b) = (&parts[a], &parts[b]);
            a.body != b.body && (convex(a) || convex(b)) && !excluded(a, b)
        };
        let broad = Broad::new(&parts, may)?;
        Some(Self {
            broad,
            parts,
            scratch: Scratch::default(),
            raws: vec![],
            fastest: 0.0,
            watches: !m.effects.off.has(EffectPart::ContinuousDetection),
        })
    }

    /// How the surfaces of a pair touch.
    pub fn surface(&self, pair: [u32; 2]) -> Surface {
        self.parts[pair[0] as usize].friction.with(&self.parts[pair[1] as usize].friction)
    }

    /// Of the last [`Detector::find`]: how far two parts that are near come towards each other within the step, as a multiple
    /// of the least width of the thinner one. Above 1 they might pass through each other unseen. 0 if continuous detection is off.
    pub fn fastest(&self) -> f64 {
        if self.watches { self.fastest } else { 0.0 }
    }

    /// All touches that could close within a step of `h` seconds of this motion, ordered by [`Touch::key`], each key once.
    pub fn find(&mut self, k: &Kinematics, h: f64, out: &mut Vec<Touch>) {
        out.clear();
        self.fastest = 0.0;
        let parts = &self.parts;
        for pair in self.broad.near(parts, k, (REACH, FASTER * h)).pairs() {
            let (a, b) = (&parts[pair[0] as usize], &parts[pair[1] as usize]);
            let ([va, vb], [wa, wb]) = split(a.speed(k), b.speed(k));
            let approach = h * (norm(vb - va) + wa * a.radius + wb * b.radius);
            let reach = REACH + FASTER * approach;
            let placed = [a.placed(k), b.placed(k)];
            let least = distance([a, b], &placed);
            // A turn that is not a number does not show in the distance of balls.
            let turns = placed[0].r.r[0].x + placed[1].r.r[0].x;
            if least >= reach || (least + turns).is_nan() {
                continue;
            }
            self.fastest = self.fastest.max(approach / a.thickness.min(b.thickness));
            self.raws.clear();
            narrow(&mut self.scratch, [a, b], &placed, reach, &mut self.raws);
            if self.raws.is_empty() {
                continue;
            }
            keep(&mut self.raws);
            // Frames of the bodies as the narrow phase sees them: the world's axes about side 0.
            let frames = [a, b].map(|p| Frame { r: k.r[p.body], p: k.p[p.body] - placed[0].p });
            out.extend(self.raws.iter().map(|raw| raw.fixed(pair, [a.body, b.body], &frames)));
        }
    }
}

fn split<A, B>((a, b): (A, B), (c, d): (A, B)) -> ([A; 2], [B; 2]) {
    ([a, c], [b, d])
}

/// Orders the points of a pair and makes their names unique; what is not a number goes.
fn keep(raws: &mut Vec<Raw>) {
    raws.retain(|raw| raw.gap.is_finite());
    raws.sort_unstable_by(|a, b| a.feature.cmp(&b.feature).then(a.gap.total_cmp(&b.gap)));
    for i in 1..raws.len() {
        if raws[i].feature <= raws[i - 1].feature {
            raws[i].feature = raws[i - 1].feature + 1;
        }
    }
}

/// The points of one pair, in the world's axes about the first part's origin.
fn narrow(s: &mut Scratch, parts: [&Part; 2], placed: &[Frame; 2], reach: f64, out: &mut Vec<Raw>) {
    let frames = placed.map(|f| Frame { r: f.r, p: f.p - placed[0].p });
    let flipped = match (&parts[0].shape, &parts[1].shape) {
        (_, Shape::HalfSpace | Shape::Surface(_)) => true,
        (Shape::Convex(a), Shape::Convex(b)) => rank(&a.kind) > rank(&b.kind),
        _ => false,
    };
    let (x, y) = if flipped { (1, 0) } else { (0, 1) };
    let size = sizes(parts);
    match (&parts[x].shape, &parts[y].shape) {
        (Shape::HalfSpace, Shape::Convex(solid)) => {
            let ground = Ground { point: frames[x].p, normal: frames[x].r.col2(), margin: parts[x].margin };
            on_ground(&ground, solid, &frames[y], (reach, size), out);
        }
        (Shape::Surface(surface), Shape::Convex(solid)) => {
            let (thickness, extent) = (parts[y].thickness, parts[y].extent);
            let (frame, place, margin) = (frames[x], frames[y], parts[x].margin);
            on_surface(s, &Query { surface, frame, margin, solid, place, extent, thickness }, (reach, size), out);
        }
        (Shape::Convex(a), Shape::Convex(b)) => solids(s, [(a, frames[x]), (b, frames[y])], (reach, size), out),
        _ => {}
    }
    if flipped {
        out.iter_mut().for_each(|raw| *raw = raw.swapped());
    }
}

/// Of the smaller part, m.
fn sizes(parts: [&Part; 2]) -> f64 {
    let size = |part: &Part| if matches!(part.shape, Shape::HalfSpace) { f64::INFINITY } else { part.radius };
    size(parts[0]).min(size(parts[1]))
}

/// What there is a closed form for comes first, a cuboid before all.
fn rank(kind: &Kind) -> u32 {
    match kind {
        Kind::Cuboid { .. } => 0,
        Kind::Point => 1,
        Kind::Segment { .. } => 2,
        _ => 0,
    }
}

fn solids(s: &mut Scratch, [(a, fa), (b, fb)]: [(&Solid, Frame); 2], limits: (f64, f64), out: &mut Vec<Raw>) {
    let rod = |solid: &Solid, frame: Frame| match solid.kind {
        Kind::Point => Some(Rod { frame, half: 0.0, radius: solid.round }),
        Kind::Segment { half } => Some(Rod { frame, half, radius: solid.round }),
        _ => None,
    };
    match (&a.kind, rod(a, fa), rod(b, fb)) {
        (_, Some(a), Some(b)) => rods(&a, &b, limits, out),
        (Kind::Cuboid { half }, _, Some(ball)) if ball.half == 0.0 => {
            cuboid_ball((&fa, *half, a.round), (fb.p, ball.radius), limits.0, out);
        }
        _ => {
            let first = Placed { solid: a, frame: fa };
            manifold(s, &first, &Placed { solid: b, frame: fb }, limits, out);
        }
    }
}
