//! The hard cases of tests/hard with every integrator of rbx at every step of the grid: nothing is wrong in silence, nothing is not finite.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::conformance::files;
use realnoid::cli::hard::{Cell, Column, Grid, STEPS, page};
use realnoid::model::Base;
use realnoid::world::{AxisCommand, EngineKind, Integrator, Settings, World};
use std::path::{Path, PathBuf};

mod support;

const CASES: &str = "tests/hard";
const PAGE: &str = "docs/hard-cases.md";

fn columns() -> Vec<Column> {
    Integrator::NAMES
        .iter()
        .map(|(_, integrator)| Column { engine: EngineKind::Rbx, integrator: *integrator })
        .collect()
}

fn holds(files: &[PathBuf]) {
    let grid = Grid::of(files, &columns(), &STEPS, &mut |_, _| {}).unwrap();
    let wrong: Vec<String> = grid.entries.iter().flat_map(|e| e.wrong(&STEPS)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for entry in &grid.entries {
        let ran = |row: &realnoid::cli::hard::Row| row.cells.iter().all(|c| matches!(c, Cell::Done { .. }));
        assert!(entry.rows.len() == Integrator::NAMES.len() && entry.rows.iter().all(ran), "{}", entry.case.name);
    }
}

/// The cases in four heaps, so that they run side by side.
fn heap(which: usize) {
    let all = files(Path::new(CASES)).unwrap();
    assert!(all.len() >= 25, "{} cases", all.len());
    let mine: Vec<PathBuf> = all.into_iter().skip(which).step_by(4).collect();
    holds(&mine);
}

#[test]
fn hard_cases_first_heap() {
    heap(0);
}

#[test]
fn hard_cases_second_heap() {
    heap(1);
}

#[test]
fn hard_cases_third_heap() {
    heap(2);
}

#[test]
fn hard_cases_fourth_heap() {
    heap(3);
}

/// A command with a number that is none is refused whole, and the world goes on as if it had not been given. A torque of NaN is one that is not
/// given: the drive gives what it can.
#[test]
fn commands_that_are_no_numbers_change_nothing() {
    let m = support::urdf::model(&std::fs::read_to_string("urdf/origin.urdf").unwrap(), Base::Fixed);
    let (torque, servo) = (AxisCommand::torque, AxisCommand::servo);
    let bad = [torque(f64::INFINITY), torque(f64::NEG_INFINITY), servo(f64::NAN), servo(f64::INFINITY)];
    for (_, integrator) in Integrator::NAMES {
        let fresh = World::new(m.clone(), Settings { integrator, ..Settings::default() }).unwrap();
        let (mut told, mut untold) = (fresh.clone(), fresh);
        for bad in bad {
            let mut commands = vec![servo(0.1); m.axes.len()];
            commands[7] = bad;
            assert_eq!(told.set_commands(&commands), Err(7), "{bad:?}");
            told.advance();
            untold.advance();
            assert_eq!(told.state(), untold.state());
        }
        told.set_commands(&vec![torque(f64::NAN); m.axes.len()]).unwrap();
        (0..200).for_each(|_| told.advance());
        assert_eq!(told.stats().diverged_steps, 0);
        assert!(told.state().q.iter().chain(&told.state().v).all(|x| x.is_finite()));
    }
}

/// The page has every case, and is of a run in which nothing is wrong in silence.
#[test]
fn the_page_is_of_these_cases() {
    let text = std::fs::read_to_string(PAGE).unwrap();
    let all = files(Path::new(CASES)).unwrap();
    let headings = text.lines().filter(|l| l.starts_with("### ")).count();
    assert_eq!(headings, all.len(), "make it anew: realnoid hard tests/hard --markdown {PAGE}");
    let some = Grid::of(&all[..1], &columns()[..1], &STEPS, &mut |_, _| {}).unwrap();
    assert_eq!(page(&some, Path::new(CASES), "").lines().next(), text.lines().next());
    let (_, figures) = text.split_once("## Summary").unwrap();
    for line in figures.lines().filter(|l| Integrator::NAMES.iter().any(|(n, _)| l.starts_with(&format!("| {n}")))) {
        assert!(!line.contains("SILENT") && !line.contains("NOT FINITE"), "{line}");
    }
    for file in &all {
        let name = file.file_stem().unwrap().to_str().unwrap();
        assert!(text.contains(&format!("\n### {name}\n")), "{name} is missing; make the page anew");
    }
}
