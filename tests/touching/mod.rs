//! Scenes with contacts, built by hand.
#![allow(dead_code)] // each test uses a part

use realnoid::description;
use realnoid::engine::State;
use realnoid::mass::link_bodies;
use realnoid::math::{Pose, Vec3};
use realnoid::model::{Base, Collider, Model, Surface};
use realnoid::shape::{ContactForm, Meshes};
use realnoid::world::{Integrator, Settings, World};
use std::path::Path;
use std::sync::Arc;

pub fn model(urdf: &str, base: Base) -> Model {
    let d = description::read(urdf, "test.urdf").description.unwrap();
    let (bodies, _) = link_bodies(&d, &Meshes::beside(Path::new("."), &[]));
    let masses: Vec<_> = bodies.iter().map(|b| b.simulated).collect();
    Model::build(&d, &masses, base, Pose::identity())
}

pub fn surface(friction: f64) -> Surface {
    Surface { friction, ..Surface::default() }
}

pub fn ground(friction: f64) -> Collider {
    Collider {
        name: "ground".into(),
        link: None,
        pose: Pose::identity(),
        form: ContactForm::HalfSpace,
        surface: surface(friction),
        margin: 0.0,
    }
}

pub fn on_link(m: &Model, link: &str, form: ContactForm, surface: Surface) -> Collider {
    let link = m.links.iter().position(|l| l.name == link).unwrap();
    Collider { name: m.links[link].name.clone(), link: Some(link), pose: Pose::identity(), form, surface, margin: 0.0 }
}

pub fn settings(h: f64, integrator: Integrator) -> Settings {
    Settings {
        control_interval_ns: (h * 1e9).round() as i64,
        steps_per_interval: 1,
        integrator,
        gravity: [0.0, 0.0, -9.81],
        ..Settings::default()
    }
}

/// One free body of this mass and inertia.
pub fn free_body(mass: f64, inertia: [f64; 3]) -> Model {
    let [x, y, z] = inertia;
    let urdf = format!(
        r#"<robot name="r"><link name="b"><inertial><mass value="{mass}"/><inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"#
    );
    model(&urdf, Base::Free)
}

pub fn ball(mass: f64, radius: f64, own: Surface, floor: Collider) -> Model {
    let i = 0.4 * mass * radius * radius;
    let mut m = free_body(mass, [i; 3]);
    let c = on_link(&m, "b", ContactForm::Ball { radius }, own);
    m.set_colliders(vec![floor, c]);
    m
}

pub fn cuboid(mass: f64, half: [f64; 3], own: Surface, floor: Collider) -> Model {
    let [x, y, z] = half.map(|h| 4.0 * h * h);
    let mut m = free_body(mass, [mass * (y + z) / 12.0, mass * (x + z) / 12.0, mass * (x + y) / 12.0]);
    let c = on_link(&m, "b", ContactForm::Cuboid { half }, own);
    m.set_colliders(vec![floor, c]);
    m
}

pub fn world(m: Model, settings: Settings) -> World {
    World::new(Arc::new(m), settings).unwrap()
}

