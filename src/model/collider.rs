//! What collides.

use crate::math::Pose;
use crate::shape::ContactForm;

/// How a surface touches (B-8 E … H).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Friction ≥ 0; pair value = product.
    pub friction: f64,
    /// Rolling friction ≥ 0, m; pair value = rollA·fricB + rollB·fricA.
    pub rolling: f64,
    /// Spinning friction ≥ 0, m; same rule.
    pub spinning: f64,
    /// Restitution ≥ 0; pair value = product.
    pub restitution: f64,
}

impl Default for Surface {
    fn default() -> Self {
        Self { friction: 1.0, rolling: 0.0, spinning: 0.0, restitution: 0.0 }
    }
}

impl Surface {
    /// Of a pair.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            friction: self.friction * other.friction,
            rolling: self.rolling * other.friction + other.rolling * self.friction,
            spinning: self.spinning * other.friction + other.spinning * self.friction,
            restitution: self.restitution * other.restitution,
        }
    }
}

/// One shape that collides.
#[derive(Clone, Debug)]
pub struct Collider {
    /// Its link's name, or its own.
    pub name: String,
    /// Index into `Model::links`; `None`: it stands still in the world.
    pub link: Option<usize>,
    /// `X_LC`: the shape's frame in the link frame (in the world without a link).
    pub pose: Pose,
    /// The shape.
    pub form: ContactForm,
    /// How it touches.
    pub surface: Surface,
    /// Collision margin (B-8 A): the shape is thicker by this all around, m.
    pub margin: f64,
}
