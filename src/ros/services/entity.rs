//! simulation_interfaces: entities are listed, read, and put somewhere.

use super::Office;
use super::entities::{Entity, named, selected};
use crate::ros::asks::Asks;
use crate::ros::messages::simulation::{
    EntitiesReply, EntitiesRequest, EntitiesStatesReply, EntityInfo, EntityInfoReply, EntityRequest, EntityState,
    EntityStateReply, ResultReply, SetEntityStateRequest, SimulationResult,
};
use crate::ros::messages::{Accel, Header, PoseMessage, Quaternion, Twist, Vector3};
use crate::ros::service::Service;
use crate::ros::tf::WORLD;
use crate::ros::topics::Topics;
use crate::world::{Order, World, checked_pose};

/// `get_entities`, `get_entities_states`, `get_entity_state`, `get_entity_info`, `set_entity_state`, `delete_entity`.
pub struct EntityServices {
    list: Service<EntitiesRequest, EntitiesReply>,
    states: Service<EntitiesRequest, EntitiesStatesReply>,
    state: Service<EntityRequest, EntityStateReply>,
    info: Service<EntityRequest, EntityInfoReply>,
    set: Service<SetEntityStateRequest, ResultReply>,
    delete: Service<EntityRequest, ResultReply>,
}

impl EntityServices {
    /// Creates the servers.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics) -> Result<Self, String> {
        Ok(Self {
            list: topics.service("get_entities", "simulation_interfaces/GetEntities")?,
            states: topics.service("get_entities_states", "simulation_interfaces/GetEntitiesStates")?,
            state: topics.service("get_entity_state", "simulation_interfaces/GetEntityState")?,
            info: topics.service("get_entity_info", "simulation_interfaces/GetEntityInfo")?,
            set: topics.service("set_entity_state", "simulation_interfaces/SetEntityState")?,
            delete: topics.service("delete_entity", "simulation_interfaces/DeleteEntity")?,
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, office: &Office<'_>) {
        let asks = office.asks;
        futures::join!(
            self.list.serve(async |r| list(asks, r).await),
            self.states.serve(async |r| states(asks, r).await),
            self.state.serve(async |r| state(asks, r).await),
            self.info.serve(async |r| info(asks, r).await),
            self.set.serve(async |r| put(asks, &r).await.err().unwrap_or_else(SimulationResult::ok).into()),
            self.delete.serve(async |r| delete(asks, r.entity).await.err().unwrap_or_else(SimulationResult::ok).into()),
        );
    }
}

/// What `see` finds in the world, or why it finds nothing.
async fn look<T: Send + 'static>(
    asks: &Asks,
    see: impl FnOnce(&World) -> Result<T, SimulationResult> + Send + 'static,
) -> Result<T, SimulationResult> {
    asks.look(see).await.unwrap_or_else(|reason| Err(SimulationResult::failed(reason)))
}

async fn list(asks: &Asks, r: EntitiesRequest) -> EntitiesReply {
    match look(asks, move |w| selected(w.model(), &r.filters)).await {
        Ok(all) => EntitiesReply { result: SimulationResult::ok(), entities: names(&all) },
        Err(result) => EntitiesReply { result, entities: vec![] },
    }
}

fn names(all: &[Entity]) -> Vec<String> {
    all.iter().map(|e| e.name.clone()).collect()
}

async fn states(asks: &Asks, r: EntitiesRequest) -> EntitiesStatesReply {
    let see = move |w: &World| {
        let (all, now) = (selected(w.model(), &r.filters)?, w.new_snapshot());
        Ok((names(&all), all.iter().map(|e| e.state(&now)).collect()))
    };
    match look(asks, see).await {
        Ok((entities, states)) => EntitiesStatesReply { result: SimulationResult::ok(), entities, states },
        Err(result) => EntitiesStatesReply { result, entities: vec![], states: vec![] },
    }
}

async fn state(asks: &Asks, r: EntityRequest) -> EntityStateReply {
    match look(asks, move |w| Ok(named(w.model(), &r.entity)?.state(&w.new_snapshot()))).await {
        Ok(state) => EntityStateReply { result: SimulationResult::ok(), state },
        Err(result) => EntityStateReply { result, state: nowhere() },
    }
}

/// What an answer without a state carries.
fn nowhere() -> EntityState {
    EntityState {
        header: Header::default(),
        pose: PoseMessage { position: Vector3::default(), orientation: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 } },
        twist: Twist::default(),
        acceleration: Accel::default(),
    }
}

async fn info(asks: &Asks, r: EntityRequest) -> EntityInfoReply {
    match look(asks, move |w| named(w.model(), &r.entity)).await {
        Ok(entity) => EntityInfoReply { result: SimulationResult::ok(), info: entity.info() },
        Err(result) => EntityInfoReply { result, info: EntityInfo::default() },
    }
}

/// Puts an entity somewhere; the world has the last word on whether it floats.
async fn put(asks: &Asks, r: &SetEntityStateRequest) -> Result<(), SimulationResult> {
    let name = r.entity.clone();
    let entity = look(asks, move |w| named(w.model(), &name)).await?;
    let frame = &r.state.header.frame_id;
    if !(frame.is_empty() || frame == WORLD) {
        let reason = format!("header.frame_id is '{frame}'; states are set in the frame '{WORLD}' (or leave it empty)");
        return Err(SimulationResult::failed(reason));
    }
    let pose = numbers(&r.state.pose);
    checked_pose(&pose).map_err(|reason| SimulationResult::because(SetEntityStateRequest::INVALID_POSE, reason))?;
    let cannot = |reason: String| Err(SimulationResult::failed(reason));
    if !entity.is_whole() {
        return cannot(format!("'{}' is a link: set the state of its robot, or use set_joint_angles", r.entity));
    }
    let Some(link) = entity.link() else { return cannot(format!("'{}' never moves", r.entity)) };
    let Twist { linear: v, angular: w } = r.state.twist;
    let order = Order::Place { link, pose, twist: [w.x, w.y, w.z, v.x, v.y, v.z] };
    let why = |reason: String| SimulationResult::failed(format!("'{}' ({}): {reason}", r.entity, entity.description));
    asks.order(order).await.map_err(why)
}

/// Takes an entity, or a link with all that hangs on it, out of the world (W-11).
async fn delete(asks: &Asks, name: String) -> Result<(), SimulationResult> {
    let asked = name.clone();
    look(asks, move |w| named(w.model(), &asked)).await?;
    asks.order(Order::Remove { name }).await.map_err(SimulationResult::failed)
}

fn numbers(pose: &PoseMessage) -> [f64; 7] {
    let (p, q) = (pose.position, pose.orientation);
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
}
