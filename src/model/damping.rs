//! Damping of bodies (B-8 I, J).

use super::{LinkFrame, Model};
use crate::description::Description;

/// How much of its velocity a body loses: v ← v·(1 − d)^dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyDamping {
    /// Index into [`Model::bodies`].
    pub body: usize,
    /// d of the velocity of the centre of mass, per second, 0 … 1.
    pub linear: f64,
    /// d of the angular velocity, per second, 0 … 1.
    pub angular: f64,
}

impl BodyDamping {
    /// What is left of the velocity of the centre of mass, and of the angular one, after h seconds: shares.
    pub fn kept(&self, h: f64) -> [f64; 2] {
        [self.linear, self.angular].map(|loss| libm::pow(1.0 - loss, h))
    }
}

/// Of every moving body that is damped. Of links joined by fixed joints the one with mass that is nearest the root counts
/// (J-6).
pub(super) fn dampings(d: &Description, m: &Model) -> Vec<BodyDamping> {
    let depth = |link: usize| std::iter::successors(Some(link), |l| m.links[*l].parent).count();
    let of_body = |body: usize| {
        let on = |link: &usize| matches!(m.links[*link].frame, LinkFrame::OnBody { body: b, .. } if b == body);
        let nearest = (0..m.links.len()).filter(on).filter(|l| m.links[*l].mass > 0.0).min_by_key(|l| depth(*l))?;
        let damping = d.links[nearest].damping.as_ref().filter(|d| d.linear > 0.0 || d.angular > 0.0)?;
        Some(BodyDamping { body, linear: damping.linear, angular: damping.angular })
    };
    (1..m.bodies.len()).filter_map(of_body).collect()
}
