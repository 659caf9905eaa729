//! The schema of scene files, and of the tables that families share with them.

use ::scene::reader::limits::{
    BIAS_M_PER_M, BIAS_TURN_PER_M, BIAS_TURN_PER_TURN, COLUMNS, FIELD_OF_VIEW, FOCAL_BASELINE, INTERVAL, JITTER,
    JITTER_ANGLE, PATIENCE, PROBABILITY, RADIUS, REACH, SEARCH, SIGMA, SLIP, SLIP_ANGLE, SLIPS, SPEED, STEP,
    TURN_PER_TURN, TURN_PER_WAY, TURN_RATE, WAIT, WAY_PER_TURN, WAY_PER_WAY,
};
use serde_json::{Value, json};

use super::moving::moving;
use super::sensors::{seen_by, sensor};
use super::{between, file, flag, line, list, name, number, pair, table, text, whole, word};

/// Coordinates and lengths stay within this, m.
const METRES: f64 = 1e6;

/// The least length, m.
const LEAST: f64 = 1e-6;

/// The schema of scene files.
pub fn scene() -> Value {
    let mut schema = file(
        "A scene: walls and things, a route, a camera (lengths in m, angles in degrees counter-clockwise from x)",
        &[&ground()[..], &obstacles(), &drive(), &moving(), &shared()].concat(),
        &["name", "waypoints", "route"],
    );
    // A map or a plan has bounds of its own.
    schema["anyOf"] = ["bounds", "map", "plan"].map(|key| json!({ "required": [key] })).into();
    schema["not"] = json!({ "required": ["map", "plan"] });
    schema
}

pub(super) fn point(about: &str) -> Value {
    pair(about, -METRES, METRES)
}

pub(super) fn length(about: &str) -> Value {
    between(about, LEAST, METRES)
}

pub(super) fn texture() -> (&'static str, Value) {
    ("texture", between("Share of the surface with edges to match: 1 all of it, 0 none", 0.0, 1.0))
}

