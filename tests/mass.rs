//! The mass room: analytic formulas against numerical integration, rigid-body identities, and the rules for links.

mod mass {
    mod formulas;
    mod identities;
    mod links;
    mod quadrature;
    mod random;
}
