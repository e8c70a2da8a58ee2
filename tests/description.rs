//! Reading URDF: every broken file in `tests/broken` gives a readable report that points at the right line;
//! every tag is read; no mutation of a text makes the reader panic.

use proptest::prelude::*;
use realnoid::description::*;

/// The line of a broken file that the first finding must point at.
const HERE: &str = "<!-- HERE -->";

fn broken(name: &str) -> (String, String) {
    let file = format!("tests/broken/{name}.urdf");
    let text = std::fs::read_to_string(&file).unwrap();
    (file, text)
}

/// One snapshot test per file; a last test that no file is left out.
macro_rules! broken_files {
    ($($name:ident: $code:literal),* $(,)?) => {
        $(#[test] fn $name() { assert_report(stringify!($name), $code); })*
        #[test]
        fn every_broken_file_is_tested() {
            let mut tested = vec![$(stringify!($name)),*];
            tested.sort_unstable();
            let mut there: Vec<_> = std::fs::read_dir("tests/broken").unwrap()
                .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_string())
                .collect();
            there.sort_unstable();
            assert_eq!(tested, there);
        }
    };
}

fn assert_report(name: &str, code: &str) {
    let (file, text) = broken(name);
    let reading = read(&text, &file);
    let first = &reading.findings[0];
    let line = text.lines().position(|line| line.contains(HERE)).unwrap() as u32 + 1;
    assert_eq!((first.code, first.at.line), (code, line));
    assert_eq!(reading.description.is_none(), first.severity == Severity::Error);
    assert_eq!(text[..first.at.start].matches('\n').count() as u32 + 1, first.at.line);
    insta::assert_snapshot!(name, render(&reading.findings, &file, &text, false));
}

broken_files! {
    bad_number: "bad-number",
    cut_off: "not-well-formed",
    cycle: "cycle",
    duplicate_link: "duplicate-name",
    group_axes: "group-axes",
    group_mass: "group-mass",
    group_order: "group-path",
    group_origin: "group-origin",
    group_unknown_joint: "unknown-name",
    hollow_without_thickness: "missing-attribute",
    joint_in_two_groups: "joint-in-two-groups",
    lower_above_upper: "lower-above-upper",
    massless_leaf: "massless-leaf",
    misplaced_tag: "unknown-tag",
    missing_velocity: "missing-bound",
    nan: "not-finite",
    negative_mass: "negative-mass",
    no_inertia: "no-inertia",
    not_well_formed: "not-well-formed",
    out_of_range: "out-of-range",
    planar: "joint-not-simulated",
    range_across_180: "range-too-wide",
    several_roots: "several-roots",
    two_parents: "two-parents",
    undeclared_prefix: "undeclared-prefix",
    unknown_attribute: "unknown-attribute",
    unknown_joint_type: "unknown-joint-type",
    unknown_link: "unknown-link",
    unknown_tag: "unknown-tag",
    version: "unknown-version",
    wrong_length: "wrong-length",
    xacro: "xacro-not-expanded",
    zero_axis: "zero-axis",
}

const INERTIAL: &str = r#"<inertial><origin xyz="0 0 -0.2" rpy="0.1 0 0"/><mass value="3.5"/>
    <inertia ixx="0.05" ixy="0.001" ixz="0.002" iyy="0.06" iyz="0.003" izz="0.02"/></inertial>"#;

/// A pelvis and a thigh with one joint; `link` goes into the thigh, `joint` into the hip, `robot` to the end.
fn robot(link: &str, joint: &str, robot: &str) -> String {
    format!(
        r#"<robot name="leg"><link name="pelvis">{INERTIAL}</link><link name="thigh">{INERTIAL}{link}</link>
        <joint name="hip" type="revolute"><parent link="pelvis"/><child link="thigh"/><axis xyz="0 2 0"/>
        <limit lower="-1" upper="2" effort="80" velocity="6"/>{joint}</joint>{robot}</robot>"#
    )
}

fn sound(text: &str) -> Description {
    let reading = read(text, "test.urdf");
    reading.description.unwrap_or_else(|| panic!("{}", render(&reading.findings, "test.urdf", text, false)))
}

fn codes(text: &str) -> Vec<&'static str> {
    read(text, "test.urdf").findings.iter().map(|f| f.code).collect()
}

fn thigh(tags: &str) -> Link {
    sound(&robot(&format!("<realnoid>{tags}</realnoid>"), "", "")).links.remove(1)
}

