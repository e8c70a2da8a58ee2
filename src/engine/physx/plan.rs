//! A [`Model`] as PhysX takes it: a body for each one that no joint holds and that carries nothing, and what collides of them
//! and of what stands still. All other bodies are links of a robot, and are left out.

use super::flight::Flight;
use super::shapes::{make, surface};
use super::spec::{Body, Form, Moving, NO_LINK, Scene, Shape};
use crate::engine::EngineKind;
use crate::engine::principal::Principal;
use crate::math::Pose;
use crate::model::{BodyDamping, Collider, Deactivation, JointType, Model};
use crate::shape::ContactForm;

/// Shapes nearer than twice this are looked at, m: what closes with less than 40 m/s is seen before it touches in a step of 1 ms.
const REACH: f32 = 0.02;
/// Contacts of a pair this near to each other share their friction, m: PhysX's own, and for small bodies as a share of their size.
const CORRELATION: (f64, f64) = (0.025, 0.2);

/// What of the model is what of PhysX.
#[derive(Clone, Debug)]
pub struct Plan {
    /// For PhysX; where the bodies are is written in before each use.
    pub scene: Scene,
    /// Per body of PhysX.
    pub seats: Vec<Seat>,
    /// Per body of the model: which of PhysX's.
    pub index: Vec<Option<usize>>,
}

/// A body of PhysX.
#[derive(Clone, Debug)]
pub struct Seat {
    /// As PhysX has it.
    pub own: Principal,
    /// kg.
    pub mass: f64,
    /// When it may sleep.
    pub rest: Option<Deactivation>,
    /// What it loses by itself.
    pub damping: Option<BodyDamping>,
}

impl Seat {
    /// About how far from its centre of mass its mass lies, m.
    fn size(&self) -> f64 {
        (self.own.moments.sum() / (2.0 * self.mass)).sqrt()
    }
}

/// Does no joint hold it, and does it carry nothing?
pub fn is_free(m: &Model, body: usize) -> bool {
    let b = &m.bodies[body];
    b.joint == JointType::Floating && b.parent == 0 && b.mass > 0.0 && m.bodies.iter().skip(1).all(|c| c.parent != body)
}

impl Plan {
    /// # Errors
    /// Names the body or shape that PhysX cannot take, and why.
    pub fn new(m: &Model) -> Result<Self, String> {
        let seats =
            (1..m.bodies.len()).filter(|i| is_free(m, *i)).map(|i| seat(m, i)).collect::<Result<Vec<_>, _>>()?;
        let mut index = vec![None; m.bodies.len()];
        seats.iter().enumerate().for_each(|(k, seat)| index[seat.own.body] = Some(k));
        let smallest = seats.iter().map(Seat::size).fold(f64::INFINITY, f64::min);
        let scene = Scene {
            bodies: seats.iter().map(of_seat).collect(),
            shapes: vec![],
            excluded: m.excluded_pairs.iter().map(|pair| pair.map(number)).collect(),
            reach: REACH,
            correlation: CORRELATION.0.min(CORRELATION.1 * smallest) as f32,
        };
        let mut plan = Self { scene, seats, index };
        if m.effects.contact {
            for (i, c) in m.colliders.iter().enumerate() {
                plan.add(m, i, c)?;
            }
        }
        Ok(plan)
    }

    fn add(&mut self, m: &Model, collider: usize, c: &Collider) -> Result<(), String> {
        let (body, x_bl) = m.seat_of(c);
        let (index, frame) = match self.index[body] {
            Some(i) => (Some(i), self.seats[i].own.frame),
            None if body == 0 => (None, Pose::identity()),
            // A link: nothing touches it.
            None => return Ok(()),
        };
        if index.is_some() && matches!(c.form, ContactForm::HalfSpace | ContactForm::Surface(_)) {
            return Err(format!("'{}' moves, and a plane or a surface cannot: give it another shape", c.name));
        }
        let parts = match &c.form {
            ContactForm::Surface(mesh) => vec![(surface(mesh)?, Pose::identity())],
            form => make(form).map_or(vec![], |made| made.parts),
        };
        let shape = |(form, own): (Form, Pose)| Shape {
            collider: number(collider),
            link: c.link.map_or(NO_LINK, number),
            body: index,
            pose: array(&(frame.inverse() * x_bl * own)),
            form,
            surface: [c.surface.friction as f32, c.surface.restitution as f32],
            margin: c.margin as f32,
        };
        self.scene.shapes.extend(parts.into_iter().map(shape));
        Ok(())
    }

    /// The body of PhysX that a collider is on; `None`: it stands still.
    pub fn carrier(&self, m: &Model, collider: u32) -> Option<usize> {
        self.index[m.seat_of(&m.colliders[collider as usize]).0]
    }

    /// Where the bodies are if the model's are there.
    pub fn place(&self, k: &crate::dynamics::Kinematics, bodies: &mut [Moving]) {
        for (seat, moving) in self.seats.iter().zip(bodies) {
            let at = seat.own.motion(k);
            let [angular, linear] = [at.angular, at.linear].map(Flight::single);
            *moving = Moving { pose: array(&at.pose), angular, linear };
        }
    }
}

fn of_seat(seat: &Seat) -> Body {
    Body { mass: seat.mass as f32, inertia: Flight::single(seat.own.moments), moving: Moving::default() }
}

fn seat(m: &Model, body: usize) -> Result<Seat, String> {
    Ok(Seat {
        own: Principal::of(m, body, EngineKind::Physx)?,
        mass: m.bodies[body].mass,
        rest: crate::engine::sleep::limit(m, body),
        damping: m.dampings.iter().find(|d| d.body == body).copied(),
    })
}

fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX - 1)
}

/// x, y, z and the quaternion x, y, z, w.
fn array(x: &Pose) -> [f32; 7] {
    let (p, q) = (x.translation, x.rotation);
    [p.x, p.y, p.z, q.i, q.j, q.k, q.w].map(|x| x as f32)
}
