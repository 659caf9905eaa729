//! Tables of point features: a row per reading and the names of the columns in the first line.
//!
//! | column | |
//! |---|---|
//! | `scan` | number of the scan; the rows of a scan stand together |
//! | `time_s` | s; later from scan to scan |
//! | `bearing_rad`, `disparity_px` | the reading: between -pi/2 and pi/2, and above 0; both empty in the row of a scan without any |
//! | `x_m`, `y_m`, `theta_rad` | pose of the camera, where it is known; may be missing or empty |
//! | `odom_x_m`, `odom_y_m`, `odom_theta_rad` | its pose by the odometry; may be missing or empty |
//! | `feature` | number of the feature that the reading is of, where it is known; may be missing or empty |
//! | `matched` | 1 where the match is right, 0 where the disparity is of something else; may be missing or empty |
//!
//! Separators, quotes, upper case, comments and other columns are as in tables of scans.

use std::f64::consts::FRAC_PI_2;
use std::io::Read;
use std::path::Path;

use sensor::{FeatureReading, FeatureScan, Pose};

use super::head::Separator;
use crate::bounds::{FAR_M, LATE_S, WOUND_RAD};
use crate::error::LogError;
use crate::fields::{number, quoted};
use crate::lines::{LONGEST_LINE, Line, Lines};
use crate::source;

const NAMES: [&str; 12] = [
    "scan",
    "time_s",
    "bearing_rad",
    "disparity_px",
    "x_m",
    "y_m",
    "theta_rad",
    "odom_x_m",
    "odom_y_m",
    "odom_theta_rad",
    "feature",
    "matched",
];
/// The first columns must be there.
const NEEDED: usize = 4;
const SCAN: usize = 0;
const TIME: usize = 1;
const BEARING: usize = 2;
const DISPARITY: usize = 3;
const POSE: [usize; 3] = [4, 5, 6];
const ODOMETRY: [usize; 3] = [7, 8, 9];
const FEATURE: usize = 10;
const MATCHED: usize = 11;

/// More readings are taken for a mistake.
const MOST: usize = 20_000_000;

/// Disparities of no camera are beyond this, px.
const MOST_PX: f64 = 1e5;

/// A scan with what the table knows of its readings.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FeatureRow {
    /// The readings; their identities are what the column `feature` has.
    pub scan: FeatureScan,
    /// For each reading whether it was matched right; none where the table does not say.
    pub matched: Vec<Option<bool>>,
    /// Line of the first of its rows, from 1.
    pub line: u64,
}

/// Reads a file, plain, gzip or bzip2.
///
/// # Errors
/// As [`read`]; a file that cannot be opened.
pub fn open(path: &Path) -> Result<Vec<FeatureRow>, LogError> {
    read(source::file(path, false)?, &path.display().to_string())
}

/// Reads scans of features, in their order; `place` names the table in messages.
///
/// # Errors
/// Columns that are missing or named twice; the first row with a value out of its bounds; rows of one scan that differ in time or pose;
/// scans that are not later than the one before; no scan; more than twenty million readings.
pub fn read(source: impl Read + Send, place: &str) -> Result<Vec<FeatureRow>, LogError> {
    let refused = |line, reason| LogError::Table { place: place.to_owned(), line, reason };
    let mut lines = Lines::new(source::text(source, place)?);
    let (mut columns, mut gathered) = (None, Gathered::default());
    loop {
        let before = lines.number();
        let next = lines.next();
        let next = next.map_err(|source| LogError::Interrupted { place: place.to_owned(), line: before, source })?;
        let (line, text) = match next {
            None if columns.is_none() => return Err(head(place, before.max(1), "the table is empty".to_owned())),
            None if gathered.scans.is_empty() => {
                return Err(refused(before, format!("no scan; give rows of {}", NAMES[..NEEDED].join(","))));
            }
            None => return Ok(gathered.scans),
            Some((line, Line::TooLong)) => {
                return Err(refused(line, format!("the line has more than {LONGEST_LINE} bytes; is it a table?")));
            }
            Some((line, Line::Text(text))) => (line, text),
        };
        if text.trim_ascii().is_empty() {
            continue;
        }
        match &columns {
            None => columns = Columns::of(text).map_err(|reason| head(place, line, reason))?,
            Some(_) if text.trim_ascii_start().starts_with(b"#") => {}
            Some(columns) => {
                let row = columns.row(text).map_err(|reason| refused(line, reason))?;
                gathered.add(row, line).map_err(|reason| refused(line, reason))?;
            }
        }
    }
}

