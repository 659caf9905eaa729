//! [`Reconciliation::Touched`](crate::Reconciliation::Touched): an edge on no ray keeps its correlation, and does not count in the marginals.

use crate::belief::prior::Continuity;
use crate::fast::bounds::{bounded, possible};
use crate::fast::map::Map;
use crate::fast::sums::{LEFT, Sums};
use crate::fast::tiles::{PATCH, split};
use crate::pairs::joint::{both_occupied, correlation};

/// An edge of a touched cell whose joint no ray moves.
struct OffRays {
    low: u32,
    axis: usize,
    kept: Kept,
}

/// What such an edge keeps of its state before the scan.
enum Kept {
    /// Its correlation, on no ray.
    Correlation(f64),
    /// The probability that its cells differ: rays pass along it unmoved.
    Differ(f64),
}

/// Takes over the means of what the sums hold.
pub(super) fn touched(map: &mut Map, continuity: Continuity, sums: &Sums) {
    let numbering = map.numbering;
    let spec = *numbering.spec();
    let places =
        sums.sheets().flat_map(|sheet| (0..PATCH).map(move |place| (sums.patch(sheet) * PATCH + place) as u32));
    let cells: Vec<u32> = places.filter(|cell| sums.is_touched(*cell)).collect();
    let mut off_rays = Vec::new();
    for &cell in cells.iter().filter(|_| continuity == Continuity::Kept) {
        let at = numbering.column_row(cell);
        let totals = sums.totals(cell);
        for axis in 0..2 {
            if at[axis] + 1 < [spec.width, spec.height][axis] && totals.differ[axis].1 <= 0.0 {
                off_rays.push(keep(map, cell, axis, false));
            }
            if let Some(low) = numbering.before(cell, axis).filter(|low| !sums.is_touched(*low)) {
                off_rays.push(keep(map, low, axis, totals.edges & (LEFT << axis) != 0));
            }
        }
    }
    for &cell in &cells {
        let (tile, place) = split(cell);
        let (sum, pairs) = sums.totals(cell).occupied;
        map.make(tile).occupied[place] = bounded((sum / pairs) as f32);
    }
    for &cell in cells.iter().filter(|_| continuity == Continuity::Kept) {
        for (axis, (sum, rays)) in sums.totals(cell).differ.into_iter().enumerate().filter(|(_, (_, rays))| *rays > 0.0)
        {
            set(map, cell, axis, &Kept::Differ(sum / rays));
        }
    }
    for OffRays { low, axis, kept } in off_rays {
        set(map, low, axis, &kept);
    }
}

fn keep(map: &Map, low: u32, axis: usize, on_rays: bool) -> OffRays {
    let [p, q] = ends(map, low, axis).map(f64::from);
    let both = f64::from(map.both(low, axis));
    let kept = if on_rays { Kept::Differ(p + q - 2.0 * both) } else { Kept::Correlation(correlation(p, q, both)) };
    OffRays { low, axis, kept }
}

/// `P(E)` of the two cells of an edge.
fn ends(map: &Map, low: u32, axis: usize) -> [f32; 2] {
    [low, map.numbering.after(low, axis).unwrap_or(low)].map(|cell| map.occupied(cell))
}

fn set(map: &mut Map, low: u32, axis: usize, kept: &Kept) {
    let [p, q] = ends(map, low, axis);
    let [x, y] = [p, q].map(f64::from);
    let (tile, place) = split(low);
    map.make(tile).both[axis][place] = match kept {
        Kept::Differ(differ) => possible(p, q, (0.5 * (x + y - differ)) as f32),
        Kept::Correlation(correlation) => both_occupied(x, y, *correlation) as f32,
    };
}
