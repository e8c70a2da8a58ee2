//! `simulate --estimate-error`: what a run is off by, and what it costs to know.

use super::bench::cpu_seconds;
use super::script::Script;
use crate::world::{Deviation, Largest, LocalEstimate, World};
use serde_json::{Value, json};

/// The run beside the run.
pub(super) struct Estimate {
    local: LocalEstimate,
    /// Goes on by itself from the start, with finer steps.
    finer: World,
    script: Script,
    worst_local: Deviation,
    most: Deviation,
    end: Deviation,
    /// s.
    cpu: f64,
}

impl Estimate {
    pub fn new(world: &World, script: &Script) -> Self {
        let zero = Deviation::default();
        Self {
            local: LocalEstimate::default(),
            finer: world.finer(),
            script: script.clone(),
            worst_local: zero,
            most: zero,
            end: zero,
            cpu: 0.0,
        }
    }

    /// Before an interval, when the script has told the world what is due.
    pub fn begin(&mut self, interval: u64, world: &World) {
        let start = cpu_seconds();
        self.local.begin(world);
        self.script.apply(interval, &mut self.finer);
        self.cpu += cpu_seconds() - start;
    }

    /// After it.
    pub fn end(&mut self, world: &World) {
        let start = cpu_seconds();
        self.worst_local.widen(&self.local.end(world));
        self.finer.advance();
        self.end = world.error_by(&self.finer);
        self.most.widen(&self.end);
        self.cpu += cpu_seconds() - start;
    }

    pub fn told(&self, world: &World) -> Value {
        let m = world.model();
        let one = |l: &Largest| json!({"size": finite(l.size), "of": l.name(m)});
        let both = |d: &Deviation| json!({"position": one(&d.position), "speed": one(&d.speed)});
        json!({
            "order": world.order(),
            "worst_interval": both(&self.worst_local),
            "at_end": both(&self.end),
            "at_most": both(&self.most),
            "cpu_seconds": self.cpu,
        })
    }
}

/// JSON has no infinity: `null` says that the two runs cannot be compared.
fn finite(x: f64) -> Option<f64> {
    Some(x).filter(|x| x.is_finite())
}
