//! Raw arguments, as they are typed, and how single values are read.

use super::load::Source;
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
    /// Time per call of kinematics, rnea, crba, aba and step: medians, thread CPU time.
    Bench(BenchArgs),
    /// Forward dynamics of single states, to compare with other programs: one JSON object per line on standard input
    /// `{"position": [..], "velocity": [..], "effort": [..], "base_pose": [x,y,z,qx,qy,qz,qw], "base_twist": [w, v]}`,
    /// per axis in the order of the URDF; one line `{"acceleration": [..], "base_acceleration": [..]}` out for each.
    Evaluate(EvaluateArgs),
}

/// Where packages are that mesh files name.
#[derive(Debug, Default, Args)]
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
#[derive(Debug, Args)]
pub struct RunArgs {
    /// URDF file; without one, that of the scene.
    #[arg(required_unless_present = "scene")]
    pub urdf: Option<PathBuf>,
    /// `--package`.
    #[command(flatten)]
    pub packages: PackageArgs,
    /// World settings, robots, bodies and the ground (YAML); flags win over it.
    #[arg(long)]
    pub scene: Option<PathBuf>,
    /// The flat ground z = 0, where the scene has none of its own.
    #[arg(long)]
    pub ground: bool,
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
    /// implicit_midpoint, semi_implicit_euler or rk4.
    #[arg(long)]
    pub integrator: Option<String>,
    /// m/s², world frame; 0,0,-9.80665 unless the scene says otherwise.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub gravity: Option<String>,
    /// Simulated time per control interval against the interval, 0 to 100.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub time_scale: Option<f64>,
    /// fixed (on a test stand) or free.
    #[arg(long, value_parser = ["fixed", "free"])]
    pub base: Option<String>,
    /// Initial position (rad or m) and speed of an axis.
    #[arg(long, value_name = "AXIS=POSITION[,VELOCITY]")]
    pub set: Vec<String>,
    /// Root link in the world: position, m, and quaternion.
    #[arg(long, value_name = "X,Y,Z,QX,QY,QZ,QW", allow_hyphen_values = true)]
    pub base_pose: Option<String>,
    /// Twist of a free base in the base frame, angular (rad/s) first.
    #[arg(long, value_name = "WX,WY,WZ,VX,VY,VZ", allow_hyphen_values = true)]
    pub base_twist: Option<String>,
    /// Position of an axis at start, set from its root side: what hangs on the axis stays where it is, the base moves.
    #[arg(long, value_name = "AXIS=POSITION")]
    pub turn: Vec<String>,
    /// Applied torque (N·m; N for a linear axis) and applied speed (rad/s; m/s) from the start.
    #[arg(long, value_name = "AXIS=TORQUE[,SPEED]")]
    pub effort: Vec<String>,
    /// Servo target (rad; m for a linear axis) from the start, and what bounds its torque and speed.
    #[arg(long, value_name = "AXIS=POSITION[,TORQUE[,SPEED]]")]
    pub servo: Vec<String>,
    /// Commands and drive settings over time (YAML): a list of entries {at: seconds, axis: NAME, …}.
    ///
    /// An entry takes mode (idle, torque, servo), torque, speed, target, max_torque, no_load_speed, static_resistance,
    /// dynamic_resistance, short_brake, bandwidth, rotor_inertia. A mode begins a new command; what an entry does not name stays as it
    /// is. Entries are in the order of time; one inside a control interval takes effect with the next interval.
    #[arg(long, value_name = "FILE.yaml")]
    pub script: Option<PathBuf>,
    /// Switch an effect off: gravity, damping, friction, limits, drives, rotor_inertia, compliance, mimic, breaking,
    /// body_damping, contact, deactivation.
    #[arg(long, value_name = "EFFECT")]
    pub off: Vec<String>,
    /// Switch an effect on.
    #[arg(long, value_name = "EFFECT")]
    pub on: Vec<String>,
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
