//! The first line of a table: the separator and where the columns are.

use crate::carmen::is_message_name;
use crate::fields::number;

/// Names of the columns.
pub(super) const NAMES: [&str; 13] = [
    "scan",
    "time_s",
    "x_m",
    "y_m",
    "theta_rad",
    "bearing_rad",
    "disparity_px",
    "range_m",
    "sensor",
    "odom_x_m",
    "odom_y_m",
    "odom_theta_rad",
    "sonar_m",
];
// Where each stands in NAMES.
pub(super) const SCAN: usize = 0;
pub(super) const TIME: usize = 1;
pub(super) const X: usize = 2;
pub(super) const Y: usize = 3;
pub(super) const THETA: usize = 4;
pub(super) const BEARING: usize = 5;
pub(super) const DISPARITY: usize = 6;
pub(super) const RANGE: usize = 7;
pub(super) const SENSOR: usize = 8;
pub(super) const ODOMETRY: [usize; 3] = [9, 10, 11];
pub(super) const SONAR: usize = 12;

/// The columns of readings, in the order of the sensors of a table that does not number them.
pub(super) const READINGS: [usize; 3] = [DISPARITY, RANGE, SONAR];

/// What a first line is.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Head {
    /// The names of columns, or something else in columns.
    Names,
    /// A comment.
    Comment,
    /// Nothing of a table.
    None,
}

/// What stands between fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// Any number of blanks.
    Blanks,
    /// One such byte.
    Byte(u8),
}

impl Separator {
    pub(super) fn of(head: &[u8]) -> Self {
        let found = [b';', b',', b'\t'].into_iter().find(|byte| head.contains(byte));
        found.map_or(Self::Blanks, Self::Byte)
    }

    /// The fields of a row without blanks and quotes around them.
    pub(super) fn cells(self, line: &[u8]) -> Vec<&[u8]> {
        let plain =
            |cell: &'_ [u8]| -> usize { usize::from(cell.len() > 1 && cell[0] == b'"' && cell.ends_with(b"\"")) };
        let unquoted = |cell| {
            let cell: &[u8] = cell;
            let quotes = plain(cell);
            &cell[quotes..cell.len() - quotes]
        };
        match self {
            Self::Blanks => line.split(u8::is_ascii_whitespace).filter(|cell| !cell.is_empty()).map(unquoted).collect(),
            Self::Byte(byte) => line.split(|other| *other == byte).map(|cell| unquoted(cell.trim_ascii())).collect(),
        }
    }
}

impl Head {
    /// What a first line is.
    pub(crate) fn of(line: &[u8]) -> Self {
        let comment = line.trim_ascii_start().starts_with(b"#");
        let cells = names(line);
        if cells.iter().filter(|name| NAMES.contains(&name.as_str())).count() >= 2 {
            return Self::Names;
        }
        if comment {
            return Self::Comment;
        }
        let bytes = Separator::of(line).cells(line);
        let numbers = bytes.len() >= 3 && bytes.iter().all(|cell| number(cell).is_some());
        let message =
            bytes.first().is_some_and(|first| is_message_name(first) && first.iter().all(|b| !b.is_ascii_lowercase()));
        let columns = bytes.len() >= 3 && Separator::of(line) != Separator::Blanks && line.is_ascii() && !message;
        if numbers || columns { Self::Names } else { Self::None }
    }
}

/// The cells of a head in lower case, without the sign of a comment.
fn names(line: &[u8]) -> Vec<String> {
    let line = line.trim_ascii_start();
    let line = line.strip_prefix(b"#").unwrap_or(line);
    let cells = Separator::of(line).cells(line).into_iter();
    cells.map(|cell| String::from_utf8_lossy(cell).to_ascii_lowercase()).collect()
}

/// Where the columns are.
#[derive(Debug)]
pub(super) struct Columns {
    pub(super) separator: Separator,
    pub(super) width: usize,
    places: [Option<usize>; NAMES.len()],
}

