//! Landmarks in a balanced tree that particles share: a copy is one pointer, and a change copies the way from the root to the landmark
//! alone (Montemerlo et al., AAAI 2002, Section 3). Branches know in which rectangle their landmarks lie, so that those near a place are
//! found without a look at all others.

use std::sync::Arc;

use super::landmark::Landmark;

/// Landmarks by slot, shared between copies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    root: Option<Arc<Node>>,
    /// The root holds `2^height` slots.
    height: u32,
}

/// A landmark in the tree, with where it is believed to be, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stored {
    pub(crate) landmark: Landmark,
    pub(crate) at_m: [f64; 2],
}

#[derive(Debug, Clone)]
enum Node {
    Leaf(Stored),
    Branch(Branch),
}

/// Two halves of a range of slots.
#[derive(Debug, Clone)]
struct Branch {
    halves: [Option<Arc<Node>>; 2],
    /// Landmarks below.
    count: usize,
    low_m: [f64; 2],
    high_m: [f64; 2],
}

impl Node {
    fn count(&self) -> usize {
        match self {
            Self::Leaf(_) => 1,
            Self::Branch(branch) => branch.count,
        }
    }

    fn extent(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Leaf(stored) => [stored.at_m; 2],
            Self::Branch(branch) => [branch.low_m, branch.high_m],
        }
    }
}

impl Branch {
    fn of(halves: [Option<Arc<Node>>; 2]) -> Self {
        let mut branch = Self { halves, count: 0, low_m: [f64::INFINITY; 2], high_m: [f64::NEG_INFINITY; 2] };
        branch.sum_up();
        branch
    }

