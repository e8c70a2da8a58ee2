//! From the world to the page.

use crate::math::Vec3;
use crate::shape::Bounds;

/// A point on the page: pixels to the right and down.
pub(super) type Point = [f64; 2];

/// From where the robot is seen.
pub(super) struct Side {
    /// Heading.
    pub title: &'static str,
    /// Unit vectors of the world: to the right on the page, up on the page, and towards the viewer.
    pub right: Vec3,
    pub up: Vec3,
    pub near: Vec3,
    /// Names of the first two directions.
    pub axes: [&'static str; 2],
}

/// The viewer stands before the robot and looks along −X.
pub(super) const FRONT: Side = Side {
    title: "front",
    right: Vec3::new(0.0, 1.0, 0.0),
    up: Vec3::new(0.0, 0.0, 1.0),
    near: Vec3::new(1.0, 0.0, 0.0),
    axes: ["Y", "Z"],
};

/// The viewer stands at the robot's right and looks along +Y.
pub(super) const RIGHT: Side = Side {
    title: "right side",
    right: Vec3::new(1.0, 0.0, 0.0),
    up: Vec3::new(0.0, 0.0, 1.0),
    near: Vec3::new(0.0, -1.0, 0.0),
    axes: ["X", "Z"],
};

impl Side {
    /// Width and height of what is seen, m.
    pub fn size(&self, extent: &Bounds) -> [f64; 2] {
        let size = extent.max - extent.min;
        [self.right, self.up].map(|axis| size.dot(&axis.abs()))
    }
}

/// One side at its place on the page.
pub(super) struct View<'a> {
    /// From where.
    pub side: &'a Side,
    /// Where the lower left corner of the extent is on the page.
    pub corner: Point,
    /// Pixels per metre.
    pub scale: f64,
    /// What is to be seen.
    pub extent: Bounds,
}

impl View<'_> {
    /// Where a point of the world is on the page.
    pub fn at(&self, p: &Vec3) -> Point {
        let [x, y] = [self.side.right, self.side.up].map(|axis| {
            let least = self.extent.min.dot(&axis).min(self.extent.max.dot(&axis));
            (p.dot(&axis) - least) * self.scale
        });
        [self.corner[0] + x, self.corner[1] - y]
    }

    /// How near to the viewer, m.
    pub fn nearness(&self, p: &Vec3) -> f64 {
        p.dot(&self.side.near)
    }

    /// Width and height on the page, pixels.
    pub fn size(&self) -> [f64; 2] {
        self.side.size(&self.extent).map(|metres| metres * self.scale)
    }
}
