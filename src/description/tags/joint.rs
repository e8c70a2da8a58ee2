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
            _ => constraint = Some(read_constraint(&element, kind, report)),
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
    warn_of_a_brake_without_a_line(&drive, element, report);
    drive
}

/// The slope of a shorted motor is max_torque / no_load_speed.
fn warn_of_a_brake_without_a_line(drive: &Drive, element: &Element, report: &mut Report) {
    if drive.short_brake && drive.no_load_speed.is_none() {
        let message =
            "short_brake has no effect without no_load_speed: how hard it brakes follows from both".to_string();
        let mend = "give no_load_speed (and max_torque, or <limit effort>)";
        report.add(Finding::warning("brake-without-line", element.place_of("short_brake", report), message, mend));
    }
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

fn read_constraint(element: &Element, kind: JointKind, report: &mut Report) -> Constraint {
    let values = CONSTRAINT.read(element, report);
    let constraint = Constraint {
        at: element.place(report).at,
        erp: values.number("erp"),
        stop_erp: values.number("stop_erp"),
        cfm: values.number("cfm"),
        stop_cfm: values.number("stop_cfm"),
        break_threshold: values.number("break_threshold"),
    };
    if kind == JointKind::Floating {
        note_nothing_to_constrain(element, report);
    } else {
        judge_softness(&constraint, element, report);
    }
    constraint
}

/// E-2: an item that cannot be honoured is told.
fn note_nothing_to_constrain(element: &Element, report: &mut Report) {
    for item in CONSTRAINT.attributes.iter().filter(|a| element.value(a.name).is_some()) {
        let message = format!("{} has no effect: a floating joint constrains nothing", item.name);
        let place = element.place_of(item.name, report);
        report.add(Finding::warning("constraint-without-effect", place, message, "take it out"));
    }
}

fn judge_softness(constraint: &Constraint, element: &Element, report: &mut Report) {
    let (erp, cfm) = (constraint.erp.unwrap_or(0.0), constraint.cfm.unwrap_or(0.0));
    if constraint.erp.is_some() && cfm == 0.0 {
        let message = "erp has no effect on the engine rbx while cfm is 0: a hard joint has no error to reduce";
        let place = element.place_of("erp", report);
        let mend = "give a cfm greater than 0 if the joint is to yield";
        report.add(Finding::note("erp-without-cfm", place, message.into(), mend));
    }
    if cfm > 0.0 && erp == 0.0 {
        let message = format!("cfm {cfm} without erp is a damper without a spring: the joint drifts apart under load");
        let mend = "give an erp greater than 0; a spring k and a damper c make erp = h k/(h k + c), cfm = 1/(h k + c)";
        report.add(Finding::warning("drifting-joint", element.place_of("cfm", report), message, mend));
    }
}
