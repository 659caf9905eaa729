//! A map in a rectangle, with marks in metres.

use ::scene::{Region, Shape};
use grid::GridSpec;

use super::drawing::{Anchor, Drawing, Point};
use super::ink::{Colour, FAINT, LABEL, REGION, THING};
use super::paper::Paper;

/// A rectangle of cells, drawn at `at` with so many units to a cell's side, or so many cells to a square.
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    pub spec: GridSpec,
    /// First column and row, and one past the last.
    columns: (usize, usize),
    rows: (usize, usize),
    /// Units per square.
    side: f64,
    /// Cells per square along each side, 1 unless the map is large.
    cells: usize,
    /// Upper left corner.
    at: Point,
}

impl Panel {
    /// The whole grid, at most `width` wide and half as much again high.
    pub fn whole(spec: GridSpec, width: f64, paper: &Paper) -> Self {
        Self::part(spec, (0, spec.width), (0, spec.height), width, paper)
    }

    /// The cells around a rectangle (m), of the same size at most.
    pub fn around(spec: GridSpec, [min, max]: [[f64; 2]; 2], width: f64, paper: &Paper) -> Self {
        let range = |k: usize, limit: usize| {
            let cell = |v: f64| ((v - spec.origin_m[k]) / spec.cell_m).max(0.0) as usize;
            (cell(min[k]).min(limit - 1), (cell(max[k]) + 1).min(limit))
        };
        Self::part(spec, range(0, spec.width), range(1, spec.height), width, paper)
    }

    fn part(spec: GridSpec, columns: (usize, usize), rows: (usize, usize), width: f64, paper: &Paper) -> Self {
        // A tall map is bound by its height, so that no scene makes a picture without end.
        let tallest = 1.5 * width;
        let (across, up) = ((columns.1 - columns.0) as f64, (rows.1 - rows.0) as f64);
        let cells = (across / width).max(up / tallest).ceil().max(1.0);
        let fits = (width / (across / cells).ceil()).min(tallest / (up / cells).ceil());
        // Cells of whole pixels are all of one size; a width that was asked for matters more.
        let side = if paper.width_mm.is_none() { fits.floor().max(1.0) } else { fits };
        Self { spec, columns, rows, side, cells: cells as usize, at: (0.0, 0.0) }
    }

    /// The same panel with its upper left corner at another place.
    pub fn at(self, x: f64, y: f64) -> Self {
        Self { at: (x, y), ..self }
    }

    /// Squares along either side.
    fn squares(&self) -> (usize, usize) {
        let count = |(from, to): (usize, usize)| (to - from).div_ceil(self.cells);
        (count(self.columns), count(self.rows))
    }

    /// Width and height.
    pub fn size(&self) -> (f64, f64) {
        let (across, up) = self.squares();
        (across as f64 * self.side, up as f64 * self.side)
    }

    /// Where a point (m) is.
    pub fn place(&self, [x, y]: [f64; 2]) -> Point {
        let scale = self.side / self.cells as f64;
        let column = (x - self.spec.origin_m[0]) / self.spec.cell_m - self.columns.0 as f64;
        let row = self.rows.1 as f64 - (y - self.spec.origin_m[1]) / self.spec.cell_m;
        (self.at.0 + column * scale, self.at.1 + row * scale)
    }

    /// Whether a point (m) is in the picture.
    pub fn holds(&self, point: [f64; 2]) -> bool {
        let (x, y) = self.place(point);
        let (width, height) = self.size();
        (self.at.0..self.at.0 + width).contains(&x) && (self.at.1..self.at.1 + height).contains(&y)
    }

    /// Whether a whole region is in the picture.
    pub fn shows(&self, region: &Region) -> bool {
        region.area.extent_m().into_iter().all(|corner| self.holds(corner))
    }

    /// Units to a metre.
    pub fn scale(&self) -> f64 {
        self.side / (self.cells as f64 * self.spec.cell_m)
    }

    /// Fills every cell, and draws a frame. Where several cells share a square the darkest shows.
    pub fn fill(&self, drawing: &mut Drawing, colour: impl Fn(usize) -> Colour) {
        let (across, up) = self.squares();
        let squares = (0..up).flat_map(|row| (0..across).map(move |column| (column, row)));
        let colours = squares.map(|(column, row)| self.darkest(column, row, &colour)).collect();
        drawing.cells(self.at, self.size(), across, colours);
        let (width, height) = self.size();
        drawing.frame(self.at, (self.at.0 + width, self.at.1 + height), FAINT.stroke(1.0));
    }

    fn darkest(&self, column: usize, row: usize, colour: impl Fn(usize) -> Colour) -> Colour {
        let first = (self.columns.0 + column * self.cells, row * self.cells);
        let mut darkest = Colour::WHITE;
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

    /// Outlines a region, with its name beside it.
    pub fn outline(&self, drawing: &mut Drawing, region: &Region) {
        let [_, max] = region.area.extent_m();
        let stroke = REGION.stroke(2.5);
        match region.area {
            ::scene::Area::Disc { center_m: [x, y], radius_m } => {
                let points = (0..=72).map(|i| {
                    let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::TAU / 72.0);
                    self.place([x + radius_m * cos, y + radius_m * sin])
                });
                drawing.line(points, stroke);
            }
            ::scene::Area::Rectangle { min_m, max_m } => {
                drawing.frame(self.place(min_m), self.place(max_m), stroke);
            }
        }
        let (x, y) = self.place([max[0], max[1]]);
        drawing.text(&region.name, (x + 4.0, y - 4.0), LABEL, REGION, Anchor::Start);
    }

    /// Outlines of what moves, as it stands in the picture.
    pub fn things<'a>(&self, drawing: &mut Drawing, shapes: impl Iterator<Item = &'a Shape>) {
        for shape in shapes {
            let outline = shape.outline_m(48);
            if outline.iter().all(|point| self.holds(*point)) {
                let closed = outline.iter().chain(outline.first());
                drawing.line(closed.map(|point| self.place(*point)), THING.stroke(2.5));
            }
        }
    }

    /// A line through points (m).
    pub fn path(&self, drawing: &mut Drawing, points: &[[f64; 2]], colour: Colour) {
        drawing.line(points.iter().map(|&point| self.place(point)), colour.stroke(3.0));
    }

    /// The robot: a disc with a line where it looks.
    pub fn robot(&self, drawing: &mut Drawing, pose: &sensor::Pose, radius_m: f64, colour: Colour) {
        let at = self.place(pose.position_m());
        let radius = (radius_m * self.scale()).max(4.0);
        drawing.disc(at, radius, colour);
        let [x, y] = pose.direction(0.0);
        drawing.line([at, (at.0 + 2.2 * radius * x, at.1 - 2.2 * radius * y)], colour.stroke(2.5));
    }
}
