//! `realnoid compare`, as a user calls it: differences that theory knows, a tip that another program has computed, wrong arguments.
#![allow(clippy::unwrap_used)] // a test may panic

use realnoid::math::Vec3;
use realnoid::world::EngineKind;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

const G: f64 = 9.80665;
/// Centre of mass of the last link of the chain after 2 s: MuJoCo's RK4 at 0.05 ms (facts A7).
const TIP: [f64; 3] = [0.305_835_067_9, 0.0, -1.763_134_268_5];
/// A ball at a height that it does not fall down from in a second.
const BALL: &str =
    "version: 1\nbodies:\n  - {name: ball, mass: 2, shape: {sphere: {radius: 0.1}}, pose: [0, 0, 9, 0, 0, 0, 1]}\n";

fn realnoid(command: &str, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_realnoid")).arg(command).args(arguments).output().unwrap()
}

/// What `compare` says of a scene as JSON; without the engine in single precision, for which these tolerances are not.
fn compared(arguments: &[&str]) -> Value {
    let mut all = arguments.to_vec();
    if !arguments.contains(&"--engine") {
        engines().into_iter().for_each(|engine| all.extend(["--engine", engine]));
    }
    parsed(&all)
}

/// The same with the engines that are named, else its own choice.
fn parsed(arguments: &[&str]) -> Value {
    let all: Vec<&str> = arguments.iter().copied().chain(["--json"]).collect();
    let output = realnoid("compare", &all);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn written(folder: &TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn run<'a>(all: &'a Value, name: &str) -> &'a Value {
    all["runs"].as_array().unwrap().iter().find(|run| run["name"] == name).unwrap_or_else(|| panic!("no run {name}"))
}

fn names(all: &Value) -> Vec<&str> {
    all["runs"].as_array().unwrap().iter().map(|run| run["name"].as_str().unwrap()).collect()
}

fn engines() -> Vec<&'static str> {
    EngineKind::built().filter(|e| *e != EngineKind::Physx).map(EngineKind::name).collect()
}

/// The longest step in which an engine moves bodies with the velocity at its end, s, for steps of `h` with `substeps` of rapier.
fn explicit_step(engine: &str, h: f64, substeps: f64) -> f64 {
    if engine == "rapier" { h / substeps } else { 0.0 }
}

/// A number of the output. serde_json reads some one unit in the last place beside what is written.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 2.0 * f64::EPSILON * b.abs()
}

/// Semi-implicit Euler is g t δ/2 below the parabola; Bullet's leapfrog and rbx are on it. The velocity is the same.
#[test]
fn free_fall_parts_as_theory_says() {
    let folder = TempDir::new().unwrap();
    let scene = written(&folder, "ball.yaml", BALL);
    let all = compared(&["--scene", &scene, "--duration", "1", "--within", "5e-5"]);
    let z = |run: &Value| run["links"]["ball"][2].as_f64().unwrap();
    let expected: Vec<&str> = ["reference", "reference/2"].into_iter().chain(engines()).collect();
    assert_eq!(names(&all), expected);
    assert!((z(run(&all, "reference")) - (9.0 - 0.5 * G)).abs() < 1e-9);
    for engine in engines() {
        let d = &run(&all, engine)["differences"];
        let rate = 0.5 * G * explicit_step(engine, 2e-4, 10.0);
        for (what, theory) in [("final", rate), ("greatest", rate)] {
            let value = d["positions"][what]["value"].as_f64().unwrap();
            assert!((value - theory).abs() <= 1e-3 * theory + 1e-9, "{engine} {what}: {value} {theory}");
        }
        // m g of it is missing.
        let energy = d["energy"].as_f64().unwrap();
        assert!((energy - 2.0 * G * rate).abs() <= 2e-3 * G * rate + 1e-7, "{engine}: {energy} J");
        assert!(d["momentum"]["linear"].as_f64().unwrap() < 2e-9 && d["axes"].is_null(), "{engine}: {d}");
        match &d["positions"]["beyond"] {
            Value::Null => assert!(rate < 5e-5, "{engine}"),
            beyond => {
                // The first millisecond after.
                let at = beyond["at"].as_f64().unwrap();
                assert!(at > 5e-5 / rate && at <= 5e-5 / rate + 1e-3 && beyond["of"] == "ball", "{engine}: {beyond}");
            }
        }
    }
}

