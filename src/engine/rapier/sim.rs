//! rapier's sets in one place, with every setting that it would choose in silence.

use crate::math::V3;
use rapier3d_f64::prelude::*;

/// A rapier world. Its scratch is not copied: it holds nothing from step to step.
pub(super) struct Sim {
    pub bodies: RigidBodySet,
    pub colliders: ColliderSet,
    pub joints: ImpulseJointSet,
    pub narrow: NarrowPhase,
    params: IntegrationParameters,
    islands: IslandManager,
    broad: BroadPhaseBvh,
    multibodies: MultibodyJointSet,
    soft: SoftBodySet,
    ccd: CCDSolver,
    pipeline: PhysicsPipeline,
}

impl Clone for Sim {
    fn clone(&self) -> Self {
        Self {
            bodies: self.bodies.clone(),
            colliders: self.colliders.clone(),
            joints: self.joints.clone(),
            narrow: self.narrow.clone(),
            params: self.params,
            islands: self.islands.clone(),
            broad: self.broad.clone(),
            multibodies: self.multibodies.clone(),
            soft: self.soft.clone(),
            ccd: self.ccd.clone(),
            pipeline: PhysicsPipeline::new(),
        }
    }
}

impl std::fmt::Debug for Sim {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Sim {{ bodies: {}, joints: {} }}", self.bodies.len(), self.joints.len())
    }
}

impl Sim {
    pub fn new() -> Self {
        Self {
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            joints: ImpulseJointSet::new(),
            narrow: NarrowPhase::new(),
            params: parameters(),
            islands: IslandManager::new(),
            broad: BroadPhaseBvh::new(),
            multibodies: MultibodyJointSet::new(),
            soft: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            pipeline: PhysicsPipeline::new(),
        }
    }

    /// One step of `h` seconds in `substeps` of rapier's; false if something became infinite or no number.
    pub fn step(&mut self, (h, substeps): (f64, usize), gravity: V3<f64>, hooks: &dyn PhysicsHooks) -> bool {
        self.params.dt = h;
        self.params.min_ccd_dt = 0.01 * h;
        self.params.num_solver_iterations = substeps;
        self.pipeline.step(
            super::convert::vector(gravity),
            &self.params,
            &mut self.islands,
            &mut self.broad,
            &mut self.narrow,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibodies,
            &mut self.soft,
            &mut self.ccd,
            hooks,
            &(),
        );
        self.pipeline.quarantine().is_empty()
    }
}

/// Those that count, by name: rapier's defaults are made for games.
fn parameters() -> IntegrationParameters {
    IntegrationParameters {
        length_unit: 1.0,
        // No speed is too high.
        normalized_max_linear_velocity: f64::MAX,
        // Contact points are shown and their forces booked: none of them is reused from other poses or merged.
        contact_recycling: false,
        contact_clustering: false,
        // Exact for sliding boxes in every direction; the other model is not (facts: 0.200 against 0.204 to 0.251 m/s).
        friction_model: FrictionModel::Simplified,
        friction_in_bias_pass: false,
        warmstart_coefficient: 1.0,
        // It would be taken back at once: rapier applies it to a row just before that is solved.
        warmstart_joints: false,
        num_internal_pgs_iterations: SWEEPS,
        num_internal_stabilization_iterations: 1,
        max_ccd_substeps: 1,
        normalized_prediction_distance: 0.02,
        normalized_max_corrective_velocity: 3.0,
        normalized_allowed_linear_error: 0.005,
        contact_softness: touching(),
        static_contact_softness: touching(),
        ..IntegrationParameters::default()
    }
}

/// Softness of contacts: a body sinks by g/ω² under its own weight, 0.25 µm, and is lifted out at ω/2ζ = 314/s. rapier's own (30 Hz) makes
/// it 0.3 mm, and the lowest floors of a tower sink by millimetres.
fn touching() -> SpringCoefficients<f64> {
    SpringCoefficients::new(1000.0, 10.0)
}

/// Softness of locks and stops: rows that do not yield, whose gap is closed at [`CLOSING`]. rapier's own (1e6 Hz) closes a gap within a
/// substep. What the sweeps leave of an impact is a gap then, that comes back as a spring does: a head that hits its stop with
/// 7.9 rad/s bounces with 5.7.
pub(super) fn hard() -> SpringCoefficients<f64> {
    SpringCoefficients::new(CLOSING * 2.0 * UNYIELDING / std::f64::consts::TAU, UNYIELDING)
}

/// Share of a gap that goes in a second, 1/s.
const CLOSING: f64 = 1000.0;
/// Damping ratio: with it a row yields by less than 1e-6 of its own mobility.
const UNYIELDING: f64 = 1e4;

/// Sweeps over all rows in each substep. One leaves motors and stops short of the locks of their own limb: with 10 substeps of 20 µs a
/// toe that dry friction holds creeps by 10 mrad/s, and stops yield by 20 mrad; with four by 2 mrad/s and 5 mrad.
const SWEEPS: usize = 4;
