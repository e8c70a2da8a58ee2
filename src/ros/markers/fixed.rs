//! Markers that move with the frames of their links: made once, and sent again only to new subscribers.

use super::kinds::{Kind, MarkerSettings};
use super::marker::{Label, color};
use crate::contact::Reach;
use crate::mass::MassProperties;
use crate::math::{Pose, Quat, Vec3};
use crate::model::{Axis, AxisKind, LinkFrame, Model};
use crate::monitor::{normals, wireframe};
use crate::ros::messages::{Color, Marker};
use crate::ros::tf::WORLD;
use crate::world::Snapshot;
use nalgebra::Unit;
use std::f64::consts::{PI, TAU};

/// Length of normals, m.
const NORMAL: f64 = 0.03;
/// Radius of the arcs of ranges, and half of the length of axes, m.
const RANGE: f64 = 0.1;
/// One line of an arc turns this far at most, rad.
const ARC_STEP: f64 = PI / 36.0;
/// Length of principal axes in sizes of centres of mass, of bodies (B-17) and of links (J-17).
const BODY_AXES: f64 = 40.0;
const LINK_AXES: f64 = 20.0;
/// Radius of a centre of mass with size 0, of a link that does not collide, m.
const NO_SHAPE: f64 = 0.01;

const SHAPE: Color = color(0.2, 0.8, 0.4);
const FACE: Color = color(0.9, 0.9, 0.2);
const AXIS: Color = color(1.0, 0.4, 0.1);
const SPAN: Color = color(0.9, 0.7, 0.1);
const HAND: Color = color(1.0, 1.0, 1.0);
/// X, Y, Z as everywhere in ROS.
const XYZ: [Color; 3] = [color(1.0, 0.0, 0.0), color(0.0, 0.8, 0.0), color(0.2, 0.4, 1.0)];

/// All of them, as things stand in `snapshot`.
pub fn fixed(m: &Model, snapshot: &Snapshot, settings: &MarkerSettings) -> Vec<Marker> {
    let mut all = vec![];
    shapes(m, settings, &mut all);
    for (i, axis) in m.axes.iter().enumerate() {
        if let Some(joint) = Joint::of(m, i, snapshot) {
            joint.show(axis, i, settings, &mut all);
        }
    }
    let names = [Kind::CentersOfMass, Kind::PrincipalAxes];
    for (i, link) in m.links.iter().enumerate().filter(|(_, link)| link.mass > 0.0) {
        let body = MassProperties { mass: link.mass, center: link.center, inertia: link.inertia };
        weight(m, (i, i, &body), (names, BODY_AXES), settings, &mut all);
    }
    let names = [Kind::LinkCentersOfMass, Kind::LinkPrincipalAxes];
    for (i, link, whole) in joint_links(m) {
        weight(m, (i, link, &whole), (names, LINK_AXES), settings, &mut all);
    }
    all
}

/// Edges and normals of what collides.
fn shapes(m: &Model, settings: &MarkerSettings, all: &mut Vec<Marker>) {
    for (id, c) in m.colliders.iter().enumerate() {
        let frame = c.link.map_or(WORLD, |link| m.links[link].name.as_str());
        if settings.shows(Kind::Wireframes) {
            all.push(Label { ns: Kind::Wireframes.name(), id, frame }.lines(&c.pose, &wireframe(&c.form), SHAPE));
        }
        if settings.shows(Kind::Normals) {
            all.push(Label { ns: Kind::Normals.name(), id, frame }.lines(&c.pose, &normals(&c.form, NORMAL), FACE));
        }
    }
}

/// A joint of the URDF between two links.
struct Joint<'a> {
    parent: &'a str,
    child: &'a str,
    /// Where the child's frame is in the parent's if the axis is at 0.
    zero: Pose,
    direction: Unit<Vec3>,
    /// Perpendicular to it: where 0 is shown.
    side: Vec3,
}

