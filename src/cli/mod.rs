//! The command line, thin.

pub mod load;
pub mod run;
