//! Raw arguments, as they are typed, and how single values are read.

use super::load::Source;
use super::start_args::StartArgs;
use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};

/// Forward dynamics of a life-size humanoid: a ROS 2 node in place of the robot, and tools around it.
///
/// Without a subcommand: `run`, the node. ROS arguments follow `--ros-args` (-p name:=value, -r from:=to,
/// --params-file FILE).
#[derive(Debug, Parser)]
#[command(name = "realnoid", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; `run` if nothing is said.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// Subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The ROS 2 node `forward_dynamics`: simulates in real time until SIGINT or SIGTERM.
    #[command(after_long_help = crate::ros::parameters::help())]
    Run {
        /// URDF file; the embedded humanoid if none is given.
        urdf: Option<PathBuf>,
        /// `--package`.
        #[command(flatten)]
        packages: PackageArgs,
        /// Records everything that the node publishes, and the commands that it gets, into this folder, which must not exist yet:
        /// a bag for rosbag2, and for `realnoid replay`.
        #[arg(long, value_name = "DIR")]
        record: Option<PathBuf>,
    },
    /// Every finding in a URDF with line, column and mend; exit code 1 if one is an error.
    Check {
        /// URDF file; the embedded humanoid if none is given.
        urdf: Option<PathBuf>,
        /// A scene file, checked with the robot in it.
        #[arg(long)]
        scene: Option<PathBuf>,
        /// For this engine: what it does not honour is told. rbx, rapier or bullet; rbx unless the scene says otherwise.
        #[arg(long)]
        engine: Option<String>,
        /// `--package`.
        #[command(flatten)]
        packages: PackageArgs,
    },
    /// Links, masses, inertias, axes, and the effects that the scene calls for.
    Inspect(InspectArgs),
    /// Simulates without ROS, as fast as it goes; a JSON summary to standard output.
    ///
    /// Exit code 0: every value is finite. 1: one is not, the run was stopped by a signal, the robot cannot be loaded or
    /// the output not be written. 2: an argument or the scene is wrong. A run that diverges or is stopped leaves a
    /// complete file.
    Simulate(Box<SimulateArgs>),
    /// The engines side by side on one scene: how far each gets from a run of rbx with steps 64 times finer, and why.
    ///
    /// Exit codes as those of simulate.
    Compare(Box<CompareArgs>),
    /// The engines: which are in this program, what they can, and how near each comes to what theory says of the scenes in case
    /// files.
    ///
    /// Exit code 0: all is within its tolerance, or beyond as the case says. 1: something is not, an engine does not take a scene, or a file
    /// cannot be written. 2: an argument or a case is wrong.
    #[command(after_long_help = crate::cli::conformance::help())]
    Engines(EnginesArgs),
    /// Cases that hurt, with every integrator and engine over steps from 10 to 0.1 ms: what becomes of each, and whether it is told.
    ///
    /// Exit code 0: every run is good, or what it could not do is told. 1: one is wrong in silence or not finite, or a file cannot be
    /// written. 2: an argument or a case is wrong.
    Hard(HardArgs),
    /// Many worlds over ranges of parameters, on all cores: a row for each in a table.
    ///
    /// Rows are written as worlds finish; the same command goes on where an interrupted one has ended. Exit code 0: every world of this
    /// shard has its row (the column status tells how it ended). 1: stopped by a signal, or a file cannot be written. 2: an argument or
    /// the specification is wrong.
    Sweep(SweepArgs),
    /// Makes a recorded run again, with the recorded commands, settings and orders, and compares every state bit for bit.
    ///
    /// Exit code 0: all bits are the same. 1: they are not, or not all could be compared. 2: an argument is wrong, or the bag cannot
    /// be replayed: it begins in the middle of a run, or was not made by realnoid.
    Replay(ReplayArgs),
    /// Completes a bag that was cut off (the process was killed, the disk was full): index, footer and metadata.yaml.
    ///
    /// Exit code 0: the bag is complete. 1: it cannot be completed; it is as it was. 2: there is none.
    Recover {
        /// The folder of a bag, or a .mcap file.
        bag: PathBuf,
    },
    /// What accuracy costs: on cases whose outcome is known, the error of every engine and integrator over steps, beside CPU time.
    ///
    /// Tables on standard output; --out makes a page with diagrams. Exit code 0: all was measured. 1: a case cannot be run, a file not be
    /// written, or the peer not be had. 2: an argument is wrong.
    Accuracy(super::accuracy::AccuracyArgs),
    /// Time per call of kinematics, rnea, crba, aba and step: medians, thread CPU time.
    Bench(BenchArgs),
    /// The price list of a scene: what calls for each effect, what it costs per step in instructions and time, and by how much a run
    /// without it is wrong. Effects that --off names are off from the beginning and have no price.
    Effects(Box<crate::cli::effects::EffectsArgs>),
    /// Forward dynamics of single states, to compare with other programs: one JSON object per line on standard input
    /// `{"position": [..], "velocity": [..], "effort": [..], "base_pose": [x,y,z,qx,qy,qz,qw], "base_twist": [w, v]}`,
    /// per axis in the order of the URDF; one line `{"acceleration": [..], "base_acceleration": [..]}` out for each.
    Evaluate(EvaluateArgs),
}

