//! What a bag holds beside the messages of a node, so that the run can be made again: commands in force, settings, orders.

use super::messages::{Header, Time};
use crate::world::{AxisCommand, Mode, Snapshot};
use fnv::FnvHasher;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::hash::Hasher;
use std::io::Read;
use std::path::{Path, PathBuf};

/// realnoid/AxisCommands.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AxisCommands<S> {
    /// Simulated time.
    pub header: S,
    /// Control intervals since the start or the last reset of time.
    pub interval: u64,
    /// Per axis; this array and the others are empty if nothing has changed since the message before.
    pub mode: Vec<u8>,
    /// Per axis, N·m or N.
    pub torque: Vec<f64>,
    /// Per axis, rad/s or m/s.
    pub speed: Vec<f64>,
    /// Per axis, rad or m.
    pub target: Vec<f64>,
}

const IDLE: u8 = 0;
const TORQUE: u8 = 1;
const SERVO: u8 = 2;

impl<S> AxisCommands<S> {
    /// The commands `of` (none: as before).
    pub fn new(header: S, interval: u64, of: &[AxisCommand]) -> Self {
        let mode = |c: &AxisCommand| match c.mode {
            Mode::Idle => IDLE,
            Mode::Torque => TORQUE,
            Mode::Servo => SERVO,
        };
        Self {
            header,
            interval,
            mode: of.iter().map(mode).collect(),
            torque: of.iter().map(|c| c.torque).collect(),
            speed: of.iter().map(|c| c.speed).collect(),
            target: of.iter().map(|c| c.target).collect(),
        }
    }

    /// The commands, if there are any.
    ///
    /// # Errors
    /// Arrays of different lengths, or a mode that does not exist.
    pub fn commands(&self) -> Result<Vec<AxisCommand>, String> {
        let n = self.mode.len();
        if [self.torque.len(), self.speed.len(), self.target.len()] != [n; 3] {
            return Err("the arrays of axis_commands differ in length".into());
        }
        let command = |i: usize| {
            let mode = match self.mode[i] {
                IDLE => Mode::Idle,
                TORQUE => Mode::Torque,
                SERVO => Mode::Servo,
                other => return Err(format!("axis_commands have mode {other}, which does not exist")),
            };
            Ok(AxisCommand { mode, torque: self.torque[i], speed: self.speed[i], target: self.target[i] })
        };
        (0..n).map(command).collect()
    }
}

/// realnoid/WorldEvent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorldEvent<S, T> {
    /// Simulated time.
    pub header: S,
    /// Control intervals before it.
    pub interval: u64,
    /// [`START`], [`SETTINGS`], [`LOST`], or the name of an order.
    pub kind: T,
    /// JSON.
    pub data: T,
}

/// The first event of a bag: [`Beginning`].
pub const START: &str = "start";
/// Settings from here on: [`crate::world::Settings`].
pub const SETTINGS: &str = "settings";
/// Something is missing from here on: [`Lost`].
pub const LOST: &str = "lost";

/// A header with borrowed words.
pub fn header(stamp_ns: i64) -> Header<'static> {
    Header { stamp: Time::from_ns(stamp_ns), frame_id: "" }
}

/// What is missing in a bag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lost {
    /// Messages that could not be written fast enough.
    pub messages: u64,
    /// Control intervals whose state was overwritten before anybody had looked at it.
    pub snapshots: u64,
}

/// Where the world of a run comes from: enough to make it again.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// URDF file; none: that of the scene, or the embedded humanoid.
    pub urdf: Option<PathBuf>,
    /// Names and folders of packages.
    pub packages: Vec<(String, PathBuf)>,
    /// Scene file.
    pub scene: Option<PathBuf>,
    /// The flat ground was asked for.
    pub ground: bool,
    /// fixed or free.
    pub base: String,
    /// The engine at start.
    pub engine: String,
    /// Effects that parameters switched.
    #[serde(default)]
    pub effects: Vec<Switched>,
    /// The text files that were read, by absolute path.
    pub texts: BTreeMap<PathBuf, String>,
    /// The mesh files that were read, with [`file_digest`], where that was asked for.
    pub meshes: BTreeMap<PathBuf, Option<String>>,
}

