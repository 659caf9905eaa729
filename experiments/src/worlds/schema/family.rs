//! The schema of files of families.

use scene::reader::limits::{CLEARANCE, COVERED, OBSTACLE, OPENING, PACE, PEOPLE, SHARE, SIDE, SPREAD, THICKNESS};
use serde_json::{Value, json};
use strict::Limit;

use super::scene::shared;
use super::{file, line, name, number, pair, table, word};

/// The schema of files of families.
pub fn family() -> Value {
    let range = |about: &str, limit: &Limit| pair(&format!("{about}: {}", limit.bound), limit.min, limit.max);
    let keys = [
        ("kind", word("The kind of place", ["clutter", "corridor", "hall", "two-rooms"])),
        ("width", range("Width of the place", &SIDE)),
        ("height", range("Height of the place", &SIDE)),
        ("passage", range("Width of a corridor", &OPENING)),
        ("door", range("Width of doors", &OPENING)),
        ("obstacle_size", number("Mean size of obstacles", &OBSTACLE)),
        ("obstacle_spread", number("Spread of their size", &SPREAD)),
        ("covered", number("Share of the floor that they cover", &COVERED)),
        ("discs", number("Share of them that are discs", &SHARE)),
        ("along_walls", number("Share of them that stand along walls", &SHARE)),
        ("clearance", number("What the route keeps off them", &CLEARANCE)),
        ("wall_thickness", number("Thickness of walls", &THICKNESS)),
        ("people_per_100_m2", range("People per 100 m²", &PEOPLE)),
        ("people_speed_m_s", range("Speed of people", &PACE)),
    ];
    let mut generate =
        table("What layouts are generated from", &keys, &["kind", "width", "height", "obstacle_size", "covered"]);
    let of = |kinds: &[&str]| json!({ "properties": { "kind": { "enum": kinds } } });
    generate["allOf"] = json!([
        { "if": of(&["corridor"]), "then": { "required": ["passage", "door"] }, "else": { "not": { "required": ["passage"] } } },
        { "if": of(&["two-rooms"]), "then": { "required": ["door"] } },
        { "if": of(&["clutter", "hall"]), "then": { "not": { "required": ["door"] } } },
    ]);
    let own = [
        ("name", name("Short name: layouts are called NAME-LAYOUT", 11)),
        ("description", line("One line about the family")),
        ("generate", generate),
    ];
    let title = "A family of scenes, of which every layout number is another (lengths in m)";
    file(title, &[&own[..], &shared()].concat(), &["name", "generate"])
}
