//! `joint_monitors`, `body_states`, odometry and the states for ros2_control: made only while somebody subscribes, or all is recorded.

use super::audience::{Audience, Seat};
use super::messages::{
    BodyState, BodyStates, Header, JointMonitor, JointMonitors, JointState, Odometry, Shared, Time,
    Twist as TwistMessage, Wrench as WrenchMessage,
};
use super::names::topic_tokens;
use super::ros2_control::{Control, ControlStates};
use super::tf::WORLD;
use super::topics::{Outgoing, Topics, state_qos};
use crate::description::MonitorFrame;
use crate::math::Twist;
use crate::model::Model;
use crate::record::messages::WithCovariance;
use crate::world::{Snapshot, Wrench};
use serde::Serialize;

/// The publishers.
pub struct Monitors {
    joints: Stream<JointMonitors>,
    bodies: Stream<BodyStates>,
    odometry: Vec<(Stream<Odometry>, Link)>,
    control: Option<(Stream<SharedJointState>, ControlStates)>,
    joints_shown: Vec<Joint>,
    monitored: Vec<(Link, MonitorFrame)>,
    world: Shared<String>,
}

/// A joint as it is shown.
struct Joint {
    name: Shared<String>,
    axes: [Option<usize>; 4],
    /// False of a separate rig, which mirrors angles and drives nothing (J-4).
    drives: bool,
}

struct Stream<M: Serialize> {
    out: Outgoing<M>,
    seat: Seat,
}

type SharedJointState = JointState<Shared<Vec<String>>>;

/// Index in `Model::links`, and name.
type Link = (usize, Shared<String>);

impl Monitors {
    /// Creates the publishers, and has their subscribers watched.
    ///
    /// # Errors
    /// Names the topic that cannot be created.
    pub fn new(
        topics: &mut Topics,
        model: &Model,
        control: Option<&Control>,
        audience: &mut Audience,
    ) -> Result<Self, String> {
        let link = |i: usize| (i, Shared::new(model.links[i].name.clone()));
        let joints = stream(topics, audience, "joint_monitors", "realnoid/JointMonitors")?;
        let bodies = stream(topics, audience, "body_states", "realnoid/BodyStates")?;
        let mut odometry = vec![];
        for (name, root) in model.floating() {
            // As in the bags of `simulate`.
            let first = root == model.root_link;
            let token = topic_tokens([name]).concat();
            let topic = if first { "odom".into() } else { format!("{token}/odom") };
            odometry.push((stream(topics, audience, &topic, "nav_msgs/Odometry")?, link(root)));
        }
        let mut states = |control: &Control| -> Result<_, String> {
            let stream = stream(topics, audience, &control.states_topic, "sensor_msgs/JointState")?;
            Ok((stream, ControlStates::new(control, model)))
        };
        let control = control.map(&mut states).transpose()?;
        let monitored = model.links.iter().enumerate().filter_map(|(i, l)| Some((link(i), l.monitor?))).collect();
        let joints_shown = shown(model);
        Ok(Self { joints, bodies, odometry, control, joints_shown, monitored, world: Shared::new(WORLD.into()) })
    }

    /// Publishes what somebody listens to; the number of messages that DDS refused.
    pub fn publish(&self, snapshot: &Snapshot, audience: &Audience) -> u64 {
        let header = |frame_id: &str| Header { stamp: Time::from_ns(snapshot.stamp_ns), frame_id: frame_id.into() };
        let mut refused = 0;
        if audience.any(self.joints.seat) {
            let joints = self.joints_shown.iter().map(|joint| joint_monitor(joint, snapshot)).collect();
            refused += self.joints.out.send(JointMonitors { header: header(""), joints });
        }
        if audience.any(self.bodies.seat) {
            let bodies = self.monitored.iter().map(|(link, frame)| self.body_state(link, *frame, snapshot)).collect();
            refused += self.bodies.out.send(BodyStates { header: header(WORLD), bodies });
        }
        if let Some((stream, states)) = self.control.as_ref().filter(|(stream, _)| audience.any(stream.seat)) {
            refused += stream.out.send(states.message(snapshot, Time::from_ns(snapshot.stamp_ns)));
        }
        for (stream, (link, name)) in self.odometry.iter().filter(|(stream, _)| audience.any(stream.seat)) {
            refused += stream.out.send(Odometry {
                header: header(WORLD),
                child_frame_id: name.clone(),
                pose: WithCovariance::exact((&snapshot.link_pose[*link]).into()),
                twist: WithCovariance::exact((&snapshot.link_twist[*link]).into()),
            });
        }
        refused
    }

