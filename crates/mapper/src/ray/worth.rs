//! What a reading is worth by the first occupied cell of its ray: what samplers of whole maps weigh.

use grid::{DigitalLine, GridSpec};

use crate::ray::surface::{Course, Surface};

/// A likelihood below this share of the ray's largest counts as this: it keeps logarithms finite.
const LEAST: f64 = 1e-12;

/// Chance that a ray that has passed its first occupied cell passes the next one too.
const GOES_ON: f64 = 0.7;

/// What a reading says, beyond the likelihood of its sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reading {
    /// Weight of its log likelihood, above 0.
    pub(crate) weight: f64,
    /// Share of rays that pass the first occupied cell, of which they see a part, 0 up to but not including 1.
    pub(crate) leak: f64,
}

/// A ray over a map, and the likelihoods of its reading, per unit of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Explained<'a> {
    /// Its cells, nearest first, at least one.
    pub(crate) line: &'a DigitalLine,
    /// Its direction, a unit vector.
    pub(crate) direction: [f64; 2],
    /// `P(o | F_k)` of every cell.
    pub(crate) likelihood: &'a [f64],
    /// `P(o | no cell of the ray is occupied)`.
    pub(crate) none: f64,
}

/// Weighs readings. Buffers to fill again and again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Worth {
    surface: Surface,
    met: Vec<f64>,
}

impl Worth {
    /// Writes what a ray is worth by its first occupied cell, nats, up to what all maps share, and returns what it is worth if there is none.
    /// Likelihoods that differ by a share of no more than `alike` get one logarithm.
    ///
    /// A cell is occupied where a wall covers it in part, and rays pass it then, most of all those that graze the wall: with the chance
    /// [`Reading::leak`] the ray ends in one of the cells behind, in the next with the chance 0.3, in the one after that with 0.7 times 0.3,
    /// and so on, whatever stands there. A reading that no map explains says nothing.
    pub(crate) fn of(
        &mut self,
        reading: &Reading,
        spec: &GridSpec,
        ray: &Explained,
        alike: f64,
        log: &mut Vec<f64>,
    ) -> f64 {
        let Self { surface, met } = self;
        let &Reading { weight, leak } = reading;
        let &Explained { line, direction, likelihood, none } = ray;
        let most = likelihood.iter().copied().fold(none, f64::max);
        let of = |l: f64| if most > 0.0 { weight * libm::log((l / most).max(LEAST)) } else { 0.0 };
        let cells = line.cells();
        // Cells are numbered row by row.
        let is_beside = |cell: usize| spec.width > 1 && cells[cell].abs_diff(cells[cell - 1]) == 1;
        let course = Course { ranges_m: line.ranges(), direction, cell_m: spec.cell_m };
        surface.likelihoods(&course, is_beside, likelihood, none, met);
        // What a ray ends in that passes its first occupied cell: most likely one of the next.
        let (mut after, mut last) = (none, None);
        log.clear();
        for (&l, &met) in likelihood.iter().zip(&*met).rev() {
            let value = (1.0 - leak) * met + leak * after;
            let is_alike = |(of, _): &(f64, f64)| (value - of).abs() <= alike * value;
            let (of_value, worth) = last.filter(is_alike).unwrap_or_else(|| (value, of(value)));
            last = Some((of_value, worth));
            log.push(worth);
            after = GOES_ON * after + (1.0 - GOES_ON) * l;
        }
        log.reverse();
        of(none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SPEC: GridSpec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 9, height: 7 };

    proptest! {
        /// By where a ray ends, term by term.
        #[test]
        fn it_is_the_sum_over_where_a_ray_ends(
            angle in 0.0f64..6.2, likelihood in prop::collection::vec(0.0f64..3.0, 17), weight in 0.1f64..1.0, leak in 0.0f64..0.9,
        ) {
            let (mut line, direction) = (DigitalLine::default(), [angle.cos(), angle.sin()]);
            line.trace(&SPEC, [0.43, 0.36], direction, f64::INFINITY);
            let (likelihood, none) = (&likelihood[..line.len()], likelihood[16]);
            let ray = Explained { line: &line, direction, likelihood, none };
            let (mut worth, mut log, mut coarse) = (Worth::default(), Vec::new(), Vec::new());
            let reading = Reading { weight, leak };
            let of_none = worth.of(&reading, &SPEC, &ray, 0.0, &mut log);
            let most = likelihood.iter().copied().fold(none, f64::max);
            let of = |l: f64| weight * (l / most).max(LEAST).ln();
            prop_assert!((of_none - of(none)).abs() < 1e-12);
            prop_assert_eq!(log.len(), line.len());
            for (first, log) in log.iter().enumerate() {
                let (mut value, mut passes) = ((1.0 - leak) * worth.met[first], leak);
                for l in &likelihood[first + 1..] {
                    value += (1.0 - GOES_ON) * passes * l;
                    passes *= GOES_ON;
                }
                value += passes * none;
                prop_assert!((log - of(value)).abs() < 1e-9, "cell {first}: {log}, {}", of(value));
            }
            worth.of(&reading, &SPEC, &ray, 1e-2, &mut coarse);
            prop_assert!(log.iter().zip(&coarse).all(|(log, coarse)| (log - coarse).abs() < 1.02e-2 * weight));
        }
    }

    #[test]
    fn a_reading_that_no_map_explains_says_nothing() {
        let mut line = DigitalLine::default();
        line.trace(&SPEC, [0.43, 0.36], [1.0, 0.0], f64::INFINITY);
        let ray = Explained { line: &line, direction: [1.0, 0.0], likelihood: &vec![0.0; line.len()], none: 0.0 };
        let (reading, mut log) = (Reading { weight: 1.0, leak: 0.1 }, Vec::new());
        let none = Worth::default().of(&reading, &SPEC, &ray, 0.0, &mut log);
        assert!(none == 0.0 && log.iter().all(|log| *log == 0.0));
    }
}