fn head(place: &str, line: u64, reason: String) -> LogError {
    LogError::Head { place: place.to_owned(), line, reason: format!("{reason}; {}", expected()) }
}

fn expected() -> String {
    format!("the first line must have {}", NAMES[..NEEDED].join(","))
}

/// Where the columns are.
struct Columns {
    separator: Separator,
    width: usize,
    places: [Option<usize>; NAMES.len()],
}

/// A row as it stands.
struct Row {
    number: f64,
    time_s: f64,
    pose: Option<Pose>,
    odometry: Option<Pose>,
    reading: Option<FeatureReading>,
    matched: Option<bool>,
}

impl Columns {
    /// The columns of a first line; none of a comment.
    fn of(line: &[u8]) -> Result<Option<Self>, String> {
        let bare = line.trim_ascii_start();
        let stripped = bare.strip_prefix(b"#").unwrap_or(bare);
        let separator = Separator::of(stripped);
        let names: Vec<String> = separator
            .cells(stripped)
            .into_iter()
            .map(|cell| String::from_utf8_lossy(cell).to_ascii_lowercase())
            .collect();
        let mut places = [None; NAMES.len()];
        for (place, name) in places.iter_mut().zip(NAMES) {
            let mut found = (0..names.len()).filter(|k| names[*k] == name);
            *place = found.next();
            if found.next().is_some() {
                return Err(format!("column {name}: is there twice; name each column once"));
            }
        }
        if bare.len() > stripped.len() && places.iter().flatten().count() < 2 {
            return Ok(None);
        }
        let missing: Vec<&str> = (0..NEEDED).filter(|k| places[*k].is_none()).map(|k| NAMES[k]).collect();
        if !missing.is_empty() {
            let (columns, are) = if missing.len() == 1 { ("column", "is") } else { ("columns", "are") };
            return Err(format!("{columns} {}: {are} missing", missing.join(", ")));
        }
        for group in [POSE, ODOMETRY] {
            let there = group.iter().filter(|k| places[**k].is_some()).count();
            if there != 0 && there != group.len() {
                return Err(format!("columns {}: give all of them or none", group.map(|k| NAMES[k]).join(", ")));
            }
        }
        Ok(Some(Self { separator, width: names.len(), places }))
    }

    fn row(&self, text: &[u8]) -> Result<Row, String> {
        let cells = self.separator.cells(text);
        if cells.len() != self.width {
            return Err(format!("{} fields; must be {}, as in the first line", cells.len(), self.width));
        }
        let cells = Cells { cells: &cells, columns: self };
        let pose = |names: [usize; 3]| -> Result<Option<Pose>, String> {
            let [x, y, theta] = names;
            if names.iter().all(|name| cells.cell(*name).is_empty()) {
                return Ok(None);
            }
            Ok(Some(Pose {
                x_m: cells.number(x, "from -1e8 to 1e8 m", |v| v.abs() <= FAR_M)?,
                y_m: cells.number(y, "from -1e8 to 1e8 m", |v| v.abs() <= FAR_M)?,
                theta_rad: cells.number(theta, "from -1e6 to 1e6 rad", |v| v.abs() <= WOUND_RAD)?,
            }))
        };
        let whole = |name: usize, most: f64, bound: &str| {
            cells.number(name, bound, |v| v >= 0.0 && v <= most && v.fract() <= 0.0)
        };
        let optional = |name: usize, most: f64, bound: &str| {
            if cells.cell(name).is_empty() { Ok(None) } else { whole(name, most, bound).map(Some) }
        };
        let identity = optional(FEATURE, f64::from(u32::MAX), "a whole number, 0 or more, or empty")?;
        let reading = if cells.cell(BEARING).is_empty() && cells.cell(DISPARITY).is_empty() {
            None
        } else {
            Some(FeatureReading {
                bearing_rad: cells.number(BEARING, "between -pi/2 and pi/2 rad", |v| v.abs() < FRAC_PI_2)?,
                disparity_px: cells.number(DISPARITY, "above 0, at most 1e5 px", |v| v > 0.0 && v <= MOST_PX)?,
                identity: identity.map(|identity| identity as u32),
            })
        };
        Ok(Row {
            number: whole(SCAN, 1e15, "a whole number, 0 or more")?,
            time_s: cells.number(TIME, "from -1e11 to 1e11 s", |v| v.abs() <= LATE_S)?,
            pose: pose(POSE)?,
            odometry: pose(ODOMETRY)?,
            reading,
            matched: optional(MATCHED, 1.0, "0, 1 or empty")?.map(|value| value > 0.5),
        })
    }
}