    fn sum_up(&mut self) {
        (self.count, self.low_m, self.high_m) = (0, [f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for half in self.halves.iter().flatten() {
            let [low, high] = half.extent();
            self.count += half.count();
            for k in 0..2 {
                self.low_m[k] = self.low_m[k].min(low[k]);
                self.high_m[k] = self.high_m[k].max(high[k]);
            }
        }
    }
}

impl Tree {
    /// Number of landmarks.
    pub(crate) fn len(&self) -> usize {
        self.root.as_ref().map_or(0, |root| root.count())
    }

    /// The landmark of a slot. O(log landmarks).
    pub(crate) fn get(&self, slot: usize) -> Option<&Stored> {
        if slot >> self.height != 0 {
            return None;
        }
        let (mut node, mut level) = (self.root.as_deref()?, self.height);
        loop {
            match node {
                Node::Leaf(stored) => return Some(stored),
                Node::Branch(branch) => {
                    level -= 1;
                    node = branch.halves[slot >> level & 1].as_deref()?;
                }
            }
        }
    }

    /// Adds a landmark and gives its slot, the lowest that is free. O(log landmarks).
    pub(crate) fn add(&mut self, stored: Stored) -> usize {
        let slot = self.free();
        self.put(slot, stored);
        slot
    }

    /// Puts a landmark into a slot, in the place of one that is there. O(log slot).
    pub(crate) fn put(&mut self, slot: usize, stored: Stored) {
        while slot >> self.height != 0 {
            let root = self.root.take();
            self.root = root.map(|root| Arc::new(Node::Branch(Branch::of([Some(root), None]))));
            self.height += 1;
        }
        self.root = put(self.root.take(), self.height, slot, Some(stored));
    }

    /// Takes a landmark out. O(log landmarks).
    pub(crate) fn remove(&mut self, slot: usize) {
        debug_assert!(self.get(slot).is_some(), "there is one in slot {slot}");
        self.root = put(self.root.take(), self.height, slot, None);
    }

    /// The lowest slot without a landmark.
    fn free(&self) -> usize {
        let (mut node, mut level, mut slot) = (self.root.as_deref(), self.height, 0);
        while let Some(Node::Branch(branch)) = node {
            level -= 1;
            let full = branch.halves[0].as_deref().is_some_and(|half| half.count() >> level != 0);
            slot |= usize::from(full) << level;
            node = branch.halves[usize::from(full)].as_deref();
        }
        // A leaf is full; a tree whose every slot is taken grows.
        slot + usize::from(node.is_some())
    }

    /// Visits slot and landmark of all within a rectangle, m, in the order of slots.
    pub(crate) fn within(&self, [low_m, high_m]: [[f64; 2]; 2], mut visit: impl FnMut(usize, &Stored)) {
        let mut next: Vec<(&Node, u32, usize)> = self.root.iter().map(|root| (&**root, self.height, 0)).collect();
        while let Some((node, level, slot)) = next.pop() {
            let [low, high] = node.extent();
            if (0..2).any(|k| low[k] > high_m[k] || high[k] < low_m[k]) {
                continue;
            }
            match node {
                Node::Leaf(stored) => visit(slot, stored),
                Node::Branch(branch) => {
                    for half in [1, 0] {
                        if let Some(node) = branch.halves[half].as_deref() {
                            next.push((node, level - 1, slot | half << (level - 1)));
                        }
                    }
                }
            }
        }
    }

    /// All landmarks in the order of slots.
    pub(crate) fn all(&self) -> Vec<Stored> {
        let mut all = Vec::with_capacity(self.len());
        self.within([[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]], |_, stored| all.push(*stored));
        all
    }
}

/// The node with another content of a slot; nodes that others hold too are copied, and others changed in place.
fn put(node: Option<Arc<Node>>, level: u32, slot: usize, stored: Option<Stored>) -> Option<Arc<Node>> {
    if level == 0 {
        return stored.map(|stored| match node {
            Some(mut own) => {
                *Arc::make_mut(&mut own) = Node::Leaf(stored);
                own
            }
            None => Arc::new(Node::Leaf(stored)),
        });
    }
    let mut node = node.unwrap_or_else(|| Arc::new(Node::Branch(Branch::of([None, None]))));
    if let Node::Branch(branch) = Arc::make_mut(&mut node) {
        let half = &mut branch.halves[slot >> (level - 1) & 1];
        *half = put(half.take(), level - 1, slot, stored);
        branch.sum_up();
    }
    (node.count() > 0).then_some(node)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2};
    use proptest::prelude::*;
    use sensor::Pose;

    use super::*;

    fn stored(number: u32, at_m: [f64; 2]) -> Stored {
        let landmark = Landmark {
            number,
            identity: None,
            anchor: Pose::default(),
            mean: Vector2::new(0.1, f64::from(number)),
            covariance: Matrix2::identity(),
            log_odds: 0.0,
            seen_from_m: [0.0; 2],
            sightings: 1,
        };
        Stored { landmark, at_m }
    }

    #[derive(Debug, Clone)]
    enum Change {
        Add([f64; 2]),
        Replace(usize, [f64; 2]),
        Remove(usize),
        Copy,
    }

    fn change() -> impl Strategy<Value = Change> {
        let at = || prop::array::uniform2(-10.0f64..10.0);
        prop_oneof![
            4 => at().prop_map(Change::Add),
            2 => (any::<usize>(), at()).prop_map(|(slot, at)| Change::Replace(slot, at)),
            2 => any::<usize>().prop_map(Change::Remove),
            1 => Just(Change::Copy),
        ]
    }

    proptest! {
        /// A list that is copied in full is the oracle: copies that are made meanwhile keep what they held.
        #[test]
        fn shared_trees_are_full_copies_to_the_bit(changes in prop::collection::vec(change(), 1..120)) {
            let (mut tree, mut list): (Tree, Vec<Option<Stored>>) = (Tree::default(), Vec::new());
            let mut copies: Vec<(Tree, Vec<Option<Stored>>)> = Vec::new();
            for (number, change) in changes.iter().enumerate() {
                let taken: Vec<usize> = (0..list.len()).filter(|slot| list[*slot].is_some()).collect();
                match *change {
                    Change::Add(at) => {
                        let new = stored(number as u32, at);
                        let slot = tree.add(new);
                        let free = list.iter().position(Option::is_none).unwrap_or(list.len());
                        prop_assert_eq!(slot, free);
                        if slot == list.len() { list.push(Some(new)) } else { list[slot] = Some(new) }
                    }
                    Change::Replace(which, at) if !taken.is_empty() => {
                        let slot = taken[which % taken.len()];
                        let new = stored(number as u32, at);
                        tree.put(slot, new);
                        list[slot] = Some(new);
                    }
                    Change::Remove(which) if !taken.is_empty() => {
                        let slot = taken[which % taken.len()];
                        tree.remove(slot);
                        list[slot] = None;
                    }
                    Change::Copy => copies.push((tree.clone(), list.clone())),
                    Change::Replace(..) | Change::Remove(_) => {}
                }
            }
            copies.push((tree, list));
            for (tree, list) in &copies {
                let all: Vec<Stored> = list.iter().flatten().copied().collect();
                prop_assert_eq!(tree.all(), all);
                prop_assert_eq!(tree.len(), list.iter().flatten().count());
                for (slot, expected) in list.iter().enumerate() {
                    prop_assert_eq!(tree.get(slot), expected.as_ref());
                }
                prop_assert!(tree.get(list.len() + 1000).is_none());
                let window = [[-3.0, -4.0], [5.0, 2.0]];
                let mut found = Vec::new();
                tree.within(window, |slot, stored| found.push((slot, *stored)));
                let inside = |s: &Stored| (0..2).all(|k| window[0][k] <= s.at_m[k] && s.at_m[k] <= window[1][k]);
                let expected: Vec<(usize, Stored)> =
                    list.iter().enumerate().filter_map(|(k, s)| s.filter(inside).map(|s| (k, s))).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn a_change_copies_the_way_to_it_alone() {
        let mut tree = Tree::default();
        (0..1000).for_each(|k| assert_eq!(tree.add(stored(k, [f64::from(k), 0.0])), k as usize));
        let copy = tree.clone();
        tree.put(137, stored(5000, [1.0, 1.0]));
        fn shared(a: &Arc<Node>, b: &Arc<Node>) -> usize {
            if Arc::ptr_eq(a, b) {
                return 0;
            }
            match (&**a, &**b) {
                (Node::Branch(a), Node::Branch(b)) => {
                    1 + a
                        .halves
                        .iter()
                        .flatten()
                        .zip(b.halves.iter().flatten())
                        .map(|(a, b)| shared(a, b))
                        .sum::<usize>()
                }
                _ => 1,
            }
        }
        let copied = shared(tree.root.as_ref().expect("full"), copy.root.as_ref().expect("full"));
        assert_eq!(copied, 11, "a way of ten branches and a leaf for 1,000 landmarks");
        assert_eq!(copy.get(137).map(|s| s.landmark.number), Some(137));
    }
}
