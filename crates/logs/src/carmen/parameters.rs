//! `PARAM` lines: what a log says of its lasers, and how far its sonars hear.

use std::collections::BTreeMap;

use sensor::Pose;

use crate::bounds::FAR_M;
use crate::fan::FanOptions;
use crate::fields::Fields;

/// What is known of one laser.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Laser {
    pub(super) max_range_m: Option<f64>,
    pub(super) fan: FanOptions,
    offset_m: Option<f64>,
    side_m: Option<f64>,
    turn_rad: Option<f64>,
}

impl Laser {
    /// Where it stands on the robot; in the middle, and looking ahead or (the second, at the rear) back, where nothing is known.
    pub(super) fn mount(&self, laser: u8) -> Pose {
        let turn_rad = self.turn_rad.unwrap_or(if laser == 2 { std::f64::consts::PI } else { 0.0 });
        Pose { x_m: self.offset_m.unwrap_or(0.0), y_m: self.side_m.unwrap_or(0.0), theta_rad: turn_rad }
    }

    /// Whether the log says where it stands.
    pub(super) fn is_mounted(&self) -> bool {
        self.offset_m.is_some() || self.side_m.is_some() || self.turn_rad.is_some()
    }
}

/// The lasers of a log by their number, from 1: front, rear, others.
#[derive(Debug, Default)]
pub(super) struct Parameters {
    lasers: BTreeMap<u8, Laser>,
    max_sonar_m: Option<f64>,
}

/// The range at which sonars hear nothing, in the names of CARMEN's simulator and bases.
const MAX_SONAR: &str = "robot_max_sonar";

/// Names of the lasers in names of parameters.
const LASERS: [(&str, u8); 13] = [
    ("front_laser", 1),
    ("frontlaser", 1),
    ("laser1", 1),
    ("rear_laser", 2),
    ("rearlaser", 2),
    ("laser2", 2),
    ("laser3", 3),
    ("laser4", 4),
    ("laser5", 5),
    ("laser_front", 1),
    ("laser_rear", 2),
    ("front", 1),
    ("rear", 2),
];

/// A resolution below this is in rad, as no scanner has steps of less than 0.05 degrees.
const LEAST_DEGREES: f64 = 0.05;

impl Parameters {
    pub(super) fn laser(&self, laser: u8) -> Laser {
        self.lasers.get(&laser).copied().unwrap_or_default()
    }

    /// The range from which on sonars hear nothing, m.
    pub(super) fn max_sonar_m(&self) -> Option<f64> {
        self.max_sonar_m
    }

    /// Takes the fields behind `PARAM`.
    pub(super) fn take(&mut self, fields: &mut Fields<'_>) -> Result<(), String> {
        let name = String::from_utf8_lossy(fields.raw("name")?).into_owned();
        if name == MAX_SONAR {
            self.max_sonar_m = Some(positive(fields.number(&name, FAR_M)?, &name, "m")?);
            return Ok(());
        }
        let Some((number, what)) = split(&name) else { return Ok(()) };
        let mut laser = self.laser(number);
        match what {
            "max" | "max_range" | "maximum_range" => {
                laser.max_range_m = Some(positive(fields.number(&name, FAR_M)?, &name, "m")?);
            }
            "fov" | "field_of_view" => {
                let value = positive(fields.number(&name, 361.0)?, &name, "rad or degrees")?;
                laser.fan.fov_rad = Some(if value > 6.3 { value.to_radians() } else { value });
            }
            "resolution" | "angular_resolution" => {
                let value = positive(fields.number(&name, 360.0)?, &name, "degrees")?;
                laser.fan.step_rad = Some(if value < LEAST_DEGREES { value } else { value.to_radians() });
            }
            "start_angle" => {
                let value = fields.number(&name, 360.0)?;
                laser.fan.first_rad = Some(if value.abs() > 6.3 { value.to_radians() } else { value });
            }
            "offset" => laser.offset_m = Some(fields.number(&name, FAR_M)?),
            "side_offset" => laser.side_m = Some(fields.number(&name, FAR_M)?),
            "angular_offset" => laser.turn_rad = Some(fields.number(&name, 7.0)?),
            _ => return Ok(()),
        }
        self.lasers.insert(number, laser);
        Ok(())
    }
}

/// The laser that a parameter is of, and which of its parameters it is: `laser_front_laser_fov` is the first laser's `fov`.
fn split(name: &str) -> Option<(u8, &str)> {
    let of = name.strip_prefix("laser_").or_else(|| name.strip_prefix("robot_"))?;
    LASERS.iter().find_map(|(laser, number)| Some((*number, of.strip_prefix(laser)?.strip_prefix('_')?)))
}

fn positive(value: f64, name: &str, unit: &str) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("{name}: {value}: must be above 0 {unit}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_told_by_laser_and_unit() {
        let mut parameters = Parameters::default();
        for line in [
            "laser_front_laser_fov 4.5",
            "laser_front_laser_resolution 0.5 host 1",
            "robot_front_laser_max 30",
            "robot_frontlaser_offset 0.25",
            "laser_laser2_fov 180",
            "laser_rear_laser_resolution 0.017453",
            "robot_rearlaser_angular_offset 3.1",
            "laser_laser3_start_angle -120",
            "robot_length 0.5",
            "robot_max_sonar 4.5",
            "robot_front_laser_port /dev/tty",
            "laser_front_laser_type LMS",
        ] {
            parameters.take(&mut Fields::by_blanks(line.as_bytes())).expect(line);
        }
        let [front, rear, third] = [1, 2, 3].map(|laser| parameters.laser(laser));
        assert_eq!((front.fan.fov_rad, front.fan.step_rad), (Some(4.5), Some(0.5f64.to_radians())));
        assert_eq!((front.max_range_m, front.mount(1)), (Some(30.0), Pose { x_m: 0.25, ..Pose::default() }));
        assert_eq!((rear.fan.fov_rad, rear.fan.step_rad), (Some(180f64.to_radians()), Some(0.017453)));
        assert_eq!(rear.mount(2), Pose { theta_rad: 3.1, ..Pose::default() });
        assert_eq!(third.fan.first_rad, Some(-120f64.to_radians()));
        assert_eq!(parameters.max_sonar_m(), Some(4.5));
        assert!(front.is_mounted() && rear.is_mounted() && !third.is_mounted());
    }
}
