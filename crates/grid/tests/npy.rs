//! NPY files as numpy writes them, and what is said about those that are no map.

use std::fs;

use grid::npy;

/// A file of format 1.0 with the header that numpy would write.
fn file(descr: &str, fortran: bool, shape: &str, values: &[u8]) -> Vec<u8> {
    let fortran = if fortran { "True" } else { "False" };
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(values);
    bytes
}

fn read(bytes: &[u8]) -> Result<npy::Array, String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("m.npy");
    fs::write(&path, bytes).expect("written");
    npy::read(&path).map_err(|error| {
        assert!(!error.is_io(), "{error}");
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    })
}

fn bytes<const N: usize>(values: &[f64], to: impl Fn(f64) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&v| to(v)).collect()
}

#[test]
fn every_type_and_order() {
    // Rows [0.25, 1, NaN] and [0, 0.5, 0.75]; the lower one is the first.
    let c = [0.25, 1.0, f64::NAN, 0.0, 0.5, 0.75];
    let fortran = [0.25, 0.0, 1.0, 0.5, f64::NAN, 0.75];
    let expected = [Some(0.25), Some(1.0), None, Some(0.0), Some(0.5), Some(0.75)];
    for (values, order) in [(&c, false), (&fortran, true)] {
        for (descr, data) in [
            ("<f4", bytes(values, |v| (v as f32).to_le_bytes())),
            (">f4", bytes(values, |v| (v as f32).to_be_bytes())),
            ("<f8", bytes(values, f64::to_le_bytes)),
            (">f8", bytes(values, f64::to_be_bytes)),
        ] {
            let array = read(&file(descr, order, "(2, 3)", &data)).expect("valid");
            assert_eq!((array.width, array.height), (3, 2));
            assert_eq!(array.occupancy, expected, "{descr} {order}");
        }
    }
    let read = |descr, data: &[u8]| read(&file(descr, false, "(1, 4)", data)).expect("valid").occupancy;
    assert_eq!(read("|i1", &[0, 37, 100, 255]), [Some(0.0), Some(0.37), Some(1.0), None]);
    assert_eq!(read("|u1", &[0, 37, 100, 255]), [Some(0.0), Some(0.37), Some(1.0), None]);
    assert_eq!(read("|b1", &[0, 1, 1, 0]), [Some(0.0), Some(1.0), Some(1.0), Some(0.0)]);
    assert_eq!(read("|i1", &[255; 4]), [None; 4], "nothing known");
    let expected = [Some(0.0), Some(0.37), Some(1.0), None];
    let percents = [0_i64, 37, 100, -1];
    assert_eq!(read("<i8", &percents.map(i64::to_le_bytes).concat()), expected);
    assert_eq!(read(">i4", &percents.map(|v| (v as i32).to_be_bytes()).concat()), expected);
    assert_eq!(read("<i2", &percents.map(|v| (v as i16).to_le_bytes()).concat()), expected);
    assert_eq!(read("<u2", &[0_u16, 37, 100, 255].map(u16::to_le_bytes).concat()), expected);
    // 0.25, 1, NaN and 0 in half precision.
    let halves = [0x3400_u16, 0x3c00, 0x7e00, 0].map(u16::to_le_bytes).concat();
    assert_eq!(read("<f2", &halves), [Some(0.25), Some(1.0), None, Some(0.0)]);
}

#[test]
fn later_versions_have_longer_headers() {
    let first = file("|b1", false, "(1, 1)", &[1]);
    for version in [2, 3] {
        let mut bytes = first.clone();
        bytes[6] = version;
        bytes.splice(10..10, [0, 0]);
        assert_eq!(read(&bytes).expect("valid").occupancy, [Some(1.0)]);
    }
}

