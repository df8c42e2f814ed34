//! Which triangles meet at an edge, and the loops that edges form.

use std::collections::HashMap;

/// One side of one triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The edge's corners, smaller index first: equal for all triangles at the edge.
    pub(super) key: (u32, u32),
    /// The triangle.
    pub(super) triangle: u32,
    /// Which of its sides: from corner `side` to corner `side + 1`.
    pub(super) side: u8,
    /// True when the triangle walks the edge from the smaller index to the larger.
    pub(super) forward: bool,
}

impl Side {
    /// The corners in the order the triangle walks them.
    pub(super) fn ends(&self) -> (u32, u32) {
        if self.forward { self.key } else { (self.key.1, self.key.0) }
    }
}

/// Every side of every triangle, sorted, so that sides of the same edge are neighbours: `chunk_by` key gives the edges.
pub(super) fn of(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for side in 0..3u8 {
            let (a, b) = (corners[usize::from(side)], corners[usize::from((side + 1) % 3)]);
            sides.push(Side { key: (a.min(b), a.max(b)), triangle: triangle as u32, side, forward: a < b });
        }
    }
    sides.sort_unstable();
    sides
}

/// True when the edge is walked equally often in both directions.
pub(super) fn balanced(edge: &[Side]) -> bool {
    2 * edge.iter().filter(|side| side.forward).count() == edge.len()
}

/// Groups of triangles that hang together: a group number per triangle, counted in the order of their first triangles, and how many
/// there are. Two triangles of an edge belong together when `joins` says so of the edge.
pub(super) fn groups(triangle_count: usize, sides: &[Side], joins: impl Fn(&[Side]) -> bool) -> (Vec<usize>, usize) {
    let mut parent: Vec<usize> = (0..triangle_count).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for edge in sides.chunk_by(|a, b| a.key == b.key).filter(|edge| joins(edge)) {
        for pair in edge.windows(2) {
            let (a, b) = (root(&mut parent, pair[0].triangle as usize), root(&mut parent, pair[1].triangle as usize));
            // The smaller index stays root: numbers then follow the file's order.
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut count = 0;
    let mut number = vec![0; triangle_count];
    for i in 0..triangle_count {
        let r = root(&mut parent, i);
        if r == i {
            number[i] = count;
            count += 1;
        } else {
            number[i] = number[r];
        }
    }
    (number, count)
}

/// The loops that directed steps between corners form, three steps or more. At a corner where several loops meet, each is closed as early as possible. Steps that
/// lead into no loop are left out.
pub(super) fn loops(steps: impl Iterator<Item = (u32, u32)>) -> Vec<Vec<u32>> {
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut starts = Vec::new();
    for (from, to) in steps {
        next.entry(from).or_default().push(to);
        starts.push(from);
    }
    let mut loops = Vec::new();
    for start in starts {
        let mut path = vec![start];
        let mut place: HashMap<u32, usize> = HashMap::from([(start, 0)]);
        while let Some(to) = path.last().and_then(|at| next.get_mut(at)).and_then(Vec::pop) {
            match place.get(&to) {
                Some(first) => {
                    let round = path.split_off(*first);
                    round.iter().for_each(|corner| {
                        place.remove(corner);
                    });
                    place.insert(to, path.len());
                    path.push(to);
                    if round.len() >= 3 {
                        loops.push(round);
                    }
                }
                None => {
                    place.insert(to, path.len());
                    path.push(to);
                }
            }
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_share_an_edge_are_one_group_and_a_shared_corner_joins_nothing() {
        let triangles = [[0, 1, 2], [5, 6, 7], [2, 1, 3], [3, 8, 9]];
        let (number, count) = groups(4, &of(&triangles), |_| true);
        assert_eq!((number, count), (vec![0, 1, 0, 2], 3));
    }

    #[test]
    fn an_edge_is_balanced_when_its_triangles_walk_it_both_ways() {
        let ends = |triangles: &[[u32; 3]]| {
            let sides = of(triangles);
            let edge: Vec<Side> = sides.into_iter().filter(|s| s.key == (1, 2)).collect();
            balanced(&edge)
        };
        assert!(ends(&[[0, 1, 2], [2, 1, 3]]));
        assert!(!ends(&[[0, 1, 2], [1, 2, 3]]));
        assert!(!ends(&[[0, 1, 2]]));
    }
}
