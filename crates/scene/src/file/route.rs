//! `[waypoints]`, `[route]` and `[[stage]]`.

use strict::{LONGEST_VALUE, Table, Value, excerpt, hint};

use super::bounds::within;
use super::findings::Findings;
use super::limits::WAIT;
use super::points::point;
use crate::geometry::distance;
use crate::{Problem, SceneError, StagePlan, Stop, Waypoint};

/// Longest name of a waypoint, in characters: pictures and messages show it.
const LONGEST_NAME: usize = 32;

/// What lists of stops hold.
const NAMES: &str = "waypoint names";

/// The named points.
///
/// A point that is refused stands among them all the same, nowhere, so that its name is known.
pub(super) fn waypoints(root: &Table, bounds: [[f64; 2]; 2], found: &mut Findings) -> Option<Vec<Waypoint>> {
    let example = "[waypoints] with lines such as A = [1.0, 2.0]";
    let Some(table) = found.take(root.section("waypoints"))? else {
        found.add(root.missing("[waypoints]", example));
        return None;
    };
    let mut waypoints = Vec::new();
    for (name, offset) in table.keys() {
        if name.is_empty() || name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
            let problem = strict::Problem::Value {
                element: "[waypoints]".to_owned(),
                key: "name".to_owned(),
                value: format!("\"{}\"", excerpt(name, LONGEST_VALUE)),
                bound: format!("1 to {LONGEST_NAME} characters that can be printed"),
                remedy: "name the waypoint with a letter or a word".to_owned(),
            };
            found.add(root.source().error(offset, problem));
        }
        let at_m = found.take(point(&table, name)).unwrap_or([f64::NAN; 2]);
        let within = within([at_m, at_m], bounds, || format!("waypoint {name}"));
        found.take(within.map_err(|problem| SceneError::at(root.source().place(offset), problem)));
        waypoints.push(Waypoint { name: name.to_owned(), at_m });
    }
    Some(waypoints)
}

/// The stops of the route.
pub(super) fn stops(root: &Table, waypoints: Option<&[Waypoint]>, found: &mut Findings) -> Option<Vec<Stop>> {
    let example = "[\"A\", \"B\"]";
    let Some(table) = found.take(root.section("route"))? else {
        found.add(root.missing("[route]", &format!("[route] with stops = {example}")));
        return None;
    };
    found.only(&table, &["stops"]);
    let names = named_stops(&table, example, found)?;
    let (waypoints, before) = (waypoints?, found.count());
    let mut stops: Vec<Stop> = Vec::new();
    for &(name, value, wait_s) in &names {
        let Some(waypoint) = found.take(find(&table, waypoints, name, value)) else { continue };
        if let Some(last) = stops.last() {
            let [here, there] = [waypoint, last.waypoint].map(|w| waypoints[w].at_m);
            if distance(here, there) < SHORTEST_LEG_M {
                let bound = format!("at least {SHORTEST_LEG_M} m from the stop before it");
                found.add(table.refuse("stop", value, &bound, "leave it out or name another waypoint"));
            }
        }
        stops.push(Stop { waypoint, wait_s, place: root.source().place(value.span().start) });
    }
    if let Some(value) = table.get("stops").filter(|_| names.len() < 2) {
        found.add(table.refuse("stops", value, "at least two waypoints", &format!("write it like {example}")));
    }
    (found.count() == before).then_some(stops)
}

/// `stops`: names of waypoints with their places and how long the robot stands there, s. A stop is a name, or a table with the
/// name and the time.
fn named_stops<'a>(
    table: &Table<'a>,
    example: &str,
    found: &mut Findings,
) -> Option<Vec<(&'a str, &'a Value<'a>, f64)>> {
    let value = table.get("stops");
    let items = value.and_then(|value| value.get_ref().as_array());
    let Some(items) = items.filter(|items| items.iter().any(|item| item.get_ref().as_table().is_some())) else {
        let names = found.take(table.strings("stops", NAMES, example))?;
        return Some(names.into_iter().map(|(name, value)| (name, value, 0.0)).collect());
    };
    let before = found.count();
    let mut stops = Vec::with_capacity(items.len());
    for (k, item) in items.iter().enumerate() {
        if let Some(name) = item.get_ref().as_str() {
            stops.push((name, item, 0.0));
            continue;
        }
        let bound = "a waypoint name, or a table such as { at = \"B\", wait_s = 10.0 }";
        let Some(entries) = item.get_ref().as_table() else {
            found.add(table.refuse("stop", item, bound, &format!("write the stops like {example}")));
            continue;
        };
        let stop = Table::new(table.source(), &format!("[route] stop {}", k + 1), item.span().start, entries);
        found.only(&stop, &["wait_s", "at"]);
        let wait_s = found.take(stop.optional_number("wait_s", &WAIT)).flatten().unwrap_or(0.0);
        match stop.get("at").map(|at| (at, at.get_ref().as_str())) {
            Some((at, Some(name))) => stops.push((name, at, wait_s)),
            Some((at, None)) => found.add(stop.refuse("at", at, "the name of a waypoint", "write it in quotes")),
            None => found.add(stop.missing("at", "`at = \"B\"`, the name of a waypoint")),
        }
    }
    (found.count() == before).then_some(stops)
}

