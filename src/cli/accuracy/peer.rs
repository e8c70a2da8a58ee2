//! `--peer mujoco`: the curves of another program, on the same bodies, in the same run.

use super::measure::{Care, Curve, Measured, judged};
use super::mjcf::request;
use super::rung::{Ladder, Point};
use serde::Deserialize;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What runs the cases there.
const SCRIPT: &str = include_str!("../../../benches/mujoco/accuracy.py");
/// What is installed from PyPI.
const REQUIREMENTS: &str = include_str!("../../../benches/mujoco/requirements.txt");
/// Where it is installed, from the working folder.
const FOLDER: &str = "target/mujoco";
/// In diagrams.
const NAME: &str = "MuJoCo";

#[derive(Deserialize)]
struct Answer {
    version: String,
    cases: Vec<PeerCase>,
}

#[derive(Deserialize)]
struct PeerCase {
    name: String,
    curves: Vec<PeerCurve>,
    /// Why it does not take the model.
    refused: Option<String>,
}

#[derive(Deserialize)]
struct PeerCurve {
    integrator: String,
    runs: Vec<PeerRun>,
}

#[derive(Deserialize)]
struct PeerRun {
    step: f64,
    /// Of the whole run, s.
    cpu: f64,
    /// It began anew, because a value was not finite.
    failed: bool,
    /// Nothing stands for what is not finite.
    values: Vec<Vec<Option<f64>>>,
}

/// Adds its curves to the cases that it can have.
///
/// # Errors
/// Why it cannot be had.
pub(super) fn add(all: &mut [Measured], steps: &[Point], care: Care) -> Result<(), String> {
    let mut cases = vec![];
    for m in all.iter_mut() {
        // Drives with their commands are ours alone.
        if m.case.orders.is_some() {
            let reason = m.case.peer_differs.unwrap_or("it has no such drives");
            m.left_out.push(format!("{NAME}: {reason}"));
            continue;
        }
        let world = (m.case.make)()?;
        match request(&m.case, &world) {
            Ok(case) => cases.push(case),
            Err(reason) => m.left_out.push(format!("{NAME}: {reason}")),
        }
    }
    if cases.is_empty() {
        return Ok(());
    }
    let steps: Vec<f64> = steps.iter().map(Point::step).collect();
    let asked = json!({"cases": cases, "steps": steps, "seconds": care.seconds});
    let answer = ask(&asked.to_string())?;
    for case in answer.cases {
        let Some(m) = all.iter_mut().find(|m| m.case.name == case.name) else { continue };
        m.left_out.extend(case.refused.map(|reason| format!("{NAME}: {reason}")));
        for curve in case.curves {
            let curve = judge(m, curve, &answer.version)?;
            m.curves.push(curve);
        }
        m.curves.sort_by_key(|c| c.ladder == Ladder::Iterations);
    }
    Ok(())
}

fn judge(m: &Measured, c: PeerCurve, version: &str) -> Result<Curve, String> {
    let run = |r: &PeerRun| {
        let values: Vec<Vec<f64>> =
            r.values.iter().map(|row| row.iter().map(|x| x.unwrap_or(f64::NAN)).collect()).collect();
        let mut run = judged(&m.case, (&values, &m.reference.values), (Point::of_step(r.step)?, r.cpu));
        run.diverged |= r.failed;
        Ok(run)
    };
    let runs: Result<Vec<_>, String> = c.runs.iter().map(run).collect();
    let (label, engine) = (format!("{NAME} {}", c.integrator), format!("{NAME} {version}"));
    Ok(Curve { label, engine, integrator: c.integrator, ladder: Ladder::Steps, peer: true, runs: runs? })
}

fn ask(question: &str) -> Result<Answer, String> {
    let folder = Path::new(FOLDER);
    let python = installed(folder)?;
    let write = |name: &str, text: &str| {
        // Another run may be on its way.
        let path = folder.join(format!("{}-{name}", std::process::id()));
        std::fs::write(&path, text).map_err(|e| format!("cannot write {}: {e}", path.display())).map(|()| path)
    };
    let (script, file) = (write("accuracy.py", SCRIPT)?, write("accuracy.json", question)?);
    let out = Command::new(&python).args([&script, &file]).output();
    for path in [&script, &file] {
        // Left behind, they do no harm.
        let _ = std::fs::remove_file(path);
    }
    let out = out.map_err(|e| format!("cannot run {}: {e}", python.display()))?;
    if !out.status.success() {
        return Err(format!("its script failed:\n{}", String::from_utf8_lossy(&out.stderr)));
    }
    serde_json::from_slice(&out.stdout).map_err(|e| format!("its script did not answer in JSON: {e}"))
}

/// The Python that has it; it is installed, if it is not there.
fn installed(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("venv/bin/python");
    let has_it = |python: &Path| {
        Command::new(python).args(["-c", "import mujoco, numpy"]).output().is_ok_and(|o| o.status.success())
    };
    if has_it(&python) {
        return Ok(python);
    }
    std::fs::create_dir_all(folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    let system = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let venv = folder.join("venv");
    did(Command::new(&system).args(["-m", "venv"]).arg(&venv), "make a virtual environment", &system)?;
    let wheel = REQUIREMENTS.lines().find(|l| l.starts_with("mujoco")).unwrap_or("mujoco");
    did(
        Command::new(&python).args(["-m", "pip", "-q", "install", wheel]),
        &format!("install {wheel} from PyPI"),
        &system,
    )?;
    if has_it(&python) {
        Ok(python)
    } else {
        Err(format!("{wheel} was installed into {}, but cannot be imported", venv.display()))
    }
}

/// Runs a command of the installation.
fn did(command: &mut Command, what: &str, python: &str) -> Result<(), String> {
    let mend = format!(
        "it needs Python 3 with venv (Debian: apt install python3-venv; found as '{python}', set PYTHON for another one) and PyPI"
    );
    let out = command.output().map_err(|e| format!("cannot {what}: {e}; {mend}"))?;
    let told = String::from_utf8_lossy(&out.stderr);
    if out.status.success() { Ok(()) } else { Err(format!("cannot {what}: {}; {mend}", told.trim())) }
}
