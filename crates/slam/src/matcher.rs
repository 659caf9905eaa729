//! Matching a scan to surfaces, coarse to fine: the best pose of a lattice by branch and bound, then uphill from there.
//!
//! Bounds as Hess, Kohler, Rapp and Andor have them ("Real-time loop closure in 2D LIDAR SLAM", ICRA 2016, Section V): a square of
//! poses is worth at most what its readings are worth over squares of cells.

use sensor::Pose;

use crate::field::{Field, LEVELS};
use crate::frame::turned;
use crate::sight::End;

/// Where the readings of a scan ended.
pub(crate) type Ends = [End];

/// The poses among which a match is looked for, round a first one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) around: Pose,
    /// Half of the window along x and y, m, and of the headings, rad.
    pub(crate) half_m: f64,
    pub(crate) half_rad: f64,
    /// Standard deviations of the pose round the first one, m and rad.
    pub(crate) sigmas: [f64; 2],
    /// Nats that a reading on a surface is worth more than one on none.
    pub(crate) gain: f64,
}

/// A square of `2^level` offsets on a side, from one on, at one heading.
#[derive(Clone, Copy)]
struct Square {
    heading: usize,
    offset: [i32; 2],
    level: usize,
    bound: f64,
}

/// The poses of a lattice of cells and headings: every heading turns the farthest end by at most a cell.
struct Lattice<'a> {
    field: &'a Field,
    window: &'a Window,
    /// Cells from the first pose to the border of the window.
    cells: i32,
    headings: Vec<f64>,
    /// Ends of every heading, turned; m from the first place.
    ends: Vec<Vec<[f64; 2]>>,
    /// Their cells.
    places: Vec<Vec<[i32; 2]>>,
    /// What each counts for.
    shares: Vec<f64>,
}

impl<'a> Lattice<'a> {
    fn new(field: &'a Field, window: &'a Window, ends: &Ends) -> Self {
        let cell_m = field.cell_m();
        let farthest_m = ends.iter().map(|end| libm::hypot(end.at[0], end.at[1])).fold(1.0, f64::max);
        let each = libm::ceil(window.half_rad * farthest_m / cell_m).max(1.0);
        let step_rad = window.half_rad / each;
        let each = each as i32;
        let headings: Vec<f64> = (-each..=each).map(|k| f64::from(k) * step_rad).collect();
        let at = window.around.position_m();
        let turn = |heading: &f64| -> Vec<[f64; 2]> {
            let put = |end: &End| {
                let [x, y] = turned(end.at, window.around.theta_rad + heading);
                [at[0] + x, at[1] + y]
            };
            ends.iter().map(put).collect()
        };
        let shares = ends.iter().map(|end| end.share).collect();
        let ends: Vec<Vec<[f64; 2]>> = headings.iter().map(turn).collect();
        let places = ends.iter().map(|ends| ends.iter().map(|end| field.place(*end)).collect()).collect();
        let cells = libm::ceil(window.half_m / cell_m) as i32;
        Self { field, window, cells, headings, ends, places, shares }
    }

    /// The least that the poses of a square, or one, are off, in nats.
    fn least_off(&self, heading: usize, offset: [i32; 2], side: i32) -> f64 {
        let cell_m = self.field.cell_m();
        let [sigma_m, sigma_rad] = self.window.sigmas;
        let off = |from: i32| f64::from(if from > 0 { from } else { (from + side - 1).min(0) }) * cell_m / sigma_m;
        let [x, y] = offset.map(off);
        let turn = self.headings[heading] / sigma_rad;
        0.5 * (x * x + y * y + turn * turn)
    }

    fn square(&self, heading: usize, offset: [i32; 2], level: usize) -> Square {
        let places = &self.places[heading];
        let worth: f64 = self.counted(places, |at| self.field.bound_of([at[0] + offset[0], at[1] + offset[1]], level));
        let bound = self.window.gain * worth - self.least_off(heading, offset, 1 << level);
        Square { heading, offset, level, bound }
    }

    /// The sum over the ends of what is asked of each, as it counts.
    #[inline(always)]
    fn counted<T>(&self, ends: &[T], worth: impl Fn(&T) -> f64) -> f64 {
        ends.iter().zip(&self.shares).map(|(end, share)| share * worth(end)).sum()
    }

