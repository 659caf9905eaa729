//! The folder that a batch program is given, and the map that it leaves there.

use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use grid::{GridSpec, Raster, npy};
use mapper::Model;
use sensor::Scan;

use super::fault::Fault;
use super::watcher::Watched;
use super::{described, unique};
use crate::jobs::interruption::{self, CleanUp};

/// The file that a program writes.
pub(super) const MAP: &str = "occupancy.npy";

/// Bytes of an NPY file besides its values, at most: version 1 has no longer header.
const HEADER: u64 = 65_546;

/// What a program may write besides its map, bytes.
const SPARE: u64 = 1 << 30;

/// Writes a file.
type Fill<'a> = dyn Fn(&mut dyn Write) -> io::Result<()> + 'a;

/// A folder of our own among the temporary ones, which vanishes with the value.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// Bytes that we have written.
    given: u64,
    _watched: Watched,
    _clean_up: CleanUp,
}

impl Folder {
    /// Makes the folder with `grid.json`, `sensors.json` and `scans.csv`.
    ///
    /// # Errors
    /// Whatever the system reports.
    pub(super) fn make(model: &Model, scans: &[Scan]) -> Result<Self, Fault> {
        let refuse =
            |what: &Path, source| Fault::Exchange { what: format!("{} cannot be written", what.display()), source };
        let word = unique();
        let path = free_name(&word);
        let own = path.clone();
        let clean_up = interruption::clean_up(move || drop(fs::remove_dir_all(&own)));
        let watched = Watched::folder(&word, &path);
        make_private(&path).map_err(|source| refuse(&path, source))?;
        let mut folder = Self { path, given: 0, _watched: watched, _clean_up: clean_up };
        let files: [(&str, &Fill); 3] = [
            ("grid.json", &|out| writeln!(out, "{:#}", described::grid(model))),
            ("sensors.json", &|out| writeln!(out, "{:#}", described::sensors(model))),
            ("scans.csv", &|out| write_scans(model, scans, out)),
        ];
        for (name, fill) in files {
            let file = folder.path.join(name);
            let written = File::create(&file).and_then(|file| {
                let mut out = BufWriter::new(file);
                fill(&mut out)?;
                out.flush()
            });
            written.map_err(|source| refuse(&file, source))?;
        }
        folder.given = size(&folder.path);
        Ok(folder)
    }

    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Refuses more than a map and what it may take to make it.
    pub(super) fn check_size(&self, grid: &GridSpec) -> Result<(), Fault> {
        let (bytes, most) = (size(&self.path).saturating_sub(self.given), largest(grid) + SPARE);
        if bytes > most { Err(Fault::Disk { bytes, most }) } else { Ok(()) }
    }

