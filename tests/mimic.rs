//! `<mimic>`: axes that follow others, from URDF text to forces.
#![allow(clippy::unwrap_used)] // a test may panic

#[path = "mimic/forces.rs"]
mod forces;
#[path = "mimic/motion.rs"]
mod motion;
#[path = "mimic/reading.rs"]
mod reading;
#[path = "mimic/scene.rs"]
mod scene;
mod support;