    fn body_state(&self, (link, name): &Link, frame: MonitorFrame, snapshot: &Snapshot) -> BodyState {
        let frame_id = match frame {
            MonitorFrame::Body => name.clone(),
            MonitorFrame::World => self.world.clone(),
        };
        let (twist, wrench) = (twist_along(snapshot, *link, frame), wrench_along(snapshot, *link, frame));
        BodyState {
            name: name.clone(),
            frame_id,
            pose: (&snapshot.link_pose[*link]).into(),
            twist: TwistMessage { linear: twist.linear.into(), angular: twist.angular.into() },
            wrench: WrenchMessage { force: wrench.force.into(), torque: wrench.torque.into() },
        }
    }
}

fn stream<M: Serialize>(
    topics: &mut Topics,
    audience: &mut Audience,
    name: &str,
    kind: &str,
) -> Result<Stream<M>, String> {
    let out = topics.publisher(name, kind, &state_qos())?;
    let seat = audience.watch(out.topic());
    Ok(Stream { out, seat })
}

/// The joints, then the rigs that mirror some of them.
fn shown(model: &Model) -> Vec<Joint> {
    let named = |name: &str, axes, drives| Joint { name: Shared::new(name.to_owned()), axes, drives };
    let joints = model.joints.iter().map(|set| named(&set.name, set.axes, true));
    let rigs = model.rigs.iter().map(|rig| {
        let [h, p, b] = rig.axes;
        named(&rig.name, [h, p, b, None], false)
    });
    joints.chain(rigs).collect()
}

fn joint_monitor(joint: &Joint, snapshot: &Snapshot) -> JointMonitor {
    let of = |values: &[f64]| joint.axes.map(|axis| axis.map_or(f64::NAN, |axis| values[axis]));
    JointMonitor {
        name: joint.name.clone(),
        position: of(&snapshot.position),
        velocity: of(&snapshot.velocity),
        effort: if joint.drives { of(&snapshot.effort) } else { [f64::NAN; 4] },
    }
}

/// Velocity of the origin of a link frame, along its own axes or those of the world.
pub fn twist_along(snapshot: &Snapshot, link: usize, frame: MonitorFrame) -> Twist {
    let v_l = snapshot.link_twist[link];
    match frame {
        MonitorFrame::Body => v_l,
        MonitorFrame::World => {
            let r_wl = snapshot.link_pose[link].rotation;
            Twist { angular: r_wl * v_l.angular, linear: r_wl * v_l.linear }
        }
    }
}

/// What the contacts of a link do about the origin of its frame, along its own axes or those of the world.
pub fn wrench_along(snapshot: &Snapshot, link: usize, frame: MonitorFrame) -> Wrench {
    let w = snapshot.link_wrench[link];
    match frame {
        MonitorFrame::World => w,
        MonitorFrame::Body => {
            let r_lw = snapshot.link_pose[link].rotation.inverse();
            Wrench { force: r_lw * w.force, torque: r_lw * w.torque }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Pose, Vec3};

    #[test]
    fn what_a_joint_does_not_have_is_nan() {
        let snapshot = Snapshot {
            position: vec![0.1, 0.2, 0.3],
            velocity: vec![1.0, 2.0, 3.0],
            effort: vec![10.0, 20.0, 30.0],
            ..Snapshot::default()
        };
        let ankle = |drives| Joint { name: Shared::new("ankle".into()), axes: [None, Some(2), Some(0), None], drives };
        let m = joint_monitor(&ankle(true), &snapshot);
        assert_eq!((m.position[1], m.position[2], m.velocity[1], m.effort[2]), (0.3, 0.1, 3.0, 10.0));
        assert!(m.position[0].is_nan() && m.effort[3].is_nan());
        let rig = joint_monitor(&ankle(false), &snapshot);
        assert!(rig.position[1] == 0.3 && rig.effort.iter().all(|x| x.is_nan()));
    }

    #[test]
    fn twists_and_wrenches_turn_with_the_link() {
        let quarter = Pose::new(Vec3::zeros(), Vec3::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        let snapshot = Snapshot {
            link_pose: vec![quarter],
            link_twist: vec![Twist { angular: Vec3::z(), linear: Vec3::x() }],
            link_wrench: vec![Wrench { force: Vec3::x(), torque: Vec3::zeros() }],
            ..Snapshot::default()
        };
        assert_eq!(twist_along(&snapshot, 0, MonitorFrame::Body).linear, Vec3::x());
        assert!((twist_along(&snapshot, 0, MonitorFrame::World).linear - Vec3::y()).norm() < 1e-15);
        assert!((wrench_along(&snapshot, 0, MonitorFrame::Body).force + Vec3::y()).norm() < 1e-15);
    }
}
