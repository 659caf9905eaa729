//! Frames and the transforms between them, by time.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::turn::Motion;
use crate::report::Gap;

/// At the time of a transform, s, there is no gap.
const AT_STAMP_S: f64 = 1e-3;

/// A frame in another, over time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Edge {
    pub(super) parent: String,
    pub(super) child: String,
    /// Whether the transform holds at all times.
    pub(super) is_static: bool,
    /// In the order of times, s, which differ; at least one.
    stamps: Vec<(f64, Motion)>,
    /// Whether all of them are the same.
    is_constant: bool,
}

/// What is known of a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Known {
    Here(Motion),
    /// What is known before and after is too far apart.
    Gap(Gap),
    /// Nothing is known before, or after.
    Outside,
}

impl Edge {
    /// Of transforms with their times, s, in any order; none without one. Of a static one the last holds.
    pub(super) fn new(parent: &str, child: &str, is_static: bool, mut stamps: Vec<(f64, Motion)>) -> Option<Self> {
        if is_static {
            stamps = vec![*stamps.last()?];
        }
        stamps.sort_by(|a, b| a.0.total_cmp(&b.0));
        stamps.dedup_by(|later, kept| {
            let same = later.0.total_cmp(&kept.0).is_eq();
            if same {
                kept.1 = later.1; // what was said last
            }
            same
        });
        let first = stamps.first()?.1;
        let is_constant = stamps.iter().all(|(_, motion)| *motion == first);
        Some(Self { parent: parent.to_owned(), child: child.to_owned(), is_static, stamps, is_constant })
    }

    /// First and last time, s.
    pub(super) fn span_s(&self) -> [f64; 2] {
        [self.stamps[0].0, self.stamps[self.stamps.len() - 1].0]
    }

    /// How many transforms there are.
    pub(super) fn len(&self) -> usize {
        self.stamps.len()
    }

    /// Whether it tells where something goes: it is no mount that is said again and again.
    pub(super) fn moves(&self) -> bool {
        !self.is_static && !self.is_constant
    }

    /// The child in the parent at a time, s. What never changes holds at all times; gaps of more than `max_gap_s` are not bridged.
    pub(super) fn at(&self, time_s: f64, max_gap_s: f64) -> Known {
        if self.is_constant {
            return Known::Here(self.stamps[0].1);
        }
        let after = self.stamps.partition_point(|(stamp, _)| *stamp <= time_s);
        let Some((before_s, before)) = after.checked_sub(1).map(|k| self.stamps[k]) else { return Known::Outside };
        let Some((after_s, after)) = self.stamps.get(after).copied() else {
            return if time_s <= before_s { Known::Here(before) } else { Known::Outside };
        };
        let long_s = after_s - before_s;
        if time_s - before_s <= 0.0 {
            return Known::Here(before);
        }
        if long_s > max_gap_s + AT_STAMP_S && before != after {
            return match (time_s - before_s, after_s - time_s) {
                (since, _) if since <= AT_STAMP_S => Known::Here(before),
                (_, until) if until <= AT_STAMP_S => Known::Here(after),
                _ => Known::Gap(Gap { from_s: before_s, long_s }),
            };
        }
        Known::Here(before.towards(&after, (time_s - before_s) / long_s))
    }
}

/// All frames of a bag.
#[derive(Debug, Clone, Default)]
pub(super) struct Frames {
    edges: Vec<Edge>,
    /// Of every frame, its edges.
    of: BTreeMap<String, Vec<usize>>,
}

/// A step from a frame to another: which edge, and whether from its child to its parent.
pub(super) type Step = (usize, bool);

