//! The arguments of `accuracy`.

use clap::Args;
use std::path::PathBuf;

/// `accuracy`.
#[derive(Debug, Default, Args)]
pub struct AccuracyArgs {
    /// Cases by name; all, if none is named.
    pub cases: Vec<String>,
    /// Which cases there are, what they show, and what they are compared with; nothing is run.
    #[arg(long)]
    pub list: bool,
    /// Folder for accuracy.md, accuracy.csv and a diagram per case, images/accuracy/CASE.svg; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Engines, separated by commas; all that this program was built with, if none is given.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub engines: Vec<String>,
    /// Integrators of rbx, separated by commas; all, if none is given.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub integrators: Vec<String>,
    /// Steps, s, separated by commas, each a part of 0.04 s; 0.008 to 0.000125 by halves, if none is given.
    #[arg(long, value_name = "SECONDS,…", value_delimiter = ',', allow_negative_numbers = true)]
    pub dt: Vec<f64>,
    /// CPU time to spend at least on timing each run, s: it is repeated, and the fastest counts.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.1, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Another program in the same diagrams, on the same bodies: mujoco (needs Python 3; its wheel is installed from PyPI).
    #[arg(long, value_name = "NAME", value_parser = ["mujoco"])]
    pub peer: Option<String>,
    /// Three steps, one run of each, and a coarser reference: to look whether it works.
    #[arg(long)]
    pub quick: bool,
    /// JSON instead of tables.
    #[arg(long)]
    pub json: bool,
}
