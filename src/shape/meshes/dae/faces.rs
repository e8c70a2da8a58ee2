//! Geometries: where their corners are, and the faces between them.

use super::{Dae, child, words};
use crate::math::{Mat3, Vec3};
use crate::shape::meshes::builder::Builder;
use crate::shape::meshes::fault::Inside;
use crate::shape::meshes::polygon::Polygons;
use crate::shape::meshes::text::short;
use roxmltree::{Node, NodeId};
use std::collections::HashMap;
use std::rc::Rc;

/// An affine map: `linear * p + offset`.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) linear: Mat3,
    pub(super) offset: Vec3,
}

impl Placed {
    pub(super) fn scaled(factor: f64) -> Self {
        Self { linear: Mat3::from_diagonal_element(factor), offset: Vec3::zeros() }
    }

    /// `inner` first, then this.
    pub(super) fn then(&self, inner: &Self) -> Self {
        Self { linear: self.linear * inner.linear, offset: self.linear * inner.offset + self.offset }
    }

    fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

/// Positions, and pairs of characters of faces, of all instances of all geometries; one geometry may be instantiated any number of times.
const MOST_WORK: usize = 1 << 28;

/// The geometries of a file; the numbers of each source are read once.
pub(super) struct Geometries<'a, 'd> {
    dae: &'d Dae<'a>,
    positions: HashMap<NodeId, Rc<Vec<[f64; 3]>>>,
    polygons: Polygons,
    work: usize,
}

/// Which of the numbers in a row of indices names the corner.
struct Layout {
    positions: Rc<Vec<[f64; 3]>>,
    stride: usize,
    offset: usize,
}

impl<'a, 'd> Geometries<'a, 'd> {
    pub(super) fn new(dae: &'d Dae<'a>) -> Self {
        Self { dae, positions: HashMap::new(), polygons: Polygons::default(), work: 0 }
    }

    /// Adds the faces of a geometry at its place.
    pub(super) fn add(&mut self, geometry: Node<'a, 'a>, at: &Placed, to: &mut Builder) -> Result<(), Inside> {
        let Some(mesh) = child(geometry, "mesh") else { return Ok(()) };
        for element in mesh.children() {
            let kind = element.tag_name().name();
            if matches!(kind, "triangles" | "trifans" | "tristrips" | "polylist" | "polygons") {
                let Some(layout) = self.layout(element)? else { continue };
                // Every instance reads the text of its faces anew.
                self.work += layout.positions.len() + element.range().len() / 2 + 1000;
                if self.work > MOST_WORK {
                    return Err(Inside::TooLarge(format!("its instances take more than {MOST_WORK} corners")));
                }
                let faces = self.faces(element, kind, &layout)?;
                self.place(element, &faces, &layout, (at, to))?;
            }
        }
        Ok(())
    }

    /// None if the element has no faces to which positions would matter.
    fn layout(&mut self, element: Node<'a, 'a>) -> Result<Option<Layout>, Inside> {
        let inputs = || element.children().filter(|c| c.tag_name().name() == "input");
        let mut stride = 0;
        let mut vertex = None;
        for input in inputs() {
            let offset = self.whole(input, "offset")?;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((input, offset));
            }
        }
        let Some((input, offset)) = vertex else {
            let empty = !element.children().any(|c| matches!(c.tag_name().name(), "p" | "ph"));
            return if empty { Ok(None) } else { Err(self.dae.fault(element, "no input with semantic=\"VERTEX\"")) };
        };
        let vertices = self.dae.target(input, "source")?;
        let position = vertices.children().find(|c| c.attribute("semantic") == Some("POSITION"));
        let position = position.ok_or_else(|| self.dae.fault(vertices, "no input with semantic=\"POSITION\""))?;
        let positions = self.source(self.dae.target(position, "source")?)?;
        Ok(Some(Layout { positions, stride, offset }))
    }

    fn whole(&self, node: Node, attribute: &str) -> Result<usize, Inside> {
        let written = node.attribute(attribute).unwrap_or("0");
        let number = written.trim().parse().ok().filter(|n| *n < 1_000_000);
        number.ok_or_else(|| self.dae.fault(node, format!("{attribute}=\"{}\" is no count", short(written))))
    }

    fn source(&mut self, source: Node<'a, 'a>) -> Result<Rc<Vec<[f64; 3]>>, Inside> {
        if let Some(known) = self.positions.get(&source.id()) {
            return Ok(known.clone());
        }
        let array = child(source, "float_array");
        let array = array.ok_or_else(|| self.dae.fault(source, "positions need a <float_array>"))?;
        let numbers = self.dae.numbers(array)?;
        let accessor = child(source, "technique_common").and_then(|t| child(t, "accessor"));
        let (stride, offset) = match accessor {
            Some(a) if a.has_attribute("stride") => (self.whole(a, "stride")?, self.whole(a, "offset")?),
            Some(a) => (3, self.whole(a, "offset")?),
            None => (3, 0),
        };
        if stride < 3 {
            return Err(self.dae.fault(source, format!("positions have three coordinates, the stride is {stride}")));
        }
        let rows = numbers.get(offset..).unwrap_or(&[]).chunks(stride).filter(|row| row.len() >= 3);
        let positions = Rc::new(rows.map(|row| [row[0], row[1], row[2]]).collect());
        self.positions.insert(source.id(), Rc::clone(&positions));
        Ok(positions)
    }

