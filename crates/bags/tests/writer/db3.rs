//! SQLite as rosbag2 has it, with pages of 512 bytes, so that trees have levels and rows overflow.

use super::{Message, topics};

const PAGE: usize = 512;

enum Field<'a> {
    Null,
    Integer(i64),
    Text(&'a str),
    Blob(&'a [u8]),
}

fn varint(value: u64) -> Vec<u8> {
    let mut bytes = vec![(value & 0x7f) as u8];
    let mut rest = value >> 7;
    while rest > 0 {
        bytes.push((rest & 0x7f) as u8 | 0x80);
        rest >>= 7;
    }
    bytes.reverse();
    bytes
}

fn payload(fields: &[Field]) -> Vec<u8> {
    let (mut kinds, mut content) = (Vec::new(), Vec::new());
    for field in fields {
        let (kind, bytes) = match field {
            Field::Null => (0, Vec::new()),
            Field::Integer(value) => (6, value.to_be_bytes().to_vec()),
            Field::Text(text) => (13 + 2 * text.len() as u64, text.as_bytes().to_vec()),
            Field::Blob(bytes) => (12 + 2 * bytes.len() as u64, bytes.to_vec()),
        };
        kinds.extend(varint(kind));
        content.extend(bytes);
    }
    assert!(kinds.len() < 127, "the head's own length takes a byte");
    [vec![kinds.len() as u8 + 1], kinds, content].concat()
}

/// Pages as they are made; the first is that of the schema.
struct Pages(Vec<Vec<u8>>);

impl Pages {
    fn add(&mut self, page: Vec<u8>) -> u32 {
        self.0.push(page);
        self.0.len() as u32
    }

    /// A row of a leaf; what does not fit goes to other pages.
    fn cell(&mut self, row: u64, payload: &[u8]) -> Vec<u8> {
        let (most, least) = (PAGE - 35, (PAGE - 12) * 32 / 255 - 23);
        let local = match payload.len() {
            length if length <= most => length,
            length => Some(least + (length - least) % (PAGE - 4)).filter(|local| *local <= most).unwrap_or(least),
        };
        let mut next = 0;
        let rest: Vec<&[u8]> = payload[local..].chunks(PAGE - 4).collect();
        for part in rest.iter().rev() {
            let mut page = u32::to_be_bytes(next).to_vec();
            page.extend_from_slice(part);
            page.resize(PAGE, 0);
            next = self.add(page);
        }
        let mut cell = [varint(payload.len() as u64), varint(row), payload[..local].to_vec()].concat();
        if next > 0 {
            cell.extend(next.to_be_bytes());
        }
        cell
    }

    /// A tree of rows, which are numbered from 1; gives its root.
    fn tree(&mut self, rows: &[Vec<u8>]) -> u32 {
        let mut leaves: Vec<(u32, u64)> = Vec::new();
        let (mut cells, mut last) = (Vec::new(), 0);
        for (row, payload) in (1..).zip(rows) {
            let cell = self.cell(row, payload);
            let used: usize = cells.iter().map(|cell: &Vec<u8>| cell.len() + 2).sum();
            if 8 + used + cell.len() + 2 > PAGE {
                let page = self.add(page(0, 0x0d, &cells, None));
                leaves.push((page, last));
                cells.clear();
            }
            cells.push(cell);
            last = row;
        }
        let right = self.add(page(0, 0x0d, &cells, None));
        if leaves.is_empty() {
            return right;
        }
        let cells: Vec<Vec<u8>> =
            leaves.iter().map(|(page, row)| [page.to_be_bytes().to_vec(), varint(*row)].concat()).collect();
        self.add(page(0, 0x05, &cells, Some(right)))
    }
}

fn page(start: usize, kind: u8, cells: &[Vec<u8>], right: Option<u32>) -> Vec<u8> {
    let mut page = vec![0; PAGE];
    let mut end = PAGE;
    let mut places = Vec::new();
    for cell in cells {
        end -= cell.len();
        page[end..end + cell.len()].copy_from_slice(cell);
        places.extend((end as u16).to_be_bytes());
    }
    page[start] = kind;
    page[start + 3..start + 5].copy_from_slice(&(cells.len() as u16).to_be_bytes());
    page[start + 5..start + 7].copy_from_slice(&(end as u16).to_be_bytes());
    let mut at = start + 8;
    if let Some(right) = right {
        page[at..at + 4].copy_from_slice(&right.to_be_bytes());
        at += 4;
    }
    assert!(at + places.len() <= end, "the cells fit");
    page[at..at + places.len()].copy_from_slice(&places);
    page
}

/// A database of a bag.
pub(crate) fn file(messages: &[Message]) -> Vec<u8> {
    let topics = topics(messages);
    let mut pages = Pages(vec![Vec::new()]);
    let rows: Vec<Vec<u8>> = topics
        .iter()
        .map(|(topic, kind)| payload(&[Field::Null, Field::Text(topic), Field::Text(kind), Field::Text("cdr")]))
        .collect();
    let of_topics = pages.tree(&rows);
    let rows: Vec<Vec<u8>> = messages
        .iter()
        .map(|message| {
            let topic = topics.iter().position(|topic| *topic == (message.topic, message.kind)).expect("listed");
            let (topic, time) = (Field::Integer(topic as i64 + 1), Field::Integer(message.time_ns as i64));
            payload(&[Field::Null, topic, time, Field::Blob(&message.bytes)])
        })
        .collect();
    let of_messages = pages.tree(&rows);
    let table = |row: u64, name: &str, root: u32, sql: &str| {
        let root = Field::Integer(i64::from(root));
        let payload = payload(&[Field::Text("table"), Field::Text(name), Field::Text(name), root, Field::Text(sql)]);
        [varint(payload.len() as u64), varint(row), payload].concat()
    };
    let cells = [
        table(
            1,
            "topics",
            of_topics,
            "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT,type TEXT,serialization_format TEXT)",
        ),
        table(
            2,
            "messages",
            of_messages,
            "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,timestamp INTEGER,data BLOB)",
        ),
    ];
    let mut first = page(100, 0x0d, &cells, None);
    first[..16].copy_from_slice(b"SQLite format 3\0");
    first[16..18].copy_from_slice(&(PAGE as u16).to_be_bytes());
    pages.0[0] = first;
    pages.0.concat()
}
