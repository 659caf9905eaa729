//! TOML files read strictly: every refusal has its file, line, column, bound and remedy.
//!
//! ```
//! use strict::{Limit, Table, open};
//! const WIDTH: Limit = Limit { min: 0.1, max: 10.0, bound: "a width in m, 0.1 to 10", remedy: "give a width such as 0.9" };
//! let text = "[door]\nwidth = 90\n";
//! let (source, document) = open(text, "house.toml")?;
//! let root = Table::new(&source, "the house", 0, document.get_ref());
//! root.only(&["door"])?;
//! let door = root.section("door")?.ok_or_else(|| root.missing("[door]", "[door] with width"))?;
//! let refusal = door.number("width", &WIDTH).expect_err("centimetres");
//! assert_eq!(
//!     refusal.to_string(),
//!     "house.toml:2:9: [door]: width = 90: must be a width in m, 0.1 to 10; give a width such as 0.9"
//! );
//! # Ok::<(), strict::Error>(())
//! ```
//!
//! - [`read`] takes a text of bounded length, [`open`] parses it; what other commands read is named with them.
//! - [`opened`] opens any file; of one that is not there the message names one beside it that is called nearly so.
//! - [`bring`] names files that a program has within it, for folders in which they do not lie.
//! - [`Table`] gives values that are checked where they are taken; [`Table::only`] refuses keys that nothing reads.
//! - [`Findings`] keeps all that is wrong with a file, not only the first of it.
//! - [`nearest`] and [`hint`] find the known name that is most like a wrong one.
//! - [`excerpt`](excerpt()) is what messages quote of a file: one line of bounded length.

mod brought;
mod excerpt;
mod file;
mod findings;
mod foreign;
mod likeness;
mod limit;
mod place;
mod problem;
mod source;
mod table;
mod value;

pub use brought::{Brought, Opened, bring, brought, is_file};
pub use excerpt::{LONGEST_REPORT, LONGEST_VALUE, excerpt};
pub use file::{open, opened, read};
pub use findings::{Finding, Findings, first};
pub use likeness::{hint, nearest};
pub use limit::Limit;
pub use place::Place;
pub use problem::{Error, ErrorKind, Problem};
pub use source::Source;
pub use table::Table;
pub use value::{Value, number};
