//! Map files as they are met, and what is said about those that cannot be read.

use std::fs;
use std::path::Path;

use grid::ros_map::{self, RosMapError};
use image::{ImageFormat, Rgba, RgbaImage};
use tempfile::TempDir;

const YAML: &str = "\
image: m.pgm
resolution: 0.05
origin: [-4.0, -4.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
";

/// Occupied, free; unknown, occupied.
const PGM: &[u8] = b"P5\n2 2\n255\n\x00\xfe\xcd\x00";
const CELLS: [Option<bool>; 4] = [None, Some(true), Some(true), Some(false)];

/// A folder with a description `m.yaml` and an image `m.pgm`.
fn folder(yaml: impl AsRef<[u8]>, image: impl AsRef<[u8]>) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.yaml"), yaml).expect("written");
    fs::write(folder.path().join("m.pgm"), image).expect("written");
    folder
}

fn cells(yaml: impl AsRef<[u8]>, image: impl AsRef<[u8]>) -> Vec<Option<bool>> {
    let folder = folder(yaml, image);
    let map = ros_map::read(&folder.path().join("m.yaml")).expect("a readable map");
    map.cells().values().to_vec()
}

/// The message about a map that cannot be read, without the path of the temporary folder.
fn message(yaml: impl AsRef<[u8]>, image: impl AsRef<[u8]>) -> String {
    let folder = folder(yaml, image);
    let error = ros_map::read(&folder.path().join("m.yaml")).expect_err("not a map");
    assert!(!error.is_io(), "{error}");
    relative(&error, folder.path())
}

fn relative(error: &RosMapError, folder: &Path) -> String {
    error.to_string().replace(&format!("{}/", folder.display()), "")
}

/// Replaces one part of the good description by another.
fn with(part: &str, other: &str) -> String {
    assert!(YAML.contains(part));
    YAML.replace(part, other)
}

#[test]
fn descriptions_in_the_forms_that_are_met() {
    let forms = [
        YAML.to_owned(),
        YAML.replace('\n', "\r\n"),
        format!("\u{feff}{YAML}"),
        with("m.pgm", "m.pgm   "),
        with("m.pgm", "\"m.pgm \"  # the image"),
        with("m.pgm", "/home/robot/maps/m.pgm"),
        with("m.pgm", "C:\\maps\\m.pgm"),
        with("m.pgm", "../elsewhere/m.pgm"),
        with("0.05", "0.050000 "),
        with("0.05", "5e-2"),
        with("image: m.pgm", "image:\tm.pgm\t# a tab parts as well as a blank"),
        with("[-4.0, -4.0, 0.0]", "\n- -4.\n- -4\n- -0.0"),
        with("negate: 0", "negate: false"),
        format!("# saved by a robot\n\n{YAML}mode: trinary\nmap_name: office\nlayers: [1, {{a: 2}}]\n"),
        YAML.lines().rev().map(|line| format!("{line}\n")).collect(),
    ];
    for form in forms {
        let folder = folder(&form, PGM);
        let map = ros_map::read(&folder.path().join("m.yaml")).unwrap_or_else(|e| panic!("{form}\n{e}"));
        assert_eq!(map.cells().values(), CELLS, "{form}");
        assert!(map.spec.origin_m.iter().all(|o| (o + 4.0).abs() < 1e-12) && (map.spec.cell_m - 0.05).abs() < 1e-12);
    }
}

#[test]
fn the_image_where_the_description_says_comes_before_the_one_beside_it() {
    let folder = folder(with("m.pgm", "maps/m.pgm"), b"P5\n1 1\n255\n\x00");
    fs::create_dir(folder.path().join("maps")).expect("made");
    fs::write(folder.path().join("maps/m.pgm"), PGM).expect("written");
    let map = ros_map::read(&folder.path().join("m.yaml")).expect("readable");
    assert_eq!(map.cells().values(), CELLS);
}

#[test]
fn netpbm_images_in_every_depth() {
    assert_eq!(cells(YAML, PGM), CELLS, "binary");
    assert_eq!(cells(YAML, "P2\n# text\n2 2\n255\n0 254\n205 0\n"), CELLS, "text");
    assert_eq!(cells(YAML, "P2\r\n2 2\r\n255\r\n0 254\r\n205 0\r\n"), CELLS, "text with carriage returns");
    assert_eq!(cells(YAML, "P2 2 2 100 0 100 80 0"), CELLS, "brightest value 100: unknown at p = 0.2");
    assert_eq!(cells(YAML, b"P5 2 2 65535 \x00\x00\xff\xff\xcd\xcd\x00\x00"), CELLS, "16 bits");
    assert_eq!(cells(YAML, b"P6 2 2 255 \0\0\0\xff\xff\xff\xcd\xcd\xcd\0\0\0"), CELLS, "colours");
}

