//! What the numbers of a scene file may be.

use strict::Limit;

const fn limit(min: f64, max: f64, bound: &'static str, remedy: &'static str) -> Limit {
    Limit { min, max, bound, remedy }
}

/// Image columns.
pub const COLUMNS: Limit =
    limit(1.0, 1e5, "a whole number from 1 to 100000", "give the number of image columns, such as 140");
/// Full horizontal field of view, degrees.
pub const FIELD_OF_VIEW: Limit =
    limit(0.1, 175.0, "an angle in degrees, 0.1 to 175", "give the full horizontal field of view, such as 80");
/// Full horizontal field of view of what may look all round, degrees.
pub const ALL_ROUND: Limit =
    limit(0.1, 360.0, "an angle in degrees, 0.1 to 360", "give the full field of view, such as 180, or 360 all round");
/// Beams, cones or columns.
pub const BEAMS: Limit = limit(1.0, 1e5, "a whole number from 1 to 100000", "give how many there are, such as 180");
/// Where a sensor stands on the robot, m.
pub const MOUNT: Limit = limit(-1e3, 1e3, "a length in m, -1000 to 1000", "give its place in the frame of the robot");
/// At which scans a sensor reads.
pub const EVERY: Limit =
    limit(1.0, 1e6, "a whole number from 1 to 1000000", "2 reads at every second scan of the drive, 1 at each");
/// Standard deviation of a range, m.
pub const RANGE_SIGMA: Limit =
    limit(1e-6, 1e3, "a positive length in m, 0.000001 to 1000", "give a standard deviation such as 0.025");
/// Standard deviation of an inverse range, 1/m.
pub const INVERSE_SIGMA: Limit =
    limit(1e-6, 10.0, "a positive number in 1/m, 0.000001 to 10", "give one such as 0.001425: 4 cm at 5 m");
/// Largest range measured, m.
pub const RANGE: Limit =
    limit(1e-3, 1e6, "a positive length in m, 0.001 to 1000000", "give the largest range measured, such as 80");
/// Things on no map per metre of beam.
pub const EARLY: Limit =
    limit(0.0, 1e3, "a rate in 1/m, 0 to 1000", "give how many things stand in a metre of beam, such as 0.002");
/// Angle between the edges of a sonar's cone, degrees.
pub const WIDTH: Limit =
    limit(0.1, 170.0, "an angle in degrees, 0.1 to 170", "give the angle between the edges of the cone, such as 30");
/// Least angle between a ray and a surface that gives a reading, degrees.
pub const GRAZING: Limit =
    limit(0.0, 89.0, "an angle in degrees, 0 to 89", "give the least angle to a surface that is seen, such as 10");
/// Focal length times baseline, px·m.
pub const FOCAL_BASELINE: Limit =
    limit(1e-6, 1e6, "a positive number in px·m, 0.000001 to 1000000", "give focal length times baseline, such as 15");
/// Standard deviation of a disparity, px.
pub const SIGMA: Limit =
    limit(1e-6, 1e3, "a positive number in px, 0.000001 to 1000", "give a standard deviation such as 0.5");
/// Largest disparity searched, px.
pub const SEARCH: Limit =
    limit(1e-3, 1e6, "a positive number in px, 0.001 to 1000000", "give the largest disparity searched, such as 60");
/// Step that disparities are rounded to, px.
pub const STEP: Limit =
    limit(0.0, 1e3, "a number in px, 0 to 1000", "give 1 for whole pixels, a fraction for sub-pixels, 0 for none");
/// A probability.
pub const PROBABILITY: Limit = limit(0.0, 1.0, "a probability, 0 to 1", "give a number such as 0.8");
/// Columns that a mismatch copies across.
pub const REACH: Limit = limit(1.0, 1e5, "a whole number of columns from 1 to 100000", "give a number such as 7");

/// Radius of the robot, m.
pub const RADIUS: Limit =
    limit(1e-3, 1e3, "a positive length in m, 0.001 to 1000", "give the robot's radius, such as 0.2");
/// Speed of the robot, m/s.
pub const SPEED: Limit = limit(1e-3, 1e3, "a positive speed in m/s, 0.001 to 1000", "give a speed such as 0.5");
/// Turning on the spot, degrees per s.
pub const TURN_RATE: Limit =
    limit(0.1, 1e5, "a positive rate in degrees per s, 0.1 to 100000", "give a rate such as 30");
/// Time between scans, s.
pub const INTERVAL: Limit =
    limit(1e-4, 1e4, "a positive time in s, 0.0001 to 10000", "give the time between scans, such as 0.2");

/// How long the robot waits for what is in its way, s.
pub const PATIENCE: Limit = limit(0.0, 3600.0, "a time in s, 0 to 3600", "give how long it waits, such as 60");
/// Standard deviation of the recorded place of a robot that stands, m.
pub const JITTER: Limit = limit(0.0, 0.1, "a length in m, 0 to 0.1", "give a standard deviation such as 0.002");
/// Standard deviation of the recorded heading of a robot that stands, degrees.
pub const JITTER_ANGLE: Limit =
    limit(0.0, 10.0, "an angle in degrees, 0 to 10", "give a standard deviation such as 0.1");
/// How long the robot stands at a stop, s.
pub const WAIT: Limit = limit(0.0, 36e3, "a time in s, 0 to 36000", "give how long the robot stands there, such as 10");

/// Error of measured turns per turn.
pub const TURN_PER_TURN: Limit =
    limit(0.0, 1.0, "a share from 0 to 1", "give 0.056 for 5 degrees per 90 turned, 0 for none");
/// Error of measured turns per metre, degrees.
pub const TURN_PER_WAY: Limit =
    limit(0.0, 90.0, "an angle in degrees per m, 0 to 90", "give a standard deviation such as 1, 0 for none");
