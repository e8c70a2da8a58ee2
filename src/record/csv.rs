//! A run as comma-separated values: 17 significant digits, so that a value read back has the same bits.

use super::Sample;
use crate::model::Model;
use crate::world::Snapshot;
use std::io::{self, BufWriter, Write};

/// Writes one row per sample.
pub struct CsvWriter<W: Write> {
    out: BufWriter<W>,
    /// Root links of all that floats.
    floating: Vec<usize>,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the header: `time`, per axis `NAME.position`, `.velocity`, `.effort`, whatever floats (the base, then what joined the robot), energies,
    /// momenta.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W, model: &Model) -> io::Result<Self> {
        let mut out = BufWriter::new(out);
        writeln!(out, "{}", columns(model).join(","))?;
        Ok(Self { out, floating: model.floating().map(|(_, root)| root).collect() })
    }

    /// Writes a sample.
    ///
    /// # Errors
    /// What the file system says.
    pub fn row(&mut self, sample: &Sample) -> io::Result<()> {
        let (s, p) = (&sample.snapshot, &sample.momentum);
        number(&mut self.out, "", s.stamp_ns as f64 * 1e-9)?;
        for i in 0..s.position.len() {
            for x in [s.position[i], s.velocity[i], s.effort[i]] {
                number(&mut self.out, ",", x)?;
            }
        }
        for x in self.floating.iter().flat_map(|root| base(*root, s)) {
            number(&mut self.out, ",", x)?;
        }
        let energies = [s.kinetic_energy, s.potential_energy];
        for x in energies.iter().chain(p.angular.iter()).chain(p.linear.iter()) {
            number(&mut self.out, ",", *x)?;
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
    for (name, _) in m.floating() {
        let parts = ["x", "y", "z", "qx", "qy", "qz", "qw", "wx", "wy", "wz", "vx", "vy", "vz"];
        names.extend(parts.map(|p| format!("{name}.{p}")));
    }
    names.extend(["energy.kinetic", "energy.potential"].map(String::from));
    names.extend(["lx", "ly", "lz", "px", "py", "pz"].map(|p| format!("momentum.{p}")));
    names
}

/// Pose of a root link in the world, its twist along its own axes.
fn base(root: usize, s: &Snapshot) -> [f64; 13] {
    let (pose, twist) = (&s.link_pose[root], &s.link_twist[root]);
    let (p, q, w, v) = (&pose.translation, pose.rotation.coords, &twist.angular, &twist.linear);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w, w.x, w.y, w.z, v.x, v.y, v.z]
}

fn number(out: &mut impl Write, before: &str, x: f64) -> io::Result<()> {
    write!(out, "{before}{x:.16e}")
}