    /// What the pose at a heading and an offset is worth.
    fn worth(&self, heading: usize, offset: [i32; 2]) -> f64 {
        let shift = offset.map(|cells| f64::from(cells) * self.field.cell_m());
        let worth = self.counted(&self.ends[heading], |end| self.field.worth([end[0] + shift[0], end[1] + shift[1]]));
        self.window.gain * worth - self.least_off(heading, offset, 1)
    }

    fn inside(&self, offset: [i32; 2]) -> bool {
        offset.iter().all(|cells| cells.abs() <= self.cells)
    }

    fn pose(&self, heading: usize, offset: [i32; 2]) -> Pose {
        let around = self.window.around;
        let [x, y] = offset.map(|cells| f64::from(cells) * self.field.cell_m());
        Pose { x_m: around.x_m + x, y_m: around.y_m + y, theta_rad: around.theta_rad + self.headings[heading] }
    }

    /// The best pose, and what it is worth.
    fn best(&self) -> (Pose, f64) {
        let middle = self.headings.len() / 2;
        let mut best = (middle, [0; 2], self.worth(middle, [0; 2]));
        let side = 1 << (LEVELS - 1);
        let starts = || (-self.cells..=self.cells).step_by(side as usize);
        let mut open: Vec<Square> = (0..self.headings.len())
            .flat_map(|heading| starts().flat_map(move |y| starts().map(move |x| (heading, [x, y]))))
            .map(|(heading, offset)| self.square(heading, offset, LEVELS - 1))
            .filter(|square| square.bound > best.2)
            .collect();
        // The most promising last, as it is taken first.
        open.sort_by(|a, b| a.bound.total_cmp(&b.bound));
        while let Some(Square { heading, offset, level, bound }) = open.pop() {
            if bound <= best.2 {
                continue;
            }
            if level == 0 {
                let worth = self.worth(heading, offset);
                if worth > best.2 {
                    best = (heading, offset, worth);
                }
                continue;
            }
            let half = 1 << (level - 1);
            let mut parts: Vec<Square> = [[0, 0], [half, 0], [0, half], [half, half]]
                .map(|[x, y]| [offset[0] + x, offset[1] + y])
                .into_iter()
                .filter(|offset| self.inside(*offset))
                .map(|offset| self.square(heading, offset, level - 1))
                .filter(|part| part.bound > best.2)
                .collect();
            parts.sort_by(|a, b| a.bound.total_cmp(&b.bound));
            open.extend(parts);
        }
        (self.pose(best.0, best.1), best.2)
    }
}

/// The best pose of the lattice in a window: none in it is worth more.
pub(crate) fn coarse(field: &Field, window: &Window, ends: &Ends) -> Pose {
    Lattice::new(field, window, ends).best().0
}

/// Steps of the first round uphill, m and rad; each round halves them.
const FIRST_STEPS: [f64; 3] = [0.04, 0.04, 0.02];

/// Rounds: the last step is a millimetre and half a milliradian.
const ROUNDS: usize = 6;

/// Goes uphill from a pose along its own axes and its heading, by steps that get smaller; gives the end and its height.
pub(crate) fn uphill(from: Pose, height: impl Fn(Pose) -> f64) -> (Pose, f64) {
    let (mut at, mut most) = (from, height(from));
    let mut steps = FIRST_STEPS;
    for _ in 0..ROUNDS {
        // A valley can lead far; a round ends all the same.
        for _ in 0..24 {
            let tried = (0..6).map(|k| {
                let mut by = [0.0; 3];
                by[k / 2] = if k % 2 == 0 { steps[k / 2] } else { -steps[k / 2] };
                moved(at, by)
            });
            let heights = tried.map(|pose| (pose, height(pose)));
            let Some((pose, higher)) = heights.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, higher)| *higher > most)
            else {
                break;
            };
            (at, most) = (pose, higher);
        }
        steps = steps.map(|step| 0.5 * step);
    }
    (at, most)
}

