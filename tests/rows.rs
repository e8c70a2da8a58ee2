//! Constraint rows: their responses against the dense mass matrix, the contact law by itself, the iteration and the finish.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "rows/columns.rs"]
mod columns;
#[path = "rows/cone.rs"]
mod cone;
#[path = "rows/iteration.rs"]
mod iteration;
#[path = "rows/lifts.rs"]
mod lifts;
#[path = "rows/response.rs"]
mod response;

#[path = "rows/coulomb.rs"]
mod coulomb;
#[path = "rows/problems.rs"]
mod problems;
mod support;
