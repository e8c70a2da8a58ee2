//! Snapshots → topics.

use super::log::Logger;
use super::messages::{
    Clock, Header, JointState, Shared, StringMessage, TFMessage, Time, Twist as TwistMessage, TwistStamped,
    Wrench as WrenchMessage, WrenchStamped,
};
use super::names::topic_tokens;
use super::tf::{Frames, WORLD};
use super::topics::{Topics, latched_qos, stream_qos};
use crate::description::MonitorFrame;
use crate::model::Model;
use crate::world::Snapshot;
use ros2_client::Publisher;
use serde::Serialize;
use std::sync::Arc;

type SharedNames = Shared<Vec<String>>;

/// The publishers of the simulated state.
pub struct Outlet {
    model: Arc<Model>,
    frames: Frames,
    clock: Publisher<Clock>,
    joint_states: Publisher<JointState<SharedNames>>,
    axis_names: SharedNames,
    monitored: Vec<Monitored>,
    tf: Publisher<TFMessage>,
    tf_static: Publisher<TFMessage>,
    robot_description: Publisher<StringMessage>,
    /// Simulated time from which the next /tf is due, ns.
    next_tf_ns: i64,
    /// Stamp of the state published last: while time stands, all of it is repeated.
    last_ns: i64,
    /// Messages that DDS did not take because a reliable subscriber is too far behind.
    pub refused_by_dds: u64,
}

struct Monitored {
    link: usize,
    frame: MonitorFrame,
    twist: Publisher<TwistStamped>,
    /// `None`: the link does not collide.
    wrench: Option<Publisher<WrenchStamped>>,
}

impl Outlet {
    /// Creates the publishers for `model`.
    pub fn new(topics: &mut Topics, model: &Arc<Model>, log: &Logger) -> Result<Self, String> {
        let stream = stream_qos();
        let latched = latched_qos();
        Ok(Self {
            model: model.clone(),
            frames: Frames::new(model),
            joint_states: topics.publisher("joint_states", "sensor_msgs/JointState", &stream)?,
            axis_names: Shared::new(model.axes.iter().map(|a| a.name.clone()).collect()),
            monitored: monitored(topics, model, log)?,
            clock: topics.publisher("/clock", "rosgraph_msgs/Clock", &stream)?,
            tf: topics.publisher("/tf", "tf2_msgs/TFMessage", &stream)?,
            tf_static: topics.publisher("/tf_static", "tf2_msgs/TFMessage", &latched)?,
            robot_description: topics.publisher("robot_description", "std_msgs/String", &latched)?,
            next_tf_ns: i64::MIN,
            last_ns: i64::MIN,
            refused_by_dds: 0,
        })
    }

    /// Publishes what is latched: the URDF text, and the frames that never move.
    pub fn latch(&mut self, urdf: &str, initial: &Snapshot) {
        let text = StringMessage { data: urdf.into() };
        self.refused_by_dds += send(&self.robot_description, text);
        self.refused_by_dds += send(&self.tf_static, self.frames.fixed(initial));
    }

    /// Publishes one state; /tf not more often than `tf_rate` (Hz, simulated time; 0: never).
    pub fn publish(&mut self, snapshot: &Snapshot, tf_rate: f64) {
        let stamp = Time::from_ns(snapshot.stamp_ns);
        let mut refused = send(&self.clock, Clock { clock: stamp });
        refused += send(&self.joint_states, self.joint_state(snapshot, stamp));
        for m in &self.monitored {
            refused += send(&m.twist, self.twist(m, snapshot, stamp));
            if let Some(wrench) = &m.wrench {
                refused += send(wrench, self.wrench(m, snapshot, stamp));
            }
        }
        let stands = snapshot.stamp_ns == self.last_ns;
        self.last_ns = snapshot.stamp_ns;
        if tf_rate > 0.0 && (stands || snapshot.stamp_ns >= self.next_tf_ns) {
            refused += send(&self.tf, self.frames.moving(snapshot));
            self.next_tf_ns = next_on_grid(snapshot.stamp_ns, 1e9 / tf_rate);
        }
        self.refused_by_dds += refused;
    }

    fn joint_state(&self, snapshot: &Snapshot, stamp: Time) -> JointState<SharedNames> {
        JointState {
            header: Header { stamp, frame_id: String::new() },
            name: self.axis_names.clone(),
            position: snapshot.position.clone(),
            velocity: snapshot.velocity.clone(),
            effort: snapshot.effort.clone(),
        }
    }

    fn twist(&self, m: &Monitored, snapshot: &Snapshot, stamp: Time) -> TwistStamped {
        let v_l = snapshot.link_twist[m.link];
        let (frame_id, linear, angular) = match m.frame {
            MonitorFrame::Body => (self.model.links[m.link].name.clone(), v_l.linear, v_l.angular),
            MonitorFrame::World => {
                let r_wl = snapshot.link_pose[m.link].rotation;
                (WORLD.to_string(), r_wl * v_l.linear, r_wl * v_l.angular)
            }
        };
        let twist = TwistMessage { linear: linear.into(), angular: angular.into() };
        TwistStamped { header: Header { stamp, frame_id }, twist }
    }

    fn wrench(&self, m: &Monitored, snapshot: &Snapshot, stamp: Time) -> WrenchStamped {
        let w = snapshot.link_wrench[m.link];
        let (frame_id, force, torque) = match m.frame {
            MonitorFrame::World => (WORLD.to_string(), w.force, w.torque),
            MonitorFrame::Body => {
                let r_lw = snapshot.link_pose[m.link].rotation.inverse();
                (self.model.links[m.link].name.clone(), r_lw * w.force, r_lw * w.torque)
            }
        };
        let wrench = WrenchMessage { force: force.into(), torque: torque.into() };
        WrenchStamped { header: Header { stamp, frame_id }, wrench }
    }
}

fn monitored(topics: &mut Topics, model: &Model, log: &Logger) -> Result<Vec<Monitored>, String> {
    let links = || model.links.iter().enumerate().filter_map(|(i, l)| Some((i, l.name.as_str(), l.monitor?)));
    let tokens = topic_tokens(links().map(|(_, name, _)| name));
    let mut all = vec![];
    for ((link, name, frame), token) in links().zip(tokens) {
        let topic = format!("twist/{token}");
        if token != name {
            log.warn(format!("link '{name}' has characters that a topic name must not have; its twist is on {topic}"));
        }
        let twist = topics.publisher(&topic, "geometry_msgs/TwistStamped", &stream_qos())?;
        let collides = model.effects.contact && model.colliders.iter().any(|c| c.link == Some(link));
        let wrench = || topics.publisher(&format!("wrench/{token}"), "geometry_msgs/WrenchStamped", &stream_qos());
        all.push(Monitored { link, frame, twist, wrench: collides.then(wrench).transpose()? });
    }
    Ok(all)
}

/// 1 if DDS refused it.
fn send<M: Serialize>(publisher: &Publisher<M>, message: M) -> u64 {
    u64::from(publisher.publish(message).is_err())
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
