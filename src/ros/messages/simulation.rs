//! simulation_interfaces 1.5, the release of Jazzy.

use super::geometry::{Accel, PoseMessage, Twist, Vector3};
use super::standard::Header;
use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// simulation_interfaces/Result.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SimulationResult {
    /// One of the constants below, or one of the service.
    pub result: u8,
    /// Why not.
    pub error_message: String,
}

impl SimulationResult {
    /// Not supported.
    pub const FEATURE_UNSUPPORTED: u8 = 0;
    /// Done.
    pub const OK: u8 = 1;
    /// There is no such entity.
    pub const NOT_FOUND: u8 = 2;
    /// Failed; nothing has changed.
    pub const OPERATION_FAILED: u8 = 4;

    /// Done.
    pub fn ok() -> Self {
        Self::because(Self::OK, "")
    }

    /// Failed.
    pub fn failed(reason: impl Into<String>) -> Self {
        Self::because(Self::OPERATION_FAILED, reason)
    }

    /// With a code and the reason.
    pub fn because(result: u8, reason: impl Into<String>) -> Self {
        Self { result, error_message: reason.into() }
    }
}

impl From<Result<(), String>> for SimulationResult {
    fn from(result: Result<(), String>) -> Self {
        result.map_or_else(Self::failed, |()| Self::ok())
    }
}

/// simulation_interfaces/EntityCategory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EntityCategory {
    /// One of the constants.
    pub category: u8,
}

impl EntityCategory {
    /// Anything.
    pub const OBJECT: Self = Self { category: 0 };
    /// A robot.
    pub const ROBOT: Self = Self { category: 1 };
    /// A body that moves.
    pub const DYNAMIC_OBJECT: Self = Self { category: 4 };
    /// A body that never moves.
    pub const STATIC_OBJECT: Self = Self { category: 5 };
}

/// simulation_interfaces/Bounds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// 0: none.
    pub kind: u8,
    /// m; what they mean depends on the type.
    pub points: Vec<Vector3>,
}

/// simulation_interfaces/TagsFilter.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TagsFilter {
    /// Tags.
    pub tags: Vec<String>,
    /// Any or all of them.
    pub filter_mode: u8,
}

/// simulation_interfaces/EntityFilters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EntityFilters {
    /// A regular expression; empty: all.
    pub filter: String,
    /// Any of these; none: all.
    pub categories: Vec<EntityCategory>,
    /// None: all.
    pub tags: TagsFilter,
    /// Empty: all.
    pub bounds: Bounds,
}

/// simulation_interfaces/EntityInfo.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EntityInfo {
    /// What it is.
    pub category: EntityCategory,
    /// For people.
    pub description: String,
    /// None here.
    pub tags: Vec<String>,
}

/// simulation_interfaces/EntityState.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntityState {
    /// Stamp, and frame of everything below.
    pub header: Header,
    /// Of the entity's frame.
    pub pose: PoseMessage,
    /// Of the frame's origin, along the axes of `header.frame_id`.
    pub twist: Twist,
    /// Not computed: zeros.
    pub acceleration: Accel,
}

/// simulation_interfaces/SimulationState.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SimulationState {
    /// One of the constants.
    pub state: u8,
}

impl SimulationState {
    /// Paused, and everything is at its start.
    pub const STOPPED: Self = Self { state: 0 };
    /// Time goes on.
    pub const PLAYING: Self = Self { state: 1 };
    /// Time stands.
    pub const PAUSED: Self = Self { state: 2 };
    /// The node ends.
    pub const QUITTING: Self = Self { state: 3 };

    /// Its name in the standard.
    pub fn name(self) -> &'static str {
        match self.state {
            0 => "STOPPED",
            1 => "PLAYING",
            2 => "PAUSED",
            3 => "QUITTING",
            4 => "NO_WORLD",
            5 => "LOADING_WORLD",
            _ => "unknown",
        }
    }
}

/// simulation_interfaces/SimulatorFeatures.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SimulatorFeatures {
    /// Constants of the message.
    pub features: Vec<u16>,
    /// None here.
    pub spawn_formats: Vec<String>,
    /// For people.
    pub custom_info: String,
}

/// srv/GetSimulatorFeatures, the reply.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FeaturesReply {
    /// What is really there.
    pub features: SimulatorFeatures,
}

/// srv/GetSimulationState, the reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StateReply {
    /// At present.
    pub state: SimulationState,
    /// Always OK.
    pub result: SimulationResult,
}

/// srv/SetSimulationState, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SetStateRequest {
    /// Wanted.
    pub state: SimulationState,
}

impl SetStateRequest {
    /// Nothing was to be done.
    pub const ALREADY_IN_TARGET_STATE: u8 = 101;
    /// It failed.
    pub const STATE_TRANSITION_ERROR: u8 = 102;
    /// There is no way there.
    pub const INCORRECT_TRANSITION: u8 = 103;
}

/// The reply of every service that answers with nothing but a result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResultReply {
    /// How it went.
    pub result: SimulationResult,
}

impl From<SimulationResult> for ResultReply {
    fn from(result: SimulationResult) -> Self {
        Self { result }
    }
}

/// srv/ResetSimulation, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResetRequest {
    /// Bits: time 1, state 2, spawned 4; 0 and 255: all.
    pub scope: u8,
}

/// srv/StepSimulation, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StepRequest {
    /// Control intervals.
    pub steps: u64,
}

/// srv/GetEntities and srv/GetEntitiesStates, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntitiesRequest {
    /// Which.
    pub filters: EntityFilters,
}

/// srv/GetEntities, the reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntitiesReply {
    /// How it went.
    pub result: SimulationResult,
    /// Names.
    pub entities: Vec<String>,
}

/// srv/GetEntitiesStates, the reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntitiesStatesReply {
    /// How it went.
    pub result: SimulationResult,
    /// Names.
    pub entities: Vec<String>,
    /// In the same order.
    pub states: Vec<EntityState>,
}

/// srv/GetEntityState and srv/GetEntityInfo, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntityRequest {
    /// Name.
    pub entity: String,
}

/// srv/GetEntityState, the reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntityStateReply {
    /// How it went.
    pub result: SimulationResult,
    /// At present.
    pub state: EntityState,
}

/// srv/GetEntityInfo, the reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EntityInfoReply {
    /// How it went.
    pub result: SimulationResult,
    /// What it is.
    pub info: EntityInfo,
}

/// srv/SetEntityState, the request.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SetEntityStateRequest {
    /// Name.
    pub entity: String,
    /// Wanted; the stamp and the acceleration do not count.
    pub state: EntityState,
}

impl SetEntityStateRequest {
    /// The pose is no pose.
    pub const INVALID_POSE: u8 = 101;
}

impl Message for FeaturesReply {}
impl Message for StateReply {}
impl Message for SetStateRequest {}
impl Message for ResultReply {}
impl Message for ResetRequest {}
impl Message for StepRequest {}
impl Message for EntitiesRequest {}
impl Message for EntitiesReply {}
impl Message for EntitiesStatesReply {}
impl Message for EntityRequest {}
impl Message for EntityStateReply {}
impl Message for EntityInfoReply {}
impl Message for SetEntityStateRequest {}
