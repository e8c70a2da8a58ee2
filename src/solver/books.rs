//! What the drives of all axes are, and what became of them.

use crate::model::{Axis, DriveLimits, Effects, Model};

/// What every engine keeps of its axes. Makes its memory once.
#[derive(Clone, Debug)]
pub struct Books {
    /// The drives as they are now, in the order of `Model::axes`.
    pub drives: Vec<DriveLimits>,
    /// Per axis: drive torque or force really applied in the last step, N·m or N.
    pub effort: Vec<f64>,
    /// Work since the start.
    pub work: Work,
    /// By how much an axis was outside its range at most, at the start of a step; rad or m.
    pub worst_stop: f64,
}

/// Work since the start, J: summed over the steps as h·torque·mean speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Done by the drives.
    pub drives: f64,
    /// Taken by damping, friction, stops, soft joints (which may give some of it back).
    pub losses: f64,
    /// Taken by contacts: friction, rolling, impacts, less what keeping bodies out of each other lifts them by.
    pub contacts: f64,
}

impl Work {
    /// Books the torque of a drive, as part of the total one of its axis, along a way in rad or m.
    pub(crate) fn book(&mut self, drive: f64, total: f64, way: f64) {
        self.drives += drive * way;
        self.losses -= (total - drive) * way;
    }
}

impl Books {
    /// With the drives of the model.
    pub fn new(m: &Model) -> Self {
        Self {
            drives: m.axes.iter().map(|a| a.drive).collect(),
            effort: vec![0.0; m.axes.len()],
            work: Work::default(),
            worst_stop: 0.0,
        }
    }

    /// Forgets the steps so far; what was changed of the drives stays.
    pub fn reset(&mut self) {
        self.effort.fill(0.0);
        (self.work, self.worst_stop) = (Work::default(), 0.0);
    }

    /// Takes the position of an axis at the start of a step.
    pub(crate) fn watch_stop(&mut self, axis: &Axis, q: f64) {
        self.worst_stop = self.worst_stop.max(axis.lower - q).max(q - axis.upper);
    }

    /// Inertia of the rotor of an axis that counts, kg·m² or kg: 0 while that effect is off.
    pub(crate) fn rotor(&self, axis: usize, effects: Effects) -> f64 {
        if effects.rotor_inertia { self.drives[axis].rotor_inertia } else { 0.0 }
    }
}
