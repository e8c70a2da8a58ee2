//! Wavefront OBJ: positions and faces; all else is for looks.
//!
//! Own reader: `tobj` 4.0 names no line, reads materials as well, and fans faces that are not convex.

use super::builder::Builder;
use super::fault::Inside;
use super::polygon::Polygons;
use super::text::{lines, number, short};
use crate::shape::TriMesh;

/// Is it certain from the bytes alone that this is an OBJ file?
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4000)];
    if head.contains(&0) {
        return false;
    }
    let is_data = |line: &str| matches!(line.split_ascii_whitespace().next(), Some("v" | "vn" | "vt"));
    let data = lines(head).filter(|(_, line)| is_data(line));
    let words: Vec<usize> = data.map(|(_, line)| line.split_ascii_whitespace().count()).collect();
    !words.is_empty() && words.iter().all(|n| *n >= 3)
}

/// The mesh in an OBJ file; coordinates are metres.
pub(super) fn read(bytes: &[u8]) -> Result<TriMesh, Inside> {
    let mut reader = Reader { builder: Builder::default(), corners: vec![], faces: vec![], ends: vec![] };
    let mut whole = String::new();
    let mut last = 0;
    for (n, line) in lines(bytes) {
        last = n;
        match line.split('#').next().unwrap_or("").trim_end().strip_suffix('\\') {
            Some(part) => {
                whole.push_str(part);
                whole.push(' ');
            }
            None if whole.is_empty() => reader.line(n, &line)?,
            None => {
                whole.push_str(&line);
                reader.line(n, &std::mem::take(&mut whole))?;
            }
        }
    }
    reader.line(last, &whole)?;
    reader.finish()
}

struct Reader {
    builder: Builder,
    /// Index in the mesh of each `v`.
    corners: Vec<u32>,
    /// Which `v`, for all faces in a row; a face may stand before its corners.
    faces: Vec<u32>,
    /// Where each face ends in `faces`, and its line.
    ends: Vec<(usize, usize)>,
}

impl Reader {
    fn line(&mut self, n: usize, line: &str) -> Result<(), Inside> {
        let mut words = line.split('#').next().unwrap_or("").split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let place = [number(n, words.next())?, number(n, words.next())?, number(n, words.next())?];
                self.corners.push(self.builder.corner(place)?);
            }
            Some("f") => {
                for word in words {
                    let corner = self.index(n, word)?;
                    self.faces.push(corner);
                }
                self.ends.push((self.faces.len(), n));
            }
            _ => (),
        }
        Ok(())
    }

    /// Which `v`, from 0, "7", "7/1", "7//2" or "-1" names.
    fn index(&self, n: usize, word: &str) -> Result<u32, Inside> {
        let written = word.split('/').next().unwrap_or("");
        let unknown = || Inside::line(n, format!("\"{}\" names no vertex", short(word)));
        let number: i64 = written.parse().map_err(|_| unknown())?;
        let before = self.corners.len() as i64;
        let index = if number > 0 { Some(number - 1) } else { before.checked_add(number).filter(|_| number < 0) };
        index.and_then(|i| u32::try_from(i).ok()).ok_or_else(unknown)
    }

    fn finish(mut self) -> Result<TriMesh, Inside> {
        let mut polygons = Polygons::default();
        let mut start = 0;
        for (end, n) in &self.ends {
            let mut face = Vec::with_capacity(end - start);
            for &corner in &self.faces[start..*end] {
                let known = self.corners.get(corner as usize);
                face.push(*known.ok_or_else(|| {
                    let reason = format!("a face names vertex {}, but there are {}", corner + 1, self.corners.len());
                    Inside::line(*n, reason)
                })?);
            }
            polygons.add(&mut self.builder, &face)?;
            start = *end;
        }
        self.builder.finish()
    }
}
