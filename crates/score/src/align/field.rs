//! Maps as fields: values with weights, at any cell size.

use grid::{Frame, GridSpec, NoMemory, Raster};

/// A value and its weight in every cell; a weight is 0 where nothing is known and 1 where all is.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) frame: Frame,
    /// Products of value and weight.
    pub(super) sums: Vec<f32>,
    pub(super) weights: Vec<f32>,
}

impl Field {
    /// The cells of a raster, `factor` x `factor` of them taken together.
    pub(super) fn of<T>(
        raster: &Raster<T>,
        frame: &Frame,
        factor: usize,
        value: impl Fn(&T) -> Option<f32>,
    ) -> Result<Self, NoMemory> {
        let spec = raster.spec();
        let size = [spec.width, spec.height].map(|n| n.div_ceil(factor));
        let coarse =
            GridSpec { cell_m: frame.spec.cell_m * factor as f64, width: size[0], height: size[1], ..frame.spec };
        let mut field = Self {
            frame: Frame { spec: coarse, ..*frame },
            sums: Raster::try_filled(coarse, 0.0_f32)?.values().to_vec(),
            weights: Raster::try_filled(coarse, 0.0_f32)?.values().to_vec(),
        };
        let share = 1.0 / (factor * factor) as f32;
        for (row, cells) in raster.values().chunks(spec.width).enumerate() {
            let first = row / factor * size[0];
            for (column, cell) in cells.iter().enumerate() {
                if let Some(value) = value(cell) {
                    field.sums[first + column / factor] += share * value;
                    field.weights[first + column / factor] += share;
                }
            }
        }
        Ok(field)
    }

    /// Value times weight, and weight, at a point in cells from the lower-left corner: bilinear between the centres of cells. Beyond
    /// the border the weight is 0.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> (f32, f32) {
        let (u, v) = (u - 0.5, v - 0.5);
        let (column, row) = (u.floor(), v.floor());
        let (right, up) = ((u - column) as f32, (v - row) as f32);
        let [width, height] = [self.frame.spec.width as f64, self.frame.spec.height as f64];
        if column < -1.0 || row < -1.0 || column >= width || row >= height {
            return (0.0, 0.0);
        }
        let (mut sum, mut weight) = (0.0, 0.0);
        for (dx, dy, share) in [
            (0.0, 0.0, (1.0 - right) * (1.0 - up)),
            (1.0, 0.0, right * (1.0 - up)),
            (0.0, 1.0, (1.0 - right) * up),
            (1.0, 1.0, right * up),
        ] {
            let (x, y) = (column + dx, row + dy);
            if x >= 0.0 && y >= 0.0 && x < width && y < height {
                let cell = self.frame.spec.index(x as usize, y as usize);
                sum += share * self.sums[cell];
                weight += share * self.weights[cell];
            }
        }
        (sum, weight)
    }
}

/// Half the width of the kernel of [`blur`], cells.
const REACH: usize = 3;

/// Smooths a raster of so many columns by a Gaussian of one cell, which is cut at three; beyond the border there is nothing.
pub(super) fn blur(values: &mut [f32], width: usize, spare: &mut Vec<f32>) {
    let kernel = kernel();
    let height = values.len() / width.max(1);
    spare.clear();
    spare.resize(values.len(), 0.0);
    for (row, out) in values.chunks(width).zip(spare.chunks_mut(width)) {
        for (k, share) in kernel.iter().enumerate() {
            let (from, to) = (k.saturating_sub(REACH).min(width), REACH.saturating_sub(k).min(width));
            let count = width - from.max(to);
            for (out, value) in out[to..to + count].iter_mut().zip(&row[from..from + count]) {
                *out += share * value;
            }
        }
    }
    values.iter_mut().for_each(|value| *value = 0.0);
    for row in 0..height {
        for (k, share) in kernel.iter().enumerate() {
            let Some(from) = (row + k).checked_sub(REACH).filter(|from| *from < height) else { continue };
            let source = &spare[from * width..(from + 1) * width];
            for (out, value) in values[row * width..(row + 1) * width].iter_mut().zip(source) {
                *out += share * value;
            }
        }
    }
}

/// A Gaussian of one cell, whose sum is 1.
fn kernel() -> [f32; 2 * REACH + 1] {
    let raw: [f64; 2 * REACH + 1] =
        std::array::from_fn(|k| libm::exp(-0.5 * (k as f64 - REACH as f64) * (k as f64 - REACH as f64)));
    let sum: f64 = raw.iter().sum();
    raw.map(|share| (share / sum) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn cells_taken_together_know_how_much_they_know() {
        let spec = GridSpec { cell_m: 0.5, origin_m: [1.0, 2.0], width: 3, height: 2 };
        let raster = Raster::new(spec, vec![Some(1.0), Some(0.0), Some(0.5), None, Some(1.0), None]);
        let field = Field::of(&raster, &Frame::straight(spec), 2, |cell| *cell).expect("memory");
        assert_eq!((field.frame.spec.width, field.frame.spec.height), (2, 1));
        assert_eq!((field.sums, field.weights), (vec![0.5, 0.125], vec![0.75, 0.25]));
    }

    #[test]
    fn between_centres_it_is_linear_and_beyond_the_border_nothing() {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 2, height: 2 };
        let raster = Raster::new(spec, vec![Some(0.0_f32), Some(1.0), Some(1.0), Some(2.0)]);
        let field = Field::of(&raster, &Frame::straight(spec), 1, |cell| *cell).expect("memory");
        assert_eq!(field.at([1.0, 1.0]), (1.0, 1.0));
        assert_eq!(field.at([1.5, 0.5]), (1.0, 1.0));
        assert_eq!(field.at([2.0, 0.5]), (0.5, 0.5));
        assert_eq!(field.at([-0.6, 0.5]), (0.0, 0.0));
    }

    proptest! {
        #[test]
        fn the_blur_is_the_sum_over_all_cells(width in 1_usize..9, height in 1_usize..9, seed in prop::collection::vec(0.0_f32..1.0, 64)) {
            let mut values: Vec<f32> = seed[..width * height].to_vec();
            let before = values.clone();
            blur(&mut values, width, &mut Vec::new());
            let kernel = kernel();
            let share = |a: usize, b: usize| if a.abs_diff(b) <= REACH { kernel[a + REACH - b] } else { 0.0 };
            for y in 0..height {
                for x in 0..width {
                    let all = (0..width * height).map(|k| share(x, k % width) * share(y, k / width) * before[k]);
                    prop_assert!((all.sum::<f32>() - values[y * width + x]).abs() < 1e-5);
                }
            }
        }
    }
}
