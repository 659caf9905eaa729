//! `convert` as a user meets it: what it writes, what it keeps, and what it refuses.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use grid::ros_map::{self, RosMap};
use grid::{GridSpec, Raster, npy};
use tempfile::TempDir;

use crate::checked::checked;

const YAML: &str = "\
image: m.pgm
resolution: 0.05
origin: [-4.0, 2.5, 0.25]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
";

/// Occupied, free, unknown; unknown, unknown, occupied.
const PGM: &[u8] = b"P5\n3 2\n255\n\x00\xfe\xcd\xcd\xcd\x00";

/// A folder with a map `m.yaml` and shares `p.npy`.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().expect("temporary folder") };
        place.put("m.yaml", YAML.as_bytes());
        place.put("m.pgm", PGM);
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width: 3, height: 2 };
        let shares = vec![Some(0.05), Some(0.651), None, Some(0.1959), Some(1.0), Some(0.5)];
        let mut bytes = Vec::new();
        npy::write_occupancy(&Raster::new(spec, shares), &mut bytes).expect("memory");
        place.put("p.npy", &bytes);
        place
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path().join(name), bytes).expect("writable");
    }

    fn get(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).expect(name)
    }

    fn map(&self, name: &str) -> RosMap {
        ros_map::read(&self.path().join(name)).expect(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path()).expect("there").map(|e| e.expect("entry").file_name());
        let mut names: Vec<_> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Converts and expects an exit code; gives stdout and stderr.
    fn expect(&self, code: i32, args: &[&str]) -> (String, String) {
        let mut command = Command::cargo_bin("experiments").expect("built");
        checked(code, &args, &command.current_dir(self.path()).arg("convert").args(args).output().expect("runs"))
    }

    fn refused(&self, args: &[&str], message: &str) {
        let before: Vec<_> =
            self.names().into_iter().map(|name| (fs::read(self.path().join(&name)).ok(), name)).collect();
        let (out, err) = self.expect(2, args);
        assert!(err.contains(message), "{args:?}: {err}");
        assert_eq!(out, "");
        let after: Vec<_> =
            self.names().into_iter().map(|name| (fs::read(self.path().join(&name)).ok(), name)).collect();
        assert_eq!(before, after, "{args:?} left something");
    }
}

#[test]
fn a_map_comes_back_from_every_form() {
    let place = Place::new();
    let before = place.map("m.yaml");
    let at = ["--resolution", "0.05", "--origin", "-4,2.5,0.25"];
    for (mode, negate) in [("trinary", false), ("trinary", true), ("scale", false), ("scale", true), ("raw", false)] {
        let options: &[&str] = if negate { &["--mode", mode, "--negate"] } else { &["--mode", mode] };
        place.expect(0, &[&["m.yaml", "a.yaml", "--force"], options].concat());
        assert_eq!(place.map("a.yaml").coding.negate, negate);
        place.expect(0, &["a.yaml", "b.npy", "--force"]);
        let (out, _) = place.expect(0, &["b.npy", "c.yaml", "--force", at[0], at[1], at[2], at[3]]);
        assert_eq!(out, "c.pgm, c.yaml: 3 x 2 cells: 1 free, 2 occupied, 3 unknown\n");
        if !negate {
            place.expect(0, &["c.yaml", "d.png", "--force", "--mode", mode]);
            place.expect(0, &[&["d.png", "c.yaml", "--force", "--read-as", mode], &at[..]].concat());
        }
        let after = place.map("c.yaml");
        assert_eq!(
            (after.spec, after.yaw_rad, after.occupancy),
            (before.spec, before.yaw_rad, before.occupancy.clone())
        );
        assert_eq!(place.get("c.pgm"), PGM, "{mode} {negate}");
    }
}

