//! The sensors of a log, each with the scans that are fitted.
//!
//! Of a log of one kind of sensor, all scans are fitted together, as of one kernel. Of several kinds every sensor is fitted by itself; sonars that are mounted together are one.
//! What sonars read at one time is one scan.

use std::collections::BTreeMap;

use logs::{Log, Report, Sensor};
use sensor::{Depth, Scan, Sonar, Stereo};

use super::kind::Kind;
use super::options::CalibrateOptions;
use super::views;
use crate::failure::Failure;
use crate::worlds::kernels::{self, PLANE_RAD};
use crate::worlds::reading;
use crate::worlds::source::Source;

/// Fewer scans cannot predict each other.
const FEWEST: usize = 20;

/// A sensor, or all of a kind, with its scans.
pub(super) struct Group {
    /// The first of its numbers, in a log of several kinds.
    pub(super) sensor: Option<usize>,
    pub(super) kind: Kind,
    /// With all of their beams; all scans have number 0.
    pub(super) scans: Vec<Vec<Scan>>,
    /// Runs of scans that follow each other, spread evenly over the log, with the beams that are fitted.
    pub(super) runs: Vec<Vec<Scan>>,
}

/// What the first reading of a log finds of a group.
struct Survey {
    sensor: Option<usize>,
    kind: Sensor,
    scans: usize,
    most_bearing_rad: f64,
    longest_m: f64,
}

/// How scans become those of groups.
struct Sorting {
    report: Report,
    is_one_kind: bool,
}

impl Sorting {
    /// The group of a sensor.
    fn group(&self, sensor: usize) -> usize {
        if self.is_one_kind { 0 } else { self.report.array_of(sensor) }
    }
}

/// Reads the groups of a log, with a line for each that has too few scans.
///
/// # Errors
/// A log that is refused, or whose sensors all have too few scans.
pub(super) fn read(options: &CalibrateOptions, source: &Source) -> Result<(Vec<Group>, Vec<String>), Failure> {
    let place = options.file.display().to_string();
    let (sorting, surveys) = survey(options, source)?;
    reading::tell(&place, &sorting.report);
    if let Some(survey) = surveys.values().next() {
        reading::tell_idle(&options.given, &place, &sorting.report, survey.kind);
    }
    options.given.warn(&["consistent"], &place, "a log, which says nothing of left and right");
    kernels::refuse_no_ranges(&options.depth, &place, &sorting.report)?;
    let (enough, few): (Vec<_>, Vec<_>) = surveys.into_iter().partition(|(_, survey)| survey.scans >= FEWEST);
    let too_few = |survey: &Survey| format!("{} scans are too few to predict some from the others", survey.scans);
    if enough.is_empty() {
        let what = few.first().map_or_else(String::new, |(_, survey)| too_few(survey));
        return Err(Failure::BadInput(format!("{place}: {what}; give a log of {FEWEST} or more")));
    }
    let left_out = |(sensor, survey): &(usize, Survey)| {
        format!("sensor {sensor} ({}) is not fitted: {}", kernels::called(survey.kind), too_few(survey))
    };
    let left_out = few.iter().map(left_out).collect();
    let mut groups = BTreeMap::new();
    for (number, survey) in &enough {
        let group =
            Group { sensor: survey.sensor, kind: kind(options, *number, survey), scans: Vec::new(), runs: Vec::new() };
        groups.insert(*number, (group, survey.scans));
    }
    fill(options, source, &sorting, &mut groups)?;
    Ok((groups.into_values().map(|(group, _)| group).collect(), left_out))
}

/// The log from its first scan on.
fn opened(options: &CalibrateOptions, source: &Source) -> Result<Log<'static>, Failure> {
    let reading = logs::Options {
        max_range_m: options.max_range,
        max_sonar_m: options.sonar_range,
        max_disparity_px: Some(options.max_disparity.unwrap_or(Stereo::default().max_disparity)),
        fan: options.fan.fan(),
        ..logs::Options::default()
    };
    source.log(&reading)
}

fn refused(error: logs::LogError) -> Failure {
    Failure::BadInput(error.to_string())
}

/// Reads a log and hands over what is one scan for its group: of sonars, all of one time.
fn each(options: &CalibrateOptions, source: &Source, of: &mut dyn FnMut(Vec<Scan>, Sensor)) -> Result<Report, Failure> {
    let mut log = opened(options, source)?;
    let mut together: Vec<Scan> = Vec::new();
    let mut last = None;
    while let Some(event) = log.next_event() {
        let event = event.map_err(refused)?;
        let is_sonar = matches!(event.kind, Sensor::Sonar { .. });
        let goes_on = is_sonar
            && together.last().is_some_and(|before| before.is_with(&event.scan))
            && matches!(last, Some(Sensor::Sonar { .. }))
            && log.report().array_of(together[0].sensor) == log.report().array_of(event.sensor);
        if !goes_on && let Some(kind) = last {
            of(std::mem::take(&mut together), kind);
        }
        last = Some(event.kind);
        together.push(event.scan);
    }
    if let Some(kind) = last {
        of(together, kind);
    }
    Ok(log.report().clone())
}

