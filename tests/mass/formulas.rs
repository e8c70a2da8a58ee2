//! Each formula against numerical integration, for random parameter sets of every kind of shape.

use super::kinds::*;
use super::points::{Moments, stretched};
use super::round::Round;
use super::straight;
use proptest::prelude::*;
use realnoid::description::{Dimension, Subdivision, Substance};
use realnoid::mass::of_shape;
use realnoid::shape::{Meshes, Shape, tessellate};

const DENSITY: f64 = 2000.0;
const WALL: f64 = 0.003;

fn ours(shape: &Shape, dimension: Dimension) -> Moments {
    let substance = Substance { specific_gravity: DENSITY / 1000.0, dimension, polygonise: None };
    let body = of_shape(shape, &substance, &Meshes::default()).unwrap();
    assert!(body.properties.is_physical(), "{:?}", body.properties.principal());
    let thickness = if dimension == Dimension::Solid { 1.0 } else { WALL };
    assert!((body.volume * DENSITY / body.properties.mass - 1.0).abs() < 1e-14);
    Moments::from_mass(&body.properties, DENSITY * thickness)
}

fn solid(shape: &Shape) -> f64 {
    let grows = shape.stretch.iter().product::<f64>().abs();
    let cloud = straight::solid(&shape.geometry, shape.finish.fillet).map(|c| stretched(c, shape.stretch, grows));
    let round = || Round::of(&shape.geometry, &shape.finish, shape.stretch).map(|r| r.solid());
    let mesh = || {
        let mesh = polygons(shape);
        straight::mesh_solid(&mesh, mesh.vertices[0] * 1.5)
    };
    let reference = cloud.or_else(round).unwrap_or_else(mesh);
    ours(shape, Dimension::Solid).deviation(&Moments::of(&reference))
}

fn hollow(shape: &Shape) -> f64 {
    let cloud = straight::surface(&shape.geometry, shape.finish.fillet, shape.stretch);
    let round = || Round::of(&shape.geometry, &shape.finish, shape.stretch).map(|r| r.surface());
    let mesh = || straight::mesh_surface(&polygons(shape));
    let reference = cloud.or_else(round).unwrap_or_else(mesh);
    ours(shape, Dimension::Hollow { thickness: WALL }).deviation(&Moments::of(&reference))
}

fn polygons(shape: &Shape) -> realnoid::shape::TriMesh {
    tessellate(shape, Subdivision { around: 3, flat: 1 }, &Meshes::default()).unwrap()
}

/// Per kind: 1e-9 where all lengths are of one order, 1e-6 at 1 : 1000.
fn agrees(off: fn(&Shape) -> f64, shape: &dyn Fn(&Draw) -> Shape) {
    let config =
        ProptestConfig { cases: 24, max_shrink_iters: 40, failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(ordinary in ordinary(), extreme in extreme())| {
        for (draw, allowed) in [(ordinary, 1e-9), (extreme, 1e-6)] {
            let off = off(&shape(&draw));
            prop_assert!(off < allowed, "{off:e} at {:?}", shape(&draw));
        }
    });
}

macro_rules! agree {
    ($($name:ident: $check:ident($shape:expr);)*) => {$(
        #[test]
        fn $name() {
            agrees($check, &$shape);
        }
    )*};
}

