//! Support and bounds against the vertices of fine meshes, in random poses.

use super::family::{finished, mesh_of, solids, surfaces};
use proptest::prelude::*;
use realnoid::description::Subdivision;
use realnoid::math::{Pose, Quat, Vec3};
use realnoid::shape::{Bounds, Meshes, Shape, Support, TriMesh, bounds};
use std::sync::LazyLock;

const FINE: Subdivision = Subdivision { around: 720, flat: 1 };

fn around(mesh: &TriMesh) -> Bounds {
    let fold = |f: fn(&Vec3, &Vec3) -> Vec3| mesh.vertices.iter().copied().reduce(|a, b| f(&a, &b)).unwrap();
    Bounds { min: fold(|a, b| a.inf(b)), max: fold(|a, b| a.sup(b)) }
}

/// Every shape with its fine mesh.
static MESHES: LazyLock<Vec<(&'static str, Shape, TriMesh)>> = LazyLock::new(|| {
    let flat = surfaces().into_iter().map(|(name, shape, _)| (name, shape));
    let all = solids().into_iter().chain(finished()).chain(flat);
    all.map(|(name, shape)| (name, shape.clone(), mesh_of(&shape, FINE))).collect()
});

/// How far a vertex may stay behind the support: before the stretch (factors ≤ 2) the sagitta R (1 − cos(π/N)) of one
/// segment in each of two directions, with R at most the torus' 0.7 m.
fn most_missed() -> f64 {
    2.0 * 2.0 * 0.7 * (1.0 - (std::f64::consts::PI / f64::from(FINE.around)).cos())
}

#[test]
fn the_bounds_are_the_least_box_around_the_mesh() {
    for (name, shape, mesh) in &*MESHES {
        let (box_, found) = (bounds(shape, &Pose::identity(), &Meshes::default()).unwrap(), around(mesh));
        let slack = 1e-14;
        assert!(
            (found.min - box_.min).min() >= -slack && (box_.max - found.max).min() >= -slack,
            "{name}: a vertex outside"
        );
        let missed = (found.min - box_.min).max().max((box_.max - found.max).max());
        assert!(missed <= most_missed(), "{name}: the mesh stays {missed} m away");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn no_vertex_is_beyond_the_support_and_some_vertex_is_close(x in -1.0..1.0f64, y in -1.0..1.0f64, z in -1.0..1.0f64) {
        let direction = Vec3::new(x, y, z);
        prop_assume!(direction.norm() > 0.1);
        let direction = direction.normalize();
        for (name, shape, mesh) in &*MESHES {
            let support = Support::of(shape, &Meshes::default()).unwrap();
            let reach = support.point(&direction).dot(&direction);
            let found = mesh.vertices.iter().map(|v| v.dot(&direction)).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(found <= reach + 1e-14, "{name}: {found} > {reach}");
            prop_assert!(reach - found <= most_missed(), "{name}: {found} < {reach}");
        }
    }

    #[test]
    fn a_turned_shape_has_the_bounds_of_its_turned_mesh(angles in prop::array::uniform3(-3.0..3.0f64), at in prop::array::uniform3(-2.0..2.0f64)) {
        let x_as = Pose::from_parts(Vec3::from(at).into(), Quat::from_euler_angles(angles[0], angles[1], angles[2]));
        for (name, shape, mesh) in &*MESHES {
            let box_ = bounds(shape, &x_as, &Meshes::default()).unwrap();
            let found = around(&mesh.clone().placed(&x_as));
            let (low, high) = (found.min - box_.min, box_.max - found.max);
            prop_assert!(low.min() >= -1e-14 && high.min() >= -1e-14, "{name}: a vertex outside");
            prop_assert!(low.max().max(high.max()) <= most_missed(), "{name}: {low} {high}");
        }
    }
}

#[test]
fn a_direction_of_nothing_gives_a_point_of_the_shape() {
    for (name, shape, _) in &*MESHES {
        let box_ = bounds(shape, &Pose::identity(), &Meshes::default()).unwrap();
        let p = Support::of(shape, &Meshes::default()).unwrap().point(&Vec3::zeros());
        assert!((p - box_.min).min() >= -1e-15 && (box_.max - p).min() >= -1e-15, "{name}");
    }
}