#[test]
fn the_chain_ends_where_the_reference_does() {
    let all = compared(&["--scene", "tests/engines/chain.yaml", "--duration", "2"]);
    for run in all["runs"].as_array().unwrap() {
        let p: Vec<f64> = run["links"]["link10"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let q = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(p[6], p[3], p[4], p[5]));
        let error = (Vec3::new(p[0], p[1], p[2]) + q * Vec3::new(0.1, 0.0, 0.0) - Vec3::from(TIP)).norm();
        let (rbx, name) = (run["engine"] == "rbx", &run["name"]);
        assert!(error < if rbx { 1e-6 } else { 1e-3 }, "{name}: {error}");
        let drift = run["joint_drift"].as_f64().unwrap();
        assert!(if rbx { drift == 0.0 } else { drift > 0.0 && drift < 1e-4 }, "{name}: {drift}");
        assert!(run["cpu_per_second"].as_f64().unwrap() > 0.0 && run["momentum"].is_null());
    }
    // RK4 is of fourth order: what the reference is off by is nothing beside what its 64 times longer steps are.
    let [fine, coarse] = ["reference/2", "rbx"]
        .map(|name| run(&all, name)["differences"]["axes"]["greatest"]["value"].as_f64().unwrap());
    assert!(fine < coarse / 64.0, "{fine} {coarse}");
    assert_eq!(run(&all, "reference")["steps"], 2000 * 4 * 64);
    assert_eq!(run(&all, "rapier")["not_honoured"][0]["item"], "integrator rk4");
}

/// The reference is what `simulate` makes with so many steps, to the last digit; every run follows the script.
#[test]
fn the_reference_is_a_run_of_rbx_under_the_same_script() {
    let folder = TempDir::new().unwrap();
    let script =
        "- {at: 0.01, axis: hip, mode: torque, torque: 1}\n- {at: 0.05, axis: knee, mode: torque, torque: -0.5}\n";
    let script = written(&folder, "script.yaml", script);
    let csv = folder.path().join("fine.csv");
    let common = ["tests/python/arm.urdf", "--duration", "0.1", "--set", "ankle=0.3", "--script", &script];
    let fine = ["--steps", "320", "--integrator", "rk4", "--out", csv.to_str().unwrap()];
    assert!(realnoid("simulate", &[&common[..], &fine].concat()).status.success());
    let text = fs::read_to_string(&csv).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let (head, last) = (cells(text.lines().next().unwrap()), cells(text.lines().last().unwrap()));
    let all = compared(&common);
    for axis in ["hip", "knee", "ankle"] {
        let column = head.iter().position(|h| *h == format!("{axis}.position")).unwrap();
        let position: f64 = last[column].parse().unwrap();
        assert!(same(run(&all, "reference")["axes"][axis].as_f64().unwrap(), position), "{axis}");
        assert!(position != 0.0);
        for engine in engines() {
            let x = run(&all, engine)["axes"][axis].as_f64().unwrap();
            assert!((x - position).abs() < 0.02 * position.abs() + 1e-4, "{engine} {axis}: {x} {position}");
        }
    }
    // 64 times 32 steps do not fit into an interval; the reference divides it, and the script stays on time.
    let more = compared(&[&common[..], &["--steps", "32"]].concat());
    assert_eq!(run(&more, "reference")["steps"], 100 * 32 * 64);
    for axis in ["hip", "knee", "ankle"] {
        let [a, b] = [&all, &more].map(|all| run(all, "reference")["axes"][axis].as_f64().unwrap());
        assert!((a - b).abs() < 1e-9, "{axis}: {a} {b}");
    }
}

#[test]
fn what_an_engine_does_not_honour_is_told() {
    let folder = TempDir::new().unwrap();
    let inertial = "<inertial><origin xyz='0.1 0 0'/><mass value='1'/>\
                    <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>";
    let joint = |name: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='0.2 0 0'/><axis xyz='0 1 0'/>{more}</joint>"
        )
    };
    let (lead, follow) = (joint("lead", "base", "a", ""), joint("follow", "a", "b", "<mimic joint='lead'/>"));
    let text = format!(
        "<robot name='pair'><link name='base'/><link name='a'>{inertial}</link><link name='b'>{inertial}</link>{lead}{follow}</robot>"
    );
    let urdf = written(&folder, "pair.urdf", &text);
    let all = compared(&[&urdf, "--duration", "0.5", "--engine", "rapier"]);
    assert_eq!(names(&all), ["reference", "reference/2", "rapier"]);
    let rapier = run(&all, "rapier");
    let mimic = &rapier["not_honoured"][0];
    assert_eq!((&mimic["item"], &mimic["element"]), (&"<mimic>".into(), &"joint 'follow'".into()));
    assert!(
        rapier["differences"]["axes"]["beyond"]["of"] == "follow"
            || rapier["differences"]["axes"]["beyond"]["of"] == "lead"
    );
    let table = realnoid("compare", &[&urdf, "--duration", "0.5", "--engine", "rapier"]).stdout;
    let table = String::from_utf8(table).unwrap();
    assert!(table.contains("\nrapier\n  not honoured: <mimic> of joint 'follow': it moves by itself\n"), "{table}");
}

