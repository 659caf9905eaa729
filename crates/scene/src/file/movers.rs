//! `[[mover]]`: what walks.

use strict::{Error, Limit, Table, Value, number};

use super::findings::Findings;
use super::limits::{FOLLOWING, MOVER_RADIUS, MOVER_SPEED, PAUSE, STRAYING};
use super::obstacles::texture;
use super::points::POINT;
use super::{polygon, route};
use crate::{Behaviour, Mover, Origin, Repeat, SceneError, Shape, Waypoint};

/// More of one kind than this are refused: each is moved beside all others.
pub(super) const MOST: usize = 200;

/// What a walker does where the file is silent.
const SPEED_M_S: f64 = 1.2;
const DISTANCE_M: f64 = 1.0;
const WITHIN_M: f64 = 1.0;
const LOITER_PAUSE_S: f64 = 5.0;

const KEYS: [&str; 11] = [
    "radius",
    "points",
    "route",
    "speed_m_s",
    "pause_s",
    "start_s",
    "repeat",
    "behaviour",
    "distance_m",
    "within_m",
    "texture",
];

/// Every mover of the file.
pub(super) fn read(root: &Table, waypoints: Option<&[Waypoint]>, found: &mut Findings) -> Vec<Mover> {
    let tables = found.take(few(root, "mover")).unwrap_or_default();
    let movers = tables.iter().enumerate().map(|(k, table)| mover(table, k + 1, waypoints, found));
    movers.collect::<Vec<_>>().into_iter().flatten().collect()
}

/// The tables of a kind of which there are not too many.
pub(super) fn few<'a>(root: &Table<'a>, kind: &str) -> Result<Vec<Table<'a>>, Error> {
    let tables = root.list(kind)?;
    match root.get(kind).filter(|_| tables.len() > MOST) {
        Some(value) => Err(root.refuse(kind, value, &format!("at most {MOST} tables"), "leave some of them out")),
        None => Ok(tables),
    }
}

fn mover(table: &Table, number: usize, waypoints: Option<&[Waypoint]>, found: &mut Findings) -> Option<Mover> {
    found.only(table, &KEYS);
    let shape = shape(table, found);
    let (speed_m_s, start_s) = (
        found.take(table.optional_number("speed_m_s", &MOVER_SPEED)),
        found.take(table.optional_number("start_s", &PAUSE)),
    );
    let (points_m, texture) = (points(table, waypoints, found), found.take(texture(table)));
    let behaviour = behaviour(table, points_m.as_deref(), found);
    Some(Mover {
        shape: shape?,
        texture: texture?,
        behaviour: behaviour?,
        start_m: *points_m?.first()?,
        speed_m_s: speed_m_s?.unwrap_or(SPEED_M_S),
        start_s: start_s?.unwrap_or(0.0),
        origin: Origin { kind: "mover", number, line: table.place().line },
    })
}

/// A disc or a polygon about the mover's own place.
fn shape(table: &Table, found: &mut Findings) -> Option<Shape> {
    match (table.get("radius"), table.get("points")) {
        (Some(value), Some(_)) => {
            let bound = "left out beside `points`";
            found.add(table.refuse("radius", value, bound, "a mover is a disc with a radius or a polygon with points"));
            None
        }
        (None, Some(_)) => found.take(polygon::points(table)).map(|points_m| Shape::Polygon { points_m }),
        _ => {
            let radius_m = found.take(table.number("radius", &MOVER_RADIUS))?;
            Some(Shape::Disc { center_m: [0.0; 2], radius_m })
        }
    }
}

