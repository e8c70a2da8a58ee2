//! Shapes: polygon meshes, support, bounds.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "shape/family.rs"]
mod family;
#[path = "shape/surface.rs"]
mod surface;
#[path = "shape/topology.rs"]
mod topology;
