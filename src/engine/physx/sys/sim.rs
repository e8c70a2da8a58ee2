//! A scene in PhysX.

use super::{making, physics, watched};
use crate::engine::physx::spec::{Form, Moving, NO_LINK, Scene, Shape, Step, Touch};
use physx_sys::*;
use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

/// PhysX squares its bounds of speed: the greatest whose square is a number.
const FASTEST: f32 = 1e16;
/// How fast what overlaps is driven apart at most, m/s.
const DEPENETRATION: f32 = 3.0;
/// Passes without the bias that takes penetration back: they take out the speed that it gave. A box that starts 1 cm deep in
/// the ground comes out with 3.0 m/s after none, 0.7 after one, 0.1 after two, none after four.
const VELOCITY_PASSES: u32 = 4;

/// The sides of pairs of links that never touch.
type Excluded = Vec<[u32; 2]>;

/// A scene in PhysX. All of its methods but those that only look at Rust's memory need it for themselves alone.
pub struct Sim {
    scene: *mut PxScene,
    dispatcher: *mut PxDefaultCpuDispatcher,
    events: *mut PxSimulationEventCallback,
    /// Written by `touched` while PhysX steps.
    touches: *mut Vec<Touch>,
    /// Read by `filter` while PhysX steps.
    excluded: *mut Excluded,
    bodies: Vec<*mut PxRigidDynamic>,
    fixed: Vec<*mut PxRigidStatic>,
    materials: Vec<([f32; 2], *mut PxMaterial)>,
    last: Option<Step>,
}

// SAFETY: all that the pointers lead to is this scene's alone, but for cooked shapes, which are counted atomically and never
// written; PhysX keeps nothing of a scene in the thread that made it.
unsafe impl Send for Sim {}
// SAFETY: what takes `&self` reads only what `&mut self` writes.
unsafe impl Sync for Sim {}

impl Sim {
    /// Makes a scene.
    ///
    /// # Errors
    /// What PhysX reports; numbers that are not finite in single precision.
    pub fn new(spec: &Scene) -> Result<Self, String> {
        let physics = physics()?;
        let mut sim = Self {
            scene: null_mut(),
            // SAFETY: no threads, so no masks are read.
            dispatcher: unsafe {
                phys_PxDefaultCpuDispatcherCreate(0, null_mut(), PxDefaultCpuDispatcherWaitForWorkMode::WaitForWork, 0)
            },
            events: null_mut(),
            touches: Box::into_raw(Box::default()),
            excluded: Box::into_raw(Box::new(spec.excluded.clone())),
            bodies: vec![],
            fixed: vec![],
            materials: vec![],
            last: None,
        };
        let made = {
            let _one_at_a_time = making();
            watched(|| sim.fill(physics, spec))
        };
        // On an error what has been made so far is dropped, by itself.
        made??;
        Ok(sim)
    }

    fn fill(&mut self, physics: *mut PxPhysics, spec: &Scene) -> Result<(), String> {
        let called = SimulationEventCallbackInfo {
            collision_callback: Some(touched),
            collision_user_data: self.touches.cast(),
            ..SimulationEventCallbackInfo::default()
        };
        // SAFETY: the description lives until the scene is made; what it points to, as long as the scene.
        self.scene = unsafe {
            self.events = create_simulation_event_callbacks(&called);
            let mut desc = PxSceneDesc_new(&PxTolerancesScale_new(1.0, 10.0));
            desc.solverType = PxSolverType::Tgs;
            desc.flags = PxSceneFlags::EnablePcm | PxSceneFlags::EnableEnhancedDeterminism;
            desc.frictionCorrelationDistance = spec.correlation;
            desc.cpuDispatcher = self.dispatcher.cast();
            desc.simulationEventCallback = self.events;
            enable_custom_filter_shader(&mut desc, filter, 0);
            PxPhysics_createScene_mut(physics, &desc)
        };
        if self.scene.is_null() || self.dispatcher.is_null() {
            return Err("physx: no scene".into());
        }
        for body in &spec.bodies {
            let numbers = [body.mass, 1.0 / body.mass].into_iter().chain(body.inertia.map(|i| 1.0 / i));
            if !body.moving.is_sound() || !numbers.into_iter().all(|x| x > 0.0 && x.is_finite()) {
                return Err("physx: a body whose mass, inertia, place or speed is beyond single precision".into());
            }
            // SAFETY: the pose and all numbers are finite.
            self.bodies.push(unsafe {
                let body_made = PxPhysics_createRigidDynamic_mut(physics, &transform(&body.moving.pose));
                set_up(body_made, body.mass, body.inertia);
                body_made
            });
        }
        spec.shapes.iter().try_for_each(|shape| self.add(physics, shape, spec.reach))?;
        // SAFETY: all of them were made above, and are in no scene yet.
        unsafe {
            for body in &self.bodies {
                PxScene_addActor_mut(self.scene, body.cast(), null());
            }
            for fixed in &self.fixed {
                PxScene_addActor_mut(self.scene, fixed.cast(), null());
            }
        }
        for (i, body) in spec.bodies.iter().enumerate() {
            self.set_speed(i, body.moving.linear, body.moving.angular);
        }
        Ok(())
    }

