//! A family for tests.

/// A family of small, almost empty rooms.
pub(crate) const FAMILY: &str = r#"
name = "attic"
description = "Rooms of 3 m with a box or two"
[generate]
kind = "clutter"
width = [3.0, 3.0]
height = [3.0, 3.2]
obstacle_size = 0.3
covered = 0.02
[grid]
cell = 0.1
[camera]
columns = 16
[robot]
radius = 0.15
scan_interval = 0.8
"#;
