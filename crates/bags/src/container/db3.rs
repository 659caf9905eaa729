//! Bags of rosbag2 in SQLite: the tables `topics` and `messages`, row after row.
//!
//! Read by code of ours, since walking through tables is little of SQLite, its file format is frozen
//! (<https://www.sqlite.org/fileformat2.html>), and the library is a minute of C in the first build.

mod pages;
mod row;
mod walk;

use std::collections::HashMap;
use std::sync::Arc;

use self::row::{Value, columns};
use self::walk::{Cell, Walk};
use super::{Container, Wanted};
use crate::damage::{Damage, Loss};
use crate::record::{Bytes, Encoding, Record, Topic, plain};

pub(crate) use self::pages::{MAGIC, Pages, write_ahead};

/// Tables that are named where those of a bag are missing.
const SOME: usize = 6;

/// A database, whose messages are read in the order of their rows.
pub(crate) struct Db3 {
    file: Arc<str>,
    pages: Pages,
    topics: HashMap<i64, Arc<Topic>>,
    walk: Walk,
    columns: Columns,
    wanted: Wanted,
    /// What was found damaged while the topics were read.
    waiting: Vec<Damage>,
}

/// Where the columns of `messages` stand.
struct Columns {
    topic: usize,
    time: usize,
    data: usize,
}

impl Db3 {
    /// Opens a database: reads what tables it has, and its topics.
    ///
    /// # Errors
    /// One without the tables of a bag.
    pub(crate) fn open(file: &Arc<str>, pages: Pages, wanted: Wanted) -> Result<Self, String> {
        let mut db = Self {
            file: Arc::clone(file),
            pages,
            topics: HashMap::new(),
            walk: Walk::of(1),
            columns: Columns { topic: 0, time: 0, data: 0 },
            wanted,
            waiting: Vec::new(),
        };
        let mut tables: HashMap<String, (u32, Vec<String>)> = HashMap::new();
        for cell in db.all(Walk::of(1)) {
            let values = db.pages.payload(&cell).ok().and_then(|payload| row::values(&payload));
            if let Some([Value::Text(kind), _, Value::Text(name), Value::Integer(root), Value::Text(sql), ..]) =
                values.as_deref()
                && kind == "table"
                && let Ok(root) = u32::try_from(*root)
            {
                tables.insert(name.clone(), (root, columns(sql)));
            }
        }
        let missing = || {
            let mut names: Vec<String> = tables.keys().map(|name| plain(name)).collect();
            names.sort_unstable();
            names.truncate(SOME);
            let has = if names.is_empty() { "no table that can be read".to_owned() } else { names.join(", ") };
            format!(
                "is an SQLite database without the tables of a bag, topics and messages (it has {has}); give a bag of rosbag2"
            )
        };
        let place = |table: &str, column: &str| {
            tables.get(table).and_then(|(_, names)| names.iter().position(|name| name == column)).ok_or_else(missing)
        };
        db.columns = Columns {
            topic: place("messages", "topic_id")?,
            time: place("messages", "timestamp")?,
            data: place("messages", "data")?,
        };
        let [name, kind, format] =
            [place("topics", "name")?, place("topics", "type")?, place("topics", "serialization_format")?];
        let (topics, messages) = (tables["topics"].0, tables["messages"].0);
        for cell in db.all(Walk::of(topics)) {
            let values = db.pages.payload(&cell).ok().and_then(|payload| row::values(&payload)).unwrap_or_default();
            let text = |at: usize| match values.get(at) {
                Some(Value::Text(text)) => text.as_str(),
                _ => "",
            };
            let encoding = if text(format) == "cdr" { Encoding::Cdr } else { Encoding::Other };
            db.topics.insert(cell.row, Arc::new(Topic::new(text(name), text(kind), encoding)));
        }
        db.walk = Walk::of(messages);
        Ok(db)
    }

    /// All rows of a small table; what is damaged waits to be said.
    fn all(&mut self, mut walk: Walk) -> Vec<Cell> {
        let mut cells = Vec::new();
        while let Some(item) = walk.next(&mut self.pages) {
            match item {
                Ok(cell) => cells.push(cell),
                Err((offset, reason)) => self.waiting.push(self.damage(offset, reason, Loss::Chunk)),
            }
        }
        cells
    }

    fn damage(&self, offset: u64, reason: String, loss: Loss) -> Damage {
        Damage { file: Arc::clone(&self.file), offset, reason, loss }
    }

    fn record(&mut self, cell: &Cell) -> Result<Record, String> {
        let head = row::values(&cell.local).ok_or("the row of a message is damaged")?;
        let integer = |at: usize| match head.get(at) {
            Some(Value::Integer(value)) => Ok(*value),
            _ => Err(format!("the row of message {} has no topic or no time", cell.row)),
        };
        let (number, time) = (integer(self.columns.topic)?, integer(self.columns.time)?);
        let topic = self.topics.get(&number);
        let topic = topic.ok_or_else(|| {
            format!("message {} is of topic {number}, which the table topics does not have", cell.row)
        })?;
        let mut record =
            Record { topic: Arc::clone(topic), time_ns: u64::try_from(time).unwrap_or(0), bytes: Bytes::default() };
        if (self.wanted)(topic) {
            let payload = self.pages.payload(cell)?;
            match row::values(&payload).map(|mut values| values.swap_remove(self.columns.data)) {
                Some(Value::Blob(data)) => record.bytes = data.into(),
                _ => return Err(format!("the row of message {} has no data", cell.row)),
            }
        }
        Ok(record)
    }
}

impl Container for Db3 {
    fn next(&mut self) -> Option<Result<Record, Damage>> {
        if let Some(damage) = self.waiting.pop() {
            return Some(Err(damage));
        }
        let item = self.walk.next(&mut self.pages)?;
        Some(match item {
            Ok(cell) => self.record(&cell).map_err(|reason| self.damage(cell.offset, reason, Loss::Message)),
            Err((offset, reason)) => Err(self.damage(offset, reason, Loss::Chunk)),
        })
    }
}
