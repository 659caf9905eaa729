//! The rays of the last scans, as a map's changes see them: by ray and by cell.

use std::collections::VecDeque;
use std::ops::Range;

use sensor::lanes::{LANES, Lanes, each};

use crate::memory::Held;

/// A ray through a cell, as long as the window moves on.
#[derive(Debug, Clone, Copy)]
struct Numbered {
    /// Number of the ray, which wraps after 2^32; see [`Rays::place`].
    ray: u32,
    /// As those of a [`Crossing`].
    step: u32,
    log: f32,
}

/// A ray through a cell, as long as the window stays as it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Place of the ray among those of the window.
    pub(super) place: u32,
    /// The cell is the so many-th of the ray, from 0.
    pub(super) step: u32,
    /// What the ray is worth if the cell is its first occupied one, nats.
    pub(super) log: f32,
}

/// What was read at one time, one ray after the other, each from the sensor on.
#[derive(Debug, Clone, Default)]
pub(super) struct Moment {
    cells: Vec<u32>,
    /// What a ray is worth if its first occupied cell is this one, nats; one per entry of `cells`.
    log: Vec<f32>,
    /// What a ray is worth if none of its cells is occupied, nats; one per ray.
    none: Vec<f32>,
    /// End of every ray in `cells`.
    ends: Vec<u32>,
    /// What each entry's flip from free to occupied has gained, nats, summed over maps and looks.
    gained: Vec<f32>,
    looks: u32,
}

impl Moment {
    /// Adds a ray.
    pub(super) fn push(&mut self, cells: &[usize], log: impl ExactSizeIterator<Item = f32>, none: f32) {
        debug_assert_eq!(cells.len(), log.len(), "one value per cell");
        // GridSpec::MAX_CELLS fits a u32.
        self.cells.extend(cells.iter().map(|&cell| cell as u32));
        self.log.extend(log);
        self.none.push(none);
        self.ends.push(self.cells.len() as u32);
        self.gained.resize(self.cells.len(), 0.0);
    }

    /// Number of rays.
    pub(super) fn rays(&self) -> usize {
        self.ends.len()
    }

    fn span(&self, ray: usize) -> Range<usize> {
        let start = if ray == 0 { 0 } else { self.ends[ray - 1] as usize };
        start..self.ends[ray] as usize
    }

    /// Looks at what flips would gain in maps of which the nearest occupied cells of every ray are known.
    #[inline(always)]
    fn look(&mut self, nearest: &[Nearest]) {
        self.looks += 1;
        for (ray, nearest) in nearest.iter().enumerate() {
            let span = self.span(ray);
            let farthest = nearest.first.iter().copied().max().unwrap_or_default() as usize;
            let seen = span.start..span.end.min(span.start + farthest + 1);
            for (step, (gained, &log)) in self.gained[seen.clone()].iter_mut().zip(&self.log[seen]).enumerate() {
                *gained += nearest.gain(step as u32, log).iter().sum::<f32>();
            }
        }
    }

    /// Cells with the mean over looks and maps of what their flips from free to occupied would gain, nats.
    pub(super) fn gains(&self) -> impl Iterator<Item = (usize, f32)> {
        let share = 1.0 / (self.looks.max(1) * LANES as u32) as f32;
        self.cells.iter().zip(&self.gained).map(move |(&cell, gained)| (cell as usize, gained * share))
    }
}

/// The first two occupied cells of a ray in every map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// The first; the number of the ray's cells if there is none.
    pub(super) first: Lanes<u32>,
    /// The second, in the same way.
    pub(super) second: Lanes<u32>,
    /// What the ray is worth, nats ...
    pub(super) value: Lanes<f32>,
    /// ... and without the first of them.
    pub(super) without: Lanes<f32>,
}

impl Nearest {
    /// How much more the ray is worth where one of its cells is occupied than where it is free, nats, given what it is worth if the cell is
    /// the first occupied one.
    #[inline(always)]
    pub(super) fn gain(&self, step: u32, log: f32) -> Lanes<f32> {
        let Self { first, value, without, .. } = self;
        let fills = each(|l| if step < first[l] { log - value[l] } else { 0.0 });
        each(|l| if step == first[l] { value[l] - without[l] } else { fills[l] })
    }
}

/// The rays of the last scans.
#[derive(Debug, Clone)]
pub(super) struct Rays {
    moments: VecDeque<Moment>,
    /// Moment, by a number that wraps, and ray in it; one per ray.
    index: VecDeque<[u32; 2]>,
    /// Number of the first ray and of the first moment.
    begins: [u32; 2],
    through: Vec<VecDeque<Numbered>>,
}

