//! Floor plans as polygons: JSON files as the HouseExpo data set has them.

use std::fmt;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use strict::{LONGEST_REPORT, Place, excerpt};
use thiserror::Error;

use crate::geometry::{cross, crossed, distance, dot, minus, outline_contains, signed_area};
use crate::warning::Warning;

/// A plan of 400 corners has 16 KiB.
const MAX_BYTES: u64 = 16 << 20;

/// Sides are checked pair by pair.
const MOST_POINTS: usize = 5000;

/// Coordinates stay within this, m.
const METRES: f64 = 1e6;

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
        File::open(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
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

/// What is wrong with `verts` that hold lists of corners.
fn lists(bytes: &[u8]) -> Option<String> {
    let document: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    let lists = document.get("verts")?.as_array()?;
    let holds_lists = lists.iter().any(|list| list.get(0).is_some_and(serde_json::Value::is_array));
    holds_lists.then(|| {
        format!(
            "`verts` holds {} lists of corners: must be one outline; give the outer one, and inner walls as sides there and back",
            lists.len()
        )
    })
}

/// The keys that are read.
struct Document {
    verts: Vec<[f64; 2]>,
}

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = Document;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object with `verts`")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Document, A::Error> {
                let mut verts = None;
                while let Some(key) = map.next_key::<String>()? {
                    if key != "verts" {
                        map.next_value::<serde::de::IgnoredAny>()?;
                    } else if verts.replace(map.next_value::<Verts>()?.0).is_some() {
                        return Err(A::Error::duplicate_field("verts"));
                    }
                }
                verts.map(|verts| Document { verts }).ok_or_else(|| A::Error::missing_field("verts"))
            }
        }
        deserializer.deserialize_map(Keys)
    }
}

/// A list of corners, each checked where it stands, so that a refusal has its line and column.
struct Verts(Vec<[f64; 2]>);

