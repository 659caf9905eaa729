//! The YAML file that describes a map.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_saphyr::Spanned;

use strict::{LONGEST_REPORT, LONGEST_VALUE, excerpt};

use super::{Coding, Mode, Place, RosMapError, Thresholds};

/// A description has some 200 bytes; a file of this many is something else.
const MAX_BYTES: u64 = 1 << 16;

/// Longest name of an image, with its folders, in characters: messages repeat it.
const LONGEST_NAME: usize = 255;

/// A turn and a little, either way, in radians: what is more was meant in degrees.
const TURN: [f64; 2] = [-6.3, 6.3];

/// A value as it stands in the file: numbers too, so that an error can quote them.
type Text = Spanned<String>;

/// The keys of the file, none of them checked. Others are ignored: programs add their own.
#[derive(Deserialize)]
struct Keys {
    image: Option<Text>,
    resolution: Option<Text>,
    origin: Option<Spanned<Vec<Text>>>,
    negate: Option<Text>,
    occupied_thresh: Option<Text>,
    free_thresh: Option<Text>,
    mode: Option<Text>,
}

/// What the file says, checked.
#[derive(Debug)]
pub(super) struct Description {
    /// The image; the file exists.
    pub(super) image: PathBuf,
    /// Side of a pixel, m.
    pub(super) resolution_m: f64,
    /// Lower-left corner of the lower-left pixel, m.
    pub(super) origin_m: [f64; 2],
    /// Angle of the pixels' rows to the x axis, rad.
    pub(super) yaw_rad: f64,
    /// What the shades mean.
    pub(super) coding: Coding,
}