impl Frames {
    pub(super) fn new(edges: Vec<Edge>) -> Self {
        let mut of: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (number, edge) in edges.iter().enumerate() {
            for frame in [&edge.parent, &edge.child] {
                of.entry(frame.clone()).or_default().push(number);
            }
        }
        Self { edges, of }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    pub(super) fn has(&self, frame: &str) -> bool {
        self.of.contains_key(frame)
    }

    pub(super) fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The shortest way from a frame to another; of those, one of mounts. None where they are not connected.
    pub(super) fn way(&self, from: &str, to: &str) -> Option<Vec<Step>> {
        self.way_by(from, to, &|_| true)
    }

    fn way_by(&self, from: &str, to: &str, takes: &dyn Fn(&Edge) -> bool) -> Option<Vec<Step>> {
        if from == to {
            return Some(Vec::new());
        }
        let mut came: BTreeMap<&str, (&str, Step)> = BTreeMap::new();
        let mut next = VecDeque::from([from]);
        while let Some(frame) = next.pop_front() {
            for &number in self.of.get(frame).into_iter().flatten() {
                let edge = &self.edges[number];
                let is_up = edge.child == frame;
                let other = if is_up { edge.parent.as_str() } else { edge.child.as_str() };
                if other == from || came.contains_key(other) || !takes(edge) {
                    continue;
                }
                came.insert(other, (frame, (number, is_up)));
                next.push_back(other);
            }
        }
        let mut way = Vec::new();
        let mut at = to;
        while at != from {
            let (before, step) = came.get(at)?;
            way.push(*step);
            at = before;
        }
        way.reverse();
        Some(way)
    }

    /// Frames above a frame, from the nearest on.
    pub(super) fn above(&self, frame: &str) -> Vec<&Edge> {
        let mut all: Vec<&Edge> = Vec::new();
        let mut seen = BTreeSet::from([frame]);
        let mut at = frame;
        while let Some(edge) =
            self.of.get(at).into_iter().flatten().map(|number| &self.edges[*number]).find(|edge| edge.child == at)
        {
            if !seen.insert(&edge.parent) {
                break;
            }
            all.push(edge);
            at = &edge.parent;
        }
        all
    }

    /// The frame of the robot, on which a frame is mounted: by its usual names, else the highest one that does not move against it.
    pub(super) fn base(&self, frame: &str) -> String {
        let mut base = frame;
        for edge in self.above(frame) {
            if edge.moves() {
                break;
            }
            base = &edge.parent;
            if ["base_link", "base_footprint"].contains(&base) {
                break;
            }
        }
        base.to_owned()
    }

    /// Where the last frame of a way stands in the first, at a time, s.
    pub(super) fn at(&self, way: &[Step], time_s: f64, max_gap_s: f64) -> Known {
        let mut whole = Motion::NONE;
        for (number, is_up) in way {
            match self.edges[*number].at(time_s, max_gap_s) {
                Known::Here(motion) if *is_up => whole = whole.then(&motion.inverse()),
                Known::Here(motion) => whole = whole.then(&motion),
                unknown => return unknown,
            }
        }
        Known::Here(whole)
    }

    /// All transforms by name, for messages: a few of them.
    pub(super) fn described(&self) -> String {
        let mut names: Vec<String> =
            self.edges.iter().take(5).map(|edge| format!("{} > {}", edge.parent, edge.child)).collect();
        if self.edges.len() > names.len() {
            names.push(format!("{} more", self.edges.len() - names.len()));
        }
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use sensor::Pose;

    use super::*;

    fn flat(x_m: f64, y_m: f64, theta_rad: f64) -> Motion {
        Motion::flat(Pose { x_m, y_m, theta_rad })
    }

    fn frames() -> Frames {
        let turn = std::f64::consts::FRAC_PI_2;
        let edge =
            |parent: &str, child: &str, is_static, stamps| Edge::new(parent, child, is_static, stamps).expect("stamps");
        Frames::new(vec![
            edge(
                "odom",
                "base_link",
                false,
                vec![(2.0, flat(2.0, 0.0, turn)), (1.0, flat(1.0, 0.0, turn)), (9.0, flat(3.0, 0.0, turn))],
            ),
            edge("base_link", "laser", true, vec![(0.0, flat(9.0, 9.0, 0.0)), (0.0, flat(0.5, 0.0, 0.0))]),
            edge(
                "map",
                "odom",
                false,
                vec![(0.0, flat(10.0, 0.0, 0.0)), (5.0, flat(10.0, 0.0, 0.0)), (9.0, flat(11.0, 0.0, 0.0))],
            ),
        ])
    }

    fn at(frames: &Frames, from: &str, to: &str, time_s: f64) -> Known {
        frames.at(&frames.way(from, to).expect("connected"), time_s, 1.0)
    }

    #[test]
    fn transforms_are_put_together_and_interpolated() {
        let frames = frames();
        let Known::Here(found) = at(&frames, "odom", "laser", 1.5) else { panic!("known") };
        assert!((found.at_m[0] - 1.5).abs() < 1e-12 && (found.at_m[1] - 0.5).abs() < 1e-12, "{found:?}");
        // The way back is the inverse.
        let Known::Here(back) = at(&frames, "laser", "odom", 1.5) else { panic!("known") };
        assert!(found.then(&back).at_m.iter().all(|at| at.abs() < 1e-12));
        // What stands still over a long time is known in between.
        let Known::Here(found) = at(&frames, "map", "laser", 2.0) else { panic!("known") };
        assert!((found.at_m[0] - 12.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn nothing_is_guessed_outside_and_in_gaps() {
        let frames = frames();
        assert_eq!(at(&frames, "odom", "laser", 0.5), Known::Outside);
        assert_eq!(at(&frames, "odom", "laser", 9.5), Known::Outside);
        assert_eq!(at(&frames, "odom", "laser", 5.0), Known::Gap(Gap { from_s: 2.0, long_s: 7.0 }));
        assert!(frames.way("odom", "camera").is_none());
    }

    #[test]
    fn the_robot_is_what_the_sensor_does_not_move_against() {
        let frames = frames();
        assert_eq!(frames.base("laser"), "base_link");
        assert_eq!(frames.base("unknown"), "unknown");
        let above: Vec<_> = frames.above("laser").iter().map(|edge| edge.parent.as_str()).collect();
        assert_eq!(above, ["base_link", "odom", "map"]);
        let circle = Frames::new(vec![
            Edge::new("a", "b", true, vec![(0.0, Motion::NONE)]).expect("one"),
            Edge::new("b", "a", true, vec![(0.0, Motion::NONE)]).expect("one"),
        ]);
        assert_eq!(circle.above("a").len(), 1);
    }
}
