//! Bags in all containers and compressions, whole, cut and damaged.

mod writer;

use bags::{Bag, Damage, Loss, Record};
use proptest::prelude::*;
use writer::{Message, Packing, bag1, db3, mcap};

/// Messages of three topics, the bytes of one longer than a page.
fn messages(count: u64) -> Vec<Message> {
    let message = |k: u64| {
        let (topic, kind, long) = match k % 3 {
            0 => ("/scan", "sensor_msgs/msg/LaserScan", 700 + k as usize),
            1 => ("/odom", "nav_msgs/msg/Odometry", 40),
            _ => ("/tf", "tf2_msgs/msg/TFMessage", 9),
        };
        let bytes = (0..long).map(|j| (j as u64 * 31 + k) as u8).collect();
        Message { topic, kind, time_ns: 1_700_000_000_000_000_000 + k * 20_000_000, bytes }
    };
    (0..count).map(message).collect()
}

fn read(bytes: Vec<u8>) -> (Vec<Record>, Vec<Damage>) {
    let bag = Bag::read(bytes, "a.bag").expect("a bag");
    let (mut records, mut damages) = (Vec::new(), Vec::new());
    for item in bag.records(|_| true) {
        match item {
            Ok(record) => records.push(record),
            Err(damage) => damages.push(damage),
        }
    }
    (records, damages)
}

/// What was read as it was written.
fn same(record: &Record, message: &Message) -> bool {
    let kind = message.kind.replace("/msg/", "/");
    (record.topic.name.as_str(), record.topic.kind.as_str(), record.time_ns, &record.bytes[..])
        == (message.topic, kind.as_str(), message.time_ns, &message.bytes[..])
}

/// All files of the messages, with their names.
fn files(messages: &[Message]) -> Vec<(String, Vec<u8>)> {
    let mcaps = [Packing::None, Packing::Lz4, Packing::Zstd];
    let mcaps = mcaps.map(|packing| (format!("mcap {packing:?}"), mcap::file(messages, packing, 4, "cdr")));
    let bags = [Packing::None, Packing::Bz2, Packing::Lz4];
    let bags = bags.map(|packing| (format!("bag {packing:?}"), bag1::file(messages, packing, 4)));
    let db3 = [("db3".to_owned(), db3::file(messages))];
    let mut files: Vec<_> = mcaps.into_iter().chain(bags).chain(db3).collect();
    let packed: Vec<_> =
        files.iter().map(|(name, bytes)| (format!("{name}, packed"), Packing::Zstd.pack(bytes))).collect();
    files.extend(packed);
    files
}

#[test]
fn every_container_gives_what_was_written() {
    let messages = messages(50);
    for (name, bytes) in files(&messages) {
        let (records, damages) = read(bytes);
        assert!(damages.is_empty(), "{name}: {damages:?}");
        assert_eq!(records.len(), messages.len(), "{name}");
        assert!(records.iter().zip(&messages).all(|(record, message)| same(record, message)), "{name}");
    }
}

#[test]
fn messages_that_are_packed_one_by_one_are_unpacked() {
    let mut messages = messages(9);
    messages.iter_mut().for_each(|message| message.bytes[0] = 0); // as CDR begins
    let mut packed = messages.clone();
    packed.iter_mut().for_each(|message| message.bytes = Packing::Zstd.pack(&message.bytes));
    for bytes in [mcap::file(&packed, Packing::None, 4, "cdr"), db3::file(&packed)] {
        let (records, damages) = read(bytes);
        assert!(damages.is_empty() && records.iter().zip(&messages).all(|(record, message)| same(record, message)));
    }
}

#[test]
fn bytes_that_are_not_wanted_may_be_left_out_and_the_others_are_there() {
    let messages = messages(9);
    for (name, bytes) in files(&messages) {
        let bag = Bag::read(bytes, "a.bag").expect("a bag");
        let records: Vec<Record> =
            bag.records(|topic| topic.name == "/scan").map(|item| item.expect("whole")).collect();
        assert_eq!(records.len(), 9, "{name}");
        let scans = records.iter().zip(&messages).filter(|(_, message)| message.topic == "/scan");
        assert!(scans.into_iter().all(|(record, message)| same(record, message)), "{name}");
    }
}