#[test]
fn png_images_with_colours_and_transparency() {
    let folder = folder(with("m.pgm", "m.png"), PGM);
    let image = folder.path().join("m.png");
    let save = |pixels: [[u8; 4]; 4]| {
        let mut png = RgbaImage::new(2, 2);
        png.pixels_mut().zip(pixels).for_each(|(pixel, rgba)| *pixel = Rgba(rgba));
        png.save_with_format(&image, ImageFormat::Png).expect("written");
        ros_map::read(&folder.path().join("m.yaml")).expect("readable").cells().values().to_vec()
    };
    let [black, white, grey] = [0, 254, 205].map(|v| [v, v, v, 255]);
    assert_eq!(save([black, white, grey, black]), CELLS);
    // Transparent black is unknown; the mean of the colours counts: 85 (p = 0.667) and 210 (p = 0.176).
    assert_eq!(save([[255, 0, 0, 255], [255, 255, 120, 255], [0, 0, 0, 0], black]), CELLS);
}

#[test]
fn messages_about_descriptions() {
    let origin = "[-4.0, -4.0, 0.0]";
    let form = "write one `key: value` per line, as map_server does";
    let metres = "must be a number from 0.0001 to 100; give the side of a pixel in metres";
    let share = "must be a number from 0 to 1; give a share of darkness, 0 white to 1 black";
    let corner = "must be a number from -100000000 to 100000000; give x and y of the lower-left corner in metres";
    let turn = "must be a number from -6.3 to 6.3; give the angle of the map in radians, counter-clockwise";
    let tab = format!("a tab stands before the text, where YAML wants blanks; {form}");
    let three = "must be three numbers; give x and y of the lower-left corner in metres and the angle in radians";
    let beside = "put the image beside the YAML file or correct its name";
    let table = [
        (String::new(), "m.yaml: the key `image` is missing; add image: map.pgm".to_owned()),
        (with("negate", "negat"), "m.yaml: the key `negate` is missing; add negate: 0".into()),
        (with(" 0.05", ""), "m.yaml: the key `resolution` is missing; add resolution: 0.05".into()),
        ("map".into(), format!("m.yaml:1:1: keys and values are needed here; {form}")),
        (with(origin, "[0, 0"), format!("m.yaml:4:7: illegal placement of ':' indicator; {form}")),
        (with("0.05", "[0.05]"), format!("m.yaml:2:13: one value is needed here, not a list or table; {form}")),
        (with(origin, "0"), format!("m.yaml:3:9: a list such as [0.0, 0.0, 0.0] is needed here; {form}")),
        (format!("{YAML}negate: 0\n"), format!("m.yaml:7:1: the key `negate` stands here a second time; {form}")),
        (format!("{YAML}---\n{YAML}"), format!("m.yaml:8:1: a second YAML document begins here; {form}")),
        (with("0.05", "0"), format!("m.yaml:2:13: resolution = 0: {metres}")),
        (with("0.05", "-0.05"), format!("m.yaml:2:13: resolution = -0.05: {metres}")),
        (with("0.05", "nan"), format!("m.yaml:2:13: resolution = nan: {metres}")),
        (with("0.05", ".inf"), format!("m.yaml:2:13: resolution = .inf: {metres}")),
        (with("0.05", "1e300"), format!("m.yaml:2:13: resolution = 1e300: {metres}")),
        (with("0.05", "five"), format!("m.yaml:2:13: resolution = five: {metres}")),
        (with(origin, "[1, 2]"), format!("m.yaml:3:9: origin = [1, 2]: {three}")),
        (with(origin, "[1, 2, 0, 0]"), format!("m.yaml:3:9: origin = [1, 2, 0, 0]: {three}")),
        (with(origin, "[1e9, 2, 0]"), format!("m.yaml:3:10: origin x = 1e9: {corner}")),
        (with(origin, "[1, inf, 0]"), format!("m.yaml:3:13: origin y = inf: {corner}")),
        (with(origin, "[1, 2, 90]"), format!("m.yaml:3:16: origin angle = 90: {turn}")),
        (with(origin, "[1, 2, nan]"), format!("m.yaml:3:16: origin angle = nan: {turn}")),
        (with("resolution: 0.05", "\tresolution: 0.05"), format!("m.yaml:2:1: {tab}")),
        (with("origin: [-4.0, -4.0, 0.0]", "origin:\n\t- -4.0\n\t- -4.0\n\t- 0.0"), format!("m.yaml:4:1: {tab}")),
        (
            with("negate: 0", "negate: 2"),
            "m.yaml:4:9: negate = 2: must be 0 or 1; give 1 if occupied cells are white".into(),
        ),
        (with("0.65", "65"), format!("m.yaml:5:18: occupied_thresh = 65: {share}")),
        (with("0.196", "-0.1"), format!("m.yaml:6:14: free_thresh = -0.1: {share}")),
        (
            with("0.196", "0.7"),
            "m.yaml:6:14: free_thresh = 0.7: must be at most occupied_thresh = 0.65; map_server writes 0.196 and 0.65"
                .into(),
        ),
        (
            format!("{YAML}mode: grey\n"),
            "m.yaml:7:7: mode = grey: must be trinary, scale or raw; leave the key out if the image holds three shades"
                .into(),
        ),
        (with("m.pgm", "n.pgm"), format!("m.yaml:1:8: image = n.pgm: no such file, tried n.pgm; {beside}")),
        (
            with("m.pgm", "/maps/n.pgm"),
            format!("m.yaml:1:8: image = /maps/n.pgm: no such file, tried /maps/n.pgm and n.pgm; {beside}"),
        ),
        (with("m.pgm", "."), format!("m.yaml:1:8: image = .: no such file, tried .; {beside}")),
        (
            with("m.pgm", "/maps/"),
            "m.yaml:1:8: image = /maps/: must be the name of a file; give the map's PGM or PNG image".into(),
        ),
    ];
    for (yaml, expected) in table {
        assert_eq!(message(&yaml, PGM), expected, "{yaml}");
    }
}

