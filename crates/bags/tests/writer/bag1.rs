//! Bags of ROS 1, format 2.0: chunks of some messages each, and an index of connections.

use super::{Message, Packing, topics};

fn fields(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let field = |(name, value): &(&str, &[u8])| {
        let content = [name.as_bytes(), b"=", value].concat();
        [&(content.len() as u32).to_le_bytes()[..], &content].concat()
    };
    fields.iter().flat_map(field).collect()
}

pub(crate) fn record(head: &[(&str, &[u8])], content: &[u8]) -> Vec<u8> {
    let head = fields(head);
    [&(head.len() as u32).to_le_bytes()[..], &head, &(content.len() as u32).to_le_bytes(), content].concat()
}

fn connection(number: usize, topic: &str, kind: &str) -> Vec<u8> {
    let described = fields(&[("topic", topic.as_bytes()), ("type", kind.as_bytes()), ("md5sum", b"*")]);
    let number = (number as u32).to_le_bytes();
    record(&[("op", &[7]), ("conn", &number), ("topic", topic.as_bytes())], &described)
}

/// A bag with so many messages a chunk; connections stand in the chunk of their first message.
pub(crate) fn file(messages: &[Message], packing: Packing, in_a_chunk: usize) -> Vec<u8> {
    let topics = topics(messages);
    let mut known = 0;
    let mut chunks = Vec::new();
    for some in messages.chunks(in_a_chunk) {
        let mut records = Vec::new();
        for one in some {
            let number = topics.iter().position(|topic| *topic == (one.topic, one.kind)).expect("listed");
            while known <= number {
                records.extend(connection(known, topics[known].0, topics[known].1));
                known += 1;
            }
            let (seconds, rest) = ((one.time_ns / 1_000_000_000) as u32, (one.time_ns % 1_000_000_000) as u32);
            let time = [seconds.to_le_bytes(), rest.to_le_bytes()].concat();
            records
                .extend(record(&[("op", &[2]), ("conn", &(number as u32).to_le_bytes()), ("time", &time)], &one.bytes));
        }
        let size = (records.len() as u32).to_le_bytes();
        let name = packing.name("none");
        chunks.extend(record(
            &[("op", &[5]), ("compression", name.as_bytes()), ("size", &size)],
            &packing.pack(&records),
        ));
        chunks.extend(record(&[("op", &[4]), ("ver", &[1, 0, 0, 0])], &[0; 12]));
    }
    let head = |index: u64| record(&[("op", &[3]), ("index_pos", &index.to_le_bytes())], &[b' '; 64]);
    let before = [&b"#ROSBAG V2.0\n"[..], &head(0)].concat().len();
    let index = (before + chunks.len()) as u64;
    let mut file = [&b"#ROSBAG V2.0\n"[..], &head(index), &chunks].concat();
    topics.iter().enumerate().for_each(|(number, (topic, kind))| file.extend(connection(number, topic, kind)));
    file
}
