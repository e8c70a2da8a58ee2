//! Drives that change while the world runs (J-13 a, b, e, f, g).

use super::World;
use crate::model::{DriveLimits, Effects};

impl World {
    /// The drive of an axis as it is now.
    pub fn drive(&self, axis: usize) -> Option<&DriveLimits> {
        self.engine.books().drives.get(axis)
    }

    /// Changes the drive of an axis, with effect from the next step; allocates nothing unless it is refused. An effect that
    /// the scene did not call for when it was loaded (friction, rotor inertia) is switched on with it; resistances that are
    /// switched off stay 0.
    ///
    /// # Errors
    /// Says which value is out of range; nothing changes then.
    pub fn set_drive(&mut self, axis: usize, drive: DriveLimits) -> Result<(), String> {
        let Some(present) = self.engine.books_mut().drives.get_mut(axis) else {
            return Err(format!("axis {axis} does not exist; there are {}", self.model.axes.len()));
        };
        drive.check()?;
        let drive = self.effects.drive_in_force(drive);
        *present = drive;
        self.engine.wake(&self.model);
        let called_for = Effects::called_for(&self.model);
        self.effects.friction |= drive.static_resistance > 0.0 && !called_for.friction;
        self.effects.rotor_inertia |= drive.rotor_inertia > 0.0 && !called_for.rotor_inertia;
        Ok(())
    }
}
