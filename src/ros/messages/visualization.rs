//! visualization_msgs, and what it contains.

use super::{Header, Shared, Time, Vector3};
use crate::record::messages::Pose;
use serde::Serialize;

/// Kinds of markers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MarkerKind {
    /// A ball at the pose.
    Sphere = 2,
    /// A line for every two points.
    LineList = 5,
    /// A ball at every point.
    SphereList = 7,
}

/// What becomes of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MarkerAction {
    /// It is shown from now on as it is here.
    Add = 0,
    /// It goes.
    Delete = 2,
    /// All go.
    DeleteAll = 3,
}

/// std_msgs/ColorRGBA.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Color {
    /// 0 … 1.
    pub r: f32,
    /// 0 … 1.
    pub g: f32,
    /// 0 … 1.
    pub b: f32,
    /// 0 (not seen) … 1.
    pub a: f32,
}

/// visualization_msgs/Marker.
#[derive(Clone, Debug, Serialize)]
pub struct Marker {
    /// Stamp 0: where the frame is now.
    pub header: Header,
    /// Kind of what is shown.
    pub ns: &'static str,
    /// Unique within `ns`.
    pub id: i32,
    /// A [`MarkerKind`].
    pub kind: i32,
    /// A [`MarkerAction`].
    pub action: i32,
    /// In the frame of the header.
    pub pose: Pose,
    /// m; of lines, x is their width.
    pub scale: Vector3,
    /// Of all of it.
    pub color: Color,
    /// 0: until it is deleted.
    pub lifetime: Time,
    /// It moves with its frame.
    pub frame_locked: bool,
    /// In the marker's pose.
    pub points: Shared<Vec<Vector3>>,
    /// Per point, or none.
    pub colors: Shared<Vec<Color>>,
    /// What comes after it is not used by these kinds.
    pub rest: Unused,
}

/// The end of visualization_msgs/Marker: textures, text and mesh files, all empty.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Unused {
    texture_resource: &'static str,
    texture: CompressedImage,
    uv_coordinates: Vec<[f32; 2]>,
    text: &'static str,
    mesh_resource: &'static str,
    mesh_file: MeshFile,
    mesh_use_embedded_materials: bool,
}

#[derive(Clone, Debug, Default, Serialize)]
struct CompressedImage {
    header: Header,
    format: &'static str,
    data: Vec<u8>,
}

#[derive(Clone, Debug, Default, Serialize)]
struct MeshFile {
    filename: &'static str,
    data: Vec<u8>,
}

/// visualization_msgs/MarkerArray.
#[derive(Clone, Debug, Serialize)]
pub struct MarkerArray {
    /// Markers.
    pub markers: Vec<Marker>,
}
