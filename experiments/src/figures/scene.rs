//! The scene, the route and the regions: the paper's Figure 11.

use plotters::prelude::*;

use super::ink::{self, FAINT, INK, ROUTE};
use super::panel::Panel;
use super::png;
use crate::failure::Failure;
use crate::trial::Ground;

/// What the picture shows.
pub const CAPTION: &str = "The scene as the truth has it (compare Figure 11): obstacles black, the route of the robot blue with its \
    stops, regions orange. Space that nobody knows the truth about is tinted and never scored.";

const MARGIN: u32 = 24;
const FOOT: u32 = 44;
const WIDTH: usize = 1000;

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
        let beside = (scene.robot.radius_m * panel.scale()) as i32;
        for waypoint in &scene.waypoints {
            let (x, y) = panel.pixel(waypoint.at_m);
            area.draw(&Circle::new((x, y), 6, ROUTE.filled())).map_err(Failure::internal)?;
            let style = ink::letters(32, &ROUTE);
            area.draw(&Text::new(waypoint.name.clone(), (x + beside, y + 6), style)).map_err(Failure::internal)?;
        }
        scale_bar(area, &panel, (MARGIN, MARGIN + height + 16))?;
        let route: Vec<&str> = stops.map(|stop| scene.waypoint_of(stop).name.as_str()).collect();
        let text = format!("{}. Route: {}", scene.description, route.join(", "));
        let at = ((MARGIN as f64 + panel.scale()) as i32 + 24, (MARGIN + height + 8) as i32);
        area.draw(&Text::new(text, at, ink::letters(24, &INK))).map_err(Failure::internal)
    })
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
