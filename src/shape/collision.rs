//! Which shapes of a link collide (B-6, J-8).

use crate::description::{Link, PlacedShape};

/// Where the shapes come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollisionSource {
    /// `<proxy>`: named for collision alone.
    Proxy,
    /// URDF's `<collision>`.
    Collision,
    /// The real shape: the shapes that the `<body>` tag makes the mass from.
    Body,
    /// The link does not collide.
    None,
}

/// The shapes of a link that collide, expressed in the link's frame. A proxy stands for `<collision>`, and that for the
/// real shape of a link with a `<body>` tag; a plain URDF link collides only if it says so.
pub fn collision_shapes(link: &Link) -> (CollisionSource, &[PlacedShape]) {
    let real = match &link.body {
        Some(body) if body.shapes.is_empty() => link.visuals.as_slice(),
        Some(body) => body.shapes.as_slice(),
        None => &[],
    };
    let sources = [
        (CollisionSource::Proxy, link.proxies.as_slice()),
        (CollisionSource::Collision, link.collisions.as_slice()),
        (CollisionSource::Body, real),
    ];
    sources.into_iter().find(|(_, shapes)| !shapes.is_empty()).unwrap_or((CollisionSource::None, &[]))
}
