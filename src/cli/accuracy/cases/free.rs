//! What nothing holds and nothing touches.

use super::super::case::{Case, Look, Truth, turned};
use super::super::closed::FreeBody;
use super::super::stage::scene;
use super::{SECOND, WEIGHTLESS};

const INERTIA: [f64; 3] = [0.01, 0.02, 0.028];
/// Nearly about the middle axis, rad/s: the body turns over.
const SPIN: [f64; 3] = [0.5, 10.0, 0.5];

pub(super) fn torque_free() -> Case {
    let [a, b, c] = INERTIA;
    let text = format!(
        "version: 1\nbodies: [{{name: body, mass: 1, inertia: [{a}, 0, 0, {b}, 0, {c}], shape: {{sphere: {{radius: 0.1}}}}, \
         angular_velocity: {SPIN:?}}}]"
    );
    Case {
        name: "torque_free",
        shows: "An asymmetric body tumbles freely at 10 rad/s about nearly its middle axis, and turns over.",
        compared: "how the body is turned",
        unit: "rad",
        size: 1.0,
        instants: 2 * SECOND,
        make: Box::new(move || scene(&text, WEIGHTLESS)),
        looks: vec![Look::Turn { link: "body".into() }],
        truth: Truth::Closed {
            words: "Jacobi's elliptic functions, and the precession about the angular momentum by quadrature of them",
            value: Box::new(|times| FreeBody::new(INERTIA, SPIN).turns(times).iter().map(turned).collect()),
        },
        orders: None,
        iterates: false,
        peer_differs: None,
    }
}
