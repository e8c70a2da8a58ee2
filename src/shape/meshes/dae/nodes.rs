//! The scene: nodes, their transforms, what they instantiate.

use super::faces::{Geometries, Placed};
use super::{Dae, child};
use crate::math::{Mat3, Vec3};
use crate::shape::TriMesh;
use crate::shape::meshes::builder::Builder;
use crate::shape::meshes::fault::Inside;
use roxmltree::Node;

/// Nodes within nodes, instances included; a file whose nodes instantiate themselves ends here.
const DEEPEST: usize = 100;
/// Nodes of a scene, each counted as often as it is instantiated.
const MOST_NODES: usize = 1_000_000;

/// Everything that the scene instantiates.
pub(super) fn mesh(dae: &Dae) -> Result<TriMesh, Inside> {
    let mut scene = Scene { dae, geometries: Geometries::new(dae), builder: Builder::default(), nodes: 0 };
    let unit = unit(dae)?;
    for node in visual_scene(dae)?.children() {
        scene.node(node, &Placed::scaled(unit), 0)?;
    }
    scene.builder.finish()
}

/// Metres per unit of length.
fn unit(dae: &Dae) -> Result<f64, Inside> {
    let Some(unit) = child(dae.root(), "asset").and_then(|asset| child(asset, "unit")) else { return Ok(1.0) };
    let Some(written) = unit.attribute("meter") else { return Ok(1.0) };
    let meter: Option<f64> = written.trim().parse().ok().filter(|m: &f64| *m > 0.0 && m.is_finite());
    meter.ok_or_else(|| dae.fault(unit, format!("meter=\"{written}\" is no length above 0")))
}

/// The scene that the file shows; its first, if it says nothing.
fn visual_scene<'a>(dae: &Dae<'a>) -> Result<Node<'a, 'a>, Inside> {
    if let Some(instance) = child(dae.root(), "scene").and_then(|s| child(s, "instance_visual_scene")) {
        return dae.target(instance, "url");
    }
    let first = dae.root().descendants().find(|n| n.tag_name().name() == "visual_scene");
    first.ok_or(Inside::Empty)
}

struct Scene<'a, 'd> {
    dae: &'d Dae<'a>,
    geometries: Geometries<'a, 'd>,
    builder: Builder,
    nodes: usize,
}

impl<'a> Scene<'a, '_> {
    fn node(&mut self, node: Node<'a, 'a>, parent: &Placed, depth: usize) -> Result<(), Inside> {
        if node.tag_name().name() != "node" {
            return Ok(());
        }
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > MOST_NODES {
            let reason = format!("nodes within nodes more than {DEEPEST} deep, or more than {MOST_NODES} of them");
            return Err(self.dae.fault(node, reason + "; does one instantiate itself?"));
        }
        let mut placed = parent.clone();
        for part in node.children().filter(Node::is_element) {
            placed = placed.then(&self.transform(part)?);
        }
        for part in node.children() {
            match part.tag_name().name() {
                "node" => self.node(part, &placed, depth + 1)?,
                "instance_node" => self.node(self.dae.target(part, "url")?, &placed, depth + 1)?,
                "instance_geometry" => {
                    let geometry = self.dae.target(part, "url")?;
                    self.geometries.add(geometry, &placed, &mut self.builder)?;
                }
                "instance_controller" => {
                    let geometry = self.skinned(self.dae.target(part, "url")?)?;
                    self.geometries.add(geometry, &placed, &mut self.builder)?;
                }
                _ => (),
            }
        }
        Ok(())
    }

    /// The geometry that a controller (a skin over bones, a morph) starts from.
    fn skinned(&self, controller: Node<'a, 'a>) -> Result<Node<'a, 'a>, Inside> {
        let mut target = controller;
        for _ in 0..DEEPEST {
            let Some(by) = target.children().find(|c| matches!(c.tag_name().name(), "skin" | "morph")) else {
                return Ok(target);
            };
            target = self.dae.target(by, "source")?;
        }
        Err(self.dae.fault(controller, "controllers that lead in a circle"))
    }

    /// One transform element of a node; the identity if it is none.
    fn transform(&self, element: Node) -> Result<Placed, Inside> {
        let name = element.tag_name().name();
        let length = match name {
            "matrix" => 16,
            "rotate" => 4,
            "translate" | "scale" => 3,
            "lookat" | "skew" => return Err(self.dae.fault(element, "this transform is not read")),
            _ => return Ok(Placed::scaled(1.0)),
        };
        let v = self.dae.numbers(element)?;
        if v.len() != length {
            return Err(self.dae.fault(element, format!("{length} numbers are needed, there are {}", v.len())));
        }
        Ok(match name {
            "matrix" if v[12..] == [0.0, 0.0, 0.0, 1.0] => Placed {
                linear: Mat3::new(v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]),
                offset: Vec3::new(v[3], v[7], v[11]),
            },
            "matrix" => return Err(self.dae.fault(element, "the last row of a matrix must be 0 0 0 1")),
            "rotate" => Placed { linear: rotation(&v), offset: Vec3::zeros() },
            "scale" => Placed { linear: Mat3::from_diagonal(&Vec3::new(v[0], v[1], v[2])), offset: Vec3::zeros() },
            _ => Placed { linear: Mat3::identity(), offset: Vec3::new(v[0], v[1], v[2]) },
        })
    }
}

/// By `[x, y, z, degrees]`; an axis of no length turns nothing.
fn rotation(v: &[f64]) -> Mat3 {
    let axis = nalgebra::Unit::try_new(Vec3::new(v[0], v[1], v[2]), 0.0);
    axis.map_or_else(Mat3::identity, |axis| *nalgebra::Rotation3::from_axis_angle(&axis, v[3].to_radians()).matrix())
}
