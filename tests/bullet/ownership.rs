//! The same run twice.

use super::touching::{cubes, ground, surface};
use super::{run, world};

#[test]
fn the_same_run_twice_gives_the_same_bits() {
    let ends = [0, 1].map(|_| {
        let mut w = world(cubes(&[1.0, 2.0, 3.0], 0.1, surface(0.5), ground(1.0)), 1e-3);
        run(&mut w, 0.5);
        w.reset();
        run(&mut w, 0.7);
        w.state().clone()
    });
    assert_eq!(ends[0], ends[1]);
}
