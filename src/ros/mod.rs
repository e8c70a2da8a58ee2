//! The ROS 2 node: the only room that knows ros2-client. Messages, parameters, topics, services; no physics.
//!
//! Three threads: the control loop (`control`) shares only the lock-free cells of `exchange` with the publishing thread
//! (`publish_loop`, the main thread) and the listening thread (`listen`: commands and parameters).

mod args;
mod asks;
mod audience;
mod chronicle;
mod clock;
mod commands;
mod connection;
mod control;
mod counts;
mod diagnostics;
mod environment;
mod exchange;
mod listen;
mod lockstep;
mod log;
mod markers;
pub mod messages;
mod monitors;
mod names;
mod neighbours;
mod node;
pub mod parameters;
mod params_file;
mod publish;
mod publish_loop;
mod recording;
mod refusal;
mod ros2_control;
mod service;
mod services;
pub mod states;
mod tf;
mod topics;
mod watchdog;
pub mod wire;

pub use args::{RosArgs, split_arguments};
pub use commands::{Command, Refusal, RefusalKind, Rules, apply};
pub use environment::{DiscoveryRange, Environment};
pub use log::{Logger, Severity};
pub use node::{Robot, run};
pub use ros2_control::Control;
