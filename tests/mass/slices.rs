//! Slices: together the whole, and turned the turned.

use super::kinds::*;
use super::weigh::{WALL, deviation, weigh};
use proptest::prelude::*;
use realnoid::description::{Dimension, Finish, Geometry, Scaling};
use realnoid::mass::MassProperties;
use realnoid::math::{Pose, Vec3};
use realnoid::shape::Shape;
use std::f64::consts::TAU;

/// The makers of shapes that a slice is defined for.
const SLICED: [Make; 10] =
    [cylinder, elliptic_cylinder, capsule, tapered_capsule, tube, cone, frustum, sphere, torus, oil_tank];
/// Those of surfaces without caps, whose slices have no faces of their own.
const SURFACES: [Make; 4] = [cylinder, cone, frustum, elliptic_cylinder];

fn made(make: Make, d: &Draw, fillets: bool, open: bool, slice: Option<[f64; 2]>, factors: [f64; 3]) -> Shape {
    let (geometry, room) = make(d);
    let fillet = if fillets { room * d.parts[1] } else { 0.0 };
    let finish = Finish { fillet, top_fillet: None, slice, open };
    Shape::finished(geometry, finish, Scaling { factors, ..Scaling::default() }).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn slices_that_make_a_whole_weigh_as_the_whole(d in ordinary(), which in 0..SLICED.len(), fillets in any::<bool>()) {
        let of = |slice| weigh(&made(SLICED[which], &d, fillets, false, slice, d.factors), Dimension::Solid);
        let [a, b] = d.slice;
        let parts = MassProperties::sum(&[of(Some([a, b])), of(Some([b, a + TAU]))]);
        prop_assert!(deviation(&parts, &of(None), 3.0) < 1e-12);
    }

    #[test]
    fn open_slices_that_make_a_whole_weigh_as_the_whole(d in ordinary(), which in 0..SURFACES.len()) {
        let of = |slice| weigh(&made(SURFACES[which], &d, false, true, slice, d.factors), WALL);
        let [a, b] = d.slice;
        let parts = MassProperties::sum(&[of(Some([a, b])), of(Some([b, a + TAU]))]);
        let off = deviation(&parts, &of(None), 3.0);
        prop_assert!(off < 1e-12, "{off:e}");
    }

    #[test]
    fn the_slices_of_a_bowl_and_of_a_disc_make_the_whole(d in ordinary(), bowl in any::<bool>()) {
        let make: Make = if bowl { hemisphere } else { disc };
        let of = |slice| weigh(&made(make, &d, false, false, slice, d.factors), WALL);
        let [a, b] = d.slice;
        let parts = MassProperties::sum(&[of(Some([a, b])), of(Some([b, a + TAU]))]);
        prop_assert!(deviation(&parts, &of(None), 3.0) < 1e-12);
    }

    #[test]
    fn a_slice_further_around_is_the_slice_turned(d in ordinary(), which in 0..SLICED.len(), by in -3.0..3.0f64) {
        let round = |mut d: Draw| { d.lengths[1] = d.lengths[0]; d };
        // Only shapes that are round about Z; the tapered capsule's ends are lengths 0 and 1.
        let d = round(d);
        for dimension in [Dimension::Solid, WALL] {
            let of = |slice| weigh(&made(SLICED[which], &d, true, false, Some(slice), [1.0; 3]), dimension);
            let [a, b] = d.slice;
            let turned = of([a, b]).placed(&Pose::rotation(Vec3::new(0.0, 0.0, by)));
            prop_assert!(deviation(&of([a + by, b + by]), &turned, 2.0) < 1e-12);
        }
    }
}

#[test]
fn a_quarter_of_a_cylinder_has_its_textbook_centre() {
    let quarter = Finish { slice: Some([0.0, TAU / 4.0]), ..Finish::default() };
    let shape = Shape::finished(Geometry::Cylinder { radius: 0.3, length: 0.7 }, quarter, Scaling::default()).unwrap();
    let body = weigh(&shape, Dimension::Solid);
    let center = 4.0 * 0.3 / (3.0 * std::f64::consts::PI);
    assert!((body.center - Vec3::new(center, center, 0.0)).norm() < 1e-15);
    assert!((body.mass / (1000.0 * TAU / 8.0 * 0.09 * 0.7) - 1.0).abs() < 1e-15);
}