    fn add(&mut self, physics: *mut PxPhysics, spec: &Shape, reach: f32) -> Result<(), String> {
        if !spec.pose.iter().chain(&spec.surface).chain([&spec.margin]).all(|x| x.is_finite()) {
            return Err("physx: a shape whose place or surface is beyond single precision".into());
        }
        let material = self.material(physics, spec.surface);
        // SAFETY: the actor is one of this scene's, or is made here; the shape takes its own references to material and hull, and
        // the actor one to the shape. Two words of the filter's data are a pointer that lives as long as the scene.
        unsafe {
            let shape = make_shape(physics, &spec.form, material);
            if shape.is_null() {
                return Err("physx: a shape that it cannot take".into());
            }
            let table = self.excluded as usize as u64;
            let data = PxFilterData { word0: spec.link, word1: 0, word2: table as u32, word3: (table >> 32) as u32 };
            PxShape_setSimulationFilterData_mut(shape, &data);
            (*shape).userData = spec.collider as usize as *mut c_void;
            // Rest must be below reach at every moment.
            PxShape_setContactOffset_mut(shape, reach + spec.margin);
            PxShape_setRestOffset_mut(shape, spec.margin);
            let actor: *mut PxRigidActor = match spec.body {
                Some(body) => {
                    PxShape_setLocalPose_mut(shape, &transform(&spec.pose));
                    self.bodies[body].cast()
                }
                None => {
                    let fixed = PxPhysics_createRigidStatic_mut(physics, &transform(&spec.pose));
                    self.fixed.push(fixed);
                    fixed.cast()
                }
            };
            let attached = PxRigidActor_attachShape_mut(actor, shape);
            PxShape_release_mut(shape);
            if attached { Ok(()) } else { Err("physx: a plane or a mesh cannot move".into()) }
        }
    }

    fn material(&mut self, physics: *mut PxPhysics, surface: [f32; 2]) -> *mut PxMaterial {
        if let Some((_, made)) = self.materials.iter().find(|(s, _)| *s == surface) {
            return *made;
        }
        // SAFETY: both numbers are finite.
        let made = unsafe {
            let made = PxPhysics_createMaterial_mut(physics, surface[0], surface[0], surface[1]);
            PxMaterial_setFrictionCombineMode_mut(made, PxCombineMode::Multiply);
            PxMaterial_setRestitutionCombineMode_mut(made, PxCombineMode::Multiply);
            made
        };
        self.materials.push((surface, made));
        made
    }

    /// One step; then `bodies` and [`Self::touches`] tell what it did.
    ///
    /// # Errors
    /// What PhysX reports.
    pub fn step(&mut self, step: &Step, bodies: &mut [Moving]) -> Result<(), String> {
        let before = self.last.replace(*step);
        let mut state = 0;
        // SAFETY: the scene and its bodies live, and no step is under way; `touched` alone uses the list during the step.
        let done = watched(|| unsafe {
            (*self.touches).clear();
            if before.is_none_or(|b| (b.gravity, b.bounce) != (step.gravity, step.bounce)) {
                PxScene_setGravity_mut(self.scene, &vector(step.gravity));
                PxScene_setBounceThresholdVelocity_mut(self.scene, step.bounce);
            }
            if before.is_none_or(|b| b.passes != step.passes) {
                for body in &self.bodies {
                    PxRigidDynamic_setSolverIterationCounts_mut(*body, step.passes.clamp(1, 255), VELOCITY_PASSES);
                }
            }
            PxScene_simulate_mut(self.scene, step.h, null_mut(), null_mut(), 0, true)
                && PxScene_fetchResults_mut(self.scene, true, &mut state)
        })?;
        if !done || state != 0 {
            return Err(format!("physx: the step was not made ({state})"));
        }
        for (body, out) in self.bodies.iter().zip(bodies) {
            // SAFETY: the body lives, and no step is under way.
            *out = unsafe { read(*body) };
        }
        Ok(())
    }

