//! Colliders of a description.

use super::exclude::excluded;
use super::forms::{Formed, form};
use crate::description::{Description, Finding, Link, PlacedShape, Position, Severity};
use crate::model::{Collider, LinkFrame, Model, Surface};
use crate::shape::{Meshes, collision_shapes};

/// What holds where a link's `<surface>` says nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defaults {
    /// How it touches.
    pub surface: Surface,
    /// Collision margin, m.
    pub margin: f64,
}

/// Fills `m.colliders` and `m.excluded_pairs` from the description that `m` was built from; what `m.colliders` held before
/// stays, in front. Tells which shapes collide as something else than they are, which not at all, and which links
/// overlap from the start.
pub fn colliders(d: &Description, m: &mut Model, meshes: &Meshes, defaults: Defaults) -> Vec<Finding> {
    let mut findings = vec![];
    for (i, link) in d.links.iter().enumerate() {
        let (_, shapes) = collision_shapes(link);
        let stands = match m.links[i].frame {
            LinkFrame::OnBody { body, .. } => body == 0,
            LinkFrame::InGroup { .. } => {
                findings.extend(shapes.first().map(|shape| in_group(link, shape)));
                continue;
            }
        };
        let (surface, margin) = touch_of(link, defaults);
        for shape in shapes {
            match form(shape, stands, meshes) {
                Ok(Formed { form, instead }) => {
                    findings.extend(instead.map(|message| about(link, shape, "collides-as", message)));
                    let (name, pose) = (link.name.clone(), shape.origin.pose());
                    m.colliders.push(Collider { name, link: Some(i), pose, form, surface, margin });
                }
                Err(fault) => findings.push(Finding {
                    severity: Severity::Warning,
                    mend: "correct it, or give the link a <proxy> or <collision> that can be read".into(),
                    ..about(link, shape, "does-not-collide", format!("this shape does not collide: {fault}"))
                }),
            }
        }
    }
    let (pairs, overlapping) = excluded(m);
    m.excluded_pairs = pairs;
    findings.extend(overlapping.iter().map(|(pair, depth)| overlap(d, *pair, *depth)));
    findings
}

fn touch_of(link: &Link, defaults: Defaults) -> (Surface, f64) {
    let Some(own) = &link.surface else { return (defaults.surface, defaults.margin) };
    let surface = Surface {
        friction: own.friction.unwrap_or(defaults.surface.friction),
        rolling: own.rolling_friction.unwrap_or(defaults.surface.rolling),
        spinning: own.spinning_friction.unwrap_or(defaults.surface.spinning),
        restitution: own.restitution.unwrap_or(defaults.surface.restitution),
    };
    (surface, own.margin.unwrap_or(defaults.margin))
}

fn note(code: &'static str, message: String, element: String, at: Position) -> Finding {
    Finding { severity: Severity::Note, code, message, element, at, mend: String::new() }
}

fn about(link: &Link, shape: &PlacedShape, code: &'static str, message: String) -> Finding {
    note(code, message, format!("link '{}' <{}>", link.name, shape.geometry.kind()), shape.at)
}

fn in_group(link: &Link, shape: &PlacedShape) -> Finding {
    let message = "a link inside a joint group has no body of its own: its shapes do not collide";
    Finding {
        severity: Severity::Warning,
        mend: "move the shape to the link of the last axis of the group".into(),
        ..about(link, shape, "collider-in-group", message.into())
    }
}

fn overlap(d: &Description, [a, b]: [usize; 2], depth: f64) -> Finding {
    let (a, b) = (&d.links[a], &d.links[b]);
    let message = format!(
        "links '{}' and '{}' overlap by {:.2} mm where all joints are at 0: they never collide with each other",
        a.name,
        b.name,
        1e3 * depth
    );
    let at = collision_shapes(b).1.first().map_or(b.at, |shape| shape.at);
    note("links-overlap", message, format!("link '{}'", b.name), at)
}
