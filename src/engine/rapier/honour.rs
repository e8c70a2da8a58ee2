//! What rapier makes of a model that is not what the model says.

use super::parts::embodied;
use super::shapes::{is_approximate, shape};
use crate::engine::honour::{Shortfall, name_of};
use crate::model::Model;
use crate::shape::ContactForm;

/// What rapier calls the shape that it makes of a form.
pub fn shape_name(form: &ContactForm) -> String {
    shape(form).map_or_else(|| "nothing: it does not collide".into(), |(s, _)| format!("{:?}", s.shape_type()))
}

/// In the order of the model.
pub fn shortfalls(m: &Model) -> Vec<Shortfall> {
    let light = embodied(m).map(|body| {
        Shortfall::new(
            name_of(m, body),
            "a body without mass or inertia",
            "it gets a little, so that rapier can move it",
        )
    });
    let shapes = m.colliders.iter().filter(|_| m.effects.contact).filter_map(|c| {
        let element = format!("link '{}'", c.name);
        match shape(&c.form) {
            None => Some(Shortfall::new(element, "the shape", "it does not collide")),
            Some(_) if is_approximate(&c.form) => {
                Some(Shortfall::new(element, "the round shape", "it collides as a polyhedron"))
            }
            Some(_) => None,
        }
    });
    light.chain(shapes).collect()
}
