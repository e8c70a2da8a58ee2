//! Which triangles meet at which edges.

/// One side of one triangle.
#[derive(Clone, Copy)]
pub(super) struct Side {
    /// The edge: its lesser corner, its greater corner.
    ends: [u32; 2],
    /// Which triangle.
    pub(super) triangle: u32,
    /// Does the triangle run from the lesser to the greater?
    pub(super) forward: bool,
}

/// The sides of all triangles, edge by edge. O(n log n).
pub(super) struct Edges {
    sides: Vec<Side>,
    odd: usize,
    balanced: bool,
}

impl Edges {
    pub(super) fn of(triangles: &[[u32; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            let side = |p: u32, q: u32| Side { ends: [p.min(q), p.max(q)], triangle: i as u32, forward: p < q };
            sides.extend([side(a, b), side(b, c), side(c, a)]);
        }
        sides.sort_unstable_by_key(|s| (s.ends, s.triangle));
        let mut edges = Self { sides, odd: 0, balanced: true };
        let odd = edges.iter().filter(|sides| sides.len() % 2 == 1).count();
        let balanced = edges.iter().all(|sides| net(sides, |_| false) == 0);
        (edges.odd, edges.balanced) = (odd, balanced);
        edges
    }

    /// The sides at each edge.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[Side]> {
        self.sides.chunk_by(|a, b| a.ends == b.ends)
    }

    /// Edges with an odd number of triangles: these lie open, whatever way the triangles face.
    pub(super) fn odd(&self) -> usize {
        self.odd
    }

    /// The corners of the first odd edge, in the order of the triangles.
    pub(super) fn first_odd(&self) -> Option<[u32; 2]> {
        self.all_odd().min_by_key(|side| side.triangle).map(|side| side.ends)
    }

    /// A side of each odd edge.
    pub(super) fn all_odd(&self) -> impl Iterator<Item = &Side> {
        self.iter().filter(|sides| sides.len() % 2 == 1).map(|sides| &sides[0])
    }

    /// Does each edge have as many triangles one way as the other?
    pub(super) fn balanced(&self) -> bool {
        self.balanced
    }
}

impl Side {
    /// The corners of the edge.
    pub(super) fn ends(&self) -> [u32; 2] {
        self.ends
    }
}

/// Triangles running forward along an edge less those running back, after turning some.
pub(super) fn net(sides: &[Side], turned: impl Fn(u32) -> bool) -> i64 {
    sides.iter().map(|s| if s.forward != turned(s.triangle) { 1 } else { -1 }).sum()
}
