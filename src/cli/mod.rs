//! The command line, thin.

pub mod load;
