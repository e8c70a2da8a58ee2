//! How far two worlds of the same model are apart.

use crate::model::{LinkFrame, Model};
use crate::world::Snapshot;

/// What is compared.
pub(super) struct Measure {
    /// In tables, CSV and JSON.
    pub name: &'static str,
    /// Of the difference.
    pub unit: &'static str,
}

/// Of each kind of difference, in the order of [`Differences`]. All stand for lengths and angles, so one bound is meant for all of them.
pub(super) const MEASURES: [Measure; 3] = [
    Measure { name: "axes", unit: "rad or m" },
    Measure { name: "positions of links", unit: "m" },
    Measure { name: "orientations of links", unit: "rad" },
];

/// The greatest difference of one kind, and the axis or link that has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Worst {
    /// In the unit of the [`Measure`].
    pub value: f64,
    /// Index of the axis or link.
    pub index: usize,
}

/// For each of [`MEASURES`].
pub(super) type Differences = [Worst; 3];

/// The links whose frames are compared: those that something can move. Links inside of a joint group have no body; the axes tell of them.
pub(super) fn moving_links(m: &Model) -> Vec<usize> {
    let moves = |link: &usize| matches!(m.links[*link].frame, LinkFrame::OnBody { body, .. } if body > 0);
    (0..m.links.len()).filter(moves).collect()
}

/// Between two instants of the same model; `links`: those of [`moving_links`].
///
/// Positions of links are those of the frames' origins in the world; orientations differ by the angle of the rotation between them. Positions of
/// axes are continuous, so a full turn more is a difference.
pub(super) fn differences(a: &Snapshot, b: &Snapshot, links: &[usize]) -> Differences {
    let axes = a.position.iter().zip(&b.position).map(|(x, y)| (x - y).abs()).enumerate();
    let (pa, pb) = (&a.link_pose, &b.link_pose);
    let place = |i: &usize| (*i, (pa[*i].translation.vector - pb[*i].translation.vector).norm());
    let turn = |i: &usize| (*i, pa[*i].rotation.angle_to(&pb[*i].rotation));
    [worst(axes), worst(links.iter().map(place)), worst(links.iter().map(turn))]
}

/// The first of the greatest; what is not a number is worse than any.
fn worst(values: impl Iterator<Item = (usize, f64)>) -> Worst {
    values.fold(Worst::default(), |w, (index, value)| {
        let worse = value > w.value || (value.is_nan() && !w.value.is_nan());
        if worse { Worst { value, index } } else { w }
    })
}

/// Name of what a difference of this kind is of.
pub(super) fn name_of(m: &Model, measure: usize, index: usize) -> &str {
    match measure {
        0 => m.axes.get(index).map_or("", |a| &a.name),
        _ => m.links.get(index).map_or("", |l| &l.name),
    }
}

/// True if there is something of this kind to compare.
pub(super) fn exists(m: &Model, links: &[usize], measure: usize) -> bool {
    if measure == 0 { !m.axes.is_empty() } else { !links.is_empty() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_named_and_nan_is_worst() {
        let of = |v: &[f64]| worst(v.iter().copied().enumerate());
        assert_eq!(of(&[0.1, 0.3, 0.3, 0.2]), Worst { value: 0.3, index: 1 });
        assert_eq!(of(&[]), Worst::default());
        let w = of(&[0.1, f64::NAN, 0.3, f64::NAN]);
        assert!(w.value.is_nan() && w.index == 1);
    }
}
