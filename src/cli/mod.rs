//! The command line, thin.

pub mod check;
pub mod load;
pub mod run;
