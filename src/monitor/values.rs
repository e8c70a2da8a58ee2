//! What links weigh, as it is shown (B-10, J-19).

use crate::mass::{LinkBody, MassProperties};
use crate::math::{Mat3, Pose, Vec3};
use crate::model::{LinkFrame, Membership, Model};

/// The values of one link.
#[derive(Clone, Debug)]
pub struct LinkValues {
    /// Name of the URDF link in whose frame the values are.
    pub frame: String,
    /// What moves it; `None`: the base.
    pub membership: Option<Membership>,
    /// URDF links that make it up, those without mass left out.
    pub members: Vec<String>,
    /// All URDF links of it, index and frame in the frame of `frame`: where collision shapes stand (J-8).
    pub seats: Vec<(usize, Pose)>,
    /// Of the material, m³; `None` if some mass is only stated.
    pub volume: Option<f64>,
    /// In the frame of `frame`.
    pub properties: MassProperties,
    /// B-18 factor, not in `properties`: of a whole, that of the body nearest the root.
    pub l_scale: f64,
    /// B-10: the power of ten below which tensor elements are shown as 0.
    pub zero_exponent: Option<i32>,
}

impl LinkValues {
    /// B-10 D: inertia about the frame's origin along its axes, kg·m².
    pub fn inertia_at_origin(&self) -> Mat3 {
        self.properties.inertia_at_origin().map(|x| self.shown(x))
    }

    /// B-10 E: principal moments about the centre of mass, ascending, kg·m².
    pub fn principal_moments(&self) -> Vec3 {
        self.properties.principal().moments.map(|x| self.shown(x))
    }

    fn shown(&self, x: f64) -> f64 {
        let least = self.zero_exponent.map_or(0.0, |e| 10.0_f64.powi(e));
        if x.abs() < least { 0.0 } else { x }
    }
}

/// The values of each URDF link, in the order of the model.
pub fn link_values(model: &Model, bodies: &[LinkBody]) -> Vec<LinkValues> {
    let links = model.links.iter().zip(bodies).enumerate();
    let values = links.map(|(i, (link, body))| LinkValues {
        frame: link.name.clone(),
        membership: link.membership.clone(),
        members: vec![link.name.clone()],
        seats: vec![(i, Pose::identity())],
        volume: body.volume,
        properties: body.properties,
        l_scale: body.l_scale,
        zero_exponent: body.zero_exponent,
    });
    values.collect()
}

/// The links of the source (節): what each joint moves as one body, from its axis to the next ones (J-6). The base
/// comes first; what has no mass is left out.
pub fn joint_link_values(model: &Model, bodies: &[LinkBody]) -> Vec<LinkValues> {
    (0..model.bodies.len()).filter_map(|body| joint_link(model, bodies, body)).collect()
}

fn joint_link(model: &Model, bodies: &[LinkBody], body: usize) -> Option<LinkValues> {
    let members: Vec<(usize, Pose)> = (model.links.iter().enumerate())
        .filter_map(|(i, link)| match link.frame {
            LinkFrame::OnBody { body: b, offset } if b == body => Some((i, offset)),
            _ => None,
        })
        .collect();
    let is_root = |i: usize| model.is_root(i) || model.links[i].membership.as_ref().is_some_and(|m| m.root);
    let &(root, root_pose) = members.iter().find(|(i, _)| is_root(*i)).or(members.first())?;
    let seats: Vec<(usize, Pose)> = members.iter().map(|(i, pose)| (*i, root_pose.inv_mul(pose))).collect();
    let heavy: Vec<&(usize, Pose)> = seats.iter().filter(|(i, _)| bodies[*i].properties.mass > 0.0).collect();
    let parts: Vec<MassProperties> = heavy.iter().map(|(i, pose)| bodies[*i].properties.placed(pose)).collect();
    let depth = |i: usize| std::iter::successors(Some(i), |i| model.links[*i].parent).count();
    let nearest = heavy.iter().map(|(i, _)| *i).min_by_key(|i| depth(*i))?;
    let members = heavy.iter().map(|(i, _)| model.links[*i].name.clone()).collect();
    let volume = heavy.iter().map(|(i, _)| bodies[*i].volume).sum();
    let zero_exponent = heavy.iter().filter_map(|(i, _)| bodies[*i].zero_exponent).min();
    Some(LinkValues {
        frame: model.links[root].name.clone(),
        membership: model.links[root].membership.clone(),
        members,
        volume,
        properties: MassProperties::sum(&parts),
        seats,
        l_scale: bodies[nearest].l_scale,
        zero_exponent,
    })
}