#[test]
fn a_damaged_chunk_is_named_with_offset_and_checksum_and_takes_nothing_else() {
    let messages = messages(20);
    let mut bytes = mcap::file(&messages, Packing::None, 4, "cdr");
    // A byte of the first message: its chunk also defines all channels, which the summary has too.
    let at = bytes.windows(9).position(|some| *some == messages[0].bytes[..9]).expect("there") + 20;
    bytes[at] ^= 1;
    let (records, damages) = read(bytes);
    assert_eq!((records.len(), damages.len()), (16, 1));
    assert!(records.iter().zip(&messages[4..]).all(|(record, message)| same(record, message)));
    let text = damages[0].to_string();
    assert!(damages[0].loss == Loss::Chunk && damages[0].offset < at as u64, "{text}");
    assert!(text.starts_with("a.bag, byte ") && text.contains("its CRC-32 is"), "{text}");
    for packing in [Packing::Lz4, Packing::Bz2] {
        let mut bytes = bag1::file(&messages, packing, 4);
        let at = bytes.windows(12).position(|some| some == b"compression=").expect("a chunk") + 150;
        bytes[at] ^= 0x10;
        let (records, damages) = read(bytes);
        assert_eq!((records.len(), damages.len()), (16, 1), "{packing:?}: {damages:?}");
        assert!(damages[0].to_string().contains("the chunk"), "{}", damages[0]);
    }
}

#[test]
fn lengths_are_claims_and_nothing_is_allocated_for_them() {
    let huge = [mcap::MAGIC, &[6], &(u64::MAX / 2).to_le_bytes(), &[0; 40]].concat();
    let (records, damages) = read(huge);
    assert!(
        records.is_empty() && damages[0].to_string().contains("claims 9223372036854775807 bytes"),
        "{}",
        damages[0]
    );
    // A chunk that claims to unpack to more than it does, and to more than any may.
    for claim in [5000u64, 1 << 40] {
        let packed = Packing::Lz4.pack(&[0; 100]);
        let length = (packed.len() as u64).to_le_bytes();
        let chunk = [&[0; 16][..], &claim.to_le_bytes(), &[0; 4], b"\x03\0\0\0lz4", &length, &packed].concat();
        let (_, damages) = read([mcap::MAGIC, &mcap::record(6, &chunk), &mcap::record(15, &[0; 4])].concat());
        assert!(damages.len() == 1 && damages[0].to_string().contains(&claim.to_string()), "{damages:?}");
    }
    let long = [&b"#ROSBAG V2.0\n"[..], &u32::MAX.to_le_bytes(), &[0; 20]].concat();
    let (_, damages) = read(long);
    assert!(damages[0].to_string().contains("its head would have 4294967295 bytes"), "{}", damages[0]);
}

#[test]
fn a_chunk_that_is_cut_is_read_as_far_as_it_goes() {
    let messages = messages(60);
    let mcaps = [Packing::None, Packing::Lz4].map(|packing| mcap::file(&messages, packing, 60, "cdr"));
    let bags = [Packing::None, Packing::Lz4].map(|packing| bag1::file(&messages, packing, 60));
    for (k, file) in mcaps.into_iter().chain(bags).enumerate() {
        // Blocks of lz4 are longer than half of this chunk, so that of a cut one nothing may be left.
        let (records, damages) = read(file[..file.len() / 2].to_vec());
        assert!(k % 2 == 1 || (20..40).contains(&records.len()), "{k}: {} records", records.len());
        assert!(records.iter().zip(&messages).all(|(record, message)| same(record, message)));
        assert!(damages.last().is_some_and(|damage| damage.to_string().contains("ends within a chunk")), "{damages:?}");
    }
}

#[test]
fn what_is_no_bag_is_refused_with_what_to_do() {
    for (bytes, expected) in [
        (&b"#ROSBAG V1.2\n"[..], "rosbag migrate"),
        (b"PK\x03\x04", "is no bag"),
        (b"", "is no bag"),
        (b"\x28\xb5\x2f\xfdxxxx", "is no bag"),
    ] {
        let message = Bag::read(bytes.to_vec(), "a.bag").expect_err(expected).to_string();
        assert!(message.contains(expected), "{message}");
    }
    let other = db3::file(&[]);
    let other = String::from_utf8_lossy(&other).replace("topics", "tropic").into_bytes();
    let damages =
        Bag::read(other, "a.db3").map(|bag| bag.records(|_| true).filter_map(Result::err).collect::<Vec<_>>());
    assert!(damages.is_ok_and(|damages| damages[0].to_string().contains("without the tables of a bag")));
}

