//! `realnoid simulate`: no ROS, as fast as it goes.

use super::args::SimulateArgs;
use super::estimate::Estimate;
use super::outcome::{Outcome, Peak, Progress, counted};
pub(super) use super::start::{Start, interval};
use super::stopwatch::Stopwatch;
use crate::record::{ContactWriter, Format, Recorder, Sample};
use crate::world::ContactPoint;
use serde_json::json;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by SIGINT and SIGTERM: the run ends early, its file is completed.
static STOP: AtomicBool = AtomicBool::new(false);

/// From here on, SIGINT and SIGTERM only set what [`stopped`] tells.
pub(super) fn catch_signals() {
    // Without the handler the run only loses its neat end.
    let _ = ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed));
}

/// Has a signal come?
pub(super) fn stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Runs; prints the summary to standard output. Exit codes: 0 all finite; 1 not finite, stopped by a signal, robot not
/// loaded, output not written; 2 wrong arguments or scene.
pub fn run(args: &SimulateArgs) -> ExitCode {
    let mut start = match checked(args) {
        Ok(start) => start,
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            return ExitCode::from(code);
        }
    };
    let files = Files { out: args.out.as_deref(), contacts: args.contacts.as_deref() };
    match start.run(&files, &mut Progress::new()) {
        Ok(summary) => {
            // A reader that has gone away (`| head`) is no failure of the run.
            let _ = writeln!(std::io::stdout(), "{summary:#}");
            let complete = summary["finite"] == true && summary["stopped"] == false;
            if complete { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn checked(args: &SimulateArgs) -> Result<Start, (u8, String)> {
    args.out.as_deref().map(Format::of).transpose().map_err(|e| (2, format!("--out {e}")))?;
    let mut start = Start::new(&args.run, args.engine.as_deref(), args.every)?;
    start.estimates = args.estimate_error;
    Ok(start)
}

/// Where the rows of a run go.
#[derive(Clone, Copy, Default)]
pub(super) struct Files<'a> {
    /// The states.
    pub out: Option<&'a Path>,
    /// The contacts.
    pub contacts: Option<&'a Path>,
}

/// The files of a run.
struct Records {
    recorder: Option<Recorder>,
    contacts: Option<ContactWriter<File>>,
}

impl Records {
    /// True if a row was written.
    fn write(&mut self, sample: &Sample, contacts: &[ContactPoint]) -> Result<bool, String> {
        if let Some(writer) = &mut self.contacts {
            writer.rows(&sample.snapshot, contacts).map_err(|cause| format!("--contacts: cannot write: {cause}"))?;
        }
        let Some(recorder) = &mut self.recorder else { return Ok(false) };
        recorder.write(sample).map_err(|e| e.to_string())?;
        Ok(true)
    }
}

impl Start {
    /// Makes the run; its summary.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn run(&mut self, files: &Files, progress: &mut Progress) -> Result<serde_json::Value, String> {
        let open = |path: &Path| Recorder::create(path, self.world.model());
        let recorder = files.out.map(open).transpose().map_err(|e| e.to_string())?;
        let touches = |path| ContactWriter::new(File::create(path)?, self.world.model());
        let told = |cause: io::Error| format!("--contacts: cannot write the file: {cause}");
        let contacts = files.contacts.map(touches).transpose().map_err(told)?;
        let mut records = Records { recorder, contacts };
        catch_signals();
        let outcome = self.simulate(&mut records, progress);
        progress.clear();
        let mut outcome = outcome?;
        if let Some(recorder) = records.recorder {
            outcome.files = recorder.finish().map_err(|e| e.to_string())?;
        }
        if let Some(contacts) = records.contacts {
            contacts.finish().map_err(told)?;
            outcome.files.extend(files.contacts.map(Path::to_owned));
        }
        Ok(self.summary(&outcome))
    }

    fn simulate(&mut self, records: &mut Records, progress: &mut Progress) -> Result<Outcome, String> {
        let peaks = vec![Peak::default(); self.world.model().axes.len()];
        let e = self.world.energy();
        let mut outcome = Outcome { finite: true, energy: e.kinetic + e.potential, peaks, ..Outcome::default() };
        let mut sample = Sample::new(&self.world);
        let watch = Stopwatch::new();
        let mut estimate = self.estimates.then(|| Estimate::new(&self.world, &self.script));
        for interval in 0..=self.intervals {
            let complete = interval == self.intervals;
            outcome.stopped = !complete && stopped();
            let (last, row) = (complete || outcome.stopped, interval % self.every == 0);
            if row || last {
                sample.take(&self.world);
                outcome.finite &= sample.is_finite();
            }
            if row {
                outcome.rows += u64::from(records.write(&sample, self.world.contacts())?);
            }
            if last {
                break;
            }
            progress.show(interval, self.intervals);
            self.script.apply(interval, &mut self.world);
            if let Some(estimate) = &mut estimate {
                estimate.begin(interval, &self.world);
            }
            let start = watch.now();
            self.world.advance();
            outcome.cpu += watch.now() - start;
            if let Some(estimate) = &mut estimate {
                estimate.end(&self.world);
            }
            outcome.note_peaks(&self.world);
        }
        outcome.cpu *= watch.share();
        outcome.estimate = estimate.map(|estimate| estimate.told(&self.world));
        Ok(outcome)
    }

    /// Where the energy (J) went; what is unaccounted for is the error of the integrator.
    fn ledger(&self, start: f64) -> serde_json::Value {
        let (e, work, stats) = (self.world.energy(), self.world.work(), self.world.stats());
        let end = e.kinetic + e.potential;
        json!({
            "start": start,
            "end": end,
            "work_of_drives": work.drives,
            "losses": work.losses,
            "losses_at_contacts": work.contacts,
            "trimmed": stats.trimmed_energy,
            "unaccounted": unaccounted(&self.world, start),
        })
    }

    fn summary(&self, outcome: &Outcome) -> serde_json::Value {
        let (s, cpu) = (self.world.stats(), outcome.cpu);
        let broken = self.world.broken().iter();
        let broken: Vec<_> = broken.map(|b| json!({"joint": *b.joint, "time": b.time, "force": b.force})).collect();
        let mut told = json!({
            "engine": self.world.settings().engine.name(),
            "steps": s.steps,
            "rows": outcome.rows,
            "output": outcome.files,
            "simulated_seconds": self.simulated(),
            "cpu_seconds": cpu,
            "us_per_step": if s.steps > 0 { cpu * 1e6 / s.steps as f64 } else { 0.0 },
            "worst_penetration": s.worst_penetration,
            "contacts": self.world.contacts().len(),
            "worst_stop_violation": s.worst_stop_violation,
            "joint_drift": self.world.joint_drift(),
            "peaks": outcome.peaks(self.world.model()),
            "finite": outcome.finite,
            "stopped": outcome.stopped,
            "fallback_steps": s.fallback_steps,
            "unsettled_steps": s.unsettled_steps,
            "halvings": s.halvings,
            "divided_steps": s.divided_steps,
            "fast_pieces": s.fast_pieces,
            "guarded_pieces": s.guarded_pieces,
            "guarded_energy": s.guarded_energy,
            "trimmed_energy": s.trimmed_energy,
            "tempered_steps": s.tempered_steps,
            "worst_residual": s.worst_residual,
            "energy": self.ledger(outcome.energy),
            "pole_steps": s.pole_steps,
            "broken_joints": broken,
            "warnings": self.all_warnings(outcome),
        });
        if let (Some(told), Some(estimate)) = (told.as_object_mut(), &outcome.estimate) {
            told.insert("error_estimate".into(), estimate.clone());
        }
        told
    }

    /// Simulated time, s; of a world that stands still, up to there.
    fn simulated(&self) -> f64 {
        let s = self.world.settings();
        let step = interval(s) / f64::from(s.steps_per_interval);
        if self.world.stats().diverged_steps > 0 {
            self.world.stats().steps.saturating_sub(1) as f64 * step
        } else {
            self.world.time()
        }
    }

    /// Those from before the run, and what the run had to tell.
    fn all_warnings(&self, outcome: &Outcome) -> Vec<String> {
        let s = self.world.stats();
        let mut warnings = self.warnings.clone();
        if outcome.stopped {
            warnings.push("stopped by a signal before the end of the duration".into());
        }
        if !outcome.finite && s.diverged_steps == 0 {
            warnings.push("a value is not finite: the state can be represented, its energy or momentum cannot".into());
        }
        let broken = self.world.broken().iter();
        warnings.extend(broken.map(|b| format!("joint '{}' {b}, more than its break_threshold", b.joint)));
        let counted = counted(&s).into_iter().filter(|(n, _)| *n > 0);
        warnings.extend(counted.map(|(n, text)| format!("{n} {text}")));
        warnings
    }
}

/// Energy (J) gained since it was `start`, less the work of drives, plus what was lost or taken away: the error of the integrator.
pub(super) fn unaccounted(w: &crate::world::World, start: f64) -> f64 {
    let (e, work, stats) = (w.energy(), w.work(), w.stats());
    let taken = work.losses + work.contacts + stats.trimmed_energy + stats.guarded_energy;
    e.kinetic + e.potential - start - work.drives + taken
}