agree! {
    solid_box: solid(scaled(cuboid));
    solid_box_with_fillets: solid(filleted(cuboid));
    solid_sphere: solid(plain(sphere));
    solid_sphere_scaled: solid(scaled(sphere));
    solid_sphere_sliced: solid(sliced(sphere));
    solid_ellipsoid: solid(scaled(ellipsoid));
    solid_cylinder: solid(plain(cylinder));
    solid_cylinder_scaled: solid(scaled(cylinder));
    solid_cylinder_sliced: solid(sliced(cylinder));
    solid_cylinder_with_fillets: solid(filleted(cylinder));
    solid_cylinder_with_everything: solid(all_at_once(cylinder));
    solid_elliptic_cylinder: solid(scaled(elliptic_cylinder));
    solid_elliptic_cylinder_with_everything: solid(all_at_once(elliptic_cylinder));
    solid_capsule: solid(plain(capsule));
    solid_capsule_scaled: solid(scaled(capsule));
    solid_capsule_sliced: solid(sliced(capsule));
    solid_tapered_capsule: solid(scaled(tapered_capsule));
    solid_tapered_capsule_sliced: solid(sliced(tapered_capsule));
    solid_tube: solid(plain(tube));
    solid_tube_scaled: solid(scaled(tube));
    solid_tube_sliced: solid(sliced(tube));
    solid_tube_with_fillets: solid(filleted(tube));
    solid_tube_with_everything: solid(all_at_once(tube));
    solid_cone: solid(scaled(cone));
    solid_cone_sliced: solid(sliced(cone));
    solid_cone_with_fillet: solid(filleted(cone));
    solid_cone_with_everything: solid(all_at_once(cone));
    solid_frustum: solid(scaled(frustum));
    solid_frustum_sliced: solid(sliced(frustum));
    solid_frustum_with_fillets: solid(filleted(frustum));
    solid_frustum_with_everything: solid(all_at_once(frustum));
    solid_torus: solid(plain(torus));
    solid_torus_scaled: solid(scaled(torus));
    solid_torus_sliced: solid(sliced(torus));
    solid_oil_tank: solid(plain(oil_tank));
    solid_oil_tank_scaled: solid(scaled(oil_tank));
    solid_oil_tank_sliced: solid(sliced(oil_tank));
    solid_pyramid: solid(scaled(pyramid));
    solid_polyhedron: solid(scaled(polyhedron));

    hollow_box: hollow(scaled(cuboid));
    hollow_box_with_fillets: hollow(filleted(cuboid));
    hollow_sphere: hollow(plain(sphere));
    hollow_sphere_scaled: hollow(scaled(sphere));
    hollow_sphere_sliced: hollow(sliced(sphere));
    hollow_ellipsoid: hollow(scaled(ellipsoid));
    hollow_hemisphere: hollow(plain(hemisphere));
    hollow_hemisphere_scaled: hollow(scaled(hemisphere));
    hollow_cylinder: hollow(plain(cylinder));
    hollow_cylinder_open: hollow(open(cylinder));
    hollow_cylinder_sliced: hollow(sliced(cylinder));
    hollow_cylinder_with_fillets: hollow(filleted(cylinder));
    hollow_cylinder_with_everything: hollow(all_at_once(cylinder));
    hollow_elliptic_cylinder: hollow(scaled(elliptic_cylinder));
    hollow_elliptic_cylinder_with_everything: hollow(all_at_once(elliptic_cylinder));
    hollow_capsule: hollow(plain(capsule));
    hollow_capsule_scaled: hollow(scaled(capsule));
    hollow_capsule_sliced: hollow(sliced(capsule));
    hollow_tapered_capsule: hollow(scaled(tapered_capsule));
    hollow_tapered_capsule_sliced: hollow(sliced(tapered_capsule));
    hollow_tube: hollow(plain(tube));
    hollow_tube_scaled: hollow(scaled(tube));
    hollow_tube_sliced: hollow(sliced(tube));
    hollow_tube_with_fillets: hollow(filleted(tube));
    hollow_tube_with_everything: hollow(all_at_once(tube));
    hollow_cone: hollow(scaled(cone));
    hollow_cone_open: hollow(open(cone));
    hollow_cone_sliced: hollow(sliced(cone));
    hollow_cone_with_everything: hollow(all_at_once(cone));
    hollow_frustum: hollow(scaled(frustum));
    hollow_frustum_open: hollow(open(frustum));
    hollow_frustum_sliced: hollow(sliced(frustum));
    hollow_frustum_with_fillets: hollow(filleted(frustum));
    hollow_frustum_with_everything: hollow(all_at_once(frustum));
    hollow_torus: hollow(plain(torus));
    hollow_torus_scaled: hollow(scaled(torus));
    hollow_torus_sliced: hollow(sliced(torus));
    hollow_oil_tank: hollow(plain(oil_tank));
    hollow_oil_tank_scaled: hollow(scaled(oil_tank));
    hollow_oil_tank_sliced: hollow(sliced(oil_tank));
    hollow_pyramid: hollow(scaled(pyramid));
    hollow_polyhedron: hollow(scaled(polyhedron));
    hollow_disc: hollow(plain(disc));
    hollow_disc_scaled: hollow(scaled(disc));
    hollow_disc_sliced: hollow(sliced(disc));
    hollow_plane: hollow(scaled(plane));
    hollow_triangle: hollow(scaled(triangle));
    hollow_quad: hollow(scaled(quad));
}
