//! The runs over time: as CSV, and what the picture is drawn from.

use super::contender::Contender;
use super::difference::Differences;
use std::io::Write;

/// One run at one instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// From the reference, in the order of `MEASURES`; of the reference itself 0.
    pub differences: [f64; 3],
    /// Kinetic and potential, J.
    pub energy: f64,
    /// Linear momentum of what floats, N·s, world frame.
    pub momentum: [f64; 3],
    /// Angular momentum of what floats about its centre of mass, N·m·s, world frame.
    pub angular: [f64; 3],
    /// Deepest since the start, m.
    pub penetration: f64,
    /// Widest since the start, m.
    pub drift: f64,
    /// Since the start, s.
    pub cpu: f64,
}

impl Row {
    /// The present state of a run.
    pub fn of(c: &Contender, d: &Differences) -> Self {
        Self {
            differences: d.map(|w| w.value),
            energy: c.energy,
            momentum: c.momentum.linear.into(),
            angular: c.momentum.angular.into(),
            penetration: c.snapshot.stats.worst_penetration,
            drift: c.world.joint_drift(),
            cpu: c.cpu,
        }
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        let first = self.differences.into_iter().chain([self.energy]).chain(self.momentum).chain(self.angular);
        first.chain([self.penetration, self.drift, self.cpu])
    }
}

/// Columns of each run, after its name and a point.
const COLUMNS: [&str; 13] = [
    "axes",
    "positions",
    "orientations",
    "energy",
    "px",
    "py",
    "pz",
    "lx",
    "ly",
    "lz",
    "penetration",
    "joint_drift",
    "cpu",
];

/// All runs over time.
#[derive(Default)]
pub(super) struct Rows {
    /// The reference comes first.
    pub names: Vec<String>,
    /// s.
    pub times: Vec<f64>,
    /// For each time, a row of each run.
    pub rows: Vec<Vec<Row>>,
}

impl Rows {
    /// Comma-separated values with 17 significant digits.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        write!(out, "time")?;
        for name in &self.names {
            COLUMNS.iter().try_for_each(|column| write!(out, ",{name}.{column}"))?;
        }
        writeln!(out)?;
        for (time, row) in self.times.iter().zip(&self.rows) {
            write!(out, "{time:.16e}")?;
            row.iter().flat_map(Row::values).try_for_each(|x| write!(out, ",{x:.16e}"))?;
            writeln!(out)?;
        }
        out.flush()
    }
}
