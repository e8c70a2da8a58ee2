//! A run of `simulate` as a bag: stamped and logged in simulated time.

use super::Sample;
use super::bag::{Bag, to_cdr};
use super::messages::{Clock, Header, JointState, Odometry, Time, WithCovariance};
use super::metadata::{Contents, Topic};
use super::schema::MessageType;
use crate::model::Model;
use crate::world::Snapshot;
use serde::Serialize;
use std::io::{self, Seek, Write};

/// Frame in which the base moves.
const WORLD: &str = "world";

/// Writes `/clock`, `/joint_states` and, for a free base, `/odom` (root link in `world`) per sample; `/NAME/odom` for whatever
/// else floats.
pub struct BagWriter<W: Write + Seek> {
    bag: Bag<W>,
    clock: usize,
    joint_states: usize,
    odometry: Vec<FreeBase>,
    axes: Vec<String>,
    payload: Vec<u8>,
}

/// A free base: topic of its odometry, index and name of the root link.
struct FreeBase {
    topic: usize,
    link: usize,
    frame: String,
}

impl<W: Write + Seek> BagWriter<W> {
    /// Writes the header and the message definitions.
    ///
    /// # Errors
    /// What the file system says.
    pub fn new(out: W, model: &Model) -> io::Result<Self> {
        let mut bag = Bag::new(out)?;
        let mut add = |topic: &str, kind: &str| {
            let kind = MessageType::by_name(kind).ok_or_else(|| io::Error::other(format!("{kind} is not known")))?;
            bag.add(Topic::new(topic, kind), &[])
        };
        let clock = add("/clock", "rosgraph_msgs/Clock")?;
        let joint_states = add("/joint_states", "sensor_msgs/JointState")?;
        let floats = |(name, link): (&str, usize)| {
            let topic = if link == model.root_link { "/odom".to_owned() } else { format!("/{name}/odom") };
            Ok(FreeBase { topic: add(&topic, "nav_msgs/Odometry")?, link, frame: model.links[link].name.clone() })
        };
        let odometry = model.floating().map(floats).collect::<io::Result<Vec<_>>>()?;
        let axes = model.axes.iter().map(|a| a.name.clone()).collect();
        Ok(Self { bag, clock, joint_states, odometry, axes, payload: Vec::new() })
    }

    /// Writes one message per topic.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write(&mut self, sample: &Sample) -> io::Result<()> {
        let s = &sample.snapshot;
        let Self { bag, payload, .. } = self;
        let mut instant = Instant { bag, payload, stamp_ns: s.stamp_ns.unsigned_abs() };
        let stamp = Time::from_ns(s.stamp_ns);
        instant.write(self.clock, &Clock { clock: stamp })?;
        instant.write(self.joint_states, &joint_state(stamp, &self.axes, s))?;
        for base in &self.odometry {
            instant.write(base.topic, &odometry(stamp, base, s))?;
        }
        Ok(())
    }

    /// Writes the index and the footer; tells what is in the bag.
    ///
    /// # Errors
    /// What the file system says.
    pub(super) fn finish(self) -> io::Result<Contents> {
        self.bag.finish()
    }
}

/// The messages of one instant.
struct Instant<'a, W: Write + Seek> {
    bag: &'a mut Bag<W>,
    payload: &'a mut Vec<u8>,
    stamp_ns: u64,
}

impl<W: Write + Seek> Instant<'_, W> {
    fn write(&mut self, topic: usize, message: &impl Serialize) -> io::Result<()> {
        to_cdr(message, self.payload)?;
        self.bag.write(topic, self.stamp_ns, self.payload)
    }
}

fn joint_state<'a>(stamp: Time, name: &'a [String], s: &'a Snapshot) -> JointState<'a> {
    let header = Header { stamp, frame_id: "" };
    JointState { header, name, position: &s.position, velocity: &s.velocity, effort: &s.effort }
}

fn odometry<'a>(stamp: Time, base: &'a FreeBase, s: &Snapshot) -> Odometry<'a> {
    Odometry {
        header: Header { stamp, frame_id: WORLD },
        child_frame_id: &base.frame,
        pose: WithCovariance::exact((&s.link_pose[base.link]).into()),
        twist: WithCovariance::exact((&s.link_twist[base.link]).into()),
    }
}