/// Where packages are that mesh files name.
#[derive(Clone, Debug, Default, Args)]
pub struct PackageArgs {
    /// Folder of a package that mesh files name as package://NAME/…; asked before ROS_PACKAGE_PATH, AMENT_PREFIX_PATH
    /// and the folders around the URDF file. As often as needed.
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    pub packages: Vec<(String, PathBuf)>,
}

impl PackageArgs {
    /// The robot in `urdf` (`None`: the embedded humanoid), with these packages.
    pub fn source<'a>(&'a self, urdf: Option<&'a Path>) -> Source<'a> {
        Source { urdf, packages: &self.packages }
    }
}

fn package(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => Ok((name.to_owned(), folder.into())),
        _ => Err("must be NAME=DIR: --package my_robot=/opt/my_robot".into()),
    }
}

/// `inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// URDF file; the embedded humanoid if none is given.
    pub urdf: Option<PathBuf>,
    /// `--package`.
    #[command(flatten)]
    pub packages: PackageArgs,
    /// A scene file: what stands in the world beside the robot, and what collides.
    #[arg(long)]
    pub scene: Option<PathBuf>,
    /// The flat ground z = 0, where the scene has none of its own.
    #[arg(long)]
    pub ground: bool,
    /// What this engine does not honour of it, and what it calls the shapes that it makes of it; not with --full.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["full", "urdf_with_inertials"])]
    pub engine: Option<String>,
    /// JSON instead of tables.
    #[arg(long)]
    pub json: bool,
    /// Every link's values in full: volume, mass, centre of mass, inertia tensor, principal moments, L scale.
    #[arg(long, conflicts_with = "json")]
    pub full: bool,
    /// Unit of length in what is shown beside SI: m, cm or mm.
    #[arg(long, default_value = "m", value_parser = ["m", "cm", "mm"])]
    pub unit: String,
    /// A drawing of the robot with centres of mass and principal axes.
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// fixed (on a test stand) or free.
    #[arg(long, default_value = "fixed", value_parser = ["fixed", "free"])]
    pub base: String,
    /// The URDF with an exact `<inertial>` in every link whose mass comes from our tag, for tools that do not read it.
    #[arg(long, conflicts_with = "json")]
    pub urdf_with_inertials: bool,
}

/// `bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// URDF file; the embedded humanoid if none is given.
    pub urdf: Option<PathBuf>,
    /// `--package`.
    #[command(flatten)]
    pub packages: PackageArgs,
    /// JSON instead of a table.
    #[arg(long)]
    pub json: bool,
    /// fixed or free.
    #[arg(long, default_value = "free", value_parser = ["fixed", "free"])]
    pub base: String,
    /// CPU time to spend per measured function, s.
    #[arg(long, default_value_t = 0.5)]
    pub seconds: f64,
    /// Instead: steps of 1 ms while the robot, its joints passive, falls onto the flat ground with its root link from this height, m.
    #[arg(long, value_name = "Z")]
    pub drop: Option<f64>,
    /// Steps per fall.
    #[arg(long, default_value_t = 600, requires = "drop", value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: u32,
    /// Falls, of which the fastest is told.
    #[arg(long, default_value_t = 5, requires = "drop", value_parser = clap::value_parser!(u32).range(1..))]
    pub rounds: u32,
}