/// Free balls (mass, radius), one link each: b0, b1, …, on a floor.
pub fn balls(list: &[(f64, f64)], own: Surface, floor: Collider) -> Model {
    let mut urdf = String::from(r#"<robot name="r"><link name="w"/>"#);
    for (k, (mass, radius)) in list.iter().enumerate() {
        let i = 0.4 * mass * radius * radius;
        urdf += &format!(
            r#"<link name="b{k}"><inertial><mass value="{mass}"/><inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>
               <joint name="j{k}" type="floating"><parent link="w"/><child link="b{k}"/></joint>"#
        );
    }
    urdf += "</robot>";
    let mut m = model(&urdf, Base::Fixed);
    let mut colliders = vec![floor];
    for (k, (_, radius)) in list.iter().enumerate() {
        colliders.push(on_link(&m, &format!("b{k}"), ContactForm::Ball { radius: *radius }, own));
    }
    m.set_colliders(colliders);
    m
}

/// A robot from a file, with the spheres of its `<collision>` elements on the ground.
pub fn feet(path: &str, friction: f64) -> Model {
    use realnoid::description::Geometry;
    let text = std::fs::read_to_string(path).unwrap();
    let d = description::read(&text, path).description.unwrap();
    let mut m = model(&text, Base::Free);
    let mut colliders = vec![ground(friction)];
    for link in &d.links {
        for c in &link.collisions {
            if let Geometry::Sphere { radius } = c.geometry {
                let pose = c.origin.pose();
                let collider = on_link(&m, &link.name, ContactForm::Ball { radius }, surface(1.0));
                colliders.push(Collider { pose, ..collider });
            }
        }
    }
    m.set_colliders(colliders);
    m
}

/// Every link may rest.
pub fn rest(m: &mut Model, linear: f64, angular: f64, after: f64) {
    for link in &mut m.links {
        link.deactivation = Some(realnoid::model::Deactivation { linear, angular, after });
    }
    m.effects.deactivation = true;
}

/// Free cubes of these masses, one link each.
pub fn cubes(masses: &[f64], half: f64, own: Surface, floor: Collider) -> Model {
    let list: Vec<(f64, f64)> = masses.iter().map(|m| (*m, half)).collect();
    let mut m = balls(&list, own, floor);
    for c in m.colliders.iter_mut().skip(1) {
        c.form = ContactForm::Cuboid { half: [half; 3] };
    }
    let all = std::mem::take(&mut m.colliders);
    m.set_colliders(all);
    m
}

/// A thin rod along x with a ball of no size at its two ends.
pub fn rod(mass: f64, half: f64, own: Surface, floor: Collider) -> Model {
    let i = mass * half * half / 3.0;
    let mut m = free_body(mass, [1e-6, i, i]);
    let c = on_link(&m, "b", ContactForm::Capsule { bottom: 1e-6, top: 1e-6, half }, own);
    let turn = realnoid::math::Quat::from_axis_angle(&realnoid::math::Vec3::y_axis(), std::f64::consts::FRAC_PI_2);
    m.set_colliders(vec![floor, Collider { pose: Pose::from_parts(nalgebra::Translation3::identity(), turn), ..c }]);
    m
}

/// Links of 0.1 kg that hang from 0.9 m above the floor, stretched out sideways, and a ball at the end.
pub fn chain_with_ball(links: usize, length: f64, ratio: f64, floor: Collider) -> Model {
    let inertia = |m: f64, r: f64| {
        let i = 0.4 * m * r * r;
        format!(
            r#"<inertial><origin xyz="{} 0 0"/><mass value="{m}"/><inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>"#,
            length / 2.0
        )
    };
    let mut urdf = String::from(r#"<robot name="r"><link name="l0"/>"#);
    for k in 1..=links + 1 {
        let (mass, radius) = if k > links { (0.1 * ratio, 0.1) } else { (0.1, 0.02) };
        let (x, axis) = (if k == 1 { 0.0 } else { length }, if k % 2 == 0 { "0 1 0" } else { "0 0 1" });
        let axis = if k == 1 { "0 1 0" } else { axis };
        let z = if k == 1 { 0.9 } else { 0.0 };
        urdf += &format!(
            r#"<link name="l{k}">{}</link><joint name="j{k}" type="continuous"><origin xyz="{x} 0 {z}"/><axis xyz="{axis}"/><parent link="l{}"/><child link="l{k}"/></joint>"#,
            inertia(mass, radius),
            k - 1
        );
    }
    urdf += "</robot>";
    let mut m = model(&urdf, Base::Fixed);
    let end = format!("l{}", links + 1);
    let c = on_link(&m, &end, ContactForm::Ball { radius: 0.1 }, surface(1.0));
    let pose = Pose::translation(length / 2.0, 0.0, 0.0);
    m.set_colliders(vec![floor, Collider { pose, ..c }]);
    m
}

/// Puts a single body at height z with this twist.
pub fn start(w: &mut World, z: f64, angular: Vec3, linear: Vec3) {
    let m = w.model().clone();
    let mut s = State::initial(&m);
    s.set_base_pose(&m, [0.0, 0.0, z], [0.0, 0.0, 0.0, 1.0]);
    s.set_base_twist(&m, angular, linear);
    w.set_initial_state(s);
}

/// Puts floating bodies of height 0.2 m on each other, from the ground up.
pub fn stack(w: &mut World) {
    let mut s = State::initial(w.model());
    for k in 0..w.model().bodies.len() - 1 {
        s.q[7 * k + 2] = 0.1 + 0.2 * k as f64;
    }
    w.set_initial_state(s);
}
