//! Reads bags of ROS 1 and ROS 2 without ROS: what robots recorded, message after message, in bounded memory.
//!
//! [`Bag::open`] takes a `.bag` (ROS 1, format 2.0), an MCAP file, a `.db3` or a folder of rosbag2, and tells them by their
//! content. [`Bag::records`] gives [`Record`]s in the order of the file: topic, type, time and bytes, which the types of [`messages`]
//! decode. What is damaged is an item of its own, [`Damage`], with file and offset; reading goes on behind it.
//!
//! ```no_run
//! use bags::{Bag, messages::LaserScan};
//!
//! let bag = Bag::open("run.mcap".as_ref())?;
//! for item in bag.records(|topic| topic.kind == LaserScan::KIND) {
//!     match item {
//!         Ok(record) if record.topic.kind == LaserScan::KIND => {
//!             let scan = LaserScan::read(record.topic.encoding, &record.bytes);
//!             println!("{} {:?}", record.time_ns, scan.map(|scan| scan.ranges_m.len()));
//!         }
//!         Ok(_) => {}
//!         Err(damage) => println!("{damage}"),
//!     }
//! }
//! # Ok::<(), bags::BagError>(())
//! ```
//!
//! No length in a file is trusted: a buffer grows by what is really there, and never beyond [`MOST_BYTES`].

mod bag;
mod container;
mod damage;
mod error;
mod folder;
pub mod messages;
mod part;
mod record;
mod unpack;

pub use bag::{Bag, Records};
pub use damage::{Damage, Loss};
pub use error::BagError;
pub use record::{Bytes, Encoding, Record, Topic};

/// A chunk or a message that claims to be longer is damaged, bytes: writers close chunks after some MB, and no message of a robot is so long.
pub const MOST_BYTES: u64 = 1 << 29;