/// The points of a route: `[x, y]` or names of waypoints.
fn points(table: &Table, waypoints: Option<&[Waypoint]>, found: &mut Findings) -> Option<Vec<[f64; 2]>> {
    const EXAMPLE: &str = "[[1.0, 2.0], \"B\"]";
    let Some(value) = table.get("route") else {
        found.add(table.missing("route", &format!("`route = {EXAMPLE}`, points and names of waypoints")));
        return None;
    };
    let Some(items) = value.get_ref().as_array().filter(|items| (1..=1000).contains(&items.len())) else {
        let bound = "a list of 1 to 1000 points [x, y] in m or names of waypoints";
        found.add(table.refuse("route", value, bound, &format!("write it like {EXAMPLE}")));
        return None;
    };
    let (before, mut points) = (found.count(), Vec::with_capacity(items.len()));
    for (k, item) in items.iter().enumerate() {
        let point = match item.get_ref().as_str() {
            None => found.take(table.pair(&format!("point {}", k + 1), item, &POINT)),
            Some(name) => {
                let waypoints = waypoints?;
                found.take(route::find(table, waypoints, name, item)).map(|w| waypoints[w].at_m)
            }
        };
        points.extend(point);
    }
    (found.count() == before).then_some(points)
}

fn behaviour(table: &Table, points: Option<&[[f64; 2]]>, found: &mut Findings) -> Option<Behaviour> {
    const KINDS: [&str; 3] = ["route", "follower", "loiterer"];
    let kind = match table.get("behaviour") {
        None => "route",
        Some(value) => found.take(table.word("behaviour", value, &KINDS))?,
    };
    // Keys that say something only of another behaviour.
    for (key, kinds) in [
        ("distance_m", &["follower"][..]),
        ("within_m", &["loiterer"]),
        ("repeat", &["route"]),
        ("pause_s", &["route", "loiterer"]),
    ] {
        if let Some(value) = table.get(key).filter(|_| !kinds.contains(&kind)) {
            let bound = format!("left out where behaviour = \"{kind}\"");
            let remedy = format!("it is for behaviour = \"{}\"; take it out", kinds.join("\" or \""));
            found.add(table.refuse(key, value, &bound, &remedy));
        }
    }
    if let Some(value) = table.get("route").filter(|_| kind != "route" && points.is_some_and(|p| p.len() > 1)) {
        let bound = format!("a single point where behaviour = \"{kind}\"");
        found.add(table.refuse("route", value, &bound, "it is where the mover starts"));
    }
    match kind {
        "follower" => {
            let distance_m = found.take(table.optional_number("distance_m", &FOLLOWING))?;
            Some(Behaviour::Follower { distance_m: distance_m.unwrap_or(DISTANCE_M) })
        }
        "loiterer" => {
            let within_m = found.take(table.optional_number("within_m", &STRAYING));
            let pause_s = found.take(table.optional_number("pause_s", &PAUSE))?;
            let within_m = within_m?.unwrap_or(WITHIN_M);
            Some(Behaviour::Loiterer { within_m, pause_s: pause_s.unwrap_or(LOITER_PAUSE_S) })
        }
        _ => {
            let repeat = match table.get("repeat") {
                None => "loop",
                Some(value) => found.take(table.word("repeat", value, &["loop", "once", "back_and_forth"]))?,
            };
            let repeat = match repeat {
                "once" => Repeat::Once,
                "back_and_forth" => Repeat::BackAndForth,
                _ => Repeat::Loop,
            };
            let points_m = points?.to_vec();
            let pauses_s = found.take(pauses(table, points_m.len()))?;
            Some(Behaviour::Route { points_m, pauses_s, repeat })
        }
    }
}

/// `pause_s`: one time for all points, or one for each.
fn pauses(table: &Table, points: usize) -> Result<Vec<f64>, SceneError> {
    let Some(value) = table.get("pause_s") else { return Ok(vec![0.0; points]) };
    let refuse = |value: &Value, limit: &Limit| table.refuse("pause_s", value, limit.bound, limit.remedy);
    let Some(items) = value.get_ref().as_array() else {
        let pause = number(value).filter(|&v| PAUSE.allows(v)).ok_or_else(|| refuse(value, &PAUSE))?;
        return Ok(vec![pause; points]);
    };
    if items.len() != points {
        let bound = format!("a time in s, or one for each of the {points} points of the route");
        return Err(table.refuse("pause_s", value, &bound, "give 0 where the mover walks on").into());
    }
    let times = items.iter().map(|item| number(item).filter(|&v| PAUSE.allows(v)).ok_or_else(|| refuse(item, &PAUSE)));
    Ok(times.collect::<Result<_, Error>>()?)
}
