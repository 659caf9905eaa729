//! The scene, the route and the regions: the paper's Figure 11.

use scene::Scene;

use super::drawing::{Anchor, Drawing};
use super::ink::{self, INK, LABEL, ROUTE};
use super::panel::Panel;
use super::paper::Paper;
use super::{key, letters};
use crate::worlds::ground::Ground;

/// What the picture shows.
pub const CAPTION: &str = "The scene as the truth has it (compare Figure 11): obstacles black, the route of the robot blue with its \
    stops, regions orange, what moves violet where it is at the start. Space that nobody knows the truth about is tinted and never scored.";

const MARGIN: f64 = 24.0;
const FOOT: f64 = 74.0;
const WIDTH: f64 = 1000.0;

/// Size of the names of waypoints.
const NAME: f64 = 28.0;

/// More waypoints than this have small dots, and no names that would hide others.
const MANY: usize = 15;

/// Draws the scene.
pub fn draw(ground: &Ground, paper: &Paper) -> Drawing {
    let scene = &ground.scene;
    let panel = Panel::whole(scene.grid, paper.width(WIDTH + 2.0 * MARGIN) - 2.0 * MARGIN, paper).at(MARGIN, MARGIN);
    let (width, height) = panel.size();
    let mut drawing = Drawing::new(width + 2.0 * MARGIN, height + 2.0 * MARGIN + FOOT);
    let d = &mut drawing;
    panel.fill(d, |cell| ink::truth(ground.still()[cell]));
    let stops = 0..scene.stops.len();
    let way: Vec<[f64; 2]> = stops.clone().map(|stop| scene.waypoint_of(stop).at_m).collect();
    panel.path(d, &way, ROUTE);
    for region in &scene.regions {
        panel.outline(d, region);
    }
    if ground.moves() {
        panel.things(d, ground.drive.motion.shapes_at(0).map(|(_, shape)| shape));
    }
    if let Some(start) = ground.drive.poses.first() {
        panel.robot(d, &start.pose, scene.robot.radius_m, ROUTE);
    }
    waypoints(d, &panel, scene, width + 2.0 * MARGIN);
    let foot = MARGIN + height + 24.0;
    let bar = key::scale_bar(d, (MARGIN, foot), &panel, width);
    let route: Vec<&str> = stops.map(|stop| scene.waypoint_of(stop).name.as_str()).collect();
    let x = MARGIN + bar + 28.0;
    let room = width + 2.0 * MARGIN - x - 8.0;
    let description = letters::cut(&scene.description, LABEL, room);
    d.text(&description, (x, foot), LABEL, INK, Anchor::Start);
    let way = way_in_words(&route, |text| letters::width(text, LABEL) <= room);
    d.text(&way, (x, foot + 28.0), LABEL, INK, Anchor::Start);
    drawing
}

/// Dots, and names where they hide no other: those of the start and of the stops at which stages end come first.
fn waypoints(drawing: &mut Drawing, panel: &Panel, scene: &Scene, width: f64) {
    let many = scene.waypoints.len() > MANY;
    let beside = scene.robot.radius_m * panel.scale();
    for waypoint in &scene.waypoints {
        drawing.disc(panel.place(waypoint.at_m), if many { 3.0 } else { 6.0 }, ROUTE);
    }
    let ends = scene.stages.iter().map(|stage| scene.stops[stage.stops - 1].waypoint);
    let first = scene.stops.iter().take(1).map(|stop| stop.waypoint).chain(ends);
    let mut drawn: Vec<[f64; 4]> = Vec::new();
    for number in first.chain(0..scene.waypoints.len()) {
        let waypoint = &scene.waypoints[number];
        let (x, y) = panel.place(waypoint.at_m);
        let (x, y) = (x + beside.max(10.0), y + 18.0);
        let place = [x, y - 0.5 * NAME, x + letters::width(&waypoint.name, NAME), y + 0.5 * NAME];
        let hides = |other: &[f64; 4]| (0..2).all(|k| place[k] < other[k + 2] && other[k] < place[k + 2]);
        if (many && place[2] > width) || drawn.iter().any(hides) {
            continue;
        }
        drawing.text(&waypoint.name, (x, y), NAME, ROUTE, Anchor::Start);
        drawn.push(place);
    }
}

/// As much of the route as fits.
fn way_in_words(route: &[&str], fits: impl Fn(&str) -> bool) -> String {
    let whole = format!("Route: {}", route.join(", "));
    if fits(&whole) {
        return whole;
    }
    let shortened = (1..route.len()).rev().map(|k| format!("Route: {}, ...", route[..k].join(", ")));
    shortened.into_iter().find(|text| fits(text)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_ends_where_the_picture_does() {
        let route = ["A", "B", "C", "D"];
        let within = |most: usize| way_in_words(&route, |text| text.len() <= most);
        assert_eq!(within(100), "Route: A, B, C, D");
        assert_eq!(within(16), "Route: A, B, ...");
        assert_eq!(within(10), "");
    }
}
