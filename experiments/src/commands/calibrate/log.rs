//! A log: the kernel and the prior under which every second scan is most likely by the map of the others.

use std::sync::Arc;

use grid::GridSpec;
use logs::{Log, Sensor};
use mapper::{Belief, FastVisibility, Model, Predictive, Prior};
use rayon::prelude::*;
use sensor::{Laser, Scan, SensorModel, Stereo};

use super::calibration::Calibration;
use super::noise::{self, Instrument, Noise};
use super::options::CalibrateOptions;
use super::outputs;
use super::search::{self, Fit, Found, Losses, Parameter, Scale};
use super::{advice, agreement, views};
use crate::failure::Failure;
use crate::jobs::progress::Count;
use crate::worlds::agreement::Spread;
use crate::worlds::source::{Asked, Source};
use crate::worlds::{kernels, reading};

/// What lies around the outermost poses and usual readings, m.
const MARGIN_M: f64 = 0.5;

/// Readings farther than this do not make the map larger, m.
const REACH_M: f64 = 15.0;

/// The search begins with one beam in so many.
const ROUGH: u32 = 4;

/// More cells than this take too long, and too much memory, for the hundreds of maps that a fit makes.
const MOST_CELLS: usize = 20_000_000;

/// Fits the kernel of whatever took the log.
///
/// What a bag tells of its camera goes into the options. None where the topics of a bag were to be listed.
pub(super) fn calibrate(options: &mut CalibrateOptions) -> Result<Option<Calibration>, Failure> {
    let Some(source) = source(options)? else { return Ok(None) };
    let options = &*options;
    let (whole, sensor) = read(options, &source)?;
    let scans: Vec<Scan> = whole.iter().map(|scan| thinned(scan, options.beams as usize)).collect();
    let grid = cover(&scans, &*points(sensor, options), options)?;
    let readings = scans.iter().flat_map(|scan| scan.readings.iter().flatten()).count() as u64;
    let (parameters, kind) = match sensor {
        Sensor::Laser { max_range_m, .. } => (laser(), format!("a laser up to {max_range_m} m")),
        Sensor::Stereo | Sensor::Sonar => (stereo(), "a stereo camera".to_owned()),
    };
    let noise = noise::of(&scans, instrument(sensor, options), parameters[0].start);
    let known = noise.as_ref().map(|noise| noise.sigma);
    let sought = if known.is_some() { &parameters[1..] } else { &parameters[..] };
    let rough: Vec<Scan> = scans.iter().map(|scan| thinned(scan, options.beams.div_ceil(ROUGH) as usize)).collect();
    let losses = |scans: &[Scan], values: &[f64]| -> Losses {
        let values: Vec<f64> = known.into_iter().chain(values.iter().copied()).collect();
        let (model, prior) = setting(sensor, options, &values)?;
        Some(predicted(scans, grid, model, prior))
    };
    tell_agreement(&whole, grid, sensor, options);
    drop(whole);
    let progress = Count::settings();
    let fit = search::fit(sought, Some(&|values| losses(&rough, values)), &|values| losses(&scans, values), &|| {
        progress.step()
    });
    progress.finish();
    let mut fit = fit.ok_or_else(|| Failure::internal("no setting could be tried"))?;
    if let Some(noise) = &noise {
        fit.found.insert(0, found(&parameters[0], noise));
    }
    let sigma = fit.found[0].value;
    let surfaces = noise::Surfaces::of(&scans, instrument(sensor, options), sigma);
    let (lengths, of_views) = views::of(&runs(options, &source)?, &surfaces, sigma);
    let mut notes = notes(&fit, noise.as_ref(), options.grid);
    notes.push(of_views);
    fit.found.extend(lengths);
    let about = format!("{} scans of {kind} in {}, {} readings", scans.len(), outputs::name(&options.file), readings);
    let advice = advice::replay(sensor, options, source.is_bag(), &fit);
    Ok(Some(Calibration {
        about,
        measure: "probability of every second scan by the map that visibility makes of the others",
        readings,
        picture: None,
        notes,
        advice,
        fit,
    }))
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

fn refused(error: logs::LogError) -> Failure {
    Failure::BadInput(error.to_string())
}

/// The log from its first scan on.
fn opened(options: &CalibrateOptions, source: &Source) -> Result<Log<'static>, Failure> {
    let reading = logs::Options {
        max_range_m: options.max_range,
        max_disparity_px: Some(options.max_disparity.unwrap_or(Stereo::default().max_disparity)),
        fan: options.fan.fan(),
        ..logs::Options::default()
    };
    source.log(&reading)
}

