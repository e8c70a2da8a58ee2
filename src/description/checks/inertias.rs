//! `<inertial>`: an inertia that is missing, or that no body can have.

use super::super::element::Element;
use super::super::finding::{Finding, Place};
use super::super::report::Report;
use super::super::{Description, Inertial};
use super::tree::Tree;
use super::{rigid, rigid::Rigid};
use crate::math::Mat3;

/// Relative: what rounding in a text may take from a principal moment or add to the greatest one.
const ROUNDING: f64 = 1e-3;
/// A principal moment below −this × the greatest one makes the tensor indefinite.
const INDEFINITE: f64 = 1e-6;
/// By what factor the greatest principal moment may exceed the sum of the other two before it is an error.
const TRIANGLE_FACTOR: f64 = 10.0;
/// Square of a radius of gyration, m², below which a body is a point (10 µm).
const POINT: f64 = 1e-10;

#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Sound,
    /// No real body has it, but it can be simulated.
    Odd,
    /// Nothing can be simulated with it.
    NoInertia,
}

/// All links with `<inertial>`.
pub(super) fn check(d: &Description, robot: &Element, tree: Option<&Tree>, report: &mut Report) {
    let bodies = tree.map(|tree| rigid::merge(d, tree)).unwrap_or_default();
    for (i, (link, element)) in d.links.iter().zip(robot.all("link")).enumerate() {
        if let Some(inertial) = &link.inertial {
            let tensor = element.all("inertial").flat_map(|e| e.all("inertia")).next();
            let place = tensor.unwrap_or(element).place(report);
            check_inertial(inertial, bodies.get(i).copied().flatten(), place, report);
        }
    }
}

fn check_inertial(inertial: &Inertial, body: Option<Rigid>, place: Place, report: &mut Report) {
    let greatest = inertial.inertia.iter().fold(0.0_f64, |max, i| max.max(i.abs()));
    if inertial.mass > 0.0 && greatest <= POINT * inertial.mass {
        let message = match greatest {
            0.0 => format!("{} kg with no inertia: simulated as a point mass", inertial.mass),
            _ => format!(
                "{:e} kg with next to no inertia ({greatest:e} kg·m² at most): simulated as written",
                inertial.mass
            ),
        };
        let mend = "give the inertia about the centre of mass";
        report.add_once("", Finding::warning("zero-inertia", place, message, mend));
    } else if inertial.mass == 0.0 && greatest > 0.0 {
        let message = "an inertia without a mass".to_string();
        report.add_once("", Finding::warning("inertia-without-mass", place, message, "give the mass, or make both 0"));
    } else if greatest > 0.0 {
        report_impossible(inertial, body, place, report);
    }
}

/// What counts is the rigid body that the link is part of: an odd sensor fixed to a sound trunk does no harm.
fn report_impossible(inertial: &Inertial, body: Option<Rigid>, place: Place, report: &mut Report) {
    let moments = principal_moments(tensor(inertial.inertia));
    let own = verdict(moments);
    if own == Verdict::Sound {
        return;
    }
    let [a, b, c] = moments.map(|x| if x.abs() < INDEFINITE * moments[2].abs() { 0.0 } else { x });
    let rule = if a < 0.0 { "none may be negative" } else { "none may exceed the sum of the other two" };
    let shown = format!("the principal moments are {a:.3e}, {b:.3e}, {c:.3e} kg·m², {rule}");
    let mend = "compute it anew about the centre of mass; check the signs of ixy, ixz, iyz, and the unit (kg·m²)";
    let whole = body.map_or(own, |body| verdict(principal_moments(body.inertia)));
    if own == Verdict::NoInertia && whole == Verdict::NoInertia {
        let message = format!("this is no inertia: {shown}");
        report.add(Finding::error("no-inertia", place, message, mend));
    } else {
        let message = format!("no real body has this inertia: {shown}");
        report.add_once("", Finding::warning("odd-inertia", place, message, mend));
    }
}

fn verdict([a, b, c]: [f64; 3]) -> Verdict {
    if a < -INDEFINITE * c.abs() || c > TRIANGLE_FACTOR * (a + b) {
        Verdict::NoInertia
    } else if c > (a + b) * (1.0 + ROUNDING) {
        Verdict::Odd
    } else {
        Verdict::Sound
    }
}

/// Symmetric tensor of ixx, ixy, ixz, iyy, iyz, izz.
pub(super) fn tensor([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Mat3 {
    Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Ascending.
fn principal_moments(tensor: Mat3) -> [f64; 3] {
    // Scaled, so that neither squares nor their sums overflow.
    let scale = tensor.amax().max(f64::MIN_POSITIVE);
    let moments = (tensor / scale).symmetric_eigenvalues() * scale;
    let mut sorted = [moments.x, moments.y, moments.z];
    sorted.sort_by(f64::total_cmp);
    sorted
}
