//! What in a scene calls for an effect.

use crate::description::DriveMode;
use crate::model::{Axis, JointType, LinkFrame, Model, Surface};
use crate::shape::ContactForm;

/// Whether something calls for an effect, and what.
#[derive(Clone, Debug)]
pub struct Cause {
    pub called_for: bool,
    pub by: String,
}

/// Names that are told before the rest is only counted.
const NAMED: usize = 3;

/// Of so many things these; `needs` is what would call for it.
fn some_of(what: &str, names: &[&str], total: usize, needs: &str) -> Cause {
    let first: Vec<String> = names.iter().take(NAMED).map(|name| (*name).to_owned()).collect();
    told(what, (names.len(), &first), total, needs)
}

fn told(what: &str, (count, first): (usize, &[String]), total: usize, needs: &str) -> Cause {
    let shown = first.join(", ");
    let more = if count > first.len() { ", …" } else { "" };
    let by = match (count, total) {
        (0, _) => format!("nothing: {needs}"),
        (1, 1) => format!("1 {what}: {shown} ({needs})"),
        _ => format!("{count} of {total} {}: {shown}{more} ({needs})", plural(what)),
    };
    Cause { called_for: count > 0, by }
}

fn plural(what: &str) -> String {
    match what.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None if what.ends_with("axis") => what.replace("axis", "axes"),
        None => format!("{what}s"),
    }
}

fn axes(m: &Model, needs: &str, used: impl Fn(&Axis) -> bool) -> Cause {
    let names: Vec<&str> = m.axes.iter().filter(|a| used(a)).map(|a| a.name.as_str()).collect();
    some_of("axis", &names, m.axes.len(), needs)
}

/// The first link on a body; of one inside of a joint, that behind it.
fn link_on(m: &Model, body: usize) -> &str {
    let on = |b: usize| m.links.iter().find(|l| matches!(l.frame, LinkFrame::OnBody { body, .. } if body == b));
    (body..m.bodies.len()).find_map(on).map_or("", |l| l.name.as_str())
}

fn bodies(m: &Model, needs: &str, used: impl Fn(usize) -> bool) -> Cause {
    let names: Vec<&str> = (1..m.bodies.len()).filter(|b| used(*b)).map(|b| link_on(m, b)).collect();
    some_of("body", &names, m.bodies.len() - 1, needs)
}

/// Pairs of colliders whose surfaces have something.
fn pairs(m: &Model, needs: &str, used: impl Fn(&Surface) -> bool) -> Cause {
    let (mut total, mut count, mut names) = (0, 0, vec![]);
    for ([a, b], surface) in m.pairs().filter(|_| touches(m)) {
        total += 1;
        if used(&surface) {
            count += 1;
            if names.len() < NAMED {
                names.push(format!("{} × {}", a.name, b.name));
            }
        }
    }
    told("pair", (count, &names), total, needs)
}

pub(super) fn gravity(m: &Model) -> Cause {
    bodies(m, "mass", |b| m.bodies[b].mass > 0.0)
}

pub(super) fn velocity_products(m: &Model) -> Cause {
    let turns = |b: usize| {
        let mut chain = std::iter::successors(Some(b), |b| Some(m.bodies[*b].parent)).take_while(|b| *b != 0);
        chain.any(|b| m.bodies[b].joint != JointType::Prismatic)
    };
    bodies(m, "bodies that can turn", turns)
}

pub(super) fn damping(m: &Model) -> Cause {
    axes(m, "<dynamics damping>", |a| a.damping > 0.0)
}

pub(super) fn friction(m: &Model) -> Cause {
    let needs = "<dynamics friction>, <drive static_resistance dynamic_resistance>";
    axes(m, needs, |a| a.friction > 0.0 || a.drive.static_resistance > 0.0)
}

pub(super) fn joint_friction(m: &Model) -> Cause {
    axes(m, "<dynamics friction>", |a| a.friction > 0.0)
}

pub(super) fn static_resistance(m: &Model) -> Cause {
    axes(m, "<drive static_resistance>", |a| a.drive.static_resistance > a.drive.dynamic_resistance)
}

pub(super) fn dynamic_resistance(m: &Model) -> Cause {
    axes(m, "<drive dynamic_resistance>", |a| a.drive.dynamic_resistance > 0.0)
}

fn has_stop(a: &Axis) -> bool {
    a.lower.is_finite() || a.upper.is_finite()
}

pub(super) fn limits(m: &Model) -> Cause {
    axes(m, "<limit>", has_stop)
}

