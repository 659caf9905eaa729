//! How certain an obstacle must be before a reading from behind it changes nothing: `occluded`, over the obstacle's certainty.

use serde_json::json;

use super::cases::{OBSTACLE, OBVIOUS_AT, UNCHANGED, hidden};
use super::{Answers, ViewingRay};
use crate::output::table::{Table, rounded};
use crate::worlds::claims::Claim;

/// One obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Prior of the cells in front of it.
    pub in_front: f64,
    /// Prior of the cells of the obstacle.
    pub certainty: f64,
    /// Largest change of a posterior of `visibility` in cells 200 to 560.
    pub behind: f64,
    /// Largest change of a posterior of `visibility` in the obstacle.
    pub obstacle: f64,
}

/// Priors of the cells in front: unseen, and seen to be free.
pub const IN_FRONT: [f64; 2] = [0.1, 0.01];

/// From an even chance to one free cell in 100,000.
const CERTAINTIES: [f64; 15] =
    [0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995, 0.998, 0.999, 0.9995, 0.9998, 0.9999, 0.99995, 0.99998, 0.99999];

/// The curve, for either prior in front.
pub fn curve() -> Vec<Point> {
    IN_FRONT.iter().flat_map(|&in_front| CERTAINTIES.map(|certainty| point(in_front, certainty))).collect()
}

fn point(in_front: f64, certainty: f64) -> Point {
    let ray = hidden(certainty, in_front);
    let posterior = Answers::of(&ray).visibility.posterior;
    let obstacle = largest(&ray, &posterior, OBVIOUS_AT..OBVIOUS_AT + OBSTACLE);
    Point { in_front, certainty, behind: largest(&ray, &posterior, 200..561), obstacle }
}

fn largest(ray: &ViewingRay, posterior: &[f64], cells: std::ops::Range<usize>) -> f64 {
    cells.map(|k| (posterior[k] - ray.prior[k]).abs()).fold(0.0, f64::max)
}

/// The curve as a table.
pub fn table(curve: &[Point]) -> Table {
    Table::of(
        curve,
        &[
            ("prior_in_front", &|point| json!(point.in_front)),
            ("certainty", &|point| json!(point.certainty)),
            ("largest_change_200_to_560", &|point| rounded(point.behind)),
            ("largest_change_of_the_obstacle", &|point| rounded(point.obstacle)),
        ],
    )
}

/// The more certain the obstacle, the less a reading from behind it moves, down to nothing.
pub fn claims(curve: &[Point]) -> Vec<Claim> {
    let falls = |of: fn(&Point) -> f64| {
        let kept = |in_front: f64| curve.iter().filter(move |p| p.in_front.to_bits() == in_front.to_bits());
        // From 0.9 on: of a doubtful obstacle, little is left to take away.
        IN_FRONT.iter().all(|&f| {
            let values: Vec<f64> = kept(f).filter(|p| p.certainty >= 0.9).map(of).collect();
            values.windows(2).all(|pair| pair[1] < pair[0])
        })
    };
    let needed = |in_front: f64| {
        let enough = |p: &&Point| p.in_front.to_bits() == in_front.to_bits() && p.behind.max(p.obstacle) <= UNCHANGED;
        curve.iter().find(enough).map_or_else(|| "more than 0.99999".to_owned(), |p| p.certainty.to_string())
    };
    vec![Claim {
        claim: "visibility: the surer the obstacle (from 0.9 on), the less changes".to_owned(),
        measured: format!(
            "below {UNCHANGED} from {} on; from {} where the front is seen free",
            needed(IN_FRONT[0]),
            needed(IN_FRONT[1])
        ),
        holds: falls(|p| p.behind) && falls(|p| p.obstacle),
    }]
}
