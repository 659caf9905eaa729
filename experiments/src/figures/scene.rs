//! The scene, the route and the regions: the paper's Figure 11.

use plotters::prelude::*;
use scene::Scene;

use super::ink::{self, FAINT, INK, ROUTE};
use super::panel::Panel;
use super::png;
use crate::failure::Failure;
use crate::worlds::run::Ground;

/// What the picture shows.
pub const CAPTION: &str = "The scene as the truth has it (compare Figure 11): obstacles black, the route of the robot blue with its \
    stops, regions orange. Space that nobody knows the truth about is tinted and never scored.";

const MARGIN: u32 = 24;
const FOOT: u32 = 44;
const WIDTH: usize = 1000;

/// More waypoints than this have small dots, and no names that would hide others.
const MANY: usize = 15;

/// Draws the scene.
///
/// # Errors
/// A drawing that fails.
pub fn draw(ground: &Ground) -> Result<Vec<u8>, Failure> {
    let scene = &ground.scene;
    let panel = Panel::whole(scene.grid, WIDTH).at(MARGIN, MARGIN);
    let (width, height) = panel.size();
    png((width + 2 * MARGIN, height + 2 * MARGIN + FOOT), |area| {
        panel.fill(area, |cell| ink::truth(ground.truth[cell]))?;
        let stops = 0..scene.stops.len();
        let way: Vec<[f64; 2]> = stops.clone().map(|stop| scene.waypoint_of(stop).at_m).collect();
        panel.path(area, &way, ROUTE)?;
        for region in &scene.regions {
            panel.outline(area, region, true)?;
        }
        if let Some(start) = ground.drive.poses.first() {
            panel.robot(area, &start.pose, scene.robot.radius_m, ROUTE)?;
        }
        waypoints(area, &panel, scene, (width + 2 * MARGIN) as i32)?;
        scale_bar(area, &panel, (MARGIN, MARGIN + height + 16))?;
        let route: Vec<&str> = stops.map(|stop| scene.waypoint_of(stop).name.as_str()).collect();
        let at = ((MARGIN as f64 + panel.scale()) as i32 + 24, (MARGIN + height + 8) as i32);
        let style = ink::letters(24, &INK);
        let room = (width + 2 * MARGIN).saturating_sub(at.0 as u32);
        let fits = |text: &str| area.estimate_text_size(text, &style).is_ok_and(|(wide, _)| wide <= room);
        let text = caption(&scene.description, &route, fits);
        area.draw(&Text::new(text, at, style)).map_err(Failure::internal)
    })
}

/// Dots, and names where they hide no other: those of the start and of the stops at which stages end come first.
fn waypoints(area: &super::Area, panel: &Panel, scene: &Scene, width: i32) -> Result<(), Failure> {
    let (many, size) = (scene.waypoints.len() > MANY, 32);
    let beside = (scene.robot.radius_m * panel.scale()) as i32;
    for waypoint in &scene.waypoints {
        let dot = Circle::new(panel.pixel(waypoint.at_m), if many { 3 } else { 6 }, ROUTE.filled());
        area.draw(&dot).map_err(Failure::internal)?;
    }
    let ends = scene.stages.iter().map(|stage| scene.stops[stage.stops - 1].waypoint);
    let first = scene.stops.iter().take(1).map(|stop| stop.waypoint).chain(ends);
    let style = ink::letters(size, &ROUTE);
    let mut drawn: Vec<[i32; 4]> = Vec::new();
    for number in first.chain(0..scene.waypoints.len()) {
        let waypoint = &scene.waypoints[number];
        let (x, y) = panel.pixel(waypoint.at_m);
        let (x, y) = (x + beside, y + 6);
        let (wide, high) = area.estimate_text_size(&waypoint.name, &style).map_err(Failure::internal)?;
        let place = [x, y, x + wide as i32, y + high as i32];
        let hides = |other: &[i32; 4]| (0..2).all(|k| place[k] < other[k + 2] && other[k] < place[k + 2]);
        if many && (place[2] > width || drawn.iter().any(hides)) {
            continue;
        }
        area.draw(&Text::new(waypoint.name.clone(), (x, y), style.clone())).map_err(Failure::internal)?;
        drawn.push(place);
    }
    Ok(())
}

/// The description and as much of the route as fits.
fn caption(description: &str, route: &[&str], fits: impl Fn(&str) -> bool) -> String {
    let whole = format!("{description}. Route: {}", route.join(", "));
    if fits(&whole) {
        return whole;
    }
    let shortened = (1..route.len()).rev().map(|k| format!("{description}. Route: {}, ...", route[..k].join(", ")));
    shortened.into_iter().find(|text| fits(text)).unwrap_or_else(|| format!("{description}."))
}

/// A bar of one metre.
fn scale_bar(area: &super::Area, panel: &Panel, (x, y): (u32, u32)) -> Result<(), Failure> {
    let (x, y) = (x as i32, y as i32);
    let end = x + panel.scale().round() as i32;
    let ticks = [vec![(x, y - 4), (x, y + 4)], vec![(x, y), (end, y)], vec![(end, y - 4), (end, y + 4)]];
    for line in ticks {
        area.draw(&PathElement::new(line, FAINT.stroke_width(2))).map_err(Failure::internal)?;
    }
    let style = ink::letters(ink::LABEL, &FAINT);
    area.draw(&Text::new("1 m", ((x + end) / 2 - 16, y + 6), style)).map_err(Failure::internal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caption_ends_where_the_picture_does() {
        let route = ["A", "B", "C", "D"];
        let within = |most: usize| caption("A room", &route, |text| text.len() <= most);
        assert_eq!(within(100), "A room. Route: A, B, C, D");
        assert_eq!(within(24), "A room. Route: A, B, ...");
        assert_eq!(within(10), "A room.");
    }
}
