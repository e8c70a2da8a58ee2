//! Poses: angles set as by a hand, and remembered as those at start.

use super::Office;
use crate::model::Model;
use crate::ros::asks::Asks;
use crate::ros::messages::{EmptyRequest, SetJointAnglesRequest, TriggerResponse};
use crate::ros::service::Service;
use crate::ros::topics::Topics;
use crate::world::{Order, Side};

/// `remember_pose` and `set_joint_angles`.
pub struct PoseServices {
    remember: Service<EmptyRequest, TriggerResponse>,
    angles: Service<SetJointAnglesRequest, TriggerResponse>,
}

impl PoseServices {
    /// Creates the servers.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics) -> Result<Self, String> {
        Ok(Self {
            remember: topics.service("remember_pose", "std_srvs/Trigger")?,
            angles: topics.service("set_joint_angles", "realnoid/SetJointAngles")?,
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, office: &Office<'_>) {
        let asks = office.asks;
        let remember = self.remember.serve(async |_| asks.order(Order::Remember).await.into());
        let angles = self.angles.serve(async |r| set_angles(asks, r).await.into());
        futures::join!(remember, angles);
    }
}

async fn set_angles(asks: &Asks, r: SetJointAnglesRequest) -> Result<(), String> {
    let order = asks.look(move |w| order(w.model(), &r)).await??;
    asks.order(order).await
}

/// What is asked for, with the axes as numbers.
fn order(m: &Model, r: &SetJointAnglesRequest) -> Result<Order, String> {
    let side = match r.side {
        SetJointAnglesRequest::TIP => Side::Tip,
        SetJointAnglesRequest::ROOT => Side::Root,
        other => return Err(format!("side is {other}; it must be TIP (0) or ROOT (1)")),
    };
    if r.name.is_empty() {
        return Err("no axis is named".into());
    }
    if r.name.len() != r.position.len() {
        return Err(format!("{} positions for {} names", r.position.len(), r.name.len()));
    }
    let mut positions: Vec<(usize, f64)> = vec![];
    for (name, position) in r.name.iter().zip(&r.position) {
        let unknown = || format!("there is no axis '{name}' (parameter 'axes' lists them)");
        let axis = m.axis(name).ok_or_else(unknown)?;
        if positions.iter().any(|(other, _)| *other == axis) {
            return Err(format!("axis '{name}' is named twice"));
        }
        positions.push((axis, *position));
    }
    Ok(Order::SetAngles { positions, side })
}
