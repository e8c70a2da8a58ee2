//! The contacts of a run as comma-separated values: one row per contact and sample.

use crate::model::Model;
use crate::world::{ContactPoint, Snapshot};
use std::io::{self, BufWriter, Write};

/// Writes a row per contact that carries something.
pub struct ContactWriter<W: Write> {
    out: BufWriter<W>,
    /// Of the colliders.
    names: Vec<String>,
}

impl<W: Write> ContactWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W, model: &Model) -> io::Result<Self> {
        let mut out = BufWriter::new(out);
        writeln!(out, "time,first,second,x,y,z,nx,ny,nz,depth,fx,fy,fz")?;
        Ok(Self { out, names: model.colliders.iter().map(|c| c.name.replace([',', '"', '\n'], "_")).collect() })
    }

    /// Writes the contacts of an instant: point (m), normal from the first to the second, depth (m), force on the second (N),
    /// in the world frame.
    ///
    /// # Errors
    /// What the file system says.
    pub fn rows(&mut self, s: &Snapshot, contacts: &[ContactPoint]) -> io::Result<()> {
        for c in contacts {
            let name = |side: usize| self.names.get(c.colliders[side]).map_or("?", String::as_str);
            write!(self.out, "{:.16e},{},{}", s.stamp_ns as f64 * 1e-9, name(0), name(1))?;
            let numbers = c.point.iter().chain(c.normal.iter()).chain(std::iter::once(&c.depth)).chain(c.force.iter());
            for x in numbers {
                write!(self.out, ",{x:.16e}")?;
            }
            writeln!(self.out)?;
        }
        Ok(())
    }

    /// Writes what is still in memory.
    ///
    /// # Errors
    /// What the file system says.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}
