//! What ROS asks of the world: done by the control thread between two steps, answered when it is done.

use crate::world::{Order, World};
use crossbeam_queue::ArrayQueue;
use futures::channel::oneshot;
use std::sync::{Arc, OnceLock};
use std::thread::{self, Thread};

/// Questions that may wait at once.
const CAPACITY: usize = 64;

/// Where the answer goes.
pub type Reply<T> = oneshot::Sender<Result<T, String>>;

/// Something asked.
pub enum Ask {
    /// Do this.
    Order(Arc<Order>, Reply<()>),
    /// Let somebody look at the world.
    Look(Box<dyn FnOnce(&World) + Send>),
    /// Make this many control intervals while time stands; the answer is the stamp after them, ns.
    Steps(u64, Reply<i64>),
}

/// Questions on their way.
pub struct Asks {
    queue: ArrayQueue<Ask>,
    server: OnceLock<Thread>,
}

impl Default for Asks {
    fn default() -> Self {
        Self { queue: ArrayQueue::new(CAPACITY), server: OnceLock::new() }
    }
}

impl Asks {
    /// Called by the thread that answers.
    pub fn serve(&self) {
        let _ = self.server.set(thread::current());
    }

    /// Wakes the thread that answers, if it does not sleep until a deadline.
    pub fn wake(&self) {
        if let Some(server) = self.server.get() {
            server.unpark();
        }
    }

    /// Does anything wait?
    pub fn waiting(&self) -> bool {
        !self.queue.is_empty()
    }

    /// The oldest question.
    pub fn next(&self) -> Option<Ask> {
        self.queue.pop()
    }

    /// Has `order` done.
    ///
    /// # Errors
    /// Why it was not done; nothing has changed then.
    pub async fn order(&self, order: Order) -> Result<(), String> {
        let (reply, answer) = oneshot::channel();
        self.ask(Ask::Order(Arc::new(order), reply))?;
        answer.await.unwrap_or_else(|_| Err(ended()))
    }

    /// Has `count` control intervals made; time must stand. Returns the stamp after them, ns.
    ///
    /// # Errors
    /// Why they were not made.
    pub async fn steps(&self, count: u64) -> Result<i64, String> {
        let (reply, answer) = oneshot::channel();
        self.ask(Ask::Steps(count, reply))?;
        answer.await.unwrap_or_else(|_| Err(ended()))
    }

    /// What `look` sees of the world between two steps.
    ///
    /// # Errors
    /// The loop has ended.
    pub async fn look<T: Send + 'static>(&self, look: impl FnOnce(&World) -> T + Send + 'static) -> Result<T, String> {
        let (reply, answer) = oneshot::channel();
        let look = move |world: &World| {
            let _ = reply.send(look(world));
        };
        self.ask(Ask::Look(Box::new(look)))?;
        answer.await.map_err(|_| ended())
    }

    fn ask(&self, ask: Ask) -> Result<(), String> {
        self.queue.push(ask).map_err(|_| format!("{CAPACITY} requests wait already: try again"))?;
        self.wake();
        Ok(())
    }
}

fn ended() -> String {
    "the simulation has ended".into()
}
