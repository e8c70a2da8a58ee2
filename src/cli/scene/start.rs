//! Where a robot starts.

use crate::contact::{Detector, OVERLAP};
use crate::dynamics::{Kinematics, kinematics};
use crate::engine::State;
use crate::math::{Pose, V3, Vec3};
use crate::model::{Base, Model};

/// How a robot starts.
#[derive(Clone, Debug)]
pub struct Start<'a> {
    /// Root link of a free base in the world.
    pub pose: Pose,
    /// Of a free base, in the base frame: angular (rad/s), then linear (m/s).
    pub twist: Option<[f64; 6]>,
    /// Positions of axes (rad or m) by name.
    pub set: &'a [(&'a str, f64)],
}

impl Start<'_> {
    /// The state of a model that is not joined with others yet.
    ///
    /// # Errors
    /// Says which axis or twist makes no sense.
    pub fn state(&self, m: &Model) -> Result<State, String> {
        let mut s = State::initial(m);
        let (p, q) = (self.pose.translation, self.pose.rotation.coords);
        s.set_base_pose(m, [p.x, p.y, p.z], [q.x, q.y, q.z, q.w]);
        if let Some(t) = self.twist {
            if m.base == Base::Fixed {
                return Err("twist: needs base: free".into());
            }
            s.set_base_twist(m, Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
        }
        let mut given = vec![];
        for (name, position) in self.set {
            let axis = crate::cli::commands::axis(m, "set", name)?;
            s.set_axis(m, axis, *position, 0.0);
            given.push(axis);
        }
        couple(m, &mut s, &given).map_err(|reason| format!("set: {reason}"))?;
        Ok(s)
    }
}

/// Puts the axes that are coupled to those given where these say.
///
/// # Errors
/// Says what contradicts, or which coupled axis would be outside its range.
pub fn couple(m: &Model, s: &mut State, given: &[usize]) -> Result<(), String> {
    s.couple_given(m, given)?;
    let coupled = |axis: usize| m.couplings_in_force().iter().any(|c| c.leader == axis || c.follower == axis);
    let refused = outside(m, s).find(|(axis, _)| coupled(*axis));
    match refused {
        Some((_, said)) => Err(format!("{said}; it is coupled to another axis, so it must start inside")),
        None => Ok(()),
    }
}

/// Axes that start outside their range.
pub fn outside<'a>(m: &'a Model, s: &'a State) -> impl Iterator<Item = (usize, String)> + 'a {
    m.axes.iter().enumerate().filter(|_| m.effects.limits).filter_map(|(i, a)| {
        let (q, _) = s.axis(m, i);
        let slack = 1e-12 * (1.0 + q.abs());
        (q < a.lower - slack || q > a.upper + slack)
            .then(|| (i, format!("axis '{}' starts at {q}, outside its range {} to {}", a.name, a.lower, a.upper)))
    })
}

/// At most so many pairs are told one by one.
const TOLD: usize = 5;

/// What starts inside something else, by more than [`OVERLAP`].
pub fn inside(m: &Model, s: &State) -> Vec<String> {
    let Some(mut detector) = Detector::new(m).filter(|_| m.effects.contact) else { return vec![] };
    let mut k = Kinematics::new(m);
    kinematics(m, &mut k, &s.q, &s.v);
    // Where things are, not where they go.
    k.v.iter_mut().chain(&mut k.w).for_each(|v| *v = V3::default());
    let mut touches = vec![];
    detector.find(&k, 0.0, &mut touches);
    let mut pairs: Vec<([usize; 2], f64)> = vec![];
    for (pair, depth) in touches.iter().map(|t| (t.pair.map(|c| c as usize), -t.placed(&k).gap)) {
        match pairs.last_mut() {
            _ if depth <= OVERLAP => {}
            Some((known, most)) if *known == pair => *most = most.max(depth),
            _ => pairs.push((pair, depth)),
        }
    }
    pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
    let name = |c: usize| &m.colliders[c].name;
    let one = |([a, b], depth): &([usize; 2], f64)| {
        format!(
            "'{}' and '{}' start {:.3} mm inside each other: they come apart only as far as their motion pays for it; place \
             them apart",
            name(*a),
            name(*b),
            1e3 * depth
        )
    };
    let more = pairs.len().saturating_sub(TOLD);
    let rest = (more > 0).then(|| format!("{more} more pairs of shapes start inside each other, by less"));
    pairs.iter().take(TOLD).map(one).chain(rest).collect()
}
