//! Files of a run: page, diagrams, CSV.

use super::measure::Measured;
use super::page::{IMAGES, Origin, page};
use super::plot::diagram;
use super::report::csv;
use super::summary::summary;
use std::path::Path;
use std::process::Command;

/// Writes accuracy.md, accuracy.csv and images/accuracy/*.svg into a folder, which is made if it does not exist.
///
/// # Errors
/// Names the file that cannot be written.
pub fn write(all: &[Measured], folder: &Path, origin: &Origin) -> Result<(), String> {
    let images = folder.join(IMAGES);
    let told =
        |path: &Path, reason: &dyn std::fmt::Display| format!("--out: {}: cannot be written: {reason}", path.display());
    std::fs::create_dir_all(&images).map_err(|e| told(&images, &e))?;
    let write = |path: &Path, text: Result<String, String>| {
        let text = text.map_err(|e| told(path, &e))?;
        std::fs::write(path, text).map_err(|e| told(path, &e))
    };
    for m in all {
        write(&images.join(format!("{}.svg", m.case.name)), diagram(m))?;
    }
    write(&images.join("summary.svg"), summary(all))?;
    write(&folder.join("accuracy.csv"), csv(all).map_err(|e| e.to_string()))?;
    write(&folder.join("accuracy.md"), Ok(page(all, origin)))
}

/// This command, this machine, today, and the commit of the working folder.
pub fn origin() -> Origin {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let commit = Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output().ok();
    let commit =
        commit.filter(|out| out.status.success()).map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned());
    let about = format!(
        "Measured on {}; {}; commit {}.",
        crate::cli::conformance::machine(),
        chrono::Utc::now().format("%Y-%m-%d"),
        commit.as_deref().unwrap_or("unknown")
    );
    Origin { command: format!("realnoid {}", words.join(" ")), about }
}
