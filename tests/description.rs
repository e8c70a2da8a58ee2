//! Reading URDF: every broken file in `tests/broken` gives a readable report that points at the right line;
//! every tag is read; no mutation of a text makes the reader panic.

#![allow(clippy::unwrap_used, reason = "a test")]

#[path = "description/groups.rs"]
mod groups;
#[path = "description/mutations.rs"]
mod mutations;
#[path = "description/tags.rs"]
mod tags;

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
    mimic_cycle: "mimic-cycle",
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
    let knee = r#"<joint name="knee" type="continuous"><parent link="thigh"/><child link="shin"/><axis xyz="0 1 0"/>
        <mimic joint="hip" multiplier="-2" offset="0.5"/></joint>"#;
    let text = robot("", "", &format!(r#"<link name="shin">{INERTIAL}</link>{knee}"#));
    let mimic = sound(&text).joints.remove(1).mimic.unwrap();
    assert_eq!((mimic.joint.as_str(), mimic.multiplier, mimic.offset), ("hip", -2.0, 0.5));
    assert_eq!(codes(&text), [""; 0]);
    assert_eq!(codes(&text.replace(r#"<mimic joint="hip""#, r#"<mimic joint="knee""#)), ["mimic-cycle"]);
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
fn plain_joints_may_turn_further_than_half_a_turn() {
    let text = robot("", "", "").replace("upper=\"2\"", "upper=\"10\"");
    assert_eq!(codes(&text), Vec::<&str>::new());
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
        robot("", "<dynamics damping='x'/>", "").replace("\"revolute\"", "\"floating\""),
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
fn depth_and_size_do_no_harm() {
    let deep = format!("<robot name='r'>{}{}</robot>", "<a>".repeat(200_000), "</a>".repeat(200_000));
    assert_eq!(codes(&deep)[0], "no-link");
    let links: String = (0..5000).map(|i| format!("<link name='l{i}'>{INERTIAL}</link>")).collect();
    let joint =
        |i: i32| format!("<joint name='j{i}' type='fixed'><parent link='l{i}'/><child link='l{}'/></joint>", i + 1);
    let chain: String = (0..4999).map(joint).collect();
    assert_eq!(sound(&format!("<robot name='r'>{links}{chain}</robot>")).joints.len(), 4999);
}

#[test]
fn what_is_no_urdf_is_said_so() {
    assert_eq!(codes(""), ["not-well-formed"]);
    assert_eq!(read("robot", "x").findings[0].message, "this text is not XML");
    assert_eq!(codes("<sdf/>"), ["not-urdf"]);
    assert_eq!(codes("<robot name='r'/>"), ["no-link"]);
    assert_eq!(codes("<!DOCTYPE robot><robot name='r'/>"), ["not-well-formed"]);
}
