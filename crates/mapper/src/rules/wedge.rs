//! Wedges: the part of the plane that a ray of a scan speaks for, where rules take beams to be as wide as they are apart.

use std::ops::Range;

use grid::GridSpec;
use sensor::{Ray, Scan};

/// A ray is at most so wide to either side, rad.
const WIDEST_RAD: f64 = 0.5;

/// Half the width of a scan's only ray, rad: half a degree.
const LONE_RAD: f64 = 0.00873;

/// A ray with its width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wedge {
    pub(crate) ray: Ray,
    /// Angles from the ray to its borders, clockwise and counter-clockwise, rad; above 0.
    pub(crate) half_rad: [f64; 2],
    /// Unit vectors along them.
    borders: [[f64; 2]; 2],
}

/// The rays of a scan in its order, each reaching half way to its neighbours in bearing; the first and the last are as wide to
/// the outside, and none is wider to one side than twice what it is to the other, so that it does not fill a blind sector.
pub(crate) fn wedges(scan: &Scan) -> Vec<Wedge> {
    let mut bearings = scan.bearings_rad.clone();
    bearings.sort_by(f64::total_cmp);
    bearings.dedup();
    let half = |bearing: f64| {
        let at = bearings.partition_point(|other| *other < bearing);
        let below = at.checked_sub(1).map(|k| bearing - bearings[k]);
        let above = bearings.get(at + 1).map(|other| other - bearing);
        let (below, above) = match (below, above) {
            (Some(below), Some(above)) => (below, above),
            (Some(gap), None) | (None, Some(gap)) => (gap, gap),
            (None, None) => return [LONE_RAD; 2],
        };
        let most = 2.0 * below.min(above);
        [below, above].map(|gap| (0.5 * gap.min(most)).min(WIDEST_RAD))
    };
    scan.rays().map(|ray| Wedge::new(ray, half(ray.bearing_rad))).collect()
}

impl Wedge {
    fn new(ray: Ray, half_rad: [f64; 2]) -> Self {
        let ([clockwise, counter], [x, y]) = (half_rad, ray.direction);
        let borders = [-clockwise, counter].map(|angle| {
            let (sin, cos) = libm::sincos(angle);
            [x * cos - y * sin, x * sin + y * cos]
        });
        Self { ray, half_rad, borders }
    }

    /// The points of its two borders at a range (m), clockwise and counter-clockwise.
    pub(crate) fn ends(&self, range_m: f64) -> [[f64; 2]; 2] {
        self.borders.map(|border| [0, 1].map(|axis| self.ray.origin_m[axis] + range_m * border[axis]))
    }

    /// Whether a vector from the origin points between the borders; the counter-clockwise one is outside, so that no
    /// point belongs to two neighbours.
    pub(crate) fn holds(&self, [dx, dy]: [f64; 2]) -> bool {
        let [clockwise, counter] = self.borders.map(|[x, y]| x * dy - y * dx);
        let [x, y] = self.ray.direction;
        clockwise >= 0.0 && counter < 0.0 && x * dx + y * dy > 0.0
    }
}

/// Calls `visit` with every row of the grid that meets a triangle (m), and with those of its columns that do. O(rows).
pub(crate) fn cells_of_triangle(spec: &GridSpec, corners: [[f64; 2]; 3], mut visit: impl FnMut(usize, Range<usize>)) {
    let in_cells = |point: [f64; 2]| [0, 1].map(|axis| (point[axis] - spec.origin_m[axis]) / spec.cell_m);
    let corners = corners.map(in_cells);
    let [bottom, top] = ends(corners.iter().map(|corner| corner[1]));
    if !(top >= 0.0 && bottom < spec.height as f64) {
        return;
    }
    let last = (top.floor() as usize).min(spec.height - 1);
    for row in bottom.max(0.0).floor() as usize..=last {
        let [left, right] = across(&corners, row as f64);
        if left <= right && right >= 0.0 && left < spec.width as f64 {
            visit(row, left.max(0.0).floor() as usize..(right.floor() as usize).min(spec.width - 1) + 1);
        }
    }
}

/// From where to where, along x, a triangle reaches in the row `from ..= from + 1`.
fn across(corners: &[[f64; 2]; 3], from: f64) -> [f64; 2] {
    let to = from + 1.0;
    let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
    let mut reach = |x: f64| (least, most) = (if x < least { x } else { least }, if x > most { x } else { most });
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        if (from..=to).contains(&a[1]) {
            reach(a[0]);
        }
        if (a[1] < from && b[1] < from) || (a[1] > to && b[1] > to) {
            continue;
        }
        for y in [from, to] {
            let share = (y - a[1]) / (b[1] - a[1]);
            if (0.0..=1.0).contains(&share) {
                reach(a[0] + share * (b[0] - a[0]));
            }
        }
    }
    [least, most]
}

