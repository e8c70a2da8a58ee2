//! `realnoid accuracy`: orders of the rules, files, and the page in docs.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::cli::accuracy::{
    COLUMNS, Care, Case, G, IMAGES, Ladder, Measured, Truth, Wish, bounce, cases, csv, diagram, summary,
};
use realnoid::world::{Integrator, Settings};
use std::path::Path;
use std::process::Command;

const QUICK: Care = Care { seconds: 0.0, quick: true };

fn case(name: &str) -> Case {
    cases().into_iter().find(|c| c.name == name).unwrap()
}

/// No curves: just the reference.
fn nobody() -> Wish {
    Wish::new(&["rbx".to_owned()], &["rk4".to_owned()], (&[0.008], true)).unwrap()
}

fn of_rbx(name: &str, integrators: &[&str], dt: &[f64]) -> Measured {
    let names = |list: &[&str]| -> Vec<String> { list.iter().map(|s| (*s).to_owned()).collect() };
    let wish = Wish::new(&names(&["rbx"]), &names(integrators), (dt, true)).unwrap();
    Measured::of(case(name), &wish, QUICK).unwrap()
}

/// Euler 1, midpoint 2, RK4 4, fitted in the asymptotic range: within 0.2. Against a closed form, and against our own fine run.
#[test]
fn rules_have_their_orders() {
    for (name, dt) in [("torque_free", [0.004, 0.002, 0.001, 0.0005]), ("chain5", [0.002, 0.001, 0.0005, 0.00025])] {
        let m = of_rbx(name, &["semi_implicit_euler", "implicit_midpoint", "rk4"], &dt);
        for (curve, order) in m.curves.iter().zip([1.0, 2.0, 4.0]) {
            let fit = curve.fit(m.case.size, m.reference.own).unwrap();
            assert!((fit.order - order).abs() < 0.2, "{name}, {}: {fit:?}", curve.label);
        }
    }
}

/// Numbers of twice the digits, and rbx with 128 steps of RK4 in a millisecond: two programs of one motion, as long as it is not chaotic.
#[test]
fn references_of_two_kinds_agree() {
    let twofold = Measured::of(case("chain5"), &nobody(), QUICK).unwrap().reference;
    let truth = Truth::Own { integrator: Integrator::Rk4, steps_per_ms: 128 };
    let own =
        Measured::of(Case { truth, ..case("chain5") }, &nobody(), Care { quick: false, ..QUICK }).unwrap().reference;
    assert!(twofold.own < 1e-14 && twofold.words.contains("twice the digits"), "{}, {}", twofold.own, twofold.words);
    for (k, (a, b)) in twofold.values.iter().zip(&own.values).enumerate() {
        assert!(case("chain5").distance(a, b) < 1e-12, "after {} instants: {a:?} {b:?}", k + 1);
    }
}

/// A finer accuracy is never much worse, and 1e-9 is better than 1e-6 m at the end of two chaotic seconds.
#[test]
fn extrapolation_is_a_ladder_of_accuracies() {
    let m = of_rbx("chain5", &["extrapolation"], &[]);
    let curve = &m.curves[0];
    assert_eq!(curve.ladder, Ladder::Accuracy);
    assert!(curve.runs.windows(2).all(|r| r[1].max < r[0].max), "{:?}", curve.runs);
    assert!(curve.runs.iter().any(|r| r.point.accuracy == 1e-9 && r.max < 1e-6));
}

/// At a relative equilibrium of the rotation and in a stack at rest every rule is exact to rounding: closed forms and start agree.
#[test]
fn closed_forms_agree_with_the_start() {
    for c in cases() {
        let Truth::Closed { value, .. } = &c.truth else { continue };
        let world = (c.make)().unwrap();
        let seats = c.seats(world.model()).unwrap();
        let now = realnoid::cli::accuracy::sample(&world.new_snapshot(), &seats);
        assert!(c.distance(&now, &value(&[0.0])[0]) < 1e-12, "{}", c.name);
    }
}