    /// Rows of corners: one per polygon, fan or strip, or one for all triangles.
    fn faces(&self, element: Node<'a, 'a>, kind: &str, layout: &Layout) -> Result<Vec<Vec<u32>>, Inside> {
        if element.children().any(|c| c.tag_name().name() == "ph") {
            return Err(self.dae.fault(element, "polygons with holes are not read: cut them into triangles"));
        }
        let rows = element.children().filter(|c| c.tag_name().name() == "p");
        let rows: Vec<Vec<u32>> = rows.map(|p| self.corners(p, layout)).collect::<Result<_, _>>()?;
        let triangles = |row: Vec<u32>| -> Vec<Vec<u32>> { row.chunks_exact(3).map(<[u32]>::to_vec).collect() };
        Ok(match kind {
            "triangles" => rows.into_iter().flat_map(triangles).collect(),
            "polylist" => self.counted(element, rows.concat())?,
            "trifans" => rows.iter().flat_map(|row| fan(row)).collect(),
            "tristrips" => rows.iter().flat_map(|row| strip(row)).collect(),
            _ => rows,
        })
    }

    /// The indices of corners in a `<p>`.
    fn corners(&self, p: Node<'a, 'a>, layout: &Layout) -> Result<Vec<u32>, Inside> {
        let known = layout.positions.len();
        let corner = |word: &str| match word.parse::<u32>() {
            Ok(i) if (i as usize) < known => Ok(i),
            Ok(i) => Err(self.dae.fault(p, format!("corner {i} of {known} positions"))),
            Err(_) => Err(self.dae.fault(p, format!("\"{}\" is no index", short(word)))),
        };
        words(p).skip(layout.offset).step_by(layout.stride).map(corner).collect()
    }

    /// `<vcount>`: corners per polygon.
    fn counted(&self, element: Node<'a, 'a>, corners: Vec<u32>) -> Result<Vec<Vec<u32>>, Inside> {
        let Some(vcount) = child(element, "vcount") else {
            return Err(self.dae.fault(element, "a <polylist> needs a <vcount>"));
        };
        let mut rest = corners.as_slice();
        let mut faces = Vec::new();
        for word in words(vcount) {
            let count = word.parse().ok().filter(|n| *n <= rest.len());
            let count = count.ok_or_else(|| {
                self.dae.fault(vcount, format!("{} corners of a face, with {} left", short(word), rest.len()))
            })?;
            let (face, others) = rest.split_at(count);
            faces.push(face.to_vec());
            rest = others;
        }
        Ok(faces)
    }

    fn place(
        &mut self,
        element: Node,
        faces: &[Vec<u32>],
        layout: &Layout,
        (at, to): (&Placed, &mut Builder),
    ) -> Result<(), Inside> {
        let mirrors = at.mirrors();
        let mut placed: Vec<Option<u32>> = vec![None; layout.positions.len()];
        let mut corners = Vec::new();
        for face in faces {
            corners.clear();
            for &i in face {
                let index = match placed[i as usize] {
                    Some(index) => index,
                    None => {
                        let place = at.linear * Vec3::from(layout.positions[i as usize]) + at.offset;
                        to.corner(place.into()).map_err(|fault| self.named(fault, element, i))?
                    }
                };
                placed[i as usize] = Some(index);
                corners.push(index);
            }
            if mirrors {
                corners.reverse();
            }
            self.polygons.add(to, &corners)?;
        }
        Ok(())
    }

    /// A fault with the number of the corner as the file has it.
    fn named(&self, fault: Inside, element: Node, corner: u32) -> Inside {
        match fault {
            Inside::NoPlace(_, place) => {
                self.dae.fault(element, format!("vertex {} of its positions is {place:?}, no place", corner + 1))
            }
            other => other,
        }
    }
}

fn fan(row: &[u32]) -> Vec<Vec<u32>> {
    let Some((first, others)) = row.split_first() else { return vec![] };
    others.windows(2).map(|pair| vec![*first, pair[0], pair[1]]).collect()
}

fn strip(row: &[u32]) -> Vec<Vec<u32>> {
    let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { t.to_vec() } else { vec![t[1], t[0], t[2]] };
    row.windows(3).enumerate().map(turned).collect()
}
