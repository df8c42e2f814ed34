//! Finding things that may meet while everything moves, much of it in company: a tree of boxes.

use super::Rect;

/// Items a group holds, and groups a larger group.
const BRANCHES: usize = 4;

/// Boxes of moving things, before and after a straight motion, in groups of neighbours, and groups of groups. Filling it again reuses its memory.
///
/// Where a uniform grid would list a box in every cell that it sweeps over, and pair it with all that sweeps over the same cells in company, the tree only pairs
/// what may meet: two boxes that are apart along one axis, the same way round before and after, are apart all the time.
#[derive(Debug, Clone, Default)]
pub struct MotionTree {
    /// The items, then ever larger groups; the last level holds one.
    levels: Vec<Vec<[Rect; 2]>>,
    /// Levels in use.
    height: usize,
}

impl MotionTree {
    /// Takes the box of every item before and after the motion. Items that follow each other should lie near each other: the groups are made in this order.
    pub fn fill(&mut self, items: impl IntoIterator<Item = [Rect; 2]>) {
        if self.levels.is_empty() {
            self.levels.push(Vec::new());
        }
        self.levels[0].clear();
        self.levels[0].extend(items);
        self.height = 1;
        while self.levels[self.height - 1].len() > 1 {
            if self.levels.len() == self.height {
                self.levels.push(Vec::new());
            }
            let (below, above) = self.levels.split_at_mut(self.height);
            let group = |g: &[[Rect; 2]]| g[1..].iter().fold(g[0], |all, b| [all[0].union(b[0]), all[1].union(b[1])]);
            above[0].clear();
            above[0].extend(below[self.height - 1].chunks(BRANCHES).map(group));
            self.height += 1;
        }
    }

    /// Calls `found` with every item of this tree and item of `other` whose boxes may meet during the motion, in a fixed order.
    pub fn near(&self, other: &MotionTree, found: &mut impl FnMut(usize, usize)) {
        if self.height > 0 && other.height > 0 && !self.levels[0].is_empty() && !other.levels[0].is_empty() {
            self.descend(other, [self.height - 1, 0], [other.height - 1, 0], found);
        }
    }

    fn descend(
        &self,
        other: &MotionTree,
        [level, item]: [usize; 2],
        [other_level, other_item]: [usize; 2],
        found: &mut impl FnMut(usize, usize),
    ) {
        if stay_apart(&self.levels[level][item], &other.levels[other_level][other_item]) {
            return;
        }
        let below = |tree: &MotionTree, level: usize, item: usize| {
            BRANCHES * item..(BRANCHES * (item + 1)).min(tree.levels[level - 1].len())
        };
        if level == 0 && other_level == 0 {
            found(item, other_item);
        } else if level >= other_level {
            for child in below(self, level, item) {
                self.descend(other, [level - 1, child], [other_level, other_item], found);
            }
        } else {
            for child in below(other, other_level, other_item) {
                self.descend(other, [level, item], [other_level - 1, child], found);
            }
        }
    }
}

/// True when two boxes never meet: they are apart along one axis, the same one first before and after.
fn stay_apart(a: &[Rect; 2], b: &[Rect; 2]) -> bool {
    (a[0].max.x < b[0].min.x && a[1].max.x < b[1].min.x)
        || (a[0].max.y < b[0].min.y && a[1].max.y < b[1].min.y)
        || (b[0].max.x < a[0].min.x && b[1].max.x < a[1].min.x)
        || (b[0].max.y < a[0].min.y && b[1].max.y < a[1].min.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;
    use proptest::prelude::*;

    fn rect(x: f64, y: f64, width: f64, height: f64) -> Rect {
        Rect { min: P2::new(x, y), max: P2::new(x + width, y + height) }
    }

    fn pairs(a: &[[Rect; 2]], b: &[[Rect; 2]]) -> Vec<(usize, usize)> {
        let (mut first, mut second) = (MotionTree::default(), MotionTree::default());
        // Filled twice, to see that nothing is left over.
        first.fill(b.iter().chain(a).chain(a).copied());
        first.fill(a.iter().copied());
        second.fill(b.iter().copied());
        let mut found = Vec::new();
        first.near(&second, &mut |i, j| found.push((i, j)));
        found.sort_unstable();
        found
    }

    #[test]
    fn what_falls_in_company_is_not_paired_and_what_swaps_places_is() {
        let falling = |y: f64| [rect(0.0, y, 10.0, 1.0), rect(0.0, y - 500.0, 10.0, 1.0)];
        let stack: Vec<[Rect; 2]> = (0..20).map(|i| falling(30.0 * f64::from(i))).collect();
        let own: Vec<(usize, usize)> = (0..20).map(|i| (i, i)).collect();
        assert_eq!(pairs(&stack, &stack), own);
        let rising = [rect(0.0, -100.0, 10.0, 1.0), rect(0.0, 700.0, 10.0, 1.0)];
        assert_eq!(pairs(&[rising], &stack).len(), 20);
        assert!(pairs(&[], &stack).is_empty() && pairs(&stack, &[]).is_empty());
    }

    fn moving() -> impl Strategy<Value = [Rect; 2]> {
        let size = 0.0..3.0f64;
        let place = || -20.0..20.0f64;
        (place(), place(), size.clone(), size, place(), place())
            .prop_map(|(x, y, w, h, dx, dy)| [rect(x, y, w, h), rect(x + dx, y + dy, w, h)])
    }

    proptest! {
        #[test]
        fn no_pair_that_meets_on_the_way_is_missed(
            a in prop::collection::vec(moving(), 1..40), b in prop::collection::vec(moving(), 1..40),
        ) {
            let found = pairs(&a, &b);
            prop_assert!(found.windows(2).all(|w| w[0] < w[1]), "every pair once");
            let at = |way: &[Rect; 2], t: f64| {
                let along = |p: P2, q: P2| p + (q - p) * t;
                Rect { min: along(way[0].min, way[1].min), max: along(way[0].max, way[1].max) }
            };
            for (i, a) in a.iter().enumerate() {
                for (j, b) in b.iter().enumerate() {
                    let meet = (0..=100).any(|k| {
                        let t = f64::from(k) / 100.0;
                        at(a, t).overlaps(&at(b, t))
                    });
                    prop_assert!(!meet || found.contains(&(i, j)), "{a:?} {b:?}");
                }
            }
        }
    }
}
