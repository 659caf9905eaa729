//! What is suspicious about a scene that is valid.

use std::fmt;
use std::path::PathBuf;

use grid::ros_map;
use strict::{Place, excerpt};

/// Something that is probably not as it was meant. Printed as one line: place, value, bound, what to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// About the map of the scene.
    Map(ros_map::Warning),
    /// A floor plan so large that its corners are probably no metres.
    Large {
        /// The plan.
        path: PathBuf,
        /// Area within its outline, m².
        area_m2: f64,
    },
    /// A map so far from the origin that its scene has an origin of its own.
    Far {
        /// Where the map's origin stands.
        place: Place,
        /// The map's origin, m.
        origin_m: [f64; 2],
    },
    /// Something that is to happen when the drive is over.
    Late {
        /// Where the time stands.
        place: Place,
        /// The part of the scene, such as `mover 2`.
        element: String,
        /// The key of the time.
        key: &'static str,
        /// The time, s.
        at_s: f64,
        /// How long the drive takes if nothing holds the robot up, s.
        drive_s: f64,
    },
    /// A drive on which many rays end on nothing.
    Open {
        /// The scene, or what it is made from.
        path: PathBuf,
        /// Share of the drive's rays that end on nothing.
        on_nothing: f64,
        /// Length of the route, m.
        length_m: f64,
        /// Length of the route with obstacles all round, m.
        inside_m: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |path: &PathBuf| excerpt(&path.display().to_string(), usize::MAX);
        match self {
            Self::Map(warning) => write!(f, "{warning}"),
            Self::Large { path, area_m2 } => write!(
                f,
                "{}: `verts`: the outline holds {area_m2:.0} m²: are the corners metres? divide them by the pixels per metre if not",
                shown(path)
            ),
            Self::Far { place, origin_m: [x, y] } => write!(
                f,
                "{place}: origin = [{x}, {y}]: more than 1000000 m away; the scene has the map's lower-left corner at [0, 0] instead",
            ),
            Self::Late { place, element, key, at_s, drive_s } => write!(
                f,
                "{place}: {element}: {key}: {at_s} s is after the end of the drive, which takes about {drive_s:.0} s: it never happens; give an earlier time, or have the robot wait"
            ),
            Self::Open { path, on_nothing, length_m, inside_m } => write!(
                f,
                "{}: {:.0} % of the rays end on nothing, and {inside_m:.1} m of the route's {length_m:.1} m have obstacles all round: does the robot drive outside the building? close gaps in its walls, or name a place inside with --start",
                shown(path),
                100.0 * on_nothing
            ),
        }
    }
}
