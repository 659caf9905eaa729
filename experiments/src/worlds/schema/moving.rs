//! The schema of what moves in a scene.

use ::scene::reader::limits::{
    ANGLE, FOLLOWING, LEAF, LEAF_THICKNESS, MOMENT, MOVER_RADIUS, MOVER_SPEED, PAUSE, PERIOD, PROBABILITY, SEED,
    STRAYING, SWING,
};
use serde_json::{Value, json};

use super::scene::{length, point, texture};
use super::{between, list, number, pair, table, text, whole, word};

/// Most tables of one kind.
const MOST: u64 = 200;

/// People, doors and chairs, and the seed of their chances.
pub(super) fn moving() -> [(&'static str, Value); 4] {
    let all = |about: &str, keys: &[(&str, Value)], required: &[&str]| {
        let mut tables = list(about, table(about, keys, required), 0);
        tables["maxItems"] = json!(MOST);
        tables
    };
    [
        ("mover", all("Somebody who walks", &mover(), &["route"])),
        ("door", all("A leaf that turns about its hinge", &door(), &["hinge", "length", "closed_deg", "open_deg"])),
        ("chair", all("Something that stands elsewhere later", &chair(), &["center", "moves"])),
        ("motion_seed", whole("Fixes every chance of what moves", &SEED)),
    ]
}

/// A list of at most so many.
fn few(mut list: Value, most: u64) -> Value {
    list["maxItems"] = json!(most);
    list
}

fn mover() -> [(&'static str, Value); 11] {
    let place = json!({ "anyOf": [point("A point, m"), text("Name of a waypoint")] });
    let pause = number("How long it stands", &PAUSE);
    let pauses = json!({ "anyOf": [pause, list("How long it stands at each point", pause.clone(), 1)] });
    [
        ("radius", number("Radius of a disc", &MOVER_RADIUS)),
        ("points", few(list("Corners of a polygon about its own place, in order", point("A corner, m"), 3), 1000)),
        ("route", few(list("Points that it goes to; the first is where it starts", place, 1), 1000)),
        ("speed_m_s", number("Speed", &MOVER_SPEED)),
        ("pause_s", pauses),
        ("start_s", number("When it sets out", &PAUSE)),
        ("repeat", word("What comes after the last point", ["loop", "once", "back_and_forth"])),
        ("behaviour", word("Where it goes", ["route", "follower", "loiterer"])),
        ("distance_m", number("Follower: how far behind the robot", &FOLLOWING)),
        ("within_m", number("Loiterer: how far it strays", &STRAYING)),
        texture(),
    ]
}

fn door() -> [(&'static str, Value); 11] {
    let open = few(list("From when until when, s", between("A time, s", 0.0, 1e6), 2), 2);
    [
        ("hinge", point("What it turns about, m")),
        ("length", number("From the hinge to the free edge", &LEAF)),
        ("thickness", number("Thickness of the leaf", &LEAF_THICKNESS)),
        ("closed_deg", number("Direction of the leaf while it is shut", &ANGLE)),
        ("open_deg", number("Direction of the leaf while it is open", &ANGLE)),
        ("swing_s", number("From shut to open", &SWING)),
        ("open_s", list("When it is open", open, 0)),
        ("open_during", list("Stages during which it is open", text("Name of a stage"), 0)),
        ("period_s", number("Once in every period it may open", &PERIOD)),
        ("open_chance", number("How likely it opens in a period", &PROBABILITY)),
        texture(),
    ]
}

fn chair() -> [(&'static str, Value); 6] {
    let to = [
        ("at_s", number("When", &MOMENT)),
        ("after_stage", text("Name of the stage after which it moves")),
        ("to_m", point("Where its middle is then, m")),
        ("turn_deg", number("Turned by so many degrees", &ANGLE)),
    ];
    [
        ("center", point("Centre, m")),
        ("size", pair("Width and height, m", 1e-6, 1e6)),
        ("radius", length("Radius of a round one, m")),
        ("rotation_deg", number("Turned by so many degrees", &ANGLE)),
        ("moves", few(list("Where it stands later", table("A move", &to, &["to_m"]), 1), 1000)),
        texture(),
    ]
}
