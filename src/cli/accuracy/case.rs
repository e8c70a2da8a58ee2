//! A case: a scene, what is looked at, and what is right.

use crate::engine::State;
use crate::math::{Quat, Vec3};
use crate::model::Model;
use crate::world::{AxisCommand, Integrator, Snapshot, World};
use nalgebra::Quaternion;

/// Time between two instants that are compared, and between two changes of commands, s. Every step and control interval divides it.
pub const GRID: f64 = 0.04;
/// The same, ns.
pub const GRID_NS: i64 = 40_000_000;
/// m/s²; also that of the closed forms.
pub const G: f64 = 9.80665;

/// What of a world is compared.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// A point of a link, m in the link's frame: where it is in the world.
    Point {
        /// Name of the link.
        link: String,
        /// m, in its frame.
        at: [f64; 3],
    },
    /// How a link is turned in the world.
    Turn {
        /// Name of the link.
        link: String,
    },
}

/// One number after the other: 3 coordinates (m) of each point, 4 of each turn (quaternion x, y, z, w).
pub type Sample = Vec<f64>;

/// The right values at these times, s.
pub type Closed = Box<dyn Fn(&[f64]) -> Vec<Sample> + Send + Sync>;

/// What is right.
pub enum Truth {
    /// A closed form.
    Closed {
        /// In words.
        words: &'static str,
        /// The values.
        value: Closed,
    },
    /// Computed in numbers of twice the digits, where nothing but gravity acts; half as many steps tell the error.
    Exact {
        /// In a [`GRID`].
        steps: u32,
    },
    /// A run of rbx with fine steps; one with half as many tells its own error.
    Own {
        /// Of both runs.
        integrator: Integrator,
        /// In a millisecond.
        steps_per_ms: u32,
    },
}

/// Makes a world at its start; settings but gravity are those of the defaults.
pub type Make = Box<dyn Fn() -> Result<World, String> + Send + Sync>;

/// Sets the commands (one per axis) that are in force from instant `k` · [`GRID`] on.
pub type Orders = fn(&Model, usize, &mut [AxisCommand]);

/// A case.
pub struct Case {
    /// In tables and file names.
    pub name: &'static str,
    /// What happens, one sentence.
    pub shows: &'static str,
    /// What is compared, in words.
    pub compared: &'static str,
    /// Unit of the error.
    pub unit: &'static str,
    /// An error as large as this is no better than knowing nothing: about how far things move, in the unit.
    pub size: f64,
    /// Instants: the duration in [`GRID`]s.
    pub instants: usize,
    /// The world.
    pub make: Make,
    /// What is compared.
    pub looks: Vec<Look>,
    /// With what.
    pub truth: Truth,
    /// Commands over time.
    pub orders: Option<Orders>,
    /// The iterations of the solver (W-6) matter: they are a ladder of their own.
    pub iterates: bool,
    /// What other programs cannot have the same of; `None`: they can have it all.
    pub peer_differs: Option<&'static str>,
}

impl Case {
    /// Simulated time, s.
    pub fn duration(&self) -> f64 {
        self.instants as f64 * GRID
    }

    /// The instants, s.
    pub fn times(&self) -> Vec<f64> {
        (1..=self.instants).map(|k| k as f64 * GRID).collect()
    }

    /// Links and points that are looked at in a world.
    ///
    /// # Errors
    /// Names a link that the world does not have.
    pub fn seats(&self, m: &Model) -> Result<Vec<Seat>, String> {
        let link = |name: &String| {
            let found = m.links.iter().position(|l| l.name == *name);
            found.ok_or_else(|| format!("case '{}': there is no link '{name}'", self.name))
        };
        let seat = |look: &Look| match look {
            Look::Point { link: name, at } => Ok(Seat::Point(link(name)?, Vec3::from(*at))),
            Look::Turn { link: name } => Ok(Seat::Turn(link(name)?)),
        };
        self.looks.iter().map(seat).collect()
    }

    /// Tells the world what is due at an instant.
    pub(super) fn command(&self, world: &mut World, k: usize) {
        let Some(orders) = self.orders else { return };
        let mut commands = world.commands().to_vec();
        orders(world.model(), k, &mut commands);
        // Finite numbers, one for each axis.
        let _ = world.set_commands(&commands);
    }

    /// Distance of two samples: the root of the mean square over all points (m) or turns (rad).
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let (mut sum, mut at) = (0.0, 0);
        for look in &self.looks {
            let size = look.size();
            let (x, y) = (&a[at..at + size], &b[at..at + size]);
            sum += if size == 3 { squared(x, y) } else { angle(x, y).powi(2) };
            at += size;
        }
        (sum / self.looks.len() as f64).sqrt()
    }
}

impl Look {
    /// A point.
    pub fn point(link: &str, at: [f64; 3]) -> Self {
        Self::Point { link: link.into(), at }
    }

    /// How many numbers of a sample are its own.
    pub fn size(&self) -> usize {
        match self {
            Self::Point { .. } => 3,
            Self::Turn { .. } => 4,
        }
    }
}

/// A [`Look`] in a world: index of the link.
#[derive(Clone, Copy, Debug)]
pub enum Seat {
    /// And a point in its frame, m.
    Point(usize, Vec3),
    /// How it is turned.
    Turn(usize),
}

/// The present sample.
pub fn sample(s: &Snapshot, seats: &[Seat]) -> Sample {
    let mut out = vec![];
    for seat in seats {
        match seat {
            Seat::Point(link, at) => out.extend((s.link_pose[*link] * nalgebra::Point3::from(*at)).iter()),
            Seat::Turn(link) => out.extend(s.link_pose[*link].rotation.coords.iter()),
        }
    }
    if s.finite { out } else { vec![f64::NAN; out.len()] }
}

/// A rotation as a sample has it.
pub(super) fn turned(q: &Quat) -> Sample {
    q.coords.iter().copied().collect()
}

fn squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum()
}

/// Between two unit quaternions (x, y, z, w), rad; the sine and not the cosine of the half, which tells nothing of small angles.
fn angle(a: &[f64], b: &[f64]) -> f64 {
    let of = |q: &[f64]| Quaternion::new(q[3], q[0], q[1], q[2]);
    let between = of(a).conjugate() * of(b);
    2.0 * libm::atan2(between.imag().norm(), between.w.abs())
}

/// Sets the axis of that name; a name that does not exist is a mistake in the case.
///
/// # Errors
/// Names the axis.
pub(super) fn set(m: &Model, s: &mut State, name: &str, (position, speed): (f64, f64)) -> Result<(), String> {
    let axis = m.axis(name).ok_or_else(|| format!("there is no axis '{name}'"))?;
    s.set_axis(m, axis, position, speed);
    Ok(())
}
