//! What could be seen: the regions of a map, from noise-free rays.

use grid::{DigitalLine, Raster};

use crate::error::same_cells;
use crate::{Region, ScoreError};

/// How far behind a hit the shell reaches, m: half the paper's mean obstacle of 40 cm, so that the
/// shell of an obstacle lies mostly inside it and not in the room behind.
pub const SHELL_DEPTH_M: f64 = 0.2;

/// Hits often lie exactly on a grid line, since walls do; the cell hit is the one that holds the
/// point this far (m) behind the hit. For the same reason a ray that runs through a cell for no
/// more than this has touched, not crossed it. Far above rounding, far below any cell.
pub const NUDGE_M: f64 = 1e-6;

/// One viewing ray, cast without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Where the ray starts, m.
    pub origin_m: [f64; 2],
    /// Unit vector along the ray.
    pub direction: [f64; 2],
    /// Range of the first hit, m; `None` where the ray hits nothing up to the border of the map.
    pub range_m: Option<f64>,
}

/// What the rays so far could see. Their order does not matter in a world at rest; see [`set_truth`](Self::set_truth) for one that moves.
#[derive(Debug, Clone)]
pub struct Sightings {
    truth: Raster<Option<bool>>,
    visible: Raster<bool>,
    surface: Raster<bool>,
    behind: Raster<bool>,
    looks: Raster<u32>,
    nearest_m: Raster<f64>,
    hits_without_surface: usize,
    line: DigitalLine,
}

impl Sightings {
    /// Nothing seen yet of a world: `Some(true)` occupied, `Some(false)` free, `None` not known.
    pub fn new(truth: &Raster<Option<bool>>) -> Self {
        let spec = *truth.spec();
        Self {
            truth: truth.clone(),
            visible: Raster::filled(spec, false),
            surface: Raster::filled(spec, false),
            behind: Raster::filled(spec, false),
            looks: Raster::filled(spec, 0),
            nearest_m: Raster::filled(spec, f64::INFINITY),
            hits_without_surface: 0,
            line: DigitalLine::default(),
        }
    }

    /// The world has moved: from now on its cells are as `truth` says. A cell whose state is another one than before has not been
    /// seen in it: it is neither visible nor surface until a ray finds it anew. What lay behind a hit, the number of looks and the nearest of them stay as they were.
    ///
    /// So in a world that moves *visible* are the free cells that some ray has crossed since they became free, and *surface* the occupied cells
    /// that some ray has hit first since they became occupied, whatever stands there; the order of calls matters, that of the rays between them does not.
    ///
    /// # Errors
    /// A truth of another geometry.
    pub fn set_truth(&mut self, truth: &Raster<Option<bool>>) -> Result<(), ScoreError> {
        same_cells("truth of the moment", truth.spec(), self.truth.spec())?;
        for cell in 0..truth.spec().cells() {
            if self.truth[cell] != truth[cell] {
                self.truth[cell] = truth[cell];
                (self.visible[cell], self.surface[cell]) = (false, false);
            }
        }
        Ok(())
    }

    /// Marks what one ray could see. A ray from outside the map sees nothing of it.
    ///
    /// # Panics
    /// If the range is negative or not a number: the cast that gave it is broken.
    pub fn add(&mut self, sight: &Sight) {
        self.add_within(sight, f64::INFINITY);
    }

    /// The same of a ray that sees no farther than `reach_m` (m): what it hits beyond is not seen.
    ///
    /// # Panics
    /// As [`add`](Self::add).
    pub fn add_within(&mut self, sight: &Sight, reach_m: f64) {
        let range_m = sight.range_m.unwrap_or(f64::INFINITY);
        assert!(range_m >= 0.0, "the ray from {:?} m has the range {range_m} m", sight.origin_m);
        let (is_hit, hit) = (sight.range_m.is_some() && range_m <= reach_m, range_m.min(reach_m));
        self.line.trace(self.truth.spec(), sight.origin_m, sight.direction, hit + SHELL_DEPTH_M);
        let mut behind_surface = false;
        let mut reached = false;
        for (&cell, chord) in self.line.cells().iter().zip(self.line.ranges().windows(2)) {
            let (enter, exit) = (chord[0], chord[1]);
            if reached {
                self.behind[cell] |= behind_surface && exit - enter > NUDGE_M;
                continue;
            }
            let crossed = exit.min(hit) - enter > NUDGE_M;
            self.visible[cell] |= crossed && self.truth[cell] == Some(false);
            // The first cell that ends behind the nudged hit holds it. Rounding, or a truth that
            // counts a partly covered cell as free, can leave the hit without a surface.
            reached = exit >= hit + NUDGE_M;
            let hits = reached && is_hit;
            behind_surface = hits && self.truth[cell] == Some(true);
            self.surface[cell] |= behind_surface;
            self.hits_without_surface += usize::from(hits && !behind_surface);
            if crossed || behind_surface {
                self.looks[cell] += 1;
                self.nearest_m[cell] = self.nearest_m[cell].min(enter);
            }
        }
    }