#[test]
fn a_quick_run_makes_files_with_all_fields() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| Command::new(env!("CARGO_BIN_EXE_realnoid")).arg("accuracy").args(args).output().unwrap();
    let out = run(&["sliding", "--quick", "--engines", "rbx", "--out", folder.path().to_str().unwrap()]);
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = std::fs::read_to_string(folder.path().join("accuracy.csv")).unwrap();
    let mut rows = ::csv::Reader::from_reader(text.as_bytes());
    assert_eq!(rows.headers().unwrap().iter().collect::<Vec<_>>(), COLUMNS);
    // Three steps of three integrators, three accuracies, and iterations 1 and 10.
    let rows: Vec<::csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 14);
    let at = |name: &str| COLUMNS.iter().position(|c| *c == name).unwrap();
    for row in &rows {
        assert!(row[at("rms")].parse::<f64>().unwrap() <= row[at("max")].parse::<f64>().unwrap());
        assert!(row[at("cpu_per_second")].parse::<f64>().unwrap() > 0.0);
    }
    for name in ["sliding", "summary"] {
        let svg = std::fs::read_to_string(folder.path().join(IMAGES).join(format!("{name}.svg"))).unwrap();
        assert!(roxmltree::Document::parse(&svg).unwrap().descendants().any(|n| n.has_tag_name("polygon")));
    }
    assert!(std::fs::read_to_string(folder.path().join("accuracy.md")).unwrap().contains("## sliding"));
    for (args, told) in [
        (&["nonsense"][..], "case 'nonsense' does not exist; choose from: chain5"),
        (&["sliding", "--dt", "0.003"], "--dt 0.003: must be a step in s"),
        (&["sliding", "--engines", "nonsense"], "engine 'nonsense' does not exist"),
        (&["sliding", "--integrators", "nonsense"], "integrator 'nonsense' does not exist"),
        (&["sliding", "--seconds", "-1"], "--seconds -1: must be"),
    ] {
        let out = run(args);
        assert!(
            out.status.code() == Some(2) && String::from_utf8_lossy(&out.stderr).contains(told),
            "{args:?}: {out:?}"
        );
    }
    let list = String::from_utf8(run(&["--list"]).stdout).unwrap();
    assert!(cases().iter().all(|c| list.contains(c.name) && list.contains(c.shows)));
}

/// Without Python the command says what is missing.
#[test]
fn a_peer_that_cannot_be_had_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_realnoid"));
    command.args(["accuracy", "sliding", "--quick", "--engines", "rbx", "--peer", "mujoco"]);
    let out = command.current_dir(&folder).env("PYTHON", "no_such_python").output().unwrap();
    let told = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.code() == Some(1) && told.contains("--peer mujoco") && told.contains("set PYTHON"), "{told}");
}

#[test]
fn the_page_has_every_case_with_its_diagram() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let page = std::fs::read_to_string(docs.join("accuracy.md")).unwrap();
    let names: Vec<&str> = cases().iter().map(|c| c.name).collect();
    for name in &names {
        assert!(page.contains(&format!("\n## {name}\n")), "{name}");
    }
    for name in names.into_iter().chain(["summary"]) {
        let svg = std::fs::read_to_string(docs.join(IMAGES).join(format!("{name}.svg"))).unwrap();
        assert!(roxmltree::Document::parse(&svg).is_ok() && page.contains(&format!("{IMAGES}/{name}.svg")), "{name}");
    }
}

/// Diverged, exact and missing values have a place in a diagram.
#[test]
fn odd_values_can_be_drawn() {
    let mut m = of_rbx("sliding", &["implicit_midpoint"], &[0.004, 0.002, 0.001]);
    let runs = &mut m.curves[0].runs;
    (runs[0].rms, runs[0].max, runs[0].diverged) = (f64::NAN, f64::NAN, true);
    (runs[1].rms, runs[1].max) = (0.0, 0.0);
    assert!(roxmltree::Document::parse(&diagram(&m).unwrap()).is_ok());
    let all = [m];
    assert!(roxmltree::Document::parse(&summary(&all).unwrap()).is_ok());
    assert!(csv(&all).unwrap().contains("NaN"));
}

/// A blow is found in ever shorter pieces; however short, none is lost. What is nearer than 1e-8 m counts as closed: at 2 m/s the ball may bounce
/// 5e-9 s too soon, three times and a half until it is at rest.
#[test]
fn a_bounce_is_not_lost_at_any_accuracy() {
    for digits in 3..=12 {
        let mut w = (case("bounce").make)().unwrap();
        let (interval, accuracy) = (10_000_000, 10.0_f64.powi(-digits));
        let settings = Settings { control_interval_ns: interval, steps_per_interval: 1, accuracy, ..*w.settings() };
        w.set_settings(Settings { integrator: Integrator::Extrapolation, ..settings }).unwrap();
        let radius = w.state().q[2] - 0.2;
        for k in 1..=80 {
            w.advance();
            let error = w.state().q[2] - radius - bounce(0.2, 0.5, G, f64::from(k) * 0.01);
            assert!(error.abs() < 1e-7, "1e-{digits}, {k}: {error:e}");
        }
    }
}
