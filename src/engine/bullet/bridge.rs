//! What Rust and C++ tell each other. Frames and velocities are in the world unless said otherwise; a body's own frame has its
//! origin in the centre of mass and its axes along the principal ones. Poses are x, y, z and a unit quaternion x, y, z, w.

pub use ffi::{
    BodySpec, Contact, JointForce, JointSpec, Motor, MotorInput, Moving, PairInput, PairSpec, ShapeKind, ShapeSpec,
    Spec, StepInput,
};
pub use ffi::{World, build};

#[cxx::bridge(namespace = "realnoid::bullet")]
mod ffi {
    /// Where a body is and how it moves.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    struct Moving {
        pose: [f64; 7],
        /// rad/s.
        angular: [f64; 3],
        /// Of the centre of mass, m/s.
        linear: [f64; 3],
    }

    /// A body that moves.
    #[derive(Clone, Debug)]
    struct BodySpec {
        /// kg.
        mass: f64,
        /// Principal moments, kg·m².
        inertia: [f64; 3],
        moving: Moving,
        /// d of v ← v·(1 − d)^dt: linear, angular.
        damping: [f64; 2],
        /// Below these for longer than that it sleeps: m/s, rad/s, s; the last < 0: never.
        sleep: [f64; 3],
    }

    /// How the numbers of a [`ShapeSpec`] are meant.
    #[derive(Debug)]
    enum ShapeKind {
        /// z ≤ 0.
        Plane,
        /// `size`: half edges.
        Box,
        /// `numbers`: x, y, z, radius of each ball; their hull.
        Balls,
        /// `size`: half axes.
        Ellipsoid,
        /// `size`: radius, half length; along z.
        Cylinder,
        /// `size`: radius of the base at −z, half length.
        Cone,
        /// `size`: two half axes of the base at −z, share of them at +z, half length.
        Frustum,
        /// `numbers`: corners.
        Hull,
        /// `numbers`: corners; `triangles`. Stands still.
        Mesh,
    }

    /// A shape that collides.
    #[derive(Clone, Debug)]
    struct ShapeSpec {
        kind: ShapeKind,
        /// Index of its body; −1: it stands still in the world.
        body: i32,
        /// Index among the model's links; −1: none.
        link: i32,
        /// In the body's own frame, or in the world.
        pose: [f64; 7],
        size: [f64; 4],
        numbers: Vec<f64>,
        triangles: Vec<i32>,
        /// m; thicker all around by this.
        margin: f64,
        /// Friction, rolling and spinning friction, restitution.
        surface: [f64; 4],
    }

    /// A btGeneric6DofSpring2Constraint. Degrees of freedom: 0 to 2 along, 3 to 5 about x, y, z; turns are about z, then y, then x.
    #[derive(Clone, Debug)]
    struct JointSpec {
        /// −1: the world.
        parent: i32,
        child: i32,
        /// In the parent's own frame (in the world without one).
        frame_in_parent: [f64; 7],
        /// In the child's own frame.
        frame_in_child: [f64; 7],
        /// rad or m; both equal: locked; lower above upper: free.
        lower: [f64; 6],
        upper: [f64; 6],
        /// Share of the error that one step takes back.
        erp: [f64; 6],
        /// Velocity per force, as J-18 defines it.
        cfm: [f64; 6],
    }

    /// A degree of freedom of a joint that can be driven.
    #[derive(Clone, Debug)]
    struct Motor {
        joint: u32,
        dof: u32,
        /// Its range is more than Bullet knows of an angle, or Bullet's row is not of its measure: the stops that are near are told in each
        /// step.
        far: bool,
    }

    /// What acts on it in a step. Units along or about the axis of Bullet's row, N·m and rad/s or N and m/s.
    #[derive(Clone, Copy, Debug, Default)]
    struct MotorInput {
        torque: f64,
        speed: f64,
        /// Velocity per force; 0: hard.
        cfm: f64,
        /// 0: no motor.
        bound: f64,
        /// Of one that is `far`: way to the lower and to the upper stop, rad.
        stop: [f64; 2],
    }

    /// The turn about the child's x of a joint with three axes, which has a range of its own where two of them are nearly one.
    #[derive(Clone, Copy, Debug)]
    struct PairSpec {
        joint: u32,
        /// Share of the error that one step takes back.
        erp: f64,
    }

    /// The same in a step.
    #[derive(Clone, Copy, Debug, Default)]
    struct PairInput {
        /// Is it in force?
        on: bool,
        /// Way to the lower and to the upper end, rad.
        stop: [f64; 2],
    }

    /// A whole world.
    #[derive(Clone, Debug, Default)]
    struct Spec {
        bodies: Vec<BodySpec>,
        shapes: Vec<ShapeSpec>,
        joints: Vec<JointSpec>,
        motors: Vec<Motor>,
        pairs: Vec<PairSpec>,
        /// Pairs of links, in order and each ascending, whose shapes never touch: two numbers each.
        excluded: Vec<i32>,
    }

    /// What a step needs to know.
    #[derive(Clone, Copy, Debug)]
    struct StepInput {
        /// s.
        h: f64,
        /// m/s².
        gravity: [f64; 3],
        iterations: i32,
    }

    /// A point where two shapes touch.
    #[derive(Clone, Copy, Debug, Default)]
    struct Contact {
        /// Indices into `Spec::shapes`, ascending.
        shapes: [i32; 2],
        point: [f64; 3],
        /// From the first shape to the second.
        normal: [f64; 3],
        depth: f64,
        /// On the second, averaged over the last step, N.
        force: [f64; 3],
    }

    /// What a joint gave its child in the last step, without its motors.
    #[derive(Clone, Copy, Debug, Default)]
    struct JointForce {
        /// N.
        force: [f64; 3],
        /// About the child's centre of mass, N·m.
        torque: [f64; 3],
    }

    unsafe extern "C++" {
        include!("realnoid/src/engine/bullet/shim.h");

        /// A btDiscreteDynamicsWorld with all that is in it.
        type World;

        /// Makes a world.
        ///
        /// # Errors
        /// What Bullet or the C++ library could not do, and indices that do not fit.
        fn build(spec: &Spec) -> Result<UniquePtr<World>>;

        /// One step. `motors` and `efforts` (what the motors gave, without `torque`) in the order of `Spec::motors`, `pairs` in that of
        /// `Spec::pairs`, `bodies` in that of `Spec::bodies`.
        ///
        /// # Errors
        /// Sizes that do not fit, and exceptions.
        fn step(
            self: Pin<&mut World>,
            input: &StepInput,
            motors: &[MotorInput],
            pairs: &[PairInput],
            efforts: &mut [f64],
            bodies: &mut [Moving],
        ) -> Result<()>;

        /// The points of the last step, ordered by their shapes.
        ///
        /// # Errors
        /// Exceptions.
        fn contacts(self: &World, out: &mut Vec<Contact>) -> Result<()>;

        /// What the joints gave in the last step, in the order of `Spec::joints`.
        ///
        /// # Errors
        /// Sizes that do not fit.
        fn joint_forces(self: &World, out: &mut [JointForce]) -> Result<()>;

        /// Nothing sleeps.
        fn wake(self: Pin<&mut World>);

        /// How many worlds there are in this process.
        fn worlds() -> usize;
    }
}

pub use ffi::worlds;

// SAFETY: a world and everything in it is made for itself alone, by `build`: no body, shape, constraint or cache is shared with
// another one, so it may go to another thread. What Bullet has of global state are settings that nobody writes after start, and
// counters for statistics.
unsafe impl Send for ffi::World {}
