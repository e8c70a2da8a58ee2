//! One contact by itself: the exact solution of Coulomb's law for a 3×3 block, and of a bounded disc.
//!
//! With H the (regularised) block of `Y Yᵀ` and r the velocity that the contact would have without its own impulse:
//! find x with `u = H x + r`, `u_n ≥ 0`, `x_n ≥ 0`, `u_n x_n = 0`, `|x_t| ≤ μ x_n`, and u_t against x_t where that bound is
//! reached. Derived in `docs/decisions/0014-rows-in-factor-space.md`.

/// Steps of the safeguarded Newton iteration: bisection alone would need about 100 from the widest bracket.
const STEPS: u32 = 100;
/// Where the ratio of length and radius is this near to 1, one more step of Newton's (which squares that) is exact.
const NEAR: f64 = 1e-8;

/// A symmetric 2×2 matrix, diagonalised: eigenvalues, and the angle of their axes as cosine and sine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plane {
    values: [f64; 2],
    turn: (f64, f64),
}

impl Plane {
    /// Of `[a b; b d]` (one Jacobi rotation).
    pub fn new(a: f64, b: f64, d: f64) -> Self {
        if b == 0.0 {
            return Self { values: [a, d], turn: (1.0, 0.0) };
        }
        let half = (d - a) / (2.0 * b);
        let t = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
        let c = 1.0 / (t * t + 1.0).sqrt();
        Self { values: [a - t * b, d + t * b], turn: (c, t * c) }
    }

    /// The matrix times a vector.
    pub fn times(self, v: [f64; 2]) -> [f64; 2] {
        let v = self.turned(v);
        self.back([self.values[0] * v[0], self.values[1] * v[1]])
    }

    /// Elements 11, 12, 22 of the inverse.
    fn inverse(self) -> [f64; 3] {
        let ((c, s), [a, b]) = (self.turn, self.values.map(|v| 1.0 / v));
        [c * c * a + s * s * b, c * s * (b - a), s * s * a + c * c * b]
    }

    fn turned(self, v: [f64; 2]) -> [f64; 2] {
        let (c, s) = self.turn;
        [c * v[0] - s * v[1], s * v[0] + c * v[1]]
    }

    fn back(self, v: [f64; 2]) -> [f64; 2] {
        let (c, s) = self.turn;
        [c * v[0] + s * v[1], c * v[1] - s * v[0]]
    }
}

/// Blocks of a contact that stay the same while it is solved again and again.
#[derive(Clone, Copy, Debug, Default)]
pub struct ConeBlock {
    /// H: nn, n1, n2, 11, 12, 22.
    h: [f64; 6],
    /// `1 / H_nn`, `h / H_nn`.
    normal: [f64; 3],
    /// `H_tt − h hᵀ / H_nn`, the normal taken out.
    slide: Plane,
    /// Its inverse: 11, 12, 22.
    stick: [f64; 3],
}

impl ConeBlock {
    /// Of the symmetric positive definite H, packed as nn, n1, n2, 11, 12, 22.
    pub fn new(h: [f64; 6]) -> Self {
        let (a, b) = (h[1] / h[0], h[2] / h[0]);
        let slide = Plane::new(h[3] - a * h[1], h[4] - a * h[2], h[5] - b * h[2]);
        Self { h, normal: [1.0 / h[0], a, b], slide, stick: slide.inverse() }
    }

    /// Trace of H.
    pub fn trace(&self) -> f64 {
        self.h[0] + self.h[3] + self.h[5]
    }

    /// The normal's own mobility, and the sum of those of the tangents.
    pub fn diagonal(&self) -> [f64; 2] {
        [self.h[0], self.h[3] + self.h[5]]
    }

    /// H x.
    pub fn times(&self, x: [f64; 3]) -> [f64; 3] {
        let h = &self.h;
        [
            h[0] * x[0] + h[1] * x[1] + h[2] * x[2],
            h[1] * x[0] + h[3] * x[1] + h[4] * x[2],
            h[2] * x[0] + h[4] * x[1] + h[5] * x[2],
        ]
    }

    /// The impulse (n, t1, t2) for the velocity `r` without it, under the friction coefficient `mu` ≥ 0.
    pub fn solve(&self, r: [f64; 3], mu: f64) -> [f64; 3] {
        self.solve_from(r, mu, &mut 0.0)
    }

