//! `realnoid replay`: makes a recorded run again, and compares bit for bit.

mod check;
mod stage;
mod verdict;

use super::args::ReplayArgs;
use super::simulate::{catch_signals, stopped};
use crate::record::story::Program;
use crate::record::{BagReader, Format, file_in};
use stage::Stage;
use std::path::Path;
use std::process::ExitCode;
use verdict::{Verdict, told};

/// Exit code for a command line, or a bag, that makes no sense.
const USAGE: u8 = 2;

/// Exit codes: 0 all bits are the same; 1 they are not, or not all could be compared; 2 there is nothing to replay.
pub fn run(args: &ReplayArgs) -> ExitCode {
    let done = file_in(&args.bag).and_then(|file| Ok((replay(&file, args.out.as_deref())?, file)));
    match done {
        Ok((verdict, file)) => {
            let _ = super::say(&told(&verdict, &file));
            if verdict.same() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
        }
        Err(reason) => {
            eprintln!("error: {}", reason.trim_end());
            ExitCode::from(USAGE)
        }
    }
}

fn replay(file: &Path, out: Option<&Path>) -> Result<Verdict, String> {
    if out.map(Format::of).transpose().map_err(|e| format!("--out {e}"))? == Some(Format::Mcap) {
        return Err("--out: a replay writes rows: FILE.csv".into());
    }
    let about = |reason: String| format!("'{}': {reason}", file.display());
    catch_signals();
    let mut reader = BagReader::open(file)?;
    let mut stage = Stage::new(out.map(Path::to_owned));
    let mut damage = None;
    while !stopped() {
        match reader.read() {
            Ok(Some(message)) => stage.take(&message).map_err(about)?,
            Ok(None) => break,
            // Nothing to replay at all, or nothing from here on.
            Err(reason) if !stage.has_begun() => return Err(about(reason)),
            Err(reason) => {
                damage = Some(reason);
                break;
            }
        }
    }
    let mut verdict = stage.finish().map_err(about)?;
    verdict.cut_off = !reader.is_complete() && damage.is_none() && !stopped();
    verdict.stopped = stopped();
    verdict.damage = damage;
    verdict.this_program = Some(Program::this());
    Ok(verdict)
}
