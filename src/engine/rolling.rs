//! Rolling and spinning friction (B-8 G, H) for engines that have none: torque impulses after a step.

use crate::math::V3;
use crate::model::Model;
use crate::solver::ContactPoint;

/// Bodies, by their index in [`Model::bodies`], that impulses turn. What stands still, or sleeps, neither turns nor can be turned.
pub(super) trait Turning {
    /// Angular velocity in the world, rad/s.
    fn spin(&self, body: usize) -> V3<f64>;

    /// Answer to a torque about a unit vector of the world, 1/(kg·m²).
    fn mobility(&self, body: usize, about: V3<f64>) -> f64;

    /// Turns it by an impulse of the world, N·m·s.
    fn turn(&mut self, body: usize, impulse: V3<f64>);
}

/// Lets the friction of a contact turn its bodies after `h` seconds in which it gave its force: bounded by coefficient × normal force, and
/// by what brings the turning to rest. Returns the energy taken, J; `None` if its surfaces have no such friction.
pub(super) fn roll(m: &Model, p: &ContactPoint, h: f64, bodies: &mut impl Turning) -> Option<f64> {
    let [a, b] = p.colliders.map(|c| &m.colliders[c]);
    let surface = a.surface.with(&b.surface);
    if surface.rolling <= 0.0 && surface.spinning <= 0.0 {
        return None;
    }
    let sides = [a, b].map(|c| m.seat_of(c).0);
    let pressed = h * p.force.dot(p.normal);
    let turn = bodies.spin(sides[1]) - bodies.spin(sides[0]);
    let about = p.normal * turn.dot(p.normal);
    let both = [(turn - about, surface.rolling), (about, surface.spinning)];
    Some(both.into_iter().map(|(turn, bound)| brake(bodies, sides, turn, bound * pressed)).sum())
}

/// Takes from the turn of the second body against the first, by at most an impulse of `bound` N·m·s; returns the energy taken, J.
fn brake(bodies: &mut impl Turning, sides: [usize; 2], turn: V3<f64>, bound: f64) -> f64 {
    let rate = turn.dot(turn).sqrt();
    if rate <= 0.0 || bound <= 0.0 {
        return 0.0;
    }
    let about = turn * (1.0 / rate);
    let mobility = bodies.mobility(sides[0], about) + bodies.mobility(sides[1], about);
    if mobility <= 0.0 {
        return 0.0;
    }
    let impulse = (rate / mobility).min(bound);
    bodies.turn(sides[0], about * impulse);
    bodies.turn(sides[1], about * -impulse);
    impulse * (rate - 0.5 * impulse * mobility)
}
