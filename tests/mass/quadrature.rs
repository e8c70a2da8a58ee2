//! Mass properties by numerical integration, from the definition of the shapes and nothing else.

use realnoid::description::{Dimension, Geometry};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Weighted points: the integral of f is Σ w·f(point).
pub type Cloud = Vec<(f64, Vec3)>;

/// Mass properties at unit density (solid) or unit thickness × density (hollow), by quadrature.
pub fn reference(geometry: &Geometry, dimension: Dimension) -> MassProperties {
    match dimension {
        Dimension::Solid => properties(&solid(geometry)),
        Dimension::Hollow { thickness } => {
            let mut p = properties(&surface(geometry));
            p.mass *= thickness;
            p.inertia *= thickness;
            p
        }
    }
}

fn properties(cloud: &Cloud) -> MassProperties {
    let mass: f64 = cloud.iter().map(|(w, _)| w).sum();
    let center = cloud.iter().map(|(w, p)| p * *w).sum::<Vec3>() / mass;
    let inertia = cloud.iter().fold(Mat3::zeros(), |i, (w, p)| {
        let d = p - center;
        i + (Mat3::from_diagonal_element(d.norm_squared()) - d * d.transpose()) * *w
    });
    MassProperties { mass, center, inertia }
}

/// Semi-axes of the section at a height.
type Section = Box<dyn Fn(f64) -> (f64, f64)>;

/// Gauss–Legendre points of order 8 on `panels` equal parts of [from, to].
fn gauss(from: f64, to: f64, panels: usize) -> Vec<(f64, f64)> {
    // Roots of P₈ by Newton's method from the usual cosine guess.
    let rule = (0..8).map(|k| {
        let mut x = (PI * (f64::from(k) + 0.75) / 8.5).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut p0, mut p1) = (1.0, x);
            for n in 2..=8 {
                let n = f64::from(n);
                (p0, p1) = (p1, ((2.0 * n - 1.0) * x * p1 - (n - 1.0) * p0) / n);
            }
            slope = 8.0 * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    });
    let rule: Vec<_> = rule.collect();
    let half = (to - from) / panels as f64 / 2.0;
    (0..panels)
        .flat_map(|i| {
            let middle = from + half * (2 * i + 1) as f64;
            rule.iter().map(move |(x, w)| (w * half, middle + half * x)).collect::<Vec<_>>()
        })
        .collect()
}

/// A body of elliptic sections: semi-axes as a function of the height, between break points.
fn stacked(breaks: &[f64], sign: f64, section: impl Fn(f64) -> (f64, f64)) -> Cloud {
    let mut cloud = Vec::new();
    for pair in breaks.windows(2) {
        for (wz, z) in gauss(pair[0], pair[1], 4) {
            let (a, b) = section(z);
            for (wt, t) in gauss(-FRAC_PI_2, FRAC_PI_2, 3) {
                for (wy, y) in gauss(-b * t.cos(), b * t.cos(), 1) {
                    cloud.push((sign * wz * wt * a * t.cos() * wy, Vec3::new(a * t.sin(), y, z)));
                }
            }
        }
    }
    cloud
}

fn solid(geometry: &Geometry) -> Cloud {
    match *geometry {
        Geometry::Box { size: [x, y, z] } => {
            let mut cloud = Vec::new();
            for (wx, px) in gauss(-x / 2.0, x / 2.0, 1) {
                for (wy, py) in gauss(-y / 2.0, y / 2.0, 1) {
                    cloud.extend(
                        gauss(-z / 2.0, z / 2.0, 1).iter().map(|(wz, pz)| (wx * wy * wz, Vec3::new(px, py, *pz))),
                    );
                }
            }
            cloud
        }
        Geometry::Tube { outer_radius: o, inner_radius: i, length } => {
            let ends = [-length / 2.0, length / 2.0];
            let mut cloud = stacked(&ends, 1.0, |_| (o, o));
            cloud.extend(stacked(&ends, -1.0, |_| (i, i)));
            cloud
        }
        _ => {
            let (breaks, section) = profile(geometry);
            stacked(&breaks, 1.0, section)
        }
    }
}

