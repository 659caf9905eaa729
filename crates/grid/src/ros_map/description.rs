//! The YAML file that describes a map.

use std::collections::HashMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use strict::{LONGEST_VALUE, Place, excerpt};

use super::coding::{Coding, Mode, Thresholds};
use super::error::RosMapError;
use super::values::{Values, without_noise};
use super::yaml::{self, Node};

/// A description has some 200 bytes; a file of this many is something else.
const MAX_BYTES: u64 = 1 << 16;

/// Longest name of an image, with its folders, in characters: messages repeat it.
const LONGEST_NAME: usize = 255;

/// A turn and a little, either way, in radians: what is more was meant in degrees.
const TURN: [f64; 2] = [-6.3, 6.3];

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
    /// Where values stand in the file.
    pub(super) places: Places,
}

/// Where the values of a map stand in its YAML file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Places {
    /// `resolution`.
    pub resolution: Place,
    /// `negate`.
    pub negate: Place,
    /// The first number of `origin`.
    pub origin: Place,
    /// The angle in `origin`.
    pub yaw: Place,
    /// `occupied_thresh`.
    pub occupied_thresh: Place,
    /// `free_thresh`.
    pub free_thresh: Place,
    /// `mode`, or the beginning of the file where it is left out.
    pub mode: Place,
}