/// `evaluate`.
#[derive(Debug, Args)]
pub struct EvaluateArgs {
    /// URDF file.
    pub urdf: PathBuf,
    /// `--package`.
    #[command(flatten)]
    pub packages: PackageArgs,
    /// fixed or free.
    #[arg(long, default_value = "fixed", value_parser = ["fixed", "free"])]
    pub base: String,
    /// m/s², world frame.
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,-9.80665", allow_hyphen_values = true)]
    pub gravity: String,
}

/// What is simulated, from which start, under which commands, and for how long.
#[derive(Debug, Default, Args)]
pub struct RunArgs {
    /// Robot, scene and state at start.
    #[command(flatten)]
    pub start: StartArgs,
    /// Simulated time, s; rounded to whole control intervals.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub duration: f64,
    /// s; 0.001 unless the scene says otherwise.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub control_interval: Option<f64>,
    /// Steps per control interval, 1 to 1000; 5 unless the scene says otherwise.
    #[arg(long)]
    pub steps: Option<u32>,
    /// Solver iterations per step, 1 to 10000; 10 unless the scene says otherwise.
    #[arg(long)]
    pub iterations: Option<u32>,
    /// Error per second of the integrator extrapolation, 1e-14 to 1e-2; chooses it, and one step per interval (or --steps).
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub accuracy: Option<f64>,
    /// m/s², world frame; 0,0,-9.80665 unless the scene says otherwise.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub gravity: Option<String>,
    /// Simulated time per control interval against the interval, 0 to 100.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub time_scale: Option<f64>,
    /// Position of an axis at start, set from its root side: what hangs on the axis stays where it is, the base moves.
    #[arg(long, value_name = "AXIS=POSITION")]
    pub turn: Vec<String>,
    /// Commands and drive settings over time (YAML): a list of entries {at: seconds, axis: NAME, …}.
    ///
    /// An entry takes mode (idle, torque, servo), torque, speed, target, max_torque, no_load_speed, static_resistance,
    /// dynamic_resistance, short_brake, bandwidth, rotor_inertia. A mode begins a new command; what an entry does not name stays as it
    /// is. Entries are in the order of time; one inside a control interval takes effect with the next interval.
    #[arg(long, value_name = "FILE.yaml")]
    pub script: Option<PathBuf>,
    /// Switch an effect on.
    #[arg(long, value_name = "EFFECT")]
    pub on: Vec<String>,
}

/// `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// The specification (docs/sweep.md); with --merge, the tables of shards.
    #[arg(required = true, value_name = "SPEC.yaml")]
    pub files: Vec<PathBuf>,
    /// The table; SPEC.csv, or SPEC.shard-I-of-N.csv, in the working folder, if none is named.
    #[arg(long, value_name = "FILE.csv")]
    pub out: Option<PathBuf>,
    /// Threads; one per core, if nothing is said.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub jobs: Option<u32>,
    /// Steps each world by itself, not several of a thread side by side in vector registers: the same rows, but for the times.
    #[arg(long)]
    pub alone: bool,
    /// Only every N-th world, from I (from 0) on.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<crate::cli::sweep::Shard>,
    /// A bag for each world, as that of simulate, in a folder of its own in this one.
    #[arg(long, value_name = "DIR")]
    pub bags: Option<PathBuf>,
    /// A table for each world, as that of simulate, in this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "bags")]
    pub tables: Option<PathBuf>,
    /// Instead: puts the tables of shards together, in the order of worlds.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["out", "jobs", "alone", "shard", "bags", "tables"])]
    pub merge: Option<PathBuf>,
}

/// `replay`.
#[derive(Debug, Args)]
pub struct ReplayArgs {
    /// The folder of a bag that `realnoid run --record` has written, or its .mcap file.
    pub bag: PathBuf,
    /// A row for each state of the replay, as those of simulate.
    #[arg(long, value_name = "FILE.csv")]
    pub out: Option<PathBuf>,
}

/// `simulate`: the fixed contract of DESIGN §1.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// What is simulated.
    #[command(flatten)]
    pub run: RunArgs,
    /// rbx, rapier or bullet (a cargo feature); rbx unless the scene says otherwise.
    #[arg(long)]
    pub engine: Option<String>,
    /// Time between two rows, s: a whole multiple of the control interval, which it is if not given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub every: Option<f64>,
    /// Where the rows go: FILE.csv or FILE.mcap; its folder is made if it does not exist.
    ///
    /// FILE.mcap is a bag of ROS 2 messages: /clock, /joint_states and, for a free base, /odom. In a new or empty folder
    /// a metadata.yaml is written beside it, which makes the folder a bag for `ros2 bag play FOLDER` and rosbags. In a
    /// folder with other things FILE.mcap stands for itself. An earlier run of the same name is replaced.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Where the contacts go: a row per contact, as often as `--every` says, with time, the two names, point (m), normal from
    /// the first to the second, depth (m) and force on the second (N, averaged over the last step), in the world frame.
    #[arg(long, value_name = "FILE.csv")]
    pub contacts: Option<PathBuf>,
    /// Makes each interval, and the whole run, again with half the step: tells what the run is off by, in `error_estimate`.
    #[arg(long)]
    pub estimate_error: bool,
}

