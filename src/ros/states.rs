//! Messages that show a state; a replay makes them again.

use super::messages::{
    Header, JointState, Time, Twist as TwistMessage, TwistStamped, Wrench as WrenchMessage, WrenchStamped,
};
use super::monitors::{twist_along, wrench_along};
use super::tf::WORLD;
use crate::description::MonitorFrame;
use crate::model::Model;
use crate::world::Snapshot;

fn stamp(s: &Snapshot) -> Time {
    Time::from_ns(s.stamp_ns)
}

/// `joint_states`; `name` are the axes in the order of `Model::axes`.
pub fn joint_state<N>(name: N, s: &Snapshot) -> JointState<N> {
    JointState {
        header: Header { stamp: stamp(s), frame_id: String::new() },
        name,
        position: s.position.clone(),
        velocity: s.velocity.clone(),
        effort: s.effort.clone(),
    }
}

/// `twist/<link>`: of the link's origin, along the axes of the frame in which the link is monitored.
pub fn twist(m: &Model, (link, frame): (usize, MonitorFrame), s: &Snapshot) -> TwistStamped {
    let v = twist_along(s, link, frame);
    let twist = TwistMessage { linear: v.linear.into(), angular: v.angular.into() };
    TwistStamped { header: header(m, (link, frame), s), twist }
}

/// `wrench/<link>`: of all contacts of the link, at its origin.
pub fn wrench(m: &Model, (link, frame): (usize, MonitorFrame), s: &Snapshot) -> WrenchStamped {
    let w = wrench_along(s, link, frame);
    let wrench = WrenchMessage { force: w.force.into(), torque: w.torque.into() };
    WrenchStamped { header: header(m, (link, frame), s), wrench }
}

/// Stamp, and along whose axes a monitored link is shown.
fn header(m: &Model, (link, frame): (usize, MonitorFrame), s: &Snapshot) -> Header {
    let frame_id = match frame {
        MonitorFrame::Body => m.links[link].name.clone(),
        MonitorFrame::World => WORLD.into(),
    };
    Header { stamp: stamp(s), frame_id }
}

/// What each topic of a monitored link is called, before namespace and remapping: link, frame, and the end of the names.
pub fn monitored(m: &Model) -> Vec<(usize, MonitorFrame, String)> {
    let links = || m.links.iter().enumerate().filter_map(|(i, l)| Some((i, l.name.as_str(), l.monitor?)));
    let tokens = super::names::topic_tokens(links().map(|(_, name, _)| name));
    links().zip(tokens).map(|((link, _, frame), token)| (link, frame, token)).collect()
}