pub(super) fn soft_stops(m: &Model) -> Cause {
    axes(m, "<constraint stop_cfm>", |a| has_stop(a) && a.stop.cfm > 0.0)
}

pub(super) fn drives(m: &Model) -> Cause {
    axes(m, "axes", |_| true)
}

pub(super) fn torque_speed_line(m: &Model) -> Cause {
    axes(m, "<drive no_load_speed>", |a| a.drive.no_load_speed.is_finite())
}

pub(super) fn short_brake(m: &Model) -> Cause {
    let brakes = |a: &Axis| a.drive.short_brake && a.drive.max_torque.is_finite() && a.drive.no_load_speed.is_finite();
    axes(m, "<drive short_brake max_torque no_load_speed>", brakes)
}

pub(super) fn servo(m: &Model) -> Cause {
    axes(m, "<drive mode=\"servo\">, or a command", |a| a.mode == DriveMode::Servo)
}

pub(super) fn rotor_inertia(m: &Model) -> Cause {
    axes(m, "<drive rotor_inertia>", |a| a.drive.rotor_inertia > 0.0)
}

pub(super) fn compliance(m: &Model) -> Cause {
    let soft = m.softs.iter().filter(|s| s.softness.cfm > 0.0);
    let mut links: Vec<&str> = soft.filter_map(|s| m.body_of(s.v)).map(|body| link_on(m, body)).collect();
    links.dedup();
    some_of("link", &links, m.links.len(), "<constraint cfm>")
}

pub(super) fn mimic(m: &Model) -> Cause {
    let names: Vec<&str> = m.couplings.iter().map(|c| m.axes[c.follower].name.as_str()).collect();
    some_of("axis", &names, m.axes.len(), "<mimic>")
}

pub(super) fn poles(m: &Model) -> Cause {
    let groups: Vec<&str> = m.eulers.iter().map(|g| link_on(m, g.body)).collect();
    some_of("3dof group", &groups, m.eulers.len(), "<group type=\"3dof\">")
}

pub(super) fn breaking(m: &Model) -> Cause {
    let names: Vec<&str> = m.breakables.iter().map(|b| b.joint.as_str()).collect();
    some_of("joint", &names, m.bodies.len() - 1, "<constraint break_threshold>")
}

pub(super) fn body_damping(m: &Model) -> Cause {
    bodies(m, "<damping>", |b| m.dampings.iter().any(|d| d.body == b))
}

/// A robot by itself has nothing to touch: only with company do its shapes collide, with each other as well.
fn touches(m: &Model) -> bool {
    let company = !m.joined.is_empty() || m.colliders.iter().any(|c| c.link.is_none());
    company && m.colliders.len() > 1
}

pub(super) fn contact(m: &Model) -> Cause {
    match touches(m) {
        false => Cause { called_for: false, by: "nothing: something to touch: a ground, a robot, a body".into() },
        true => {
            let by = format!("something to touch: {} shapes that collide", m.colliders.len());
            Cause { called_for: true, by }
        }
    }
}

pub(super) fn contact_friction(m: &Model) -> Cause {
    pairs(m, "<surface friction> of both", |s| s.friction > 0.0)
}

pub(super) fn rolling_resistance(m: &Model) -> Cause {
    pairs(m, "<surface rolling_friction>", |s| s.rolling > 0.0)
}

pub(super) fn spinning_friction(m: &Model) -> Cause {
    pairs(m, "<surface spinning_friction>", |s| s.spinning > 0.0)
}

pub(super) fn restitution(m: &Model) -> Cause {
    pairs(m, "<surface restitution> of both", |s| s.restitution > 0.0)
}

pub(super) fn continuous_detection(m: &Model) -> Cause {
    let thin = |c: &&crate::model::Collider| !matches!(c.form, ContactForm::HalfSpace) && m.seat_of(c).0 != 0;
    let names: Vec<&str> = m.colliders.iter().filter(thin).map(|c| c.name.as_str()).collect();
    let names = if touches(m) { names } else { vec![] };
    some_of("shape", &names, m.colliders.len(), "shapes that move and can touch something")
}

pub(super) fn deactivation(m: &Model) -> Cause {
    let names: Vec<&str> = m.links.iter().filter(|l| l.deactivation.is_some()).map(|l| l.name.as_str()).collect();
    some_of("link", &names, m.links.len(), "<deactivate>")
}

pub(super) fn nobody(_: &Model) -> Cause {
    Cause { called_for: false, by: String::new() }
}