/// An effect that a parameter switched.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Switched {
    /// Name of the parameter.
    pub parameter: String,
    /// Name of the effect.
    pub effect: String,
    /// On or off.
    pub on: bool,
}

/// The data of the event [`START`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Beginning {
    /// Who recorded.
    pub program: Program,
    /// What was simulated.
    pub origin: Origin,
    /// Of the model that was made of it.
    pub model: String,
    /// The bag begins with the run; else it begins in the middle of it.
    pub from_start: bool,
    /// Parameters of the node at its start, as YAML would write them.
    pub parameters: BTreeMap<String, String>,
}

/// A program, as far as its bits depend on it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Of realnoid.
    pub version: String,
    /// Architecture and operating system.
    pub target: String,
    /// Engines built in.
    pub engines: Vec<String>,
    /// Features of the CPU that the libraries choose code by.
    pub cpu: Vec<String>,
}

impl Program {
    /// This one.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            target: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
            engines: crate::world::EngineKind::built().map(|e| e.name().to_owned()).collect(),
            cpu: cpu(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn cpu() -> Vec<String> {
    let features = [
        ("sse4.2", is_x86_feature_detected!("sse4.2")),
        ("avx", is_x86_feature_detected!("avx")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ];
    features.iter().filter(|(_, there)| *there).map(|(name, _)| (*name).to_owned()).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn cpu() -> Vec<String> {
    vec![]
}

/// A digest of everything that `value` shows when it is debugged (numbers with all their digits), as 16 hexadecimal digits.
pub fn digest(value: &impl std::fmt::Debug) -> String {
    struct Fnv(FnvHasher);
    impl Write for Fnv {
        fn write_str(&mut self, s: &str) -> std::fmt::Result {
            self.0.write(s.as_bytes());
            Ok(())
        }
    }
    let mut hash = Fnv(FnvHasher::default());
    // Hashing cannot fail.
    let _ = write!(hash, "{value:?}");
    format!("{:016x}", hash.0.finish())
}

/// FNV-1a over the bytes of a file, as 16 hexadecimal digits; `None` if it cannot be read.
pub fn file_digest(file: &Path) -> Option<String> {
    let mut hash = FnvHasher::default();
    let mut input = std::fs::File::open(file).ok()?;
    let mut part = vec![0; 1 << 16];
    loop {
        match input.read(&mut part).ok()? {
            0 => return Some(format!("{:016x}", hash.finish())),
            n => hash.write(&part[..n]),
        }
    }
}

/// FNV-1a over the bits of a state: interval, stamp, positions, speeds and efforts of the axes, pose, twist and contact wrench of
/// each link, energies.
pub fn state_digest(s: &Snapshot) -> u64 {
    let mut hash = FnvHasher::default();
    hash.write(&s.interval.to_le_bytes());
    hash.write(&s.stamp_ns.to_le_bytes());
    let axes = s.position.iter().chain(&s.velocity).chain(&s.effort);
    let poses = s.link_pose.iter().flat_map(|p| p.translation.vector.iter().chain(p.rotation.coords.iter()));
    let twists = s.link_twist.iter().flat_map(|t| t.angular.iter().chain(t.linear.iter()));
    let wrenches = s.link_wrench.iter().flat_map(|w| w.force.iter().chain(w.torque.iter()));
    let energies = [s.kinetic_energy, s.potential_energy];
    for x in axes.chain(poses).chain(twists).chain(wrenches).chain(&energies) {
        hash.write(&x.to_bits().to_le_bytes());
    }
    hash.finish()
}

/// Do two sets of commands have the same bits?
pub fn same_commands(a: &[AxisCommand], b: &[AxisCommand]) -> bool {
    let bits = |c: &AxisCommand| (c.mode, [c.torque, c.speed, c.target].map(f64::to_bits));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
}
