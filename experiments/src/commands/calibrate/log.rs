//! A log: the kernel and the prior under which every second scan is most likely by the map of the others.

use std::sync::Arc;

use grid::GridSpec;
use mapper::{Belief, FastVisibility, Model, Predictive, Prior};
use rayon::prelude::*;
use sensor::{Scan, SensorModel, Stereo};

use super::calibration::{Calibration, Found as Run};
use super::groups::{self, Group, thinned};
use super::kind::Kind;
use super::noise::{self, Noise, Surfaces};
use super::options::CalibrateOptions;
use super::outputs;
use super::search::{self, Fit, Found, Losses, Parameter};
use super::{advice, agreement, pixels, views};
use crate::failure::Failure;
use crate::jobs::progress::Count;
use crate::worlds::source::{Asked, Source};

/// What lies around the outermost poses and usual readings, m.
const MARGIN_M: f64 = 0.5;

/// Readings farther than this do not make the map larger, m.
const REACH_M: f64 = 15.0;

/// The search begins with one beam in so many.
const ROUGH: u32 = 4;

/// More cells than this take too long, and too much memory, for the hundreds of maps that a fit makes.
const MOST_CELLS: usize = 20_000_000;

/// Fits the kernel of whatever took the log, of several kinds of sensors that of each.
///
/// What a bag tells of its camera goes into the options. None where the topics of a bag were to be listed.
pub(super) fn calibrate(options: &mut CalibrateOptions) -> Result<Option<Run>, Failure> {
    let Some(source) = source(options)? else { return Ok(None) };
    let options = &*options;
    let (groups, left_out) = groups::read(options, &source)?;
    let (mut all, mut words) = (Vec::new(), Vec::new());
    for group in groups {
        let (calibration, kind) = fitted(group, options)?;
        let own = advice::options(&kind, options, source.is_bag(), &calibration.fit);
        all.push(Calibration { advice: advice::scene(&kind, &calibration.fit), ..calibration });
        words.extend(own);
    }
    Ok(Some(Run { all, left_out, advice: advice::replay(&words, options) }))
}

/// Fits a group.
fn fitted(group: Group, options: &CalibrateOptions) -> Result<(Calibration, Kind), Failure> {
    let Group { sensor, kind, scans: whole, runs } = group;
    let all_thinned = |beams: u32| -> Vec<Vec<Scan>> {
        let of = |scans: &Vec<Scan>| scans.iter().map(|scan| thinned(scan, beams as usize)).collect();
        whole.iter().map(of).collect()
    };
    let scans = all_thinned(options.beams);
    let flat: Vec<Scan> = scans.iter().flatten().cloned().collect();
    let grid = cover(&flat, &*kind.usual(), options)?;
    let readings = flat.iter().flat_map(|scan| scan.readings.iter().flatten()).count() as u64;
    let parameters = kind.parameters();
    let noise = kind.instrument().and_then(|instrument| noise::of(&flat, instrument, parameters[0].start));
    let known = noise.as_ref().map(|noise| noise.sigma);
    let sought = if known.is_some() { &parameters[1..] } else { &parameters[..] };
    let rough = all_thinned(options.beams.div_ceil(ROUGH));
    let losses = |scans: &[Vec<Scan>], values: &[f64]| -> Losses {
        let values: Vec<f64> = known.into_iter().chain(values.iter().copied()).collect();
        let (model, prior) = kind.setting(&values)?;
        Some(predicted(scans, grid, model, prior))
    };
    if kind.instrument().is_some() {
        tell_agreement(&whole, grid, &kind, options);
    }
    let progress = Count::settings();
    let of_rough = |values: &[f64]| losses(&rough, values);
    let rough: Option<&search::Loss> = if rough == scans { None } else { Some(&of_rough) };
    let fit = search::fit(sought, rough, &|values| losses(&scans, values), &|| progress.step());
    progress.finish();
    let mut fit = fit.ok_or_else(|| Failure::internal("no setting could be tried"))?;
    if let Some(noise) = &noise {
        fit.found.insert(0, found(&parameters[0], noise));
    }
    let mut notes = notes(&fit, noise.as_ref(), &kind, options.grid);
    if let Some(instrument) = kind.instrument() {
        let sigma = fit.found[0].value;
        let surfaces = Surfaces::of(&flat, instrument, sigma);
        if kind.has_pixels() {
            let has_angle = matches!(kind, Kind::Depth(_));
            let (of_pixels, why) = pixels::of(&flat, &surfaces, kind.max_range_m(), has_angle);
            notes.push(why);
            fit.found.extend(of_pixels);
        }
        let (lengths, of_views) = views::of(&runs, &surfaces, sigma);
        notes.push(of_views);
        fit.found.extend(lengths);
    }
    let which = sensor.map_or_else(String::new, |number| format!("sensor {number}, "));
    let about = format!(
        "{which}{} scans of {} in {}, {readings} readings",
        scans.len(),
        kind.called(),
        outputs::name(&options.file)
    );
    let calibration = Calibration {
        sensor,
        about,
        measure: "probability of every second scan by the map that visibility makes of the others",
        readings,
        picture: None,
        notes,
        advice: None,
        fit,
    };
    Ok((calibration, kind))
}

