//! The embedded humanoid as a description, read here on its own: these tests check the file, not the reader.

use realnoid::description::*;
use realnoid::math::Pose;
use realnoid::shape;
use roxmltree::{Document, Node};
use std::collections::HashMap;

pub const TEXT: &str = include_str!("../../urdf/origin.urdf");

pub fn numbers<const N: usize>(node: Node, attribute: &str) -> [f64; N] {
    let text = node.attribute(attribute).unwrap_or_else(|| panic!("{attribute} of {node:?}"));
    let values: Vec<f64> = text.split_whitespace().map(|w| w.parse().unwrap()).collect();
    values.try_into().unwrap()
}

fn number(node: Node, attribute: &str) -> f64 {
    numbers::<1>(node, attribute)[0]
}

pub fn child<'a, 'i>(node: Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.has_tag_name(tag))
}

pub fn all<'a, 'i: 'a>(node: Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.has_tag_name(tag))
}

fn origin(node: Node) -> Origin {
    let Some(origin) = child(node, "origin") else { return Origin::default() };
    let triple = |name| if origin.has_attribute(name) { numbers(origin, name) } else { [0.0; 3] };
    Origin { xyz: triple("xyz"), rpy: triple("rpy") }
}

fn geometry(node: Node) -> Geometry {
    let get = |name| number(node, name);
    match node.tag_name().name() {
        "box" => Geometry::Box { size: numbers(node, "size") },
        "sphere" => Geometry::Sphere { radius: get("radius") },
        "cylinder" => Geometry::Cylinder { radius: get("radius"), length: get("length") },
        "ellipsoid" => Geometry::Ellipsoid { radii: numbers(node, "radii") },
        "elliptic_cylinder" => {
            Geometry::EllipticCylinder { radius_x: get("radius_x"), radius_y: get("radius_y"), length: get("length") }
        }
        "frustum" => Geometry::Frustum {
            radius_x: get("radius_x"),
            radius_y: get("radius_y"),
            top_scale: get("top_scale"),
            length: get("length"),
        },
        "capsule" if node.has_attribute("radius") => {
            Geometry::Capsule { radius_top: get("radius"), radius_bottom: get("radius"), length: get("length") }
        }
        "capsule" => Geometry::Capsule {
            radius_top: get("radius_top"),
            radius_bottom: get("radius_bottom"),
            length: get("length"),
        },
        other => panic!("<{other}>"),
    }
}

/// `holder` carries an optional `<origin>` beside the shape; in `<visual>` and `<collision>` the shape is in `<geometry>`.
fn placed(holder: Node) -> PlacedShape {
    let around = child(holder, "geometry").unwrap_or(holder);
    let shape = around.children().find(|n| n.is_element() && !n.has_tag_name("origin")).unwrap();
    PlacedShape { at: Position::default(), origin: origin(holder), geometry: geometry(shape) }
}

fn link(node: Node) -> Link {
    let tags = child(node, "realnoid");
    let body = tags.and_then(|t| child(t, "body")).map(|body| {
        assert_eq!(body.attribute("dimension"), Some("3d"));
        Body {
            at: Position::default(),
            specific_gravity: number(body, "specific_gravity"),
            dimension: Dimension::Solid,
            l_scale: 1.0,
            shapes: all(body, "shape").map(placed).collect(),
        }
    });
    Link {
        name: node.attribute("name").unwrap().into(),
        at: Position::default(),
        inertial: None,
        visuals: all(node, "visual").map(placed).collect(),
        collisions: all(node, "collision").map(placed).collect(),
        body,
        proxies: tags.map(|t| all(t, "proxy").map(placed).collect()).unwrap_or_default(),
        surface: None,
        damping: None,
        deactivate: None,
        monitor: tags.and_then(|t| child(t, "monitor")).map(|_| MonitorFrame::Body),
    }
}

fn joint(node: Node) -> Joint {
    let end = |tag| child(node, tag).unwrap().attribute("link").unwrap().to_string();
    let at = Position::default();
    let limit = child(node, "limit").map(|l| Limit {
        at,
        lower: number(l, "lower"),
        upper: number(l, "upper"),
        effort: Some(number(l, "effort")),
        velocity: Some(number(l, "velocity")),
    });
    let dynamics = child(node, "dynamics");
    Joint {
        name: node.attribute("name").unwrap().into(),
        at,
        kind: if node.attribute("type") == Some("fixed") { JointKind::Fixed } else { JointKind::Revolute },
        parent: end("parent"),
        parent_at: at,
        child: end("child"),
        child_at: at,
        origin: origin(node),
        axis: child(node, "axis").map(|a| numbers(a, "xyz")).unwrap_or([1.0, 0.0, 0.0]),
        limit,
        damping: dynamics.map_or(0.0, |d| number(d, "damping")),
        friction: dynamics.map_or(0.0, |d| number(d, "friction")),
        mimic: None,
        drive: None,
        constraint: None,
    }
}

fn group(node: Node) -> JointGroup {
    let axis = |name| node.attribute(name).map(str::to_string);
    let kind = match node.attribute("type").unwrap() {
        "combined_hinge" => GroupKind::CombinedHinge,
        "cardan" => GroupKind::Cardan,
        "3dof" => GroupKind::ThreeDof,
        other => panic!("{other}"),
    };
    let name = node.attribute("name").unwrap().to_string();
    JointGroup { name, at: Position::default(), kind, h: axis("h"), p: axis("p"), b: axis("b"), e: axis("e") }
}

pub fn read() -> Description {
    let document = Document::parse(TEXT).unwrap();
    let robot = document.root_element();
    let tags = child(robot, "realnoid").unwrap();
    let chain = |n: Node| Chain {
        at: Position::default(),
        root: n.attribute("root").unwrap().into(),
        anchor: n.attribute("anchor").map(str::to_string),
        self_collision: n.attribute("self_collision") == Some("true"),
    };
    Description {
        name: robot.attribute("name").unwrap().into(),
        file: "origin.urdf".into(),
        text: TEXT.into(),
        links: all(robot, "link").map(link).collect(),
        joints: all(robot, "joint").map(joint).collect(),
        groups: all(tags, "joint_group").map(group).collect(),
        chains: all(tags, "chain").map(chain).collect(),
    }
}

/// Frame of every link in the frame of `base_link`, all axes at zero.
pub fn zero_pose(description: &Description) -> HashMap<&str, Pose> {
    let mut poses = HashMap::from([("base_link", Pose::identity())]);
    while poses.len() < description.links.len() {
        let before = poses.len();
        for j in &description.joints {
            if let Some(parent) = poses.get(j.parent.as_str()) {
                poses.insert(&j.child, parent * shape::pose(&j.origin));
            }
        }
        assert!(poses.len() > before, "links that no joint connects to base_link");
    }
    poses
}
