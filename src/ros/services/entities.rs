//! What the entities of simulation_interfaces are here: robots, bodies of the scene, and links.

use crate::math::Pose;
use crate::model::{Base, Model};
use crate::ros::messages::simulation::{EntityCategory, EntityFilters, EntityInfo, EntityState, SimulationResult};
use crate::ros::messages::{Accel, Header, PoseMessage, Time, Twist};
use crate::ros::tf::WORLD;
use crate::world::Snapshot;
use regex::Regex;
use std::collections::HashSet;

/// Longest compiled filter, bytes.
const LARGEST_FILTER: usize = 1 << 20;

/// An entity.
#[derive(Clone, Debug)]
pub struct Entity {
    /// Unique.
    pub name: String,
    /// What it is.
    pub category: EntityCategory,
    /// For people.
    pub description: String,
    place: Place,
}

#[derive(Clone, Debug)]
enum Place {
    /// Index into `Model::links`.
    Link(usize),
    /// In the world; it never moves.
    Still(Pose),
}

impl Entity {
    /// Its (root) link; `None` if nothing of it can move.
    pub fn link(&self) -> Option<usize> {
        match self.place {
            Place::Link(link) => Some(link),
            Place::Still(_) => None,
        }
    }

    /// Can its pose be set, as far as its kind is concerned?
    pub fn is_whole(&self) -> bool {
        self.category != EntityCategory::OBJECT
    }

    /// What it is, as the standard tells it.
    pub fn info(&self) -> EntityInfo {
        EntityInfo { category: self.category, description: self.description.clone(), tags: vec![] }
    }

    /// Pose and twist in the world.
    pub fn state(&self, s: &Snapshot) -> EntityState {
        let (pose, twist) = match &self.place {
            Place::Still(pose) => (*pose, Twist::default()),
            Place::Link(link) => {
                let (x_wl, v_l) = (s.link_pose[*link], s.link_twist[*link]);
                let (linear, angular) = (x_wl.rotation * v_l.linear, x_wl.rotation * v_l.angular);
                (x_wl, Twist { linear: linear.into(), angular: angular.into() })
            }
        };
        let header = Header { stamp: Time::from_ns(s.stamp_ns), frame_id: WORLD.into() };
        EntityState { header, pose: PoseMessage::from(&pose), twist, acceleration: Accel::default() }
    }
}

/// All entities: robots and bodies, what stands still, then their parts, the links, by their frames' names. A name counts once.
pub fn entities(m: &Model) -> Vec<Entity> {
    let first = (m.name.as_str(), m.root_link, m.base, first_is_robot(m));
    let joined = m.joined.iter().map(|j| {
        let alone = j.links.len() == 1 && m.links.get(j.root_link).is_some_and(|l| l.name == j.name);
        (j.name.as_str(), j.root_link, j.base, !alone)
    });
    let mut all: Vec<Entity> = std::iter::once(first).chain(joined).map(whole).collect();
    all.extend(m.colliders.iter().filter(|c| c.link.is_none()).map(|c| Entity {
        name: c.name.clone(),
        category: EntityCategory::STATIC_OBJECT,
        description: "stands still in the world".into(),
        place: Place::Still(c.pose),
    }));
    all.extend(m.links.iter().enumerate().map(|(i, l)| Entity {
        name: l.name.clone(),
        category: EntityCategory::OBJECT,
        description: format!("link, {} kg", l.mass),
        place: Place::Link(i),
    }));
    let mut seen = HashSet::new();
    let there = |link: usize| m.links.get(link).is_some_and(|l| !l.removed);
    all.retain(|e| seen.insert(e.name.clone()) && e.link().is_none_or(there));
    all
}

/// The root of a scene without a robot is one link that stands still.
fn first_is_robot(m: &Model) -> bool {
    let links = m.joined.first().map_or(m.links.len(), |j| j.links.start);
    links > 1 || m.links.first().is_some_and(|l| l.name != m.name)
}

fn whole((name, root, base, robot): (&str, usize, Base, bool)) -> Entity {
    let (category, description) = match (robot, base) {
        (true, Base::Free) => (EntityCategory::ROBOT, "robot on a free base"),
        (true, Base::Fixed) => (EntityCategory::ROBOT, "robot on a fixed base"),
        (false, Base::Free) => (EntityCategory::DYNAMIC_OBJECT, "free body"),
        (false, Base::Fixed) => (EntityCategory::STATIC_OBJECT, "static body"),
    };
    Entity { name: name.into(), category, description: description.into(), place: Place::Link(root) }
}

/// The entities that pass the filters.
///
/// # Errors
/// Says which filter is not supported, or makes no sense.
pub fn selected(m: &Model, filters: &EntityFilters) -> Result<Vec<Entity>, SimulationResult> {
    let unsupported = |what: &str| SimulationResult::because(SimulationResult::FEATURE_UNSUPPORTED, what);
    if !filters.tags.tags.is_empty() {
        return Err(unsupported("entities have no tags here: leave the filter 'tags' empty"));
    }
    if filters.bounds.kind != 0 || !filters.bounds.points.is_empty() {
        return Err(unsupported("entities are not filtered by bounds here: leave the type of 'bounds' at TYPE_EMPTY"));
    }
    let bad = |e: regex::Error| {
        SimulationResult::failed(format!("filter '{}' is no regular expression: {e}", filters.filter))
    };
    let name = regex::RegexBuilder::new(&filters.filter).size_limit(LARGEST_FILTER).build().map_err(bad)?;
    Ok(passing(entities(m), &name, &filters.categories))
}

fn passing(all: Vec<Entity>, name: &Regex, categories: &[EntityCategory]) -> Vec<Entity> {
    // Parts only where they are asked for: whoever lists the world wants robots and bodies.
    let wanted = |e: &Entity| if categories.is_empty() { e.is_whole() } else { categories.contains(&e.category) };
    all.into_iter().filter(|e| wanted(e) && name.is_match(&e.name)).collect()
}

/// The entity of this name.
///
/// # Errors
/// There is none.
pub fn named(m: &Model, name: &str) -> Result<Entity, SimulationResult> {
    let reason = || format!("there is no entity '{name}' (get_entities lists them)");
    let found = entities(m).into_iter().find(|e| e.name == name);
    found.ok_or_else(|| SimulationResult::because(SimulationResult::NOT_FOUND, reason()))
}
