//! The bodies of a model, which models share until one of them changes its own.

use super::Body;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;

/// A list of bodies; the first is the world. To write to a shared one makes a copy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies(Arc<Vec<Body>>);

impl Bodies {
    /// Is it the very same list? Then so are all numbers in it.
    #[inline(always)]
    pub fn is_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Deref for Bodies {
    type Target = Vec<Body>;

    #[inline(always)]
    fn deref(&self) -> &Vec<Body> {
        &self.0
    }
}

impl DerefMut for Bodies {
    fn deref_mut(&mut self) -> &mut Vec<Body> {
        Arc::make_mut(&mut self.0)
    }
}

impl From<Vec<Body>> for Bodies {
    fn from(bodies: Vec<Body>) -> Self {
        Self(Arc::new(bodies))
    }
}

impl<'a> IntoIterator for &'a Bodies {
    type Item = &'a Body;
    type IntoIter = std::slice::Iter<'a, Body>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
