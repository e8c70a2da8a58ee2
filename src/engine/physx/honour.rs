//! What PhysX makes of a model that is not what the model says.

use super::plan::is_free;
use super::shapes::make;
use crate::engine::honour::{Shortfall, name_of};
use crate::model::Model;

/// Links, told once for each of their axes, and then shapes, in the order of the model.
pub fn shortfalls(m: &Model) -> Vec<Shortfall> {
    let joint = |element| Shortfall::new(element, "<joint>", LEFT_OUT);
    let mut links: Vec<Shortfall> = m.axes.iter().map(|a| joint(format!("joint '{}'", a.name))).collect();
    if links.is_empty() {
        links.extend((1..m.bodies.len()).filter(|i| !is_free(m, *i)).map(|i| joint(name_of(m, i))));
    }
    let moves = |body: usize| body == 0 || is_free(m, body);
    let shapes = m.colliders.iter().filter(|c| m.effects.contact && moves(m.seat_of(c).0)).filter_map(|c| {
        let element = format!("link '{}'", c.name);
        match make(&c.form) {
            None => Some(Shortfall::new(element, "the shape", "it does not collide")),
            Some(made) => made.instead.map(|instead| Shortfall::new(element, "the shape", instead)),
        }
    });
    links.extend(shapes);
    links
}

const LEFT_OUT: &str =
    "physx moves bodies without joints only; links stand where they are at the start, and nothing touches them";
