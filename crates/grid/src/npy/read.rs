//! Occupancy out of NPY files.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use thiserror::Error;

use strict::{LONGEST_VALUE, Opened, excerpt};

use super::header::Header;
use super::meaning::Meaning;
use super::number::Number;

/// As many cells as a map's image may have pixels.
const MAX_CELLS: u64 = 100_000_000;

/// Occupancy without a place: an NPY file knows no lengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Array<T = f32> {
    /// Cells along x.
    pub width: usize,
    /// Cells along y.
    pub height: usize,
    /// Share of occupancy from 0 to 1, `None` where nothing is known; row by row, row 0 the lowest.
    pub occupancy: Vec<Option<T>>,
}

/// Why a file is no map. Every message is one line: place, value, bound, what to do.
#[derive(Debug, Error)]
pub enum NpyError {
    /// The file cannot be opened or read.
    #[error("{}: cannot be read: {source}; check the path and the permissions", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system reports.
        source: io::Error,
    },
    /// Not an NPY file, or one that does not hold what its header says.
    #[error("{}: {problem}; save the map again with numpy.save", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// An array that is no map.
    #[error("{}: {what} = {value}: must be {bound}; {remedy}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// What of the array.
        what: String,
        /// What it is.
        value: String,
        /// What it must be.
        bound: String,
        /// What to do.
        remedy: &'static str,
    },
}

impl NpyError {
    /// Whether the system, not the content of the file, is at fault.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }
}

/// Reads a two-dimensional array, in C or Fortran order: rows are y, row 0 is the lowest.
///
/// float16, float32 and float64 are shares of occupancy from 0 to 1, NaN is unknown, and float64 is rounded to float32;
/// bool is occupied or free; integers are percent as in a ROS `OccupancyGrid`, -1 or 255 unknown. Pictures, states and
/// percents that are stored as something else are refused, each with the line of numpy that mends it.
///
/// # Errors
/// A file that cannot be read, is no NPY file, ends too early, or holds another shape, type or value.
pub fn read(path: &Path) -> Result<Array, NpyError> {
    let (file, length) = opened(path)?;
    read_from(file, length, path)
}

/// As [`read`], with float64 as it is.
///
/// # Errors
/// As [`read`].
pub fn read_file_in_full(path: &Path) -> Result<Array<f64>, NpyError> {
    let (file, length) = opened(path)?;
    read_in_full(file, length, path)
}

/// A file and its length.
fn opened(path: &Path) -> Result<(BufReader<Opened>, u64), NpyError> {
    let unreadable = |source| Reader { path }.unreadable(source);
    let file = strict::opened(path).map_err(unreadable)?;
    let length = file.length().map_err(unreadable)?;
    Ok((BufReader::new(file), length))
}

/// As [`read_from`], with float64 as it is.
///
/// # Errors
/// As [`read`].
pub fn read_in_full(file: impl io::Read, length: u64, path: &Path) -> Result<Array<f64>, NpyError> {
    read_as(file, length, path, |share| share)
}

/// As [`read`], from a source of exactly `length` bytes; `path` is named in messages.
///
/// # Errors
/// As [`read`].
pub fn read_from(file: impl io::Read, length: u64, path: &Path) -> Result<Array, NpyError> {
    read_as(file, length, path, |share| share as f32)
}

fn read_as<T: Clone>(
    mut file: impl io::Read,
    length: u64,
    path: &Path,
    kept: impl Fn(f64) -> T,
) -> Result<Array<T>, NpyError> {
    let reader = Reader { path };
    let unreadable = |source| reader.unreadable(source);
    let header = reader.header(&mut file)?;
    let [height, width] = reader.shape(&header)?;
    let number = reader.number(&header)?;
    let needed = height * width * number.bytes as u64; // at most 800 million
    let held = length.saturating_sub(header.bytes);
    if held != needed {
        let problem = format!(
            "{height} x {width} values of type {} are {needed} bytes, but {held} follow its header",
            header.descr
        );
        return Err(reader.damaged(problem));
    }
    let (height, width) = (height as usize, width as usize);
    let mut meaning = Meaning::of(&number);
    let mut occupancy = vec![None; width * height];
    let mut bytes = [0; 8];
    for k in 0..occupancy.len() {
        let bytes = &mut bytes[..number.bytes];
        file.read_exact(bytes).map_err(unreadable)?;
        let value = number.value(bytes);
        let (row, column) = if header.fortran_order { (k % height, k / height) } else { (k / width, k % width) };
        let share = meaning.occupancy(value).ok_or_else(|| {
            let (bound, remedy) = meaning.range(value);
            reader.value(&format!("value [{row}, {column}]"), number.shown(value), bound, remedy)
        })?;
        occupancy[row * width + column] = share.map(&kept);
    }
    if let Some((what, value, bound, remedy)) = meaning.doubt() {
        return Err(reader.value(what, value, bound, remedy));
    }
    Ok(Array { width, height, occupancy })
}

/// Reads one file, which its errors name.
struct Reader<'a> {
    path: &'a Path,
}

impl Reader<'_> {
    fn header(&self, file: &mut impl io::Read) -> Result<Header, NpyError> {
        Header::read(file).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => self.damaged(error.to_string()),
            _ => self.unreadable(error),
        })
    }

    fn shape(&self, header: &Header) -> Result<[u64; 2], NpyError> {
        let shape = header.shape.as_slice();
        let cells = shape.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
        match (shape, cells) {
            (&[height, width], Some(1..=MAX_CELLS)) => Ok([height, width]),
            (&[_, _, channels @ 2..=4], _) => {
                let value = format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", "));
                let bound = format!("two numbers, rows and columns; this is a picture of {channels} channels");
                Err(self.value("shape", value, &bound, "save one of them: numpy.save(path, a[:, :, 0])"))
            }
            _ => {
                let value = format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", "));
                let bound = "two numbers, rows and columns, of at least 1 and at most 100000000 cells in all";
                Err(self.value("shape", value, bound, "save one map, cropped or with larger cells"))
            }
        }
    }

    fn number(&self, header: &Header) -> Result<Number, NpyError> {
        Number::of(&header.descr).ok_or_else(|| {
            let bound = "float16, float32, float64, bool, or integers of 1 to 8 bytes";
            self.value("dtype", header.descr.clone(), bound, "convert it with astype(\"float32\")")
        })
    }

    fn unreadable(&self, source: io::Error) -> NpyError {
        NpyError::Unreadable { path: self.path.into(), source }
    }

    fn damaged(&self, problem: String) -> NpyError {
        NpyError::Damaged { path: self.path.into(), problem }
    }

    fn value(&self, what: &str, value: String, bound: &str, remedy: &'static str) -> NpyError {
        let value = excerpt(&value, LONGEST_VALUE);
        NpyError::Value { path: self.path.into(), what: what.to_owned(), value, bound: bound.to_owned(), remedy }
    }
}
