//! Groups with fixed and linear axes, chains, rigs: what is accepted, and what is told.

use super::*;

/// Pelvis – hip_yaw – hip_pitch – hip_roll – thigh – slide – shaft; `kind` and `axes` of the group, `slide` of its joint,
/// `more` beside the group.
fn leg(kind: &str, axes: &str, slide: &str, more: &str) -> String {
    let (_, text) = broken("group_origin");
    let group = r#"<joint_group name="hip" type="3dof" h="hip_yaw" p="hip_pitch" b="hip_roll"/>"#;
    let joint = format!(
        "<link name='shaft'>{INERTIAL}</link><joint name='slide' type='prismatic'><parent link='thigh'/>\
         <child link='shaft'/>{slide}</joint>"
    );
    let tags = format!("<joint_group name='hip' type='{kind}' {axes}/>{more}");
    text.replace("0 0 -0.05", "0 0 0").replace(group, &tags).replace("</robot>", &format!("{joint}</robot>"))
}

const SLIDE: &str = "<axis xyz='1 0 0'/><limit lower='0' upper='0.1' effort='500' velocity='0.2'/>";
const HPB: &str = "h='hip_yaw' p='hip_pitch' b='hip_roll'";
const HPBE: &str = "h='hip_yaw' p='hip_pitch' b='hip_roll' e='slide'";

#[test]
fn an_extension_lies_along_b_and_has_limits() {
    let none = Vec::<&str>::new();
    for kind in ["3dof", "cardan", "combined_hinge"] {
        assert_eq!(codes(&leg(kind, HPBE, SLIDE, "")), none, "{kind}");
        assert_eq!(codes(&leg(kind, HPBE, &SLIDE.replace("1 0 0", "-1 0 0"), "")), none, "to the other side");
        assert_eq!(codes(&leg(kind, HPBE, &SLIDE.replace("1 0 0", "1 0.01 0"), "")), ["group-extension"]);
        let turned = format!("<origin xyz='0 0 0' rpy='0 0 1.5707963267948966'/>{SLIDE}");
        assert_eq!(codes(&leg(kind, HPBE, &turned, "")), ["group-extension"]);
        assert_eq!(codes(&leg(kind, HPBE, &turned.replace("1 0 0", "0 1 0"), "")), none, "in its own frame");
        let free = codes(&leg(kind, HPBE, "<axis xyz='1 0 0'/>", ""));
        assert_eq!(free, ["group-extension-range", "missing-limit"]);
    }
    assert_eq!(
        codes(&leg("3dof", &HPBE.replace("b='hip_roll'", "b='slide'"), SLIDE, "")),
        ["group-axis-type", "joint-in-two-groups"]
    );
    assert_eq!(codes(&leg("combined_hinge", "e='hip_roll'", SLIDE, "")), ["group-axis-type"]);
    assert_eq!(codes(&leg("combined_hinge", "e='slide'", SLIDE, "")), none);
}

#[test]
fn axes_without_a_joint_and_fixed_joints_are_fixed() {
    let fixed = |name: &str| {
        let text = leg("3dof", HPB, SLIDE, "");
        text.replace(&format!("\"{name}\" type=\"revolute\""), &format!("\"{name}\" type=\"fixed\""))
    };
    for name in ["hip_yaw", "hip_pitch", "hip_roll"] {
        assert_eq!(codes(&fixed(name)), Vec::<&str>::new(), "{name}");
    }
    // P frozen at 0.3 rad: H and B are skew, and may be.
    let frozen = |text: String| text.replace("<origin xyz=\"0 0 0\"/>", "<origin xyz=\"0 0 0\" rpy=\"0 0.3 0\"/>");
    assert_eq!(codes(&frozen(fixed("hip_pitch"))), Vec::<&str>::new());
    assert_eq!(codes(&frozen(leg("3dof", HPB, SLIDE, ""))), ["group-axes"], "a turning P must stand at right angles");
    for axes in ["h='hip_yaw'", "h='hip_yaw' p='hip_pitch'", "p='hip_pitch' b='hip_roll'", "b='hip_roll'"] {
        assert_eq!(codes(&leg("3dof", axes, SLIDE, "")), ["group-axis-fixed"], "{axes}");
    }
    assert_eq!(codes(&leg("3dof", "", SLIDE, "")), ["group-axis-missing"]);
}

#[test]
fn an_axis_that_cannot_move_and_is_not_at_zero_is_told() {
    let range =
        |at: &str| robot("", "", "").replace("lower=\"-1\" upper=\"2\"", &format!("lower=\"{at}\" upper=\"{at}\""));
    assert_eq!(codes(&range("0.3")), ["frozen-transform"]);
    assert_eq!(codes(&range("0")), ["empty-range"]);
}

