//! A scene drawn with characters.

use std::collections::BTreeMap;

use crate::worlds::ground::Ground;

/// A character is about twice as high as it is wide.
const ASPECT: f64 = 2.0;

/// The scene in lines of at most `width` characters: obstacles `#`, the route `.`, waypoints by the first character of their
/// names, the inside of regions `-`, what nobody knows `?`; and a line that says how large it is.
pub(super) fn drawing(ground: &Ground, width: usize) -> String {
    let spec = *ground.truth.spec();
    let size_m = [spec.width, spec.height].map(|cells| cells as f64 * spec.cell_m);
    // Too high a scene is made narrower, so that it stays on a screen or two.
    let across_m = (size_m[0] / width as f64).max(size_m[1] / (ASPECT * width as f64)).max(spec.cell_m);
    let [columns, rows] = [(size_m[0] / across_m).ceil(), (size_m[1] / (ASPECT * across_m)).ceil()].map(|n| n as usize);
    let mut canvas = Canvas {
        columns: columns.max(1),
        rows: rows.max(1),
        across_m,
        origin_m: spec.origin_m,
        marks: BTreeMap::new(),
    };
    for (cell, truth) in ground.truth.values().iter().enumerate() {
        let mark = match truth {
            Some(true) => Mark::Obstacle,
            Some(false) => Mark::Free,
            None => Mark::Unknown,
        };
        canvas.put(spec.centre(cell), mark, ' ');
    }
    for region in &ground.scene.regions {
        let mask = region.mask(&spec);
        let inside = mask.values().iter().enumerate().filter(|(_, inside)| **inside);
        inside.for_each(|(cell, _)| canvas.put(spec.centre(cell), Mark::Region, '-'));
    }
    ground.drive.poses.iter().for_each(|timed| canvas.put(timed.pose.position_m(), Mark::Route, '.'));
    for stop in 0..ground.scene.stops.len() {
        let waypoint = ground.scene.waypoint_of(stop);
        canvas.put(waypoint.at_m, Mark::Waypoint, waypoint.name.chars().next().unwrap_or('*'));
    }
    let legend = "# obstacle  . route, letters its stops  - region  ? not known";
    format!("{}{:.1} m x {:.1} m; {legend}\n", canvas.text(), size_m[0], size_m[1])
}

/// What a character shows, the least important first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    Unknown,
    Free,
    Region,
    Obstacle,
    Route,
    Waypoint,
}

struct Canvas {
    columns: usize,
    rows: usize,
    across_m: f64,
    origin_m: [f64; 2],
    marks: BTreeMap<(usize, usize), (Mark, char)>,
}

impl Canvas {
    /// Shows a mark at a place, unless a more important one is there.
    fn put(&mut self, at_m: [f64; 2], mark: Mark, character: char) {
        let [x, y] = [0, 1].map(|axis| at_m[axis] - self.origin_m[axis]);
        let column = ((x / self.across_m).max(0.0) as usize).min(self.columns - 1);
        let row = ((y / (ASPECT * self.across_m)).max(0.0) as usize).min(self.rows - 1);
        let character = match mark {
            Mark::Obstacle => '#',
            Mark::Unknown => '?',
            _ => character,
        };
        let here = self.marks.entry((row, column)).or_insert((mark, character));
        if mark > here.0 {
            *here = (mark, character);
        }
    }

    /// The lines, the upper ones first.
    fn text(&self) -> String {
        let mark = |row, column| self.marks.get(&(row, column)).map_or(' ', |(_, character)| *character);
        let line = |row| (0..self.columns).map(|column| mark(row, column)).collect::<String>().trim_end().to_owned();
        (0..self.rows).rev().map(|row| line(row) + "\n").collect()
    }
}