impl<'a> Joint<'a> {
    /// `None` where there is none any more.
    fn of(m: &'a Model, axis: usize, snapshot: &Snapshot) -> Option<Self> {
        let child = m.carried(axis)?;
        let parent = m.links[child].parent?;
        if snapshot.cut_off.get(child).is_some_and(|cut_off| *cut_off) {
            return None;
        }
        let (a, at) = (&m.axes[axis], snapshot.position[axis]);
        let direction = Unit::new_normalize(a.direction);
        let back = match a.kind {
            AxisKind::Rotary => Pose::from_parts(Vec3::zeros().into(), Quat::from_axis_angle(&direction, -at)),
            AxisKind::Linear => Pose::from_parts((a.direction * -at).into(), Quat::identity()),
        };
        let away = if direction.x.abs() < 0.7 { Vec3::x() } else { Vec3::z() };
        Some(Self {
            parent: &m.links[parent].name,
            child: &m.links[child].name,
            zero: snapshot.link_pose[parent].inv_mul(&snapshot.link_pose[child]) * back,
            direction,
            side: direction.cross(&away).cross(&direction).normalize(),
        })
    }

    /// Axis and range; the hand that shows where the axis stands is in the frame of the child.
    fn show(&self, axis: &Axis, id: usize, settings: &MarkerSettings, all: &mut Vec<Marker>) {
        let d = *self.direction;
        if settings.shows(Kind::Axes) {
            let label = Label { ns: Kind::Axes.name(), id, frame: self.child };
            all.push(label.lines(&Pose::identity(), &[d * -RANGE, d * RANGE], AXIS));
        }
        if settings.shows(Kind::Ranges) {
            let label = |id, frame| Label { ns: Kind::Ranges.name(), id, frame };
            let (span, hand) = match axis.kind {
                AxisKind::Rotary => (self.arc(axis), [Vec3::zeros(), self.side * RANGE]),
                AxisKind::Linear => (self.track(axis), [Vec3::zeros(), self.side * (0.5 * RANGE)]),
            };
            all.push(label(2 * id, self.parent).lines(&self.zero, &span, SPAN));
            all.push(label(2 * id + 1, self.child).lines(&Pose::identity(), &hand, HAND));
        }
    }

    /// From the middle to the lower end, along the arc, and back from the upper end; without a range a full circle.
    fn arc(&self, axis: &Axis) -> Vec<Vec3> {
        let limited = axis.lower.is_finite() && axis.upper.is_finite() && axis.upper - axis.lower < TAU;
        let (from, to) = if limited { (axis.lower, axis.upper) } else { (-PI, PI) };
        let steps = ((to - from) / ARC_STEP).ceil().max(1.0) as u32;
        let at = |k: u32| {
            let angle = from + (to - from) * f64::from(k) / f64::from(steps);
            Quat::from_axis_angle(&self.direction, angle) * self.side * RANGE
        };
        let mut lines: Vec<Vec3> = (0..steps).flat_map(|k| [at(k), at(k + 1)]).collect();
        if limited {
            lines.extend([Vec3::zeros(), at(0), Vec3::zeros(), at(steps)]);
        }
        lines
    }

    /// From the lower to the upper end, with a mark at both; an end that is not there is 1 m away.
    fn track(&self, axis: &Axis) -> Vec<Vec3> {
        let (from, to) = (axis.lower.max(-1.0), axis.upper.min(1.0));
        let (from, to) = (self.direction.scale(from.min(to)), self.direction.scale(to));
        let mark = self.side * (0.25 * RANGE);
        vec![from, to, from - mark, from + mark, to - mark, to + mark]
    }
}

