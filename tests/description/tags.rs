//! Every tag is read as it is written, and its faults are told.

use super::*;

fn thigh(tags: &str) -> Link {
    sound(&robot(&format!("<realnoid>{tags}</realnoid>"), "", "")).links.remove(1)
}

fn drive(attributes: &str) -> Drive {
    let text = robot("", &format!("<realnoid><drive {attributes}/></realnoid>"), "");
    sound(&text).joints.remove(0).drive.unwrap()
}

#[test]
fn body_is_read() {
    let visual = r#"<visual><geometry><sphere radius="0.1"/></geometry></visual>"#;
    let text = |body: &str| robot(&format!("{visual}<realnoid>{body}</realnoid>"), "", "");
    let solid = sound(&text(r#"<body specific_gravity="1.05"/>"#)).links.remove(1).body.unwrap();
    assert_eq!(
        (solid.substance.specific_gravity, solid.substance.dimension, solid.l_scale),
        (1.05, Dimension::Solid, 1.0)
    );
    assert!(solid.shapes.is_empty());
    let hollow = r#"<body specific_gravity="2" dimension="2d" thickness="0.003" l_scale="1.5"/>"#;
    let hollow = sound(&text(hollow)).links.remove(1).body.unwrap();
    assert_eq!((hollow.substance.dimension, hollow.l_scale), (Dimension::Hollow { thickness: 0.003 }, 1.5));
    assert_eq!(codes(&text(r#"<body specific_gravity="1"/>"#)), ["body-over-inertial"]);
    assert_eq!(codes(&text(r#"<body specific_gravity="1" thickness="0.1"/>"#))[0], "thickness");
    assert_eq!(codes(&text(r#"<body specific_gravity="0"/>"#))[0], "static-body-moves");
    assert_eq!(codes(&robot("<realnoid><body specific_gravity='1'/></realnoid>", "", ""))[0], "body-without-shape");
}

#[test]
fn every_shape_is_read() {
    let cases = [
        (r#"<box size="1 2 3"/>"#, Geometry::Box { size: [1.0, 2.0, 3.0] }),
        (r#"<sphere radius="1"/>"#, Geometry::Sphere { radius: 1.0 }),
        (r#"<cylinder radius="1" length="2"/>"#, Geometry::Cylinder { radius: 1.0, length: 2.0 }),
        (r#"<capsule radius="1" length="2"/>"#, Geometry::Capsule { radius_top: 1.0, radius_bottom: 1.0, length: 2.0 }),
        (
            r#"<capsule radius_top="1" radius_bottom="3" length="2"/>"#,
            Geometry::Capsule { radius_top: 1.0, radius_bottom: 3.0, length: 2.0 },
        ),
        (r#"<ellipsoid radii="1 2 3"/>"#, Geometry::Ellipsoid { radii: [1.0, 2.0, 3.0] }),
        (
            r#"<elliptic_cylinder radius_x="1" radius_y="2" length="3"/>"#,
            Geometry::EllipticCylinder { radius_x: 1.0, radius_y: 2.0, length: 3.0 },
        ),
        (
            r#"<tube outer_radius="2" inner_radius="1" length="3"/>"#,
            Geometry::Tube { outer_radius: 2.0, inner_radius: 1.0, length: 3.0 },
        ),
        (r#"<cone radius="1" length="2"/>"#, Geometry::Cone { radius_x: 1.0, radius_y: 1.0, length: 2.0 }),
        (
            r#"<frustum radius_x="1" radius_y="2" top_scale="0.5" length="3"/>"#,
            Geometry::Frustum { radius_x: 1.0, radius_y: 2.0, top_scale: 0.5, length: 3.0 },
        ),
        (
            r#"<mesh filename="a.stl" scale="1 -1 1"/>"#,
            Geometry::Mesh { filename: "a.stl".into(), scale: [1.0, -1.0, 1.0] },
        ),
        (r#"<mesh filename="a.stl"/>"#, Geometry::Mesh { filename: "a.stl".into(), scale: [1.0; 3] }),
        (r#"<hemisphere radius="1"/>"#, Geometry::Hemisphere { radius: 1.0 }),
        (r#"<torus ring_radius="2" pipe_radius="1"/>"#, Geometry::Torus { ring_radius: 2.0, pipe_radius: 1.0 }),
        (
            r#"<oil_tank radius="2" length="3" cap_height="1"/>"#,
            Geometry::OilTank { radius: 2.0, length: 3.0, cap_height: 1.0 },
        ),
        (r#"<pyramid size="1 2 3"/>"#, Geometry::Pyramid { size: [1.0, 2.0, 3.0] }),
        (r#"<polyhedron faces="12" radius="1"/>"#, Geometry::Polyhedron { faces: 12, radius: 1.0 }),
        (r#"<disc outer_radius="1"/>"#, Geometry::Disc { outer_radius: 1.0, inner_radius: 0.0 }),
        (r#"<disc outer_radius="1" inner_radius="0.5"/>"#, Geometry::Disc { outer_radius: 1.0, inner_radius: 0.5 }),
        (r#"<plane size="1 2"/>"#, Geometry::Plane { size: [1.0, 2.0] }),
        (
            r#"<triangle a="0 0 0" b="1 0 0" c="0 1 0"/>"#,
            Geometry::Triangle { corners: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] },
        ),
        (
            r#"<quad a="0 0 0" b="1 0 0" c="1 1 0" d="0 1 0"/>"#,
            Geometry::Quad { corners: [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] },
        ),
        (
            r#"<terrain size="4 2 1" columns="3" heights="0 0 0  0 1 0"/>"#,
            Geometry::Terrain {
                size: [4.0, 2.0, 1.0],
                heights: Heights::Written { columns: 3, values: vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0] },
            },
        ),
        (
            r#"<terrain radius="1" height="0.1" filename="moon.png"/>"#,
            Geometry::SphericalTerrain {
                radius: 1.0,
                height: 0.1,
                heights: Heights::File { filename: "moon.png".into() },
            },
        ),
    ];
    for (text, expected) in cases {
        let proxy = thigh(&format!(r#"<proxy><origin xyz="0 0 1"/>{text}</proxy>"#)).proxies.remove(0);
        assert_eq!((&proxy.geometry, proxy.origin.xyz), (&expected, [0.0, 0.0, 1.0]), "in <proxy>");
        let body = thigh(&format!(r#"<body specific_gravity="1"><shape>{text}</shape></body>"#)).body.unwrap();
        assert_eq!(body.shapes[0].geometry, expected, "in <shape>");
        let visual = robot(&format!("<visual><geometry>{text}</geometry></visual>"), "", "");
        assert_eq!(sound(&visual).links[1].visuals[0].geometry, expected, "in <visual>");
    }
}

#[test]
fn finish_scale_and_substance_are_read() {
    let shape =
        |body: &str, shape: &str| thigh(&format!("<body specific_gravity='2' {body}>{shape}</body>")).body.unwrap();
    let body = shape(
        "",
        r#"<shape><frustum radius="1" top_scale="0.5" length="2" fillet="0.1" top_fillet="0.2" slice="0 3"/></shape>"#,
    );
    assert_eq!(
        body.shapes[0].finish,
        Finish { fillet: 0.1, top_fillet: Some(0.2), slice: Some([0.0, 3.0]), open: false }
    );
    let body =
        shape("", r#"<shape scale="1 2 -3" scale_top="0" scale_bottom="2"><capsule radius="1" length="1"/></shape>"#);
    assert_eq!(body.shapes[0].scaling, Scaling { factors: [1.0, 2.0, -3.0], top: 0.0, bottom: 2.0 });
    let walls = r#"<shape dimension="3d" specific_gravity="8"><sphere radius="1"/></shape>
        <shape thickness="0.02"><cylinder radius="1" length="1" caps="false"/></shape><shape><sphere radius="1"/></shape>"#;
    let body = shape(r#"dimension="2d" thickness="0.01""#, walls);
    let told: Vec<_> =
        body.shapes.iter().map(|s| body.substance_of(s)).map(|s| (s.specific_gravity, s.dimension)).collect();
    let hollow = |thickness| Dimension::Hollow { thickness };
    assert_eq!(told, [(8.0, Dimension::Solid), (2.0, hollow(0.02)), (2.0, hollow(0.01))]);
    assert!(body.shapes[1].finish.open);
    let polygons = r#"<shape><sphere radius="1"/></shape><shape polygonise="false"><sphere radius="1"/></shape>
        <shape segments="8" limit_subdivisions="true"><box size="1 1 1"/></shape><shape><torus ring_radius="2" pipe_radius="1"/></shape>"#;
    let body = shape(r#"polygonise="true" segments="24" flat_segments="4" zero_exponent="-9""#, polygons);
    let told: Vec<_> = body.shapes.iter().map(|s| body.substance_of(s).polygonise).collect();
    let later = shape(r#"segments="100""#, r#"<shape polygonise="true"><sphere radius="1"/></shape>"#);
    assert_eq!(later.substance_of(&later.shapes[0]).polygonise.map(|s| s.around), Some(100), "the body's segments");
    let into = |around, flat| Some(Subdivision { around, flat });
    assert_eq!(told, [into(24, 4), None, into(8, 1), None]);
    assert_eq!(body.zero_exponent, Some(-9));
}

#[test]
fn what_a_shape_does_not_take_is_told() {
    let told =
        |shape: &str| codes(&robot(&format!("<realnoid><body specific_gravity='1'>{shape}</body></realnoid>"), "", ""));
    let only = |shape: &str, code: &str| {
        let codes = told(shape);
        assert!(codes.contains(&code), "{code} is missing in {codes:?}");
    };
    only("<shape scale='1 0 1'><sphere radius='1'/></shape>", "out-of-range");
    let one = told("<shape><sphere radius='0'/></shape>");
    assert_eq!(one, ["out-of-range", "body-over-inertial"], "no word about a body without shapes");
    only("<shape scale='1 nan 1'><sphere radius='1'/></shape>", "not-finite");
    only("<shape scale='1 -1 1'><sphere radius='1'/></shape>", "mirrored");
    only("<shape scale='2 2 2'><mesh filename='a.stl'/></shape>", "scale-ignored");
    only("<shape scale_top='2'><sphere radius='1'/></shape>", "scale-ignored");
    only("<shape scale_top='-1'><capsule radius='1' length='1'/></shape>", "out-of-range");
    only("<shape polygonise='true'><box size='1 1 1' fillet='0.1'/></shape>", "polygonise-ignored");
    only("<shape polygonise='true' dimension='2d' thickness='0.1'><sphere radius='1'/></shape>", "polygonise-ignored");
    only("<shape segments='2001'><sphere radius='1'/></shape>", "out-of-range");
    only("<shape flat_segments='1.5'><sphere radius='1'/></shape>", "out-of-range");
    only("<shape segments='20'><sphere radius='1'/></shape>", "segments-ignored");
    only("<shape scale='1 1 1'><mesh filename='a.stl' scale='1 -1 1'/></shape>", "mirrored");
    only("<shape segments='2'><sphere radius='1'/></shape>", "out-of-range");
    only("<shape><cylinder radius='1' length='1' slice='1 0'/></shape>", "slice");
    only("<shape><cylinder radius='1' length='1' slice='0 7'/></shape>", "slice");
    only("<shape><terrain size='1 1 1' heights='0 0 0' columns='2'/></shape>", "terrain");
    only("<shape><terrain size='1 1 1' radius='2' filename='a.png'/></shape>", "terrain");
    only("<shape><terrain size='1 1 1'/></shape>", "terrain");
    only("<shape><terrain size='1 1 1' heights='0 x 0 0' columns='2'/></shape>", "bad-number");
    assert!(
        told("<shape scale='2 2 2'><torus ring_radius='2' pipe_radius='1'/></shape>")
            .iter()
            .all(|c| *c == "body-over-inertial")
    );
}

#[test]
fn faults_in_shapes_are_told() {
    let proxy = |shape: &str| codes(&robot(&format!("<realnoid><proxy>{shape}</proxy></realnoid>"), "", ""))[0];
    assert_eq!(proxy(""), "missing-shape");
    assert_eq!(proxy("<cube size='1 1 1'/>"), "unknown-shape");
    assert_eq!(proxy("<sphere radius='0'/>"), "out-of-range");
    assert_eq!(proxy("<sphere/>"), "missing-attribute");
    assert_eq!(proxy("<sphere radius='1' size='1'/>"), "unknown-attribute");
    assert_eq!(proxy("<capsule radius='1' radius_top='1' length='1'/>"), "radius");
    assert_eq!(proxy("<tube outer_radius='1' inner_radius='1' length='1'/>"), "tube-without-wall");
    assert_eq!(proxy("<polyhedron faces='5' radius='1'/>"), "out-of-range");
    assert_eq!(proxy("<sphere radius='1'/><sphere radius='1'/>"), "second-shape");
}

#[test]
fn odd_visuals_are_warnings_unless_they_give_the_mass() {
    let odd = "<visual><geometry><blob/></geometry><material><texture/></material></visual><visual/>
        <collision><geometry><sphere radius='nan'/></geometry></collision>";
    let text = robot(odd, "", "");
    let link = sound(&text).links.remove(1);
    assert!(link.visuals.is_empty() && link.collisions.is_empty());
    assert_eq!(codes(&text), ["unknown-shape", "unnamed-material", "missing-element", "not-finite"]);
    let with_body = robot(&format!("{odd}<realnoid><body specific_gravity='1'/></realnoid>"), "", "");
    assert!(read(&with_body, "x").description.is_none());
}

#[test]
fn the_other_tags_of_a_link_are_read() {
    let link = thigh(
        r#"<surface friction="0.8" rolling_friction="0.01" spinning_friction="0.02" restitution="0.1" margin="0"/>
        <damping linear="0.01" angular="0.02"/><deactivate linear="0.01" angular="0.02" after="0.5"/>
        <monitor frame="world"/>"#,
    );
    let surface = link.surface.unwrap();
    assert_eq!(
        (surface.friction, surface.rolling_friction, surface.spinning_friction),
        (Some(0.8), Some(0.01), Some(0.02))
    );
    assert_eq!((surface.restitution, surface.margin), (Some(0.1), Some(0.0)));
    let damping = link.damping.unwrap();
    assert_eq!((damping.linear, damping.angular), (0.01, 0.02));
    let deactivate = link.deactivate.unwrap();
    assert_eq!((deactivate.linear, deactivate.angular, deactivate.after), (0.01, 0.02, 0.5));
    assert_eq!(link.monitor, Some(MonitorFrame::World));
    assert_eq!(thigh("<monitor/>").monitor, Some(MonitorFrame::Body));
    assert!(thigh("<surface/>").surface.unwrap().friction.is_none());
}

#[test]
fn drive_is_read() {
    let full = drive(
        r#"mode="servo" max_torque="120" no_load_speed="8" static_resistance="1.2" dynamic_resistance="0.8"
        short_brake="true" rotor_inertia="1e-4" gear_ratio="100" switchable="false""#,
    );
    assert_eq!((full.mode, full.max_torque, full.no_load_speed), (DriveMode::Servo, Some(120.0), Some(8.0)));
    assert_eq!((full.static_resistance, full.dynamic_resistance), (Some(1.2), Some(0.8)));
    assert_eq!((full.rotor_inertia, full.gear_ratio), (Some(1e-4), Some(100.0)));
    assert!(full.short_brake && !full.switchable);
    let empty = drive("");
    assert_eq!(
        (empty.mode, empty.max_torque, empty.switchable, empty.short_brake),
        (DriveMode::Idle, None, true, false)
    );
    assert_eq!(drive(r#"mode="torque""#).mode, DriveMode::Torque);
}

#[test]
fn a_drive_needs_an_axis() {
    let text = robot("", "<realnoid><drive/></realnoid>", "").replace("\"revolute\"", "\"fixed\"");
    assert_eq!(codes(&text), ["drive-without-axis"]);
}

#[test]
fn constraint_is_read() {
    let tag = r#"<constraint erp="0.2" stop_erp="0.3" cfm="0" stop_cfm="0.1" break_threshold="5000"/>"#;
    let c = sound(&robot("", &format!("<realnoid>{tag}</realnoid>"), "")).joints.remove(0).constraint.unwrap();
    assert_eq!((c.erp, c.stop_erp, c.cfm, c.stop_cfm), (Some(0.2), Some(0.3), Some(0.0), Some(0.1)));
    assert_eq!(c.break_threshold, Some(5000.0));
}

#[test]
fn groups_and_chains_are_read() {
    let tags = r#"<realnoid version="1"><joint_group name="g" type="combined_hinge" p="hip"/>
        <chain root="g" anchor="pelvis" self_collision="false"/></realnoid>"#;
    let d = sound(&robot("", "", tags));
    let group = &d.groups[0];
    assert_eq!((group.name.as_str(), group.kind), ("g", GroupKind::CombinedHinge));
    assert_eq!((&group.h, group.p.as_deref(), &group.b, &group.e), (&None, Some("hip"), &None, &None));
    let chain = &d.chains[0];
    assert_eq!((chain.root.as_str(), chain.anchor.as_deref(), chain.self_collision), ("g", Some("pelvis"), false));
}

#[test]
fn a_3dof_group_follows_its_rules() {
    let (_, text) = broken("group_origin");
    let mended = text.replace("0 0 -0.05", "0 0 0");
    assert_eq!(sound(&mended).groups[0].kind, GroupKind::ThreeDof);
    assert_eq!(codes(&mended), Vec::<&str>::new());
    let wide = mended.replacen("\"-1.5\" upper=\"1.5\"", "\"-1.5\" upper=\"1.5\" ", 1);
    let pitch_at = wide.find("hip_pitch").unwrap();
    let (head, tail) = wide.split_at(pitch_at);
    let wide = format!("{head}{}", tail.replacen("upper=\"1.5\"", "upper=\"1.6\"", 1));
    assert_eq!(codes(&wide), ["range-too-wide"]);
    let free = mended.replace("\"hip_pitch\" type=\"revolute\"", "\"hip_pitch\" type=\"continuous\"");
    assert_eq!(codes(&free), ["range-too-wide", "ignored-range"]);
    let missing = mended.replace(" b=\"hip_roll\"", "");
    assert_eq!(codes(&missing), ["group-axis-fixed"]);
    let cardan = mended.replace("3dof", "cardan");
    assert_eq!(codes(&cardan), Vec::<&str>::new());
    let cardan_with_arm =
        cardan.replace("<parent link=\"pitch\"/>", "<parent link=\"pitch\"/><origin xyz=\"0 0 -0.3\"/>");
    assert_eq!(codes(&cardan_with_arm), Vec::<&str>::new());
    assert_eq!(codes(&cardan_with_arm.replace("cardan", "3dof")), ["group-origin"]);
    let linear = mended.replacen("type=\"revolute\"", "type=\"prismatic\"", 1);
    assert_eq!(codes(&linear), ["group-axis-type"]);
}

#[test]
fn what_collides_is_read_without_a_word() {
    let tags = "<realnoid><surface friction='0.5'/><deactivate linear='0.1' angular='0.1' after='1'/>
        <proxy><sphere radius='1'/></proxy><proxy><sphere radius='2'/></proxy></realnoid>";
    let text = robot(tags, "", "");
    assert_eq!(codes(&text), [""; 0]);
    let thigh = sound(&text).links.remove(1);
    assert_eq!((thigh.proxies.len(), thigh.surface.unwrap().friction), (2, Some(0.5)));
}
