//! What is written is read back, cell by cell.

use std::fs;
use std::path::Path;

use grid::ros_map::{self, Coding, EncodeError, Mode, RosMapError, Shades, Thresholds};
use grid::{GridSpec, Raster, npy};
use proptest::prelude::*;
use strict::Place;

/// Writes a map as `m.yaml` and `m.pgm` or `m.png`.
fn write(folder: &Path, map: &Raster<Option<f32>>, yaw_rad: f64, coding: &Coding, png: bool) {
    let shades = Shades::of(map, coding).expect("shades");
    let image = if png { "m.png" } else { "m.pgm" };
    let mut bytes = Vec::new();
    if png { shades.png(&mut bytes) } else { shades.pgm(&mut bytes) }.expect("memory");
    fs::write(folder.join(image), bytes).expect("written");
    fs::write(folder.join("m.yaml"), ros_map::describe(map.spec(), yaw_rad, coding, image)).expect("written");
}

fn percent(percent: u8) -> f32 {
    (f64::from(percent) / 100.0) as f32
}

fn row(cells: Vec<Option<f32>>) -> Raster<Option<f32>> {
    Raster::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: cells.len(), height: 1 }, cells)
}

/// Shares of any kind, with unknown cells among them.
fn share() -> impl Strategy<Value = Option<f32>> {
    prop_oneof![
        1 => Just(None),
        2 => (0..=100_u8).prop_map(|v| Some(percent(v))),
        2 => (0_f32..=1.0).prop_map(Some),
        1 => prop_oneof![Just(0.65_f32), Just(0.196), Just(0.651), Just(0.1959), Just(0.0), Just(1.0)].prop_map(Some),
    ]
}

proptest! {
    #[test]
    fn every_mode_keeps_every_cell(
        width in 1_usize..7, height in 1_usize..7, cells in prop::collection::vec(share(), 36),
        mode in prop::sample::select(&Mode::ALL[..]), negate: bool, png: bool,
        (free, occupied) in prop_oneof![Just((0.196, 0.65)), Just((0.25, 0.65)), (0.05_f64..0.3, 0.71_f64..0.99)],
        cell_m in 1e-4_f64..100.0, x in -1e8_f64..1e8, y in -1e3_f64..1e3, yaw_rad in -3.2_f64..3.2,
    ) {
        let thresholds = Thresholds { occupied, free };
        let coding = Coding { mode, negate, thresholds };
        let spec = GridSpec { cell_m, origin_m: [x, y], width, height };
        let map = Raster::new(spec, cells[..width * height].to_vec());
        let png = png || mode == Mode::Scale;
        let folder = tempfile::tempdir().expect("a temporary folder");
        write(folder.path(), &map, yaw_rad, &coding, png);
        let back = ros_map::read(&folder.path().join("m.yaml")).expect("our own");
        // To the bit, whatever the number of digits.
        prop_assert_eq!((back.spec, back.yaw_rad), (spec, yaw_rad));
        prop_assert_eq!(back.coding, Coding { negate: negate && mode != Mode::Raw, ..coding });
        for (cell, (&before, &after)) in map.values().iter().zip(back.occupancy.values()).enumerate() {
            match (mode, before, after) {
                (Mode::Trinary, _, _) => {}
                (_, Some(a), Some(b)) => {
                    let whole = (0..=100).any(|v| percent(v).to_bits() == a.to_bits());
                    prop_assert!(if whole { a.to_bits() == b.to_bits() } else { (a - b).abs() <= 0.01 }, "{cell}: {a} {b}");
                }
                _ => prop_assert_eq!(before, after),
            }
            // Where a whole percent has the state at all, it is kept.
            if mode == Mode::Trinary || occupied - free > 0.02 {
                prop_assert_eq!(thresholds.state(before), thresholds.state(after), "{} {:?} {:?}", cell, before, after);
            }
        }
        // A second round changes nothing.
        let first = fs::read(folder.path().join(if png { "m.png" } else { "m.pgm" })).expect("there");
        write(folder.path(), &back.occupancy, yaw_rad, &coding, png);
        prop_assert_eq!(fs::read(folder.path().join(if png { "m.png" } else { "m.pgm" })).expect("there"), first);
    }

    #[test]
    fn npy_keeps_every_bit(width in 1_usize..7, height in 1_usize..7, cells in prop::collection::vec(share(), 36)) {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
        let map = Raster::new(spec, cells[..width * height].to_vec());
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("m.npy");
        npy::write_occupancy(&map, fs::File::create(&path).expect("writable")).expect("written");
        let back = npy::read(&path).expect("our own");
        prop_assert_eq!((back.width, back.height), (width, height));
        let bits = |cells: &[Option<f32>]| cells.iter().map(|c| c.map(f32::to_bits)).collect::<Vec<_>>();
        prop_assert_eq!(bits(&back.occupancy), bits(map.values()));
    }

    #[test]
    fn damage_is_an_error_or_another_map_and_never_a_panic(
        at in prop::collection::vec((0_usize..10_000, any::<u8>()), 1..4), cut in 0_usize..10_000, which in 0_usize..4,
    ) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let map = row(vec![Some(1.0), None, Some(0.0), Some(0.37)]);
        let mode = if which == 1 { Mode::Scale } else { Mode::Trinary };
        write(folder.path(), &map, 0.5, &Coding { mode, ..Coding::default() }, which == 1);
        npy::write_occupancy(&map, fs::File::create(folder.path().join("m.npy")).expect("writable")).expect("written");
        let path = folder.path().join(["m.pgm", "m.png", "m.yaml", "m.npy"][which]);
        let mut bytes = fs::read(&path).expect("there");
        for (place, byte) in at {
            let place = place % bytes.len();
            bytes[place] = byte;
        }
        bytes.truncate(bytes.len() - cut % 8);
        fs::write(&path, bytes).expect("writable");
        let error = match which {
            3 => npy::read(&path).err().map(|e| e.to_string()),
            _ => ros_map::read(&folder.path().join("m.yaml")).err().map(|e| e.to_string()),
        };
        prop_assert!(error.is_none_or(|message| message.lines().count() == 1));
    }
}

