//! `[odometry]`: how far the robot's odometry is off.

use sensor::OdometryNoise;
use strict::{Error, Table};

use super::camera::take;
use super::findings::Findings;
use super::limits::{
    BIAS_M_PER_M, BIAS_TURN_PER_M, BIAS_TURN_PER_TURN, SLIP, SLIP_ANGLE, SLIPS, TURN_PER_TURN, TURN_PER_WAY,
    WAY_PER_TURN, WAY_PER_WAY,
};
use crate::Odometry;

/// Keys of `[odometry]` that say what comes of a slip.
const SLIPPED: [&str; 2] = ["slip_m", "slip_deg"];

/// `[odometry]`, if there is one: the standard noise, no bias and no slip where it is silent.
pub(super) fn read(root: &Table, found: &mut Findings) -> Option<Odometry> {
    let table = found.take(root.section("odometry")).flatten()?;
    let mut odometry = Odometry::default();
    let Odometry { noise, bias_m_per_m, bias_rad_per_rad, bias_rad_per_m, slips_per_m, slip_m, slip_rad } =
        &mut odometry;
    let OdometryNoise { rad_per_rad, rad_per_m, m_per_m, m_per_rad } = noise;
    // Angles are degrees in the file: on the way in, and out of degrees again once all is read.
    let mut degrees = [&mut *rad_per_m, &mut *bias_rad_per_m, &mut *slip_rad];
    degrees.iter_mut().for_each(|angle| **angle = angle.to_degrees());
    let [deg_per_m, bias_deg_per_m, slip_deg] = degrees;
    let mut m_per_deg = m_per_rad.to_radians();
    let fields = [
        ("deg_per_deg", &TURN_PER_TURN, rad_per_rad),
        ("deg_per_m", &TURN_PER_WAY, &mut *deg_per_m),
        ("m_per_m", &WAY_PER_WAY, m_per_m),
        ("m_per_deg", &WAY_PER_TURN, &mut m_per_deg),
        ("bias_deg_per_deg", &BIAS_TURN_PER_TURN, bias_rad_per_rad),
        ("bias_deg_per_m", &BIAS_TURN_PER_M, &mut *bias_deg_per_m),
        ("bias_m_per_m", &BIAS_M_PER_M, bias_m_per_m),
        ("slips_per_m", &SLIPS, slips_per_m),
        ("slip_m", &SLIP, slip_m),
        ("slip_deg", &SLIP_ANGLE, &mut *slip_deg),
    ];
    found.only(&table, &fields.each_ref().map(|(key, ..)| *key));
    take(&table, fields, found);
    for angle in [deg_per_m, bias_deg_per_m, slip_deg] {
        *angle = angle.to_radians();
    }
    *m_per_rad = m_per_deg.to_degrees();
    found.take(slips(&table));
    Some(odometry)
}

/// Refuses what is said of slips where there are none.
fn slips(table: &Table) -> Result<(), Error> {
    if table.get("slips_per_m").is_some() {
        return Ok(());
    }
    match SLIPPED.iter().find_map(|key| Some((key, table.get(key)?))) {
        Some((key, value)) => {
            let remedy = "write slips_per_m = 0.05 beside it, or take it out";
            Err(table.refuse(key, value, "left out where nothing slips", remedy))
        }
        None => Ok(()),
    }
}
