//! Files that are none of ours, told by how they begin, with the command that reads them.

const MAP: &str = "`scene from-map MAP --out SCENE.toml` makes a scene of it, `convert` other forms";
const LOG: &str = "`replay` maps it, `calibrate` fits a sensor to it";
const PLAN: &str = "`scene from-plan PLAN --out SCENE.toml` makes a scene of a floor plan";
const IMAGE: &str =
    "give the YAML file that describes the map: `scene from-map MAP.yaml --out SCENE.toml` makes a scene of it";
const UNPACK: &str = "unpack it";
const UTF8: &str = "save it as UTF-8, such as with iconv -f UTF-16 -t UTF-8";

/// First bytes, what they are of, and what to do.
const MAGIC: [(&[u8], &str, &str); 18] = [
    (b"\x89PNG", "a PNG image", IMAGE),
    (b"P2\n", "a PGM image", IMAGE),
    (b"P5\n", "a PGM image", IMAGE),
    (b"P2\r", "a PGM image", IMAGE),
    (b"P5\r", "a PGM image", IMAGE),
    (b"P2 ", "a PGM image", IMAGE),
    (b"P5 ", "a PGM image", IMAGE),
    (b"BM", "a BMP image", IMAGE),
    (b"\xff\xd8\xff", "a JPEG image", IMAGE),
    (b"GIF8", "a GIF image", IMAGE),
    (b"\x93NUMPY", "a NumPy array", "`convert` writes a map of it, and `scene from-map` makes a scene of that"),
    (b"\x1f\x8b", "a gzip archive", "unpack it with gzip -d; logs are read as they are by `replay` and `calibrate`"),
    (b"PK\x03\x04", "a zip archive", UNPACK),
    (b"\xfd7zXZ\0", "an xz archive", UNPACK),
    (b"\x28\xb5\x2f\xfd", "a zstd archive", UNPACK),
    (b"%PDF", "a PDF document", "give a TOML text"),
    (b"\xff\xfe", "UTF-16 text", UTF8),
    (b"\xfe\xff", "UTF-16 text", UTF8),
];

/// First words of a line among the first ones, what they are of, and what to do.
const WORDS: [(&str, &str, &str); 14] = [
    ("image:", "the description of a map (YAML)", MAP),
    ("resolution:", "the description of a map (YAML)", MAP),
    ("FLASER ", "a log of a laser (CARMEN)", LOG),
    ("RLASER ", "a log of a laser (CARMEN)", LOG),
    ("ROBOTLASER1 ", "a log of a laser (CARMEN)", LOG),
    ("RAWLASER1 ", "a log of a laser (CARMEN)", LOG),
    ("PARAM ", "a log of a laser (CARMEN)", LOG),
    ("ODOM ", "a log of a laser (CARMEN)", LOG),
    ("scan,", "a table of scans", "`replay`, `calibrate` and `speed` read it"),
    ("mapper,", "a table of results", "give a TOML text"),
    ("{", "a JSON document", PLAN),
    ("<", "an XML document or a web page", "download the file itself"),
    ("version https://git-lfs", "a placeholder of Git LFS", "fetch the file itself with git lfs pull"),
    ("%YAML", "a YAML document", MAP),
];

/// So many lines of a text are looked at.
const LINES: usize = 40;

/// What a file is that is no TOML and begins so, and what to do.
pub(crate) fn named(start: &[u8]) -> Option<(&'static str, &'static str)> {
    if let Some((_, what, remedy)) = MAGIC.iter().find(|(magic, ..)| start.starts_with(magic)) {
        return Some((what, remedy));
    }
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    let mut lines = text.split(|byte| *byte == b'\n').take(LINES);
    let found = lines.find_map(|line| WORDS.iter().find(|(word, ..)| line.starts_with(word.as_bytes())));
    found.map(|(_, what, remedy)| (*what, *remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_logs_plans_and_pictures_are_named_and_toml_is_not() {
        for (start, expected) in [
            (&b"# saved\nimage: a.pgm\nresolution: 0.05\n"[..], "from-map"),
            (b"\xef\xbb\xbfimage: a.pgm", "from-map"),
            (b"P5\n4 3\n255\n\xcd", "from-map"),
            (b"\x89PNG\r\n", "from-map"),
            (b"\x93NUMPY\x01\0", "convert"),
            (b"# CARMEN\nPARAM robot_length 1\nFLASER 3 1 1 1 0 0 0 0 0 0 1 h 1\n", "replay"),
            (b"scan,time_s,x_m\n1,0,0\n", "replay"),
            (b"{\"verts\": []}", "from-plan"),
            (b"\xff\xfei\0", "iconv"),
        ] {
            let (what, remedy) = named(start).expect(expected);
            assert!(format!("{what}; {remedy}").contains(expected), "{what}; {remedy}");
        }
        for start in [&b""[..], b"name = \"room\"\n[bounds]\n", b"\n\n[image]\n"] {
            assert_eq!(named(start), None, "{}", String::from_utf8_lossy(start));
        }
    }
}