    /// Whether a cell belongs to a region.
    pub fn contains(&self, region: Region, cell: usize) -> bool {
        let observable = self.visible[cell] || self.surface[cell];
        let unseen = self.truth[cell].is_some() && !observable;
        match region {
            Region::Visible => self.visible[cell],
            Region::Surface => self.surface[cell],
            Region::Shell => unseen && self.behind[cell],
            Region::Hidden => unseen && !self.behind[cell],
            Region::Observable => observable,
            Region::All => self.truth[cell].is_some(),
        }
    }

    /// The cells of a region, from all rays so far.
    pub fn mask(&self, region: Region) -> Raster<bool> {
        let spec = *self.truth.spec();
        Raster::new(spec, (0..spec.cells()).map(|cell| self.contains(region, cell)).collect())
    }

    /// The mask of [`Region::Visible`] without a copy, for [`Retention`](crate::Retention).
    pub fn visible(&self) -> &Raster<bool> {
        &self.visible
    }

    /// The mask of [`Region::Surface`] without a copy, for [`Scorer`](crate::Scorer).
    pub fn surface(&self) -> &Raster<bool> {
        &self.surface
    }

    /// How many rays crossed each cell or hit it first.
    pub fn looks(&self) -> &Raster<u32> {
        &self.looks
    }

    /// The least range, m, at which a ray that crossed a cell or hit it first entered it: zero where
    /// a sensor stood, infinity where no ray looked.
    pub fn nearest_m(&self) -> &Raster<f64> {
        &self.nearest_m
    }

    /// The observable cells that some ray entered at no more than `range_m`.
    pub fn seen_within(&self, range_m: f64) -> Raster<bool> {
        let near = |cell| self.contains(Region::Observable, cell) && self.nearest_m[cell] <= range_m;
        Raster::new(*self.truth.spec(), (0..self.truth.spec().cells()).map(near).collect())
    }