#[test]
fn the_files_that_map_server_would_write() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = GridSpec { cell_m: 0.05, origin_m: [-4.0, 2.5], width: 3, height: 2 };
    let map = Raster::new(spec, vec![Some(0.0), Some(0.9), None, Some(1.0), Some(0.1), Some(0.5)]);
    write(folder.path(), &map, 0.0, &Coding::default(), false);
    assert_eq!(fs::read(folder.path().join("m.pgm")).expect("there"), b"P5\n3 2\n255\n\x00\xfe\xcd\xfe\x00\xcd");
    assert_eq!(
        fs::read_to_string(folder.path().join("m.yaml")).expect("there"),
        "image: m.pgm\nmode: trinary\nresolution: 0.05\norigin: [-4.0, 2.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    );
}

#[test]
fn images_with_any_name_are_found_again() {
    for name in
        ["map 1.pgm", " a: b #c.pgm", "it's \"x\".pgm", "-.pgm", "ö\\n.pgm", "- [x].pgm", "null", "1.0", "tab\tx"]
    {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let map = row(vec![Some(1.0), None]);
        let mut pgm = Vec::new();
        Shades::of(&map, &Coding::default()).expect("shades").pgm(&mut pgm).expect("memory");
        fs::write(folder.path().join(name), pgm).expect("written");
        let yaml = ros_map::describe(map.spec(), 0.0, &Coding::default(), name);
        fs::write(folder.path().join("m.yaml"), &yaml).expect("written");
        let back = ros_map::read(&folder.path().join("m.yaml")).unwrap_or_else(|e| panic!("{yaml}\n{e}"));
        assert_eq!(back.image, folder.path().join(name));
    }
}

#[test]
fn unknown_takes_another_grey_where_205_would_be_free() {
    let map = row(vec![Some(0.0), None, Some(1.0)]);
    let shades = |occupied, free| {
        let mut pgm = Vec::new();
        let coding = Coding { thresholds: Thresholds { occupied, free }, ..Coding::default() };
        Shades::of(&map, &coding)?.pgm(&mut pgm).expect("memory");
        Ok::<_, EncodeError>(pgm[pgm.len() - 3..].to_vec())
    };
    assert_eq!(shades(0.65, 0.196), Ok(vec![254, 205, 0]));
    assert_eq!(shades(0.65, 0.25), Ok(vec![254, 140, 0]), "p = 115 / 255 = 0.451, in the middle");
    assert_eq!(shades(0.65, 0.003), Ok(vec![255, 205, 0]), "254 is p = 0.0039: not free");
    assert_eq!(shades(1.0, 0.0), Ok(vec![205, 205, 205]), "by these thresholds nothing is known");
    let error = shades(0.501, 0.5).expect_err("no shade").to_string();
    assert!(error.contains("thresholds 0.5 and 0.501: no grey of 256 between them reads back as unknown"), "{error}");
    // Percent need more room than that.
    let coding = Coding { mode: Mode::Scale, thresholds: Thresholds { occupied: 0.5, free: 0.4 }, negate: false };
    let error = Shades::of(&row((0..=100).map(|v| Some(percent(v))).collect()), &coding).expect_err("25 greys");
    assert!(error.to_string().contains("%"), "{error}");
}

#[test]
fn scale_has_no_pgm_with_unknown_cells() {
    let coding = Coding { mode: Mode::Scale, ..Coding::default() };
    let shades = |cells| Shades::of(&row(cells), &coding).expect("shades").pgm(Vec::new());
    shades(vec![Some(0.3), Some(0.4)]).expect("all are known");
    let error = shades(vec![Some(0.3), None, None]).expect_err("transparent");
    assert!(error.to_string().contains("2 cells are unknown"), "{error}");
}

#[test]
fn the_states_of_the_real_map_survive_every_form() {
    let yaml = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/maps/UMA_236_237.yaml");
    let map = ros_map::read(&yaml).expect("readable");
    let folder = tempfile::tempdir().expect("a temporary folder");
    for mode in Mode::ALL {
        for negate in [false, true] {
            write(folder.path(), &map.occupancy, 0.0, &Coding { mode, negate, ..map.coding }, true);
            let back = ros_map::read(&folder.path().join("m.yaml")).expect("our own");
            assert_eq!((back.spec, &back.occupancy), (map.spec, &map.occupancy), "{mode:?} {negate}");
        }
    }
}

#[test]
fn an_error_names_the_place() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("m.yaml");
    let text = ros_map::describe(row(vec![None]).spec(), 0.0, &Coding::default(), "gone.pgm");
    fs::write(&path, text).expect("written");
    let error = ros_map::read(&path).expect_err("no image");
    let expected = Place { file: path.display().to_string(), line: 1, column: 8 };
    assert!(matches!(error, RosMapError::NoImage { place, .. } if place == expected));
}