#[test]
fn files_have_every_run_over_time() {
    let folder = TempDir::new().unwrap();
    let scene = written(&folder, "ball.yaml", BALL);
    let [csv, svg] = ["run.csv", "run.svg"].map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let all = compared(&["--scene", &scene, "--duration", "0.5", "--every", "0.01", "--csv", &csv, "--svg", &svg]);
    let text = fs::read_to_string(&csv).unwrap();
    let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!((rows.len(), head.len()), (51, 1 + 13 * names(&all).len()));
    assert!(
        rows.iter().enumerate().all(|(i, row)| row.len() == head.len() && (row[0] - 0.01 * i as f64).abs() < 1e-12)
    );
    for name in names(&all).into_iter().skip(1) {
        let at = |column: &str| rows[50][head.iter().position(|h| *h == format!("{name}.{column}")).unwrap()];
        let run = run(&all, name);
        let last = &run["differences"]["positions"]["final"]["value"];
        assert!(same(last.as_f64().unwrap(), at("positions")), "{name}");
        assert!(same(run["energy"].as_f64().unwrap(), at("energy")), "{name}");
        assert!((at("pz") + 2.0 * G * 0.5).abs() < 1e-8, "{name}: {}", at("pz"));
    }
    picture(&fs::read_to_string(&svg).unwrap(), &names(&all)[1..]);
}

/// Every run has its name in the legend and a line that is not empty where theory says it parts; axes have decades and seconds.
fn picture(svg: &str, runs: &[&str]) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts: Vec<&str> =
        document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).map(str::trim).collect();
    for wanted in runs.iter().copied().chain(["time, s", "within 0.001", "1e-4", "0.5"]) {
        assert!(texts.contains(&wanted), "{wanted} is not in the picture: {texts:?}");
    }
    let lines = document.descendants().filter(|n| n.has_tag_name("polyline"));
    let long = lines.filter(|n| n.attribute("points").is_some_and(|p| p.split(' ').count() > 40)).count();
    // Positions and energy of rapier at least.
    assert!(long >= 2, "{long} lines");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn wrong_arguments_are_refused_with_the_reason() {
    let arm = "tests/python/arm.urdf";
    let cases: [(&[&str], i32, &str); 9] = [
        (&[arm, "--duration", "1", "--engine", "ode"], 2, "--engine: engine 'ode' does not exist; choose one of: rbx"),
        (&[arm, "--duration", "1", "--engine", "rbx", "--engine", "rbx"], 2, "--engine rbx is given twice"),
        (&[arm, "--duration", "1", "--within", "0"], 2, "--within 0: must be a finite number above 0"),
        (&[arm, "--duration", "1", "--within", "NaN"], 2, "--within NaN"),
        (&[arm, "--duration", "-1"], 2, "--duration -1"),
        (&[arm, "--duration", "1", "--every", "0.0015"], 2, "--every 0.0015"),
        (&["no.urdf", "--duration", "1"], 1, "no.urdf"),
        (
            &[arm, "--duration", "0.1", "--csv", "/no/such/folder/run.csv"],
            1,
            "--csv /no/such/folder/run.csv: cannot write",
        ),
        (
            &[arm, "--duration", "0.1", "--svg", "/no/such/folder/run.svg"],
            1,
            "--svg /no/such/folder/run.svg: cannot write",
        ),
    ];
    for (arguments, code, reason) in cases {
        let output = realnoid("compare", arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(reason) && output.stdout.is_empty(), "{arguments:?}: {said}");
    }
    assert!(!Path::new("run.csv").exists());
}

#[test]
fn no_time_at_all_is_no_difference() {
    let all = compared(&["tests/python/arm.urdf", "--duration", "0"]);
    for run in all["runs"].as_array().unwrap().iter().skip(1) {
        assert!(run["cpu_per_second"].is_null());
        for kind in ["axes", "positions", "orientations"] {
            let greatest = run["differences"][kind]["greatest"]["value"].as_f64().unwrap();
            assert!(greatest < 1e-12, "{kind}: {greatest}");
        }
    }
}

/// Two hinges at 45° with no mass between them: rbx and rapier take them, Bullet does not.
#[cfg(feature = "bullet")]
#[test]
fn an_engine_that_cannot_take_the_scene_is_left_out_and_told() {
    let folder = TempDir::new().unwrap();
    let joint = |name: &str, parent: &str, child: &str, axis: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/><axis xyz='{axis}'/></joint>"
        )
    };
    let arm = "<inertial><origin xyz='0.1 0 0.1'/><mass value='1'/>\
               <inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>";
    let (first, second) = (joint("first", "base", "a", "0 1 0"), joint("second", "a", "b", "0 0.70710678 0.70710678"));
    let text = format!(
        "<robot name='skew'><link name='base'/><link name='a'/><link name='b'>{arm}</link>{first}{second}</robot>"
    );
    let urdf = written(&folder, "skew.urdf", &text);
    let all = parsed(&[&urdf, "--duration", "0.01"]);
    assert_eq!(names(&all)[2..], ["rbx", "rapier"]);
    let said: Vec<&str> = all["warnings"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(said.iter().any(|w| w.starts_with("left out: bullet: ")), "{said:?}");
    let physx = said.iter().any(|w| w.starts_with("left out: physx, which has no joints"));
    assert_eq!(physx, EngineKind::Physx.available().is_ok(), "{said:?}");
    let named = realnoid("compare", &[&urdf, "--duration", "0.01", "--engine", "bullet"]);
    assert_eq!(named.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&named.stderr).contains("error: bullet: "));
}
