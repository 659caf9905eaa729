//! Scene files, families and floor plans.

use std::path::Path;

use scene::{Family, FloorPlan, Scene, Variation, World};

use crate::message;

/// Scenes find `map.yaml` and `plan.json` here.
const BESIDE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/beside/scene.toml");

/// The largest cells that a scene can have, m: those of a wide plan are then few.
const LARGE_M: f64 = 1000.0;

/// More cells of a plan take long to tell inside from outside.
const MOST_CELLS: f64 = 1e5;

/// A scene file. An accepted scene parses again to the same, keeps what it holds within its bounds, and makes a world in which
/// rays are cast.
pub fn scene(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Some(scene) = parsed(text, Some(LARGE_M)) else { return };
    let [min, max] = scene.bounds_m;
    let size_m = [max[0] - min[0], max[1] - min[1]];
    assert!(size_m.iter().all(|side| *side > 0.0 && side.is_finite()));
    assert!(scene.stops.len() >= 2 && !scene.stages.is_empty());
    for (k, stop) in scene.stops.iter().enumerate() {
        assert!(stop.waypoint < scene.waypoints.len(), "stop {k}");
        let at = scene.waypoint_of(k).at_m;
        assert!((0..2).all(|k| (min[k]..=max[k]).contains(&at[k])), "{at:?}");
    }
    let world = World::new(&scene);
    for angle in [0.0_f64, 1.0, 3.0, 5.0] {
        let hit = world.cast(scene.waypoint_of(0).at_m, [angle.cos(), angle.sin()]);
        assert!(hit.is_none_or(|hit| hit.range_m >= 0.0 && hit.range_m.is_finite()));
    }
    if scene.known.is_none() {
        parsed(text, None);
    } else if size_m[0] * size_m[1] < MOST_CELLS * 0.05 * 0.05 {
        parsed(text, Some(0.05));
    }
}

/// Parses twice.
fn parsed(text: &str, cell_m: Option<f64>) -> Option<Scene> {
    let parse = || Scene::parse(text, Path::new(BESIDE), cell_m);
    let scene = parse().inspect_err(|error| message::check(error, BESIDE)).ok()?;
    let again = parse().expect("it was accepted before");
    assert_eq!(format!("{scene:?}"), format!("{again:?}"));
    Some(scene)
}

/// A family file. An accepted family parses again to the same, and its layouts are scenes.
pub fn family(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let path = Path::new("f.toml");
    let family = match Family::parse(text, path) {
        Ok(family) => family,
        Err(error) => return message::check(&error, "f.toml:"),
    };
    let again = Family::parse(text, path).expect("it was accepted before");
    assert_eq!(format!("{family:?}"), format!("{again:?}"));
    if pieces(text).is_none_or(|pieces| pieces > 50.0) {
        return; // takes long to furnish
    }
    let layout = match family.generate(1, &Variation::default()) {
        Ok(layout) => layout,
        Err(error) => return message::check(&error, "f.toml:"),
    };
    assert_eq!(again.generate(1, &Variation::default()).expect("it was made before"), layout);
    let scene = Scene::parse(&layout, path, None).unwrap_or_else(|error| panic!("{error}\n{layout}"));
    assert_eq!(scene.name, format!("{}-1", family.name));
}

/// About how many obstacles a layout has.
fn pieces(text: &str) -> Option<f64> {
    let table: toml::Table = text.trim_start_matches('\u{feff}').parse().ok()?;
    let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|v| v as f64));
    let plan = table.get("generate")?;
    let side = |key: &str| number(plan.get(key)?.get(1)?);
    let size_m = number(plan.get("obstacle_size")?)?;
    Some(number(plan.get("covered")?)? * side("width")? * side("height")? / (size_m * size_m))
}

/// A floor plan. What is read is an outline that holds an area, is written, and reads back the same.
pub fn plan(data: &[u8]) {
    let read = |bytes: &[u8]| FloorPlan::parse(bytes, Path::new("p.json"));
    let plan = match read(data) {
        Ok(plan) => plan,
        Err(error) => return message::check(&error, "p.json:"),
    };
    let [min, max] = plan.extent_m();
    assert!(plan.outline_m.len() >= 3 && (0..2).all(|k| min[k] < max[k]), "{plan:?}");
    let text = format!("{{\"verts\": {:?}}}", plan.outline_m);
    assert_eq!(read(text.as_bytes()).expect("what was written is a plan").outline_m, plan.outline_m);
}
