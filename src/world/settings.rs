//! Settings of a world (W-3 … W-6), with their ranges.

/// How the state is advanced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// First order; damping, servos, stops and friction implicit. The default.
    #[default]
    SemiImplicitEuler,
    /// Classical fourth order; steps in which a stop, dry friction or a servo acts fall back to the default, counted.
    Rk4,
}

/// Settings of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Control interval in ns of simulated time before the time scale; 1 µs … 1 s.
    pub control_interval_ns: i64,
    /// W-5: 1 … 1000.
    pub steps_per_interval: u32,
    /// W-6: 1 … 10000.
    pub solver_iterations: u32,
    /// W-3: 0 … 100; 0 stops time.
    pub time_scale: f64,
    /// m/s², world frame (Z up).
    pub gravity: [f64; 3],
    /// Integrator.
    pub integrator: Integrator,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            control_interval_ns: 1_000_000,
            steps_per_interval: 5,
            solver_iterations: 10,
            time_scale: 1.0,
            gravity: [0.0, 0.0, -9.80665],
            integrator: Integrator::SemiImplicitEuler,
        }
    }
}
