//! A family for tests.

/// A small hall, seen by few columns: a world is done in a moment.
pub(crate) const FAMILY: &str = r#"
name = "nook"
[generate]
kind = "clutter"
width = [4.0, 4.5]
height = [3.5, 4.0]
obstacle_size = 0.4
covered = 0.04
[grid]
cell = 0.1
[camera]
columns = 24
field_of_view_deg = 80.0
[robot]
radius = 0.15
speed = 0.6
turn_rate_deg = 90.0
scan_interval = 0.5
"#;
