//! Where the mass is and how it is spread: centres of mass and principal axes.

use super::svg::{line, quartered_circle};
use super::view::{Point, View};
use super::{Drawing, DrawnLink};
use crate::mass::MassProperties;
use crate::math::Vec3;

/// Radii of the signs, pixels: the heaviest link's, the least that can be seen, and the whole robot's.
const LARGEST: f64 = 9.0;
const SMALLEST: f64 = 2.0;
pub(super) const WHOLE: f64 = 12.0;

/// What is drawn of a link that has mass, in the world.
pub(super) struct Mark<'a> {
    /// Place in the list of links, from 1.
    pub number: usize,
    /// Name of the link.
    pub name: &'a str,
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub center: Vec3,
    /// Radius of the sign, pixels.
    pub radius: f64,
    /// Half lines of the principal axes, least moment first: half the radius of gyration about the axis, m.
    pub axes: [Vec3; 3],
}

/// Marks of all links with mass.
pub(super) fn marks<'a>(drawing: &Drawing<'a>) -> Vec<Mark<'a>> {
    let heavy: Vec<&DrawnLink> = drawing.links.iter().filter(|l| l.properties.mass > 0.0).collect();
    let heaviest = heavy.iter().map(|l| l.properties.mass).fold(0.0, f64::max);
    let mark = |(i, link): (usize, &&DrawnLink<'a>)| {
        let properties = link.properties.placed(&link.pose);
        let principal = properties.principal();
        let gyration = |i: usize| (principal.moments[i].max(0.0) / properties.mass).sqrt();
        let axis = |i: usize| principal.axes.column(i) * (gyration(i) / 2.0);
        Mark {
            number: i + 1,
            name: link.name,
            mass: properties.mass,
            center: properties.center,
            radius: radius(properties.mass, heaviest),
            axes: [axis(0), axis(1), axis(2)],
        }
    };
    heavy.iter().enumerate().map(mark).collect()
}

/// Area in proportion to the mass, down to what can be seen.
pub(super) fn radius(mass: f64, heaviest: f64) -> f64 {
    (LARGEST * (mass / heaviest).sqrt()).max(SMALLEST)
}

/// The whole robot, in the world.
pub(super) fn whole(drawing: &Drawing) -> MassProperties {
    let placed: Vec<MassProperties> = drawing.links.iter().map(|l| l.properties.placed(&l.pose)).collect();
    MassProperties::sum(&placed)
}

/// Principal axes, then centres of mass, the larger ones below.
pub(super) fn drawn(marks: &[Mark], view: &View) -> String {
    let mut text = String::new();
    for mark in marks {
        for (i, axis) in mark.axes.iter().enumerate() {
            let ends = [mark.center - axis, mark.center + axis].map(|p| view.at(&p));
            if length(ends) >= 0.5 {
                text += &line(["a1", "a2", "a3"][i], ends[0], ends[1]);
            }
        }
    }
    let mut by_size: Vec<&Mark> = marks.iter().collect();
    by_size.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    by_size.iter().for_each(|mark| text += &quartered_circle("com", view.at(&mark.center), mark.radius));
    text
}

/// The centre of mass of the whole with its plumb line to the ground.
pub(super) fn drawn_whole(center: &Vec3, view: &View, ground: f64) -> String {
    let at = view.at(center);
    let foot = view.at(&Vec3::new(center.x, center.y, ground));
    line("plumb", at, foot) + &quartered_circle("whole", at, WHOLE)
}

fn length([a, b]: [Point; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}
