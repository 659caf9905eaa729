//! Floor plans as polygons: JSON files as the HouseExpo data set has them.

mod document;

use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use strict::{LONGEST_REPORT, Place, excerpt};
use thiserror::Error;

use crate::geometry::{cross, crossed, distance, dot, minus, outline_contains, signed_area};
use crate::warning::Warning;
use document::{Document, lists};

/// A plan of 400 corners has 16 KiB.
const MAX_BYTES: u64 = 16 << 20;

/// Points nearer than this are taken for the same one, m.
const SMALLEST_M: f64 = 1e-6;

/// Area above which the corners are probably pixels, and above which they surely are none of a floor, m².
const LARGE_M2: [f64; 2] = [1e4, 1e5];

/// The outline of a floor: what is inside is free.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorPlan {
    /// The corners, m, counter-clockwise, the first only once.
    pub outline_m: Vec<[f64; 2]>,
    /// Walls within, each from one end to the other, m: sides that the outline runs along there and back.
    pub partitions_m: Vec<[[f64; 2]; 2]>,
}

/// What is wrong with a floor plan.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The fields are what the messages say.
pub enum FloorPlanError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}; check the path and the permissions", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// The file is no plan.
    #[error("{place}: {problem}; must be JSON such as {{\"verts\": [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]}}, in m")]
    Syntax { place: Place, problem: String },
    /// The outline is none.
    #[error("{}: `verts`: {problem}; {remedy}", path.display())]
    Outline { path: PathBuf, problem: String, remedy: &'static str },
}

impl FloorPlan {
    /// Reads the plan at `path`: a JSON object with `verts`, the corners in m and in order. Other keys are ignored.
    /// Corners given twice in a row are one corner, and sides that the outline runs along there and back are walls within.
    /// An outline may touch itself.
    ///
    /// # Errors
    /// A file that cannot be read or is no such JSON; fewer than three corners or more than 5000; coordinates beyond
    /// 1,000,000 m; an outline that crosses itself, has no area, or holds more than 100,000 m².
    pub fn load(path: &Path) -> Result<Self, FloorPlanError> {
        let unreadable = |source| FloorPlanError::Unreadable { path: path.into(), source };
        let mut bytes = Vec::new();
        strict::opened(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
        Self::parse(&bytes, path)
    }

    /// Checks the plan in `bytes`; `path` is named in messages.
    ///
    /// # Errors
    /// As [`load`](Self::load), but for a file that cannot be read.
    pub fn parse(bytes: &[u8], path: &Path) -> Result<Self, FloorPlanError> {
        let place = |line, column| Place { file: path.display().to_string(), line, column };
        if bytes.len() as u64 > MAX_BYTES {
            return Err(FloorPlanError::Syntax { place: place(1, 1), problem: "it has more than 16 MiB".to_owned() });
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let Document { mut verts } = serde_json::from_slice(bytes).map_err(|error| {
            let (line, column) = (error.line(), error.column());
            // The parser repeats the place at the end.
            let problem = error.to_string().replace(&format!(" at line {line} column {column}"), "");
            let problem = lists(bytes).unwrap_or_else(|| excerpt(&problem, LONGEST_REPORT));
            FloorPlanError::Syntax { place: place(line.max(1), column.max(1)), problem }
        })?;
        let outline = |problem: String, remedy| Err(FloorPlanError::Outline { path: path.into(), problem, remedy });
        once(&mut verts);
        if verts.len() < 3 {
            return outline(
                format!("{} different corners: must be at least 3", verts.len()),
                "list the corners in order",
            );
        }
        let mut partitions_m = partitions(&mut verts);
        if let Some((first, second)) = crossed(&verts) {
            let side = |k: usize| {
                let ([a, b], [c, d]) = (verts[k], verts[(k + 1) % verts.len()]);
                format!("[{a}, {b}] to [{c}, {d}]")
            };
            let problem = format!("the sides {} and {} cross", side(first), side(second));
            return outline(problem, "must be an outline that does not cross itself: put the corners in order");
        }
        let area = if verts.len() < 3 { 0.0 } else { signed_area(&verts) };
        if area.abs() < SMALLEST_M {
            let remedy = "must hold an area: the corners lie on one line, or the outline crosses itself in a corner";
            return outline(format!("the outline holds {area:e} m²"), remedy);
        }
        if area.abs() > LARGE_M2[1] {
            let remedy = "are the corners pixels or millimetres? divide them, so that they are metres";
            return outline(
                format!("the outline holds {:.0} m²: must be at most {} m²", area.abs(), LARGE_M2[1]),
                remedy,
            );
        }
        if area < 0.0 {
            verts.reverse();
        }
        partitions_m.retain(|[a, b]| outline_contains(&verts, [0, 1].map(|k| 0.5 * (a[k] + b[k]))));
        Ok(Self { outline_m: verts, partitions_m })
    }

    /// Area within the outline, m².
    pub fn area_m2(&self) -> f64 {
        signed_area(&self.outline_m)
    }

    /// What is suspicious about the plan; `path` is named in it.
    pub fn warning(&self, path: &Path) -> Option<Warning> {
        let area_m2 = self.area_m2();
        (area_m2 > LARGE_M2[0]).then(|| Warning::Large { path: path.to_owned(), area_m2 })
    }

    /// Lower-left and upper-right corner, m.
    pub fn extent_m(&self) -> [[f64; 2]; 2] {
        let pick =
            |k: usize, pick: fn(f64, f64) -> f64| self.outline_m.iter().map(|p| p[k]).reduce(pick).unwrap_or(0.0);
        [[pick(0, f64::min), pick(1, f64::min)], [pick(0, f64::max), pick(1, f64::max)]]
    }
}

/// Corners given twice in a row are one corner.
fn once(verts: &mut Vec<[f64; 2]>) {
    verts.dedup_by(|b, a| distance(*a, *b) < SMALLEST_M);
    while verts.len() > 1 && distance(verts[0], verts[verts.len() - 1]) < SMALLEST_M {
        verts.pop();
    }
}

/// Takes the sides out that the outline runs along there and back, and gives them.
fn partitions(verts: &mut Vec<[f64; 2]>) -> Vec<[[f64; 2]; 2]> {
    let mut partitions = Vec::new();
    loop {
        let n = verts.len();
        let tip = (0..n).find(|&k| {
            let (back, on) = (minus(verts[(k + n - 1) % n], verts[k]), minus(verts[(k + 1) % n], verts[k]));
            let lengths = distance(back, [0.0; 2]) * distance(on, [0.0; 2]);
            cross(back, on).abs() <= 1e-9 * lengths && dot(back, on) > 0.0
        });
        let Some(tip) = tip.filter(|_| n > 2) else { return partitions };
        let (from, ends) = (verts[tip], [verts[(tip + n - 1) % n], verts[(tip + 1) % n]]);
        let nearer = if distance(from, ends[0]) <= distance(from, ends[1]) { ends[0] } else { ends[1] };
        partitions.push([from, nearer]);
        verts.remove(tip);
        once(verts);
    }
}

#[cfg(test)]
mod tests;
