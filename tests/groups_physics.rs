//! Groups against theory: heavy tops, the cardan's kinematics, the pole, stops and drives of a 3DOF, the linear axis.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "groups_physics/ball.rs"]
mod ball;
#[path = "groups_physics/cardan.rs"]
mod cardan;
#[path = "groups_physics/extension.rs"]
mod extension;
mod limbs;
#[path = "groups_physics/tops.rs"]
mod tops;
