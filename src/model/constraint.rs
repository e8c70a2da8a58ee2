//! Soft, coupled and breaking joints (J-18, `<mimic>`).

/// Error reduction and force mixing of a constraint, as J-18 defines them: `ERP = h k / (h k + d)`, `CFM = 1 / (h k + d)`
/// for a spring k and a damper d, taken by implicit Euler. CFM 0 is hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softness {
    /// Share of the error that one step takes back, 0 to 1.
    pub erp: f64,
    /// Velocity per force, rad/s per N·m or m/s per N; 0 or more.
    pub cfm: f64,
}

impl Softness {
    /// Of a coordinate that never moves: a fixed joint that may break.
    pub const HELD: Self = Self { erp: 0.0, cfm: 0.0 };

    /// `h k + d` of a piece of `h` seconds, with the spring and the damper of the `whole` step; exactly 1/CFM for all of it.
    pub fn hk_plus_d(&self, h: f64, whole: f64) -> f64 {
        (1.0 - self.erp * (1.0 - h / whole)) / self.cfm
    }

    /// The spring k of a `whole` step, N·m/rad or N/m.
    pub fn stiffness(&self, whole: f64) -> f64 {
        self.erp / (self.cfm * whole)
    }
}

/// One direction in which a soft joint yields: a coordinate of its own whose error is its position. With CFM 0 it does not
/// yield, but is held where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftDof {
    /// Index into q.
    pub q: usize,
    /// Index into v.
    pub v: usize,
    /// How soft.
    pub softness: Softness,
}

/// An axis that follows another: `follower = ratio · leader + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// Index into `Model::axes`.
    pub follower: usize,
    /// Index into `Model::axes`.
    pub leader: usize,
    /// Position of the follower per position of the leader.
    pub ratio: f64,
    /// rad or m.
    pub offset: f64,
}

/// A joint that comes apart when the force through it exceeds a threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct Breakable {
    /// Body that the joint carries; of a soft joint, the last one.
    pub body: usize,
    /// Name of the URDF joint whose threshold it is: the least one of a group.
    pub joint: String,
    /// N.
    pub threshold: f64,
}