/// Bodies of the model that weigh something and move, each with a link that is on it, as one in that link's frame.
fn joint_links(m: &Model) -> Vec<(usize, usize, MassProperties)> {
    let on = |body: usize| {
        let seats = m.links.iter().enumerate().filter_map(move |(i, link)| match link.frame {
            LinkFrame::OnBody { body: b, offset } if b == body => Some((i, offset)),
            _ => None,
        });
        seats.collect::<Vec<_>>()
    };
    let one = |body: usize| {
        let seats = on(body);
        let is_root = |i: usize| m.is_root(i) || m.links[i].membership.as_ref().is_some_and(|member| member.root);
        let (link, root) = *seats.iter().find(|(i, _)| is_root(*i)).or(seats.first())?;
        let part = |(i, pose): &(usize, Pose)| {
            let l = &m.links[*i];
            MassProperties { mass: l.mass, center: l.center, inertia: l.inertia }.placed(&root.inv_mul(pose))
        };
        let whole = MassProperties::sum(&seats.iter().map(part).collect::<Vec<_>>());
        (whole.mass > 0.0).then_some((body, link, whole))
    };
    (1..m.bodies.len()).filter_map(one).collect()
}

/// Centre of mass and principal axes.
fn weight(
    m: &Model,
    (id, link, body): (usize, usize, &MassProperties),
    ([centers, axes], length): ([Kind; 2], f64),
    settings: &MarkerSettings,
    all: &mut Vec<Marker>,
) {
    let frame = m.links[link].name.as_str();
    let size = if settings.size > 0.0 { settings.size } else { least_half_edge(m, link) };
    if settings.shows(centers) {
        all.push(Label { ns: centers.name(), id, frame }.ball(&body.center, size, settings.color));
    }
    if settings.shows(axes) {
        let principal = body.principal().axes;
        let line = |k: usize| [body.center, body.center + principal.column(k) * (length * size)];
        let (points, colors) =
            (0..3).map(|k| (line(k), [XYZ[k]; 2])).fold((vec![], vec![]), |(mut p, mut c), (l, x)| {
                p.extend(l);
                c.extend(x);
                (p, c)
            });
        all.push(Label { ns: axes.name(), id, frame }.colored(&Pose::identity(), &points, colors));
    }
}

/// B-17: of the box around a link's collision shapes, along the axes of its frame, m.
fn least_half_edge(m: &Model, link: usize) -> f64 {
    let own = m.colliders.iter().filter(|c| c.link == Some(link));
    let boxes = own.filter_map(|c| Some(Reach::of(&c.form, 0.0)?.bounds(&c.pose)));
    let whole = boxes.reduce(|a, b| a.union(&b));
    whole.map_or(NO_SHAPE, |b| 0.5 * (b.max - b.min).min())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(lower: f64, upper: f64, kind: AxisKind) -> Axis {
        let text = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
            <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
            <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"#;
        let d = crate::description::read(text, "r.urdf").description.unwrap();
        let m = Model::build(&d, &[MassProperties::ZERO; 2], crate::model::Base::Fixed, Pose::identity());
        Axis { lower, upper, kind, ..m.axes[0].clone() }
    }

    fn joint() -> Joint<'static> {
        Joint { parent: "a", child: "b", zero: Pose::identity(), direction: Vec3::z_axis(), side: Vec3::x() }
    }

    #[test]
    fn an_arc_goes_from_the_lower_to_the_upper_end() {
        let lines = joint().arc(&axis(-0.5, 1.0, AxisKind::Rotary));
        let at = |angle: f64| Vec3::new(angle.cos(), angle.sin(), 0.0) * RANGE;
        assert!((lines[0] - at(-0.5)).norm() < 1e-12);
        assert!((lines[lines.len() - 1] - at(1.0)).norm() < 1e-12);
        let circle = joint().arc(&axis(f64::NEG_INFINITY, 1.0, AxisKind::Rotary));
        assert!((circle[0] - circle[circle.len() - 1]).norm() < 1e-12);
    }

    #[test]
    fn a_track_ends_where_the_slider_does() {
        let lines = joint().track(&axis(-0.1, f64::INFINITY, AxisKind::Linear));
        assert_eq!((lines[0], lines[1]), (Vec3::z() * -0.1, Vec3::z()));
    }
}
