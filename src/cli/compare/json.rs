//! The comparison for programs.

use super::contender::{Contender, Course};
use super::difference::{MEASURES, Worst, exists, name_of};
use super::{Contest, FINER, notes};
use serde_json::{Map, Value, json};

/// Names of the [`MEASURES`] as keys.
const KEYS: [&str; MEASURES.len()] = ["axes", "positions", "orientations"];

/// Everything, SI units.
pub(super) fn summary(c: &Contest) -> Value {
    let s = &c.settings;
    json!({
        "robot": c.model.name,
        "seconds": c.time(),
        "control_interval": s.control_interval_ns as f64 * 1e-9,
        "steps_per_interval": s.steps_per_interval,
        "within": c.within,
        "stopped": c.stopped,
        "times_finer": FINER,
        "floats": c.floats,
        "runs": c.all().map(|run| contender(c, run)).collect::<Vec<_>>(),
        "warnings": c.warnings,
    })
}

/// The first one is the reference, whose differences are absent.
fn contender(c: &Contest, run: &Contender) -> Value {
    let (stats, settings) = (run.world.stats(), run.world.settings());
    let is_reference = std::ptr::eq(run, &c.reference);
    let told = |s: crate::engine::Shortfall| json!({"element": s.element, "item": s.item, "instead": s.instead});
    let not_honoured: Vec<Value> = c.shortfalls(run).into_iter().map(told).collect();
    json!({
        "name": run.name,
        "engine": run.engine.name(),
        "integrator": run.engine.capabilities().integrators.then(|| settings.integrator.name()),
        "step": run.step(),
        "steps": stats.steps,
        "fallback_steps": stats.fallback_steps,
        "finite": run.finite,
        "cpu_seconds": run.cpu,
        "cpu_per_second": c.cpu(run),
        "worst_penetration": stats.worst_penetration,
        "worst_stop_violation": stats.worst_stop_violation,
        "joint_drift": run.world.joint_drift(),
        "energy": run.energy,
        "momentum": c.floats.then(|| momentum(run)),
        "differences": (!is_reference).then(|| differences(c, run)),
        "not_honoured": not_honoured,
        "notes": notes(&run.world),
        "axes": axes(c, run),
        "links": links(c, run),
    })
}

fn momentum(run: &Contender) -> Value {
    let m = &run.momentum;
    json!({"linear": m.linear.as_slice(), "angular": m.angular.as_slice()})
}

fn differences(c: &Contest, run: &Contender) -> Value {
    let mut all = Map::new();
    for (measure, key) in KEYS.iter().enumerate().filter(|(measure, _)| exists(&c.model, &c.links, *measure)) {
        let of = |w: Worst| json!({"value": w.value, "of": name_of(&c.model, measure, w.index)});
        let Course { last, greatest, greatest_at, beyond } = run.record.measures[measure];
        let beyond =
            beyond.map(|(at, w)| json!({"value": w.value, "of": name_of(&c.model, measure, w.index), "at": at}));
        let mut greatest = of(greatest);
        greatest["at"] = greatest_at.into();
        all.insert((*key).into(), json!({"final": of(last), "greatest": greatest, "beyond": beyond}));
    }
    let r = &run.record;
    all.insert("energy".into(), r.energy.into());
    if c.floats {
        all.insert("momentum".into(), json!({"linear": r.momentum, "angular": r.angular}));
    }
    all.into()
}

/// Positions at the end, rad or m.
fn axes(c: &Contest, run: &Contender) -> Map<String, Value> {
    c.model.axes.iter().zip(&run.snapshot.position).map(|(a, x)| (a.name.clone(), json!(x))).collect()
}

/// Frames in the world at the end: x, y, z, qx, qy, qz, qw.
fn links(c: &Contest, run: &Contender) -> Map<String, Value> {
    let one = |link: &usize| {
        let pose = &run.snapshot.link_pose[*link];
        let numbers: Vec<f64> = pose.translation.vector.iter().chain(pose.rotation.coords.iter()).copied().collect();
        (c.model.links[*link].name.clone(), json!(numbers))
    };
    c.links.iter().map(one).collect()
}
