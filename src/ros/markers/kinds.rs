//! What can be shown, and how: the parameters `markers…`.

use crate::ros::messages::Color;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// A kind of markers; its name is their namespace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Edges of the collision shapes.
    Wireframes,
    /// Least boxes around the collision shapes, along the axes of the world.
    Aabbs,
    /// Points, normals and forces of contacts.
    Contacts,
    /// Axes of joints.
    Axes,
    /// Their ranges, and where they stand in them.
    Ranges,
    /// Normals of the polygons of collision shapes.
    Normals,
    /// Centres of mass of the links of the URDF (B-17).
    CentersOfMass,
    /// Their principal axes (B-17).
    PrincipalAxes,
    /// Centres of mass of what joints move as one body (J-17).
    LinkCentersOfMass,
    /// Their principal axes (J-17).
    LinkPrincipalAxes,
}

/// Kinds, in the order of [`KIND_NAMES`].
const KINDS: [Kind; KIND_NAMES.len()] = [
    Kind::Wireframes,
    Kind::Aabbs,
    Kind::Contacts,
    Kind::Axes,
    Kind::Ranges,
    Kind::CentersOfMass,
    Kind::PrincipalAxes,
    Kind::LinkCentersOfMass,
    Kind::LinkPrincipalAxes,
    Kind::Normals,
];

/// Names of the kinds: what is shown by default, then the normals.
pub const KIND_NAMES: [&str; 10] = [
    "wireframes",
    "aabbs",
    "contacts",
    "axes",
    "ranges",
    "centers_of_mass",
    "principal_axes",
    "link_centers_of_mass",
    "link_principal_axes",
    "normals",
];

impl Kind {
    /// Its name.
    pub fn name(self) -> &'static str {
        KIND_NAMES[self.index()]
    }

    fn index(self) -> usize {
        KINDS.iter().position(|kind| *kind == self).unwrap_or_default()
    }
}

/// The parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MarkerSettings {
    /// Real time, Hz; 0: none.
    pub rate: f64,
    /// A bit for each kind.
    kinds: u32,
    /// Radius of centres of mass, m; 0: the least half edge of the box around a link's collision shapes.
    pub size: f64,
    /// Of centres of mass.
    pub color: Color,
}

impl MarkerSettings {
    /// Checked values.
    pub fn new(rate: f64, kinds: &[String], size: f64, color: [f64; 4]) -> Self {
        let bit = |name: &String| KIND_NAMES.iter().position(|n| n == name).map_or(0, |i| 1 << i);
        let [r, g, b, a] = color.map(|x| x as f32);
        Self { rate, kinds: kinds.iter().fold(0, |bits, name| bits | bit(name)), size, color: Color { r, g, b, a } }
    }

    /// Is this kind shown?
    pub fn shows(&self, kind: Kind) -> bool {
        self.kinds & (1 << kind.index()) != 0
    }
}

/// Settings that one thread writes and another reads.
#[derive(Debug, Default)]
pub struct LiveSettings {
    rate: AtomicU64,
    kinds: AtomicU32,
    size: AtomicU64,
    color: [AtomicU32; 4],
}

impl LiveSettings {
    /// Writes them.
    pub fn set(&self, s: &MarkerSettings) {
        self.rate.store(s.rate.to_bits(), Relaxed);
        self.kinds.store(s.kinds, Relaxed);
        self.size.store(s.size.to_bits(), Relaxed);
        let parts = [s.color.r, s.color.g, s.color.b, s.color.a];
        self.color.iter().zip(parts).for_each(|(cell, part)| cell.store(part.to_bits(), Relaxed));
    }

    /// Reads them.
    pub fn get(&self) -> MarkerSettings {
        let [r, g, b, a] = [0, 1, 2, 3].map(|i| f32::from_bits(self.color[i].load(Relaxed)));
        let double = |cell: &AtomicU64| f64::from_bits(cell.load(Relaxed));
        let (rate, size) = (double(&self.rate), double(&self.size));
        MarkerSettings { rate, kinds: self.kinds.load(Relaxed), size, color: Color { r, g, b, a } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_through_as_they_were_set() {
        let settings = MarkerSettings::new(10.0, &["aabbs".into(), "normals".into()], 0.01, [1.0, 0.5, 0.0, 1.0]);
        let live = LiveSettings::default();
        live.set(&settings);
        assert_eq!(live.get(), settings);
        let shown: Vec<_> = KINDS.iter().filter(|kind| settings.shows(**kind)).map(|kind| kind.name()).collect();
        assert_eq!(shown, ["aabbs", "normals"]);
    }
}
