//! The cases, in the order of tables and page.

mod contact;
mod drives;
mod free;
mod joints;

use super::case::{Case, G};

/// All of them.
pub fn cases() -> Vec<Case> {
    vec![
        joints::chain("chain5", 5),
        joints::chain("chain10", 10),
        free::torque_free(),
        joints::conical_pendulum(),
        joints::heavy_top(),
        drives::humanoid_torques(),
        drives::humanoid_servos(),
        drives::servo_step(),
        drives::stop(),
        contact::rolling(),
        contact::sliding(),
        contact::slip_to_roll(),
        contact::bounce(),
        contact::stack(),
        contact::humanoid_drop(),
    ]
}

/// Straight down, m/s².
const DOWN: [f64; 3] = [0.0, 0.0, -G];
/// None.
const WEIGHTLESS: [f64; 3] = [0.0; 3];

/// 1 s in instants.
const SECOND: usize = 25;