/// A pose moved along its axes, m, and turned, rad.
pub(crate) fn moved(pose: Pose, [along, across, turn]: [f64; 3]) -> Pose {
    let [x, y] = turned([along, across], pose.theta_rad);
    Pose { x_m: pose.x_m + x, y_m: pose.y_m + y, theta_rad: pose.theta_rad + turn }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::field::Sharpness;
    use crate::surfaces::Surfaces;
    use grid::GridSpec;
    use mapper::{HitCount, HitCounter, Model};
    use proptest::prelude::*;
    use sensor::Laser;

    /// A field in which every surface counts.
    fn field(points: &[[f64; 2]]) -> Field {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 60, height: 60 };
        let mut surfaces = Surfaces::new(spec);
        points.iter().for_each(|at| surfaces.add(*at));
        let map = HitCounter::new(&Model::new(spec, Arc::new(Laser::default())), HitCount::GMAPPING);
        let sharpness = Sharpness { sigma_m: 0.05, occupied: 0.0, power: 1.0 };
        Field::new(&surfaces, &map, sharpness, [[1.0; 2], [5.0; 2]], true)
    }

    /// Ends of which some count for more than others.
    fn shared(ends: &[[f64; 2]]) -> Vec<End> {
        ends.iter().enumerate().map(|(k, at)| End { at: *at, share: 1.0 / (1 + k % 3) as f64 }).collect()
    }

    fn points(number: std::ops::Range<usize>, low: f64, high: f64) -> impl Strategy<Value = Vec<[f64; 2]>> {
        prop::collection::vec(prop::array::uniform2(low..high), number)
    }

    proptest! {
        #[test]
        fn the_nearest_surface_is_that_of_all(surfaces in points(1..60, 1.2, 4.8), at in prop::array::uniform2(1.3f64..4.7)) {
            let field = field(&surfaces);
            let means: Vec<[f64; 2]> = {
                let mut cells = std::collections::BTreeMap::<_, Vec<[f64; 2]>>::new();
                surfaces.iter().for_each(|s| cells.entry(s.map(|c| (c / 0.1).floor() as i64)).or_default().push(*s));
                cells.values().map(|list| [0, 1].map(|k| list.iter().map(|s| s[k]).sum::<f64>() / list.len() as f64)).collect()
            };
            let near = means.iter().filter(|mean| (0..2).all(|k| ((mean[k] / 0.1).floor() - (at[k] / 0.1).floor()).abs() < 1.5));
            let least = near.map(|mean| ((mean[0] - at[0]).powi(2) + (mean[1] - at[1]).powi(2)) / 0.0025).fold(f64::INFINITY, f64::min);
            let found = field.squared(at);
            prop_assert!(found.total_cmp(&least).is_eq() || (found - least).abs() < 1e-3 * (1.0 + least), "{} {}", found, least);
        }

        #[test]
        fn bounds_are_no_less_than_any_point_of_their_square(
            surfaces in points(1..40, 1.2, 4.8), corner in prop::array::uniform2(0i32..45), level in 0usize..LEVELS,
            within in prop::array::uniform2(0.0f64..1.0),
        ) {
            let field = field(&surfaces);
            let corner = corner.map(|c| c - 4);
            let side = f64::from(1 << level);
            let at = [0, 1].map(|k| field.origin_m()[k] + 0.1 * (f64::from(corner[k]) + side * within[k]));
            prop_assert!(field.bound_of(corner, level) + 1e-9 >= field.worth(at));
        }

        #[test]
        fn branch_and_bound_finds_the_best_of_all_poses(
            surfaces in points(5..50, 1.5, 4.5), ends in points(3..20, -1.2, 1.2), at in prop::array::uniform2(2.5f64..3.5),
            theta_rad in -3.0f64..3.0, sigma in 0.1f64..2.0,
        ) {
            let field = field(&surfaces);
            let around = Pose { x_m: at[0], y_m: at[1], theta_rad };
            let window = Window { around, half_m: 0.55, half_rad: 0.2, sigmas: [sigma, 0.2 * sigma], gain: 1.0 };
            let lattice = Lattice::new(&field, &window, &shared(&ends));
            let mut best = f64::NEG_INFINITY;
            for heading in 0..lattice.headings.len() {
                for x in -lattice.cells..=lattice.cells {
                    for y in -lattice.cells..=lattice.cells {
                        best = best.max(lattice.worth(heading, [x, y]));
                    }
                }
            }
            let (_, found) = lattice.best();
            prop_assert!(found.total_cmp(&best).is_eq(), "{} {}", found, best);
        }
    }

    #[test]
    fn uphill_ends_at_the_top() {
        let top = Pose { x_m: 0.13, y_m: -0.07, theta_rad: 0.05 };
        let height = |pose: Pose| {
            -(pose.x_m - top.x_m).powi(2)
                - 3.0 * (pose.y_m - top.y_m).powi(2)
                - (pose.theta_rad - top.theta_rad).powi(2)
        };
        let (pose, _) = uphill(Pose::default(), height);
        assert!(
            (pose.x_m - top.x_m).hypot(pose.y_m - top.y_m) < 0.003 && (pose.theta_rad - top.theta_rad).abs() < 0.002
        );
    }
}
