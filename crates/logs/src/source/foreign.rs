//! Files that are no logs, told by their first bytes, with the way from them to one.

const TO_TEXT: &str = "export its scans as a table (scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m)";
const BAG: &str = "give its path to replay, slam or calibrate, or to Log::open";
const UTF8: &str = "save it as UTF-8, such as with iconv -f UTF-16 -t UTF-8";

/// First bytes, what they are of, and what to do.
const MAGIC: &[(&[u8], &str, &str)] = &[
    (b"\xfd7zXZ\0", "an xz archive", "unpack it with xz -d"),
    (b"\x28\xb5\x2f\xfd", "a zstd archive", "unpack it with zstd -d"),
    (b"\x04\x22\x4d\x18", "an lz4 archive", "unpack it with lz4 -d"),
    (b"\x5d\0\0", "an lzma archive", "unpack it with xz -d"),
    (b"LZIP", "an lzip archive", "unpack it with lzip -d"),
    (b"\x1f\x9d", "a compress archive (.Z)", "unpack it with uncompress"),
    (b"PK\x03\x04", "a zip archive", "unpack it, and give the log in it"),
    (b"PK\x05\x06", "an empty zip archive", "get a whole copy"),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "unpack it, and give the log in it"),
    (b"Rar!", "a rar archive", "unpack it, and give the log in it"),
    (b"#ROSBAG V", "a ROS 1 bag", BAG),
    (b"\x89MCAP", "an MCAP file of ROS 2", BAG),
    (b"SQLite format 3\0", "an SQLite database, as of a ROS 2 bag (.db3)", BAG),
    (b"\x89HDF\r\n", "an HDF5 file", TO_TEXT),
    (b"\x93NUMPY", "a NumPy array", TO_TEXT),
    (b"\x89PNG", "a PNG image", "give a log; maps are read by convert and scene from-map"),
    (b"%PDF", "a PDF document", "give a log"),
    (b"\x7fELF", "a program", "give a log"),
    (b"\0\0\xfe\xff", "UTF-32 text", UTF8),
    (b"\xff\xfe", "UTF-16 text", UTF8),
    (b"\xfe\xff", "UTF-16 text", UTF8),
    (b"# .PCD", "a point cloud (PCD)", TO_TEXT),
    (b"ply\n", "a point cloud (PLY)", TO_TEXT),
];

/// First words of a text, what they are of, and what to do.
const WORDS: &[(&str, &str, &str)] = &[
    (
        "VERTEX",
        "a pose graph (g2o, TORO)",
        "it has poses and no scans: give the log that it was made from, and its poses as a trajectory",
    ),
    (
        "EDGE",
        "a pose graph (g2o, TORO)",
        "it has poses and no scans: give the log that it was made from, and its poses as a trajectory",
    ),
    (
        "LASER_READING",
        "a log of GFS (GMapping)",
        "write its readings as FLASER lines, of which n ranges and the pose x y theta are the same",
    ),
    (
        "ODOM_POS",
        "a log of GFS (GMapping)",
        "write its readings as FLASER lines, of which n ranges and the pose x y theta are the same",
    ),
    ("rosbag2_bagfile_information:", "the description of a ROS 2 bag", "give the folder in which it lies"),
    ("version https://git-lfs", "a placeholder of Git LFS", "fetch the file itself with git lfs pull"),
    ("<!DOCTYPE", "a web page", "download the file itself"),
    ("<!doctype", "a web page", "download the file itself"),
    ("<html", "a web page", "download the file itself"),
    ("<?xml", "an XML document", TO_TEXT),
    ("<", "an XML document or a web page", TO_TEXT),
    ("{", "a JSON document", TO_TEXT),
    ("[", "a JSON document", TO_TEXT),
    ("image:", "the description of a map (YAML)", "give a log; maps are read by convert and scene from-map"),
    ("%YAML", "a YAML document", TO_TEXT),
    ("---", "a YAML document, such as of rostopic echo", TO_TEXT),
    ("header:", "a YAML document, such as of rostopic echo", TO_TEXT),
];

/// What a file is that begins so, and what to do, if it is none of ours.
pub(super) fn named(start: &[u8]) -> Option<(&'static str, &'static str)> {
    if let Some((_, what, remedy)) = MAGIC.iter().find(|(magic, ..)| start.starts_with(magic)) {
        return Some((what, remedy));
    }
    if start.get(257..262) == Some(b"ustar") {
        return Some(("a tar archive", "unpack it with tar -xf, and give the log in it"));
    }
    if is_wide(start) {
        return Some(("UTF-16 text", UTF8));
    }
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    let found = WORDS.iter().find(|(word, ..)| text.starts_with(word.as_bytes()));
    found.map(|(_, what, remedy)| (*what, *remedy))
}

/// Whether every second byte is 0 for a while, and the others are not.
fn is_wide(start: &[u8]) -> bool {
    let pairs = &start.as_chunks::<2>().0[..(start.len() / 2).min(32)];
    pairs.len() >= 8 && [0, 1].iter().any(|k| pairs.iter().all(|pair| pair[*k] == 0 && pair[1 - *k] != 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_named_and_logs_are_not() {
        for (start, expected) in [
            (&b"\xfd7zXZ\0\0\x04"[..], "xz -d"),
            (b"\x28\xb5\x2f\xfd\x04", "zstd -d"),
            (b"PK\x03\x04\x14\0", "zip"),
            (b"#ROSBAG V2.0\nE", "ROS 1 bag"),
            (b"\x89MCAP0\r\n", "MCAP"),
            (b"SQLite format 3\0\x10", "db3"),
            (b"VERTEX_SE2 0 0 0 0\n", "pose graph"),
            (b"\nEDGE_SE2 0 1 1 0 0.1 100\n", "pose graph"),
            (b"LASER_READING 5 1.0 1.1", "GFS"),
            (b"\xff\xfeF\0L\0", "UTF-16"),
            (b"F\0L\0A\0S\0E\0R\0 \x001\0 \0", "UTF-16"),
            (b"\xef\xbb\xbf<html><body>", "web page"),
            (b"{\"scans\": []}", "JSON"),
        ] {
            let (what, remedy) = named(start).expect(expected);
            assert!(format!("{what}; {remedy}").contains(expected), "{what}; {remedy}");
        }
        let mut archive = vec![b'a'; 512];
        archive[257..262].copy_from_slice(b"ustar");
        assert_eq!(named(&archive).map(|(what, _)| what), Some("a tar archive"));
        for start in [
            &b""[..],
            b"\n",
            b"FLASER 1 2",
            b"scan,x_m",
            b"# CARMEN",
            b"PARAM a b",
            b"1.0 2.0",
            b"\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
        ] {
            assert_eq!(named(start), None, "{start:?}");
        }
    }
}
