//! A picture of the robot: its shapes seen from the front and from the side, where its mass is and how it is spread.

mod contour;
mod labels;
mod legend;
mod lines;
mod marks;
mod page;
mod parts;
mod svg;
mod view;

use super::load::Loaded;
use crate::description::{Link, PlacedShape};
use crate::dynamics::{Kinematics, kinematics, link_pose};
use crate::mass::MassProperties;
use crate::math::Pose;
use crate::shape::Meshes;

/// What to draw.
pub struct Drawing<'a> {
    /// Name of the robot.
    pub title: &'a str,
    /// Links, in the order in which the list names them.
    pub links: Vec<DrawnLink<'a>>,
    /// Where mesh and height files are.
    pub meshes: &'a Meshes,
}

/// One link.
pub struct DrawnLink<'a> {
    /// Name.
    pub name: &'a str,
    /// Its frame in the world, Z up.
    pub pose: Pose,
    /// What it looks like; a shape whose file cannot be read is left out, and the picture says so.
    pub shapes: &'a [PlacedShape],
    /// What it weighs, in its own frame.
    pub properties: MassProperties,
}

/// The picture as SVG text: front view, side view, the links with their masses, a key. One scale for all lengths; the area
/// of the sign for a centre of mass is in proportion to the mass, within bounds.
pub fn draw(drawing: &Drawing) -> String {
    page::page(drawing)
}

/// The picture of a robot whose axes are all at zero, as it is simulated.
pub fn draw_robot(robot: &Loaded) -> String {
    let m = &robot.model;
    let (q, angles) = (m.neutral(), vec![[0.0; 3]; m.eulers.len()]);
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &q, &vec![0.0; m.nv]);
    let links = robot.description.links.iter().zip(&robot.bodies).enumerate();
    let drawn = links.map(|(i, (link, body))| DrawnLink {
        name: &link.name,
        pose: link_pose(m, &k, &q, &angles, i),
        shapes: looks(link),
        properties: body.properties,
    });
    draw(&Drawing { title: &m.name, links: drawn.collect(), meshes: &robot.meshes })
}

/// What people see of a link: `<visual>`, else what its mass is made of, else what collides.
fn looks(link: &Link) -> &[PlacedShape] {
    let body = link.body.as_ref().map_or(&[][..], |b| &b.shapes);
    [&link.visuals, body, &link.collisions, &link.proxies].into_iter().find(|s| !s.is_empty()).unwrap_or(&[])
}
