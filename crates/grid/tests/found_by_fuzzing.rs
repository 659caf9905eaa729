//! Inputs that broke a promise once: found by `crates/fuzz`, made small by hand.

use std::path::Path;

use grid::npy;
use grid::ros_map::{Coding, read_from, read_image_from};

const YAML: &str =
    "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn refusal_of_map(part: &str, other: &str) -> String {
    assert!(YAML.contains(part));
    let yaml = YAML.replace(part, other);
    read_from(yaml.as_bytes(), b"P2 1 1 255 0", Path::new("m.yaml")).expect_err(&yaml).to_string()
}

#[test]
fn a_value_of_several_lines_is_quoted_on_one() {
    let message = refusal_of_map("negate: 0", "negate: \"0\\n\\t\\e[1m1\"");
    let expected =
        "m.yaml:4:9: negate = 0\\n\\t\\u{1b}[1m1: must be 0 or 1; give 1 if occupied cells are white".to_owned();
    assert_eq!(message, expected);
}

#[test]
fn a_long_value_is_quoted_in_part() {
    for (part, start) in [("0.05", "resolution: "), ("[0, 0, 0]", "origin: "), ("m.pgm", "image: ")] {
        let long = "7".repeat(50_000);
        let other = if start == "origin: " { format!("[{long}]") } else { long };
        let message = refusal_of_map(part, &other);
        assert!(message.contains(&format!("{}...", "7".repeat(60))) && message.len() < 250, "{message}");
    }
}

#[test]
fn a_long_key_that_stands_twice_is_quoted_in_part() {
    let key = "k".repeat(900);
    let message = refusal_of_map("image:", &format!("{key}: 1\n{key}: 2\nimage:"));
    assert!(message.contains(&format!("`{}...` stands here", "k".repeat(60))), "{message}");
}

#[test]
fn the_name_of_an_image_is_one_line() {
    let yaml = YAML.replace("m.pgm", "\"m\\n.pgm\"");
    let message = read_from(yaml.as_bytes(), b"P2 1 1 255", Path::new("m.yaml")).expect_err(&yaml).to_string();
    assert!(message.starts_with("m\\n.pgm: cannot be read as a PGM"), "{message}");
}

#[test]
fn a_header_of_noise_is_quoted_in_part() {
    let image = [b"P7\n", [7; 1000].as_slice(), b"\nENDHDR\n"].concat();
    let read = read_image_from(&image, Path::new("m.pgm"), Coding::default(), 0.05, [0.0; 2]);
    let message = read.expect_err("no image").to_string();
    assert!(message.starts_with("m.pgm:4:1: cannot be read") && message.len() < 400, "{message}");
}

#[test]
fn the_type_of_an_array_is_quoted_on_one_line() {
    for (descr, quoted) in
        [("<\t\0f8".to_owned(), "<\\t\\u{0}f8"), ("x".repeat(5000), &format!("{}...", "x".repeat(60)))]
    {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (1, 1)}}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        let message = npy::read_from(&*bytes, bytes.len() as u64, Path::new("m.npy")).expect_err("no map").to_string();
        let expected =
            format!("m.npy: dtype = {quoted}: must be float16, float32, float64, bool, or integers of 1 to 8 bytes; ");
        assert!(message.starts_with(&expected), "{message}");
    }
}

#[test]
fn a_palette_that_ends_within_a_colour_is_refused() {
    // Four pixels of two bits, and a palette of 7 bytes.
    let image = b"\x89PNG\r\n\x1a\n\x00\x00\x00\x0dIHDR\x00\x00\x00\x04\x00\x00\x00\x01\x02\x03\x00\x00\x00\x84R\xe7^\
        \x00\x00\x00\x07PLTE\x00\x01\x02\x03\x04\x05\x06\xe9H\x81\x92\
        \x00\x00\x00\x0aIDATx\x9cc\x90\x06\x00\x00\x1d\x00\x1c\x8e\xf4\xf5!\x00\x00\x00\x00IEND\xaeB`\x82";
    let read = read_image_from(image, Path::new("m.png"), Coding::default(), 0.05, [0.0; 2]);
    let message = read.expect_err("no image").to_string();
    assert!(message.contains("its palette has 7 bytes, and each colour takes three"), "{message}");
}