#[test]
fn messages_about_files_that_are_no_description() {
    let table: [(&[u8], &str); 3] = [
        (b"image\0", "it holds zero bytes"),
        (b"P5 2 2 255 \xff\xfe", "byte 12 is not UTF-8 text"),
        (&[b'#'; 70_000], "it has more than 65536 bytes"),
    ];
    for (bytes, problem) in table {
        let expected = format!("m.yaml: is not a map description: {problem}; give the YAML file, not the image");
        assert_eq!(message(bytes, PGM), expected);
    }
}

#[test]
fn messages_about_images() {
    let damaged: [(&[u8], &str, &str); 20] = [
        (b"", "", "its first bytes are those of no known image"),
        (b"image", "", "its first bytes are those of no known image"),
        (b"GIF89a", "", "it is a Gif image"),
        // What a decoder says is its own; that it says something is enough.
        (b"\x89PNG\r\n\x1a\n", "", "*"),
        (b"P6\n2 2\n255\n\x00", "", "*"),
        (b"P5", ":1:3", "it ends before its width"),
        (b"P5\n2", ":2:2", "it ends before its height"),
        (b"P5\n2 2\n", ":3:1", "it ends before its brightest value"),
        (b"P5\n2 two\n255\n1234", ":2:3", "'t': must be a whole number"),
        (b"P5\n2 -2\n255\n1234", ":2:3", "'-': must be a whole number"),
        (b"P5\n2 2.5\n255\n1234", ":2:3", "2...: must be a whole number"),
        (b"P5\n# by \xff\n99999999999 1\n255\n\x00", ":3:1", "99999999999: must be at most 4294967295"),
        (b"P5\n2 2\n0\n1234", ":4:1", "its brightest value is 0: must be from 1 to 65535"),
        (b"P5\n2 2\n65536\n1234", ":3:1", "65536: must be at most 65535"),
        (b"P5\n2 2\n255\n\x00", "", "it ends after 1 of 2 x 2 pixels"),
        (b"P5\n2 2\n256\n\x00\x01\x00\x01\x00", "", "it ends after 2 of 2 x 2 pixels"),
        (
            b"P5\n2 2\n100\n\x00\x00\x00\x65",
            "",
            "pixel 1 of row 1, from 0 at the top left, is 101: must be at most 100, its brightest value",
        ),
        (b"P2\n2 2\n255\n1 2\n3 256", ":5:3", "256: must be at most 255"),
        (b"P2\n2 2\n255\n1 2\n3", "", "it ends after 3 of 2 x 2 pixels"),
        // Headers that lie ask for no memory.
        (b"P5\n10000 10000\n255\n\x00", "", "it ends after 1 of 10000 x 10000 pixels"),
    ];
    let advice = "; save the map again or convert it to one of the two";
    for (image, place, problem) in damaged {
        let message = message(YAML, image);
        let head = format!("m.pgm{place}: cannot be read as a PGM or PNG image: ");
        if problem == "*" {
            let rest = message.strip_prefix(&head);
            assert!(rest.is_some_and(|r| r.ends_with(advice) && !r.contains('\n')), "{message}");
        } else {
            assert_eq!(message, format!("{head}{problem}{advice}"));
        }
    }
    let lie = "its header promises 10000 x 10000 pixels, more than 18 bytes can hold";
    let head = "m.pgm: cannot be read as a PGM or PNG image: ";
    assert_eq!(message(YAML, b"P6 10000 10000 255"), format!("{head}{lie}{advice}"));
    for (header, size) in [("P5\n0 2\n255\n", "0 x 2"), ("P5\n4000000000 4000000000\n255\n", "4000000000 x 4000000000")]
    {
        assert_eq!(
            message(YAML, header),
            format!(
                "m.pgm: {size} pixels: must be at least 1 and at most 100000000 in all; save the map again, cropped or with larger pixels"
            )
        );
    }
}

