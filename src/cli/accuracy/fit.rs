//! Order of convergence, and where a rung diverges.

use super::measure::Run;

/// An error is above the floor if it is so many times as large as what the reference itself errs by.
const ABOVE_REFERENCE: f64 = 10.0;
/// And if it is greater than this share of the size of the motion: below it, rounding counts.
const ROUNDING: f64 = 1e-12;
/// The greatest share of the size of the motion at which the error can be asymptotic.
const ASYMPTOTIC: f64 = 0.1;
/// By so much the orders of neighbouring pairs of points may differ where the error is taken to follow a power law.
const STEADY: f64 = 0.3;
/// An order below this is no convergence: first order is the least that a rule has.
const CONVERGES: f64 = 0.5;
/// Points of a fit at least.
const LEAST: usize = 3;

/// A power law through points of a ladder of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Error ∝ step^order.
    pub order: f64,
    /// Coarsest and finest step used, s.
    pub steps: [f64; 2],
    /// How many points.
    pub points: usize,
}

/// Least squares over the logarithms of RMS errors, `(step, error)` from coarse to fine.
///
/// Points can be used if their error is below a tenth of `size`, above rounding, and above ten times what the reference errs by (`own`). Of these the
/// longest stretch is taken in which the orders from point to point are steady and that of a convergence, of equal ones the finer. `None` if it has less than three points.
pub fn fit(points: &[(f64, f64)], size: f64, own: f64) -> Option<Fit> {
    let floor = (ABOVE_REFERENCE * own).max(ROUNDING * size);
    let usable = |p: &(f64, f64)| p.1 > floor && p.1 < ASYMPTOTIC * size;
    let mut best: &[(f64, f64)] = &[];
    for from in 0..points.len() {
        let mut parts = (from + LEAST..=points.len()).rev().map(|to| &points[from..to]);
        let longest = parts.find(|part| part.iter().all(usable) && is_steady(part));
        best = longest.filter(|part| part.len() >= best.len()).unwrap_or(best);
    }
    let (first, last) = (best.first()?, best.last()?);
    Some(Fit { order: slope(best), steps: [first.0, last.0], points: best.len() })
}

fn is_steady(part: &[(f64, f64)]) -> bool {
    let orders = part.windows(2).map(slope);
    let (low, high) = orders.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    low >= CONVERGES && high - low <= STEADY
}

/// Of the regression of ln error over ln step.
fn slope(part: &[(f64, f64)]) -> f64 {
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| part.iter().map(f).sum::<f64>() / part.len() as f64;
    let (x, y) = (mean(&|p| p.0.ln()), mean(&|p| p.1.ln()));
    mean(&|p| (p.0.ln() - x) * (p.1.ln() - y)) / mean(&|p| (p.0.ln() - x).powi(2))
}

/// The finest step that diverges, s, if one does.
pub fn diverges<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<f64> {
    runs.filter(|r| r.diverged).map(|r| r.point.step()).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: [f64; 6] = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25];

    #[test]
    fn the_order_is_that_of_the_points_between_chaos_and_rounding() {
        let of = |f: &dyn Fn(f64) -> f64, own| fit(&H.map(|h| (h, f(h))), 1.0, own);
        let f = of(&|h| 1e-5 * h.powi(4), 0.0).unwrap();
        assert!((f.order - 4.0).abs() < 1e-12 && f.points == 6);
        // Too coarse, then fourth order, then rounding.
        let f = of(&|h| if h > 3.0 { 0.7 } else { 1e-6 * h.powi(4) + 1e-9 / h }, 0.0).unwrap();
        assert!(f.steps == [2.0, 0.5] && (f.order - 4.0).abs() < 0.2, "{f:?}");
        // Nothing below ten times the error of the reference counts.
        let f = of(&|h| 1e-3 * h, 0.9e-4).unwrap();
        assert_eq!((f.steps, f.points), ([8.0, 1.0], 4), "{f:?}");
        assert_eq!(fit(&[(2.0, 1e-3), (1.0, 5e-4)], 1.0, 0.0), None);
        assert_eq!(of(&|_| f64::NAN, 0.0), None);
        assert_eq!(of(&|_| 0.0, 0.0), None);
    }
}