#[test]
fn messages() {
    let good = file("|b1", false, "(1, 1)", &[1]);
    let with = |at: usize, byte| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    let mut claims = b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec();
    claims.extend(b"{}");
    let shape = "must be two numbers, rows and columns, of at least 1 and at most 100000000 cells in all; save one map, cropped or with larger cells";
    let again = "save the map again with numpy.save";
    let share = "must be from 0 to 1, or NaN; save shares of occupancy, not percent or log odds";
    let f4 = |values: &[f64]| file("<f4", false, "(1, 2)", &bytes(values, |v| (v as f32).to_le_bytes()));
    let table = [
        (Vec::new(), format!("m.npy: it ends within its header; {again}")),
        (good[..60].to_vec(), format!("m.npy: it ends within its header; {again}")),
        (b"P5 2 2 255 1234".to_vec(), format!("m.npy: its first bytes are not those of an NPY file; {again}")),
        (with(6, 4), format!("m.npy: version 4 of the format is not known; {again}")),
        (claims, format!("m.npy: its header claims 4294967295 bytes: must be at most 65536; {again}")),
        (with(11, 0xff), format!("m.npy: its header is no text; {again}")),
        (
            with(11, b'x'),
            format!("m.npy: its header is no {{'descr': TYPE, 'fortran_order': BOOL, 'shape': (ROWS, COLUMNS)}}; {again}"),
        ),
        (file("<f4", false, "(2,)", &[0; 8]), format!("m.npy: shape = (2): {shape}")),
        (file("<f4", false, "(1, 2, 1)", &[0; 8]), format!("m.npy: shape = (1, 2, 1): {shape}")),
        (file("<f4", false, "(0, 2)", &[]), format!("m.npy: shape = (0, 2): {shape}")),
        (
            file("<f4", false, "(4294967296, 4294967296)", &[]),
            format!("m.npy: shape = (4294967296, 4294967296): {shape}"),
        ),
        (
            file("<f8", false, "(10000, 10000)", &[0; 8]),
            format!("m.npy: 10000 x 10000 values of type <f8 are 800000000 bytes, but 8 follow its header; {again}"),
        ),
        (
            file("<f4", false, "(1, 2)", &[0; 9]),
            format!("m.npy: 1 x 2 values of type <f4 are 8 bytes, but 9 follow its header; {again}"),
        ),
        (
            file("<c8", false, "(1, 1)", &[0; 8]),
            "m.npy: dtype = <c8: must be float16, float32, float64, bool, or integers of 1 to 8 bytes; convert it with astype(\"float32\")".into(),
        ),
        (f4(&[0.5, 1.5]), format!("m.npy: value [0, 1] = 1.5: {share}")),
        (
            f4(&[0.5, -1.0]),
            "m.npy: value [0, 1] = -1: must be from 0 to 1, or NaN; NaN means unknown: a[a < 0] = numpy.nan".into(),
        ),
        (
            f4(&[0.5, 30.0]),
            "m.npy: value [0, 1] = 30: must be from 0 to 1, or NaN; save shares of occupancy, not percent or log odds: a / 100 if it is percent".into(),
        ),
        (
            f4(&[0.0, 254.0 / 255.0]),
            "m.npy: its values = 0.804 and 0.996: must be shares of occupancy; 0, 205 / 255 and 254 / 255 are the shades of a picture; save the picture as PNG and convert that, or save states: a == 0 as bool".into(),
        ),
        (
            file("|u1", false, "(1, 1, 3)", &[0; 3]),
            "m.npy: shape = (1, 1, 3): must be two numbers, rows and columns; this is a picture of 3 channels; save one of them: numpy.save(path, a[:, :, 0])".into(),
        ),
        (
            file("|u1", false, "(1, 2)", &[0, 255]),
            "m.npy: its values = 0 and 255: must be percent; 0 and 255 alone are a picture or a mask; save states as bool: a == 0 where black is occupied, a == 255 where white is".into(),
        ),
        (
            file("<i4", false, "(1, 3)", &[255, 255, 255, 255, 0, 0, 0, 0, 1, 0, 0, 0]),
            "m.npy: the largest value = 1: must be a percent, up to 100; save shares: numpy.where(a == 1, 1.0, numpy.where(a == 0, 0.0, numpy.nan))".into(),
        ),
        (
            file("<i2", false, "(1, 1)", &[0, 0x80]),
            "m.npy: value [0, 0] = -32768: must be from 0 to 100, or -1 or 255; save percent of occupancy, as a ROS OccupancyGrid has them".into(),
        ),
        (f4(&[-0.5, 0.5]), format!("m.npy: value [0, 0] = -0.5: {share}")),
        (f4(&[f64::INFINITY, 0.5]), format!("m.npy: value [0, 0] = inf: {share}")),
        (
            file("|u1", false, "(1, 2)", &[100, 101]),
            "m.npy: value [0, 1] = 101: must be from 0 to 100, or -1 or 255; save percent of occupancy, as a ROS OccupancyGrid has them; save a picture as PNG and convert that".into(),
        ),
        (
            file("|u1", false, "(1, 2)", &[0, 1]),
            "m.npy: the largest value = 1: must be a percent, up to 100; save states as bool, or shares as float32".into(),
        ),
        (
            file("|b1", false, "(1, 2)", &[0, 2]),
            "m.npy: value [0, 1] = 2: must be 0 or 1; save the array again".into(),
        ),
    ];
    for (bytes, expected) in table {
        assert_eq!(read(&bytes).expect_err("no map"), expected);
    }
}

#[test]
fn a_file_that_cannot_be_opened_is_the_systems_fault() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert!(npy::read(&folder.path().join("absent.npy")).expect_err("not there").is_io());
    assert!(npy::read(folder.path()).is_err());
}
