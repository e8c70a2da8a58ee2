//! realnoid: the forward dynamics of a life-size humanoid, as a library and a ROS 2 node.
//!
//! The rooms, in the order in which data flows; a room may use only rooms above it
//! (`tests/layering.rs` enforces that):

pub mod cli;
pub mod description;
pub mod dynamics;
pub mod engine;
pub mod mass;
pub mod math;
pub mod model;
pub mod monitor;
pub mod record;
pub mod ros;
pub mod shape;
pub mod solver;
pub mod world;