    /// The points of the last step.
    pub fn touches(&self) -> &[Touch] {
        // SAFETY: the list lives as long as `self`, and is written only while `&mut self` is borrowed.
        unsafe { &*self.touches }
    }

    /// Gives a body that is awake another velocity; finite numbers only, others are not taken.
    pub fn set_speed(&mut self, body: usize, linear: [f32; 3], angular: [f32; 3]) {
        if !linear.iter().chain(&angular).all(|x| x.is_finite()) {
            return;
        }
        // SAFETY: the body lives and is in the scene; no step is under way.
        unsafe {
            PxRigidDynamic_setLinearVelocity_mut(self.bodies[body], &vector(linear), false);
            PxRigidDynamic_setAngularVelocity_mut(self.bodies[body], &vector(angular), false);
        }
    }

    /// Lets a body sleep, or wakes it.
    pub fn let_sleep(&mut self, body: usize, asleep: bool) {
        // SAFETY: the body lives and is in the scene; no step is under way.
        unsafe {
            if asleep {
                PxRigidDynamic_putToSleep_mut(self.bodies[body]);
            } else {
                PxRigidDynamic_wakeUp_mut(self.bodies[body]);
            }
        }
    }

    /// Does it sleep?
    pub fn sleeps(&self, body: usize) -> bool {
        // SAFETY: the body lives and is in the scene; this only reads.
        unsafe { PxRigidDynamic_isSleeping(self.bodies[body]) }
    }
}

impl Drop for Sim {
    fn drop(&mut self) {
        let _one_at_a_time = making();
        // SAFETY: each was made by this scene and is freed once: actors before the scene, the scene before what it calls.
        unsafe {
            self.bodies.iter().for_each(|b| PxActor_release_mut(b.cast()));
            self.fixed.iter().for_each(|f| PxActor_release_mut(f.cast()));
            if !self.scene.is_null() {
                PxScene_release_mut(self.scene);
            }
            self.materials.iter().for_each(|(_, m)| PxRefCounted_release_mut(m.cast()));
            if !self.events.is_null() {
                destroy_simulation_event_callbacks(self.events);
            }
            if !self.dispatcher.is_null() {
                PxDefaultCpuDispatcher_release_mut(self.dispatcher);
            }
            drop((Box::from_raw(self.touches), Box::from_raw(self.excluded)));
        }
    }
}

impl std::fmt::Debug for Sim {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Sim {{ bodies: {}, fixed: {} }}", self.bodies.len(), self.fixed.len())
    }
}

fn vector([x, y, z]: [f32; 3]) -> PxVec3 {
    PxVec3 { x, y, z }
}

fn transform(&[px, py, pz, x, y, z, w]: &[f32; 7]) -> PxTransform {
    PxTransform { q: PxQuat { x, y, z, w }, p: PxVec3 { x: px, y: py, z: pz } }
}

/// What PhysX would choose by itself.
///
/// # Safety
/// A body that lives; positive numbers.
unsafe fn set_up(body: *mut PxRigidDynamic, mass: f32, inertia: [f32; 3]) {
    let rigid: *mut PxRigidBody = body.cast();
    // SAFETY: as of this function.
    unsafe {
        PxRigidBody_setMass_mut(rigid, mass);
        PxRigidBody_setMassSpaceInertiaTensor_mut(rigid, &vector(inertia));
        PxRigidBody_setLinearDamping_mut(rigid, 0.0);
        PxRigidBody_setAngularDamping_mut(rigid, 0.0);
        PxRigidBody_setMaxLinearVelocity_mut(rigid, FASTEST);
        PxRigidBody_setMaxAngularVelocity_mut(rigid, FASTEST);
        PxRigidBody_setMaxDepenetrationVelocity_mut(rigid, DEPENETRATION);
        PxRigidBody_setRigidBodyFlag_mut(rigid, PxRigidBodyFlag::EnableGyroscopicForces, true);
        // Nothing sleeps but by `Sim::let_sleep`.
        PxRigidDynamic_setSleepThreshold_mut(body, 0.0);
    }
}