/// `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// What is simulated.
    #[command(flatten)]
    pub run: RunArgs,
    /// An engine to compare; as often as needed. All that this program was built with, if none is given.
    #[arg(long, value_name = "NAME")]
    pub engine: Vec<String>,
    /// The difference (rad or m) of which it is told when it is first exceeded.
    #[arg(long, value_name = "X", default_value_t = 0.001, allow_negative_numbers = true)]
    pub within: f64,
    /// Time between two rows of `--csv` and points of `--svg`, s: a whole multiple of the control interval, which it is if not given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub every: Option<f64>,
    /// Differences, energy, momentum, penetration, joint drift and CPU time of every run over time.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// The differences over time as a picture.
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// JSON instead of tables; it also has where everything is at the end.
    #[arg(long)]
    pub json: bool,
}

/// `engines`.
#[derive(Debug, Args)]
pub struct EnginesArgs {
    /// Case files: a folder of NAME.yaml, or one of them. Each is run on every engine of this program.
    #[arg(long, value_name = "DIR")]
    pub cases: Option<PathBuf>,
    /// An engine to run; as often as needed. All that this program was built with, if none is given.
    #[arg(long, value_name = "NAME", requires = "cases")]
    pub engine: Vec<String>,
    /// A page of documentation: what every engine can, its errors beside theory, CPU times.
    #[arg(long, value_name = "FILE.md", requires = "cases")]
    pub markdown: Option<PathBuf>,
    /// JSON instead of tables.
    #[arg(long)]
    pub json: bool,
    /// A row per case, quantity and engine.
    #[arg(long, value_name = "FILE.csv", requires = "cases")]
    pub csv: Option<PathBuf>,
}

/// `hard`.
#[derive(Debug, Args)]
pub struct HardArgs {
    /// Case files: a folder of NAME.yaml, or one of them.
    pub cases: PathBuf,
    /// An engine to run; as often as needed. All that this program was built with, if none is given.
    #[arg(long, value_name = "NAME")]
    pub engine: Vec<String>,
    /// An integrator of rbx; as often as needed. All, if none is given.
    #[arg(long, value_name = "NAME")]
    pub integrator: Vec<String>,
    /// A step, ms; as often as needed. 10, 5, 2, 1, 0.5 and 0.1, if none is given.
    #[arg(long, value_name = "MS")]
    pub step: Vec<f64>,
    /// A page of documentation.
    #[arg(long, value_name = "FILE.md")]
    pub markdown: Option<PathBuf>,
    /// A row per case, engine, integrator and step.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
}

/// `N` numbers separated by commas.
///
/// # Errors
/// Names the flag, the value, and the form it must have.
pub fn numbers<const N: usize>(flag: &str, form: &str, text: &str) -> Result<[f64; N], String> {
    let parts: Vec<f64> =
        text.split(',').map_while(|p| p.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    match parts.try_into() {
        Ok(array) if text.split(',').count() == N => Ok(array),
        _ => Err(format!("{flag} {text}: must be {N} finite numbers, {form}")),
    }
}

/// `NAME=VALUE`, and the numbers of the value.
///
/// # Errors
/// Names the flag and the form it must have.
pub fn assignment<'a>(flag: &str, form: &str, text: &'a str) -> Result<(&'a str, Vec<f64>), String> {
    let wrong = || format!("{flag} {text}: must be {form} with finite numbers");
    let (name, value) = text.rsplit_once('=').ok_or_else(wrong)?;
    let numbers: Result<Vec<f64>, _> = value.split(',').map(|p| p.trim().parse::<f64>()).collect();
    let numbers = numbers.ok().filter(|n| n.iter().all(|x| x.is_finite())).ok_or_else(wrong)?;
    Ok((name, numbers))
}
