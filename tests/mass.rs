//! The mass room: analytic formulas against numerical integration, rigid-body identities, and the rules for links.
#![allow(clippy::unwrap_used)] // a test may panic

mod mass {
    mod closed_forms;
    mod convergence;
    mod corrections;
    mod formulas;
    mod identities;
    mod kinds;
    mod links;
    mod offsets;
    mod points;
    mod polygons;
    mod principal;
    mod random;
    mod round;
    mod shapes;
    mod slices;
    mod straight;
    mod weigh;
}
