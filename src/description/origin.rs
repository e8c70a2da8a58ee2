//! `<origin xyz rpy>`, also as a quaternion (URDF 1.1).

use super::element::{Domain, Element};
use super::finding::Finding;
use super::report::Report;
use super::{Origin, unknown};
use nalgebra::{Quaternion, UnitQuaternion};

/// The attribute that URDF 1.1 added.
pub(super) const QUATERNION: &str = "quat_xyzw";

/// Origin given by the `<origin>` child of `element`; identity if there is none or it is wrong (reported).
pub(super) fn read(element: &Element, report: &mut Report) -> Origin {
    let Some(origin) = element.first("origin", report) else { return Origin::default() };
    unknown::attributes(&origin, &["xyz", "rpy", QUATERNION], report);
    let xyz = origin.vector("xyz", Domain::Any, report).unwrap_or_default();
    let rpy = origin.vector("rpy", Domain::Any, report).unwrap_or_default();
    Origin { xyz, rpy: read_quaternion(&origin, report).unwrap_or(rpy) }
}

fn read_quaternion(origin: &Element, report: &mut Report) -> Option<[f64; 3]> {
    let [x, y, z, w] = origin.vector(QUATERNION, Domain::Any, report)?;
    let quaternion = Quaternion::new(w, x, y, z);
    let fault = if !since(origin, 1) {
        report.add(Finding::warning(
            "quaternion-ignored",
            origin.place_of(QUATERNION, report),
            "quat_xyzw is ignored, as URDF before 1.1 does".into(),
            "write <robot version=\"1.1\" …>, or give the rotation as rpy",
        ));
        return None;
    } else if origin.value("rpy").is_some() {
        ("two-orientations", "both rpy and quat_xyzw are given", "keep one of them")
    } else if quaternion.norm() < f64::EPSILON {
        ("out-of-range", "this quaternion is zero: it is no orientation", "no rotation is quat_xyzw=\"0 0 0 1\"")
    } else {
        let (roll, pitch, yaw) = UnitQuaternion::from_quaternion(quaternion).euler_angles();
        return Some([roll, pitch, yaw]);
    };
    report.add(Finding::error(fault.0, origin.place_of(QUATERNION, report), fault.1.into(), fault.2));
    None
}

/// Does the robot say `version="1.minor"` or later? Without a version it is URDF 1.0.
pub(super) fn since(element: &Element, minor: u32) -> bool {
    let version = element.node.document().root_element().attribute("version").unwrap_or("1.0");
    let parts = version.trim().split_once('.').map(|(a, b)| (a.parse::<u32>(), b.parse::<u32>()));
    matches!(parts, Some((Ok(major), Ok(m))) if (major, m) >= (1, minor))
}
