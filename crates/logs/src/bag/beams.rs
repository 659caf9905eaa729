//! Messages as beams: bearings and readings.

use bags::messages::{DisparityImage, Image, LaserScan};

use crate::options::Options;
use crate::ranges::{Rule, disparity};
use crate::report::Report;

/// Bearings (rad) and readings of a scan, as it was taken.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Beams {
    pub(super) bearings_rad: Vec<f64>,
    pub(super) readings: Vec<Option<f64>>,
    /// What the message said, for the check of units.
    pub(super) raw: Vec<f64>,
}

/// No scanner has more beams.
const MOST_BEAMS: usize = 100_000;

/// A full turn and what rounding does to it, rad.
const TURN_RAD: f64 = std::f64::consts::TAU + 0.02;

/// Beams of a laser, and from which range on there is no echo, m.
pub(super) fn laser(scan: &LaserScan, options: &Options, report: &mut Report) -> Result<(Beams, f64), String> {
    let LaserScan { first_rad, step_rad, min_m, max_m, ranges_m, .. } = scan;
    let count = ranges_m.len();
    if count == 0 || count > MOST_BEAMS {
        return Err(format!("a scan of {count} ranges, which must be 1 to {MOST_BEAMS}"));
    }
    let long_rad = step_rad * (count - 1) as f64;
    if !first_rad.is_finite() || !step_rad.is_finite() || (count > 1 && step_rad.abs() <= 0.0) {
        return Err(format!(
            "angle_min is {first_rad} and angle_increment {step_rad}, which must be numbers, the latter not 0"
        ));
    }
    if first_rad.abs() > TURN_RAD || long_rad.abs() > TURN_RAD {
        return Err(format!(
            "its {count} beams begin at {first_rad:.3} and turn by {long_rad:.3} rad, more than a full turn: are its angles in degrees?"
        ));
    }
    let stated = Some(*max_m).filter(|max| *max > 0.0 && max.is_finite());
    let rule = Rule::new(options, stated);
    let least_m = min_m.max(rule.min_m);
    let reading = |range: f64| {
        // A range beyond what the scanner measures says nothing (REP 117), unless an option says what it is.
        let is_beyond = options.max_range_m.is_none() && range.is_finite() && stated.is_some_and(|max| range > max);
        (range >= least_m && !is_beyond).then(|| rule.reading(range)).flatten()
    };
    let beyond =
        |range: &&f64| options.max_range_m.is_none() && range.is_finite() && stated.is_some_and(|max| **range > max);
    report.beyond_maximum += ranges_m.iter().filter(beyond).count() as u64;
    let beams = Beams {
        bearings_rad: (0..count).map(|k| first_rad + k as f64 * step_rad).collect(),
        readings: ranges_m.iter().map(|range| reading(*range)).collect(),
        raw: ranges_m.iter().copied().filter(|range| range.is_finite()).collect(),
    };
    Ok((beams, rule.max_m))
}

/// The camera whose image is turned into beams.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    /// Focal length, px.
    pub(super) focal_px: f64,
    /// Column and row of its axis; the middle where that is not known.
    pub(super) centre_px: Option<[f64; 2]>,
    /// Rows of which the nearest is taken.
    pub(super) rows: usize,
}

impl Columns {
    /// The rows about the axis, as many as there are.
    fn band(&self, image: &Image<'_>) -> std::ops::Range<usize> {
        let middle = self.centre(image)[1].round().clamp(0.0, image.height.saturating_sub(1) as f64) as usize;
        let first = middle.saturating_sub((self.rows - 1) / 2);
        first..(first + self.rows).min(image.height)
    }

    fn centre(&self, image: &Image<'_>) -> [f64; 2] {
        let middle = |size: usize| 0.5 * (size as f64 - 1.0);
        self.centre_px.unwrap_or([middle(image.width), middle(image.height)])
    }

    /// Bearings of the columns, rad counter-clockwise: the first column looks to the left.
    fn bearings(&self, image: &Image<'_>) -> Result<Vec<f64>, String> {
        if image.width == 0 || image.height == 0 || image.width > MOST_BEAMS {
            return Err(format!(
                "an image of {} columns and {} rows, which must be 1 to {MOST_BEAMS} columns and a row or more",
                image.width, image.height
            ));
        }
        let centre = self.centre(image)[0];
        Ok((0..image.width).map(|column| libm::atan2(centre - column as f64, self.focal_px)).collect())
    }

    fn read(
        &self,
        image: &Image<'_>,
        rows: &[Vec<f64>],
        options: &Options,
        report: &mut Report,
    ) -> Result<Beams, String> {
        let bearings_rad = self.bearings(image)?;
        // The nearest has the largest disparity; what is no number is no match.
        let nearest = |column: usize| rows.iter().map(|row| row[column]).fold(f64::NAN, f64::max);
        let raw: Vec<f64> = (0..image.width).map(nearest).collect();
        let read = |value: &f64| disparity(Some(*value), options.max_disparity_px, &mut report.codes);
        let readings = raw.iter().map(read).collect();
        Ok(Beams { bearings_rad, readings, raw })
    }

    /// Beams of disparities, px.
    pub(super) fn disparities(
        &self,
        image: &DisparityImage<'_>,
        options: &Options,
        report: &mut Report,
    ) -> Result<Beams, String> {
        let rows = image.disparities_px(self.band(&image.image))?;
        self.read(&image.image, &rows, options, report)
    }

    /// Beams of depths, as disparities of a camera of this focal length times baseline, px·m.
    pub(super) fn depths(
        &self,
        image: &Image<'_>,
        focal_baseline: f64,
        options: &Options,
        report: &mut Report,
    ) -> Result<Beams, String> {
        let mut rows = image.depths_m(self.band(image))?;
        // No depth is NaN, inf (too far) or -inf (too near), by REP 117 and 118.
        let disparity = |depth: f64| if depth > 0.0 && depth.is_finite() { focal_baseline / depth } else { f64::NAN };
        rows.iter_mut().flatten().for_each(|depth| *depth = disparity(*depth));
        self.read(image, &rows, options, report)
    }
}
