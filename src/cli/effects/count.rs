//! Instructions per step, counted by valgrind's callgrind: exactly, and the same in every run.
//!
//! This program starts itself under callgrind, with the same arguments and `--count`. Callgrind writes what it has counted since the
//! last time whenever [`counted_steps`] or [`after_steps`] begins: every second file is that of one variant of the world, and
//! loading and copying are in the others.

use crate::world::World;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Instructions per physics step.
pub(super) struct Counts {
    /// With all that the scene calls for.
    pub full: f64,
    /// Without each effect, by its name.
    without: Vec<(&'static str, f64)>,
}

impl Counts {
    /// What an effect costs.
    pub fn of(&self, effect: &str) -> Option<f64> {
        self.without.iter().find(|(name, _)| *name == effect).map(|(_, without)| self.full - without)
    }
}

/// Worlds that are made and stepped before any is counted: the heap is then as it will be before each of them.
const WARM: usize = 2;

/// The child under callgrind: the world with everything, then those without each of `effects`. Each is made from `make` and gone
/// before the next one, so that all of them lie in the same places: how `memcpy` copies depends on the address.
pub(super) fn count_here(make: impl Fn(Option<&str>) -> Option<World>, effects: &[&str], intervals: u64) {
    for _ in 0..WARM {
        if let Some(mut world) = make(None) {
            (0..intervals).for_each(|_| world.advance());
        }
    }
    for effect in std::iter::once(None).chain(effects.iter().map(|name| Some(*name))) {
        if let Some(mut world) = make(effect) {
            counted_steps(&mut world, intervals);
            after_steps();
        }
    }
}

#[inline(never)]
fn after_steps() {
    std::hint::black_box(());
}

/// What counts.
#[inline(never)]
fn counted_steps(world: &mut World, intervals: u64) {
    for _ in 0..intervals {
        world.advance();
    }
}

/// Counts a world, and those without each of `effects`, over `steps` physics steps each.
///
/// # Errors
/// Why that is not possible, and the mend.
pub(super) fn counts(effects: &[&'static str], steps: u64) -> Result<Counts, String> {
    let folder = Folder::new()?;
    let program = std::env::current_exe().map_err(|error| format!("this program cannot be found: {error}"))?;
    let child = Command::new("valgrind")
        .args(["--tool=callgrind", "--dump-before=*count::counted_steps*", "--dump-before=*count::after_steps*"])
        .arg(format!("--callgrind-out-file={}", folder.0.join("part").display()))
        .arg(program)
        .args(std::env::args_os().skip(1))
        .arg("--count")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output();
    let output = child.map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => "valgrind is not installed: apt install valgrind".into(),
        _ => format!("valgrind cannot be started: {error}"),
    })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("valgrind failed: {}", said.lines().last().unwrap_or("it said nothing")));
    }
    let counted = |n: usize| {
        let file = folder.0.join(format!("part.{}", 2 * n));
        let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        total(&text).ok_or_else(|| format!("{}: no totals in it", file.display()))
    };
    let per_step = |n: usize| Ok::<f64, String>(counted(n)? as f64 / steps as f64);
    let without = effects.iter().enumerate().map(|(i, name)| Ok::<_, String>((*name, per_step(i + 2)?)));
    Ok(Counts { full: per_step(1)?, without: without.collect::<Result<_, _>>()? })
}

/// `totals: N` of a file of callgrind.
fn total(text: &str) -> Option<u64> {
    text.lines().rev().find_map(|line| line.strip_prefix("totals: ")).and_then(|n| n.trim().parse().ok())
}

/// A folder of its own, which goes with it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("realnoid-effects-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What is left there harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn totals_are_read() {
        assert_eq!(super::total("version: 1\nsummary: 7\n\nfn=x\n1 2\n\ntotals: 1234\n"), Some(1234));
        assert_eq!(super::total("version: 1\n"), None);
        assert_eq!(super::total("totals: many\n"), None);
    }
}
