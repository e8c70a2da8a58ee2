//! Single markers.

use crate::math::{Pose, Vec3};
use crate::ros::messages::{Color, Header, Marker, MarkerAction, MarkerKind, Shared, Time, Unused, Vector3};

/// Width of lines, m.
const LINE_WIDTH: f64 = 0.002;

/// An opaque colour.
pub const fn color(r: f32, g: f32, b: f32) -> Color {
    Color { r, g, b, a: 1.0 }
}

/// Where a marker belongs, and what it is called.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    /// Its kind.
    pub ns: &'static str,
    /// Unique within the kind.
    pub id: usize,
    /// A link, or the world.
    pub frame: &'a str,
}

impl Label<'_> {
    /// A line for every two points, in metres.
    pub fn lines(self, x_fm: &Pose, points: &[Vec3], color: Color) -> Marker {
        self.marker(MarkerKind::LineList, x_fm, Vec3::new(LINE_WIDTH, 0.0, 0.0), (points, color))
    }

    /// A ball.
    pub fn ball(self, center: &Vec3, radius: f64, color: Color) -> Marker {
        let at = Pose::from_parts((*center).into(), nalgebra::UnitQuaternion::identity());
        self.marker(MarkerKind::Sphere, &at, Vec3::repeat(2.0 * radius), (&[], color))
    }

    /// A ball of this radius at every point.
    pub fn balls(self, points: &[Vec3], radius: f64, color: Color) -> Marker {
        self.marker(MarkerKind::SphereList, &Pose::identity(), Vec3::repeat(2.0 * radius), (points, color))
    }

    /// Takes a marker away.
    pub fn deleted(self) -> Marker {
        let nothing = (&[] as &[Vec3], Color::default());
        let marker = self.marker(MarkerKind::LineList, &Pose::identity(), Vec3::zeros(), nothing);
        Marker { action: MarkerAction::Delete as i32, ..marker }
    }

    /// The same lines with one colour per point.
    pub fn colored(self, x_fm: &Pose, points: &[Vec3], colors: Vec<Color>) -> Marker {
        let marker = self.lines(x_fm, points, color(1.0, 1.0, 1.0));
        Marker { colors: Shared::new(colors), ..marker }
    }

    fn marker(self, kind: MarkerKind, x_fm: &Pose, scale: Vec3, (points, color): (&[Vec3], Color)) -> Marker {
        Marker {
            header: Header { stamp: Time::default(), frame_id: self.frame.into() },
            ns: self.ns,
            id: i32::try_from(self.id).unwrap_or(i32::MAX),
            kind: kind as i32,
            action: MarkerAction::Add as i32,
            pose: x_fm.into(),
            scale: scale.into(),
            color,
            lifetime: Time::default(),
            frame_locked: true,
            points: Shared::new(points.iter().map(|p| Vector3::from(*p)).collect()),
            colors: Shared::new(vec![]),
            rest: Unused::default(),
        }
    }
}

/// Takes all markers of the topic away.
pub fn all_deleted() -> Marker {
    let label = Label { ns: "", id: 0, frame: crate::ros::tf::WORLD };
    Marker { action: MarkerAction::DeleteAll as i32, ..label.deleted() }
}