/// Error of measured ways per metre.
pub const WAY_PER_WAY: Limit = limit(0.0, 1.0, "a share from 0 to 1", "give 0.1 for 10 % of the distance, 0 for none");
/// Error of measured ways per degree turned, m.
pub const WAY_PER_TURN: Limit =
    limit(0.0, 0.1, "a length in m per degree, 0 to 0.1", "give a standard deviation such as 0.0002, 0 for none");
/// What is always measured beyond a turn.
pub const BIAS_TURN_PER_TURN: Limit =
    limit(-0.5, 0.5, "a share from -0.5 to 0.5", "give 0.02 for a track that is taken for 2 % too narrow");
/// What is always measured to be turned on a straight way, degrees per m.
pub const BIAS_TURN_PER_M: Limit =
    limit(-90.0, 90.0, "an angle in degrees per m, -90 to 90", "give it counter-clockwise, such as 0.5");
/// What is always measured beyond a way.
pub const BIAS_M_PER_M: Limit =
    limit(-0.5, 0.5, "a share from -0.5 to 0.5", "give 0.01 for wheels that are taken for 1 % too large");
/// Slips per metre.
pub const SLIPS: Limit =
    limit(0.0, 100.0, "a number of slips per m, 0 to 100", "give the mean number, such as 0.05, 0 for none");
/// What a slip adds to the way, m.
pub const SLIP: Limit =
    limit(0.0, 10.0, "a length in m, 0 to 10", "give the mean of what is measured too much, such as 0.05");
/// What a slip adds to the turn, degrees.
pub const SLIP_ANGLE: Limit = limit(0.0, 180.0, "an angle in degrees, 0 to 180", "give a standard deviation such as 2");

/// Radius of a mover, m.
pub const MOVER_RADIUS: Limit = limit(0.01, 5.0, "a length in m, 0.01 to 5", "give the mover's radius, such as 0.25");
/// Speed of a mover, m/s.
pub const MOVER_SPEED: Limit = limit(0.01, 5.0, "a speed in m/s, 0.01 to 5", "give a speed such as 1.2");
/// How long a mover stands, s.
pub const PAUSE: Limit = limit(0.0, 36e3, "a time in s, 0 to 36000", "give how long the mover stands, such as 2");
/// What a follower keeps between itself and the robot, m.
pub const FOLLOWING: Limit =
    limit(0.1, 100.0, "a length in m, 0.1 to 100", "give how far behind the robot it walks, such as 1");
/// How far a loiterer strays, m.
pub const STRAYING: Limit = limit(0.01, 100.0, "a length in m, 0.01 to 100", "give how far it strays, such as 1");
/// Length of a door's leaf, m.
pub const LEAF: Limit = limit(0.05, 5.0, "a length in m, 0.05 to 5", "give the length of the leaf, such as 0.9");
/// Thickness of a door's leaf, m.
pub const LEAF_THICKNESS: Limit =
    limit(0.001, 1.0, "a length in m, 0.001 to 1", "give the thickness of the leaf, such as 0.04");
/// A direction, degrees.
pub const ANGLE: Limit = limit(-360.0, 360.0, "an angle in degrees, -360 to 360", "give it counter-clockwise from x");
/// From shut to open, s.
pub const SWING: Limit = limit(0.01, 600.0, "a time in s, 0.01 to 600", "give how long the leaf swings, such as 2");
/// How often a door may open, s.
pub const PERIOD: Limit = limit(0.1, 36e3, "a time in s, 0.1 to 36000", "give the length of a period, such as 30");
/// A time of the drive, s.
pub const MOMENT: Limit = limit(0.0, 1e6, "a time in s, 0 to 1000000", "give a time since the start, such as 30");
/// The seed of what moves.
pub const SEED: Limit = limit(0.0, 9e15, "a whole number from 0 to 9000000000000000", "give a number such as 1");
/// People per 100 square metres.
pub const PEOPLE: Limit =
    limit(0.0, 20.0, "two numbers, 0 to 20, the least first", "give [least, most], such as [2.0, 4.0]");

/// How fast generated people walk, m/s.
pub const PACE: Limit =
    limit(0.01, 5.0, "two speeds in m/s, 0.01 to 5, the least first", "give [least, most], such as [0.6, 1.4]");

/// Sides of a generated place, m.
pub const SIDE: Limit =
    limit(2.0, 100.0, "two lengths in m, 2 to 100, the least first", "give [least, most], such as [6.0, 8.0]");
/// Width of a corridor or door, m.
pub const OPENING: Limit =
    limit(0.1, 20.0, "two lengths in m, 0.1 to 20, the least first", "give [least, most], such as [0.9, 1.1]");
/// Mean size of obstacles, m.
pub const OBSTACLE: Limit = limit(0.02, 10.0, "a length in m, 0.02 to 10", "give the mean size, such as 0.4");
/// Spread of the sizes of obstacles.
pub const SPREAD: Limit =
    limit(0.0, 0.9, "a share from 0 to 0.9", "0.5 draws sizes from half to one and a half of the mean");
/// Share of the floor under furniture.
pub const COVERED: Limit =
    limit(0.0, 0.4, "a share from 0 to 0.4", "give the share of the floor under furniture, such as 0.08");
/// A share.
pub const SHARE: Limit = limit(0.0, 1.0, "a share from 0 to 1", "give a number such as 0.3");
/// What the robot keeps off obstacles, m.
pub const CLEARANCE: Limit = limit(0.01, 2.0, "a length in m, 0.01 to 2", "give what the robot keeps off, such as 0.1");
/// Thickness of walls, m.
pub const THICKNESS: Limit = limit(0.01, 1.0, "a length in m, 0.01 to 1", "give the walls' thickness, such as 0.1");
