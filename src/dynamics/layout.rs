//! Where the velocities lie in factor space.

use crate::model::Model;
use std::ops::Range;

/// Numbers in a chunk: rows are stored and multiplied in units of this.
pub const CHUNK: usize = 4;

/// Places of the velocity coordinates in w: depth first, and every unbranched run of bodies starts at a whole chunk, so that
/// what acts on a body has entries in the chunks of its ancestors only.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Per body: place of its first velocity.
    place: Vec<usize>,
    /// Numbers in w, a multiple of [`CHUNK`].
    width: usize,
    /// Chunks of the ancestors of each body and of itself, ascending, one list after the other.
    chunks: Vec<u32>,
    of: Vec<Range<usize>>,
}

impl Layout {
    /// Of this model.
    pub fn new(m: &Model) -> Self {
        let n = m.bodies.len();
        let mut children = vec![vec![]; n];
        for (i, b) in m.bodies.iter().enumerate().skip(1) {
            children[b.parent].push(i);
        }
        let mut layout = Self { place: vec![0; n], width: 0, chunks: vec![], of: vec![0..0; n] };
        let mut waiting: Vec<usize> = children[0].iter().rev().copied().collect();
        while let Some(i) = waiting.pop() {
            let parent = m.bodies[i].parent;
            layout.put(m, i, parent == 0 || children[parent].len() > 1);
            waiting.extend(children[i].iter().rev());
        }
        layout.width = layout.width.next_multiple_of(CHUNK);
        layout
    }

    fn put(&mut self, m: &Model, body: usize, starts: bool) {
        if starts {
            self.width = self.width.next_multiple_of(CHUNK);
        }
        self.place[body] = self.width;
        self.width += m.bodies[body].joint.nv();
        let start = self.chunks.len();
        self.chunks.extend_from_within(self.of[m.bodies[body].parent].clone());
        let own = self.place[body] / CHUNK..self.width.div_ceil(CHUNK);
        let known = self.chunks[start..].last().map_or(0, |c| *c as usize + 1);
        self.chunks.extend(own.filter(|c| *c >= known).map(|c| c as u32));
        self.of[body] = start..self.chunks.len();
    }

    /// Numbers in w.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Place of the first velocity of a body's joint.
    pub fn place(&self, body: usize) -> usize {
        self.place[body]
    }

    /// Chunks in which the response to what acts on this body can differ from 0, ascending.
    pub fn chunks(&self, body: usize) -> &[u32] {
        &self.chunks[self.of[body].clone()]
    }

    /// The same for what acts on two bodies; appended to `out`.
    pub fn join(&self, a: usize, b: usize, out: &mut Vec<u32>) {
        let (mut a, mut b) = (self.chunks(a), self.chunks(b));
        loop {
            let next = match (a.first(), b.first()) {
                (Some(x), Some(y)) => *x.min(y),
                (Some(x), None) | (None, Some(x)) => *x,
                (None, None) => return,
            };
            a = a.strip_prefix(&[next]).unwrap_or(a);
            b = b.strip_prefix(&[next]).unwrap_or(b);
            out.push(next);
        }
    }

    /// The most chunks that a body has.
    pub fn deepest(&self) -> usize {
        self.of.iter().map(ExactSizeIterator::len).max().unwrap_or(0)
    }
}
