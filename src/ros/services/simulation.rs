//! simulation_interfaces: what the simulation can do, its state, reset, single steps.

use super::Office;
use crate::ros::messages::EmptyRequest;
use crate::ros::messages::simulation::{
    FeaturesReply, ResetRequest, ResultReply, SetStateRequest, SimulationResult, SimulationState, SimulatorFeatures,
    StateReply, StepRequest,
};
use crate::ros::service::Service;
use crate::ros::topics::Topics;
use crate::world::Order;
use ros2_client::ParameterValue;
use std::cell::Cell;
use std::time::Duration;

/// Time for the last answer to reach whoever ended the node.
const LAST_WORDS: Duration = Duration::from_millis(100);

/// Bits of a reset.
const TIME: u8 = 1;
const STATE: u8 = 2;
const SPAWNED: u8 = 4;
const ALL: u8 = 255;

/// Numbers of the features in simulation_interfaces/SimulatorFeatures: deleting; categories; state and info of entities; reset, of time, of the
/// state; getting and setting the state of the simulation, pause; one step, several.
const FEATURES: [u16; 13] = [1, 8, 10, 11, 12, 20, 21, 22, 24, 25, 26, 31, 32];

/// `get_simulator_features`, `get_simulation_state`, `set_simulation_state`, `reset_simulation`, `step_simulation`.
pub struct SimulationServices {
    features: Service<EmptyRequest, FeaturesReply>,
    get_state: Service<EmptyRequest, StateReply>,
    set_state: Service<SetStateRequest, ResultReply>,
    reset: Service<ResetRequest, ResultReply>,
    step: Service<StepRequest, ResultReply>,
    quitting: Cell<bool>,
}

impl SimulationServices {
    /// Creates the servers.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics) -> Result<Self, String> {
        Ok(Self {
            features: topics.service("get_simulator_features", "simulation_interfaces/GetSimulatorFeatures")?,
            get_state: topics.service("get_simulation_state", "simulation_interfaces/GetSimulationState")?,
            set_state: topics.service("set_simulation_state", "simulation_interfaces/SetSimulationState")?,
            reset: topics.service("reset_simulation", "simulation_interfaces/ResetSimulation")?,
            step: topics.service("step_simulation", "simulation_interfaces/StepSimulation")?,
            quitting: Cell::new(false),
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, office: &Office<'_>) {
        let quit = async || {
            if self.quitting.get() {
                smol::Timer::after(LAST_WORDS).await;
                office.quit.now();
            }
        };
        futures::join!(
            self.features.serve(async |_| FeaturesReply { features: features() }),
            self.get_state.serve(async |_| StateReply { state: self.state(office), result: SimulationResult::ok() }),
            self.set_state.serve_then(async |r: SetStateRequest| self.go_to(office, r.state).await.into(), quit),
            self.reset.serve(async |r: ResetRequest| reset(office, r.scope).await.into()),
            self.step.serve(async |r: StepRequest| self.step(office, r.steps).await.into()),
        );
    }

    fn state(&self, office: &Office) -> SimulationState {
        let paused = office.setter.values.borrow().pace().paused;
        match (self.quitting.get(), paused, office.live.stopped()) {
            (true, ..) => SimulationState::QUITTING,
            (_, false, _) => SimulationState::PLAYING,
            (_, true, true) => SimulationState::STOPPED,
            (_, true, false) => SimulationState::PAUSED,
        }
    }

    async fn go_to(&self, office: &Office<'_>, wanted: SimulationState) -> SimulationResult {
        let present = self.state(office);
        let pause = |paused: bool| office.setter.set("paused", ParameterValue::Boolean(paused));
        let done = match wanted {
            _ if wanted == present => {
                let reason = format!("the simulation is {} already", present.name());
                return SimulationResult::because(SetStateRequest::ALREADY_IN_TARGET_STATE, reason);
            }
            SimulationState::QUITTING => {
                self.quitting.set(true);
                Ok(())
            }
            SimulationState::PLAYING => pause(false),
            SimulationState::PAUSED => pause(true).map(|()| office.live.set_stopped(false)),
            SimulationState::STOPPED => match pause(true) {
                Ok(()) => everything_to_its_start(office).await.map(|()| office.live.set_stopped(true)),
                Err(reason) => Err(reason),
            },
            _ => {
                let reason = format!(
                    "there is no way from {} to {} (state {}): this simulator has one world, from start to end",
                    present.name(),
                    wanted.name(),
                    wanted.state
                );
                return SimulationResult::because(SetStateRequest::INCORRECT_TRANSITION, reason);
            }
        };
        match done {
            Ok(()) => SimulationResult::ok(),
            Err(reason) => SimulationResult::because(SetStateRequest::STATE_TRANSITION_ERROR, reason),
        }
    }

    async fn step(&self, office: &Office<'_>, steps: u64) -> SimulationResult {
        if steps == 0 {
            return SimulationResult::failed("0 steps: give at least 1");
        }
        if self.state(office) == SimulationState::STOPPED {
            return SimulationResult::failed("the simulation is STOPPED: set it to PAUSED first");
        }
        office.asks.steps(steps).await.map(drop).into()
    }
}

fn features() -> SimulatorFeatures {
    let custom_info = "realnoid: a step is one control interval. Entities are robots and bodies; links are listed where the category \
         OBJECT is asked for, and can be read only. States are in the frame 'world'; accelerations are not computed: 0.";
    SimulatorFeatures { features: FEATURES.to_vec(), spawn_formats: vec![], custom_info: custom_info.into() }
}

async fn everything_to_its_start(office: &Office<'_>) -> Result<(), String> {
    bring_back(office).await?;
    let joints = office.setter.values.borrow().pace().reset_joints;
    office.asks.order(Order::Reset { time: true, state: true, joints }).await
}

/// What has been deleted comes back.
async fn bring_back(office: &Office<'_>) -> Result<(), String> {
    let deleted = office.asks.look(|world| world.model().links.iter().any(|l| l.removed)).await?;
    if deleted { office.asks.order(Order::Rebuild { all: true }).await } else { Ok(()) }
}

async fn reset(office: &Office<'_>, scope: u8) -> SimulationResult {
    let scope = match scope {
        0 | ALL => return everything_to_its_start(office).await.into(),
        _ if scope & !(TIME | STATE | SPAWNED) != 0 => {
            let reason = format!("scope {scope} has unknown bits; there are TIME 1, STATE 2, SPAWNED 4, and ALL 255");
            return SimulationResult::failed(reason);
        }
        _ if scope & SPAWNED != 0 => {
            let reason =
                "nothing can be spawned, so nothing spawned can be reset: leave the bit SPAWNED out, or use ALL";
            return SimulationResult::because(SimulationResult::FEATURE_UNSUPPORTED, reason);
        }
        _ => scope,
    };
    let joints = office.setter.values.borrow().pace().reset_joints;
    let order = Order::Reset { time: scope & TIME != 0, state: scope & STATE != 0, joints };
    office.asks.order(order).await.into()
}