/// The log, opened once; what a bag tells of its camera is taken.
fn source(options: &mut CalibrateOptions) -> Result<Option<Source>, Failure> {
    let asked = Asked {
        command: "calibrate",
        path: &options.file,
        bag: &options.bag,
        trajectory: None,
        body: logs::Body::Robot,
        focal_baseline: options.focal_baseline,
        given: &options.given,
    };
    let Some(source) = Source::open(&asked)? else { return Ok(None) };
    let mut most = options.max_disparity.unwrap_or(Stereo::default().max_disparity);
    let usual = most;
    source.adapt(&options.given, &mut options.focal_baseline, &mut most);
    if most.total_cmp(&usual).is_ne() {
        options.max_disparity = Some(most);
    }
    Ok(Some(source))
}

fn cover(scans: &[Scan], sensor: &dyn SensorModel, options: &CalibrateOptions) -> Result<GridSpec, Failure> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut include = |at: [f64; 2]| {
        low = [0, 1].map(|k| low[k].min(at[k] - MARGIN_M));
        high = [0, 1].map(|k| high[k].max(at[k] + MARGIN_M));
    };
    for scan in scans {
        include(scan.pose.position_m());
        for ray in scan.rays() {
            let range = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            if let Some(range_m) = range.filter(|range| *range < REACH_M) {
                include([0, 1].map(|k| ray.origin_m[k] + range_m * ray.direction[k]));
            }
        }
    }
    let place = options.file.display();
    let grid = GridSpec::covering(low, high, options.grid)
        .map_err(|error| Failure::BadInput(format!("{place}: the map of the log: {error}")))?;
    if grid.cells() > MOST_CELLS {
        let what = format!("the map has {} cells, more than {MOST_CELLS}; use larger cells (--grid)", grid.cells());
        return Err(Failure::BadInput(format!("{place}: {what}")));
    }
    agreement::refuse_too_large(&place.to_string(), grid)?;
    Ok(grid)
}

/// Says how far the scans agree with a map of each other, by the usual kernel: a fitted one would excuse what is wrong.
fn tell_agreement(scans: &[Vec<Scan>], grid: GridSpec, kind: &Kind, options: &CalibrateOptions) {
    let scans: Vec<Scan> = scans.iter().flatten().cloned().collect();
    let place = options.file.display().to_string();
    agreement::tell(&place, &scans, grid, kind.usual(), Prior::default(), kind.spread());
}

/// `-ln P` of every second scan by the map of the others, and its number of readings.
fn predicted(scans: &[Vec<Scan>], grid: GridSpec, sensor: Arc<dyn SensorModel>, prior: Prior) -> Vec<(f64, u64)> {
    let setup = Model { prior, ..Model::new(grid, Arc::clone(&sensor)) };
    let mut map = FastVisibility::visibility(&setup);
    scans.iter().step_by(2).for_each(|scans| map.integrate_together_on(scans, 1));
    let pairs = map.pairs();
    let loss = |scans: &Vec<Scan>| {
        let mut predictive = Predictive::new(grid, &*sensor, prior.onset(grid.cell_m));
        let (mut sum, mut readings) = (0.0, 0);
        for ray in scans.iter().flat_map(Scan::rays) {
            if predictive.take(&ray) {
                sum += predictive.log_loss(Belief::Chain(&pairs));
                readings += 1;
            }
        }
        (sum, readings)
    };
    scans.par_iter().skip(1).step_by(2).map(loss).collect()
}

fn notes(fit: &Fit, noise: Option<&Noise>, kind: &Kind, cell_m: f64) -> Vec<String> {
    let mut notes = Vec::new();
    let value = |name: &str| fit.found.iter().find(|found| found.parameter.name == name).map(|found| found.value);
    if let (Some(prior), Some(correlation)) = (value("prior"), value("correlation")) {
        // c(d) = exp(-d / ((1 - p) L)).
        let length_m = -Prior::REFERENCE_M / ((1.0 - prior) * libm::log(correlation));
        notes.push(format!("the prior and the correlation are those of obstacles {length_m:.2} m long on average, as the sensor sees them"));
    }
    let sigma = fit.found[0].parameter.name;
    match noise {
        Some(noise) => notes.push(format!(
            "{sigma} is that of {} readings about straight pieces of surface, fitted to the other half of the scans; the rest is by maps with it",
            noise.readings
        )),
        None if matches!(kind, Kind::Sonar(_)) => notes.push(format!(
            "an echo does not tell where in its cone it comes from: {sigma} is by maps, which know a surface to a cell of {cell_m} m, and holds \
             that too; range and cone are taken as told"
        )),
        None => notes.push(format!(
            "too few readings lie on straight surfaces: {sigma} is by maps, which know a surface to a cell of {cell_m} m, and is too small by up to a third of the square of a cell"
        )),
    }
    notes
}

/// What the noise about surfaces says of sigma.
fn found(parameter: &Parameter, noise: &Noise) -> Found {
    Found {
        parameter: parameter.clone(),
        value: noise.sigma,
        interval: noise.interval,
        unidentified: None,
        profile: noise.profile.clone(),
    }
}