#[test]
fn shares_make_a_map_and_a_second_one_in_percent() {
    let place = Place::new();
    place.put("run.json", br#"{"grid": {"cell_m": 0.1, "origin_m": [1.5, -2.0], "width": 3, "height": 2}}"#);
    let (out, _) = place.expect(0, &["p.npy", "n.yaml"]);
    assert_eq!(
        out,
        "n.pgm, n.yaml, n-raw.pgm, n-raw.yaml: 3 x 2 cells: 2 free, 2 occupied, 2 unknown\n4 cells had a share between 0 and 1: kept to a whole percent in the second map\n"
    );
    let [states, percent] = ["n.yaml", "n-raw.yaml"].map(|name| place.map(name));
    let spec = GridSpec { cell_m: 0.1, origin_m: [1.5, -2.0], width: 3, height: 2 };
    assert_eq!((states.spec, percent.spec), (spec, spec));
    assert_eq!(states.cells(), percent.cells());
    // 65.1 % is occupied and 19.59 % free, so that they are 66 and 19 rather than 65 and 20.
    let whole: Vec<_> = percent.occupancy.values().iter().map(|o| o.map(|o| (o * 100.0).round() as u8)).collect();
    assert_eq!(whole, [Some(5), Some(66), None, Some(19), Some(100), Some(50)]);

    let (out, _) = place.expect(0, &["p.npy", "o.yaml", "--mode", "trinary", "--occupied-thresh", "0.7"]);
    assert!(out.contains("2 free, 1 occupied, 3 unknown") && out.contains("kept nowhere"), "{out}");
    assert!(!place.path().join("o-raw.yaml").exists());
    assert!(String::from_utf8(place.get("o.yaml")).expect("text").contains("occupied_thresh: 0.7\n"));

    place.expect(0, &["p.npy", "q.npy"]);
    assert_eq!(place.get("p.npy"), place.get("q.npy"), "to the bit");
}

#[test]
fn another_place_keeps_the_cells() {
    let place = Place::new();
    place.expect(0, &["m.yaml", "straight.yaml", "--origin", "-4,2.5,0", "--resolution", "0.1"]);
    let map = place.map("straight.yaml");
    assert!(!map.is_turned() && (map.spec.cell_m - 0.1).abs() < 1e-12);
    assert_eq!(place.get("straight.pgm"), PGM);
}

#[test]
fn what_is_refused_leaves_everything_as_it_was() {
    let place = Place::new();
    place.refused(&["m.yaml", "m.yaml"], "m.pgm: is read by this run; choose another name to write to");
    place.refused(&["m.yaml", "./m.pgm"], "is read by this run");
    place.refused(&["p.npy", "../p.npy/../x/p.npy"], "cannot be written");
    place.refused(&["p.npy", "p.npy"], "p.npy: is read by this run");
    place.refused(
        &["p.npy", "n.yaml"],
        "p.npy: has no resolution and origin, which the YAML file must say; give --resolution M and --origin X,Y,YAW",
    );
    place.refused(&["p.npy", "n.yaml", "--resolution", "0.1"], "has no resolution and origin");
    place.refused(&["m.pgm", "n.yaml", "--origin", "0,0,0"], "m.pgm: has no resolution and origin");
    place.refused(&["m.yaml", "n.bmp"], "n.bmp: must end in .yaml, .pgm, .npy or .png");
    place.refused(&["m.bmp", "n.npy"], "m.bmp: must end in .yaml, .npy, .pgm or .png");
    place.refused(&["absent.yaml", "n.npy"], "absent.yaml: cannot be read");
    place.refused(&["absent.npy", "n.npy"], "absent.npy: cannot be read");
    place.refused(&["m.yaml", "n.yaml", "--mode", "raw", "--negate"], "--negate: must not stand with --mode raw");
    place.refused(&["m.yaml", "n.npy", "--mode", "raw"], "--mode: must stand with an image to write, not .npy");
    place.refused(&["m.yaml", "n.npy", "--negate"], "--negate: must stand with an image to write, not .npy");
    place.refused(&["m.yml", "n.npy"], "there is no such file (did you mean `m.yaml`?)");
    place.refused(&["m.yaml", "n.yaml", "--free-thresh", "0.7"], "--free-thresh: 0.7: must be at most");
    place.refused(
        &["m.yaml", "n.yaml", "--free-thresh", "0.5", "--occupied-thresh", "0.501"],
        "no grey of 256 between them reads back as unknown",
    );
    for bad in ["0", "-1", "nan", "inf", "1000"] {
        place.refused(&["p.npy", "n.yaml", "--resolution", bad], "must be a number from 0.0001 to 100");
    }
    for bad in ["0,0", "0,0,0,0", "0,0,nan", "0,0,90", "1e9,0,0", "a,b,c"] {
        place.refused(&["p.npy", "n.yaml", "--origin", bad], "must be three numbers X,Y,YAW");
    }
    fs::create_dir(place.path().join("n.yaml")).expect("made");
    place.refused(&["m.yaml", "n.yaml"], "n.yaml: is a folder where a file is to go");
    place.put("m.pgm", b"P5\n3 2\n255\n\x00");
    place
        .refused(&["m.yaml", "o.yaml"], "m.pgm: cannot be read as a PGM or PNG image: it ends after 1 of 3 x 2 pixels");
    place.put("m.yaml", YAML.replace("origin", "\torigin").as_bytes());
    place.refused(&["m.yaml", "o.yaml"], "m.yaml:3:1: a tab stands before the text");
    place.put("run.json", br#"{"grid": {"cell_m": 0.1, "origin_m": [0.0, 0.0], "width": 2, "height": 3}}"#);
    place.refused(
        &["p.npy", "o.yaml"],
        "run.json: its grid has 2 x 3 cells: must be 3 x 2, as p.npy; give --resolution and --origin",
    );
    place.put("run.json", b"{");
    place.refused(&["p.npy", "o.yaml"], "run.json: is not understood");
    place.expect(0, &["p.npy", "o.yaml", "--resolution", "0.1", "--origin", "0,0,0"]);
}

#[test]
fn what_is_suspicious_about_a_map_is_told_of() {
    let place = Place::new();
    let (_, err) = place.expect(0, &["m.yaml", "a.npy"]);
    assert_eq!(err, "", "all is well");
    place.put("nav2.yaml", YAML.replace("0.196", "0.25").as_bytes());
    let (out, err) = place.expect(0, &["nav2.yaml", "nav2.npy"]);
    assert!(err.starts_with("warning: nav2.yaml:6:14: free_thresh = 0.25: 3 of 6 pixels have the shade 205"), "{err}");
    assert!(out.contains("4 free, 2 occupied, 0 unknown"), "{out}");
    place.put("raw.yaml", format!("{YAML}mode: raw\n").as_bytes());
    let (_, err) = place.expect(0, &["raw.yaml", "raw.npy"]);
    assert!(err.contains("raw.yaml:7:7: mode = raw: 4 of 6 pixels have shades from 101 to 254"), "{err}");
    place.refused(
        &["m.yaml", "b.npy", "--read-as", "raw"],
        "--read-as: must stand with an image without YAML, not .yaml; change `mode` in the YAML file",
    );
}

#[test]
fn the_first_row_of_an_array_is_the_lowest_or_the_top_one() {
    let place = Place::new();
    let cells = |name: &str| npy::read(&place.path().join(name)).expect(name).occupancy;
    place.expect(0, &["m.yaml", "low.npy"]);
    place.expect(0, &["m.yaml", "top.npy", "--row-order", "top"]);
    let flipped: Vec<Option<f32>> = cells("low.npy").chunks(3).rev().flatten().copied().collect();
    assert_eq!(cells("top.npy"), flipped);
    place.expect(0, &["top.npy", "back.npy", "--row-order", "top"]);
    assert_eq!(cells("back.npy"), cells("low.npy"));
    let at = ["--resolution", "0.05", "--origin", "-4,2.5,0.25"];
    place.expect(0, &[&["top.npy", "c.yaml", "--row-order", "top"], &at[..]].concat());
    assert_eq!(place.get("c.pgm"), PGM);
    place.refused(
        &["m.yaml", "d.yaml", "--row-order", "top"],
        "--row-order: must stand with an .npy file to read or write",
    );
}
