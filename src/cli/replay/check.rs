//! Published messages of a bag against those that the replayed state would be published as.

use crate::description::MonitorFrame;
use crate::model::Model;
use crate::record::{CDR_LITTLE_ENDIAN, to_cdr};
use crate::ros::messages::{JointState, TwistStamped, WrenchStamped};
use crate::ros::states;
use crate::world::Snapshot;
use byteorder::LittleEndian;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The message in `cdr`.
///
/// # Errors
/// It is none of this type.
pub fn decode<T: DeserializeOwned>(cdr: &[u8]) -> Result<T, String> {
    let body = cdr.strip_prefix(&CDR_LITTLE_ENDIAN).ok_or("is no little-endian CDR")?;
    let (message, _) = cdr_encoding::from_bytes::<T, LittleEndian>(body).map_err(|e| e.to_string())?;
    Ok(message)
}

/// The stamp of a message that begins with a header, ns.
pub fn stamp_ns(cdr: &[u8]) -> Option<i64> {
    let word = |at: usize| cdr.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
    Some(i64::from(word(4)? as i32) * 1_000_000_000 + i64::from(word(8)?))
}

/// What is compared, by the name before namespace and remapping.
pub struct Checks {
    axes: Vec<String>,
    monitored: Vec<(usize, MonitorFrame, String)>,
}

impl Checks {
    /// Of a model.
    pub fn new(m: &Model) -> Self {
        Self { axes: m.axes.iter().map(|a| a.name.clone()).collect(), monitored: states::monitored(m) }
    }

    /// Is a topic compared?
    pub fn knows(&self, relative: &str) -> bool {
        let token = relative.strip_prefix("twist/").or_else(|| relative.strip_prefix("wrench/"));
        relative == "joint_states" || token.is_some_and(|t| self.monitored.iter().any(|(.., known)| known == t))
    }

    /// `None`: not a topic that is compared; else what is different in the message, if anything is.
    pub fn check(&self, relative: &str, cdr: &[u8], (m, s): (&Model, &Snapshot)) -> Option<Result<(), String>> {
        if relative == "joint_states" {
            let expected = states::joint_state(&self.axes, s);
            return Some(self.compare(relative, cdr, &expected, |r: &JointState| self::axes(&self.axes, r, s)));
        }
        let (kind, token) = relative.split_once('/')?;
        let (link, frame, _) = self.monitored.iter().find(|(.., t)| t == token)?;
        let at = (*link, *frame);
        match kind {
            "twist" => {
                let expected = states::twist(m, at, s);
                let parts = |t: &TwistStamped| {
                    let (v, w) = (t.twist.linear, t.twist.angular);
                    [
                        ("linear x", v.x),
                        ("linear y", v.y),
                        ("linear z", v.z),
                        ("angular x", w.x),
                        ("angular y", w.y),
                        ("angular z", w.z),
                    ]
                };
                Some(self.compare(relative, cdr, &expected, |r| first(&parts(r), &parts(&expected))))
            }
            "wrench" => {
                let expected = states::wrench(m, at, s);
                let parts = |t: &WrenchStamped| {
                    let (f, n) = (t.wrench.force, t.wrench.torque);
                    [
                        ("force x", f.x),
                        ("force y", f.y),
                        ("force z", f.z),
                        ("torque x", n.x),
                        ("torque y", n.y),
                        ("torque z", n.z),
                    ]
                };
                Some(self.compare(relative, cdr, &expected, |r| first(&parts(r), &parts(&expected))))
            }
            _ => None,
        }
    }

    fn compare<T: DeserializeOwned>(
        &self,
        name: &str,
        cdr: &[u8],
        expected: &impl Serialize,
        find: impl Fn(&T) -> Option<String>,
    ) -> Result<(), String> {
        let mut own = vec![];
        to_cdr(expected, &mut own).map_err(|e| format!("{name}: {e}"))?;
        if own == cdr {
            return Ok(());
        }
        match decode::<T>(cdr) {
            Ok(recorded) => {
                let found = find(&recorded).unwrap_or_else(|| "the numbers are the same; stamp or names differ".into());
                Err(format!("{name}: {found}"))
            }
            Err(reason) => Err(format!("{name}: the recorded message cannot be read: {reason}")),
        }
    }
}

fn axes(names: &[String], recorded: &JointState, s: &Snapshot) -> Option<String> {
    let arrays = [
        ("position", &recorded.position, &s.position),
        ("velocity", &recorded.velocity, &s.velocity),
        ("effort", &recorded.effort, &s.effort),
    ];
    if let Some((part, there, here)) = arrays.iter().find(|(_, a, b)| a.len() != b.len()) {
        return Some(format!("{} values of {part}, but {} axes", there.len(), here.len()));
    }
    names.iter().enumerate().find_map(|(i, name)| {
        let other = |(part, there, here): &(&str, &Vec<f64>, &Vec<f64>)| {
            (there[i].to_bits() != here[i].to_bits())
                .then(|| format!("axis '{name}' {part} {}", values(there[i], here[i])))
        };
        arrays.iter().find_map(other)
    })
}

fn first(recorded: &[(&str, f64)], replayed: &[(&str, f64)]) -> Option<String> {
    let mut pairs = recorded.iter().zip(replayed);
    pairs
        .find(|((_, a), (_, b))| a.to_bits() != b.to_bits())
        .map(|((part, a), (_, b))| format!("{part} {}", values(*a, *b)))
}

fn values(recorded: f64, replayed: f64) -> String {
    format!(
        "recorded {recorded:?}, replayed {replayed:?} (bits {:016x}, {:016x})",
        recorded.to_bits(),
        replayed.to_bits()
    )
}
