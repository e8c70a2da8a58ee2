//! Where file names lead.

use super::support::{Folder, cuboid, obj};
use realnoid::shape::{MeshFault, Meshes, SearchPaths};
use std::ffi::OsString;
use std::path::PathBuf;

/// Which of several boxes was read: its height.
fn height(meshes: &Meshes, name: &str) -> f64 {
    let mesh = meshes.mesh(name).unwrap_or_else(|fault| panic!("{fault}"));
    mesh.vertices.iter().map(|v| v.z).fold(0.0, f64::max)
}

fn box_of(height: f64) -> String {
    obj(&cuboid([1.0, 1.0, height]))
}

fn joined(folders: &[PathBuf]) -> OsString {
    std::env::join_paths(folders).unwrap()
}

fn manifest(name: &str) -> String {
    format!("<?xml version=\"1.0\"?>\n<package format=\"3\"><name>{name}</name></package>")
}

const URI: &str = "package://robot/meshes/a.obj";

#[test]
fn relative_absolute_and_file_addresses() {
    let folder = Folder::with("mesh es/a b.obj", box_of(2.0));
    let path = folder.path().join("mesh es/a b.obj").display().to_string();
    let meshes = folder.meshes();
    for name in [
        "mesh es/a b.obj",
        &path,
        &format!("file://{path}"),
        &format!("FILE://localhost{path}"),
        &format!("file://{}", path.replace(' ', "%20")),
    ] {
        assert_eq!(height(&meshes, name), 2.0, "{name}");
    }
}

#[test]
fn addresses_that_are_refused() {
    let meshes = Folder::new().meshes();
    for (name, why) in [
        ("model://robot/a.obj", "package://NAME"),
        ("http://example.com/a.obj", "only files of this computer"),
        ("file://meshes/a.obj", "starts with a slash"),
        ("file:///a%2", "two hex digits"),
        ("file:///a%+f", "two hex digits"),
    ] {
        let fault = meshes.mesh(name).unwrap_err();
        assert!(matches!(fault, MeshFault::Address { .. }), "{fault}");
        assert!(fault.to_string().contains(why) && fault.to_string().contains(name), "{fault}");
    }
}

/// Each place hides the ones after it: told, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH, a folder above the URDF.
#[test]
fn packages_are_looked_for_in_order() {
    let folder = Folder::new();
    folder.write("told/meshes/a.obj", box_of(1.0));
    folder.write("ros/robot/meshes/a.obj", box_of(2.0));
    folder.write("prefix/share/robot/meshes/a.obj", box_of(3.0));
    folder.write("robot/meshes/a.obj", box_of(4.0));
    let urdf = folder.path().join("robot/urdf/deep/robot.urdf");
    std::fs::create_dir_all(urdf.parent().unwrap()).unwrap();
    let told = [("robot".to_owned(), folder.path().join("told"))];
    let ros = joined(&[folder.path().join("none"), folder.path().join("ros")]);
    let ament = joined(&[folder.path().join("prefix")]);
    let paths = |ros: &OsString, ament: &OsString| SearchPaths {
        ros_package_path: ros.clone(),
        ament_prefix_path: ament.clone(),
    };
    let none = OsString::new();
    assert_eq!(height(&Meshes::with_paths(&urdf, &told, paths(&ros, &ament)), URI), 1.0);
    assert_eq!(height(&Meshes::with_paths(&urdf, &[], paths(&ros, &ament)), URI), 2.0);
    assert_eq!(height(&Meshes::with_paths(&urdf, &[], paths(&none, &ament)), URI), 3.0);
    assert_eq!(height(&Meshes::with_paths(&urdf, &[], paths(&none, &none)), URI), 4.0);
}

#[test]
fn an_entry_of_the_ros_package_path_may_be_the_package() {
    let folder = Folder::with("robot/meshes/a.obj", box_of(2.0));
    let paths = SearchPaths { ros_package_path: joined(&[folder.path().join("robot")]), ..SearchPaths::default() };
    assert_eq!(height(&Meshes::with_paths(&PathBuf::from("x.urdf"), &[], paths), URI), 2.0);
}

/// The name in package.xml counts, not the name of its folder.
#[test]
fn the_manifest_names_the_package() {
    let folder = Folder::new();
    folder.write("ros/robot/package.xml", manifest("another"));
    folder.write("ros/robot/meshes/a.obj", box_of(1.0));
    folder.write("ros/checkout/package.xml", manifest(" robot "));
    folder.write("ros/checkout/meshes/a.obj", box_of(2.0));
    let paths = SearchPaths { ros_package_path: joined(&[folder.path().join("ros")]), ..SearchPaths::default() };
    assert_eq!(height(&Meshes::with_paths(&PathBuf::from("x.urdf"), &[], paths), URI), 2.0);
    let urdf = folder.path().join("ros/checkout/robot.urdf");
    assert_eq!(height(&Meshes::with_paths(&urdf, &[], SearchPaths::default()), URI), 2.0);
}

#[test]
fn a_file_that_the_first_package_lacks_is_found_in_the_next() {
    let folder = Folder::new();
    folder.write("one/robot/other.obj", box_of(1.0));
    folder.write("two/robot/meshes/a.obj", box_of(2.0));
    let ros = joined(&[folder.path().join("one"), folder.path().join("two")]);
    let meshes = Meshes::with_paths(
        &PathBuf::from("x.urdf"),
        &[],
        SearchPaths { ros_package_path: ros, ..SearchPaths::default() },
    );
    assert_eq!(height(&meshes, URI), 2.0);
    let fault = meshes.mesh("package://robot/gone.obj").unwrap_err().to_string();
    for place in ["one/robot/gone.obj", "two/robot/gone.obj"] {
        assert!(fault.contains(&folder.path().join(place).display().to_string()), "{fault}");
    }
}

#[test]
fn an_unknown_package_says_how_to_tell_it() {
    let folder = Folder::new();
    let ament = joined(&[folder.path().join("prefix")]);
    let paths = SearchPaths { ament_prefix_path: ament, ..SearchPaths::default() };
    let fault = Meshes::with_paths(&folder.path().join("r.urdf"), &[], paths).mesh(URI).unwrap_err();
    assert!(matches!(&fault, MeshFault::UnknownPackage { package, .. } if package == "robot"));
    for part in ["package \"robot\"", "ROS_PACKAGE_PATH (not set)", "AMENT_PREFIX_PATH (", "prefix"] {
        assert!(fault.to_string().contains(part), "{fault}");
    }
    let nameless = folder.meshes().mesh("package:///a.obj").unwrap_err();
    assert!(matches!(nameless, MeshFault::UnknownPackage { .. }), "{nameless}");
}
