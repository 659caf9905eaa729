//! Map files as they are met, and what is said about those that cannot be read.

use std::fs;
use std::path::Path;

use grid::ros_map::{self, RosMapError};
use png::{BitDepth, ColorType};
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

/// A PNG of two columns, as a program of another kind would write it.
fn png(color: ColorType, depth: BitDepth, palette: &[u8], data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels_per_row = 2;
    let per_row = color.samples() * pixels_per_row * depth as usize;
    let mut encoder = png::Encoder::new(&mut bytes, 2, (data.len() / per_row.div_ceil(8)) as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if !palette.is_empty() {
        encoder.set_palette(palette);
    }
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(data).expect("pixels");
    writer.finish().expect("an end");
    bytes
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
        format!("---\n{YAML}---\n"),
        YAML.replace('\n', "\r"),
        YAML.replace(": ", ":\t"),
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
    let save = |pixels: [[u8; 4]; 4]| {
        let image = png(ColorType::Rgba, BitDepth::Eight, &[], pixels.as_flattened());
        fs::write(folder.path().join("m.png"), image).expect("written");
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
    let unknown_turn = "must be a number from -6.3 to 6.3; savers write nan where they do not know the angle: put 0";
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
        (with(origin, "[1, 2, 90]"), format!("m.yaml:3:16: origin angle = 90: {turn}: 90 degrees are 1.5708")),
        (with(origin, "[1, 2, 1e3]"), format!("m.yaml:3:16: origin angle = 1e3: {turn}")),
        (with(origin, "[1, 2, nan]"), format!("m.yaml:3:16: origin angle = nan: {unknown_turn}")),
        (with(origin, "[1, 2, -nan]"), format!("m.yaml:3:16: origin angle = -nan: {unknown_turn}")),
        (with(origin, "[1, 2, .NaN]"), format!("m.yaml:3:16: origin angle = .NaN: {unknown_turn}")),
        (with("resolution: 0.05", "\tresolution: 0.05"), format!("m.yaml:2:1: {tab}")),
        (with("origin: [-4.0, -4.0, 0.0]", "origin:\n\t- -4.0\n\t- -4.0\n\t- 0.0"), format!("m.yaml:4:1: {tab}")),
        (
            with("negate: 0", "negate: 2"),
            "m.yaml:4:9: negate = 2: must be 0 or 1; give 1 if occupied cells are white".into(),
        ),
        (with("0.65", "65"), format!("m.yaml:5:18: occupied_thresh = 65: {share}, not percent: 0.65")),
        (with("0.65", "\"0,65\""), "m.yaml:5:18: occupied_thresh = 0,65: must be a number from 0 to 1; write a decimal point: 0.65".into()),
        (with("m.pgm", "\"C:\\maps\\m.pgm\""), "m.yaml:1:8: a backslash in double quotes begins an escape, and this one is none; write file names with forward slashes, or in single quotes".into()),
        (with("m.pgm", "\"C:\\new\\a.pgm\""), "m.yaml:1:8: image = C:\\new\\u{7}.pgm: no such file, tried C:\\new\\u{7}.pgm; in double quotes a backslash begins an escape: write forward slashes, or single quotes".into()),
        (with("0.196", "-0.1"), format!("m.yaml:6:14: free_thresh = -0.1: {share}")),
        (
            with("0.196", "0.7"),
            "m.yaml:6:14: free_thresh = 0.7: must be at most occupied_thresh = 0.65; exchange the two if they are swapped; map_server writes 0.196 and 0.65"
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
        (b"", "", "it is empty"),
        (b"image", "", "its first bytes are those of no known image"),
        (b"GIF89a", "", "it is a GIF image"),
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
    let head = "m.pgm: cannot be read as a PGM or PNG image: ";
    let lie = "it ends after 0 of 10000 x 10000 pixels";
    assert_eq!(message(YAML, b"P6 10000 10000 255"), format!("{head}{lie}{advice}"));
    let mut image = png(ColorType::Grayscale, BitDepth::Eight, &[], &[0; 4]);
    image[16..24].copy_from_slice(&[0, 0, 39, 16, 0, 0, 39, 16]); // 10000 x 10000
    let sum = crc32(&image[12..29]);
    image[29..33].copy_from_slice(&sum.to_be_bytes());
    let lie = format!("its header promises 10000 x 10000 pixels, more than {} bytes can hold", image.len());
    assert_eq!(message(YAML, &image), format!("{head}{lie}{advice}"));
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

/// The checksum of a PNG's chunks, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
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
    let shades = [22937_u16, 22938].map(u16::to_be_bytes);
    fs::write(image, png(ColorType::Grayscale, BitDepth::Sixteen, &[], shades.as_flattened())).expect("written");
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

/// The cells and the warnings of a map.
fn warned(yaml: impl AsRef<[u8]>, image: impl AsRef<[u8]>) -> (Vec<Option<bool>>, Vec<String>) {
    let folder = folder(yaml, image);
    let map = ros_map::read(&folder.path().join("m.yaml")).expect("readable");
    let short = |warning: &ros_map::Warning| warning.to_string().replace(&format!("{}/", folder.path().display()), "");
    (map.cells().values().to_vec(), map.warnings.iter().map(short).collect())
}

#[test]
fn headers_of_binary_images_end_in_many_ways() {
    let pixels = b"\x00\xfe\xcd\x00";
    let silent = [
        "P5\r\n2 2\r\n255\r\n",
        "P5 2 2 255\r\n",
        "P5\r2 2\r255\r",
        "P5\t2\t2\t255\t",
        "P5\n2 2\n255 \n",
        "P5\n2 2\n255  ",
        "P5\n2 2\n255\n# by a saver\n",
        "P5\n2 2\n255\n# by\r\n# a saver\r\n",
        "P5\n#\n2 # columns\n2\n255\n",
    ];
    for header in silent {
        let image = [header.as_bytes(), pixels].concat();
        assert_eq!(warned(YAML, image), (CELLS.to_vec(), vec![]), "{header:?}");
    }
    // A pixel that could be the second byte of a line end, a comment or a blank, where the file has no byte to spare.
    for first in [b'\n', b'#', b' '] {
        let image = [b"P5 2 2 255\r".as_slice(), &[first], b"\xfe\xcd\x00"].concat();
        assert_eq!(warned(YAML, image), (CELLS.to_vec(), vec![]), "{first}");
    }
    let message = message(YAML, b"P5\r\n2 2\r\n255\r\n\x00\xfe\xcd");
    assert!(message.contains("it ends after 3 of 2 x 2 pixels"), "{message}");
}

#[test]
fn bytes_behind_the_last_pixel_are_counted() {
    let left = |bytes: usize| {
        format!(
            "m.pgm: {bytes} bytes follow the last pixel and are not read; save the map again if its header does not fit its pixels"
        )
    };
    for (behind, bytes) in [(b"\x00".as_slice(), 1), (b"\n\n", 2), (&[205; 100], 100)] {
        assert_eq!(warned(YAML, [PGM, behind].concat()), (CELLS.to_vec(), vec![left(bytes)]));
    }
    assert_eq!(warned(YAML, "P2 2 2 255 0 254 205 0\n\n"), (CELLS.to_vec(), vec![]));
    assert_eq!(warned(YAML, "P2 2 2 255 0 254 205 0 17\n"), (CELLS.to_vec(), vec![left(3)]));
    assert_eq!(warned(YAML, b"P6 1 1 255 \x00\x00\x00\x07").1, [left(1)]);
}

#[test]
fn the_shade_of_unknown_cells_is_missed_where_it_is_read_as_something() {
    let image = b"P5 4 1 255 \x00\xfe\xcd\xcd";
    assert_eq!(warned(YAML, image).1, Vec::<String>::new());
    let (cells, warnings) = warned(with("0.196", "0.25"), image);
    assert_eq!(cells, [Some(true), Some(false), Some(false), Some(false)]);
    let shade = "2 of 4 pixels have the shade 205, which map savers write for unknown cells, and are read as";
    let remedy = "write 0.196 as map savers do, unless they are known to be free";
    assert_eq!(warnings, [format!("m.yaml:6:14: free_thresh = 0.25: {shade} free; {remedy}")]);
    let (_, warnings) = warned(with("0.65", "0.19").replace("0.196", "0.1"), image);
    let remedy = "write 0.65 as map savers do, unless they are known to be occupied";
    assert_eq!(warnings, [format!("m.yaml:5:18: occupied_thresh = 0.19: {shade} occupied; {remedy}")]);
    let (_, warnings) = warned(format!("{YAML}mode: scale\n"), image);
    let remedy = "use mode trinary, or make unknown cells transparent";
    assert_eq!(warnings, [format!("m.yaml:7:7: mode = scale: {shade} free; {remedy}")]);
    // Inverted images, and the same in other depths.
    let inverted = with("0.196", "0.25").replace("negate: 0", "negate: yes");
    assert_eq!(warned(inverted, b"P5 4 1 255 \xff\x01\x32\x32").1.len(), 1);
    assert_eq!(warned(with("0.196", "0.25"), b"P5 2 1 65535 \x00\x00\xcd\xcd").1.len(), 1);
    // A map in many shades has this one like any other.
    let many: Vec<u8> = (0..=255).collect();
    assert_eq!(warned(with("0.196", "0.25"), [b"P5 256 1 255 ", many.as_slice()].concat()).1, Vec::<String>::new());
}

#[test]
fn an_image_for_the_other_value_of_negate_is_told_of() {
    let (cells, warnings) = warned(YAML, b"P5 4 1 255 \xff\x01\x32\x32");
    assert_eq!(cells, [Some(false), Some(true), Some(true), Some(true)]);
    let expected = "m.yaml:4:9: negate = 0: 2 of 4 pixels have the shade 50, which unknown cells have in an image for negate = 1; write negate: 1 if occupied cells are white";
    assert_eq!(warnings, [expected]);
    let (_, warnings) = warned(with("negate: 0", "negate: 1"), b"P5 4 1 255 \x00\xfe\xcd\xcd");
    assert!(warnings[0].contains("negate = 1: 2 of 4 pixels have the shade 205"), "{warnings:?}");
    assert_eq!(warned(with("negate: 0", "negate: 1"), b"P5 4 1 255 \xff\x01\x32\x32").1, Vec::<String>::new());
}

#[test]
fn cells_of_metres_are_told_of() {
    let expected = "m.yaml:2:13: resolution = 5: cells of 5 m; give metres, such as 0.05";
    assert_eq!(warned(with("0.05", "5"), PGM).1, [expected]);
    assert_eq!(warned(with("0.05", "1"), PGM).1, Vec::<String>::new());
}

#[test]
fn shades_that_are_no_percent_are_counted() {
    let yaml = format!("{YAML}mode: raw\n");
    assert_eq!(warned(&yaml, b"P5 4 1 255 \x00\x64\xff\xff").1, Vec::<String>::new());
    let (cells, warnings) = warned(&yaml, b"P5 4 1 255 \x00\x65\xfe\xff");
    assert_eq!(cells, [Some(false), None, None, None]);
    let expected = "m.yaml:7:7: mode = raw: 2 of 4 pixels have shades from 101 to 254, which mean nothing in mode raw, and are read as unknown; use mode trinary or scale if the image shows shades of darkness";
    assert_eq!(warnings, [expected]);
}

#[test]
fn booleans_of_yaml_1_1() {
    let negated = b"P5 2 2 255 \xff\x01\x32\xff";
    for word in ["1", "yes", "Yes", "YES", "on", "On", "TRUE", "True", "true", "y", "Y", "'yes'"] {
        assert_eq!(cells(with("negate: 0", &format!("negate: {word}")), negated), CELLS, "{word}");
    }
    for word in ["0", "no", "No", "NO", "off", "OFF", "FALSE", "False", "false", "n", "N"] {
        assert_eq!(cells(with("negate: 0", &format!("negate: {word}")), PGM), CELLS, "{word}");
    }
}

#[test]
fn numbers_of_single_precision_are_what_was_meant() {
    let yaml = with("0.05", "0.05000000074505806").replace("-4.0,", "-4.050000190734863,");
    let folder = folder(yaml, PGM);
    let map = ros_map::read(&folder.path().join("m.yaml")).expect("readable");
    let numbers = [map.spec.cell_m, map.spec.origin_m[0], map.spec.origin_m[1]];
    assert_eq!(numbers.map(f64::to_bits), [0.05, -4.05, -4.05].map(f64::to_bits));
}

#[test]
fn every_kind_of_png() {
    use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb};
    let cells = |image: Vec<u8>| cells(YAML, image);
    assert_eq!(cells(png(Grayscale, BitDepth::Eight, &[], &[0, 254, 205, 0])), CELLS);
    assert_eq!(cells(png(GrayscaleAlpha, BitDepth::Eight, &[], &[0, 255, 254, 255, 90, 0, 0, 255])), CELLS);
    assert_eq!(cells(png(Indexed, BitDepth::Two, &[0, 0, 0, 254, 254, 254, 205, 205, 205], &[0x10, 0x80])), CELLS);
    let rgb = [0, 254, 205, 0].map(|v| [v; 3]);
    assert_eq!(cells(png(Rgb, BitDepth::Eight, &[], rgb.as_flattened())), CELLS);
    let wide = [0, 254, 205, 0].map(|v| [v; 6]);
    assert_eq!(cells(png(Rgb, BitDepth::Sixteen, &[], wide.as_flattened())), CELLS);
    // Black and white alone: nothing is unknown.
    let two = [Some(true), Some(false), Some(false), Some(true)];
    assert_eq!(
        cells(png(Grayscale, BitDepth::One, &[], &[0b0100_0000, 0b1000_0000])),
        [two[2], two[3], two[0], two[1]]
    );
}

#[test]
fn black_and_white_netpbm_images() {
    let two = [Some(true), Some(false), Some(false), Some(true)];
    assert_eq!(cells(YAML, "P1\n2 2\n0 1\n1 0\n"), two);
    assert_eq!(cells(YAML, "P1 2 2 0110"), two);
    assert_eq!(cells(YAML, b"P4 2 2 \x40\x80"), two);
    assert_eq!(cells(YAML, "P3 2 2 255 0 0 0 254 254 254 205 205 205 0 0 0"), CELLS);
    let pam = |tuple: &str, depth: usize| {
        format!("P7\nWIDTH 2\nHEIGHT 2\nDEPTH {depth}\nMAXVAL 255\nTUPLTYPE {tuple}\nENDHDR\n")
    };
    assert_eq!(cells(YAML, [pam("GRAYSCALE", 1).as_bytes(), b"\x00\xfe\xcd\x00"].concat()), CELLS);
    let alpha = b"\x00\xff\xfe\xff\x5a\x00\x00\xff";
    assert_eq!(cells(YAML, [pam("GRAYSCALE_ALPHA", 2).as_bytes(), alpha].concat()), CELLS);
    let message = message(YAML, b"BM and the rest");
    assert!(message.contains("it is a BMP image; save the map again or convert it to one of the two"), "{message}");
}