/// Break points in height and the semi-axes of the section at a height.
fn profile(geometry: &Geometry) -> (Vec<f64>, Section) {
    let prism = |a: f64, b: f64, top: f64, length: f64| -> (Vec<f64>, Section) {
        let scale = move |z: f64| 1.0 + (top - 1.0) * (z / length + 0.5);
        (vec![-length / 2.0, length / 2.0], Box::new(move |z| (a * scale(z), b * scale(z))))
    };
    match *geometry {
        Geometry::Sphere { radius: r } => {
            (vec![-r, r], Box::new(move |z| ((r * r - z * z).sqrt(), (r * r - z * z).sqrt())))
        }
        Geometry::Ellipsoid { radii: [a, b, c] } => {
            let s = move |z: f64| (1.0 - (z / c).powi(2)).sqrt();
            (vec![-c, c], Box::new(move |z| (a * s(z), b * s(z))))
        }
        Geometry::Cylinder { radius, length } => prism(radius, radius, 1.0, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => prism(radius_x, radius_y, 1.0, length),
        Geometry::Cone { radius_x, radius_y, length } => prism(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => prism(radius_x, radius_y, top_scale, length),
        Geometry::Capsule { radius_top: t, radius_bottom: b, length } => {
            let h = length / 2.0;
            let radius = move |z: f64| {
                if z > h {
                    (t * t - (z - h).powi(2)).max(0.0).sqrt()
                } else if z < -h {
                    (b * b - (z + h).powi(2)).max(0.0).sqrt()
                } else {
                    b + (t - b) * (z / length + 0.5)
                }
            };
            (vec![-h - b, -h, h, h + t], Box::new(move |z| (radius(z), radius(z))))
        }
        ref other => panic!("no profile for {other:?}"),
    }
}

/// A patch of surface r(u, v), with the surface element from central differences.
fn patch(u: [f64; 2], v: [f64; 2], at: impl Fn(f64, f64) -> Vec3) -> Cloud {
    const D: f64 = 1e-5;
    let mut cloud = Vec::new();
    for (wu, u) in gauss(u[0], u[1], 24) {
        for (wv, v) in gauss(v[0], v[1], 24) {
            let along_u = (at(u + D, v) - at(u - D, v)) / (2.0 * D);
            let along_v = (at(u, v + D) - at(u, v - D)) / (2.0 * D);
            cloud.push((wu * wv * along_u.cross(&along_v).norm(), at(u, v)));
        }
    }
    cloud
}

fn mantle(a: f64, b: f64, top: f64, length: f64) -> Cloud {
    patch([0.0, 1.0], [0.0, TAU], move |u, v| {
        let s = 1.0 + (top - 1.0) * u;
        Vec3::new(a * s * v.cos(), b * s * v.sin(), (u - 0.5) * length)
    })
}

fn ring(outer: (f64, f64), inner: f64, z: f64) -> Cloud {
    patch([inner, 1.0], [0.0, TAU], move |u, v| Vec3::new(outer.0 * u * v.cos(), outer.1 * u * v.sin(), z))
}

fn cap(r: f64, from: f64, to: f64, z: f64) -> Cloud {
    patch([from, to], [0.0, TAU], move |u, v| Vec3::new(r * u.sin() * v.cos(), r * u.sin() * v.sin(), z + r * u.cos()))
}

fn faces([x, y, z]: [f64; 3]) -> Cloud {
    let half = Vec3::new(x, y, z) / 2.0;
    let face = |axis: usize, side: f64| {
        patch([-1.0, 1.0], [-1.0, 1.0], move |u, v| {
            let mut p = Vec3::zeros();
            p[axis] = side * half[axis];
            p[(axis + 1) % 3] = u * half[(axis + 1) % 3];
            p[(axis + 2) % 3] = v * half[(axis + 2) % 3];
            p
        })
    };
    (0..3).flat_map(|axis| [face(axis, -1.0), face(axis, 1.0)].concat()).collect()
}

/// Points on the surface.
pub fn surface(geometry: &Geometry) -> Cloud {
    let frustum = |a: f64, b: f64, top: f64, length: f64| {
        let low = ring((a, b), 0.0, -length / 2.0);
        let high = if top > 0.0 { ring((a * top, b * top), 0.0, length / 2.0) } else { Vec::new() };
        [mantle(a, b, top, length), low, high].concat()
    };
    match *geometry {
        Geometry::Box { size } => faces(size),
        Geometry::Sphere { radius } => cap(radius, 0.0, PI, 0.0),
        Geometry::Ellipsoid { radii: [a, b, c] } => patch([0.0, PI], [0.0, TAU], move |u, v| {
            Vec3::new(a * u.sin() * v.cos(), b * u.sin() * v.sin(), c * u.cos())
        }),
        Geometry::Cylinder { radius, length } => frustum(radius, radius, 1.0, length),
        Geometry::EllipticCylinder { radius_x, radius_y, length } => frustum(radius_x, radius_y, 1.0, length),
        Geometry::Cone { radius_x, radius_y, length } => frustum(radius_x, radius_y, 0.0, length),
        Geometry::Frustum { radius_x, radius_y, top_scale, length } => frustum(radius_x, radius_y, top_scale, length),
        Geometry::Tube { outer_radius: o, inner_radius: i, length } => {
            let ends = [ring((o, o), i / o, -length / 2.0), ring((o, o), i / o, length / 2.0)].concat();
            [mantle(o, o, 1.0, length), mantle(i, i, 1.0, length), ends].concat()
        }
        Geometry::Capsule { radius_top: t, radius_bottom: b, length } => {
            [cap(t, 0.0, FRAC_PI_2, length / 2.0), mantle(b, b, t / b, length), cap(b, FRAC_PI_2, PI, -length / 2.0)]
                .concat()
        }
        ref other => panic!("no surface for {other:?}"),
    }
}
