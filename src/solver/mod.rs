//! What acts on an axis besides the smooth dynamics: damping, dry friction, stops, drives.
//!
//! Everything stiff is implicit. The laws of one axis are a monotone staircase of torque over the velocity at the end of
//! the step ([`law`]); all axes together are solved as a set ([`AxisSet`]) with the hybrid dynamics.

mod axis_set;
mod command;
mod law;
mod refit;
mod smooth;
mod soft;

pub use axis_set::{AxisSet, Outcome, StateRef};
pub use command::{AxisCommand, Mode};
pub use law::{AxisInput, Law, SERVO_TIME, STOP_ERP, law};
