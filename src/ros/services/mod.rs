//! The services of the node, but for those of its parameters.

mod elements;
mod entities;
mod entity;
mod pose;
mod record;
mod simulation;

use super::asks::Asks;
use super::listen::{Live, Quit};
use super::parameters::Setter;
use super::recording::Tape;
use super::topics::Topics;
use elements::ElementServices;
use entity::EntityServices;
use pose::PoseServices;
use record::RecordService;
use simulation::SimulationServices;

/// What services work with.
#[derive(Clone, Copy)]
pub struct Office<'a> {
    /// To ask something of the world.
    pub asks: &'a Asks,
    /// To read and to set parameters.
    pub setter: Setter<'a>,
    /// What all threads of the node see.
    pub live: &'a Live,
    /// To end the node.
    pub quit: &'a Quit,
}

/// All services.
pub struct Services {
    elements: ElementServices,
    pose: PoseServices,
    record: RecordService,
    simulation: SimulationServices,
    entities: EntityServices,
}

impl Services {
    /// Creates the servers.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics, tape: &Tape) -> Result<Self, String> {
        Ok(Self {
            elements: ElementServices::new(topics)?,
            pose: PoseServices::new(topics)?,
            record: RecordService::new(topics, tape)?,
            simulation: SimulationServices::new(topics)?,
            entities: EntityServices::new(topics)?,
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, office: &Office<'_>) {
        futures::join!(
            self.elements.serve(office.asks),
            self.pose.serve(office),
            self.record.serve(),
            self.simulation.serve(office),
            self.entities.serve(office)
        );
    }
}
