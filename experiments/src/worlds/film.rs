//! What a report keeps of a map as it grows.

use grid::Raster;
use score::{Moving, MovingRegion, Region, Retention};

use super::levels::{fine, levels};

/// A map on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// After so many scans.
    pub scans: usize,
    /// Occupancy in [`levels`].
    pub levels: Raster<u8>,
    /// Occupancy in [`fine`] steps of log odds, at the end of a stage.
    pub fine: Option<Raster<i16>>,
    /// The metrics that levels are too coarse for or that have a history, [`EXACT`], of every region: those of
    /// [`Region::ALL`], those that the scene names, and those of [`MovingRegion::ALL`] in a world that moves.
    pub exact: Vec<[Option<f64>; EXACT.len()]>,
}

/// Names of the metrics that frames hold, as crate `score` has them.
pub const EXACT: [&str; 3] = ["log_loss", "brier", "retention"];

/// What maps are held against: the same for every mapper.
pub struct Judge<'a> {
    /// Occupied, free, or not known.
    pub truth: &'a Raster<Option<bool>>,
    /// The part of the map that each cell belongs to at the moment, see [`parts`].
    pub parts: &'a Raster<Option<Region>>,
    /// The regions that the scene names.
    pub named: &'a [Raster<bool>],
    /// The regions of a world that moves at the moment, see [`moving_regions`].
    pub moving: Option<&'a Raster<u8>>,
}

/// The four regions that no cell is in two of; the others are made of them.
pub const PARTS: [Region; 4] = [Region::Visible, Region::Surface, Region::Shell, Region::Hidden];

/// The part that each cell belongs to; none where the truth is not known.
pub fn parts(seen: &score::Sightings) -> Raster<Option<Region>> {
    let spec = *seen.looks().spec();
    let part = |cell| PARTS.into_iter().find(|region| seen.contains(*region, cell));
    Raster::new(spec, (0..spec.cells()).map(part).collect())
}

/// The regions of [`MovingRegion::ALL`] that each cell belongs to at the moment: bit k for the k-th.
pub fn moving_regions(moving: &Moving) -> Raster<u8> {
    let spec = *moving.truth().spec();
    let bits = |cell| {
        let inside = |(k, region): (usize, &MovingRegion)| u8::from(moving.contains(*region, cell)) << k;
        MovingRegion::ALL.iter().enumerate().map(inside).sum()
    };
    Raster::new(spec, (0..spec.cells()).map(bits).collect())
}

/// The levels of a map that had others before, if any.
pub fn in_levels(map: &Raster<f64>, former: Option<&Raster<u8>>) -> Raster<u8> {
    let level = |(cell, p): (usize, &f64)| levels().of(*p, former.map(|former| former[cell]));
    Raster::new(*map.spec(), map.values().iter().enumerate().map(level).collect())
}

/// A map in [`fine`] steps of log odds.
pub fn in_fine_steps(map: &Raster<f64>) -> Raster<i16> {
    map.map(|p| fine(*p))
}

/// Sums over cells.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    cells: usize,
    log_loss: f64,
    squared_error: f64,
    kept: usize,
    lost: usize,
}

impl Sums {
    fn and(self, other: Self) -> Self {
        Self {
            cells: self.cells + other.cells,
            log_loss: self.log_loss + other.log_loss,
            squared_error: self.squared_error + other.squared_error,
            kept: self.kept + other.kept,
            lost: self.lost + other.lost,
        }
    }

    fn metrics(self) -> [Option<f64>; EXACT.len()] {
        let mean = |sum: f64, count: usize| (count > 0).then(|| sum / count as f64);
        let once_free = self.kept + self.lost;
        [mean(self.log_loss, self.cells), mean(self.squared_error, self.cells), mean(self.kept as f64, once_free)]
    }
}

impl Judge<'_> {
    /// The metrics of [`EXACT`], a row per region; `retention` is none where a map has no history.
    pub fn exact(&self, map: &Raster<f64>, retention: Option<&Retention>) -> Vec<[Option<f64>; EXACT.len()]> {
        let mut by_part = [Sums::default(); PARTS.len()];
        let mut by_name = vec![Sums::default(); self.named.len()];
        let mut by_movement = vec![Sums::default(); self.moving.map_or(0, |_| MovingRegion::ALL.len())];
        for (cell, &p) in map.values().iter().enumerate() {
            let (Some(occupied), Some(part)) = (self.truth[cell], self.parts[cell]) else { continue };
            let clipped = p.clamp(score::threshold::CLIP, 1.0 - score::threshold::CLIP);
            let kept = retention.and_then(|retention| retention.kept(cell));
            let sums = Sums {
                cells: 1,
                log_loss: -libm::log(if occupied { clipped } else { 1.0 - clipped }),
                squared_error: (p - f64::from(u8::from(occupied))).powi(2),
                kept: usize::from(kept == Some(true)),
                lost: usize::from(kept == Some(false)),
            };
            let place = PARTS.iter().position(|region| *region == part).unwrap_or(0);
            by_part[place] = by_part[place].and(sums);
            for (of_name, _) in by_name.iter_mut().zip(self.named).filter(|(_, mask)| mask[cell]) {
                *of_name = of_name.and(sums);
            }
            let bits = self.moving.map_or(0, |moving| moving[cell]);
            for (_, of_region) in by_movement.iter_mut().enumerate().filter(|(k, _)| bits >> k & 1 == 1) {
                *of_region = of_region.and(sums);
            }
        }
        let by_rays = Region::ALL.iter().map(|region| {
            let of_region = PARTS.iter().zip(by_part).filter(|(part, _)| holds(*region, **part));
            of_region.fold(Sums::default(), |all, (_, sums)| all.and(sums))
        });
        by_rays.chain(by_name).chain(by_movement).map(Sums::metrics).collect()
    }
}

/// Whether a region holds the cells of a part.
fn holds(region: Region, part: Region) -> bool {
    match region {
        Region::All => true,
        Region::Observable => matches!(part, Region::Visible | Region::Surface),
        one => one == part,
    }
}
