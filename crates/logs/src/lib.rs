//! Reads what robots recorded, as a stream of [`sensor::Scan`]s.
//!
//! [`Log::open`] takes a CARMEN log ([`carmen`]) or a table of scans ([`table`]), plain, gzip or bzip2, and finds out which by
//! the content. Iterating gives scan after scan in bounded memory. A damaged line is noted in the [`Report`], counted and
//! skipped; too many of them refuse the log. What can make results doubtful is in [`Report::findings`].
//!
//! ```
//! use logs::{Log, Options};
//!
//! let text = "FLASER 3 2.0 81.91 1.5  1.0 2.0 0.5  1.0 2.0 0.5  10.25 robot 0.25\n";
//! let mut log = Log::read(text.as_bytes(), "a.log", &Options::default())?;
//! let scan = log.next().expect("a scan")?;
//! assert_eq!(scan.readings, [Some(2.0), Some(f64::INFINITY), Some(1.5)]); // the second beam found no echo
//! assert_eq!((log.report().scans, log.report().no_returns), (1, 1));
//! # Ok::<(), logs::LogError>(())
//! ```
//!
//! What a reading means, whatever the log:
//!
//! | reading | laser (m along the ray) | stereo (px) |
//! |---|---|---|
//! | `Some(r)`, finite | an echo at range r | a disparity |
//! | `Some(INFINITY)` | no echo up to the maximum range ([`Sensor::Laser`]): free all the way, not a wall | does not occur |
//! | `None` | nothing usable: NaN, zero, negative, below the minimum range, an empty field | no match: NaN, zero, negative, infinite, above the largest disparity, an empty field |

pub mod bag;
mod bounds;
pub mod carmen;
mod choice;
mod error;
mod fan;
mod fields;
mod finding;
mod frames;
mod lines;
mod log;
mod motion;
mod options;
mod ranges;
mod record;
mod report;
mod source;
mod strays;
pub mod table;
pub mod trajectory;

pub use error::LogError;
pub use fan::{Fan, FanOptions, FanSource};
pub use finding::Finding;
pub use lines::LONGEST_LINE;
pub use log::Log;
pub use motion::{Motion, Step};
pub use options::Options;
pub use record::{Event, Sensor};
pub use report::{FanReport, Gap, NoMatchCodes, Problem, Report, SensorReport, StepBack, Stray, Unit};
pub use trajectory::{Body, Trajectory};
