//! What the world consists of, what it warns of, and building it again.

use crate::ros::asks::Asks;
use crate::ros::messages::{EmptyRequest, ListElementsResponse, TriggerResponse, WarningsResponse};
use crate::ros::service::Service;
use crate::ros::topics::Topics;
use crate::world::{Condition, Order, World};

/// `list_elements`, `warnings`, `rebuild`.
pub struct ElementServices {
    list: Service<EmptyRequest, ListElementsResponse>,
    warnings: Service<EmptyRequest, WarningsResponse>,
    rebuild: Service<EmptyRequest, TriggerResponse>,
}

impl ElementServices {
    /// Creates the servers.
    ///
    /// # Errors
    /// Names the one that cannot be created.
    pub fn new(topics: &mut Topics) -> Result<Self, String> {
        Ok(Self {
            list: topics.service("list_elements", "realnoid/ListElements")?,
            warnings: topics.service("warnings", "realnoid/Warnings")?,
            rebuild: topics.service("rebuild", "std_srvs/Trigger")?,
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, asks: &Asks) {
        // A world that has ended has nothing to list.
        let list = self.list.serve(async |_| {
            // The list is made of a copy, so that the control loop does not wait for it.
            let copy = asks.look(|world| (world.clone(), world.condition())).await;
            copy.map_or_else(|_| ListElementsResponse::default(), |(world, condition)| listed(&world, condition))
        });
        let warnings = self.warnings.serve(async |_| asks.look(warned).await.unwrap_or_default());
        let rebuild = self.rebuild.serve(async |_| asks.order(Order::Rebuild { all: false }).await.into());
        futures::join!(list, warnings, rebuild);
    }
}

fn listed(world: &World, condition: Condition) -> ListElementsResponse {
    ListElementsResponse {
        engine: world.settings().engine.name().into(),
        state: condition.name().into(),
        elements: world.elements().into_iter().map(Into::into).collect(),
    }
}

fn warned(world: &World) -> WarningsResponse {
    let warnings = world.warnings();
    WarningsResponse { warnings: warnings.iter().map(Into::into).collect(), omitted: warnings.omitted }
}
