//! What a run leaves on disk.

mod csv;

pub use csv::CsvWriter;
