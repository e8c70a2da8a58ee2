//! Shapes: polygon meshes, support, bounds.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "shape/family.rs"]
mod family;
#[path = "shape/measures.rs"]
mod measures;
#[path = "shape/platonic.rs"]
mod platonic;
#[path = "shape/reach.rs"]
mod reach;
#[path = "shape/topology.rs"]
mod topology;