#[test]
fn a_tree_that_goes_round_comes_to_an_end() {
    let mut bytes = db3::file(&messages(40));
    // Every child of an interior page is that page itself.
    let pages: Vec<usize> = (0..bytes.len() / 512).filter(|page| bytes[page * 512] == 5).collect();
    assert_eq!(pages.len(), 1);
    let (start, number) = (pages[0] * 512, pages[0] as u32 + 1);
    bytes[start + 8..start + 12].copy_from_slice(&number.to_be_bytes());
    let (records, damages) = read(bytes);
    assert!(
        records.len() >= 30 && damages.iter().any(|damage| damage.to_string().contains("comes again")),
        "{damages:?}"
    );
}

#[test]
fn a_write_ahead_log_has_the_newest_pages() {
    let (old, new) = (db3::file(&messages(3)), db3::file(&messages(12)));
    let salts = [1u8, 2, 3, 4, 5, 6, 7, 8];
    let head = [
        &0x377f_0682u32.to_be_bytes()[..],
        &3_007_000u32.to_be_bytes(),
        &512u32.to_be_bytes(),
        &[0; 4],
        &salts,
        &[0; 8],
    ];
    let mut log = head.concat();
    let count = (new.len() / 512) as u32;
    for (number, page) in (1u32..).zip(new.chunks(512)) {
        let commit = if number == count { count } else { 0 };
        log.extend([&number.to_be_bytes()[..], &commit.to_be_bytes(), &salts, &[0; 8], page].concat());
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.db3");
    std::fs::write(&path, &old).expect("writable");
    let count = || Bag::open(&path).expect("a bag").records(|_| true).filter(Result::is_ok).count();
    assert_eq!(count(), 3);
    std::fs::write(folder.path().join("run.db3-wal"), &log).expect("writable");
    assert_eq!(count(), 12);
    // Without its end, nothing of it was committed.
    std::fs::write(folder.path().join("run.db3-wal"), &log[..log.len() - 600]).expect("writable");
    assert_eq!(count(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_cut_file_is_read_as_far_as_it_goes(which in 0usize..14, cut in 0.0..1.0f64) {
        let messages = messages(24);
        let (name, bytes) = files(&messages).swap_remove(which);
        let cut = (cut * bytes.len() as f64) as usize;
        let Ok(bag) = Bag::read(bytes[..cut].to_vec(), "a.bag") else { return Ok(()) };
        let (mut found, mut last) = (Vec::new(), None);
        for item in bag.records(|_| true) {
            match item {
                Ok(record) => found.push(record),
                Err(damage) => last = Some(damage),
            }
        }
        if name.starts_with("db3") {
            // Its pages are in another order than its rows.
            prop_assert!(found.iter().all(|record| messages.iter().any(|message| same(record, message))), "{}", name);
        } else {
            prop_assert!(found.iter().zip(&messages).all(|(record, message)| same(record, message)), "{}", name);
        }
        prop_assert!(found.len() == messages.len() || last.is_some() || name.starts_with("bag"), "{}: silence about {} of 24", name, found.len());
    }

    #[test]
    fn a_changed_byte_costs_no_more_than_what_it_stands_in(which in 0usize..14, at in 0.0..1.0f64, flip in 1u8..) {
        let messages = messages(24);
        let (name, mut bytes) = files(&messages).swap_remove(which);
        let at = (at * bytes.len() as f64) as usize;
        bytes[at] ^= flip;
        let Ok(bag) = Bag::read(bytes, "a.bag") else { return Ok(()) };
        let items: Vec<_> = bag.records(|_| true).collect();
        prop_assert!(items.len() < 200, "{}: {} items", name, items.len());
        for damage in items.iter().filter_map(|item| item.as_ref().err()) {
            prop_assert!(!damage.to_string().contains('\n') && damage.to_string().len() < 500, "{}", damage);
        }
        // The checksum of MCAP lets nothing pass that was not written.
        if name.starts_with("mcap") && !name.contains("packed") {
            let records = items.iter().filter_map(|item| item.as_ref().ok());
            let known = |record: &Record| messages.iter().any(|message| message.time_ns == record.time_ns && message.bytes == record.bytes[..]);
            prop_assert!(records.into_iter().all(known), "{}", name);
        }
    }
}
