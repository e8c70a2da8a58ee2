//! What a bag needs beside messages so that the run can be made again: `axis_commands`, `world_events` and `state_digest`.

use super::recording::Tape;
use crate::model::Model;
use crate::record::messages::Header;
use crate::record::story::{
    AxisCommands, Beginning, LOST, Lost, Origin, Program, SETTINGS, START, WorldEvent, digest, header, same_commands,
    state_digest,
};
use crate::world::{AxisCommand, Settings, Snapshot};
use serde::Serialize;
use std::collections::BTreeMap;

/// std_msgs/UInt64.
#[derive(Serialize)]
struct Number {
    data: u64,
}

/// Tells every recording what is done to the world. The publishing thread owns it.
pub struct Chronicle {
    tape: Tape,
    commands: usize,
    events: usize,
    digests: usize,
    /// The recording that was told last.
    session: u64,
    /// Told last in this recording.
    settings: Option<Settings>,
    /// Told last in this recording.
    in_force: Option<Vec<AxisCommand>>,
    lost: Lost,
    /// Snapshots dropped before this recording.
    dropped_before: u64,
    first: Option<Settings>,
    /// Nothing has happened yet but the start.
    untouched: bool,
    parameters: BTreeMap<String, String>,
}

impl Chronicle {
    /// Topics under the names that `resolve` makes of relative ones; `parameters` are those at the start.
    ///
    /// # Errors
    /// A name that is none.
    pub fn new(
        tape: &Tape,
        resolve: impl Fn(&str) -> Result<String, String>,
        parameters: BTreeMap<String, String>,
    ) -> Result<Self, String> {
        let track =
            |relative: &str, kind: &str| Ok::<_, String>(tape.track(&resolve(relative)?, relative, kind, false));
        Ok(Self {
            tape: tape.clone(),
            commands: track("axis_commands", "realnoid/AxisCommands")?,
            events: track("world_events", "realnoid/WorldEvent")?,
            digests: track("state_digest", "std_msgs/UInt64")?,
            session: 0,
            settings: None,
            in_force: None,
            lost: Lost::default(),
            dropped_before: 0,
            first: None,
            untouched: true,
            parameters,
        })
    }

    /// Tells of a state before its messages are published; `dropped` states were never seen so far. True if it is the first one of
    /// a recording.
    pub fn tell(&mut self, s: &Snapshot, dropped: u64, (model, origin): (&Model, &Origin)) -> bool {
        let first = *self.first.get_or_insert(s.settings);
        let same_engine = (first.engine, first.integrator) == (s.settings.engine, s.settings.integrator);
        // What is told of this state leads to it from the start.
        let from_start = self.untouched && s.interval <= 1;
        self.untouched &= s.interval == 0 && s.cause.is_none() && same_engine && dropped == 0;
        if !self.tape.runs() {
            return false;
        }
        let new = self.session != self.tape.begun();
        if new {
            self.begin(s, from_start, (model, origin));
            self.dropped_before = dropped;
        }
        self.tell_losses(s, dropped);
        if self.settings != Some(s.settings) && self.event(s, SETTINGS, &s.settings) {
            self.settings = Some(s.settings);
        }
        if let Some(order) = &s.cause {
            self.event(s, order.name(), &**order);
        }
        self.tell_commands(s);
        self.tape.note(self.digests, &Number { data: state_digest(s) });
        new
    }

    fn begin(&mut self, s: &Snapshot, from_start: bool, (model, origin): (&Model, &Origin)) {
        self.session = self.tape.begun();
        (self.settings, self.in_force, self.lost) = (None, None, Lost::default());
        let beginning = Beginning {
            program: Program::this(),
            origin: origin.clone(),
            model: digest(model),
            from_start,
            parameters: self.parameters.clone(),
        };
        self.event(s, START, &beginning);
    }

    fn tell_losses(&mut self, s: &Snapshot, dropped: u64) {
        let lost = Lost { messages: self.tape.lost(), snapshots: dropped - self.dropped_before };
        if lost != self.lost && self.event(s, LOST, &lost) {
            self.lost = lost;
        }
    }

    fn tell_commands(&mut self, s: &Snapshot) {
        let same = self.in_force.as_ref().is_some_and(|c| same_commands(c, &s.commands));
        let told: &[AxisCommand] = if same { &[] } else { &s.commands };
        let message: AxisCommands<Header> = AxisCommands::new(header(s.stamp_ns), s.interval, told);
        if self.tape.note(self.commands, &message) && !same {
            self.in_force = Some(s.commands.clone());
        }
    }

    fn event(&self, s: &Snapshot, kind: &str, data: &impl Serialize) -> bool {
        let Ok(data) = serde_json::to_string(data) else { return false };
        let event = WorldEvent { header: header(s.stamp_ns), interval: s.interval, kind, data: data.as_str() };
        self.tape.note(self.events, &event)
    }
}
