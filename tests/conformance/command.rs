//! `realnoid engines`, as a user calls it, with cases of his own.

use realnoid::world::EngineKind;
use serde_json::Value;
use std::fs;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A ball that falls for 0.1 s; a sound case.
const GOOD: &str = "version: 1
shows: It falls.
scene:
  version: 1
  bodies:
    - {name: ball, mass: 2, shape: {sphere: {radius: 0.1}}, pose: [0, 0, 9, 0, 0, 0, 1]}
duration: 0.1
constants: [\"v = g * 0.1\"]
expect:
  - quantity: velocity
    of: ball
    part: z
    is: -v
    theory: uniform acceleration
    within: {others: 1e-9, physx: 1e-3}
    because: exact
";

fn engines(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_realnoid")).arg("engines").args(arguments).output().unwrap()
}

/// The case in a folder of its own.
fn folder(text: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("fall.yaml"), text).unwrap();
    folder
}

fn run(text: &str, more: &[&str]) -> (Option<i32>, String, String) {
    let folder = folder(text);
    let arguments: Vec<&str> = ["--cases", folder.path().to_str().unwrap()].iter().chain(more).copied().collect();
    let output = engines(&arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_list_is_that_of_the_program() {
    let list: Value = serde_json::from_slice(&engines(&["--json"]).stdout).unwrap();
    let text = String::from_utf8(engines(&[]).stdout).unwrap();
    for ((name, kind), said) in EngineKind::NAMES.iter().zip(list["engines"].as_array().unwrap()) {
        assert_eq!((said["name"].as_str(), said["built"].as_bool()), (Some(*name), Some(kind.available().is_ok())));
        assert_eq!(said["to_have_it"].as_str(), kind.available().err().as_deref());
        assert_eq!(said["capabilities"]["joints"].as_bool(), Some(kind.capabilities().joints));
        let how = kind.available().err().unwrap_or_else(|| "in this program".into());
        assert!(text.lines().any(|l| l.starts_with(name) && l.ends_with(&how)), "{text}");
    }
}

#[test]
fn a_sound_case_passes_and_a_wrong_one_fails() {
    let (code, said, _) = run(GOOD, &[]);
    assert!(code == Some(0) && said.contains("It falls."), "{said}");
    // Theory that is wrong by a millimetre per second.
    let (code, said, _) = run(&GOOD.replace("is: -v", "is: 0.001 - v"), &["--engine", "rapier"]);
    assert!(
        code == Some(1) && said.contains("rapier is BEYOND ITS TOLERANCE: velocity of ball z: 1.00e-3 of 1.00e-9"),
        "{said}"
    );
    assert!(!said.contains("rbx"), "{said}");
    // What the case says of an engine that is beyond …
    let known = |error: f64| {
        let beyond = format!("{GOOD}    beyond: {{rbx: {{error: {error}, because: a mistake}}}}\n");
        run(&beyond.replace("is: -v", "is: 0.001 - v"), &["--engine", "rbx"])
    };
    let (code, said, _) = known(0.001);
    assert!(code == Some(0) && said.contains("rbx is beyond, as the case says"), "{said}");
    // … holds up to twice of it, and no longer than it is so.
    assert_eq!(known(0.0004).0, Some(1));
    let (code, said, _) =
        run(&format!("{GOOD}    beyond: {{rbx: {{error: 0.001, because: a mistake}}}}\n"), &["--engine", "rbx"]);
    assert!(code == Some(0) && said.contains("no longer beyond"), "{said}");
}

#[test]
fn figures_go_into_files() {
    let out = TempDir::new().unwrap();
    let file = |name: &str| out.path().join(name).to_str().unwrap().to_owned();
    let (csv, page) = (file("a.csv"), file("a.md"));
    let (code, said, _) = run(GOOD, &["--json", "--engine", "rbx", "--csv", &csv, "--markdown", &page]);
    assert_eq!(code, Some(0));
    let all: Value = serde_json::from_str(&said).unwrap();
    let figure = &all["cases"][0]["engines"]["rbx"]["quantities"][0];
    assert!((figure["value"].as_f64().unwrap() + 0.980665).abs() < 1e-9, "{figure}");
    assert_eq!((all["passed"].as_bool(), figure["verdict"].as_str()), (Some(true), Some("within")));
    let rows = fs::read_to_string(csv).unwrap();
    assert!(
        rows.lines().count() == 2
            && rows.lines().nth(1).unwrap().starts_with("\"fall\",\"velocity of ball z\",m/s,rbx,0.1,"),
        "{rows}"
    );
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("### fall") && page.contains("not asked"), "{page}");
    assert_eq!(run(GOOD, &["--engine", "rbx", "--csv", "/nowhere/a.csv"]).0, Some(1));
}

/// What is changed in the sound case, and what is said of it.
const WRONG: [(&str, &str, &str); 24] = [
    ("shows:", "show:", "line 2"),
    ("version: 1\nshows", "version: 2\nshows", "version is 2"),
    ("mass: 2", "mas: 2", "line 6"),
    ("mass: 2", "mass: -2", "line 6: bodies[0] 'ball': mass is -2 kg"),
    ("duration: 0.1", "duration: 0.10005", "whole multiple of the control interval"),
    ("quantity: velocity", "quantity: speed", "line 10: expect[0] 'speed': there is no such quantity"),
    ("of: ball", "of: bull", "there is no link 'bull'; there are: stand, ball"),
    ("    of: ball\n", "", "of is missing: which link?"),
    ("part: z", "part: w", "choose one of: x, y, z"),
    ("    part: z\n", "", "must be a list of three"),
    ("is: -v", "is: -u", "there is no 'u'"),
    ("is: -v", "is: v *", "is no formula"),
    ("is: -v", "is: [1, 2, 3]", "must be a number or a formula"),
    ("    part: z", "    part: z\n    at: [0.2]", "0.2 s is after the end of the run"),
    ("    part: z", "    part: z\n    at: []", "give it at"),
    ("    part: z", "    part: z\n    between: [0, 0.1]", "give it at"),
    ("    part: z", "    part: z\n    between: [0, 0.1]\n    take: mean", "take 'mean' does not exist"),
    ("    part: z", "    part: z\n    count: 1", "only crossing_time has one"),
    ("others: 1e-9", "rbx: 1e-9", "the engine rapier has no tolerance"),
    ("others: 1e-9", "newton: 1e-9", "there is no engine 'newton'"),
    ("v = g * 0.1", "g = 1", "line 8: constants: 'g' is no name, or already has a value"),
    ("v = g * 0.1", "v = g * t", "it must be finite, and without t"),
    ("duration: 0.1", "duration: 0.1\nneeds: [wings]", "there is no capability 'wings'; they are: exact_copy, joints"),
    ("duration: 0.1", "duration: 0.1\ncommands: [{at: 0, axis: hip, torque: 1}]", "there is no axis 'hip'"),
];

#[test]
fn a_wrong_case_is_refused_with_its_line() {
    for (from, to, told) in WRONG {
        assert!(GOOD.contains(from), "{from}");
        let (code, said, error) = run(&GOOD.replacen(from, to, 1), &["--engine", "rbx"]);
        assert!(code == Some(2) && said.is_empty(), "{to}: {code:?} {said}");
        assert!(error.contains("fall.yaml") && error.contains(told), "{to}: {error}");
    }
}

#[test]
fn wrong_arguments_are_refused() {
    let (code, _, error) = run(GOOD, &["--engine", "newton"]);
    assert!(code == Some(2) && error.contains("'newton' does not exist"), "{error}");
    let output = engines(&["--cases", "/nowhere"]);
    assert_eq!(output.status.code(), Some(2));
    let empty = TempDir::new().unwrap();
    let output = engines(&["--cases", empty.path().to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("there is no case in it"));
    assert_eq!(engines(&["--engine", "rbx"]).status.code(), Some(2));
}

/// docs/conformance.md is complete: every quantity and part, and every key.
#[test]
fn the_format_is_documented() {
    let text = fs::read_to_string("docs/conformance.md").unwrap();
    let help = String::from_utf8(engines(&["--help"]).stdout).unwrap();
    let listed = help.split("Quantities of case files").nth(1).unwrap();
    let quantities: Vec<&str> =
        listed.lines().filter(|l| l.starts_with("  ")).filter_map(|l| l.split_whitespace().next()).collect();
    assert!(quantities.len() > 15, "{help}");
    let keys = fs::read_to_string("src/cli/conformance/file.rs").unwrap();
    let keys: Vec<&str> =
        keys.lines().filter_map(|l| l.trim().strip_prefix("pub ")?.split_once(':')).map(|(k, _)| k).collect();
    assert!(keys.len() > 20, "{keys:?}");
    for word in quantities.iter().chain(&keys) {
        assert!(text.contains(&format!("`{word}`")), "docs/conformance.md does not tell of `{word}`");
    }
}