struct Cells<'a> {
    cells: &'a [&'a [u8]],
    columns: &'a Columns,
}

impl Cells<'_> {
    fn cell(&self, name: usize) -> &[u8] {
        self.columns.places[name].and_then(|column| self.cells.get(column)).copied().unwrap_or_default()
    }

    fn number(&self, name: usize, bound: &str, fine: impl Fn(f64) -> bool) -> Result<f64, String> {
        let cell = self.cell(name);
        let found = if self.columns.separator == Separator::Byte(b';') && cell.contains(&b',') {
            number(&cell.iter().map(|byte| if *byte == b',' { b'.' } else { *byte }).collect::<Vec<_>>())
        } else {
            number(cell)
        };
        let hint = match name {
            BEARING if found.is_some_and(|v| v.abs() >= FRAC_PI_2 && v.is_finite()) => ": is it in degrees?",
            _ => "",
        };
        found
            .filter(|value| fine(*value))
            .ok_or_else(|| format!("column {}: {} must be {bound}{hint}", NAMES[name], quoted(cell)))
    }
}

/// Rows put together to scans.
#[derive(Default)]
struct Gathered {
    scans: Vec<FeatureRow>,
    number: Option<f64>,
    readings: usize,
}

impl Gathered {
    fn add(&mut self, row: Row, line: u64) -> Result<(), String> {
        let same = self.number.is_some_and(|number| number.total_cmp(&row.number).is_eq());
        match self.scans.last() {
            Some(last) if same => {
                let scan = &last.scan;
                if scan.time_s.total_cmp(&row.time_s).is_ne() || scan.pose != row.pose || scan.odometry != row.odometry
                {
                    return Err(format!(
                        "scan {}: this row differs from line {} in time or pose; give the readings of another moment another number",
                        row.number, last.line
                    ));
                }
            }
            Some(last) if row.time_s <= last.scan.time_s => {
                return Err(format!(
                    "column time_s: {} s is not later than the {} s of the scan before (line {}); sort the rows by time",
                    row.time_s, last.scan.time_s, last.line
                ));
            }
            _ => {}
        }
        if !same {
            let scan = FeatureScan { time_s: row.time_s, pose: row.pose, odometry: row.odometry, readings: Vec::new() };
            self.scans.push(FeatureRow { scan, matched: Vec::new(), line });
            self.number = Some(row.number);
        }
        if let (Some(reading), Some(last)) = (row.reading, self.scans.last_mut()) {
            self.readings += 1;
            if self.readings > MOST {
                return Err(format!("more than {MOST} readings; split the table"));
            }
            last.scan.readings.push(reading);
            last.matched.push(row.matched);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "scan,time_s,odom_x_m,odom_y_m,odom_theta_rad,bearing_rad,disparity_px,feature,matched";

    fn all(text: &str) -> Result<Vec<FeatureRow>, String> {
        read(text.as_bytes(), "f.csv").map_err(|error| error.to_string())
    }

    #[test]
    fn rows_of_a_number_are_a_scan() {
        let text = format!(
            "# made by hand\n{HEAD}\n0,0.5,1,2,0.5,0.1,10,7,1\n0,0.5,1,2,0.5,-0.1,12.5,,0\n3,1.5,1,2,0.6,,,,\n"
        );
        let scans = all(&text).expect("fine");
        assert_eq!(scans.len(), 2);
        assert_eq!(scans[0].scan.odometry, Some(Pose { x_m: 1.0, y_m: 2.0, theta_rad: 0.5 }));
        assert_eq!((scans[0].scan.pose, scans[0].line, scans[1].line), (None, 3, 5));
        let reading = |bearing_rad, disparity_px, identity| FeatureReading { bearing_rad, disparity_px, identity };
        assert_eq!(scans[0].scan.readings, [reading(0.1, 10.0, Some(7)), reading(-0.1, 12.5, None)]);
        assert_eq!(scans[0].matched, [Some(true), Some(false)]);
        assert!(scans[1].scan.readings.is_empty());
        assert_eq!(all(&text.replace(',', ";").replace("12.5", "12,5")), Ok(scans.clone()));
        assert_eq!(all(&text.replace(',', "\t")), Ok(scans));
    }

    #[test]
    fn what_is_wrong_is_named_with_line_column_value_and_bound() {
        let row = "0,0.5,1,2,0.5,0.1,10,7,1";
        for (text, message) in [
            (
                String::new(),
                "f.csv:1: the table is empty; the first line must have scan,time_s,bearing_rad,disparity_px",
            ),
            ("scan,time_s,bearing_rad\n".to_owned(), "f.csv:1: column disparity_px: is missing"),
            (format!("{HEAD},scan\n"), "f.csv:1: column scan: is there twice"),
            (
                "scan,time_s,bearing_rad,disparity_px,x_m\n".to_owned(),
                "columns x_m, y_m, theta_rad: give all of them or none",
            ),
            (format!("{HEAD}\n"), "f.csv:1: no scan"),
            (format!("{HEAD}\n0,1\n"), "f.csv:2: 2 fields; must be 9"),
            (
                format!("{HEAD}\n{}\n", row.replace("0.1,10", "10,10")),
                "column bearing_rad: \"10\" must be between -pi/2 and pi/2 rad: is it in degrees?",
            ),
            (
                format!("{HEAD}\n{}\n", row.replace("0.1,10", "0.1,0")),
                "column disparity_px: \"0\" must be above 0, at most 1e5 px",
            ),
            (format!("{HEAD}\n{}\n", row.replace("0.1,10", "0.1,")), "column disparity_px: \"\" must be above 0"),
            (
                format!("{HEAD}\n{}\n", row.replace("10,7", "10,-7")),
                "column feature: \"-7\" must be a whole number, 0 or more, or empty",
            ),
            (format!("{HEAD}\n{}\n", row.replace("7,1", "7,2")), "column matched: \"2\" must be 0, 1 or empty"),
            (
                format!("{HEAD}\n{}\n", row.replace("1,2,0.5", "nan,2,0.5")),
                "column odom_x_m: \"nan\" must be from -1e8 to 1e8 m",
            ),
            (
                format!("{HEAD}\n{row}\n{}\n", row.replace("1,2", "1,3")),
                "f.csv:3: scan 0: this row differs from line 2",
            ),
            (format!("{HEAD}\n{row}\n1{}\n", &row[1..]), "f.csv:3: column time_s: 0.5 s is not later than the 0.5 s"),
        ] {
            let found = all(&text).err().unwrap_or_default();
            assert!(found.contains(message), "{text}: {found}");
        }
    }

    proptest::proptest! {
        /// Whatever stands in a table, it is scans that can be taken, or one line that names the place.
        #[test]
        fn bytes_are_scans_or_one_line(cells in proptest::collection::vec("(0|1|2|-1|0\\.5|1e9|nan|inf||x|\"|;)", 0..60), width in 1usize..12) {
            let rows: Vec<String> = cells.chunks(width).map(|row| row.join(",")).collect();
            match all(&format!("{HEAD}\n{}\n", rows.join("\n"))) {
                Ok(scans) => {
                    proptest::prop_assert!(scans.windows(2).all(|pair| pair[0].scan.time_s < pair[1].scan.time_s));
                    for row in &scans {
                        proptest::prop_assert_eq!(row.matched.len(), row.scan.readings.len());
                        proptest::prop_assert!(row.scan.readings.iter().all(|r| r.disparity_px > 0.0 && r.bearing_rad.abs() < FRAC_PI_2));
                    }
                }
                Err(message) => {
                    let placed = message.strip_prefix("f.csv:").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
                    proptest::prop_assert!(placed && message.lines().count() == 1, "{}", message);
                }
            }
        }
    }
}