impl Columns {
    /// Of a head.
    pub(super) fn new(head: &[u8]) -> Result<Self, String> {
        let names = names(head);
        let must = [SCAN, X, Y, THETA, BEARING];
        let all = || must.map(|k| NAMES[k]).join(",") + " and one of range_m, disparity_px and sonar_m";
        if names.iter().all(|name| number(name.as_bytes()).is_some()) {
            let hint = if names.len() == 8 { "; a trajectory is given beside a log (--trajectory)" } else { "" };
            return Err(format!(
                "{} numbers, and no names of columns; the first line must have {}{hint}",
                names.len(),
                all()
            ));
        }
        let mut places = [None; NAMES.len()];
        for (place, name) in places.iter_mut().zip(NAMES) {
            let mut found = (0..names.len()).filter(|k| names[*k] == name);
            *place = found.next();
            if found.next().is_some() {
                return Err(format!("column {name}: is there twice; name each column once"));
            }
        }
        let missing: Vec<_> = must.into_iter().filter(|k| places[*k].is_none()).map(|k| NAMES[k]).collect();
        if !missing.is_empty() {
            let found: String = names.join(",").chars().filter(|c| !c.is_control()).take(100).collect();
            let are = if missing.len() == 1 { "is" } else { "are" };
            let columns = if missing.len() == 1 { "column" } else { "columns" };
            return Err(format!(
                "{columns} {}: {are} missing; the first line has {found}, and must have {}",
                missing.join(", "),
                all()
            ));
        }
        if READINGS.iter().all(|reading| places[*reading].is_none()) {
            return Err("columns disparity_px, range_m and sonar_m: all are missing; give one for each kind of sensor"
                .to_owned());
        }
        Ok(Self { separator: Separator::of(head), width: names.len(), places })
    }

    /// Where a column is, if it is there.
    pub(super) fn place(&self, name: usize) -> Option<usize> {
        self.places[name]
    }

    /// Which columns of readings there are, by their places in [`READINGS`].
    pub(super) fn readings(&self) -> impl Iterator<Item = usize> {
        (0..READINGS.len()).filter(|kind| self.places[READINGS[*kind]].is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m";

    #[test]
    fn heads_are_told_from_messages_and_comments() {
        for (line, expected) in [
            (HEAD, Head::Names),
            ("\"scan\" , range_m", Head::Names),
            ("Scan;X_m;range_M", Head::Names),
            ("SCAN\tTIME_S\tX_M", Head::Names),
            ("# scan,x_m,y_m", Head::Names),
            ("scan x_m y_m", Head::Names),
            ("id,x,y,yaw", Head::Names),
            ("0,0,0,0,0,1.5", Head::Names),
            ("1.5 0 0 0 0 0 0 1", Head::Names),
            ("# scan,range", Head::Comment),
            ("# CARMEN Logfile", Head::Comment),
            ("FLASER 1 2", Head::None),
            ("FLASER\t1\t2\t3", Head::None),
            ("hello", Head::None),
        ] {
            assert_eq!(Head::of(line.as_bytes()), expected, "{line}");
        }
    }

    #[test]
    fn a_head_names_each_column_once_and_one_reading() {
        for (head, message) in [
            ("scan,x_m,y_m,theta_rad,range_m", "column bearing_rad: is missing; the first line has scan,"),
            (
                "id,x,y,yaw,angle,dist",
                "columns scan, x_m, y_m, theta_rad, bearing_rad: are missing; the first line has id,x",
            ),
            ("0,0,0,0,0,1.5", "6 numbers, and no names of columns; the first line must have scan,x_m"),
            ("1.5 0 0 0 0 0 0 1", "a trajectory is given beside a log"),
            ("scan,x_m,y_m,theta_rad,bearing_rad", "columns disparity_px, range_m and sonar_m: all are missing"),
            (&format!("{HEAD},x_m"), "column x_m: is there twice"),
        ] {
            let found = Columns::new(head.as_bytes()).err().unwrap_or_default();
            assert!(found.contains(message), "{head}: {found}");
        }
    }
}