fn drive(attributes: &str) -> Drive {
    let text = robot("", &format!("<realnoid><drive {attributes}/></realnoid>"), "");
    sound(&text).joints.remove(0).drive.unwrap()
}

#[test]
fn the_standard_part_is_read() {
    let d =
        sound(&robot("", r#"<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><dynamics damping="0.5" friction="0.25"/>"#, ""));
    assert_eq!(d.name, "leg");
    let inertial = d.links[1].inertial.as_ref().unwrap();
    assert_eq!((inertial.mass, inertial.inertia), (3.5, [0.05, 0.001, 0.002, 0.06, 0.003, 0.02]));
    assert_eq!(inertial.origin, Origin { xyz: [0.0, 0.0, -0.2], rpy: [0.1, 0.0, 0.0] });
    let hip = &d.joints[0];
    assert_eq!((hip.kind, hip.parent.as_str(), hip.child.as_str()), (JointKind::Revolute, "pelvis", "thigh"));
    assert_eq!(hip.origin, Origin { xyz: [1.0, 2.0, 3.0], rpy: [0.1, 0.2, 0.3] });
    assert_eq!((hip.axis, hip.damping, hip.friction), ([0.0, 1.0, 0.0], 0.5, 0.25));
    let limit = hip.limit.as_ref().unwrap();
    assert_eq!((limit.lower, limit.upper, limit.effort, limit.velocity), (-1.0, 2.0, Some(80.0), Some(6.0)));
}

#[test]
fn positions_are_lines_columns_and_bytes() {
    let text = "<robot name='ä'>\n  <link name='a'/><!-- é --><link name='b'/>\n</robot>";
    let reading = read(text, "x");
    let roots = reading.findings.iter().find(|f| f.code == "several-roots").unwrap();
    assert_eq!((roots.at.line, roots.at.column), (2, 29));
    assert_eq!(&text[roots.at.start..roots.at.end], "<link name='b'");
}

#[test]
fn placeholders_are_no_bounds() {
    let text = robot("", "", "").replace(r#"effort="80" velocity="6""#, r#"effort="0" velocity="0""#);
    let limit = sound(&text).joints.remove(0).limit.unwrap();
    assert_eq!((limit.effort, limit.velocity), (None, None));
    assert_eq!(codes(&text), ["placeholder-bound", "placeholder-bound"]);
}

#[test]
fn a_revolute_joint_without_limit_is_unlimited() {
    let text = robot("", "", "").replace(r#"<limit lower="-1" upper="2" effort="80" velocity="6"/>"#, "");
    assert!(sound(&text).joints[0].limit.is_none());
    assert_eq!(codes(&text), ["missing-limit"]);
}

#[test]
fn mimic_is_read_and_told() {
    let text = robot("", r#"<mimic joint="hip" multiplier="-2" offset="0.5"/>"#, "");
    let mimic = sound(&text).joints.remove(0).mimic.unwrap();
    assert_eq!((mimic.joint.as_str(), mimic.multiplier, mimic.offset), ("hip", -2.0, 0.5));
    assert_eq!(codes(&text), ["mimic-not-simulated"]);
}

#[test]
fn an_axis_needs_its_direction() {
    let text = robot("", "", "").replace("<axis xyz=\"0 2 0\"/>", "<axis/>");
    assert_eq!(codes(&text), ["missing-attribute"]);
    assert_eq!(codes(&text.replace("<axis/>", "")), ["default-axis"]);
}

#[test]
fn a_quaternion_origin_counts_from_version_1_1() {
    let quarter = r#"<origin quat_xyzw="0 0 0.5 0.5"/>"#;
    let text = robot("", quarter, "");
    assert_eq!(sound(&text).joints[0].origin.rpy, [0.0; 3]);
    assert_eq!(codes(&text), ["quaternion-ignored"]);
    let newer = text.replace("<robot ", r#"<robot version="1.1" "#);
    let [roll, pitch, yaw] = sound(&newer).joints[0].origin.rpy;
    approx::assert_relative_eq!(yaw, std::f64::consts::FRAC_PI_2, epsilon = 1e-12);
    assert_eq!((roll, pitch), (0.0, 0.0));
}

#[test]
fn body_is_read() {
    let visual = r#"<visual><geometry><sphere radius="0.1"/></geometry></visual>"#;
    let text = |body: &str| robot(&format!("{visual}<realnoid>{body}</realnoid>"), "", "");
    let solid = sound(&text(r#"<body specific_gravity="1.05"/>"#)).links.remove(1).body.unwrap();
    assert_eq!((solid.specific_gravity, solid.dimension, solid.l_scale), (1.05, Dimension::Solid, 1.0));
    assert!(solid.shapes.is_empty());
    let hollow = r#"<body specific_gravity="2" dimension="2d" thickness="0.003" l_scale="1.5"/>"#;
    let hollow = sound(&text(hollow)).links.remove(1).body.unwrap();
    assert_eq!((hollow.dimension, hollow.l_scale), (Dimension::Hollow { thickness: 0.003 }, 1.5));
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
        (r#"<hemisphere radius="1"/>"#, other("hemisphere", &[("radius", 1.0)])),
        (r#"<torus ring_radius="2" pipe_radius="1"/>"#, other("torus", &[("ring_radius", 2.0), ("pipe_radius", 1.0)])),
        (
            r#"<oil_tank radius="2" length="3" cap_height="1"/>"#,
            other("oil_tank", &[("radius", 2.0), ("length", 3.0), ("cap_height", 1.0)]),
        ),
        (r#"<pyramid size="1 2 3"/>"#, other("pyramid", &[("size.0", 1.0), ("size.1", 2.0), ("size.2", 3.0)])),
        (r#"<polyhedron faces="12" radius="1"/>"#, other("polyhedron", &[("faces", 12.0), ("radius", 1.0)])),
        (r#"<disc outer_radius="1"/>"#, other("disc", &[("outer_radius", 1.0)])),
        (r#"<plane size="1 2"/>"#, other("plane", &[("size.0", 1.0), ("size.1", 2.0)])),
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

fn other(kind: &str, values: &[(&str, f64)]) -> Geometry {
    Geometry::Other { kind: kind.into(), values: values.iter().map(|(name, x)| (name.to_string(), *x)).collect() }
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
    let missing = mended.replace(" b=\"hip_roll\"", "");
    assert_eq!(codes(&missing), ["group-axis-missing"]);
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
fn plain_joints_may_turn_further_than_half_a_turn() {
    let text = robot("", "", "").replace("upper=\"2\"", "upper=\"10\"");
    assert_eq!(codes(&text), Vec::<&str>::new());
}

#[test]
fn effects_to_come_are_noted_once_per_kind() {
    let tags = "<realnoid><surface/><proxy><sphere radius='1'/></proxy><proxy><sphere radius='1'/></proxy></realnoid>";
    let text = robot(tags, "<realnoid><drive rotor_inertia='1' max_torque='3'/></realnoid>", "");
    let findings = read(&text, "x").findings;
    assert!(findings.iter().all(|f| (f.code, f.severity) == ("not-simulated-yet", Severity::Note)));
    let messages: Vec<_> = findings.iter().map(|f| f.message.as_str()).collect();
    assert_eq!(messages.len(), 3);
    assert!(messages.iter().any(|m| m.starts_with("<proxy>") && m.contains("2 of them")));
    assert!(messages.iter().any(|m| m.starts_with("<drive rotor_inertia>")));
}

#[test]
fn an_odd_sensor_on_a_sound_trunk_is_a_warning() {
    let sensor = r#"<link name="imu"><inertial><mass value="0.001"/><inertia ixx="1e-6" ixy="1e-6" ixz="1e-6"
        iyy="1e-6" iyz="1e-6" izz="1e-6"/></inertial></link><joint name="imu" type="fixed"><parent link="thigh"/>
        <child link="imu"/></joint>"#;
    let text = robot("", "", sensor);
    assert_eq!(codes(&text), ["odd-inertia"]);
    let moving = text.replace("\"fixed\"", "\"continuous\"");
    assert_eq!(codes(&moving)[0], "no-inertia");
}

#[test]
fn unequal_sides_are_a_warning() {
    let (_, text) = broken("two_parents");
    let text = text.replace("thigh", "left_thigh").replace("shin", "right_thigh").replacen("tendon", "free", 1);
    let text = text.replace(
        "<parent link=\"pelvis\"/>\n    <child link=\"right_thigh\"/>",
        "<parent link=\"right_thigh\"/><child link=\"toe\"/>",
    );
    let text = text.replace("</robot>", &format!("<link name='toe'>{INERTIAL}</link></robot>"));
    assert_eq!(codes(&text), Vec::<&str>::new());
    let slip = text.replacen(
        "left_thigh\">\n    <inertial>\n      <origin xyz=\"0 0 -0.2\"/>\n      <mass value=\"3.5\"",
        "left_thigh\">\n    <inertial>\n      <origin xyz=\"0 0 -0.2\"/>\n      <mass value=\"35\"",
        1,
    );
    assert_eq!(codes(&slip), ["unequal-sides"]);
}

#[test]
fn urdf_rs_panics_and_refusals_do_not_reach_the_user() {
    let oddities = [
        robot("<visual><geometry><ellipsoid radii='1 1 1'/></geometry></visual>", "", ""),
        robot("", "", "<gazebo><plugin><inertial/></plugin></gazebo>"),
        robot("<x:inertial xmlns:x='urn:x'/>", "<x:limit xmlns:x='urn:x' velocity='1'/>", ""),
        robot("<inertial/>", "<axis xyz='1 0 0'/>", ""),
        robot("", "<safety_controller/><calibration rising='x'/>", ""),
        robot("", "", "").replace("thigh", "a &amp; b &lt;&gt; &quot;ü&quot;"),
        robot("", "", "").replace("velocity=\"6\"", ""),
        robot("", "", "").replace("lower=\"-1\"", ""),
        robot("", "", "").replace("\"revolute\"", "\"continuous\"").replace("lower=\"-1\"", "lower=\"x\""),
        robot("", "", "").replace("\"revolute\"", "\"fixed\"").replace("0 2 0", "nonsense"),
    ];
    for text in oddities {
        let reading = read(&text, "x");
        assert!(reading.description.is_some(), "{}", render(&reading.findings, "x", &text, false));
    }
}

#[test]
fn what_is_no_urdf_is_said_so() {
    assert_eq!(codes(""), ["not-well-formed"]);
    assert_eq!(codes("<sdf/>"), ["not-urdf"]);
    assert_eq!(codes("<robot name='r'/>"), ["no-link"]);
    assert_eq!(codes("<!DOCTYPE robot><robot name='r'/>"), ["not-well-formed"]);
}

/// A text that holds every tag, to be mutated.
fn sample() -> String {
    let (_, group) = broken("group_origin");
    let link = r#"<visual><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="m"/></visual>
        <realnoid><body specific_gravity="1.05" dimension="2d" thickness="0.01"><shape><sphere radius="1"/></shape></body>
        <proxy><capsule radius="0.07" length="0.3"/></proxy><surface friction="0.8"/><monitor frame="body"/></realnoid>"#;
    let joint = r#"<realnoid><drive mode="servo" max_torque="120"/><constraint erp="0.2"/></realnoid>"#;
    let group =
        group.replacen("</link>", &format!("{link}</link>"), 1).replacen("</joint>", &format!("{joint}</joint>"), 1);
    group.replace("0 0 -0.05", "0 0 0")
}

/// Cuts, doubles or overwrites a piece of the text at character boundaries.
fn mutate(text: &str, at: usize, length: usize, insert: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let start = at % (characters.len() + 1);
    let end = (start + length).min(characters.len());
    characters[..start].iter().collect::<String>() + insert + &characters[end..].iter().collect::<String>()
}

const PIECES: &[&str] = &[
    "",
    "\"",
    "<",
    ">",
    "/>",
    "</link>",
    "<link name=\"x\"/>",
    "nan",
    "-",
    "1e999",
    "0",
    " ",
    "é",
    "&amp;",
    "&",
    "x:",
    "<!--",
    "-->",
    "<realnoid>",
    "link",
    "joint",
    "\u{0}",
    "]]>",
    "version=\"1.2\"",
    "<!DOCTYPE a>",
    "<?xml?>",
    "e",
    "pelvis",
    "=\"\"",
    "\n",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn no_mutation_makes_the_reader_panic(
        edits in prop::collection::vec((any::<usize>(), 0usize..60, prop::sample::select(PIECES)), 1..4)
    ) {
        let text = edits.iter().fold(sample(), |text, (at, length, piece)| mutate(&text, *at, *length, piece));
        let reading = read(&text, "mutated.urdf");
        prop_assert!(reading.findings.iter().all(|f| f.code != "readers-disagree"), "{text}");
        prop_assert!(reading.findings.iter().all(|f| f.at.start <= f.at.end && f.at.end <= text.len()));
        let sound = reading.findings.iter().all(|f| f.severity < Severity::Error);
        prop_assert_eq!(reading.description.is_some(), sound);
        let report = render(&reading.findings, "mutated.urdf", &text, false);
        prop_assert!(report.ends_with('\n'));
    }
}