/// The scans of the sensor that is fitted, or of all.
fn scans(
    options: &CalibrateOptions,
    log: impl Iterator<Item = Result<Scan, logs::LogError>>,
) -> impl Iterator<Item = Result<Scan, Failure>> {
    let chosen = options.sensor;
    let is_of = move |scan: &Scan| chosen.is_none_or(|number| scan.sensor == number);
    log.map(|scan| scan.map_err(refused)).filter(move |scan| scan.as_ref().map_or(true, is_of))
}

/// Runs of scans that follow each other, spread evenly over the log: all of it, where it is short.
fn runs(options: &CalibrateOptions, source: &Source) -> Result<Vec<Vec<Scan>>, Failure> {
    let mut all = 0;
    for scan in scans(options, opened(options, source)?) {
        scan?;
        all += 1;
    }
    let count = (all / views::RUN).clamp(1, views::RUNS);
    let mut runs = vec![Vec::new(); count];
    for (number, scan) in scans(options, opened(options, source)?).enumerate() {
        let run = (number * count / all).min(count - 1);
        // The first of those that fall to it.
        if number - (run * all).div_ceil(count) < views::RUN {
            runs[run].push(thinned(&scan?, options.beams as usize));
        }
    }
    Ok(runs)
}

/// The scans that are fitted, with all of their beams, and what took them.
fn read(options: &CalibrateOptions, source: &Source) -> Result<(Vec<Scan>, Sensor), Failure> {
    let mut all = 0;
    for scan in scans(options, opened(options, source)?) {
        scan?;
        all += 1;
    }
    let most = u64::from(options.scans).min(all);
    // The last of every so many, also where that is no whole number.
    let takes = |number: u64| (number + 1) * most / all > number * most / all;
    let mut log = opened(options, source)?;
    let mut fitted = Vec::new();
    for (number, scan) in (0u64..).zip(scans(options, &mut log)) {
        let scan = scan?;
        if takes(number) {
            // Of one kind they are, so that one kernel is fitted to all.
            fitted.push(Scan { sensor: 0, ..scan });
        }
    }
    let place = options.file.display().to_string();
    let sensor = kernels::fitted(&place, log.report(), options.sensor)?;
    reading::tell(&place, log.report());
    reading::tell_idle(&options.given, &place, log.report(), sensor);
    options.given.warn(&["consistent"], &place, "a log, which says nothing of left and right");
    if fitted.len() < 20 {
        let what =
            format!("{} scans are too few to predict some from the others; give a log of 20 or more", fitted.len());
        return Err(Failure::BadInput(format!("{}: {what}", options.file.display())));
    }
    Ok((fitted, sensor))
}

/// A scan with so many beams at most.
fn thinned(scan: &Scan, beams: usize) -> Scan {
    let every = scan.readings.len().div_ceil(beams).max(1);
    Scan {
        bearings_rad: scan.bearings_rad.iter().copied().step_by(every).collect(),
        readings: scan.readings.iter().copied().step_by(every).collect(),
        ..scan.clone()
    }
}

fn points(sensor: Sensor, options: &CalibrateOptions) -> Arc<dyn SensorModel> {
    match sensor {
        Sensor::Laser { .. } => Arc::new(Laser::default()),
        Sensor::Stereo | Sensor::Sonar => {
            Arc::new(Stereo { focal_baseline: options.focal_baseline, ..Stereo::default() })
        }
    }
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

fn parameter(name: &'static str, unit: &'static str, range: [f64; 2], start: f64, scale: Scale) -> Parameter {
    Parameter { name, unit, range, start, scale }
}

fn belief() -> [Parameter; 2] {
    let Prior { occupancy, correlation, .. } = Prior::default();
    [
        parameter("prior", "1", [0.002, 0.6], occupancy, Scale::Odds),
        parameter("correlation", "1", [0.02, 0.99], correlation, Scale::Odds),
    ]
}

fn laser() -> Vec<Parameter> {
    let Laser { range_sigma_m, hit, no_echo, early_per_m, .. } = Laser::default();
    let kernel = [
        parameter("range_sigma", "m", [0.002, 0.5], range_sigma_m, Scale::Ratio),
        parameter("hit", "1", [0.2, 0.9995], hit, Scale::Odds),
        parameter("no_echo", "1", [1e-5, 0.5], no_echo, Scale::Odds),
        parameter("early", "1/m", [1e-5, 0.5], early_per_m, Scale::Ratio),
    ];
    kernel.into_iter().chain(belief()).collect()
}

fn stereo() -> Vec<Parameter> {
    let Stereo { disparity_sigma, correct_match, .. } = Stereo::default();
    let kernel = [
        parameter("disparity_sigma", "px", [0.02, 5.0], disparity_sigma, Scale::Ratio),
        parameter("correct_match", "1", [0.05, 0.999], correct_match, Scale::Odds),
    ];
    kernel.into_iter().chain(belief()).collect()
}

/// The sensor and the prior of these values; none where shares add up to more than one.
fn setting(sensor: Sensor, options: &CalibrateOptions, values: &[f64]) -> Option<(Arc<dyn SensorModel>, Prior)> {
    let prior = |at: usize| Prior { occupancy: values[at], correlation: values[at + 1], ..Prior::default() };
    match sensor {
        Sensor::Laser { max_range_m, .. } => {
            let [range_sigma_m, hit, no_echo, early_per_m] = [values[0], values[1], values[2], values[3]];
            let laser = Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m };
            // Some outliers there always are: without any, one of them makes a log impossible.
            (laser.outlier() >= 1e-4 && laser.validate().is_ok()).then(|| (Arc::new(laser) as _, prior(4)))
        }
        Sensor::Stereo | Sensor::Sonar => {
            let max_disparity = options.max_disparity.unwrap_or(Stereo::default().max_disparity);
            let stereo = Stereo {
                focal_baseline: options.focal_baseline,
                disparity_sigma: values[0],
                correct_match: values[1],
                max_disparity,
            };
            Some((Arc::new(stereo), prior(2)))
        }
    }
}

