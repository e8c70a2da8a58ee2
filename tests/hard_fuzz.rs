//! Whole scenes drawn at random: a robot of links over nine orders of magnitude with any drives, free or fixed, bodies, a ground, commands that
//! jump, any integrator and step. Nothing is not finite, and no energy comes out of nothing in silence. A failure becomes a case of tests/hard.
//! More of them: PROPTEST_CASES=2000 cargo nextest run --release --test hard_fuzz
#![allow(clippy::unwrap_used)] // a test may panic

use proptest::prelude::*;
use realnoid::cli::conformance::{Case, Outcome, Rung};
use realnoid::world::{EngineKind, Integrator};
use std::fmt::Write;

/// Control intervals of 10 ms: times of commands and of the end fit every step.
const DURATION: f64 = 0.5;
const STEPS_NS: [i64; 5] = [10_000_000, 5_000_000, 2_000_000, 1_000_000, 500_000];

#[derive(Clone, Debug)]
struct Link {
    parent: usize,
    kind: u8,
    axis: u8,
    /// Powers of ten: kg, m, and of the inertia against that of a rod.
    mass: f64,
    length: f64,
    inertia: f64,
    stops: bool,
    damping: Option<f64>,
    friction: Option<f64>,
    drive: u8,
    strength: f64,
    bandwidth: f64,
    rotor: Option<f64>,
}

#[derive(Clone, Debug)]
struct Drawn {
    links: Vec<Link>,
    free: bool,
    ground: bool,
    gravity: bool,
    bodies: Vec<(u8, f64, f64)>,
    commands: Vec<(u8, u8, f64)>,
    speed: f64,
    integrator: usize,
    step: usize,
}

fn link() -> impl Strategy<Value = Link> {
    let shape = (0..8usize, 0..3u8, 0..3u8, -6.0..3.0f64, -2.0..0.0f64, -3.0..1.0f64);
    let law = (any::<bool>(), prop::option::of(-3.0..6.0f64), prop::option::of(-3.0..3.0f64));
    let drive = (0..3u8, -3.0..4.0f64, -1.0..3.0f64, prop::option::weighted(0.2, -6.0..1.0f64));
    (shape, law, drive).prop_map(|(s, l, d)| Link {
        parent: s.0,
        kind: s.1,
        axis: s.2,
        mass: s.3,
        length: s.4,
        inertia: s.5,
        stops: l.0,
        damping: l.1.filter(|_| s.0 % 3 == 0),
        friction: l.2.filter(|_| s.0 % 2 == 0),
        drive: d.0,
        strength: d.1,
        bandwidth: d.2,
        rotor: d.3,
    })
}

fn drawn() -> impl Strategy<Value = Drawn> {
    let body = (0..3u8, -2.0..3.0f64, 0.0..1.0f64);
    let command = (0..8u8, 0..3u8, -1.0..1.0f64);
    let parts =
        (prop::collection::vec(link(), 1..8), prop::collection::vec(body, 0..3), prop::collection::vec(command, 0..8));
    let world =
        (any::<bool>(), any::<bool>(), any::<bool>(), -2.0..2.0f64, 0..Integrator::NAMES.len(), 0..STEPS_NS.len());
    (parts, world).prop_map(|((links, bodies, commands), w)| Drawn {
        links,
        bodies,
        commands,
        free: w.0,
        ground: w.1,
        gravity: w.2,
        speed: w.3,
        integrator: w.4,
        step: w.5,
    })
}

impl Link {
    fn moment(&self) -> f64 {
        10f64.powf(self.mass + 2.0 * self.length + self.inertia) / 12.0
    }

    fn urdf(&self, i: usize) -> String {
        let (mass, length, moment) = (10f64.powf(self.mass), 10f64.powf(self.length), self.moment());
        let parent = if i == 0 { "base".to_owned() } else { format!("link{}", self.parent % i) };
        let kind = ["revolute", "continuous", "prismatic"][usize::from(self.kind)];
        let axis = ["1 0 0", "0 1 0", "0 0 1"][usize::from(self.axis)];
        let limit = match (self.kind, self.stops) {
            (1, _) => String::new(),
            (_, stops) => {
                let range = if stops { 0.3 } else { 3.0 };
                format!("<limit lower=\"-{range}\" upper=\"{range}\" effort=\"1e4\" velocity=\"1000\"/>")
            }
        };
        let dynamics = self.damping.map_or(String::new(), |d| format!("<dynamics damping=\"{:e}\"/>", 10f64.powf(d)));
        let friction = self.friction.map_or(0.0, |f| 10f64.powf(f));
        let rotor = self.rotor.map_or(0.0, |r| 10f64.powf(r));
        let mode = ["idle", "torque", "servo"][usize::from(self.drive)];
        let (strength, bandwidth) = (10f64.powf(self.strength), 10f64.powf(self.bandwidth));
        format!(
            "<link name=\"link{i}\"><inertial><origin xyz=\"{x:e} 0 0\"/><mass value=\"{mass:e}\"/><inertia ixx=\"{moment:e}\" ixy=\"0\" \
             ixz=\"0\" iyy=\"{moment:e}\" iyz=\"0\" izz=\"{moment:e}\"/></inertial><collision><geometry><sphere radius=\"{x:e}\"/></geometry>\
             </collision></link>\n<joint name=\"axis{i}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"link{i}\"/><origin \
             xyz=\"{length:e} 0 0\"/><axis xyz=\"{axis}\"/>{limit}{dynamics}<realnoid><drive mode=\"{mode}\" max_torque=\"{strength:e}\" \
             no_load_speed=\"20\" bandwidth=\"{bandwidth:e}\" dynamic_resistance=\"{friction:e}\" rotor_inertia=\"{rotor:e}\"/></realnoid></joint>\n",
            x = length / 2.0,
        )
    }
}