impl Description {
    /// Reads and checks the file at `path`.
    pub(super) fn read(path: &Path) -> Result<Self, RosMapError> {
        let unreadable = |source| RosMapError::Unreadable { path: path.into(), source };
        let mut bytes = Vec::new();
        strict::opened(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
        Self::parse(&bytes, path, strict::is_file)
    }

    /// Checks the description in `bytes`; `exists` tells whether an image is there, `path` is named in messages.
    pub(super) fn parse(bytes: &[u8], path: &Path, exists: fn(&Path) -> bool) -> Result<Self, RosMapError> {
        let text = text(bytes, path)?;
        let keys = yaml::keys(text).map_err(|fault| syntax(path, text, fault))?;
        check(&keys, path, exists)
    }
}

/// The text of the file, without the byte order mark that some editors put before it.
fn text<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str, RosMapError> {
    let wrong = |problem| RosMapError::NotADescription { path: path.into(), problem };
    if bytes.len() as u64 > MAX_BYTES {
        return Err(wrong(format!("it has more than {MAX_BYTES} bytes")));
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(wrong("it is UTF-16 text: save it as UTF-8".into()));
    }
    let text =
        std::str::from_utf8(bytes).map_err(|e| wrong(format!("byte {} is not UTF-8 text", e.valid_up_to() + 1)))?;
    if text.contains('\0') {
        return Err(wrong("it holds zero bytes".into()));
    }
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

fn syntax(path: &Path, text: &str, fault: yaml::Fault) -> RosMapError {
    let place = |(line, column)| Place { file: path.display().to_string(), line, column };
    // The parser names the value before the tab.
    for (number, text) in (1..).zip(text.lines()) {
        let blanks = text.len() - text.trim_start().len();
        if let Some(tab) = text[..blanks].find('\t').filter(|_| blanks < text.len()) {
            let problem = "a tab stands before the text, where YAML wants blanks".to_owned();
            return RosMapError::Syntax { place: place((number, tab + 1)), problem, remedy: yaml::FORM };
        }
    }
    RosMapError::Syntax { place: place(fault.at), problem: fault.problem, remedy: fault.remedy }
}

fn check(keys: &HashMap<String, Node>, path: &Path, exists: fn(&Path) -> bool) -> Result<Description, RosMapError> {
    let values = Values { path, keys };
    let image = image(&values, path, exists)?;
    let (mode, mode_at) = mode(&values)?;
    let metres = "give the side of a pixel in metres";
    let (resolution_m, resolution) =
        values.number("resolution", "resolution: 0.05", [1e-4, 100.0], |_| metres.into())?;
    let (origin_m, yaw_rad, [origin, yaw]) = self::origin(&values)?;
    let (negate, negate_at) = values.boolean("negate", "negate: 0", "give 1 if occupied cells are white")?;
    let share = |value: f64| match value {
        1.0..=100.0 => format!("give a share of darkness, 0 white to 1 black, not percent: {}", value / 100.0),
        _ => "give a share of darkness, 0 white to 1 black".to_owned(),
    };
    let (occupied, occupied_thresh) = values.number("occupied_thresh", "occupied_thresh: 0.65", [0.0, 1.0], share)?;
    let (free, free_thresh) = values.number("free_thresh", "free_thresh: 0.196", [0.0, 1.0], share)?;
    if free > occupied {
        return Err(RosMapError::Value {
            place: free_thresh,
            key: "free_thresh",
            value: free.to_string(),
            bound: format!("at most occupied_thresh = {occupied}").into(),
            remedy: "exchange the two if they are swapped; map_server writes 0.196 and 0.65".into(),
        });
    }
    Ok(Description {
        image,
        resolution_m: without_noise(resolution_m),
        origin_m: origin_m.map(without_noise),
        yaw_rad,
        coding: Coding { mode, negate, thresholds: Thresholds { occupied, free } },
        places: Places { resolution, negate: negate_at, origin, yaw, occupied_thresh, free_thresh, mode: mode_at },
    })
}

/// Trinary where nothing is said; map_server does not mind capitals.
fn mode(values: &Values) -> Result<(Mode, Place), RosMapError> {
    let Some(given) = values.optional("mode")? else { return Ok((Mode::default(), values.place((1, 1)))) };
    let named = |mode: &Mode| mode.name().eq_ignore_ascii_case(given.value.trim());
    let remedy = "leave the key out if the image holds three shades";
    match Mode::ALL.into_iter().find(named) {
        Some(mode) => Ok((mode, values.place(given.at))),
        None => Err(values.wrong("mode", given, "trinary, scale or raw", remedy.to_owned())),
    }
}

/// The image where the file says, relative to the file, or the file of that name beside it.
fn image(values: &Values, path: &Path, exists: fn(&Path) -> bool) -> Result<PathBuf, RosMapError> {
    let given = values.text("image", "image: map.pgm")?;
    let name = given.value.trim();
    let beside = path.parent().unwrap_or(Path::new(""));
    // Either slash: the other machine may have run another system.
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if file.is_empty() || given.value.chars().count() > LONGEST_NAME {
        return Err(values.wrong("image", given, "the name of a file", "give the map's PGM or PNG image".to_owned()));
    }
    let mut tried = vec![beside.join(&given.value), beside.join(name), beside.join(file)];
    tried.dedup();
    if let Some(found) = tried.iter().find(|p| exists(p)) {
        return Ok(found.clone());
    }
    let remedy = if given.escaped && name.contains(char::is_control) {
        "in double quotes a backslash begins an escape: write forward slashes, or single quotes"
    } else {
        "put the image beside the YAML file or correct its name"
    };
    Err(RosMapError::NoImage { place: values.place(given.at), value: excerpt(name, LONGEST_VALUE), tried, remedy })
}

/// The corner, the angle, and where the two stand.
fn origin(values: &Values) -> Result<([f64; 2], f64, [Place; 2]), RosMapError> {
    let given = values.list("origin", "origin: [0.0, 0.0, 0.0]")?;
    let [x, y, theta] = given.items.as_slice() else {
        let texts: Vec<&str> = given.items.iter().map(|v| v.value.as_str()).collect();
        let place = values.place(given.at);
        let value = format!("[{}]", excerpt(&texts.join(", "), LONGEST_VALUE));
        let remedy = "give x and y of the lower-left corner in metres and the angle in radians";
        return Err(RosMapError::Value {
            place,
            key: "origin",
            value,
            bound: "three numbers".into(),
            remedy: remedy.into(),
        });
    };
    // Twice the Earth's girth; every projected coordinate fits, and floats still resolve a micrometre.
    let reach = [-1e8, 1e8];
    let corner = |_| "give x and y of the lower-left corner in metres".to_owned();
    let origin = [values.within("origin x", x, reach, corner)?, values.within("origin y", y, reach, corner)?];
    let turn = |value: f64| match value {
        _ if value.is_nan() => "savers write nan where they do not know the angle: put 0".to_owned(),
        _ if value.abs() <= 360.0 => {
            let radians = value.to_radians();
            format!("give the angle of the map in radians, counter-clockwise: {value} degrees are {radians:.4}")
        }
        _ => "give the angle of the map in radians, counter-clockwise".to_owned(),
    };
    let yaw = values.within("origin angle", theta, TURN, turn)?;
    Ok((origin, yaw, [values.place(x.at), values.place(theta.at)]))
}