/// # Safety
/// A body that lives, between two steps.
unsafe fn read(body: *mut PxRigidDynamic) -> Moving {
    // SAFETY: as of this function.
    let (x, w, v) = unsafe {
        let rigid: *mut PxRigidBody = body.cast();
        (
            PxRigidActor_getGlobalPose(body.cast()),
            PxRigidBody_getAngularVelocity(rigid),
            PxRigidBody_getLinearVelocity(rigid),
        )
    };
    Moving {
        pose: [x.p.x, x.p.y, x.p.z, x.q.x, x.q.y, x.q.z, x.q.w],
        angular: [w.x, w.y, w.z],
        linear: [v.x, v.y, v.z],
    }
}

/// # Safety
/// A material that lives.
unsafe fn make_shape(physics: *mut PxPhysics, form: &Form, material: *mut PxMaterial) -> *mut PxShape {
    // SAFETY: PhysX copies the geometry. Hulls and meshes live while `form` does, and the shape counts itself as a user.
    unsafe {
        let create = |geometry: *const PxGeometry| {
            PxPhysics_createShape_mut(physics, geometry, material, true, PxShapeFlags::SimulationShape)
        };
        match form {
            Form::Ball(radius) => create(std::ptr::from_ref(&PxSphereGeometry_new(*radius)).cast()),
            Form::Cuboid([x, y, z]) => create(std::ptr::from_ref(&PxBoxGeometry_new(*x, *y, *z)).cast()),
            Form::Capsule(radius, half) => create(std::ptr::from_ref(&PxCapsuleGeometry_new(*radius, *half)).cast()),
            Form::HalfSpace => create(std::ptr::from_ref(&PxPlaneGeometry_new()).cast()),
            Form::Hull(hull) => {
                let (mesh, flags) = (hull.0.as_ptr().cast(), PxConvexMeshGeometryFlags::empty());
                create(std::ptr::from_ref(&PxConvexMeshGeometry_new(mesh, &PxMeshScale_new(), flags)).cast())
            }
            Form::Mesh(mesh) => {
                let (mesh, flags) = (mesh.0.as_ptr().cast(), PxMeshGeometryFlags::empty());
                create(std::ptr::from_ref(&PxTriangleMeshGeometry_new(mesh, &PxMeshScale_new(), flags)).cast())
            }
        }
    }
}

/// Asked by PhysX about pairs of shapes that come near each other.
unsafe extern "C" fn filter(pair: *mut FilterShaderCallbackInfo) -> PxFilterFlags {
    // SAFETY: PhysX hands over a pair of its own. The words of both are from `Sim::add`, of this scene.
    unsafe {
        let (a, b) = (&(*pair).filterData0, &(*pair).filterData1);
        let table = (u64::from(a.word3) << 32 | u64::from(a.word2)) as usize as *const Excluded;
        let links = [a.word0.min(b.word0), a.word0.max(b.word0)];
        if links[1] != NO_LINK && (*table).binary_search(&links).is_ok() {
            return PxFilterFlags::Suppress;
        }
        *(*pair).pairFlags = PxPairFlags::ContactDefault
            | PxPairFlags::NotifyTouchFound
            | PxPairFlags::NotifyTouchPersists
            | PxPairFlags::NotifyContactPoints;
        PxFilterFlags::empty()
    }
}

/// Told by PhysX what touched in a step.
unsafe extern "C" fn touched(
    list: *mut c_void,
    _: *const PxContactPairHeader,
    pairs: *const PxContactPair,
    count: u32,
) {
    /// PhysX counts the points of a pair in 8 bits.
    const MOST: usize = 255;
    let mut points = [const { MaybeUninit::<PxContactPairPoint>::uninit() }; MOST];
    // SAFETY: `list` is that of this scene, which nobody else uses during a step; `pairs` has `count` items, whose shapes live;
    // PhysX fills the points that it counts.
    unsafe {
        let list = &mut *list.cast::<Vec<Touch>>();
        for pair in std::slice::from_raw_parts(pairs, count as usize) {
            let colliders = pair.shapes.map(|shape| (*shape).userData as usize as u32);
            let found = PxContactPair_extractContacts(pair, points.as_mut_ptr().cast(), MOST as u32);
            for point in &points[..(found as usize).min(MOST)] {
                let p = point.assume_init_ref();
                let (n, j) = (&p.normal, &p.impulse);
                list.push(Touch {
                    colliders,
                    point: [p.position.x, p.position.y, p.position.z],
                    normal: [n.x, n.y, n.z],
                    separation: p.separation,
                    impulse: n.x * j.x + n.y * j.y + n.z * j.z,
                });
            }
        }
    }
}