    /// Number of hits inside the map whose cell is not truly occupied, so that they made neither
    /// surface nor shell. More than a few mean that the truth and the casts do not agree.
    pub fn hits_without_surface(&self) -> usize {
        self.hits_without_surface
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{CELL_M, drawn, picture};

    const RIGHT: [f64; 2] = [1.0, 0.0];
    const LEFT: [f64; 2] = [-1.0, 0.0];
    const UP: [f64; 2] = [0.0, 1.0];

    fn sight(x: f64, y: f64, direction: [f64; 2], range_m: impl Into<Option<f64>>) -> Sight {
        Sight { origin_m: [x, y], direction, range_m: range_m.into() }
    }

    fn seen(world: &[&str], sights: &[Sight]) -> Sightings {
        let mut sightings = Sightings::new(&drawn(world));
        sights.iter().for_each(|s| sightings.add(s));
        sightings
    }

    /// One letter per cell: v(isible), s(urface), b(ehind: shell), h(idden), ? (not known).
    fn regions(s: &Sightings) -> Vec<String> {
        let parts = [(Region::Visible, 'v'), (Region::Surface, 's'), (Region::Shell, 'b'), (Region::Hidden, 'h')];
        picture(s.truth.spec(), |cell| {
            let inside: Vec<char> = parts.iter().filter(|p| s.contains(p.0, cell)).map(|p| p.1).collect();
            assert!(inside.len() <= 1, "cell {cell} is in {inside:?}");
            assert_eq!(s.contains(Region::All, cell), !inside.is_empty());
            assert_eq!(s.contains(Region::Observable, cell), inside.iter().any(|c| "vs".contains(*c)));
            inside.first().copied().unwrap_or('?')
        })
    }

    fn looks(s: &Sightings) -> Vec<String> {
        picture(s.truth.spec(), |cell| char::from_digit(s.looks()[cell], 10).expect("below ten"))
    }

    // Cells of 0.1 m: the shell of 0.2 m is two cells, one of them the surface where the wall's face
    // is a grid line.

    #[test]
    fn a_hit_exactly_on_a_grid_line_belongs_to_the_cell_behind_it() {
        let s = seen(&["...##..."], &[sight(0.05, 0.05, RIGHT, 0.25)]);
        assert_eq!(regions(&s), ["vvvsbhhh"]);
        assert_eq!(looks(&s), ["11110000"]);
        // From the other side the same line would belong to the free cell.
        let s = seen(&["...##..."], &[sight(0.75, 0.05, LEFT, 0.25)]);
        assert_eq!(regions(&s), ["hhhbsvvv"]);
        assert_eq!(looks(&s), ["00001111"]);
    }

    #[test]
    fn rounding_of_the_hit_does_not_matter() {
        for error in [-1e-9, 1e-9] {
            let s = seen(&["...##..."], &[sight(0.05, 0.05, RIGHT, 0.25 + error)]);
            assert_eq!((regions(&s), looks(&s)), (vec!["vvvsbhhh".into()], vec!["11110000".into()]), "{error}");
        }
    }

    #[test]
    fn a_hit_inside_a_partly_covered_cell() {
        let s = seen(&["...##..."], &[sight(0.05, 0.05, RIGHT, 0.27)]);
        assert_eq!(regions(&s), ["vvvsbbhh"], "the shell starts at the hit, 0.32 to 0.52 m");
        assert_eq!(looks(&s), ["11110000"], "crossed and hit is one look");
    }

    #[test]
    fn no_hit_sees_to_the_border_and_only_free_cells() {
        let s = seen(&["..?.#..."], &[sight(0.05, 0.05, RIGHT, None)]);
        assert_eq!(regions(&s), ["vv?vhvvv"], "an occupied cell that a ray slips through is not seen");
        assert_eq!(looks(&s), ["11111111"]);
        assert_eq!(s.hits_without_surface(), 0);
    }

    #[test]
    fn a_ray_sees_as_far_as_it_reaches() {
        let within = |sight: Sight, reach_m: f64| {
            let mut s = Sightings::new(&drawn(&["...##..."]));
            s.add_within(&sight, reach_m);
            assert_eq!(s.hits_without_surface(), 0);
            regions(&s)[0].clone()
        };
        let (hits, passes) = (sight(0.05, 0.05, RIGHT, 0.25), sight(0.05, 0.05, RIGHT, None));
        assert_eq!(within(hits, 0.12), "vvhhhhhh", "nor is anything behind it a shell");
        assert_eq!(within(hits, 0.25), "vvvsbhhh");
        assert_eq!(within(passes, 0.12), "vvhhhhhh");
        assert_eq!(within(passes, f64::INFINITY), regions(&seen(&["...##..."], &[passes]))[0]);
    }

    #[test]
    fn a_hit_beyond_the_border_is_none_of_the_maps_cells() {
        let s = seen(&["...."], &[sight(0.05, 0.05, RIGHT, 0.35), sight(0.05, 0.05, RIGHT, 9.0)]);
        assert_eq!((regions(&s), looks(&s)), (vec!["vvvv".into()], vec!["2222".into()]));
        assert_eq!(s.hits_without_surface(), 0);
    }

    #[test]
    fn a_hit_in_a_cell_that_is_not_occupied_is_no_surface() {
        for world in ["......", "...?.."] {
            let s = seen(&[world], &[sight(0.05, 0.05, RIGHT, 0.25)]);
            assert_eq!(regions(&s)[0].replace('?', "h"), "vvvhhh", "neither surface nor shell");
            assert_eq!((looks(&s), s.hits_without_surface()), (vec!["111000".into()], 1));
        }
        let s = seen(&["......"], &[sight(0.05, 0.05, RIGHT, 0.27)]);
        assert_eq!(regions(&s), ["vvvvhh"], "what lies before the hit was crossed");
    }

    #[test]
    fn along_a_wall() {
        // The grid line between the rows belongs to the upper one.
        let along = sight(0.05, 0.1, RIGHT, None);
        assert_eq!(regions(&seen(&["....", "####"], &[along])), ["vvvv", "hhhh"]);
        let s = seen(&["####", "...."], &[along]);
        assert_eq!((regions(&s), looks(&s)), (vec!["hhhh".into(); 2], vec!["1111".into(), "0000".into()]));
        // A cast that stops at the wall's edge where the wall begins.
        assert_eq!(regions(&seen(&["..##", "...."], &[sight(0.0, 0.1, RIGHT, 0.2)])), ["vvsb", "hhhh"]);
    }

    #[test]
    fn a_ray_that_starts_on_a_grid_line_and_leaves_the_cell_at_once_has_not_crossed_it() {
        let s = seen(&["...."], &[sight(0.2, 0.05, LEFT, None)]);
        assert_eq!((regions(&s), looks(&s)), (vec!["vvhh".into()], vec!["1100".into()]));
    }

    #[test]
    fn a_ray_through_corners_crosses_the_diagonal_only() {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let s = seen(&["...", "...", "..."], &[sight(0.05, 0.05, [h, h], None)]);
        assert_eq!(regions(&s), ["hhv", "hvh", "vhh"]);
        // Into the corner of a block: the block's cell is hit although its neighbours touch the corner too.
        let s = seen(&["..#", "...", "..."], &[sight(0.05, 0.05, [h, h], 0.15 / h)]);
        assert_eq!(regions(&s), ["hhs", "hvh", "vhh"]);
    }

    #[test]
    fn the_shell_gives_way_to_what_another_ray_sees() {
        let world = ["......", "..#...", "......"];
        let ray = sight(0.05, 0.15, RIGHT, 0.15);
        assert_eq!(regions(&seen(&world, &[ray])), ["hhhhhh", "vvsbhh", "hhhhhh"]);
        let across = sight(0.35, 0.05, UP, None);
        for sights in [[ray, across], [across, ray]] {
            assert_eq!(regions(&seen(&world, &sights)), ["hhhvhh", "vvsvhh", "hhhvhh"]);
        }
        // The block's other side is a surface of its own.
        let back = sight(0.55, 0.15, LEFT, 0.25);
        let s = seen(&world, &[ray, back]);
        assert_eq!((regions(&s)[1].as_str(), looks(&s)[1].as_str()), ("vvsvvv", "112111"));
    }

    #[test]
    fn unknown_cells_are_in_no_region() {
        let s = seen(&["..#??."], &[sight(0.05, 0.05, RIGHT, 0.15)]);
        assert_eq!(regions(&s), ["vvs??h"]);
        for region in Region::ALL {
            let mask = s.mask(region);
            assert!(!mask[3] && !mask[4], "{region:?}");
            assert!((0..6).all(|cell| mask[cell] == s.contains(region, cell)));
        }
    }

    #[test]
    fn a_sensor_inside_an_obstacle_or_outside_the_map() {
        let s = seen(&[".##."], &[sight(0.15, 0.05, RIGHT, 0.0)]);
        assert_eq!((regions(&s), looks(&s)), (vec!["hsbb".into()], vec!["0100".into()]));
        let s = seen(&[".##."], &[sight(-0.05, 0.05, RIGHT, 0.15)]);
        assert_eq!((regions(&s), s.hits_without_surface()), (vec!["hhhh".into()], 0));
    }

    #[test]
    fn the_nearest_look_counts_from_where_the_ray_enters() {
        let far = sight(0.05, 0.05, RIGHT, 0.25);
        let centimetres =
            |s: &Sightings| s.nearest_m().values().iter().map(|m| (m * 100.0).round()).collect::<Vec<_>>();
        let none = f64::INFINITY;
        assert_eq!(centimetres(&seen(&["...#.."], &[far])), [0.0, 5.0, 15.0, 25.0, none, none]);
        let near = sight(0.15, 0.05, RIGHT, 0.15);
        for sights in [[far, near], [near, far]] {
            assert_eq!(centimetres(&seen(&["...#.."], &sights)), [0.0, 0.0, 5.0, 15.0, none, none]);
        }
    }

    #[test]
    fn what_has_changed_is_unseen_until_a_ray_finds_it_anew() {
        let ray = |range: f64| sight(0.05, 0.05, RIGHT, range);
        let mut s = seen(&["......."], &[sight(0.05, 0.05, RIGHT, None)]);
        let set = |s: &mut Sightings, world: &str| s.set_truth(&drawn(&[world])).expect("same cells");
        assert_eq!(regions(&s), ["vvvvvvv"]);
        set(&mut s, "...##..");
        assert_eq!(regions(&s), ["vvvhhvv"], "nobody has seen the thing that came");
        s.add(&ray(0.25));
        assert_eq!(regions(&s), ["vvvsbvv"], "hit first, and what is behind");
        set(&mut s, ".....##");
        assert_eq!(regions(&s), ["vvvhbhh"], "it has gone on; the shell behind it was free before it came");
        s.add(&ray(0.45));
        assert_eq!(regions(&s), ["vvvvvsb"]);
        assert_eq!(looks(&s), ["3333221"], "all that was looked at, in whatever state");
        assert!(s.set_truth(&drawn(&["."])).is_err());
    }

    #[test]
    fn within_a_range_are_the_cells_that_a_ray_entered_no_farther_away() {
        let s = seen(&["...#.."], &[sight(0.05, 0.05, RIGHT, 0.25)]);
        let within = |m: f64| s.seen_within(m).values().iter().filter(|near| **near).count();
        assert_eq!([0.0, 0.1, 0.2, 0.3, 9.0].map(within), [1, 2, 3, 4, 4]);
    }

    #[test]
    fn a_broken_range_is_refused() {
        for bad in [f64::NAN, -1e-9] {
            let broken = std::panic::catch_unwind(|| seen(&["..."], &[sight(0.05, 0.05, RIGHT, bad)]));
            assert!(broken.is_err(), "{bad}");
        }
    }

    #[test]
    fn the_drawings_have_the_shells_depth() {
        assert!((SHELL_DEPTH_M - 2.0 * CELL_M).abs() < 1e-15);
    }
}
