//! The drawing of a robot, and the gallery of shapes.
#![allow(clippy::unwrap_used)] // a test may panic

use approx::assert_relative_eq;
use realnoid::cli::drawing::{Drawing, DrawnLink, draw, draw_robot};
use realnoid::cli::load::{Loaded, Source, load};
use realnoid::description::{Finish, Geometry, Origin, PlacedShape, Scaling};
use realnoid::mass::MassProperties;
use realnoid::math::{Mat3, Pose, Vec3};
use realnoid::model::Base;
use realnoid::shape::Meshes;
use roxmltree::{Document, Node};
use std::collections::BTreeSet;
use std::path::Path;

fn robot(urdf: Option<&str>) -> Loaded {
    load(Source { urdf: urdf.map(Path::new), packages: &[] }, Base::Fixed).map_err(|e| panic!("{e}")).unwrap()
}

fn placed(geometry: Geometry) -> PlacedShape {
    let (origin, finish, scaling) = (Origin::default(), Finish::default(), Scaling::default());
    PlacedShape { at: Default::default(), origin, geometry, finish, scaling, substance: None }
}

fn of_class<'a, 'i>(svg: &'a Document<'i>, class: &'static str) -> Vec<Node<'a, 'i>> {
    svg.descendants().filter(|n| n.attribute("class") == Some(class)).collect()
}

