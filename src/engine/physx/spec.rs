//! What a scene of PhysX is made of, and what it tells: single precision, SI units, frames in the world unless said otherwise.

use super::sys::Cooked;
use std::sync::Arc;

/// Stands for no link.
pub const NO_LINK: u32 = u32::MAX;

/// Where a body is and how it moves. A body's own frame has its origin in the centre of mass and its axes along the principal
/// ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moving {
    /// x, y, z, m, and a unit quaternion x, y, z, w.
    pub pose: [f32; 7],
    /// rad/s.
    pub angular: [f32; 3],
    /// Of the centre of mass, m/s.
    pub linear: [f32; 3],
}

impl Moving {
    /// The greatest number that is taken: m, m/s, rad/s. PhysX's own bounds, which it keeps in silence, lie above it.
    pub const MOST: f32 = 1e15;

    /// Are all of its numbers finite and within [`Self::MOST`]?
    pub fn is_sound(&self) -> bool {
        self.pose.iter().chain(&self.angular).chain(&self.linear).all(|x| x.abs() <= Self::MOST)
    }
}

/// A body that moves.
#[derive(Clone, Debug)]
pub struct Body {
    /// kg.
    pub mass: f32,
    /// Principal moments, kg·m².
    pub inertia: [f32; 3],
    /// At the start.
    pub moving: Moving,
}

/// A shape as PhysX knows it, in its own frame.
#[derive(Clone, Debug)]
pub enum Form {
    /// Radius, m.
    Ball(f32),
    /// Half edges, m.
    Cuboid([f32; 3]),
    /// Along x: radius, half length without the caps, m.
    Capsule(f32, f32),
    /// All of x ≤ 0; stands still.
    HalfSpace,
    /// Convex.
    Hull(Arc<Cooked>),
    /// Triangles; stands still.
    Mesh(Arc<Cooked>),
}

/// A shape on a body.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Which collider of the model it is, or is a part of.
    pub collider: u32,
    /// Its link; [`NO_LINK`]: none.
    pub link: u32,
    /// Index into [`Scene::bodies`]; `None`: it stands still in the world.
    pub body: Option<usize>,
    /// In the body's own frame, as [`Moving::pose`].
    pub pose: [f32; 7],
    /// The shape.
    pub form: Form,
    /// Friction, restitution; the values of a pair are products.
    pub surface: [f32; 2],
    /// Thicker by this all around, m.
    pub margin: f32,
}

/// A whole scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Those that move.
    pub bodies: Vec<Body>,
    /// What collides.
    pub shapes: Vec<Shape>,
    /// Pairs of links (ascending, in order) whose shapes never touch.
    pub excluded: Vec<[u32; 2]>,
    /// Shapes that are nearer to each other than twice this are looked at, m.
    pub reach: f32,
    /// Contacts nearer to each other than this share their friction, m.
    pub correlation: f32,
}

/// What a step needs to know.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// s.
    pub h: f32,
    /// m/s².
    pub gravity: [f32; 3],
    /// Position iterations, 1 to 255.
    pub passes: u32,
    /// Below this speed nothing bounces, m/s.
    pub bounce: f32,
}

/// A point where two shapes touch, or are about to.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    /// Colliders of the model.
    pub colliders: [u32; 2],
    /// At the start of the step.
    pub point: [f32; 3],
    /// Unit, from the second to the first.
    pub normal: [f32; 3],
    /// Between the shapes without their margins, at the start of the step, m; below 0 they overlap.
    pub separation: f32,
    /// Along the normal, on the first, N·s.
    pub impulse: f32,
}