#[test]
fn a_chain_hangs_on_its_anchor() {
    let chain = |attributes: &str| codes(&leg("3dof", HPB, SLIDE, &format!("<chain {attributes}/>")));
    let none = Vec::<&str>::new();
    assert_eq!(chain("root='hip'"), none);
    assert_eq!(chain("root='hip' anchor='pelvis'"), none);
    assert_eq!(chain("root='hip' anchor='world'"), none, "the pelvis is the base");
    assert_eq!(chain("root='hip_yaw' anchor='pelvis'"), none, "the first axis of the group");
    assert_eq!(chain("root='slide' anchor='thigh'"), none);
    assert_eq!(chain("root='hip_roll'"), ["chain-inside-group"]);
    assert_eq!(chain("root='hip' anchor='thigh'"), ["chain-anchor"]);
    assert_eq!(chain("root='slide' anchor='pelvis'"), ["chain-anchor"]);
    assert_eq!(chain("root='slide' anchor='world'"), ["chain-anchor"]);
    assert_eq!(chain("root='hip' anchor='pelviss'"), ["unknown-name"]);
    assert_eq!(chain("root='hipp'"), ["unknown-name"]);
    let text = leg("3dof", HPB, SLIDE, "<chain root='slide' anchor='pelvis'/>");
    let message = &read(&text, "x").findings[0].message;
    assert!(message.contains("'thigh'") && message.contains("'pelvis'"), "names both: {message}");
}

#[test]
fn a_chain_is_rigidly_fixed_to_its_anchor_at_least() {
    let text = leg("3dof", HPB, SLIDE, "<chain root='slide' anchor='thigh'/>");
    let between =
        "<link name='mount'/><joint name='bolt' type='fixed'><parent link='thigh'/><child link='mount'/></joint>";
    let mounted = text
        .replace("<parent link='thigh'/>", "<parent link='mount'/>")
        .replace("</robot>", &format!("{between}</robot>"));
    assert_eq!(codes(&mounted), Vec::<&str>::new());
    assert_eq!(
        codes(&mounted.replace("\"fixed\"", "\"continuous\"").replace("'fixed'", "'continuous'"))[0],
        "chain-anchor"
    );
}

#[test]
fn a_link_belongs_to_one_chain() {
    let chains = |inner: &str| codes(&leg("3dof", HPB, SLIDE, &format!("<chain root='hip'/><chain {inner}/>")));
    assert_eq!(chains("root='slide'"), ["chain-in-chain"]);
    assert_eq!(chains("root='slide' anchor='thigh'"), Vec::<&str>::new(), "its anchor says that it is meant");
    assert_eq!(chains("root='hip'"), ["chain-twice"]);
    assert_eq!(chains("root='hip_yaw'"), ["chain-twice"]);
}

#[test]
fn rigs_are_read_and_checked() {
    let rig = |more: &str| codes(&leg("3dof", HPB, SLIDE, more));
    let none = Vec::<&str>::new();
    assert_eq!(rig("<separate_rig name='ik' of='hip'/>"), none);
    assert_eq!(rig("<chain root='hip'/><separate_rig name='ik' of='hip' anchor='pelvis'/>"), none);
    assert_eq!(rig("<separate_rig name='ik' of='hip' anchor='pelvis'/>"), ["rig-anchor"]);
    assert_eq!(rig("<separate_rig name='ik' of='hipp'/>"), ["unknown-name"]);
    assert_eq!(rig("<separate_rig name='thigh' of='hip'/>"), ["duplicate-name"]);
    assert_eq!(rig("<separate_rig name='world' of='hip'/>"), ["duplicate-name"]);
    assert_eq!(rig("<separate_rig name='a' of='hip'/><separate_rig name='a' of='hip'/>"), ["duplicate-name"]);
    assert_eq!(rig("<separate_rig name='a'/>"), ["missing-attribute"]);
    let slide = codes(&leg("combined_hinge", "e='slide'", SLIDE, "<separate_rig name='ik' of='hip'/>"));
    assert_eq!(slide, ["rig-without-reference"]);
    let d = sound(&leg("3dof", HPB, SLIDE, "<chain root='hip'/><separate_rig name='ik' of='hip' anchor='pelvis'/>"));
    assert_eq!(
        (d.rigs[0].name.as_str(), d.rigs[0].group.as_str(), d.rigs[0].anchor.as_deref()),
        ("ik", "hip", Some("pelvis"))
    );
}
