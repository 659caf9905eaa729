//! A map on whole pixels, with marks in metres.

use ::scene::Region;
use grid::GridSpec;
use plotters::prelude::*;

use super::Area;
use super::ink::{self, FAINT, REGION};
use crate::failure::Failure;

/// A rectangle of cells, drawn at `at` with so many pixels to a cell's side, or so many cells to a pixel.
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    pub spec: GridSpec,
    /// First column and row, and one past the last.
    columns: (usize, usize),
    rows: (usize, usize),
    /// Pixels per cell.
    pixels: usize,
    /// Cells per pixel, 1 unless the map is large.
    cells: usize,
    /// Upper left pixel.
    at: (i32, i32),
}

impl Panel {
    /// The whole grid, at most about `width` pixels wide and half as much again high.
    pub fn whole(spec: GridSpec, width: usize) -> Self {
        Self::part(spec, (0, spec.width), (0, spec.height), width)
    }

    /// The cells around a rectangle (m), of the same size at most.
    pub fn around(spec: GridSpec, [min, max]: [[f64; 2]; 2], width: usize) -> Self {
        let range = |k: usize, limit: usize| {
            let cell = |v: f64| ((v - spec.origin_m[k]) / spec.cell_m).max(0.0) as usize;
            (cell(min[k]).min(limit - 1), (cell(max[k]) + 1).min(limit))
        };
        Self::part(spec, range(0, spec.width), range(1, spec.height), width)
    }

    fn part(spec: GridSpec, columns: (usize, usize), rows: (usize, usize), width: usize) -> Self {
        // A tall map is bound by its height, so that no scene makes a picture without end.
        let tallest = width + width / 2;
        let (across, up) = (columns.1 - columns.0, rows.1 - rows.0);
        let pixels = (width / across).min(tallest / up).max(1);
        let cells = across.div_ceil(width).max(up.div_ceil(tallest)).max(1);
        Self { spec, columns, rows, pixels, cells, at: (0, 0) }
    }

    /// The same panel with its upper left corner at another place.
    pub fn at(self, x: u32, y: u32) -> Self {
        Self { at: (x as i32, y as i32), ..self }
    }

    /// Width and height, px.
    pub fn size(&self) -> (u32, u32) {
        let pixels = |(from, to): (usize, usize)| ((to - from).div_ceil(self.cells) * self.pixels) as u32;
        (pixels(self.columns), pixels(self.rows))
    }

    /// The pixel at a point (m).
    pub fn pixel(&self, [x, y]: [f64; 2]) -> (i32, i32) {
        let scale = self.pixels as f64 / self.cells as f64;
        let column = (x - self.spec.origin_m[0]) / self.spec.cell_m - self.columns.0 as f64;
        let row = self.rows.1 as f64 - (y - self.spec.origin_m[1]) / self.spec.cell_m;
        (self.at.0 + (column * scale).round() as i32, self.at.1 + (row * scale).round() as i32)
    }

    /// Whether a point (m) is in the picture.
    pub fn holds(&self, point: [f64; 2]) -> bool {
        let (x, y) = self.pixel(point);
        let (width, height) = self.size();
        (self.at.0..self.at.0 + width as i32).contains(&x) && (self.at.1..self.at.1 + height as i32).contains(&y)
    }

    /// Whether a whole region is in the picture.
    pub fn shows(&self, region: &Region) -> bool {
        region.area.extent_m().into_iter().all(|corner| self.holds(corner))
    }

    /// Pixels to a metre.
    pub fn scale(&self) -> f64 {
        self.pixels as f64 / (self.cells as f64 * self.spec.cell_m)
    }

    /// Fills every cell, and draws a frame. Where several cells share a pixel the darkest shows.
    pub fn fill(&self, area: &Area, colour: impl Fn(usize) -> RGBColor) -> Result<(), Failure> {
        let (width, height) = self.size();
        for y in 0..height as usize {
            for x in 0..width as usize {
                let shade = self.darkest(x, y, &colour);
                let at = (self.at.0 + x as i32, self.at.1 + y as i32);
                area.draw_pixel(at, &shade).map_err(Failure::internal)?;
            }
        }
        let corners = [(self.at.0 - 1, self.at.1 - 1), (self.at.0 + width as i32, self.at.1 + height as i32)];
        area.draw(&Rectangle::new(corners, FAINT)).map_err(Failure::internal)
    }

    fn darkest(&self, x: usize, y: usize, colour: impl Fn(usize) -> RGBColor) -> RGBColor {
        let first = (self.columns.0 + x / self.pixels * self.cells, y / self.pixels * self.cells);
        let mut darkest = WHITE;
        for down in first.1..(first.1 + self.cells).min(self.rows.1 - self.rows.0) {
            for column in first.0..(first.0 + self.cells).min(self.columns.1) {
                let shade = colour(self.spec.index(column, self.rows.1 - 1 - down));
                if shade.0 <= darkest.0 {
                    darkest = shade;
                }
            }
        }
        darkest
    }

    /// Outlines a region, with its name beside it if asked for.
    pub fn outline(&self, area: &Area, region: &Region, named: bool) -> Result<(), Failure> {
        let [_, max] = region.area.extent_m();
        let style = REGION.stroke_width(2);
        match region.area {
            ::scene::Area::Disc { center_m: [x, y], radius_m } => {
                let points = (0..=72).map(|i| {
                    let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::TAU / 72.0);
                    self.pixel([x + radius_m * cos, y + radius_m * sin])
                });
                area.draw(&PathElement::new(points.collect::<Vec<_>>(), style)).map_err(Failure::internal)?;
            }
            ::scene::Area::Rectangle { min_m, max_m } => {
                let corners = [self.pixel(min_m), self.pixel(max_m)];
                area.draw(&Rectangle::new(corners, style)).map_err(Failure::internal)?;
            }
        }
        if named {
            let (x, y) = self.pixel([max[0], max[1]]);
            let style = ink::letters(ink::TITLE, &REGION);
            area.draw(&Text::new(region.name.clone(), (x + 2, y - 12), style)).map_err(Failure::internal)?;
        }
        Ok(())
    }

    /// A line through points (m). Leg by leg: a line that turns back on itself would lose its width.
    pub fn path(&self, area: &Area, points: &[[f64; 2]], colour: RGBColor) -> Result<(), Failure> {
        points.windows(2).try_for_each(|leg| {
            let ends: Vec<_> = leg.iter().map(|&point| self.pixel(point)).collect();
            area.draw(&PathElement::new(ends, colour.stroke_width(3))).map_err(Failure::internal)
        })
    }

    /// The robot: a disc with a line where it looks.
    pub fn robot(&self, area: &Area, pose: &sensor::Pose, radius_m: f64, colour: RGBColor) -> Result<(), Failure> {
        let at = self.pixel(pose.position_m());
        let radius = (radius_m * self.scale()).max(3.0);
        area.draw(&Circle::new(at, radius as i32, colour.filled())).map_err(Failure::internal)?;
        let [x, y] = pose.direction(0.0);
        let tip = (at.0 + (2.2 * radius * x) as i32, at.1 - (2.2 * radius * y) as i32);
        area.draw(&PathElement::new(vec![at, tip], colour.stroke_width(2))).map_err(Failure::internal)
    }
}
