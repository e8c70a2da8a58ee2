//! The trees of a model: each root on the world carries one.

use crate::model::Model;

/// Which tree each body and axis belongs to.
#[derive(Clone, Debug)]
pub(super) struct Forest {
    /// Per body; of the world: none, one past the last.
    pub of_body: Vec<usize>,
    /// Per axis; none if its joint has come apart.
    pub of_axis: Vec<usize>,
    pub count: usize,
}

impl Forest {
    pub fn of(m: &Model) -> Self {
        let mut of_body = vec![0; m.bodies.len()];
        let mut count = 0;
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            of_body[i] = if b.parent == 0 { count } else { of_body[b.parent] };
            count += usize::from(b.parent == 0);
        }
        of_body[0] = count;
        let of_axis = (0..m.axes.len()).map(|axis| m.carrier(axis).map_or(count, |body| of_body[body])).collect();
        Self { of_body, of_axis, count }
    }
}

/// Sets of trees that hang together, by contacts. Makes its memory once.
#[derive(Clone, Debug, Default)]
pub(super) struct Islands {
    parent: Vec<usize>,
}

impl Islands {
    /// Room for this many trees.
    pub fn new(trees: usize) -> Self {
        Self { parent: (0..trees).collect() }
    }

    /// Every tree by itself.
    pub fn part(&mut self) {
        self.parent.iter_mut().enumerate().for_each(|(i, p)| *p = i);
    }

    /// The tree that stands for the island of this one.
    pub fn of(&self, mut tree: usize) -> usize {
        while self.parent[tree] != tree {
            tree = self.parent[tree];
        }
        tree
    }

    /// Joins two; what is no tree (the world) joins nothing.
    pub fn join(&mut self, a: usize, b: usize) {
        if a < self.parent.len() && b < self.parent.len() {
            let (a, b) = (self.of(a), self.of(b));
            self.parent[a.max(b)] = a.min(b);
        }
    }
}