impl Description {
    /// Reads and checks the file at `path`.
    pub(super) fn read(path: &Path) -> Result<Self, RosMapError> {
        let unreadable = |source| RosMapError::Unreadable { path: path.into(), source };
        let mut bytes = Vec::new();
        File::open(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
        Self::parse(&bytes, path, Path::is_file)
    }

    /// Checks the description in `bytes`; `exists` says whether an image is there, `path` is named in messages.
    pub(super) fn parse(bytes: &[u8], path: &Path, exists: fn(&Path) -> bool) -> Result<Self, RosMapError> {
        let text = text(bytes, path)?;
        let options = serde_saphyr::options! { with_snippet: false };
        let keys = serde_saphyr::from_str_with_options::<Keys>(text, options).map_err(|e| syntax(path, text, &e))?;
        Checker { path, exists }.check(&keys)
    }
}

/// The text of the file, without the byte order mark that some editors put before it.
fn text<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str, RosMapError> {
    let wrong = |problem| RosMapError::NotADescription { path: path.into(), problem };
    if bytes.len() as u64 > MAX_BYTES {
        return Err(wrong(format!("it has more than {MAX_BYTES} bytes")));
    }
    let text =
        std::str::from_utf8(bytes).map_err(|e| wrong(format!("byte {} is not UTF-8 text", e.valid_up_to() + 1)))?;
    if text.contains('\0') {
        return Err(wrong("it holds zero bytes".into()));
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

fn syntax(path: &Path, text: &str, error: &serde_saphyr::Error) -> RosMapError {
    use serde_saphyr::Error as Yaml;
    let (line, column) = error.location().map_or((1, 1), |at| (at.line(), at.column()));
    // The parser names the value before the tab.
    for (number, text) in (1..).zip(text.lines()) {
        let blanks = text.len() - text.trim_start().len();
        if let Some(tab) = text[..blanks].find('\t').filter(|_| blanks < text.len()) {
            let place = Place { path: path.into(), line: number, column: tab as u64 + 1 };
            let problem = "a tab stands before the text, where YAML wants blanks".to_owned();
            return RosMapError::Syntax { place, problem };
        }
    }
    let problem = match error {
        Yaml::DuplicateMappingKey { key: Some(key), .. } => {
            format!("the key `{}` stands here a second time", excerpt(key, LONGEST_VALUE))
        }
        Yaml::MultipleDocuments { .. } => "a second YAML document begins here".to_owned(),
        Yaml::Unexpected { expected: "string scalar", .. } => {
            "one value is needed here, not a list or table".to_owned()
        }
        Yaml::Unexpected { expected: "sequence start", .. } => {
            "a list such as [0.0, 0.0, 0.0] is needed here".to_owned()
        }
        Yaml::Unexpected { expected: "mapping start", .. } => "keys and values are needed here".to_owned(),
        // The parser repeats the place at the end.
        other => excerpt(&other.to_string().replace(&format!(" at line {line}, column {column}"), ""), LONGEST_REPORT),
    };
    RosMapError::Syntax { place: Place { path: path.into(), line, column }, problem }
}

/// Turns the keys of one file into a description.
struct Checker<'a> {
    path: &'a Path,
    exists: fn(&Path) -> bool,
}

impl Checker<'_> {
    fn check(&self, keys: &Keys) -> Result<Description, RosMapError> {
        let image = self.image(&keys.image)?;
        let mode = self.mode(&keys.mode)?;
        let resolution_m = self.number(
            "resolution",
            &keys.resolution,
            "resolution: 0.05",
            [1e-4, 100.0],
            "give the side of a pixel in metres",
        )?;
        let (origin_m, yaw_rad) = self.origin(&keys.origin)?;
        let negate = self.negate(&keys.negate)?;
        let share = "give a share of darkness, 0 white to 1 black";
        let occupied_thresh =
            self.number("occupied_thresh", &keys.occupied_thresh, "occupied_thresh: 0.65", [0.0, 1.0], share)?;
        let free_thresh = self.number("free_thresh", &keys.free_thresh, "free_thresh: 0.196", [0.0, 1.0], share)?;
        if let Some(given) = keys.free_thresh.as_ref().filter(|_| free_thresh > occupied_thresh) {
            let bound = format!("at most occupied_thresh = {occupied_thresh}");
            return Err(self.wrong("free_thresh", given, &bound, "map_server writes 0.196 and 0.65"));
        }
        let coding = Coding { mode, negate, thresholds: Thresholds { occupied: occupied_thresh, free: free_thresh } };
        Ok(Description { image, resolution_m, origin_m, yaw_rad, coding })
    }

    /// Trinary where nothing is said; map_server does not mind capitals.
    fn mode(&self, given: &Option<Text>) -> Result<Mode, RosMapError> {
        let Some(given) = given else { return Ok(Mode::default()) };
        let named = |mode: &Mode| mode.name().eq_ignore_ascii_case(given.value.trim());
        let remedy = "leave the key out if the image holds three shades";
        Mode::ALL.into_iter().find(named).ok_or_else(|| self.wrong("mode", given, "trinary, scale or raw", remedy))
    }

    /// The image where the file says, relative to the file, or the file of that name beside it.
    fn image(&self, given: &Option<Text>) -> Result<PathBuf, RosMapError> {
        let given = self.present("image", given, "image: map.pgm")?;
        let name = given.value.trim();
        let beside = self.path.parent().unwrap_or(Path::new(""));
        // Either slash: the other machine may have run another system.
        let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
        if file.is_empty() || given.value.chars().count() > LONGEST_NAME {
            return Err(self.wrong("image", given, "the name of a file", "give the map's PGM or PNG image"));
        }
        let mut tried = vec![beside.join(&given.value), beside.join(name), beside.join(file)];
        tried.dedup();
        match tried.iter().find(|p| (self.exists)(p)) {
            Some(found) => Ok(found.clone()),
            None => Err(RosMapError::NoImage { place: self.place(given), value: excerpt(name, LONGEST_VALUE), tried }),
        }
    }

    fn origin(&self, given: &Option<Spanned<Vec<Text>>>) -> Result<([f64; 2], f64), RosMapError> {
        let example = "origin: [0.0, 0.0, 0.0]";
        let given = self.present("origin", given, example)?;
        let [x, y, theta] = given.value.as_slice() else {
            let values: Vec<&str> = given.value.iter().map(|v| v.value.as_str()).collect();
            let place = self.place(given);
            let value = format!("[{}]", excerpt(&values.join(", "), LONGEST_VALUE));
            let remedy = "give x and y of the lower-left corner in metres and the angle in radians";
            return Err(RosMapError::Value { place, key: "origin", value, bound: "three numbers".into(), remedy });
        };
        // Twice the Earth's girth; every projected coordinate fits, and floats still resolve a micrometre.
        let reach = [-1e8, 1e8];
        let corner = "give x and y of the lower-left corner in metres";
        let origin = [self.within("origin x", x, reach, corner)?, self.within("origin y", y, reach, corner)?];
        let turn = "give the angle of the map in radians, counter-clockwise";
        Ok((origin, self.within("origin angle", theta, TURN, turn)?))
    }

    fn negate(&self, given: &Option<Text>) -> Result<bool, RosMapError> {
        let given = self.present("negate", given, "negate: 0")?;
        match given.value.trim() {
            "0" | "false" | "False" => Ok(false),
            "1" | "true" | "True" => Ok(true),
            _ => Err(self.wrong("negate", given, "0 or 1", "give 1 if occupied cells are white")),
        }
    }

    fn number(
        &self,
        key: &'static str,
        given: &Option<Text>,
        example: &'static str,
        range: [f64; 2],
        remedy: &'static str,
    ) -> Result<f64, RosMapError> {
        self.within(key, self.present(key, given, example)?, range, remedy)
    }

    fn within(
        &self,
        key: &'static str,
        given: &Text,
        [low, high]: [f64; 2],
        remedy: &'static str,
    ) -> Result<f64, RosMapError> {
        let number = given.value.trim().parse::<f64>().ok();
        // A number that is none (NaN) is in no range.
        number
            .filter(|n| (low..=high).contains(n))
            .ok_or_else(|| self.wrong(key, given, &format!("a number from {low} to {high}"), remedy))
    }

    fn present<'a, T>(
        &self,
        key: &'static str,
        given: &'a Option<T>,
        example: &'static str,
    ) -> Result<&'a T, RosMapError> {
        given.as_ref().ok_or_else(|| RosMapError::MissingKey { path: self.path.into(), key, example })
    }

    fn wrong(&self, key: &'static str, given: &Text, bound: &str, remedy: &'static str) -> RosMapError {
        let value = excerpt(given.value.trim(), LONGEST_VALUE);
        RosMapError::Value { place: self.place(given), key, value, bound: bound.to_owned(), remedy }
    }

    fn place<T>(&self, given: &Spanned<T>) -> Place {
        let at = &given.referenced;
        Place { path: self.path.into(), line: at.line(), column: at.column() }
    }
}
