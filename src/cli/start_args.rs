//! Arguments of every command that makes a run: what starts, how it is advanced, and under which commands.

use super::args::PackageArgs;
use clap::Args;
use std::path::PathBuf;

/// Robot, scene, state and commands at start.
#[derive(Clone, Debug, Default, Args)]
pub struct StartArgs {
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
    /// implicit_midpoint, semi_implicit_euler, rk4 or extrapolation.
    #[arg(long)]
    pub integrator: Option<String>,
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
    /// Applied torque (N·m; N for a linear axis) and applied speed (rad/s; m/s) from the start.
    #[arg(long, value_name = "AXIS=TORQUE[,SPEED]")]
    pub effort: Vec<String>,
    /// Servo target (rad; m for a linear axis) from the start, and what bounds its torque and speed.
    #[arg(long, value_name = "AXIS=POSITION[,TORQUE[,SPEED]]")]
    pub servo: Vec<String>,
    /// Switch an effect off: gravity, damping, friction (joint_friction, static_resistance, dynamic_resistance), limits (soft_stops), drives
    /// (torque_speed_line, short_brake, servo), rotor_inertia, compliance, mimic, breaking, body_damping, contact (contact_friction,
    /// rolling_resistance, spinning_friction, restitution, continuous_detection), deactivation. Those in brackets are parts.
    #[arg(long, value_name = "EFFECT")]
    pub off: Vec<String>,
}