impl Rays {
    /// No ray yet, over a map of so many cells.
    pub(super) fn new(cells: usize) -> Self {
        Self { moments: VecDeque::new(), index: VecDeque::new(), begins: [0; 2], through: vec![VecDeque::new(); cells] }
    }

    /// The same with another number for the first ray and the first moment.
    #[cfg(test)]
    pub(super) fn numbered_from(cells: usize, number: u32) -> Self {
        Self { begins: [number; 2], ..Self::new(cells) }
    }

    /// Number of moments.
    pub(super) fn moments(&self) -> usize {
        self.moments.len()
    }

    /// Number of rays.
    pub(super) fn count(&self) -> usize {
        self.index.len()
    }

    /// Place of a ray among those of the window, by its number.
    fn place(&self, ray: u32) -> u32 {
        ray.wrapping_sub(self.begins[0])
    }

    /// Number of a ray, by its place.
    fn number(&self, place: usize) -> u32 {
        self.begins[0].wrapping_add(place as u32)
    }

    /// Takes in what was read at one time.
    pub(super) fn add(&mut self, moment: Moment) {
        let number = self.begins[1].wrapping_add(self.moments.len() as u32);
        for ray in 0..moment.rays() {
            let id = self.number(self.count());
            for (step, entry) in moment.span(ray).enumerate() {
                let crossing = Numbered { ray: id, step: step as u32, log: moment.log[entry] };
                self.through[moment.cells[entry] as usize].push_back(crossing);
            }
            self.index.push_back([number, ray as u32]);
        }
        self.moments.push_back(moment);
    }

    /// Lets the oldest moment go.
    pub(super) fn leave(&mut self) -> Option<Moment> {
        let moment = self.moments.pop_front()?;
        // Rays are in their order in every cell.
        for &cell in &moment.cells {
            self.through[cell as usize].pop_front();
        }
        self.index.drain(..moment.rays());
        let [rays, moments] = self.begins;
        self.begins = [rays.wrapping_add(moment.rays() as u32), moments.wrapping_add(1)];
        Some(moment)
    }

    /// Looks at the gains of flips on the rays of the older half of a full window of so many moments, every moment once in so many calls.
    pub(super) fn look(&mut self, nearest: &[Nearest], full: usize, every: u32) {
        let older = self.moments.len().saturating_sub(full / 2);
        let (newest, mut ray) = (self.begins[1].wrapping_add(self.moments.len() as u32), 0);
        for (age, moment) in self.moments.iter_mut().take(older).enumerate() {
            let number = self.begins[1].wrapping_add(age as u32);
            if newest.wrapping_sub(number).is_multiple_of(every) {
                moment.look(&nearest[ray..ray + moment.rays()]);
            }
            ray += moment.rays();
        }
    }

    /// Cells of a ray by its place, nearest first.
    pub(super) fn cells(&self, place: usize) -> &[u32] {
        let [moment, ray] = self.index[place];
        let moment = &self.moments[moment.wrapping_sub(self.begins[1]) as usize];
        &moment.cells[moment.span(ray as usize)]
    }

    /// What a ray is worth if this is its first occupied cell, or none is at the end of its cells, nats.
    pub(super) fn value(&self, place: usize, step: usize) -> f32 {
        let [moment, ray] = self.index[place];
        let moment = &self.moments[moment.wrapping_sub(self.begins[1]) as usize];
        let span = moment.span(ray as usize);
        if step < span.len() { moment.log[span.start + step] } else { moment.none[ray as usize] }
    }

    /// Number of rays through a cell.
    pub(super) fn crossings(&self, cell: usize) -> usize {
        self.through[cell].len()
    }

    /// Appends the rays through a cell, oldest first, by their places.
    #[inline(always)]
    pub(super) fn gather(&self, cell: usize, crossings: &mut Vec<Crossing>) {
        let placed = |&Numbered { ray, step, log }: &Numbered| Crossing { place: self.place(ray), step, log };
        let (older, newer) = self.through[cell].as_slices();
        crossings.extend(older.iter().map(placed));
        crossings.extend(newer.iter().map(placed));
    }
}

impl Held for Moment {
    fn held(&self) -> usize {
        self.cells.held() + self.log.held() + self.none.held() + self.ends.held() + self.gained.held()
    }
}

impl Held for Rays {
    fn held(&self) -> usize {
        let through: usize = self.through.iter().map(|rays| rays.capacity() * size_of::<Numbered>()).sum();
        let index = self.index.capacity() * size_of::<[u32; 2]>();
        self.moments.iter().map(Held::held).sum::<usize>() + index + through + self.through.held()
    }
}