impl<'de> Deserialize<'de> for Verts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Corners;
        impl<'de> Visitor<'de> for Corners {
            type Value = Verts;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a list of corners [x, y] in m")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Verts, A::Error> {
                let mut corners = Vec::new();
                while let Some(corner) = list.next_element::<[f64; 2]>()? {
                    let number = corners.len() + 1;
                    if let Some(far) = corner.into_iter().find(|v| v.abs() > METRES) {
                        let bound = "must lie within 1000000 m of the origin";
                        return Err(A::Error::custom(format!("corner {number}: coordinate {far:e}: {bound}")));
                    }
                    if number > MOST_POINTS {
                        return Err(A::Error::custom(format!(
                            "corner {number}: must be at most {MOST_POINTS} corners"
                        )));
                    }
                    corners.push(corner);
                }
                Ok(Verts(corners))
            }
        }
        deserializer.deserialize_seq(Corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<FloorPlan, FloorPlanError> {
        FloorPlan::parse(text.as_bytes(), Path::new("p.json"))
    }

    #[test]
    fn an_outline_is_read_in_either_direction_and_closed_or_not() {
        let expected = FloorPlan { outline_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], partitions_m: vec![] };
        let texts = [
            "{\"verts\": [[0, 0], [4, 0], [4, 3.0]]}",
            "\u{feff}{\"id\": \"a\", \"room_num\": 1, \"verts\": [[0, 0], [4, 0], [4, 0], [4, 3], [0, 0]], \"bbox\": {\"min\": [0, 0]}}",
        ];
        for text in texts {
            assert_eq!(parsed(text).expect("a plan"), expected);
        }
        let back = parsed("{\"verts\": [[4, 3], [4, 0], [0, 0]]}").expect("a plan");
        assert_eq!(back, FloorPlan { outline_m: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], partitions_m: vec![] });
        assert_eq!(back.extent_m(), [[0.0, 0.0], [4.0, 3.0]]);
    }

    #[test]
    fn sides_there_and_back_are_walls_within() {
        let square = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]];
        // A wall from the upper side, one with a bend, one of two parts, one from a corner, one along a side.
        let plans: [(&str, &[[[f64; 2]; 2]]); 6] = [
            ("[[0,0],[6,0],[6,4],[3,4],[3,2],[3,4],[0,4]]", &[[[3.0, 2.0], [3.0, 4.0]]]),
            (
                "[[0,0],[6,0],[6,4],[3,4],[3,2],[4,2],[3,2],[3,4],[0,4]]",
                &[[[4.0, 2.0], [3.0, 2.0]], [[3.0, 2.0], [3.0, 4.0]]],
            ),
            (
                "[[0,0],[6,0],[6,4],[3,4],[3,3],[3,1],[3,2.5],[3,4],[0,4],[0,0]]",
                &[[[3.0, 1.0], [3.0, 2.5]], [[3.0, 2.5], [3.0, 3.0]], [[3.0, 3.0], [3.0, 4.0]]],
            ),
            ("[[0,0],[2,2],[0,0],[6,0],[6,4],[0,4]]", &[[[2.0, 2.0], [0.0, 0.0]]]),
            ("[[0,0],[6,0],[6,4],[0,4],[0,0],[0,2],[0,0]]", &[]),
            ("[[0,4],[3,4],[3,5],[3,4],[6,4],[6,0],[0,0]]", &[]), // a wall outside is none
        ];
        for (verts, partitions) in plans {
            let plan = parsed(&format!("{{\"verts\": {verts}}}")).expect(verts);
            assert!((plan.area_m2() - 24.0).abs() < 1e-9, "{verts}");
            assert!(square.iter().all(|corner| plan.outline_m.contains(corner)), "{:?}", plan.outline_m);
            let lengths = |walls: &[[[f64; 2]; 2]]| walls.iter().map(|[a, b]| distance(*a, *b)).sum::<f64>();
            assert_eq!(lengths(&plan.partitions_m).to_bits(), lengths(partitions).to_bits(), "{:?}", plan.partitions_m);
            assert!(partitions.iter().all(|wall| plan.partitions_m.contains(wall)), "{:?}", plan.partitions_m);
        }
    }

    #[test]
    fn outlines_may_touch_themselves() {
        // Two squares that meet in a corner; corners half a millimetre apart.
        for (verts, area_m2) in [
            ("[[0,0],[3,0],[3,3],[6,3],[6,6],[3,6],[3,3],[0,3]]", 18.0),
            ("[[0,0],[2,0.0004],[4,-0.0003],[6,0],[6,4],[6,4.0005],[5.9995,4],[0,4],[0,0]]", 24.0),
        ] {
            let plan = parsed(&format!("{{\"verts\": {verts}}}")).expect(verts);
            assert!((plan.area_m2() - area_m2).abs() < 2e-3, "{verts}: {}", plan.area_m2());
        }
    }

    #[test]
    fn pixels_are_taken_for_pixels() {
        let of = |side: f64| parsed(&format!("{{\"verts\": [[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]}}"));
        let warning = |side| of(side).expect("a plan").warning(Path::new("p.json")).map(|warning| warning.to_string());
        assert_eq!(warning(99.0), None);
        let expected = "p.json: `verts`: the outline holds 14400 m²: are the corners metres? divide them by the pixels per metre if not";
        assert_eq!(warning(120.0).as_deref(), Some(expected));
        let refusal = of(964.0).expect_err("too large").to_string();
        let expected = "p.json: `verts`: the outline holds 929296 m²: must be at most 100000 m²; are the corners pixels or millimetres? divide them, so that they are metres";
        assert_eq!(refusal, expected);
    }

    #[test]
    fn what_is_no_plan_is_refused_with_its_place_and_reason() {
        let many = (0..=MOST_POINTS).map(|k| format!("[{k}, {}]", k * k % 1000)).collect::<Vec<_>>().join(", ");
        let many = format!("{{\"verts\": [{many}]}}");
        let deep = format!("{{\"a\": {}", "[".repeat(100_000));
        let cases = [
            ("", "p.json:1:1: EOF while parsing a value"),
            ("[1]", "p.json:1:1: invalid type: sequence, expected an object with `verts`"),
            ("{\"verts\": [[0, 0], [1, 0]", "p.json:1:25: EOF while parsing a list"),
            ("{\n\"verts\": [[0, 0],\n [1, NaN]]}", "p.json:3:6: expected value"),
            ("{\"verts\": [[0, 0], [1, 1e400]]}", "number out of range"),
            ("{\"verts\": [[0, 0],\n[1, 2e6],\n[0, 1]]}", "corner 2: coordinate 2e6: must lie within 1000000 m"),
            ("{\"verts\": [[0, 0], [1]]}", "invalid length 1"),
            ("{\"verts\": [[0, 0], [1, 2, 3]]}", "trailing characters"),
            ("{\"verts\": [[0, 0], [1, \"2\"]]}", "invalid type: string \"2\", expected f64"),
            ("{\"bbox\": 1}", "missing field `verts`"),
            ("{\"verts\": [], \"verts\": []}", "duplicate field `verts`"),
            ("{\"verts\": []}", "p.json: `verts`: 0 different corners: must be at least 3"),
            ("{\"verts\": [[0, 0], [1, 0], [1, 0], [0, 0]]}", "p.json: `verts`: 2 different corners"),
            ("{\"verts\": [[0, 0], [2, 0], [1, 0]]}", "the outline holds 0e0 m²; must hold an area"),
            ("{\"verts\": [[0, 0], [1, 1], [1, 0], [0, 1]]}", "the sides [0, 0] to [1, 1] and [1, 0] to [0, 1] cross"),
            (
                "{\"verts\": [[[0, 0], [6, 0], [6, 4]], [[2, 1], [3, 1], [3, 2]]]}",
                "`verts` holds 2 lists of corners: must be one outline; give the outer one",
            ),
            (&many, "corner 5001: must be at most 5000 corners"),
            (&deep, "EOF while parsing a list"),
        ];
        for (text, expected) in cases {
            let message = parsed(text).expect_err(expected).to_string();
            let placed = message.starts_with("p.json:1:")
                || message.starts_with("p.json:2:")
                || message.starts_with("p.json:3:");
            assert!(placed || message.starts_with("p.json: `verts`: "), "{message}");
            assert!(message.contains(expected) && !message.contains('\n'), "{message}\nlacks\n{expected}");
        }
        let missing = FloorPlan::load(Path::new("no/such.json")).expect_err("no file").to_string();
        assert!(missing.starts_with("no/such.json: cannot be read: "), "{missing}");
    }
}
