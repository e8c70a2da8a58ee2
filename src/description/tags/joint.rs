//! `<realnoid>` inside `<joint>`: drive, constraint.

use super::super::element::{Domain, Element};
use super::super::finding::Finding;
use super::super::report::Report;
use super::super::rules::{Attribute, Kind, Tag};
use super::super::{Constraint, Drive, DriveMode, JointKind};

const NON_NEGATIVE: Kind = Kind::Number(Domain::NonNegative);
const POSITIVE: Kind = Kind::Number(Domain::Positive);
const UNIT: Kind = Kind::Number(Domain::Unit);

pub(in super::super) const DRIVE: Tag = Tag {
    name: "drive",
    attributes: &[
        Attribute::optional("mode", Kind::Word(&["idle", "torque", "servo"])),
        Attribute::optional("max_torque", NON_NEGATIVE),
        Attribute::optional("no_load_speed", POSITIVE),
        Attribute::optional("static_resistance", NON_NEGATIVE),
        Attribute::optional("dynamic_resistance", NON_NEGATIVE),
        Attribute::optional("short_brake", Kind::Flag),
        Attribute::optional("bandwidth", POSITIVE),
        Attribute::optional("rotor_inertia", NON_NEGATIVE),
        Attribute::optional("gear_ratio", POSITIVE),
        Attribute::optional("switchable", Kind::Flag),
    ],
    children: &[],
};

pub(in super::super) const CONSTRAINT: Tag = Tag {
    name: "constraint",
    attributes: &[
        Attribute::optional("erp", UNIT),
        Attribute::optional("stop_erp", UNIT),
        Attribute::optional("cfm", NON_NEGATIVE),
        Attribute::optional("stop_cfm", NON_NEGATIVE),
        Attribute::optional("break_threshold", POSITIVE),
    ],
    children: &[],
};

/// Names of the tags that may stand here.
pub(in super::super) const NAMES: &[&str] = &["drive", "constraint"];

/// Reads the `<realnoid>` elements of a joint.
pub(in super::super) fn read(
    joint: &Element,
    kind: JointKind,
    report: &mut Report,
) -> (Option<Drive>, Option<Constraint>) {
    super::refuse_attributes(joint, report);
    let (mut drive, mut constraint) = (None, None);
    for element in super::collect(joint, NAMES, &[], report) {
        match element.tag() {
            "drive" => drive = Some(read_drive(&element, kind, report)),
            _ => constraint = Some(read_constraint(&element, report)),
        }
    }
    (drive, constraint)
}

fn read_drive(element: &Element, kind: JointKind, report: &mut Report) -> Drive {
    if !matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic) {
        let message = "this type of joint has no single axis to drive".to_string();
        let mend = "make the joint revolute, continuous or prismatic, or take <drive> out";
        report.add(Finding::error("drive-without-axis", element.place(report), message, mend));
    }
    let values = DRIVE.read(element, report);
    let drive = Drive {
        at: element.place(report).at,
        mode: match values.word("mode") {
            Some("torque") => DriveMode::Torque,
            Some("servo") => DriveMode::Servo,
            _ => DriveMode::Idle,
        },
        max_torque: values.number("max_torque"),
        no_load_speed: values.number("no_load_speed"),
        static_resistance: values.number("static_resistance"),
        dynamic_resistance: values.number("dynamic_resistance"),
        short_brake: values.flag_or("short_brake", false),
        bandwidth: values.number("bandwidth"),
        rotor_inertia: values.number("rotor_inertia"),
        gear_ratio: values.number("gear_ratio"),
        switchable: values.flag_or("switchable", true),
    };
    warn_of_swapped_resistances(&drive, element, report);
    drive
}

fn warn_of_swapped_resistances(drive: &Drive, element: &Element, report: &mut Report) {
    if let (Some(at_rest), Some(turning)) = (drive.static_resistance, drive.dynamic_resistance)
        && turning > at_rest
    {
        let message = format!("dynamic_resistance {turning} is greater than static_resistance {at_rest}");
        let mend = "friction at rest is the greater one of real drives: were the two swapped?";
        let place = element.place_of("dynamic_resistance", report);
        report.add(Finding::warning("swapped-resistances", place, message, mend));
    }
}

fn read_constraint(element: &Element, report: &mut Report) -> Constraint {
    let values = CONSTRAINT.read(element, report);
    Constraint {
        at: element.place(report).at,
        erp: values.number("erp"),
        stop_erp: values.number("stop_erp"),
        cfm: values.number("cfm"),
        stop_cfm: values.number("stop_cfm"),
        break_threshold: values.number("break_threshold"),
    }
}
