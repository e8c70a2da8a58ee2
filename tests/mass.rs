//! The mass room: analytic formulas against numerical integration, rigid-body identities, and the rules for links.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking, as tests do")]

mod mass {
    mod formulas;
    mod identities;
    mod links;
    mod quadrature;
    mod random;
    mod shapes;
}
