//! The mass room: analytic formulas against numerical integration, rigid-body identities, and the rules for links.

#![allow(clippy::unwrap_used)] // a test may panic

mod mass {
    mod formulas;
    mod kinds;
    mod points;
    mod round;
    mod straight;
}
