//! The sensor kernel over range and disparity: the paper's Figure 7.

use crate::figures::axis::{Axis, Tick};
use crate::figures::drawing::Anchor;
use crate::figures::ink::{Colour, FAINT, INK, LABEL, SMALL};
use crate::figures::{Drawing, Paper, letters};

/// The kernel on a grid: `density[row][column]` in 1/px.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kernel {
    /// Range at the right border, m; the left one is the sensor.
    pub far_m: f64,
    /// Disparity at the upper border, px; the lower one is 0.
    pub max_disparity: f64,
    /// Rows from the lowest disparity up, columns from the sensor on.
    pub density: Vec<Vec<f64>>,
}

/// Size of the picture, and the room about the kernel.
const SIZE: (f64, f64) = (1100.0, 700.0);
const LEFT: f64 = 84.0;
const RIGHT: f64 = 140.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = 70.0;

/// Width of the colour bar, and its steps.
const BAR: f64 = 24.0;
const STEPS: usize = 128;

/// Anchors of viridis (Smith and van der Walt 2015): as bright as they are high, for every eye.
const SCALE: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];

/// Colour of a share of the scale, 0 to 1, in so many steps.
fn colour(share: f64) -> Colour {
    let share = (share.clamp(0.0, 1.0) * STEPS as f64).round() / STEPS as f64;
    let at = share * (SCALE.len() - 1) as f64;
    let first = (at as usize).min(SCALE.len() - 2);
    let [r, g, b] = std::array::from_fn(|i| {
        let (low, high) = (SCALE[first][i], SCALE[first + 1][i]);
        (low + (at - first as f64) * (high - low)).round() as u8
    });
    Colour(r, g, b)
}

/// Draws the kernel, with colours in equal steps of its logarithm.
pub(super) fn draw(title: &str, kernel: &Kernel, paper: &Paper) -> Drawing {
    let values = || kernel.density.iter().flatten().copied().filter(|l| *l > 0.0);
    let top = values().fold(f64::MIN_POSITIVE, f64::max);
    // Six powers of ten show all that matters where nothing is matched falsely.
    let bottom = values().fold(top, f64::min).max(1e-6 * top).min(0.5 * top);
    let scale = Axis::logarithmic("", bottom..top);
    let mut drawing = Drawing::new(paper.width(SIZE.0), SIZE.1);
    let (width, height) = (drawing.width - LEFT - RIGHT, SIZE.1 - TOP - BOTTOM);
    let rows = kernel.density.iter().rev();
    let colours = rows.flatten().map(|l| colour(if *l > 0.0 { scale.share(*l) } else { 0.0 })).collect();
    let columns = kernel.density.first().map_or(0, Vec::len);
    drawing.cells((LEFT, TOP), (width, height), columns, colours);
    let title = letters::cut(title, LABEL, drawing.width - LEFT);
    drawing.text(&title, (LEFT, 0.5 * TOP), LABEL, INK, Anchor::Start);
    axes(&mut drawing, kernel, (width, height));
    bar(&mut drawing, &scale, height);
    drawing
}

fn axes(drawing: &mut Drawing, kernel: &Kernel, (width, height): (f64, f64)) {
    let (base, line) = (TOP + height, FAINT.stroke(1.5));
    for Tick { at, label } in Axis::linear("", 0.0..kernel.far_m).ticks((width / 80.0) as usize) {
        let x = LEFT + at * width;
        drawing.line([(x, base), (x, base + 7.0)], line);
        drawing.text(&label, (x, base + 20.0), SMALL, INK, Anchor::Middle);
    }
    drawing.text("range, m", (LEFT + 0.5 * width, base + 50.0), SMALL, INK, Anchor::Middle);
    for Tick { at, label } in Axis::linear("", 0.0..kernel.max_disparity).ticks((height / 70.0) as usize) {
        let y = base - at * height;
        drawing.line([(LEFT - 7.0, y), (LEFT, y)], line);
        drawing.text(&label, (LEFT - 12.0, y), SMALL, INK, Anchor::End);
    }
    drawing.upward_text("disparity read, px", (20.0, TOP + 0.5 * height), SMALL, INK);
}

/// The colour bar, with its ticks.
fn bar(drawing: &mut Drawing, scale: &Axis, height: f64) {
    let left = drawing.width - RIGHT + 26.0;
    let colours = (0..STEPS).rev().map(|k| colour((k as f64 + 0.5) / STEPS as f64)).collect();
    drawing.cells((left, TOP), (BAR, height), 1, colours);
    for Tick { at, label } in scale.ticks((height / 60.0) as usize) {
        let y = TOP + (1.0 - at) * height;
        let long = if label.is_empty() { 4.0 } else { 7.0 };
        drawing.line([(left + BAR, y), (left + BAR + long, y)], FAINT.stroke(1.5));
        drawing.text(&label, (left + BAR + 12.0, y), SMALL, INK, Anchor::Start);
    }
    drawing.text("density, 1/px", (left + BAR, 0.5 * TOP), SMALL, INK, Anchor::Middle);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_where_it_should() {
        assert_eq!((colour(-1.0), colour(2.0)), (Colour(68, 1, 84), Colour(253, 231, 37)));
    }

    #[test]
    fn the_kernel_is_drawn_from_the_largest_disparity_down() {
        use crate::figures::drawing::Item;
        let kernel = Kernel { far_m: 15.0, max_disparity: 60.0, density: vec![vec![1.0, 0.1], vec![0.001, 0.01]] };
        let drawing = draw("title", &kernel, &Paper::default());
        let Some(Item::Cells { colours, columns, .. }) = drawing.items.first() else { panic!("{drawing:?}") };
        assert_eq!(*columns, 2);
        assert_eq!([colours[0], colours[2]], [colour(0.0), colour(1.0)]);
    }
}
