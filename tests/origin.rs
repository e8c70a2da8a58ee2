//! The default humanoid: what it promises, read from the file itself.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail by panicking, as tests do")]

mod origin {
    pub mod body;
    mod joints;
    mod reader;
    mod standard;
}
