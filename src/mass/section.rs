//! Moments of the region that a closed outline encloses in the half plane (ρ, z).
//!
//! By Green's theorem ∬ uᵃ wᵇ du dw = ∮ uᵃ⁺¹/(a + 1) wᵇ dw, with u and w measured from a point inside, so that a thin
//! wall far from the axis keeps its digits.

use super::moments::Sum;
use super::rules::{gauss, quarters};
use crate::shape::{Lathe, Piece};

/// Points on the outline with the weight of dz: Σ f(ρ, z)·dz is the integral along it.
struct Step {
    rho: f64,
    z: f64,
    dz: f64,
}

/// The outline of a solid that a lathe makes.
pub(super) struct Section {
    steps: Vec<Step>,
    /// Area, m².
    pub area: f64,
    /// Centre of the area (ρ, z), m.
    pub center: [f64; 2],
    /// Mean squares of ρ and z about the centre, and their mean product: ρρ, ρz, zz, m².
    pub spread: [f64; 3],
}

/// The region weighted with ρ, as its turning weighs it.
pub(super) struct Turned {
    /// ∬ρ dρ dz, m³: the volume per radian.
    pub volume: f64,
    /// Weighted centre (ρ, z), m.
    pub center: [f64; 2],
    /// Weighted means about it: ρρ, ρz, zz, m².
    pub spread: [f64; 3],
}

impl Section {
    /// The region that the outline encloses, alone or with the axis.
    pub fn of(lathe: &Lathe) -> Self {
        let steps = steps(&lathe.pieces);
        let mut section = Self { steps, area: 0.0, center: [0.0; 2], spread: [0.0; 3] };
        let rough = section.rough_center();
        section.area = section.moment(rough, 0, 0);
        let (rho, z) = (section.moment(rough, 1, 0) / section.area, section.moment(rough, 0, 1) / section.area);
        section.center = [rough[0] + rho, rough[1] + z];
        let powers = [(2, 0), (1, 1), (0, 2)];
        section.spread = powers.map(|(a, b)| section.moment(section.center, a, b) / section.area);
        section
    }

    /// The same region as its turning about Z weighs it.
    pub fn turned(&self) -> Turned {
        let [rho, z] = self.center;
        // Pappus; then the weight ρ shifts the centre outwards.
        let center = [rho + self.spread[0] / rho, z + self.spread[1] / rho];
        let weighted = |a: i32, b: i32| center[0] * self.moment(center, a, b) + self.moment(center, a + 1, b);
        let volume = self.area * rho;
        let spread = [(2, 0), (1, 1), (0, 2)].map(|(a, b)| weighted(a, b) / volume);
        Turned { volume, center, spread }
    }

    /// ∬ (ρ − ρ₀)ᵃ (z − z₀)ᵇ dρ dz.
    fn moment(&self, [rho, z]: [f64; 2], a: i32, b: i32) -> f64 {
        let mut sum = Sum::ZERO;
        for step in &self.steps {
            sum.add((step.rho - rho).powi(a + 1) * (step.z - z).powi(b) * step.dz);
        }
        sum.value() / f64::from(a + 1)
    }

    /// Middle of the outline's extent.
    fn rough_center(&self) -> [f64; 2] {
        let middle = |value: fn(&Step) -> f64| {
            let range = self.steps.iter().map(value).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            range.0 / 2.0 + range.1 / 2.0
        };
        [middle(|s| s.rho), middle(|s| s.z)]
    }
}

/// Along the pieces and, where the axis closes the outline, back along the axis.
fn steps(pieces: &[Piece]) -> Vec<Step> {
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return vec![] };
    let back = Piece::Line { from: last.at(1.0), to: first.at(0.0) };
    pieces.iter().chain([&back]).flat_map(piece_steps).collect()
}

fn piece_steps(piece: &Piece) -> Vec<Step> {
    let part = |piece: Piece| {
        gauss().iter().map(move |&(weight, t)| {
            let [rho, z] = piece.at(t);
            Step { rho, z, dz: weight * piece.slope(t)[1] }
        })
    };
    cut(piece).into_iter().flat_map(part).collect()
}

/// A piece cut at the quarters of its circle.
pub(super) fn cut(piece: &Piece) -> Vec<Piece> {
    match *piece {
        Piece::Line { .. } => vec![*piece],
        Piece::Arc { center, radius, from, to } => {
            quarters(from, to).into_iter().map(|[from, to]| Piece::Arc { center, radius, from, to }).collect()
        }
    }
}