fn number(node: &Node, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Centre and radius of each sign, in the order of the page.
fn signs(svg: &Document, class: &'static str) -> Vec<[f64; 3]> {
    let circles = of_class(svg, class).into_iter().map(|g| g.first_element_child().unwrap());
    circles.map(|c| ["cx", "cy", "r"].map(|name| number(&c, name))).collect()
}

#[test]
fn the_humanoid_is_drawn_whole() {
    let robot = robot(None);
    let text = draw_robot(&robot);
    assert!(text.len() < 1_000_000, "{} bytes", text.len());
    let svg = Document::parse(&text).unwrap();
    let heavy: Vec<usize> = (0..robot.bodies.len()).filter(|i| robot.bodies[*i].properties.mass > 0.0).collect();
    assert_eq!(
        signs(&svg, "com").len(),
        2 * heavy.len() + 1,
        "one sign per link with mass and view, and one in the key"
    );
    assert_eq!(signs(&svg, "whole").len(), 2 + 1);
    let names: BTreeSet<&str> = of_class(&svg, "l").iter().filter_map(|n| n.text()).collect();
    for i in heavy {
        assert!(names.contains(robot.description.links[i].name.as_str()));
    }
    let shapes: usize = robot.description.links.iter().map(|l| l.visuals.len()).sum();
    assert_eq!(of_class(&svg, "f").len(), 2 * shapes, "every visual in both views");
}

/// Two boxes whose centres are 1 m apart give the scale; everything else must agree with it.
#[test]
fn signs_and_axes_are_to_scale() {
    let shapes = [placed(Geometry::Box { size: [0.2, 0.2, 0.2] })];
    let weight = |mass: f64, k: [f64; 3]| MassProperties {
        mass,
        center: Vec3::zeros(),
        inertia: Mat3::from_diagonal(&Vec3::from(k).map(|k| mass * k * k)),
    };
    let gyration = [0.05, 0.07, 0.09];
    let link = |name, z: f64, properties| DrawnLink {
        name,
        pose: Pose::translation(0.0, 0.3, z),
        shapes: &shapes,
        properties,
    };
    let links = vec![link("low", 0.0, weight(8.0, gyration)), link("high", 1.0, weight(2.0, gyration))];
    let text = draw(&Drawing { title: "two", links, meshes: &Meshes::default() });
    let svg = Document::parse(&text).unwrap();
    let [low, high, ..] = signs(&svg, "com")[..] else { panic!("no signs") };
    let scale = low[1] - high[1];
    assert!(scale > 100.0 && low[0] == high[0], "the second one is straight above");
    assert_relative_eq!(low[2] / high[2], 2.0, max_relative = 1e-2);
    // The whole: at a fifth of the way, from the 8 kg to the 2 kg.
    assert_relative_eq!(low[1] - signs(&svg, "whole")[0][1], 0.2 * scale, epsilon = 0.02);
    // From the front X is out of the page, Y to the right, Z up; from the right X is to the right.
    let lengths = |class| -> Vec<f64> {
        let length = |n: &Node| (number(n, "x2") - number(n, "x1")).hypot(number(n, "y2") - number(n, "y1"));
        of_class(&svg, class).iter().map(length).collect()
    };
    // Two links per view in which the axis is seen; the last line of each class is in the key.
    for (class, k, views) in [("a1", gyration[0], 1), ("a2", gyration[1], 1), ("a3", gyration[2], 2)] {
        let found = lengths(class);
        assert_eq!(found.len(), 2 * views + 1, "{class}");
        for length in &found[..2 * views] {
            assert_relative_eq!(*length, k * scale, epsilon = 0.2);
        }
    }
}

/// A box's outline reaches exactly as far as the box.
#[test]
fn an_outline_is_where_the_shape_is() {
    let shapes = [placed(Geometry::Box { size: [0.2, 0.5, 1.0] })];
    let links =
        vec![DrawnLink { name: "box", pose: Pose::identity(), shapes: &shapes, properties: MassProperties::ZERO }];
    let text = draw(&Drawing { title: "box", links, meshes: &Meshes::default() });
    let svg = Document::parse(&text).unwrap();
    let sizes: Vec<[f64; 2]> = of_class(&svg, "f").iter().map(|n| extent(n.attribute("d").unwrap())).collect();
    let [front, side] = sizes[..] else { panic!("{sizes:?}") };
    for (size, width) in [(front, 0.5), (side, 0.2)] {
        assert_relative_eq!(size[0] / size[1], width, max_relative = 1e-3);
    }
    assert_eq!(front[1], side[1], "one scale");
}

/// Width and height of a path.
fn extent(path: &str) -> [f64; 2] {
    let numbers: Vec<f64> = path
        .split(|c: char| c.is_ascii_alphabetic() || c == ' ')
        .filter(|t| !t.is_empty())
        .map(|t| t.parse().unwrap())
        .collect();
    [0, 1].map(|i| {
        let along = || numbers.iter().skip(i).step_by(2).copied();
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    })
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let missing = Geometry::Mesh { filename: "nowhere.stl".into(), scale: [1.0; 3] };
    let shapes = [placed(missing), placed(Geometry::Sphere { radius: 0.1 })];
    let link = DrawnLink { name: "arm", pose: Pose::identity(), shapes: &shapes, properties: MassProperties::ZERO };
    let text = draw(&Drawing { title: "one", links: vec![link], meshes: &Meshes::default() });
    let svg = Document::parse(&text).unwrap();
    assert_eq!(of_class(&svg, "f").len(), 2, "the sphere is drawn in both views");
    let words: Vec<&str> = of_class(&svg, "l").iter().filter_map(|n| n.text()).collect();
    assert!(words.contains(&"not drawn:") && words.iter().any(|w| w.contains("nowhere.stl")), "{words:?}");
}

#[test]
fn names_are_text_and_nothing_is_a_picture_too() {
    let title = "a<b>&\"c\"\u{1}";
    let text = draw(&Drawing { title, links: vec![], meshes: &Meshes::default() });
    let svg = Document::parse(&text).unwrap();
    assert_eq!(of_class(&svg, "h")[0].text(), Some("a<b>&\"c\""));
    let huge = [placed(Geometry::Sphere { radius: 1e200 })];
    let far = Pose::translation(1e300, 0.0, 0.0);
    let link = DrawnLink { name: "far", pose: far, shapes: &huge, properties: MassProperties::ZERO };
    let text = draw(&Drawing { title, links: vec![link], meshes: &Meshes::default() });
    assert!(Document::parse(&text).is_ok() && !text.contains("NaN") && !text.contains("inf"), "{text}");
}

/// Every kind of shape once, all drawn; nothing is found but how some collide.
#[test]
fn the_gallery_shows_every_shape() {
    let robot = robot(Some("urdf/shapes.urdf"));
    assert!(robot.findings.iter().all(|f| f.code == "collides-as"), "{:?}", robot.findings);
    let shapes = || robot.description.links.iter().filter_map(|l| l.body.as_ref()).flat_map(|b| &b.shapes);
    let kinds: BTreeSet<&str> = shapes().map(|s| s.geometry.kind()).collect();
    let table = std::fs::read_to_string("docs/tags.md").unwrap();
    let (_, section) = table.split_once("\n## Shapes").unwrap();
    let documented: BTreeSet<&str> =
        section.lines().filter_map(|l| l.strip_prefix("| `<")?.split_once('>')).map(|(kind, _)| kind).collect();
    assert!(documented.len() >= 20, "{documented:?}");
    assert_eq!(kinds, documented);
    let faces: BTreeSet<u32> = shapes()
        .filter_map(|s| match s.geometry {
            Geometry::Polyhedron { faces, .. } => Some(faces),
            _ => None,
        })
        .collect();
    assert_eq!(faces, BTreeSet::from([4, 6, 8, 12, 20]));
    let text = draw_robot(&robot);
    assert!(text.len() < 1_000_000 && !text.contains("not drawn"));
    let svg = Document::parse(&text).unwrap();
    // Discs and planes lean towards the viewer in front: from the side they are lines.
    let lines = shapes().filter(|s| matches!(s.geometry, Geometry::Disc { .. } | Geometry::Plane { .. })).count();
    assert_eq!(of_class(&svg, "f").len(), 2 * shapes().count() - lines);
}
