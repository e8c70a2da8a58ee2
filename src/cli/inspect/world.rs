//! What stands in the world beside the robot (W-13): robots, bodies, joints, and what collides.

use crate::model::{Base, Collider, LinkFrame, Model};
use serde_json::{Value, json};

/// Links that move and weigh something, and those that stand still and weigh something or collide.
fn links(m: &Model) -> (Vec<&str>, Vec<&str>) {
    let (mut dynamic, mut fixed) = (vec![], vec![]);
    for (i, link) in m.links.iter().enumerate() {
        let collides = m.colliders.iter().any(|c| c.link == Some(i));
        match link.frame {
            LinkFrame::OnBody { body: 0, .. } if link.mass > 0.0 || collides => fixed.push(link.name.as_str()),
            LinkFrame::OnBody { body, .. } if body > 0 && link.mass > 0.0 => dynamic.push(link.name.as_str()),
            _ => {}
        }
    }
    (dynamic, fixed)
}

pub(super) fn json(m: &Model) -> Value {
    let (dynamic, fixed) = links(m);
    let joints: Vec<&str> = m.axes.iter().map(|a| a.name.as_str()).collect();
    let joined = m.joined.iter().map(|j| json!({"name": j.name, "base": base(j.base), "links": j.links.len()}));
    json!({"dynamic": dynamic, "static": fixed, "joints": joints, "joined": joined.collect::<Vec<_>>(),
           "colliders": m.colliders.iter().map(|c| collider_json(m, c)).collect::<Vec<_>>()})
}

fn collider_json(m: &Model, c: &Collider) -> Value {
    let (p, q, s) = (c.pose.translation, c.pose.rotation.coords, c.surface);
    json!({"name": c.name, "link": c.link.map(|l| &m.links[l].name), "form": c.form.name(),
           "pose": [p.x, p.y, p.z, q.x, q.y, q.z, q.w], "friction": s.friction, "rolling_friction": s.rolling,
           "spinning_friction": s.spinning, "restitution": s.restitution, "margin": c.margin})
}

pub(super) fn table(m: &Model) -> String {
    let (dynamic, fixed) = links(m);
    let list = |names: &[&str]| if names.is_empty() { "none".into() } else { names.join(", ") };
    let mut text = format!(
        "\nworld: {} moving bodies, {} velocities, {:.3} kg\ndynamic: {}\nstatic: {}\n",
        m.bodies.len() - 1,
        m.nv,
        m.mass(),
        list(&dynamic),
        list(&fixed)
    );
    for j in &m.joined {
        let (base, links, axes) = (base(j.base), j.links.len(), j.axes.len());
        text += &format!("{:<28} base {base}, {links} links, {axes} axes\n", j.name);
    }
    text += &format!(
        "\n{:<28} {:<14} {:>9} {:>9} {:>9} {:>12} {:>9}\n",
        "collider", "form", "friction", "rolling", "spinning", "restitution", "margin m"
    );
    for c in &m.colliders {
        let s = c.surface;
        text += &format!(
            "{:<28} {:<14} {:>9} {:>9} {:>9} {:>12} {:>9}\n",
            c.name,
            c.form.name(),
            s.friction,
            s.rolling,
            s.spinning,
            s.restitution,
            c.margin
        );
    }
    text
}

fn base(base: Base) -> &'static str {
    if base == Base::Free { "free" } else { "fixed" }
}
