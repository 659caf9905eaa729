//! MCAP: chunks of some messages each, with checksums, and a summary.

use super::{Message, Packing, topics};

pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

pub(crate) fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// Schema and channel of a topic.
fn defined(number: usize, topic: &str, kind: &str, encoding: &str) -> Vec<u8> {
    let id = (number as u16 + 1).to_le_bytes();
    let schema = [&id[..], &text(kind), &text("ros2msg"), &text("")].concat();
    let channel = [&id[..], &id, &text(topic), &text(encoding), &0u32.to_le_bytes()].concat();
    [record(3, &schema), record(4, &channel)].concat()
}

fn message(number: usize, message: &Message) -> Vec<u8> {
    let id = (number as u16 + 1).to_le_bytes();
    let time = message.time_ns.to_le_bytes();
    record(5, &[&id[..], &[0; 4], &time, &time, &message.bytes].concat())
}

/// A file with so many messages a chunk; channels are defined in the chunk of their first message.
pub(crate) fn file(messages: &[Message], packing: Packing, in_a_chunk: usize, encoding: &str) -> Vec<u8> {
    let topics = topics(messages);
    let mut file = MAGIC.to_vec();
    file.extend(record(1, &[text("ros2"), text("a test")].concat()));
    let mut known = 0;
    for some in messages.chunks(in_a_chunk) {
        let mut records = Vec::new();
        for one in some {
            let number = topics.iter().position(|topic| *topic == (one.topic, one.kind)).expect("listed");
            while known <= number {
                records.extend(defined(known, topics[known].0, topics[known].1, encoding));
                known += 1;
            }
            records.extend(message(number, one));
        }
        let packed = packing.pack(&records);
        let crc = crc32fast::hash(&records).to_le_bytes();
        let times = [0u8; 16];
        let size = (records.len() as u64).to_le_bytes();
        let length = (packed.len() as u64).to_le_bytes();
        file.extend(record(6, &[&times[..], &size, &crc, &text(packing.name("")), &length, &packed].concat()));
        file.extend(record(7, &[0; 6])); // an index without entries
    }
    file.extend(record(15, &[0; 4]));
    let start = file.len() as u64;
    topics.iter().enumerate().for_each(|(number, (topic, kind))| file.extend(defined(number, topic, kind, encoding)));
    file.extend(record(2, &[&start.to_le_bytes()[..], &[0; 12]].concat()));
    file.extend(MAGIC);
    file
}
