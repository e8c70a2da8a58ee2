//! `<realnoid version="1">` inside `<robot>`: joint_group, chain, separate_rig.

use super::super::element::Element;
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::rules::{Attribute, Kind, Tag, Values};
use super::super::{Chain, GroupKind, JointGroup, SeparateRig};

pub(in super::super) const JOINT_GROUP: Tag = Tag {
    name: "joint_group",
    attributes: &[
        Attribute::required("name", Kind::Text),
        Attribute::required("type", Kind::Word(&["combined_hinge", "cardan", "3dof"])),
        Attribute::optional("h", Kind::Text),
        Attribute::optional("p", Kind::Text),
        Attribute::optional("b", Kind::Text),
        Attribute::optional("e", Kind::Text),
    ],
    children: &[],
};

pub(in super::super) const CHAIN: Tag = Tag {
    name: "chain",
    attributes: &[
        Attribute::required("root", Kind::Text),
        Attribute::optional("anchor", Kind::Text),
        Attribute::optional("self_collision", Kind::Flag),
    ],
    children: &[],
};

pub(in super::super) const SEPARATE_RIG: Tag = Tag {
    name: "separate_rig",
    attributes: &[
        Attribute::required("name", Kind::Text),
        Attribute::required("of", Kind::Text),
        Attribute::optional("anchor", Kind::Text),
    ],
    children: &[],
};

/// Names of the tags that may stand here.
pub(in super::super) const NAMES: &[&str] = &["joint_group", "chain", "separate_rig"];

/// The only version of the tags there is.
const VERSION: &str = "1";

/// What the tags of the robot say, each with its element for later checks.
#[derive(Default)]
pub(in super::super) struct RobotTags<'a> {
    pub groups: Vec<(JointGroup, Element<'a>)>,
    pub chains: Vec<(Chain, Element<'a>)>,
    pub rigs: Vec<(SeparateRig, Element<'a>)>,
}

/// Reads the `<realnoid>` elements of the robot.
pub(in super::super) fn read<'a>(robot: &Element<'a>, report: &mut Report) -> RobotTags<'a> {
    for realnoid in robot.all(super::REALNOID) {
        check_version(&realnoid, report);
    }
    let mut tags = RobotTags::default();
    for element in super::collect(robot, NAMES, NAMES, report) {
        match element.tag() {
            "joint_group" => tags.groups.extend(read_group(&element, report).map(|group| (group, element))),
            "chain" => tags.chains.extend(read_chain(&element, report).map(|chain| (chain, element))),
            _ => tags.rigs.extend(read_rig(&element, report).map(|rig| (rig, element))),
        }
    }
    tags
}

fn check_version(realnoid: &Element, report: &mut Report) {
    const RULE: Tag =
        Tag { name: "realnoid", attributes: &[Attribute::required("version", Kind::Text)], children: NAMES };
    let values = RULE.read_attributes(realnoid, report);
    if let Some(version) = values.word("version").filter(|v| *v != VERSION) {
        let message = format!("version {version} of the tags is not known to this realnoid");
        let mend = "write version=\"1\", or update realnoid";
        report.add(Finding::error("unknown-version", realnoid.place_of("version", report), message, mend));
    }
}

fn read_group(element: &Element, report: &mut Report) -> Option<JointGroup> {
    let values = JOINT_GROUP.read(element, report);
    let kind = match values.word("type")? {
        "combined_hinge" => GroupKind::CombinedHinge,
        "cardan" => GroupKind::Cardan,
        _ => GroupKind::ThreeDof,
    };
    Some(JointGroup {
        name: values.word("name")?.into(),
        at: element.place(report).at,
        kind,
        h: text(&values, "h"),
        p: text(&values, "p"),
        b: text(&values, "b"),
        e: text(&values, "e"),
    })
}

fn read_chain(element: &Element, report: &mut Report) -> Option<Chain> {
    let values = CHAIN.read(element, report);
    Some(Chain {
        at: element.place(report).at,
        root: values.word("root")?.into(),
        anchor: text(&values, "anchor"),
        self_collision: values.flag_or("self_collision", true),
    })
}

fn read_rig(element: &Element, report: &mut Report) -> Option<SeparateRig> {
    let values = SEPARATE_RIG.read(element, report);
    Some(SeparateRig {
        at: element.place(report).at,
        name: values.word("name")?.into(),
        group: values.word("of")?.into(),
        anchor: text(&values, "anchor"),
    })
}

fn text(values: &Values, name: &str) -> Option<String> {
    values.word(name).map(str::to_string)
}
