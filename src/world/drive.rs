//! Changing the machine behind an axis while it runs (J-13 a, b, e, f, g).

use super::World;
use crate::model::DriveLimits;
use std::sync::Arc;

impl World {
    /// Sets what bounds the drive of an axis; takes effect with the next step.
    ///
    /// # Errors
    /// Says which item is out of range; nothing changes then.
    pub fn set_drive(&mut self, axis: usize, drive: DriveLimits) -> Result<(), String> {
        let count = self.model.axes.len();
        if axis >= count {
            return Err(format!("there is no axis {axis}; there are {count}"));
        }
        let positive = [("no_load_speed", drive.no_load_speed), ("max_speed", drive.max_speed)];
        if let Some((name, x)) = positive.into_iter().find(|(_, x)| x.is_nan() || *x <= 0.0) {
            return Err(format!("{name} is {x}; it must be greater than 0"));
        }
        let finite = [
            ("static_resistance", drive.static_resistance),
            ("dynamic_resistance", drive.dynamic_resistance),
            ("rotor_inertia", drive.rotor_inertia),
        ];
        if drive.max_torque.is_nan() || drive.max_torque < 0.0 {
            return Err(format!("max_torque is {}; it must be 0 or greater", drive.max_torque));
        }
        if let Some((name, x)) = finite.into_iter().find(|(_, x)| !x.is_finite() || *x < 0.0) {
            return Err(format!("{name} is {x}; it must be finite, 0 or greater"));
        }
        Arc::make_mut(&mut self.model).axes[axis].drive = drive;
        Ok(())
    }
}
