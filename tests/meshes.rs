//! Mesh files: found, read, judged, repaired or refused.
#![allow(clippy::unwrap_used)] // a test may panic

mod meshes {
    mod bad;
    mod dae;
    mod heights;
    mod mutated;
    mod paths;
    mod read;
    mod solid;
    mod support;
}
