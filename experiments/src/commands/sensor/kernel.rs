//! The sensor kernel over range and disparity: the paper's Figure 7.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::failure::Failure;
use crate::figures::ink::{self, FAINT, INK};
use crate::figures::{Area, png};

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

const WIDTH: u32 = 900;
const HEIGHT: u32 = 600;
const LEFT: u32 = 92;
const RIGHT: u32 = 150;
const TOP: u32 = 48;
const BOTTOM: u32 = 72;
const BAR: u32 = 26;

/// Anchors of viridis (Smith and van der Walt 2015): as bright as they are high, for every eye.
const SCALE: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];

/// Colour of a share of the scale, 0 to 1.
fn colour(share: f64) -> RGBColor {
    let at = share.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let first = (at as usize).min(SCALE.len() - 2);
    let [r, g, b] = std::array::from_fn(|i| {
        let (low, high) = (SCALE[first][i], SCALE[first + 1][i]);
        (low + (at - first as f64) * (high - low)).round() as u8
    });
    RGBColor(r, g, b)
}

/// Draws the kernel, with colours in equal steps of its logarithm.
///
/// # Errors
/// A drawing that fails.
pub(super) fn draw(title: &str, kernel: &Kernel) -> Result<Vec<u8>, Failure> {
    let values = || kernel.density.iter().flatten().copied().filter(|l| *l > 0.0);
    let top = values().fold(f64::MIN_POSITIVE, f64::max);
    // Six powers of ten show all that matters where nothing is matched falsely.
    let bottom = values().fold(top, f64::min).max(1e-6 * top).min(0.5 * top);
    let (low, high) = (libm::log10(bottom), libm::log10(top));
    let share = |l: f64| if l > 0.0 { (libm::log10(l) - low) / (high - low) } else { 0.0 };
    png((LEFT + WIDTH + RIGHT, TOP + HEIGHT + BOTTOM), |area| {
        let (rows, columns) = (kernel.density.len(), kernel.density[0].len());
        for y in 0..HEIGHT {
            let row = &kernel.density[(HEIGHT - 1 - y) as usize * rows / HEIGHT as usize];
            for x in 0..WIDTH {
                let shade = colour(share(row[x as usize * columns / WIDTH as usize]));
                area.draw_pixel(((LEFT + x) as i32, (TOP + y) as i32), &shade).map_err(Failure::internal)?;
            }
        }
        let style = ink::letters(ink::TITLE, &INK).pos(Pos::new(HPos::Center, VPos::Center));
        write(area, title, (LEFT + WIDTH / 2, TOP / 2), style)?;
        axes(area, kernel)?;
        bar(area, (low, high))
    })
}

fn write(area: &Area, text: &str, (x, y): (u32, u32), style: TextStyle) -> Result<(), Failure> {
    area.draw(&Text::new(text.to_owned(), (x as i32, y as i32), style)).map_err(Failure::internal)
}

fn tick(area: &Area, from: (u32, u32), to: (u32, u32)) -> Result<(), Failure> {
    let ends = [from, to].map(|(x, y)| (x as i32, y as i32));
    area.draw(&PathElement::new(ends.to_vec(), FAINT)).map_err(Failure::internal)
}

/// A round step that divides `span` into four to eight parts.
fn step(span: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(span / 4.0)));
    [5.0, 2.0, 1.0].into_iter().map(|d| d * power).find(|s| span / s >= 4.0).unwrap_or(power)
}

fn axes(area: &Area, kernel: &Kernel) -> Result<(), Failure> {
    let letters = || ink::letters(ink::LABEL, &INK);
    let base = TOP + HEIGHT;
    let each = step(kernel.far_m);
    for i in 0..=(kernel.far_m / each * (1.0 + 1e-12)) as u32 {
        let x = LEFT + (f64::from(i) * each / kernel.far_m * f64::from(WIDTH)) as u32;
        tick(area, (x, base), (x, base + 6))?;
        write(area, &label(f64::from(i) * each), (x, base + 8), letters().pos(Pos::new(HPos::Center, VPos::Top)))?;
    }
    let middle = Pos::new(HPos::Center, VPos::Top);
    write(area, "range, m", (LEFT + WIDTH / 2, base + 40), letters().pos(middle))?;
    let each = step(kernel.max_disparity);
    for i in 0..=(kernel.max_disparity / each * (1.0 + 1e-12)) as u32 {
        let y = base - (f64::from(i) * each / kernel.max_disparity * f64::from(HEIGHT)) as u32;
        tick(area, (LEFT - 6, y), (LEFT, y))?;
        write(area, &label(f64::from(i) * each), (LEFT - 10, y), letters().pos(Pos::new(HPos::Right, VPos::Center)))?;
    }
    let turned = ink::letters(ink::LABEL, &INK).transform(FontTransform::Rotate270).pos(middle);
    write(area, "disparity read, px", (14, TOP + HEIGHT / 2), turned)
}

fn label(value: f64) -> String {
    format!("{}", (value * 1e9).round() / 1e9)
}

/// The colour bar, with a tick at every power of ten.
fn bar(area: &Area, (low, high): (f64, f64)) -> Result<(), Failure> {
    let left = LEFT + WIDTH + 28;
    for y in 0..HEIGHT {
        let shade = colour(1.0 - f64::from(y) / f64::from(HEIGHT - 1));
        for x in left..left + BAR {
            area.draw_pixel((x as i32, (TOP + y) as i32), &shade).map_err(Failure::internal)?;
        }
    }
    let style = || ink::letters(ink::LABEL, &INK).pos(Pos::new(HPos::Left, VPos::Center));
    for power in low.ceil() as i32..=high.floor() as i32 {
        let y = TOP + ((high - f64::from(power)) / (high - low) * f64::from(HEIGHT - 1)).round() as u32;
        tick(area, (left + BAR, y), (left + BAR + 6, y))?;
        write(area, &label(libm::pow(10.0, f64::from(power))), (left + BAR + 10, y), style())?;
    }
    write(area, "1/px", (left, TOP / 2), style())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_and_few() {
        for (span, expected) in [(60.0, 10.0), (15.0, 2.0), (1.0, 0.2), (40.0, 10.0)] {
            assert!((step(span) - expected).abs() < 1e-12, "{span}: {}", step(span));
        }
    }

    #[test]
    fn the_scale_ends_where_it_should() {
        assert_eq!((colour(-1.0), colour(2.0)), (RGBColor(68, 1, 84), RGBColor(253, 231, 37)));
    }
}
