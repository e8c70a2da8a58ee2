//! STL, binary and ASCII.
//!
//! Own reader: `stl_io` 0.11 takes a binary file whose header begins with "solid" for ASCII, reads ASCII numbers as f32,
//! refuses the "normal nan nan nan" that exporters write, and names no line.

use super::builder::Builder;
use super::fault::Inside;
use super::text::{lines, number, short};
use crate::shape::TriMesh;

const HEADER: usize = 84;
const RECORD: usize = 50;

/// Is it certain from the bytes alone that this is an STL file?
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    promised(bytes).is_some_and(|n| bytes.len() == HEADER + RECORD * n) || is_text(bytes)
}

/// The mesh in an STL file; coordinates are metres.
pub(super) fn read(bytes: &[u8]) -> Result<TriMesh, Inside> {
    match promised(bytes) {
        Some(n) if bytes.len() == HEADER + RECORD * n => binary(bytes, n),
        _ if is_text(bytes) => ascii(bytes),
        // A tail shorter than one record: some exporters pad.
        Some(n) if bytes.len() > HEADER + RECORD * n && bytes.len() < HEADER + RECORD * (n + 1) => binary(bytes, n),
        Some(n) => {
            let room = (bytes.len() - HEADER) / RECORD;
            Err(Inside::byte(HEADER - 4, format!("{n} triangles are promised, but there are bytes for {room}")))
        }
        None => Err(Inside::byte(bytes.len(), "the file ends within the header")),
    }
}

/// Number of triangles by the header of a binary file.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?) as usize)
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let head = &start[..start.len().min(1000)];
    let is_word = |word: &[u8]| head.len() >= word.len() && head[..word.len()].eq_ignore_ascii_case(word);
    is_word(b"solid") && head.iter().all(|b| *b >= b' ' || b.is_ascii_whitespace())
}

fn binary(bytes: &[u8], triangles: usize) -> Result<TriMesh, Inside> {
    let mut builder = Builder::default();
    for record in bytes[HEADER..].chunks_exact(RECORD).take(triangles) {
        let coordinate = |i: usize| -> f64 {
            let at = 12 + 4 * i;
            f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]).into()
        };
        let mut corners = [0; 3];
        for (i, corner) in corners.iter_mut().enumerate() {
            *corner = builder.corner([coordinate(3 * i), coordinate(3 * i + 1), coordinate(3 * i + 2)])?;
        }
        builder.triangle(corners)?;
    }
    builder.finish()
}

fn ascii(bytes: &[u8]) -> Result<TriMesh, Inside> {
    let mut builder = Builder::default();
    let mut facet: Option<Vec<u32>> = None;
    let mut inside = false;
    let mut last = 1;
    for (n, line) in lines(bytes) {
        let mut words = line.split_ascii_whitespace();
        let Some(word) = words.next() else { continue };
        last = n;
        match (word.to_ascii_lowercase().as_str(), &mut facet) {
            ("solid", None) => inside = true,
            ("endsolid", None) => inside = false,
            ("facet", None) if inside => facet = Some(Vec::with_capacity(3)),
            ("outer" | "endloop", Some(_)) | ("color", _) => (),
            ("vertex", Some(corners)) if corners.len() < 3 => {
                let place = [number(n, words.next())?, number(n, words.next())?, number(n, words.next())?];
                corners.push(builder.corner(place)?);
            }
            ("endfacet", Some(corners)) => {
                let corners = corners.as_slice().try_into();
                builder.triangle(corners.map_err(|_| Inside::line(n, "this facet has fewer than three vertices"))?)?;
                facet = None;
            }
            ("vertex", Some(_)) => return Err(Inside::line(n, "this facet has more than three vertices")),
            _ => return Err(Inside::line(n, format!("\"{}\" is out of place here", short(word)))),
        }
    }
    if inside || facet.is_some() {
        return Err(Inside::line(last, "the file ends before \"endsolid\": it is cut off"));
    }
    builder.finish()
}