impl Drawn {
    fn urdf(&self) -> String {
        let base = "<link name=\"base\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/>\
                    </inertial></link>\n";
        let links: String = self.links.iter().enumerate().map(|(i, l)| l.urdf(i)).collect();
        format!("<?xml version=\"1.0\"?>\n<robot name=\"drawn\">\n{base}{links}</robot>\n")
    }

    /// Energy (J) that such a scene may err by: what everything weighs over its reach and 0.5 s of fall, what moves at the start, and what the drives
    /// can give.
    fn scale(&self) -> f64 {
        let reach: f64 = self.links.iter().map(|l| 10f64.powf(l.length)).sum::<f64>() + 2.0;
        let mass: f64 = 1.0 + self.links.iter().map(|l| 10f64.powf(l.mass)).sum::<f64>();
        let bodies: f64 = self.bodies.iter().map(|b| 10f64.powf(b.1)).sum();
        let speed = 10f64.powf(self.speed);
        let moving: f64 = self
            .links
            .iter()
            .map(|l| {
                (10f64.powf(l.mass) * reach * reach + l.moment() + l.rotor.map_or(0.0, |r| 10f64.powf(r)))
                    * speed
                    * speed
            })
            .sum();
        let drives: f64 = self.links.iter().map(|l| 10f64.powf(l.strength) * 20.0 * DURATION).sum();
        (mass + bodies) * 9.81 * (reach + 2.0) + moving * self.links.len() as f64 + drives
    }

    fn case(&self) -> String {
        let mut text = "version: 1\nshows: drawn\nscene:\n  version: 1\n".to_owned();
        if !self.gravity {
            text += "  world: {gravity: [0, 0, 0]}\n";
        }
        let (base, at) = if self.free { ("free", "[0, 0, 1, 0, 0, 0, 1]") } else { ("fixed", "[0, 0, 1, 0, 0, 0, 1]") };
        let _ = writeln!(text, "  robot: {{urdf: drawn.urdf, base: {base}, pose: {at}}}");
        if self.ground {
            text += "  ground: true\n";
        }
        if !self.bodies.is_empty() {
            text += "  bodies:\n";
        }
        for (i, (kind, mass, place)) in self.bodies.iter().enumerate() {
            let shape =
                ["sphere: {radius: 0.1}", "box: {size: [0.2, 0.3, 0.1]}", "capsule: {radius: 0.05, length: 0.2}"]
                    [usize::from(*kind)];
            let (mass, z) = (10f64.powf(*mass), 0.3 + 0.5 * i as f64);
            let _ = writeln!(
                text,
                "    - {{name: body{i}, mass: {mass:e}, shape: {{{shape}}}, pose: [{place}, 0.05, {z}, 0, 0, 0, 1]}}"
            );
        }
        let speeds: Vec<String> =
            (0..self.links.len()).step_by(2).map(|i| format!("axis{i}: {:e}", 10f64.powf(self.speed))).collect();
        let _ = writeln!(text, "speeds: {{{}}}\ncommands:", speeds.join(", "));
        for (k, (axis, mode, size)) in self.commands.iter().enumerate() {
            let axis = usize::from(*axis) % self.links.len();
            let strength = 10f64.powf(self.links[axis].strength) * size;
            let what = match mode {
                0 => "mode: idle".to_owned(),
                1 => format!("mode: torque, torque: {strength:e}, speed: {:e}", 20.0 * size),
                _ => format!("mode: servo, target: {:e}", 0.3 * size),
            };
            let _ = writeln!(text, "  - {{at: {}, axis: axis{axis}, {what}}}", 0.05 * k as f64);
        }
        if self.commands.is_empty() {
            text = text.replace("commands:\n", "");
        }
        let within = self.scale();
        let _ = write!(
            text,
            "duration: {DURATION}\nexpect:\n  - quantity: energy_unaccounted\n    between: [0, {DURATION}]\n    take: greatest\n    is: 0\n    \
             theory: none comes out of nothing\n    within: {{others: {within:e}}}\n    because: all that there is\n"
        );
        text
    }
}

fn told(s: &realnoid::world::Stats) -> bool {
    s.unsettled_steps + s.fast_pieces + s.guarded_pieces + s.tempered_steps > 0
        || s.guarded_energy + s.trimmed_energy > 0.0
}

/// A grain about its own axis may have no inertia that the reader takes for one: such a scene is refused, and says so.
fn refused(why: String) -> TestCaseError {
    if why.contains("error[singular-joint]") { TestCaseError::reject(why) } else { TestCaseError::fail(why) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn any_scene_stays_finite_and_makes_no_energy_in_silence(d in drawn()) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("drawn.urdf"), d.urdf()).unwrap();
        let file = folder.path().join("drawn.yaml");
        std::fs::write(&file, d.case()).unwrap();
        let rung = Rung { integrator: Integrator::NAMES[d.integrator].1, step_ns: STEPS_NS[d.step] };
        let case = Case::read_at(&file, Some(rung)).map_err(refused)?;
        let Outcome::Done(run) = case.run(EngineKind::Rbx) else { return Err(TestCaseError::fail("not run")) };
        prop_assert!(run.stats.diverged_steps == 0, "diverged\n{}\n{}", d.urdf(), d.case());
        let f = run.figures[0];
        prop_assert!(f.error.is_finite(), "not finite\n{}\n{}", d.urdf(), d.case());
        prop_assert!(f.error <= f.allowed || told(&run.stats), "{:e} of {:e}\n{}\n{}", f.error, f.allowed, d.urdf(), d.case());
    }
}
