//! Snapshots → topics.

use super::audience::Audience;
use super::connection::Plan;
use super::log::Logger;
use super::markers::{MarkerSettings, Markers};
use super::messages::{Clock, JointState, Shared, StringMessage, TFMessage, Time, TwistStamped, WrenchStamped};
use super::monitors::Monitors;
use super::states;
use super::tf::Frames;
use super::topics::{Outgoing, Topics, latched_qos, state_qos, stream_qos};
use crate::description::MonitorFrame;
use crate::model::Model;
use crate::world::Snapshot;
use std::sync::Arc;

/// The topic that tells a robot's state: two publishers of it are a mistake.
pub const JOINT_STATES: &str = "joint_states";

type SharedNames = Shared<Vec<String>>;

/// The publishers of the simulated state.
pub struct Outlet {
    model: Arc<Model>,
    frames: Frames,
    clock: Outgoing<Clock>,
    joint_states: Outgoing<JointState<SharedNames>>,
    axis_names: SharedNames,
    monitored: Vec<Monitored>,
    monitors: Monitors,
    /// `debug/markers`.
    pub markers: Markers,
    tf: Outgoing<TFMessage>,
    tf_static: Outgoing<TFMessage>,
    robot_description: Outgoing<StringMessage>,
    /// Simulated time from which the next /tf is due, ns.
    next_tf_ns: i64,
    /// Stamp of the state published last: while time stands, all of it is repeated.
    last_ns: i64,
    /// Who subscribes to what is made on demand.
    pub audience: Audience,
    /// Messages that DDS did not take because a reliable subscriber is too far behind.
    pub refused_by_dds: u64,
}

struct Monitored {
    link: usize,
    frame: MonitorFrame,
    twist: Outgoing<TwistStamped>,
    /// `None`: the link does not collide.
    wrench: Option<Outgoing<WrenchStamped>>,
}

impl Outlet {
    /// Creates the publishers.
    ///
    /// # Errors
    /// Names the topic that cannot be created.
    pub fn new(topics: &mut Topics, plan: &Plan, log: &Logger) -> Result<Self, String> {
        let model = &plan.robot.model;
        let stream = stream_qos();
        let latched = latched_qos();
        let mut audience = Audience::default();
        Ok(Self {
            model: model.clone(),
            frames: Frames::new(model),
            joint_states: topics.publisher(JOINT_STATES, "sensor_msgs/JointState", &state_qos())?,
            axis_names: Shared::new(model.axes.iter().map(|a| a.name.clone()).collect()),
            monitored: monitored(topics, model, log)?,
            monitors: Monitors::new(topics, model, plan.control.map(|c| &**c), &mut audience)?,
            markers: Markers::new(topics, model, &mut audience)?,
            clock: topics.publisher("/clock", "rosgraph_msgs/Clock", &stream)?,
            tf: topics.publisher("/tf", "tf2_msgs/TFMessage", &stream)?,
            tf_static: topics.publisher("/tf_static", "tf2_msgs/TFMessage", &latched)?,
            robot_description: topics.publisher("robot_description", "std_msgs/String", &latched)?,
            next_tf_ns: i64::MIN,
            last_ns: i64::MIN,
            audience,
            refused_by_dds: 0,
        })
    }

    /// Publishes what is latched: the URDF text, and the frames that never move.
    pub fn latch(&mut self, urdf: &str, initial: &Snapshot) {
        let text = StringMessage { data: urdf.into() };
        self.refused_by_dds += self.robot_description.send(text);
        self.refused_by_dds += self.tf_static.send(self.frames.fixed(initial));
    }

    /// Puts what is latched into a bag that was begun later.
    pub fn note_latched(&self, urdf: &str, initial: &Snapshot) {
        self.robot_description.note_latched(|| StringMessage { data: urdf.into() });
        self.tf_static.note_latched(|| self.frames.fixed(initial));
    }

    /// Publishes one state; /tf not more often than `tf_rate` (Hz, simulated time; 0: never).
    pub fn publish(&mut self, snapshot: &Snapshot, tf_rate: f64) {
        let stamp = Time::from_ns(snapshot.stamp_ns);
        let mut refused = self.clock.send(Clock { clock: stamp });
        refused += self.joint_states.send(states::joint_state(self.axis_names.clone(), snapshot));
        for m in &self.monitored {
            refused += m.twist.send(states::twist(&self.model, (m.link, m.frame), snapshot));
            if let Some(wrench) = &m.wrench {
                refused += wrench.send(states::wrench(&self.model, (m.link, m.frame), snapshot));
            }
        }
        refused += self.monitors.publish(snapshot, &self.audience);
        let stands = snapshot.stamp_ns == self.last_ns;
        if snapshot.stamp_ns < self.last_ns {
            // Time was reset: what was due in the old time is not waited for.
            self.next_tf_ns = i64::MIN;
        }
        self.last_ns = snapshot.stamp_ns;
        if tf_rate > 0.0 && (stands || snapshot.stamp_ns >= self.next_tf_ns) {
            refused += self.tf.send(self.frames.moving(snapshot));
            self.next_tf_ns = next_on_grid(snapshot.stamp_ns, 1e9 / tf_rate);
        }
        self.refused_by_dds += refused;
    }

    /// Shows one state as markers, if somebody subscribes and it is time for it.
    pub fn show(&mut self, snapshot: &Snapshot, settings: &MarkerSettings) {
        self.refused_by_dds += self.markers.publish(snapshot, settings, &self.audience);
    }
}

fn monitored(topics: &mut Topics, model: &Model, log: &Logger) -> Result<Vec<Monitored>, String> {
    let mut all = vec![];
    for (link, frame, token) in states::monitored(model) {
        let name = &model.links[link].name;
        let topic = format!("twist/{token}");
        if token != *name {
            log.warn(format!("link '{name}' has characters that a topic name must not have; its twist is on {topic}"));
        }
        let twist = topics.publisher(&topic, "geometry_msgs/TwistStamped", &state_qos())?;
        let collides = model.effects.contact && model.colliders.iter().any(|c| c.link == Some(link));
        let wrench = || topics.publisher(&format!("wrench/{token}"), "geometry_msgs/WrenchStamped", &state_qos());
        all.push(Monitored { link, frame, twist, wrench: collides.then(wrench).transpose()? });
    }
    Ok(all)
}

/// The first multiple of `period` ns after `stamp`, so that rates do not drift with the control interval.
fn next_on_grid(stamp: i64, period: f64) -> i64 {
    ((stamp as f64 / period).floor() * period + period).round() as i64
}

#[cfg(test)]
mod tests {
    use super::next_on_grid;

    #[test]
    fn fifty_hertz_on_a_millisecond_grid_is_every_twentieth() {
        let (mut next, mut sent) = (i64::MIN, vec![]);
        for ms in 0..100 {
            let stamp = ms * 1_000_000;
            if stamp >= next {
                sent.push(ms);
                next = next_on_grid(stamp, 20e6);
            }
        }
        assert_eq!(sent, [0, 20, 40, 60, 80]);
    }
}
