//! Inputs that broke a promise once: found by `crates/fuzz`, made small by hand.

use std::path::Path;

use scene::{Family, FloorPlan, Scene, Variation};

/// The smallest scene there is.
const SMALL: &str = r#"name = "small"
[bounds]
min = [0.0, 0.0]
max = [4.0, 3.0]
[waypoints]
A = [1.0, 1.0]
B = [3.0, 1.0]
[route]
stops = ["A", "B"]
"#;

fn refusal(text: &str) -> String {
    let message = Scene::parse(text, Path::new("s.toml"), None).expect_err(text).to_string();
    assert!(!message.contains(char::is_control) && message.chars().count() < 1000, "{message}");
    message
}

#[test]
fn names_of_files_are_one_line() {
    for (table, what) in [("map", "a map's YAML file"), ("plan", "a floor plan's JSON file")] {
        for name in ["m\\nap".to_owned(), "m".repeat(300)] {
            let message = refusal(&format!("{SMALL}[{table}]\nfile = \"{name}\"\n"));
            let refused = format!(": must be the name of {what}; it is relative to the scene file");
            assert!(message.starts_with(&format!("s.toml:11:8: [{table}]: file = \"m")) && message.ends_with(&refused));
        }
    }
}

#[test]
fn unknown_keys_and_waypoints_are_quoted_on_one_line_and_in_part() {
    let message = refusal(&format!("{SMALL}[camera]\n\"a\\nb\" = 1\n"));
    assert!(message.contains("unknown key `a\\nb`; known keys: columns"), "{message}");
    let long = "x".repeat(5000);
    let message = refusal(&format!("{SMALL}[camera]\n{long} = 1\n"));
    assert!(message.contains(&format!("unknown key `{}...`; known", "x".repeat(60))), "{message}");
    let message = refusal(&SMALL.replace("[\"A\"", &format!("[\"{long}\"")));
    assert!(message.contains(&format!("no waypoint `{}...`; known waypoints: A, B", "x".repeat(60))), "{message}");
    let message = refusal(&SMALL.replace("A =", &format!("\"\\u0007{long}\" =")));
    assert!(
        message.contains("name = \"\\u{7}xxx") && message.contains("...\": must be 1 to 32 characters"),
        "{message}"
    );
}

#[test]
fn of_many_waypoints_a_message_lists_the_first() {
    let many: String = (0..1000).map(|k| format!("w{k} = [{}, 1.0]\n", 0.001 * f64::from(k))).collect();
    let message = refusal(&SMALL.replace("A = [1.0, 1.0]\n", &many));
    let first: Vec<String> = (0..20).map(|k| format!("w{k}")).collect();
    assert!(message.ends_with(&format!("known waypoints: {} and 981 more", first.join(", "))), "{message}");
}

#[test]
fn likeness_to_a_name_of_megabytes_is_not_measured() {
    // It takes 8 bytes for every pair of letters: 2 GB beside a key of 17 letters.
    let long = "x".repeat(12 << 20);
    refusal(&SMALL.replace("[\"A\"", &format!("[\"{long}\"")));
    refusal(&format!("{SMALL}[camera]\n{long} = 1\n"));
}

#[test]
fn a_text_among_the_corners_is_quoted_in_part() {
    let text = format!("{{\"verts\": [[\"{}\", 1]]}}", "\u{7f}".repeat(900));
    let message = FloorPlan::parse(text.as_bytes(), Path::new("p.json")).expect_err("no plan").to_string();
    assert!(message.starts_with("p.json:1:") && message.chars().count() < 400, "{message}");
}

#[test]
fn the_last_room_of_a_corridor_ends_where_the_wall_begins() {
    // Rooms were added without end where the place of the outer wall was rounded down.
    let text = corridors("wall_thickness = 0.4\npassage = [1.8, 2.2]");
    let family = Family::parse(&text, Path::new("f.toml")).expect("a family");
    for layout in 1..=20 {
        let text = family.generate(layout, &Variation::default()).expect("a layout");
        Scene::parse(&text, Path::new("s.toml"), None).expect("a scene");
    }
}

#[test]
fn openings_fit_in_their_place() {
    let error =
        Family::parse(&corridors("passage = [1.8, 6.2]"), Path::new("f.toml")).expect_err("wider than the place");
    assert!(error.to_string().contains("less than the least height of the place, 4 m"), "{error}");
    let wide = corridors("").replace("corridor", "two-rooms").replace("[0.8, 1.1]", "[0.8, 3.9]");
    let family = Family::parse(&wide, Path::new("f.toml")).expect("some doors of this family fit");
    for layout in 1..=50 {
        let text = family.generate(layout, &Variation::default()).expect("a layout");
        Scene::parse(&text, Path::new("s.toml"), None).expect("a scene whose walls lie within its bounds");
    }
}

/// A family of corridors with further keys.
fn corridors(keys: &str) -> String {
    format!(
        r#"name = "corridor"
[generate]
kind = "corridor"
width = [11.0, 12.5]
height = [4.0, 4.6]
obstacle_size = 0.3
covered = 0.05
door = [0.8, 1.1]
{keys}
[camera]
columns = 20
"#
    )
}

#[test]
fn the_seed_with_everything_that_moves_is_a_scene_that_can_be_driven() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/scene/moving.toml");
    let scene = Scene::load(&path, None).unwrap_or_else(|error| panic!("{error}"));
    let drive = scene::drive(&scene).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(drive.motion.len(), 8);
}