/// What a scene is called and what it stands on.
fn ground() -> [(&'static str, Value); 5] {
    let bounds = [("min", point("Lower-left corner, m")), ("max", point("Upper-right corner, m"))];
    let map = [
        ("file", text("YAML file of a ROS map, relative to this file")),
        ("origin", point("Lower-left corner of the map in the scene, in place of its own, m")),
        texture(),
    ];
    let plan = [
        ("file", text("JSON file of a floor plan, relative to this file")),
        ("thickness", between("Thickness of the walls along its outline, m", 1e-3, 10.0)),
        texture(),
    ];
    [
        ("name", name("Short name: part of file names", 32)),
        ("description", line("One line about the scene")),
        ("bounds", table("What the map covers", &bounds, &["min", "max"])),
        ("map", table("A map that a robot built", &map, &["file"])),
        ("plan", table("A floor plan; what is outside is not scored", &plan, &["file"])),
    ]
}

fn obstacles() -> [(&'static str, Value); 4] {
    let wall = [
        ("from", point("One end, m")),
        ("to", point("The other end, m")),
        ("thickness", length("Thickness, m")),
        texture(),
        seen_by(),
    ];
    let rectangle = [
        ("center", point("Centre, m")),
        ("size", pair("Width and height, m", LEAST, METRES)),
        ("rotation_deg", between("Turned by so many degrees", -360.0, 360.0)),
        texture(),
        seen_by(),
    ];
    let disc = [("center", point("Centre, m")), ("radius", length("Radius, m")), texture(), seen_by()];
    let mut corners = list("Corners in order, the first only once", point("A corner, m"), 3);
    corners["maxItems"] = json!(1000);
    let polygon = [("points", corners), texture(), seen_by()];
    let all = |about: &str, keys: &[(&str, Value)], required: &[&str]| list(about, table(about, keys, required), 0);
    [
        ("wall", all("A straight wall", &wall, &["from", "to", "thickness"])),
        ("box", all("A box, as seen from above", &rectangle, &["center", "size"])),
        ("disc", all("A disc", &disc, &["center", "radius"])),
        ("polygon", all("An outline that does not touch itself", &polygon, &["points"])),
    ]
}

/// The way of the robot, and where maps are judged.
fn drive() -> [(&'static str, Value); 4] {
    let mut waypoints =
        json!({ "description": "Named points", "type": "object", "additionalProperties": point("A point, m") });
    waypoints["propertyNames"] = json!({ "minLength": 1, "maxLength": 32 });
    let stops = |about| list(about, text("Name of a waypoint"), 1);
    let at = [("at", text("Name of a waypoint")), ("wait_s", number("How long the robot stands there", &WAIT))];
    let stop = json!({ "anyOf": [text("Name of a waypoint"), table("A stop", &at, &["at"])] });
    let route = [("stops", list("Waypoints in the order of the drive", stop, 2))];
    let stage = [
        ("name", name("Name of the stage", 32)),
        ("after", stops("The first stops of the route, up to where the stage ends; in the last stage all")),
        ("label", line("What tables call it")),
    ];
    let area = [
        ("name", name("Name of the region", 32)),
        ("center", point("Centre of a disc, m")),
        ("radius", length("Radius of a disc, m")),
        ("min", point("Lower-left corner of a rectangle, m")),
        ("max", point("Upper-right corner of a rectangle, m")),
        ("claims", flag("Whether the paper's claims are checked here")),
    ];
    let mut region = table("A part of the world that maps are judged in", &area, &["name"]);
    region["oneOf"] = json!([
        { "required": ["center", "radius"], "not": { "anyOf": [{ "required": ["min"] }, { "required": ["max"] }] } },
        { "required": ["min", "max"], "not": { "anyOf": [{ "required": ["center"] }, { "required": ["radius"] }] } },
    ]);
    [
        ("waypoints", waypoints),
        ("route", table("The drive", &route, &["stops"])),
        ("stage", list("Maps are judged after each stage", table("A stage", &stage, &["name", "after"]), 0)),
        ("region", list("Parts of the world that maps are judged in", region, 0)),
    ]
}

/// The tables that families have too.
pub(super) fn shared() -> [(&'static str, Value); 5] {
    let noise = [
        ("focal_baseline", number("Focal length times baseline", &FOCAL_BASELINE)),
        ("max_disparity", number("Largest disparity searched", &SEARCH)),
        ("correct_match", number("Share of correct matches", &PROBABILITY)),
        ("disparity_sigma", number("Standard deviation of a correct disparity", &SIGMA)),
        ("detection_rate", number("Share of the columns with an edge to match", &PROBABILITY)),
        ("quantisation", number("Step that disparities are rounded to", &STEP)),
        ("mismatches", word("How false matches come", ["independent", "clustered"])),
        ("persistence", number("Clustered: how likely a mismatch follows another", &PROBABILITY)),
        ("copies", number("Clustered: share of copies of a neighbour", &PROBABILITY)),
        ("near_misses", number("Clustered: share of near misses", &PROBABILITY)),
        ("copy_reach", whole("Clustered: reach of copies", &REACH)),
    ];
    let camera =
        [("columns", whole("Image columns", &COLUMNS)), ("field_of_view_deg", number("Field of view", &FIELD_OF_VIEW))];
    let robot = [
        ("radius", number("Radius", &RADIUS)),
        ("speed", number("Speed", &SPEED)),
        ("turn_rate_deg", number("Turning on the spot", &TURN_RATE)),
        ("scan_interval", number("Time between scans", &INTERVAL)),
        ("patience_s", number("How long it waits for what moves and is in its way", &PATIENCE)),
        ("jitter_m", number("Standard deviation of its recorded place while it stands", &JITTER)),
        ("jitter_deg", number("Standard deviation of its recorded heading while it stands", &JITTER_ANGLE)),
    ];
    let grid = [("cell", between("Side of a cell, m", 1e-4, 1e3))];
    [
        ("grid", table("The cells of the map", &grid, &[])),
        ("camera", table("The stereo camera, sensor 0", &[&camera[..], &noise].concat(), &[])),
        ("sensor", sensor(&noise)),
        ("robot", table("The robot", &robot, &[])),
        ("odometry", odometry()),
    ]
}

fn odometry() -> Value {
    let keys = [
        ("deg_per_deg", number("Standard deviation of a turn per turn", &TURN_PER_TURN)),
        ("deg_per_m", number("Standard deviation of both turns of a step per distance", &TURN_PER_WAY)),
        ("m_per_m", number("Standard deviation of the distance per distance", &WAY_PER_WAY)),
        ("m_per_deg", number("Standard deviation of the distance per turn", &WAY_PER_TURN)),
        ("bias_deg_per_deg", number("Share of a turn that is measured beyond it", &BIAS_TURN_PER_TURN)),
        ("bias_deg_per_m", number("Turn that is measured of a straight way", &BIAS_TURN_PER_M)),
        ("bias_m_per_m", number("Share of a distance that is measured beyond it", &BIAS_M_PER_M)),
        ("slips_per_m", number("Mean number of slips", &SLIPS)),
        ("slip_m", number("Mean of what a slip adds to the distance", &SLIP)),
        ("slip_deg", number("Standard deviation of what a slip adds to the turn", &SLIP_ANGLE)),
    ];
    let mut odometry = table("What the robot measures of its way, beside the true pose", &keys, &[]);
    odometry["dependentRequired"] = json!({ "slip_m": ["slips_per_m"], "slip_deg": ["slips_per_m"] });
    odometry
}