/// The least and the largest.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sensor::Pose;

    const SPEC: GridSpec = GridSpec { cell_m: 0.1, origin_m: [-0.5, 0.3], width: 20, height: 17 };

    /// Whether a square of side `s` about `c` and a triangle have a separating line, and by how much: its sides and theirs.
    fn gap(centre: [f64; 2], half: f64, corners: &[[f64; 2]; 3]) -> f64 {
        let edges = [0, 1, 2].map(|k| [0, 1].map(|a| corners[(k + 1) % 3][a] - corners[k][a]));
        let normals = edges.map(|[x, y]| [-y, x]).into_iter().chain([[1.0, 0.0], [0.0, 1.0]]);
        let gaps = normals.map(|[nx, ny]| {
            let length = nx.hypot(ny);
            let at = |p: [f64; 2]| (p[0] * nx + p[1] * ny) / length;
            let [low, high] = ends(corners.iter().map(|p| at(*p)));
            let (middle, reach) = (at(centre), half * (nx.abs() + ny.abs()) / length);
            (low - (middle + reach)).max(middle - reach - high)
        });
        gaps.fold(f64::NEG_INFINITY, f64::max)
    }

    proptest! {
        /// All cells by separating lines.
        #[test]
        fn cells_are_those_that_touch(corners in prop::array::uniform3(prop::array::uniform2(-1.0f64..2.6))) {
            let area = (corners[1][0] - corners[0][0]) * (corners[2][1] - corners[0][1])
                - (corners[1][1] - corners[0][1]) * (corners[2][0] - corners[0][0]);
            prop_assume!(area.abs() > 1e-3);
            let mut met = vec![0; SPEC.cells()];
            cells_of_triangle(&SPEC, corners, |row, columns| columns.for_each(|column| met[SPEC.index(column, row)] += 1));
            for (cell, met) in met.into_iter().enumerate() {
                let gap = gap(SPEC.centre(cell), 0.05, &corners);
                if gap.abs() > 1e-9 {
                    prop_assert_eq!(met, i32::from(gap < 0.0), "cell {} {}", cell, gap);
                }
            }
        }

        /// Every direction between the first and the last ray belongs to one of them, the nearest.
        #[test]
        fn wedges_tile_what_a_camera_sees(at in -0.49f64..0.49, theta_rad in -4.0f64..4.0) {
            let bearings_rad: Vec<f64> = (-10..=10).map(|k| (0.0546 * f64::from(k)).atan()).collect();
            let pose = Pose { x_m: 0.2, y_m: 0.9, theta_rad };
            let scan = Scan { pose, readings: vec![None; 21], bearings_rad: bearings_rad.clone(), ..Scan::default() };
            let towards = pose.direction(at);
            let holding: Vec<usize> =
                wedges(&scan).iter().enumerate().filter(|(_, w)| w.holds(towards)).map(|(k, _)| k).collect();
            let distance = |k: &usize| (bearings_rad[*k] - at).abs();
            let mut order: Vec<usize> = (0..21).collect();
            order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            prop_assume!(distance(&order[1]) - distance(&order[0]) > 1e-9);
            prop_assert_eq!(holding, &order[..1]);
        }
    }

    #[test]
    fn widths_are_half_the_gaps_and_blind_sectors_stay_blind() {
        let wide = |bearings: &[f64]| -> Vec<[f64; 2]> {
            let scan =
                Scan { bearings_rad: bearings.to_vec(), readings: vec![None; bearings.len()], ..Scan::default() };
            wedges(&scan).iter().map(|wedge| wedge.half_rad).collect()
        };
        let near = |a: &[[f64; 2]], b: &[[f64; 2]]| {
            assert!(a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
        };
        near(&wide(&[0.0, 0.1, 0.2]), &[[0.05; 2]; 3]);
        near(&wide(&[0.2, 0.0, 0.1]), &[[0.05; 2]; 3]);
        near(&wide(&[0.0, 0.1, 0.1]), &[[0.05; 2]; 3]);
        near(&wide(&[0.0, 0.1, 2.0]), &[[0.05, 0.05], [0.05, 0.1], [0.5, 0.5]]);
        near(&wide(&[0.3]), &[[LONE_RAD; 2]]);
    }
}
