//! realnoid: the forward dynamics of a life-size humanoid, as a library and a ROS 2 node.
//!
//! The rooms, in the order in which data flows. invariant: a room uses only rooms above it (`tests/layering.rs` reads this
//! list; the empty lines keep rustfmt from sorting it).

pub mod math;

pub mod description;

pub mod shape;

pub mod mass;

pub mod model;

pub mod dynamics;

pub mod contact;

pub mod solver;

pub mod engine;

pub mod world;

pub mod monitor;

pub mod record;

pub mod ros;

pub mod cli;
