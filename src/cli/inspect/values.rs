//! The values of every link in full, in the form and units of table 6-9 of the source (J-19).

use super::super::load::Loaded;
use crate::math::{Mat3, Vec3};
use crate::monitor::{LinkValues, joint_link_values, link_values};
use std::fmt::Write;

/// The system unit of length (G-9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// `m`, `cm` or `mm`.
    pub name: &'static str,
    /// How many of it make a metre.
    pub per_metre: f64,
    /// Decimals that show a length to the nanometre.
    decimals: usize,
}

impl Unit {
    /// `m` for any other word: the command line allows only the three.
    pub fn named(name: &str) -> Self {
        match name {
            "cm" => Self { name: "cm", per_metre: 100.0, decimals: 7 },
            "mm" => Self { name: "mm", per_metre: 1000.0, decimals: 6 },
            _ => Self { name: "m", per_metre: 1.0, decimals: 9 },
        }
    }

    /// The unit in which a volume is shown beside m³: the source takes cm where the system unit is the metre.
    fn beside_metre(self) -> Self {
        if self.name == "m" { Self::named("cm") } else { self }
    }
}

/// One block per joint: all bodies that it moves as one (J-6); then one for each of them, if there are several.
pub(super) fn full(l: &Loaded, unit: Unit) -> String {
    let single = link_values(&l.model, &l.bodies);
    let mut blocks = vec![];
    for whole in joint_link_values(&l.model, &l.bodies) {
        blocks.push(block(&title(&whole), &whole, unit));
        let parts = whole.seats.iter().map(|(i, _)| &single[*i]).filter(|v| v.properties.mass > 0.0);
        if whole.members.len() > 1 {
            blocks.extend(parts.map(|v| block(&format!("part {}", v.frame), v, unit)));
        }
    }
    blocks.join("\n")
}

fn block(title: &str, v: &LinkValues, unit: Unit) -> String {
    let p = &v.properties;
    let beside = unit.beside_metre();
    let volume = v
        .volume
        .map(|m3| format!("{} m³   {} {}³", exponent(m3), exponent(m3 * beside.per_metre.powi(3)), beside.name));
    let center = (p.center * unit.per_metre).map(|x| x + 0.0);
    let mut text = String::new();
    let mut line = |name: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {name:<20} {value}");
    };
    line("volume", volume.as_deref().unwrap_or("unknown: the mass is stated by <inertial>"));
    line("mass", &format!("{} kg   {} g", exponent(p.mass), exponent(p.mass * 1e3)));
    let d = unit.decimals;
    line("centre of mass", &format!("{:.d$} {:.d$} {:.d$} {}", center.x, center.y, center.z, unit.name));
    matrix(&mut line, "inertia at origin", &v.inertia_at_origin());
    matrix(&mut line, "inertia at centre", &p.inertia);
    line("principal moments", &format!("{} kg·m²", row(&v.principal_moments())));
    line("L scale", &v.l_scale.to_string());
    format!("{title}\n{text}")
}

fn title(v: &LinkValues) -> String {
    let joint = match &v.membership {
        None => "base".to_owned(),
        Some(m) if m.joint == m.axis => format!("joint {}", m.joint),
        Some(m) => format!("joint {}, axis {}", m.joint, m.axis),
    };
    let others: Vec<&str> = v.members.iter().filter(|m| **m != v.frame).map(String::as_str).collect();
    let with = if others.is_empty() { String::new() } else { format!(", with {}", others.join(", ")) };
    format!("{joint}: link {}{with}", v.frame)
}

fn matrix(line: &mut impl FnMut(&str, &str), name: &str, m: &Mat3) {
    for i in 0..3 {
        let row = row(&m.row(i).transpose());
        line(if i == 0 { name } else { "" }, &if i == 0 { format!("{row} kg·m²") } else { row });
    }
}

fn row(v: &Vec3) -> String {
    v.iter().map(|x| format!("{:>23}", exponent(*x))).collect::<Vec<_>>().join(" ")
}

/// One digit, 15 decimals, exponent with its sign.
fn exponent(x: f64) -> String {
    // Adding 0 takes the sign from a negative zero.
    let text = format!("{:.15E}", x + 0.0);
    if text.contains("E-") { text } else { text.replace('E', "E+") }
}