fn survey(options: &CalibrateOptions, source: &Source) -> Result<(Sorting, BTreeMap<usize, Survey>), Failure> {
    let mut by_sensor: BTreeMap<usize, Survey> = BTreeMap::new();
    let report = each(options, source, &mut |scans, kind| {
        let survey = by_sensor.entry(scans[0].sensor).or_insert(Survey {
            sensor: Some(scans[0].sensor),
            kind,
            scans: 0,
            most_bearing_rad: 0.0,
            longest_m: 0.0,
        });
        survey.scans += 1;
        let bearings = scans.iter().flat_map(|scan| &scan.bearings_rad);
        survey.most_bearing_rad = bearings.fold(survey.most_bearing_rad, |most, bearing| most.max(bearing.abs()));
        let readings = scans.iter().flat_map(|scan| scan.readings.iter().flatten());
        survey.longest_m = readings.filter(|r| r.is_finite()).fold(survey.longest_m, |longest, r| longest.max(*r));
    })?;
    let is_depth = |sensor: &usize| options.depth.contains(sensor);
    let kinds: Vec<_> =
        by_sensor.iter().map(|(number, found)| (std::mem::discriminant(&found.kind), is_depth(number))).collect();
    let is_one_kind = kinds.windows(2).all(|pair| pair[0] == pair[1]);
    let sorting = Sorting { report, is_one_kind };
    let mut groups: BTreeMap<usize, Survey> = BTreeMap::new();
    for (number, found) in by_sensor {
        match groups.get_mut(&sorting.group(number)) {
            Some(group) => {
                group.scans += found.scans;
                group.most_bearing_rad = group.most_bearing_rad.max(found.most_bearing_rad);
                group.longest_m = group.longest_m.max(found.longest_m);
            }
            None => {
                let sensor = found.sensor.filter(|_| !is_one_kind);
                groups.insert(sorting.group(number), Survey { sensor, ..found });
            }
        }
    }
    Ok((sorting, groups))
}

fn kind(options: &CalibrateOptions, number: usize, survey: &Survey) -> Kind {
    let max_disparity = options.max_disparity.unwrap_or(Stereo::default().max_disparity);
    let stereo = Stereo { focal_baseline: options.focal_baseline, max_disparity, ..Stereo::default() };
    // Of one kind the group has number 0, whatever its sensors have.
    let is_depth = options.depth.contains(&number) || (survey.sensor.is_none() && !options.depth.is_empty());
    match survey.kind {
        Sensor::Laser { .. } if is_depth => {
            let max_range_m = options.max_range.unwrap_or(survey.longest_m);
            Kind::Depth(Depth { max_range_m, ..Depth::default() })
        }
        Sensor::Laser { max_range_m, .. } => Kind::Laser { max_range_m },
        Sensor::Stereo if survey.most_bearing_rad > PLANE_RAD => Kind::Omnidirectional(stereo),
        Sensor::Stereo => Kind::Stereo(stereo),
        Sensor::Sonar { max_range_m, width_rad } => {
            let usual = Sonar::default();
            Kind::Sonar(Sonar {
                max_range_m: options.sonar_range.or(max_range_m).unwrap_or(usual.max_range_m),
                width_rad: options.sonar_width.map(f64::to_radians).or(width_rad).unwrap_or(usual.width_rad),
                ..usual
            })
        }
    }
}

/// Reads the scans of the groups, of each so many as are fitted, spread evenly over the log, and runs of those that follow each other.
fn fill(
    options: &CalibrateOptions,
    source: &Source,
    sorting: &Sorting,
    groups: &mut BTreeMap<usize, (Group, usize)>,
) -> Result<(), Failure> {
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    each(options, source, &mut |scans, _| {
        let number = sorting.group(scans[0].sensor);
        let Some((group, all)) = groups.get_mut(&number) else { return };
        let (all, seen) = (*all, seen.entry(number).or_default());
        let place = *seen;
        *seen += 1;
        let most = (options.scans as usize).min(all);
        // Of one kind they are, so that one kernel is fitted to all.
        let scans: Vec<Scan> = scans.into_iter().map(|scan| Scan { sensor: 0, ..scan }).collect();
        if group.kind.instrument().is_some() {
            let count = (all / views::RUN).clamp(1, views::RUNS);
            group.runs.resize(count, Vec::new());
            let run = (place * count / all).min(count - 1);
            // The first of those that fall to it.
            if place - (run * all).div_ceil(count) < views::RUN {
                group.runs[run].extend(scans.iter().map(|scan| thinned(scan, options.beams as usize)));
            }
        }
        // The last of every so many, also where that is no whole number.
        if (place + 1) * most / all > place * most / all {
            group.scans.push(scans);
        }
    })?;
    Ok(())
}

/// A scan with so many beams at most.
pub(super) fn thinned(scan: &Scan, beams: usize) -> Scan {
    let every = scan.readings.len().div_ceil(beams).max(1);
    Scan {
        bearings_rad: scan.bearings_rad.iter().copied().step_by(every).collect(),
        readings: scan.readings.iter().copied().step_by(every).collect(),
        ..scan.clone()
    }
}