#[test]
fn a_description_that_cannot_be_opened_is_the_systems_fault() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for path in [folder.path().join("absent.yaml"), folder.path().to_path_buf()] {
        let error = ros_map::read(&path).expect_err("nothing to read");
        assert!(error.is_io(), "{error}");
        assert!(error.to_string().starts_with(&format!("{}: cannot be read: ", path.display())), "{error}");
    }
}

#[test]
fn the_real_map_in_scenes() {
    let yaml = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/maps/UMA_236_237.yaml");
    let map = ros_map::read(&yaml).expect("readable");
    assert_eq!((map.spec.width, map.spec.height), (331, 269));
    let cells = map.cells();
    let count = |state| map.cells().values().iter().filter(|s| **s == state).count();
    // Counted with another reader of images: shades up to 32; from 206 up; 107 and 205.
    assert_eq!([count(Some(true)), count(Some(false)), count(None)], [5044, 45346, 38649]);
    // The corridor runs at x = 8.7 m from y = -1.2 to y = 6.65 m; its left wall stands at 7.7 m.
    let at = |x, y| cells[map.spec.locate([x, y]).expect("inside")];
    assert!((0..100).all(|i| at(8.7, -1.2 + 0.0785 * f64::from(i)) == Some(false)));
    assert!((0..12).any(|i| at(7.4 + 0.05 * f64::from(i), 1.0) == Some(true)));
}

#[test]
fn a_depth_of_its_own_is_not_stretched() {
    // Of 1000: 350 is p = 0.65 to the digit and 804 p = 0.196, both unknown; 349 and 805 are not.
    let shades = [349_u16, 350, 804, 805];
    let mut image = b"P5 4 1 1000\n".to_vec();
    shades.iter().for_each(|v| image.extend(v.to_be_bytes()));
    let expected = [Some(true), None, None, Some(false)];
    assert_eq!(cells(YAML, &image), expected);
    assert_eq!(cells(YAML, "P2 4 1 1000 349 350 804 805"), expected);

    let folder = folder(YAML, "");
    let (path, image) = (folder.path().join("m.yaml"), folder.path().join("m.pgm"));
    // p > 0.65 below 65535 x 0.35 = 22937.25; the high byte alone, 89, would not tell.
    let png = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, vec![22937, 22938]).expect("two pixels");
    png.save_with_format(&image, ImageFormat::Png).expect("written");
    assert_eq!(ros_map::read(&path).expect("readable").cells().values(), [Some(true), None]);
}

#[test]
fn percent_in_modes_scale_and_raw() {
    let percents = |yaml: String, image: &[u8]| {
        let folder = folder(yaml, image);
        let map = ros_map::read(&folder.path().join("m.yaml")).expect("readable");
        map.occupancy.values().iter().map(|o| o.map(|o| (o * 100.0).round() as u8)).collect::<Vec<_>>()
    };
    let image = b"P5 5 1 255 \x00\x25\x64\x65\xff";
    let expected = [Some(0), Some(37), Some(100), None, None];
    assert_eq!(percents(format!("{YAML}mode: raw\n"), image), expected);
    assert_eq!(percents(with("negate: 0", "negate: 1\nmode: Raw"), image), expected, "nav2 negates no raw map");
    let wide = b"P5 3 1 65535 \x00\x00\x25\x25\x64\x64";
    assert_eq!(percents(format!("{YAML}mode: raw\n"), wide), expected[..3]);
    // 1 - 0x99/255 = 0.4 is 45 % of the way from 0.196 to 0.65.
    let image = b"P5 3 1 255 \x00\x99\xff";
    assert_eq!(percents(format!("{YAML}mode: scale\n"), image), [Some(100), Some(45), Some(0)]);
}
