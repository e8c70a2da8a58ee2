//! What acts on an axis besides the smooth dynamics: damping, dry friction, stops, drives.
//!
//! Everything stiff is implicit. The laws of one axis are a monotone staircase of torque over its speed ([`Law`]); all axes
//! together are solved as a set ([`AxisSet`]) with the hybrid dynamics.

mod axis_set;
mod between;
mod books;
mod command;
mod cone;
mod contacts;
mod contested;
mod couplings;
mod damping;
mod dense;
mod drive;
mod driven;
mod finish;
mod free_mobility;
mod gauss_seidel;
mod inner;
mod inputs;
mod law;
mod lifting;
mod lifts;
mod margins;
mod mobility;
mod outcome;
mod piece;
mod products;
mod refit;
mod rows;
mod seat;
mod smooth;
mod soft;
mod touching;
mod way;
mod yielding;

pub use axis_set::{AxisSet, StateRef, StepStart};
pub use books::{Books, Work};
pub use command::{AxisCommand, Mode};
pub use cone::{ConeBlock, Plane, disc};
pub use contacts::{ContactPoint, Contacts};
pub use couplings::Stage as CouplingStage;
pub use drive::Brakes;
pub use driven::Driven;
pub use free_mobility::FreeMobility;
pub use law::{AxisInput, Law};
pub use lifts::{Lift, LiftKind};
pub use margins::{Margins, Shape, first_to_leave, share};
pub use piece::Piece;
pub(crate) use piece::Reach;
pub use rows::{FINISH_ROWS, Kind, Row, Rows, Solved};
pub use soft::write_softs;