/// The direction of a shorter leg would be noise.
const SHORTEST_LEG_M: f64 = 0.001;

/// The stages, or one named `end` where the file has none.
///
/// Without waypoints or stops, whether a stage fits them is not asked.
pub(super) fn stages(
    root: &Table,
    waypoints: Option<&[Waypoint]>,
    stops: Option<&[Stop]>,
    found: &mut Findings,
) -> Vec<StagePlan> {
    let tables = found.take(root.list("stage")).unwrap_or_default();
    let mut stages: Vec<StagePlan> = Vec::new();
    let mut names: Vec<(String, usize)> = Vec::new();
    for (k, table) in tables.iter().enumerate() {
        found.only(table, &["name", "after", "label"]);
        let name = found.take(table.name("name"));
        if let Some(name) = &name {
            if let Some((_, line)) = names.iter().find(|(other, _)| other == name) {
                found.add(duplicate(table, name.clone(), *line));
            }
            names.push((name.clone(), table.place().line));
        }
        let after = found.take(table.strings("after", NAMES, "[\"A\", \"B\"]"));
        let label = found.take(table.text("label")).flatten();
        let (Some(after), Some(waypoints)) = (after, waypoints) else { continue };
        let before = found.count();
        for &(stop, value) in &after {
            found.take(find(table, waypoints, stop, value));
        }
        let Some(stops) = stops.filter(|_| found.count() == before) else { continue };
        let on_route = after.len() <= stops.len()
            && after.iter().zip(stops).all(|((name, _), stop)| *name == waypoints[stop.waypoint].name);
        let longer = after.len() > stages.last().map_or(0, |s: &StagePlan| s.stops);
        let complete = k + 1 < tables.len() || after.len() == stops.len();
        let bound = match (on_route, longer, complete) {
            (true, true, true) => None,
            (false, ..) => Some(format!("the first stops of the route, {}", listed_stops(waypoints, stops))),
            (_, false, _) if stages.is_empty() => Some("at least the first stop of the route".to_owned()),
            (_, false, _) => Some("longer than that of the stage before it".to_owned()),
            _ => Some(format!("the whole route in the last stage, {}", listed_stops(waypoints, stops))),
        };
        if let Some(bound) = bound {
            let remedy = "a stage ends on arrival at the last stop it lists";
            found.take(table.get("after").map_or(Ok(()), |value| Err(table.refuse("after", value, &bound, remedy))));
        }
        let name = name.unwrap_or_default();
        stages.push(StagePlan { label: label.unwrap_or_else(|| name.clone()), name, stops: after.len() });
    }
    if let Some(stops) = stops.filter(|_| tables.is_empty()) {
        stages.push(StagePlan { name: "end".to_owned(), label: "end of the route".to_owned(), stops: stops.len() });
    }
    stages
}

pub(super) fn duplicate(table: &Table, name: String, line: usize) -> SceneError {
    let problem = Problem::Duplicate { element: table.element(), name, line };
    SceneError::at(table.place_of("name"), problem)
}

pub(super) fn find(table: &Table, waypoints: &[Waypoint], name: &str, value: &Value) -> Result<usize, SceneError> {
    waypoints.iter().position(|w| w.name == name).ok_or_else(|| {
        let known: Vec<&str> = waypoints.iter().map(|w| w.name.as_str()).collect();
        let problem = Problem::UnknownWaypoint {
            element: table.element(),
            name: excerpt(name, LONGEST_VALUE),
            hint: hint(name, &known),
            known: listed(&known),
        };
        SceneError::at(table.source().place(value.span().start), problem)
    })
}

fn listed_stops(waypoints: &[Waypoint], stops: &[Stop]) -> String {
    listed(&stops.iter().map(|s| waypoints[s.waypoint].name.as_str()).collect::<Vec<_>>())
}

/// Names for a message, the first of them where there are many.
pub(super) fn listed(names: &[&str]) -> String {
    const MOST: usize = 20;
    let shown = names[..names.len().min(MOST)].join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}
