//! One module per word of the command line, named as it is typed.

pub mod calibrate;
pub mod check;
pub mod compare;
pub mod completions;
pub mod convert;
pub mod estimate;
pub mod features;
pub mod gate;
pub mod guide;
pub mod list;
pub mod ray;
pub mod replay;
pub mod report;
pub mod room;
pub mod scene;
pub mod schema;
pub mod score;
pub mod sensor;
pub mod slam;
pub mod slam_worlds;
pub mod speed;
pub mod sweep;
pub mod tune;
