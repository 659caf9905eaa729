//! `[waypoints]`, `[route]` and `[[stage]]`.

use strict::{LONGEST_VALUE, Table, Value, excerpt, hint};

use super::bounds::within;
use super::points::point;
use crate::geometry::distance;
use crate::{Problem, SceneError, StagePlan, Stop, Waypoint};

/// Longest name of a waypoint, in characters: pictures and messages show it.
const LONGEST_NAME: usize = 32;

/// What lists of stops hold.
const NAMES: &str = "waypoint names";

/// The named points.
pub(super) fn waypoints(root: &Table, bounds: [[f64; 2]; 2]) -> Result<Vec<Waypoint>, SceneError> {
    let example = "[waypoints] with lines such as A = [1.0, 2.0]";
    let Some(table) = root.section("waypoints")? else { return Err(root.missing("[waypoints]", example).into()) };
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
            return Err(root.source().error(offset, problem).into());
        }
        let at_m = point(&table, name)?;
        within([at_m, at_m], bounds, || format!("waypoint {name}"))
            .map_err(|p| SceneError::at(root.source().place(offset), p))?;
        waypoints.push(Waypoint { name: name.to_owned(), at_m });
    }
    Ok(waypoints)
}

/// The stops of the route.
pub(super) fn stops(root: &Table, waypoints: &[Waypoint]) -> Result<Vec<Stop>, SceneError> {
    let example = "[\"A\", \"B\"]";
    let Some(table) = root.section("route")? else {
        return Err(root.missing("[route]", &format!("[route] with stops = {example}")).into());
    };
    table.only(&["stops"])?;
    let names = table.strings("stops", NAMES, example)?;
    let mut stops: Vec<Stop> = Vec::new();
    for &(name, value) in &names {
        let waypoint = find(&table, waypoints, name, value)?;
        if let Some(last) = stops.last() {
            let [here, there] = [waypoint, last.waypoint].map(|w| waypoints[w].at_m);
            if distance(here, there) < SHORTEST_LEG_M {
                let bound = format!("at least {SHORTEST_LEG_M} m from the stop before it");
                return Err(table.refuse("stop", value, &bound, "leave it out or name another waypoint").into());
            }
        }
        stops.push(Stop { waypoint, place: root.source().place(value.span().start) });
    }
    match table.get("stops") {
        Some(value) if stops.len() < 2 => {
            Err(table.refuse("stops", value, "at least two waypoints", &format!("write it like {example}")).into())
        }
        _ => Ok(stops),
    }
}

/// The direction of a shorter leg would be noise.
const SHORTEST_LEG_M: f64 = 0.001;

/// The stages, or one named `end` where the file has none.
pub(super) fn stages(root: &Table, waypoints: &[Waypoint], stops: &[Stop]) -> Result<Vec<StagePlan>, SceneError> {
    let tables = root.list("stage")?;
    let mut stages: Vec<StagePlan> = Vec::new();
    for (k, table) in tables.iter().enumerate() {
        table.only(&["name", "after", "label"])?;
        let name = table.name("name")?;
        if let Some(first) = stages.iter().position(|s| s.name == name) {
            return Err(duplicate(table, name, tables[first].place().line));
        }
        let after = table.strings("after", NAMES, "[\"A\", \"B\"]")?;
        for &(stop, value) in &after {
            find(table, waypoints, stop, value)?;
        }
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
            let value = table.get("after").ok_or_else(|| table.missing("after", "the stops"))?;
            return Err(table
                .refuse("after", value, &bound, "a stage ends on arrival at the last stop it lists")
                .into());
        }
        let label = table.text("label")?.unwrap_or_else(|| name.clone());
        stages.push(StagePlan { name, label, stops: after.len() });
    }
    if stages.is_empty() {
        stages.push(StagePlan { name: "end".to_owned(), label: "end of the route".to_owned(), stops: stops.len() });
    }
    Ok(stages)
}

pub(super) fn duplicate(table: &Table, name: String, line: usize) -> SceneError {
    let problem = Problem::Duplicate { element: table.element(), name, line };
    SceneError::at(table.place_of("name"), problem)
}

fn find(table: &Table, waypoints: &[Waypoint], name: &str, value: &Value) -> Result<usize, SceneError> {
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
fn listed(names: &[&str]) -> String {
    const MOST: usize = 20;
    let shown = names[..names.len().min(MOST)].join(", ");
    if names.len() > MOST { format!("{shown} and {} more", names.len() - MOST) } else { shown }
}
