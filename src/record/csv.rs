//! A run as comma-separated values: 17 significant digits, so that a value read back has the same bits.

use crate::model::{Base, Model};
use crate::world::{Snapshot, World};
use std::io::{self, BufWriter, Write};

/// Writes one row per call.
pub struct CsvWriter<W: Write> {
    out: BufWriter<W>,
    snapshot: Snapshot,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the header: `time`, per axis `NAME.position`, `.velocity`, `.effort`, the base where it is free, energies,
    /// momenta.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W, world: &World) -> io::Result<Self> {
        let mut out = BufWriter::new(out);
        writeln!(out, "{}", columns(world.model()).join(","))?;
        Ok(Self { out, snapshot: world.new_snapshot() })
    }

    /// Writes the present state.
    ///
    /// # Errors
    /// What the file system says.
    pub fn row(&mut self, world: &World) -> io::Result<()> {
        world.write_snapshot(&mut self.snapshot);
        let (m, s) = (world.model(), &self.snapshot);
        number(&mut self.out, "", world.time())?;
        for i in 0..m.axes.len() {
            for x in [s.position[i], s.velocity[i], s.effort[i]] {
                number(&mut self.out, ",", x)?;
            }
        }
        if m.base == Base::Free {
            for x in base(m, s) {
                number(&mut self.out, ",", x)?;
            }
        }
        let (e, p) = (world.energy(), world.momentum());
        for x in [e.kinetic, e.potential].into_iter().chain(p.angular.iter().copied()).chain(p.linear.iter().copied()) {
            number(&mut self.out, ",", x)?;
        }
        writeln!(self.out)
    }

    /// Writes what is still in memory.
    ///
    /// # Errors
    /// What the file system says.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn columns(m: &Model) -> Vec<String> {
    let mut names = vec!["time".to_owned()];
    for a in &m.axes {
        names.extend(["position", "velocity", "effort"].map(|kind| format!("{}.{kind}", a.name)));
    }
    if m.base == Base::Free {
        let parts = ["x", "y", "z", "qx", "qy", "qz", "qw", "wx", "wy", "wz", "vx", "vy", "vz"];
        names.extend(parts.map(|p| format!("base.{p}")));
    }
    names.extend(["energy.kinetic", "energy.potential"].map(String::from));
    names.extend(["lx", "ly", "lz", "px", "py", "pz"].map(|p| format!("momentum.{p}")));
    names
}

/// Pose of the root link in the world, its twist along its own axes.
fn base(m: &Model, s: &Snapshot) -> [f64; 13] {
    let (pose, twist) = (&s.link_pose[m.root_link], &s.link_twist[m.root_link]);
    let (p, q, w, v) = (&pose.translation, pose.rotation.coords, &twist.angular, &twist.linear);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w, w.x, w.y, w.z, v.x, v.y, v.z]
}

fn number(out: &mut impl Write, before: &str, x: f64) -> io::Result<()> {
    write!(out, "{before}{x:.16e}")
}