/// Says how far the scans agree with a map of each other, by the usual kernel: a fitted one would excuse what is wrong.
fn tell_agreement(scans: &[Scan], grid: GridSpec, sensor: Sensor, options: &CalibrateOptions) {
    let model: Arc<dyn SensorModel> = match sensor {
        Sensor::Laser { max_range_m, .. } => Arc::new(Laser { max_range_m, ..Laser::default() }),
        Sensor::Stereo | Sensor::Sonar => {
            let max_disparity = options.max_disparity.unwrap_or(Stereo::default().max_disparity);
            Arc::new(Stereo { focal_baseline: options.focal_baseline, max_disparity, ..Stereo::default() })
        }
    };
    let spread = match sensor {
        Sensor::Laser { .. } => Spread::Range(Laser::default().range_sigma_m),
        Sensor::Stereo | Sensor::Sonar => Spread::Disparity(Stereo::default().disparity_sigma),
    };
    agreement::tell(&options.file.display().to_string(), scans, grid, model, Prior::default(), spread);
}

/// `-ln P` of every second scan by the map of the others, and its number of readings.
fn predicted(scans: &[Scan], grid: GridSpec, sensor: Arc<dyn SensorModel>, prior: Prior) -> Vec<(f64, u64)> {
    let setup = Model { prior, ..Model::new(grid, Arc::clone(&sensor)) };
    let mut map = FastVisibility::visibility(&setup);
    scans.iter().step_by(2).for_each(|scan| map.integrate_on(scan, 1));
    let pairs = map.pairs();
    let loss = |scan: &Scan| {
        let mut predictive = Predictive::new(grid, &*sensor, prior.onset(grid.cell_m));
        let (mut sum, mut readings) = (0.0, 0);
        for ray in scan.rays() {
            if predictive.take(&ray) {
                sum += predictive.log_loss(Belief::Chain(&pairs));
                readings += 1;
            }
        }
        (sum, readings)
    };
    scans.par_iter().skip(1).step_by(2).map(loss).collect()
}

fn notes(fit: &Fit, noise: Option<&Noise>, cell_m: f64) -> Vec<String> {
    let mut notes = Vec::new();
    let value = |name: &str| fit.found.iter().find(|found| found.parameter.name == name).map(|found| found.value);
    if let (Some(prior), Some(correlation)) = (value("prior"), value("correlation")) {
        // c(d) = exp(-d / ((1 - p) L)).
        let length_m = -Prior::REFERENCE_M / ((1.0 - prior) * libm::log(correlation));
        notes.push(format!("the prior and the correlation are those of obstacles {length_m:.2} m long on average, as the sensor sees them"));
    }
    match noise {
        Some(noise) => notes.push(format!(
            "{} is that of {} readings about straight pieces of surface, fitted to the other half of the scans; the rest is by maps with it",
            fit.found[0].parameter.name, noise.readings
        )),
        None => notes.push(format!(
            "too few readings lie on straight surfaces: {} is by maps, which know a surface to a cell of {cell_m} m, and is too small by up to a third of the square of a cell",
            fit.found[0].parameter.name
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

fn instrument(sensor: Sensor, options: &CalibrateOptions) -> Instrument {
    match sensor {
        Sensor::Laser { .. } => Instrument::Laser,
        Sensor::Stereo | Sensor::Sonar => {
            Instrument::Stereo(Stereo { focal_baseline: options.focal_baseline, ..Stereo::default() })
        }
    }
}
