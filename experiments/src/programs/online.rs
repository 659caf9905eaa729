//! A program that is given scans one by one on standard input, and answers with maps on standard output.

use std::time::{Duration, Instant};

use grid::Raster;
use mapper::{Mapper, Model, Outside};
use sensor::Scan;
use serde_json::{Value, json};

use super::batch::told;
use super::described::{self, SCHEMA_VERSION};
use super::fault::Fault;
use super::talk::Talk;
use super::times;

/// Hands every scan on, and asks for a map whenever one is to be looked at.
pub(super) struct Online {
    name: &'static str,
    words: &'static [String],
    longest: Duration,
    model: Model,
    talk: State,
    /// Number of scans so far.
    scans: usize,
    /// Scans were taken since the last map.
    behind: bool,
    occupancy: Raster<f64>,
    outside: Outside,
}

enum State {
    Before,
    Running(Talk),
    Over,
}

impl Online {
    pub(super) fn new(name: &'static str, words: &'static [String], longest: Duration, model: &Model) -> Self {
        Self {
            name,
            words,
            longest,
            model: model.clone(),
            talk: State::Before,
            scans: 0,
            behind: true,
            occupancy: Raster::filled(model.grid, model.prior.occupancy),
            outside: Outside::default(),
        }
    }

    /// Says something to the program, or hears something from it; a fault ends it.
    fn with(&mut self, exchange: impl FnOnce(&mut Talk) -> Result<(), Fault>) {
        let start = Instant::now();
        if matches!(self.talk, State::Before) {
            let opening = json!({
                "type": "start",
                "schema_version": SCHEMA_VERSION,
                "grid": described::grid(&self.model),
                "sensors": described::sensors(&self.model),
            });
            self.talk = State::Over;
            match Talk::start(self.words, self.model.grid, self.longest) {
                Ok(mut talk) => match talk.say(&opening) {
                    Ok(()) => self.talk = State::Running(talk),
                    Err(fault) => self.over(&talk, fault),
                },
                Err(fault) => self.outside.fault = Some(told(&fault, "")),
            }
        }
        if let State::Running(talk) = &mut self.talk {
            let done = exchange(talk);
            self.outside.stderr = talk.stderr();
            if let Err(fault) = done
                && let State::Running(talk) = std::mem::replace(&mut self.talk, State::Over)
            {
                self.over(&talk, fault);
            }
        }
        self.outside.seconds += start.elapsed().as_secs_f64();
    }

    fn over(&mut self, talk: &Talk, fault: Fault) {
        let fault = talk.end(fault);
        self.outside.stderr = talk.stderr();
        self.outside.fault = Some(told(&fault, &self.outside.stderr));
        self.occupancy = Raster::filled(self.model.grid, self.model.prior.occupancy);
    }
}

impl Mapper for Online {
    fn integrate(&mut self, scan: &Scan) {
        let (start, before) = (Instant::now(), self.outside.seconds);
        let message = message(self.scans, scan, described::reading(&**self.model.sensors.of(scan)));
        self.scans += 1;
        self.behind = true;
        self.with(|talk| talk.say(&message));
        times::add(self.name, start, self.outside.seconds - before);
    }

    fn settle(&mut self) {
        if !std::mem::take(&mut self.behind) {
            return;
        }
        let (start, before) = (Instant::now(), self.outside.seconds);
        let (mut map, unseen) = (None, self.model.prior.occupancy);
        self.with(|talk| {
            map = Some(talk.map()?);
            Ok(())
        });
        if let Some(values) = map {
            let filled = |value: f64| if value.is_nan() { unseen } else { value };
            self.occupancy = Raster::new(self.model.grid, values.into_iter().map(filled).collect());
        }
        times::add(self.name, start, self.outside.seconds - before);
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn outside(&self) -> Option<&Outside> {
        Some(&self.outside)
    }
}

/// A scan as a message. A beam without echo, which JSON has no number for, is the text "inf".
pub(super) fn message(number: usize, scan: &Scan, reading: &str) -> Value {
    let value = |reading: &Option<f64>| match reading {
        Some(value) if value.is_infinite() => json!("inf"),
        other => json!(other),
    };
    let mut message = json!({
        "type": "scan",
        "schema_version": SCHEMA_VERSION,
        "scan": number,
        "time_s": scan.time_s,
        "sensor": scan.sensor,
        "x_m": scan.pose.x_m,
        "y_m": scan.pose.y_m,
        "theta_rad": scan.pose.theta_rad,
        "bearing_rad": scan.bearings_rad,
    });
    message[reading] = scan.readings.iter().map(value).collect();
    message
}

#[cfg(test)]
mod tests {
    use sensor::Pose;

    use super::*;

    #[test]
    fn a_scan_as_a_line() {
        let scan = Scan {
            sensor: 1,
            time_s: 0.5,
            pose: Pose { x_m: 1.0, y_m: 2.0, theta_rad: -0.25 },
            bearings_rad: vec![-0.5, 0.0, 0.5],
            readings: vec![Some(0.1), None, Some(f64::INFINITY)],
        };
        let expected = r#"{"type":"scan","schema_version":1,"scan":7,"time_s":0.5,"sensor":1,"x_m":1.0,"y_m":2.0,
            "theta_rad":-0.25,"bearing_rad":[-0.5,0.0,0.5],"range_m":[0.1,null,"inf"]}"#;
        assert_eq!(message(7, &scan, "range_m"), serde_json::from_str::<Value>(expected).expect("JSON"));
    }
}