    /// The same; `guess` is the slip of the last time (velocity against impulse, `|u_t| / |x_t|`), and becomes that of this.
    #[inline(always)]
    pub(super) fn solve_from(&self, r: [f64; 3], mu: f64, guess: &mut f64) -> [f64; 3] {
        if r[0] >= 0.0 {
            return [0.0; 3];
        }
        let ([inverse, a, b], [p, q, t], h) = (self.normal, self.stick, &self.h);
        let rest = [r[1] - a * r[0], r[2] - b * r[0]];
        let pressing = |x: [f64; 2]| -(r[0] + h[1] * x[0] + h[2] * x[1]) * inverse;
        let stick = [-(p * rest[0] + q * rest[1]), -(q * rest[0] + t * rest[1])];
        let allowed = mu * pressing(stick);
        let x = if allowed >= 0.0 && stick[0] * stick[0] + stick[1] * stick[1] <= allowed * allowed {
            stick
        } else {
            // x_n = base − lever·x_t keeps u_n = 0.
            let radius = Radius { base: -mu * r[0] * inverse, lever: [-mu * a, -mu * b] };
            slide(&self.slide, rest, &radius, guess)
        };
        [pressing(x), x[0], x[1]]
    }
}

/// The impulse of a plane block within a disc of this radius.
pub fn disc(h: &Plane, r: [f64; 2], radius: f64) -> [f64; 2] {
    if radius <= 0.0 {
        return [0.0; 2];
    }
    bounded(h, r, &Radius { base: radius, lever: [0.0; 2] })
}

/// Largest |x_t| allowed, as a function of x_t.
struct Radius {
    base: f64,
    lever: [f64; 2],
}

impl Radius {
    #[inline(always)]
    fn at(&self, x: [f64; 2]) -> f64 {
        self.base + self.lever[0] * x[0] + self.lever[1] * x[1]
    }
}

/// `−H⁻¹ r` if its length is within the radius, else that of [`slide`].
fn bounded(h: &Plane, r: [f64; 2], radius: &Radius) -> [f64; 2] {
    let [p, q, t] = h.inverse();
    let stick = [-(p * r[0] + q * r[1]), -(q * r[0] + t * r[1])];
    let allowed = radius.at(stick);
    let inside = allowed >= 0.0 && stick[0] * stick[0] + stick[1] * stick[1] <= allowed * allowed;
    if inside { stick } else { slide(h, r, radius, &mut 0.0) }
}

/// Where `−H⁻¹ r` is longer than the radius: `x(s) = −(H + s)⁻¹ r` with s > 0 such that its length is the radius: then
/// `u = H x + r = −s x` is against x. The length minus the radius is positive at s = 0 and negative at ∞.
#[inline(always)]
fn slide(h: &Plane, r: [f64; 2], radius: &Radius, guess: &mut f64) -> [f64; 2] {
    if radius.base <= 0.0 {
        return [0.0; 2];
    }
    let turned = Radius { base: radius.base, lever: h.turned(radius.lever) };
    let r = h.turned(r);
    let s = root(h, r, &turned, *guess);
    *guess = s;
    let x = [-r[0] / (h.values[0] + s), -r[1] / (h.values[1] + s)];
    let (have, want) = (length(x), turned.at(x));
    let scale = if have > 0.0 && want >= 0.0 { want / have } else { 1.0 };
    h.back(x.map(|x| x * scale))
}

/// Where the length is the radius: the zero of radius over length minus 1, which is nearly a straight line in s, by
/// Newton's iteration between a lower and an upper bound that close in, from a guess ≥ 0.
fn root(h: &Plane, r: [f64; 2], radius: &Radius, guess: f64) -> f64 {
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut s = guess;
    for _ in 0..STEPS {
        let inverse = [1.0 / (h.values[0] + s), 1.0 / (h.values[1] + s)];
        let x = [-r[0] * inverse[0], -r[1] * inverse[1]];
        let shorter = 1.0 / length(x);
        let ratio = radius.at(x) * shorter;
        if ratio < 1.0 {
            low = s
        } else {
            high = s
        }
        // dx/ds = −x / (h + s)
        let turn = [x[0] * inverse[0], x[1] * inverse[1]];
        let along = (x[0] * turn[0] + x[1] * turn[1]) * (shorter * shorter);
        let slope = ratio * along - (radius.lever[0] * turn[0] + radius.lever[1] * turn[1]) * shorter;
        let newton = s + (1.0 - ratio) / slope;
        let inside = newton > low && newton < high;
        if (ratio - 1.0).abs() <= NEAR {
            return if inside { newton } else { s };
        }
        let next = if inside {
            newton
        } else if high.is_finite() {
            0.5 * (low + high)
        } else {
            2.0 * s + h.values[0] + h.values[1]
        };
        if (next - s).abs() <= f64::EPSILON * s {
            return s;
        }
        s = next;
    }
    s
}

fn length(x: [f64; 2]) -> f64 {
    (x[0] * x[0] + x[1] * x[1]).sqrt()
}
