//! `realnoid sweep`: many worlds over ranges of parameters, on all cores, a row for each.

mod document;
mod draw;
mod merge;
mod row;
mod spec;
mod table;
mod vary;
mod work;

use super::args::SweepArgs;
use super::simulate::{catch_signals, stopped};
use crate::dynamics::LaneKind;
use document::Document;
use spec::Spec;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use table::Table;
use work::{Places, Tally, Work};

/// Exit code for a command line or a specification that makes no sense.
const USAGE: u8 = 2;

/// Exit codes: 0 every world has its row; 1 stopped by a signal, or a file cannot be written; 2 wrong arguments or specification.
pub fn run(args: &SweepArgs) -> ExitCode {
    let done = match &args.merge {
        Some(out) => merge::merge(out, &args.files),
        None => sweep(args),
    };
    match done {
        Ok(text) if stopped() => {
            let _ = super::say(&text);
            ExitCode::FAILURE
        }
        Ok(text) => super::say(&text),
        Err((code, reason)) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(code)
        }
    }
}

fn sweep(args: &SweepArgs) -> Result<String, (u8, String)> {
    let usage = |reason: String| (USAGE, reason);
    let [file] = args.files.as_slice() else {
        return Err(usage("name one specification: realnoid sweep SPEC.yaml".into()));
    };
    let shard = args.shard.unwrap_or_default();
    let spec = Spec::read(file).map_err(usage)?;
    let document = Document::new(&spec, file).map_err(usage)?;
    let worlds = spec.worlds().map_err(|reason| usage(format!("{}: {reason}", file.display())))?;
    let plan = document.trial(&worlds[0], file)?;
    let path = args.out.clone().unwrap_or_else(|| default_out(file, shard));
    let todo: Vec<usize> = (0..worlds.len()).filter(|i| i % shard.count == shard.index).collect();
    let mut table = Table::open(&path, &plan).map_err(usage)?;
    let left: Vec<usize> = todo.iter().copied().filter(|i| !table.has(*i)).collect();
    let before = todo.len() - left.len();
    if before > 0 {
        eprintln!("{before} of {} worlds are in '{}' already", todo.len(), path.display());
    }
    catch_signals();
    let places = Places { bags: args.bags.clone(), tables: args.tables.clone() };
    let (jobs, together) = at_once(args, left.len());
    let work = Work { document: &document, worlds: &worlds, plan: &plan, places, jobs, together };
    let tally = work.run(&left, &mut table).map_err(|reason| (1, reason))?;
    if !stopped() {
        table.sort().map_err(|reason| (1, reason))?;
    }
    Ok(told(&tally, (before, todo.len(), worlds.len()), &path))
}

/// Threads for so many worlds, and worlds of each that are stepped together: a lane each, but not while other threads idle.
fn at_once(args: &SweepArgs, worlds: usize) -> (usize, usize) {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = args.jobs.map_or_else(cores, |jobs| jobs as usize);
    let lanes = if args.alone { 1 } else { LaneKind::best().width() };
    (jobs, lanes.min(worlds.div_ceil(jobs)))
}

fn told(tally: &Tally, (before, here, all): (usize, usize, usize), path: &Path) -> String {
    let mut text = format!("{} worlds made", tally.made);
    if before > 0 {
        text += &format!(", {before} were there");
    }
    if here < all {
        text += &format!("; this shard has {here} of {all}");
    }
    if tally.not_finite > 0 {
        text += &format!("; {} diverged", tally.not_finite);
    }
    if tally.refused > 0 {
        text += &format!("; {} could not be made (see the column error)", tally.refused);
    }
    if stopped() {
        text += "; stopped by a signal: the same command goes on from here";
    }
    text + &format!(": '{}'\n", path.display())
}

/// `SPEC.csv`, or `SPEC.shard-0-of-8.csv`, in the working folder.
fn default_out(spec: &Path, shard: Shard) -> PathBuf {
    let stem = spec.file_stem().map_or_else(|| "sweep".into(), |s| s.to_string_lossy().into_owned());
    PathBuf::from(match shard.count {
        1 => format!("{stem}.csv"),
        count => format!("{stem}.shard-{}-of-{count}.csv", shard.index),
    })
}

/// A part of the worlds: every `count`-th, from `index` on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: usize,
    /// At least 1.
    pub count: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Self { index: 0, count: 1 }
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((index, count)) if index < count => Ok(Self { index, count }),
            _ => Err("must be I/N with I from 0 to N - 1: --shard 0/8".into()),
        }
    }
}