    /// The map that the program has left; `unseen` in the place of NaN.
    pub(super) fn map(&self, grid: &GridSpec, unseen: f64) -> Result<Raster<f64>, Fault> {
        let path = self.path.join(MAP);
        // Not followed: behind a link could be anything, and a pipe would be waited for.
        let found = fs::symlink_metadata(&path).map_err(|source| match source.kind() {
            io::ErrorKind::NotFound => Fault::NoFile { file: MAP },
            _ => Fault::Exchange { what: format!("{MAP} cannot be read"), source },
        })?;
        if !found.is_file() {
            return Err(Fault::NoRegularFile { file: MAP });
        }
        let (bytes, most) = (found.len(), largest(grid));
        if bytes > most {
            return Err(Fault::TooLarge { file: MAP, bytes, most, grid: *grid });
        }
        let file = File::open(&path);
        let file = file.map_err(|source| Fault::Exchange { what: format!("{MAP} cannot be read"), source })?;
        let array = npy::read_in_full(BufReader::new(file), bytes, Path::new(MAP))?;
        if (array.width, array.height) != (grid.width, grid.height) {
            let (found_height, found_width) = (array.height as u64, array.width as u64);
            return Err(Fault::Shape { found_height, found_width, grid: *grid });
        }
        Ok(Raster::new(*grid, array.occupancy.into_iter().map(|share| share.unwrap_or(unseen)).collect()))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Bytes of the largest map: float64.
fn largest(grid: &GridSpec) -> u64 {
    HEADER + 8 * grid.cells() as u64
}

fn free_name(word: &str) -> PathBuf {
    let temporary = std::env::temp_dir();
    temporary.canonicalize().unwrap_or(temporary).join(format!("sightgrid-{word}"))
}

/// A folder that was not there before, for nobody else.
fn make_private(path: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Bytes of all files in a folder and the folders in it; links are not followed.
fn size(folder: &Path) -> u64 {
    let of = |entry: fs::DirEntry| match entry.metadata() {
        Ok(found) if found.is_dir() => size(&entry.path()),
        Ok(found) => found.len(),
        Err(_) => 0,
    };
    fs::read_dir(folder).into_iter().flatten().flatten().map(of).sum()
}

/// The table of scans, as crate `logs` reads it. Numbers are those that mappers in this process get, to the last digit.
fn write_scans(model: &Model, scans: &[Scan], mut out: impl Write) -> io::Result<()> {
    let mut readings: Vec<&str> = model.sensors.iter().map(|sensor| described::reading(&**sensor)).collect();
    readings.sort_unstable();
    readings.dedup();
    writeln!(out, "scan,time_s,sensor,x_m,y_m,theta_rad,bearing_rad,{}", readings.join(","))?;
    for (number, scan) in scans.iter().enumerate() {
        let own = described::reading(&**model.sensors.of(scan));
        let place = readings.iter().position(|name| *name == own).unwrap_or(0);
        let (before, behind) = (",".repeat(place), ",".repeat(readings.len() - 1 - place));
        let Scan { time_s, sensor, pose, .. } = scan;
        let head = format!("{number},{time_s},{sensor},{},{},{}", pose.x_m, pose.y_m, pose.theta_rad);
        for (bearing, reading) in scan.bearings_rad.iter().zip(&scan.readings) {
            let reading = reading.map_or_else(String::new, |reading| reading.to_string());
            writeln!(out, "{head},{bearing},{before}{reading}{behind}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mapper::Sensors;
    use sensor::{Laser, Pose, Stereo};

    use super::*;

    fn model(width: usize) -> Model {
        let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 2 };
        Model::new(grid, Arc::new(Stereo::default()))
    }

    fn scan(sensor: usize, readings: Vec<Option<f64>>) -> Scan {
        let pose = Pose { x_m: 1.0 / 3.0, y_m: -2.0, theta_rad: 0.5 };
        Scan { sensor, time_s: 1.5, pose, bearings_rad: vec![-0.25, 0.0, 0.25], readings }
    }

    #[test]
    fn the_table_has_every_digit_and_a_column_for_every_kind_of_reading() {
        let mut model = model(3);
        model.sensors = Sensors::new(vec![Arc::new(Stereo::default()), Arc::new(Laser::default())]);
        let scans = [scan(0, vec![Some(0.1), None, Some(1e-9)]), scan(1, vec![Some(f64::INFINITY), None, Some(2.0)])];
        let mut text = Vec::new();
        write_scans(&model, &scans, &mut text).expect("memory");
        let expected = "scan,time_s,sensor,x_m,y_m,theta_rad,bearing_rad,disparity_px,range_m\n\
            0,1.5,0,0.3333333333333333,-2,0.5,-0.25,0.1,\n\
            0,1.5,0,0.3333333333333333,-2,0.5,0,,\n\
            0,1.5,0,0.3333333333333333,-2,0.5,0.25,0.000000001,\n\
            1,1.5,1,0.3333333333333333,-2,0.5,-0.25,,inf\n\
            1,1.5,1,0.3333333333333333,-2,0.5,0,,\n\
            1,1.5,1,0.3333333333333333,-2,0.5,0.25,,2\n";
        assert_eq!(String::from_utf8(text).expect("text"), expected);
    }

    #[test]
    fn a_folder_is_private_and_vanishes() {
        let model = model(3);
        let folder = Folder::make(&model, &[scan(0, vec![None; 3])]).expect("writable");
        let path = folder.path().to_owned();
        for name in ["grid.json", "sensors.json", "scans.csv"] {
            assert!(path.join(name).is_file(), "{name}");
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            assert_eq!(fs::metadata(&path).expect("there").permissions().mode() & 0o777, 0o700);
        }
        drop(folder);
        assert!(!path.exists());
    }

    #[test]
    fn a_map_is_read_in_full_and_what_is_none_is_a_fault() {
        let model = model(2);
        let grid = model.grid;
        let folder = Folder::make(&model, &[]).expect("writable");
        let path = folder.path().join(MAP);
        let fault = || folder.map(&grid, 0.1).expect_err("no map").to_string();
        assert!(fault().starts_with("occupancy.npy was not written"), "{}", fault());

        let header = |shape: &str, descr: &str| {
            let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
            let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
            bytes.extend(format!("{text:<117}\n").bytes());
            bytes
        };
        let values = [0.1, f64::NAN, 0.123_456_789_012_345_68, 1.0];
        let doubles = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        fs::write(&path, [header("(2, 2)", "<f8"), doubles(&values)].concat()).expect("writable");
        let map = folder.map(&grid, 0.25).expect("a map");
        assert_eq!(map.values(), [0.1, 0.25, values[2], 1.0]);

        let cases = [
            ([header("(2, 2)", "<f8"), doubles(&values[..3])].concat(), "32 bytes, but 24 follow its header"),
            ([header("(1, 4)", "<f8"), doubles(&values)].concat(), "the map is 1 x 4: must be 2 x 2"),
            ([header("(2, 2)", "<f8"), doubles(&[0.0, 0.5, f64::INFINITY, 1.0])].concat(), "value [1, 0] = inf"),
            ([header("(2, 2)", "<f8"), doubles(&[0.0, 0.5, -1e-9, 1.0])].concat(), "value [1, 0] = -0.000000001"),
            (b"PNG".to_vec(), "occupancy.npy"),
            (vec![0; HEADER as usize + 33], "must be at most 65578"),
        ];
        for (bytes, part) in cases {
            fs::write(&path, bytes).expect("writable");
            assert!(fault().contains(part) && !fault().contains('\n'), "{part}: {}", fault());
        }
        fs::remove_file(&path).expect("there");
        fs::create_dir(&path).expect("writable");
        assert!(fault().contains("no regular file"), "{}", fault());
    }

    #[test]
    fn what_a_program_writes_is_measured_in_folders_too() {
        let model = model(2);
        let folder = Folder::make(&model, &[]).expect("writable");
        assert!(folder.check_size(&model.grid).is_ok());
        fs::create_dir(folder.path().join("cache")).expect("writable");
        // Its length counts, on whatever blocks it is.
        let large = File::create(folder.path().join("cache/large")).expect("writable");
        large.set_len(SPARE + largest(&model.grid) + 1).expect("sparse");
        assert!(matches!(folder.check_size(&model.grid), Err(Fault::Disk { bytes, most }) if bytes == most + 1));
    }
}
