//! Where behind the face of its first occupied cell a ray meets the surface.

/// A ray over a map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course<'a> {
    /// Ranges (m) at which it crosses from cell to cell, one more than cells.
    pub(super) ranges_m: &'a [f64],
    /// Unit vector.
    pub(super) direction: [f64; 2],
    /// Side of a cell, m.
    pub(super) cell_m: f64,
}

/// Where rays meet surfaces. A buffer to fill again and again.
#[derive(Debug, Clone, Default)]
pub(super) struct Surface {
    /// Integral of the likelihood along the ray, up to where each cell is entered.
    sums: Vec<f64>,
}

impl Surface {
    /// `P(o | first occupied cell)` of every cell of a ray, per unit of the reading, from `P(o | F_k)`, that of a surface somewhere on the
    /// chord of the cell, and that of a ray which hits nothing. `is_beside` says of a cell but the first whether the ray enters it from the
    /// column beside, else it does from a row. O(cells).
    ///
    /// A cell is occupied where an obstacle covers any part of it: the surface lies up to one side of a cell behind the face through which
    /// the ray enters, at a depth of which nothing is known, and is taken to be parallel to it. A ray with direction `d` is on its way through
    /// this depth for up to `cell_m / |n d|` metres, `n` the normal of the face; the likelihood is the mean over these. Head on that is about
    /// one cell; a ray that grazes a wall passes many cells of which the wall covers a part. Nothing is known of the face of the sensor's own
    /// cell, whose chord counts.
    pub(super) fn likelihoods(
        &mut self,
        course: &Course,
        is_beside: impl Fn(usize) -> bool,
        likelihood: &[f64],
        none: f64,
        met: &mut Vec<f64>,
    ) {
        let &Course { ranges_m, direction, cell_m } = course;
        let sums = &mut self.sums;
        sums.clear();
        let mut sum = 0.0;
        sums.push(sum);
        for (l, chord) in likelihood.iter().zip(ranges_m.windows(2)) {
            sum += l * (chord[1] - chord[0]);
            sums.push(sum);
        }
        let depth_m = direction.map(|slope| cell_m / slope.abs());
        // The cell in which the depth behind faces of each kind ended last: it never falls from one face to the next.
        let mut reached = [0; 2];
        met.clear();
        met.push(likelihood[0]);
        for cell in 1..likelihood.len() {
            let axis = usize::from(!is_beside(cell));
            let until_m = ranges_m[cell] + depth_m[axis];
            let end = &mut reached[axis];
            *end = cell.max(*end);
            while *end < likelihood.len() && ranges_m[*end + 1] <= until_m {
                *end += 1;
            }
            let beyond = likelihood.get(*end).copied().unwrap_or(none);
            let upto = sums[*end] + (until_m - ranges_m[*end]) * beyond;
            met.push((upto - sums[cell]) / depth_m[axis]);
        }
    }
}

#[cfg(test)]
mod tests {
    use grid::{DigitalLine, GridSpec};

    use super::*;

    const SPEC: GridSpec = GridSpec { cell_m: 0.1, origin_m: [-0.3, 0.2], width: 12, height: 9 };

    /// A ray in a direction (rad), a likelihood that varies from cell to cell, and the mean of it over depths.
    fn met(angle: f64, of: impl Fn(usize) -> f64, none: f64) -> (DigitalLine, [f64; 2], Vec<f64>, Vec<f64>) {
        let (mut line, direction) = (DigitalLine::default(), [angle.cos(), angle.sin()]);
        line.trace(&SPEC, [0.234, 0.611], direction, f64::INFINITY);
        let likelihood: Vec<f64> = (0..line.len()).map(of).collect();
        let column = |cell: usize| SPEC.column_row(line.cells()[cell]).0;
        let course = Course { ranges_m: line.ranges(), direction, cell_m: SPEC.cell_m };
        let mut met = vec![9.9; 3];
        Surface::default().likelihoods(&course, |cell| column(cell) != column(cell - 1), &likelihood, none, &mut met);
        (line, direction, likelihood, met)
    }

    /// Point by point: the cell in which a surface is at so many depths behind the face, found by its place in the plane.
    #[test]
    fn it_is_the_mean_over_depths() {
        for step in 0..40 {
            let angle = 0.05 + 0.161 * f64::from(step);
            let (line, direction, likelihood, met) = met(angle, |cell| 1.0 + (cell as f64 * 12.9898).sin(), 0.3);
            assert_eq!(met.len(), line.len());
            assert!((met[0] - likelihood[0]).abs() < 1e-15);
            for (cell, met) in met.iter().enumerate().skip(1) {
                let [now, before] = [cell, cell - 1].map(|cell| SPEC.column_row(line.cells()[cell]));
                let slope = direction[usize::from(now.0 == before.0)].abs();
                let depths = 20_000;
                let mean = (0..depths).map(|depth| {
                    let range_m =
                        line.ranges()[cell] + (f64::from(depth) + 0.5) / f64::from(depths) * SPEC.cell_m / slope;
                    let there = SPEC.locate([0.234 + range_m * direction[0], 0.611 + range_m * direction[1]]);
                    there
                        .and_then(|there| line.cells().iter().position(|&cell| cell == there))
                        .map_or(0.3, |at| likelihood[at])
                });
                let mean = mean.sum::<f64>() / f64::from(depths);
                assert!((met - mean).abs() < 3e-3, "{angle} rad, cell {cell}: {met} {mean}");
            }
        }
    }

    /// Head on, the depths are those of the chord; what is the same everywhere is so for all surfaces; a grazing ray is asked about many cells.
    #[test]
    fn it_depends_on_the_angle() {
        let (_, _, likelihood, head_on) = met(0.0, |cell| 1.0 + cell as f64, 0.3);
        for (l, met) in likelihood.iter().zip(&head_on) {
            assert!((l - met).abs() < 1e-9, "{l} {met}");
        }
        assert!(met(0.9, |_| 0.7, 0.7).3.iter().all(|met| (met - 0.7).abs() < 1e-12));
        // The ray grazes the face of the next row: of the way through it, only the first chord is in the first of its cells.
        let angle = 0.2f64.atan();
        let rows: Vec<usize> = met(angle, |_| 0.0, 0.0).0.cells().iter().map(|&cell| SPEC.column_row(cell).1).collect();
        let up = (1..rows.len()).find(|&cell| rows[cell] != rows[cell - 1]).expect("it crosses into the next row");
        let (line, direction, _, grazing) = met(angle, |cell| if cell <= up { 1.0 } else { 0.0 }, 0.0);
        let share = (line.ranges()[up + 1] - line.ranges()[up]) * direction[1] / SPEC.cell_m;
        assert!(share < 0.2 && (grazing[up] - share).abs() < 1e-12, "{}: {share}", grazing[up]);
    }
}
