//! Round shapes from their definition: section radii over the height for the inside, curves for the surface.

use super::points::{Cloud, gauss, graded, rooted};
use realnoid::description::{Finish, Geometry};
use realnoid::math::Vec3;
use std::f64::consts::{FRAC_PI_2, TAU};

type Radius = Box<dyn Fn(f64) -> f64>;
type Curve = Box<dyn Fn(f64) -> [f64; 2]>;

pub struct Round {
    /// Heights between which the radii are smooth.
    breaks: Vec<f64>,
    outer: Radius,
    inner: Radius,
    /// (ρ, z) over 0 … 1, each smooth, at most a quarter of a circle.
    curves: Vec<Curve>,
    turn: [f64; 2],
    cut: bool,
    /// Factors along the axes.
    stretch: [f64; 3],
}

fn arc([rho, z]: [f64; 2], radius: f64, from: f64, to: f64) -> Curve {
    Box::new(move |t| {
        let angle = from + (to - from) * t;
        [rho + radius * angle.cos(), z + radius * angle.sin()]
    })
}

fn line(from: [f64; 2], to: [f64; 2]) -> Curve {
    Box::new(move |t| [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t])
}

fn root(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

impl Round {
    /// The shape under further factors.
    pub fn of(geometry: &Geometry, finish: &Finish, stretch: [f64; 3]) -> Option<Self> {
        let mut round = match *geometry {
            Geometry::Sphere { radius } => capsule(radius, radius, 0.0),
            Geometry::Ellipsoid { radii } => Self { stretch: radii, ..capsule(1.0, 1.0, 0.0) },
            Geometry::Hemisphere { radius } => bowl(radius),
            Geometry::Capsule { radius_top, radius_bottom, length } => capsule(radius_top, radius_bottom, length / 2.0),
            Geometry::Cylinder { radius, length } => frustum([radius, radius], length / 2.0, finish),
            Geometry::EllipticCylinder { radius_x, radius_y, length } => {
                elliptic(radius_y / radius_x, frustum([radius_x, radius_x], length / 2.0, finish))
            }
            Geometry::Cone { radius_x, radius_y, length } => {
                elliptic(radius_y / radius_x, frustum([radius_x, 0.0], length / 2.0, finish))
            }
            Geometry::Frustum { radius_x, radius_y, top_scale, length } => {
                elliptic(radius_y / radius_x, frustum([radius_x, radius_x * top_scale], length / 2.0, finish))
            }
            Geometry::Tube { outer_radius, inner_radius, length } => {
                tube(outer_radius, inner_radius, length / 2.0, finish.fillet)
            }
            Geometry::Torus { ring_radius, pipe_radius } => torus(ring_radius, pipe_radius),
            Geometry::OilTank { radius, length, cap_height } => oil_tank(radius, length / 2.0, cap_height),
            Geometry::Disc { outer_radius, inner_radius } => {
                Self { curves: vec![line([inner_radius, 0.0], [outer_radius, 0.0])], ..bowl(1.0) }
            }
            _ => return None,
        };
        (0..3).for_each(|i| round.stretch[i] *= stretch[i]);
        round.turn = finish.slice.unwrap_or([0.0, TAU]);
        round.cut = finish.slice.is_some() && round.breaks.len() > 1 && !finish.open;
        Some(round)
    }

    fn new(breaks: Vec<f64>, outer: Radius, inner: Radius, curves: Vec<Curve>) -> Self {
        Self { breaks, outer, inner, curves, turn: [0.0; 2], cut: false, stretch: [1.0; 3] }
    }

    /// The inside, by sections.
    pub fn solid(&self) -> Cloud {
        let grows = self.stretch.iter().product::<f64>().abs();
        let mut cloud = Vec::new();
        for (w, [rho, z]) in self.section() {
            for range in self.quarters() {
                for (wp, phi) in gauss(range[0], range[1]) {
                    cloud.push((w * wp * rho * grows, self.place([rho, z], phi)));
                }
            }
        }
        cloud
    }

    /// Points (ρ, z) of the half section.
    fn section(&self) -> Vec<(f64, [f64; 2])> {
        let mut points = Vec::new();
        for pair in self.breaks.windows(2).filter(|p| p[0] < p[1]) {
            for (wz, z) in rooted(pair[0], pair[1]) {
                points.extend(gauss((self.inner)(z), (self.outer)(z)).into_iter().map(|(w, rho)| (w * wz, [rho, z])));
            }
        }
        points
    }

    /// The surface, its element from differences of the position.
    pub fn surface(&self) -> Cloud {
        let mut cloud = Vec::new();
        for curve in &self.curves {
            for range in self.quarters() {
                self.patch(curve, range, &mut cloud);
            }
        }
        if self.cut {
            for phi in self.turn {
                // The face is a linear image of the half section.
                let (out, up) = (self.place([1.0, 0.0], phi), self.place([0.0, 1.0], phi));
                let grows = out.cross(&up).norm();
                cloud.extend(self.section().into_iter().map(|(w, at)| (w * grows, self.place(at, phi))));
            }
        }
        cloud
    }

    fn patch(&self, curve: &Curve, range: [f64; 2], cloud: &mut Cloud) {
        const D: f64 = 2e-4;
        // Fourth order, at unit scale before the stretch.
        let slope = |at: &dyn Fn(f64) -> [f64; 2], t: f64| {
            [0, 1]
                .map(|i| (8.0 * (at(t + D)[i] - at(t - D)[i]) - (at(t + 2.0 * D)[i] - at(t - 2.0 * D)[i])) / (12.0 * D))
        };
        let around = |phi: f64| [phi.cos(), phi.sin()];
        let turns: Vec<_> =
            graded(range[0], range[1]).into_iter().map(|(w, phi)| (w, around(phi), slope(&around, phi))).collect();
        let stretch = Vec3::from(self.stretch);
        for (wt, t) in graded(0.0, 1.0) {
            let ([rho, z], [rho_slope, z_slope]) = (curve(t), slope(curve, t));
            for &(wp, [cos, sin], [dcos, dsin]) in &turns {
                let along = Vec3::new(rho_slope * cos, rho_slope * sin, z_slope).component_mul(&stretch);
                let across = Vec3::new(rho * dcos, rho * dsin, 0.0).component_mul(&stretch);
                let at = Vec3::new(rho * cos, rho * sin, z).component_mul(&stretch);
                cloud.push((wt * wp * along.cross(&across).norm(), at));
            }
        }
    }

    fn place(&self, [rho, z]: [f64; 2], phi: f64) -> Vec3 {
        Vec3::new(rho * phi.cos(), rho * phi.sin(), z).component_mul(&Vec3::from(self.stretch))
    }

    /// A box around the whole turn.
    pub fn box_around(&self) -> (Vec3, Vec3) {
        let (Some(low), Some(high)) = (self.breaks.first(), self.breaks.last()) else { return Default::default() };
        let widest = self.curves.iter().map(|c| c(0.0)[0].max(c(1.0)[0])).fold(0.0, f64::max);
        let corners = [Vec3::new(-widest, -widest, *low), Vec3::new(widest, widest, *high)];
        let [a, b] = corners.map(|c| c.component_mul(&Vec3::from(self.stretch)));
        (a.inf(&b), a.sup(&b))
    }

    /// Is a point inside?
    pub fn contains(&self, p: Vec3) -> bool {
        let q = p.component_div(&Vec3::from(self.stretch));
        let rho = q.x.hypot(q.y);
        let [from, to] = self.turn;
        let past = (q.y.atan2(q.x) - from).rem_euclid(TAU);
        let within = self.breaks.first().is_some_and(|z| *z < q.z) && self.breaks.last().is_some_and(|z| q.z < *z);
        within && past <= to - from && (self.inner)(q.z) < rho && rho < (self.outer)(q.z)
    }

    /// The turn in parts within quarters.
    fn quarters(&self) -> Vec<[f64; 2]> {
        let [from, to] = self.turn;
        let mut cuts = vec![from];
        cuts.extend((-16..=16).map(|k| f64::from(k) * FRAC_PI_2).filter(|c| from < *c && *c < to));
        cuts.push(to);
        cuts.windows(2).map(|w| [w[0], w[1]]).collect()
    }
}

fn elliptic(ratio: f64, round: Round) -> Round {
    Round { stretch: [1.0, ratio, 1.0], ..round }
}

fn bowl(r: f64) -> Round {
    Round::new(vec![], Box::new(|_| 0.0), Box::new(|_| 0.0), vec![arc([0.0, 0.0], r, 0.0, FRAC_PI_2)])
}

fn capsule(top: f64, bottom: f64, h: f64) -> Round {
    let outer = move |z: f64| {
        if z > h {
            root((top - (z - h)) * (top + (z - h)))
        } else if z < -h {
            root((bottom + (z + h)) * (bottom - (z + h)))
        } else {
            bottom + (top - bottom) * (z + h) / (2.0 * h)
        }
    };
    let mut curves = vec![arc([0.0, h], top, 0.0, FRAC_PI_2), arc([0.0, -h], bottom, -FRAC_PI_2, 0.0)];
    if h > 0.0 {
        curves.push(line([bottom, -h], [top, h]));
    }
    Round::new(vec![-h - bottom, -h, h, h + top], Box::new(outer), Box::new(|_| 0.0), curves)
}

/// A ball of the fillet's radius f touches the end (at distance f) and the mantle (at distance f along its normal).
fn frustum([a, t]: [f64; 2], h: f64, finish: &Finish) -> Round {
    let slant = (2.0 * h).hypot(a - t);
    let (normal_rho, normal_z) = (2.0 * h / slant, (a - t) / slant);
    let mantle = move |z: f64| a + (t - a) * (z + h) / (2.0 * h);
    let low = finish.fillet;
    let high = if t > 0.0 { finish.top_fillet.unwrap_or(low) } else { 0.0 };
    let ball = move |z: f64, f: f64| (mantle(z) - f / normal_rho, z);
    let ((low_rho, low_z), (high_rho, high_z)) = (ball(-h + low, low), ball(h - high, high));
    let (low_touch, high_touch) = (low_z + low * normal_z, high_z + high * normal_z);
    let outer = move |z: f64| {
        if z < low_touch {
            low_rho + root((low - (z - low_z)) * (low + (z - low_z)))
        } else if z > high_touch {
            high_rho + root((high - (z - high_z)) * (high + (z - high_z)))
        } else {
            mantle(z)
        }
    };
    let tilt = normal_z.atan2(normal_rho);
    let touching = |rho: f64, z: f64, f: f64| [rho + f * normal_rho, z + f * normal_z];
    let mut curves = vec![line(touching(low_rho, low_z, low), touching(high_rho, high_z, high))];
    if low > 0.0 {
        curves.push(arc([low_rho, low_z], low, -FRAC_PI_2, 0.0f64.min(tilt)));
        curves.push(arc([low_rho, low_z], low, 0.0f64.min(tilt), tilt));
    }
    if high > 0.0 {
        curves.push(arc([high_rho, high_z], high, tilt, 0.0f64.max(tilt)));
        curves.push(arc([high_rho, high_z], high, 0.0f64.max(tilt), FRAC_PI_2));
    }
    if !finish.open {
        curves.push(line([0.0, -h], [low_rho, -h]));
        curves.push(line([0.0, h], [high_rho, h]));
    }
    Round::new(vec![-h, low_touch, high_touch, h], Box::new(outer), Box::new(|_| 0.0), curves)
}

fn tube(o: f64, i: f64, h: f64, f: f64) -> Round {
    let recess = move |z: f64| {
        let over = z.abs() - (h - f);
        if over > 0.0 { f - root((f - over) * (f + over)) } else { 0.0 }
    };
    let mut curves = vec![line([o, f - h], [o, h - f]), line([i, f - h], [i, h - f])];
    for sign in [-1.0, 1.0] {
        curves.push(line([i + f, sign * h], [o - f, sign * h]));
        if f > 0.0 {
            curves.push(arc([o - f, sign * (h - f)], f, 0.0, sign * FRAC_PI_2));
            curves.push(arc([i + f, sign * (h - f)], f, 2.0 * FRAC_PI_2, 2.0 * FRAC_PI_2 - sign * FRAC_PI_2));
        }
    }
    Round::new(vec![-h, f - h, h - f, h], Box::new(move |z| o - recess(z)), Box::new(move |z| i + recess(z)), curves)
}

fn torus(ring: f64, pipe: f64) -> Round {
    let half = move |z: f64| root((pipe - z) * (pipe + z));
    let quarter = |k: i32| arc([ring, 0.0], pipe, f64::from(k) * FRAC_PI_2, f64::from(k + 1) * FRAC_PI_2);
    let curves = (0..4).map(quarter).collect();
    Round::new(vec![-pipe, pipe], Box::new(move |z| ring + half(z)), Box::new(move |z| ring - half(z)), curves)
}

fn oil_tank(r: f64, h: f64, c: f64) -> Round {
    let ball = (r * r + c * c) / (2.0 * c);
    let outer = move |z: f64| {
        let over = z.abs() - h;
        if over > 0.0 { root((c - over) * (2.0 * ball - c + over)) } else { r }
    };
    let rim = (ball - c).atan2(r);
    let curves = vec![
        line([r, -h], [r, h]),
        arc([0.0, h + c - ball], ball, rim, FRAC_PI_2),
        arc([0.0, ball - c - h], ball, -rim, -FRAC_PI_2),
    ];
    Round::new(vec![-h - c, -h, h, h + c], Box::new(outer), Box::new(|_| 0.0), curves)
}
