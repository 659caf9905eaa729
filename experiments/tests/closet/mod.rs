//! A scene for tests.

/// A small closed room with a box, seen by few columns: done in a moment.
pub(crate) const SCENE: &str = r#"
name = "closet"
[bounds]
min = [0.0, 0.0]
max = [3.0, 2.0]
[grid]
cell = 0.1
[[wall]]
from = [0.05, 0.05]
to = [2.95, 0.05]
thickness = 0.1
[[wall]]
from = [2.95, 0.05]
to = [2.95, 1.95]
thickness = 0.1
[[wall]]
from = [2.95, 1.95]
to = [0.05, 1.95]
thickness = 0.1
[[wall]]
from = [0.05, 1.95]
to = [0.05, 0.05]
thickness = 0.1
[[box]]
center = [2.0, 0.5]
size = [0.4, 0.4]
[waypoints]
A = [0.5, 1.0]
B = [2.4, 1.2]
[route]
stops = ["A", "B", "A"]
[[region]]
name = "X"
center = [1.2, 1.0]
radius = 0.3
[camera]
columns = 24
field_of_view_deg = 70.0
[robot]
radius = 0.15
speed = 0.5
turn_rate_deg = 60.0
scan_interval = 0.5
"#;
