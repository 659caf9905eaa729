//! Options of `scene` and its parts.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::output::args::{count, number};
use crate::worlds::scenes::scene;

/// What `scene` does.
#[derive(Debug, Subcommand)]
pub enum SceneCommand {
    /// Write a commented scene to begin with
    New(NewOptions),
    /// Print the scene file of a layout of a family
    Generate(GenerateOptions),
    /// Make a scene of a ROS map (YAML, with PGM or PNG): a route through all that the robot can reach
    FromMap(FromMapOptions),
    /// Make a scene of a floor plan (JSON with `verts`, as HouseExpo has them)
    FromPlan(FromMapOptions),
}

/// Options of `scene from-map` and `scene from-plan`.
#[derive(Debug, Args)]
pub struct FromMapOptions {
    /// The map's YAML file, or the floor plan
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Scene file to write instead of stdout; it names the map relative to itself
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the scene file if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Radius of the robot, m
    #[arg(long, value_name = "M", default_value_t = 0.2, allow_negative_numbers = true, value_parser = radius)]
    pub radius: f64,
    /// What the robot keeps from everything beside its radius, m
    #[arg(long, value_name = "M", default_value_t = 0.05, allow_negative_numbers = true, value_parser = clearance)]
    pub clearance: f64,
    /// All of the floor is to be seen from at most this far away, m
    #[arg(long, value_name = "M", default_value_t = 4.0, allow_negative_numbers = true, value_parser = range)]
    pub range: f64,
    /// Cut the route at this length, m
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = route_length)]
    pub max_length: Option<f64>,
    /// Where to start, m; not given, where the route gets short
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub start: Option<[f64; 2]>,
    /// Image columns of the camera
    #[arg(long, value_name = "N", default_value_t = 120, allow_negative_numbers = true, value_parser = count(100_000))]
    pub camera_columns: u32,
    /// Horizontal field of view of the camera, degrees
    #[arg(long, value_name = "DEG", default_value_t = 80.0, allow_negative_numbers = true, value_parser = field_of_view)]
    pub camera_field_of_view: f64,
}

/// Options of `scene new`.
#[derive(Debug, Args)]
pub struct NewOptions {
    /// Scene file to write, with or without .toml
    #[arg(value_name = "NAME")]
    pub file: PathBuf,
    /// Replace the file if it is there already
    #[arg(long)]
    pub force: bool,
}

/// Options of `scene generate`.
#[derive(Debug, Args)]
pub struct GenerateOptions {
    /// Family of scenes: a name of `list`, or a file
    #[arg(value_name = "FAMILY", value_parser = scene())]
    pub family: PathBuf,
    /// Which scene of the family
    #[arg(long, value_name = "N", default_value_t = scene::Set::FIRST_TEST, allow_negative_numbers = true)]
    pub layout: u64,
    /// Factor on the size of the obstacles; they cover as much of the floor
    #[arg(long, value_name = "F", default_value_t = 1.0, allow_negative_numbers = true, value_parser = size_factor)]
    pub size_factor: f64,
    /// File to write instead of stdout
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
}

fn size_factor(text: &str) -> Result<f64, String> {
    number(text, "from 0.1 to 10", |v| (0.1..=10.0).contains(&v))
}

fn radius(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.001 to 1000", |v| (0.001..=1000.0).contains(&v))
}

fn clearance(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.005 to 10", |v| (0.005..=10.0).contains(&v))
}

fn range(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.1 to 100", |v| (0.1..=100.0).contains(&v))
}

fn route_length(text: &str) -> Result<f64, String> {
    number(text, "in m from 0.1 to 1000000", |v| (0.1..=1e6).contains(&v))
}

fn field_of_view(text: &str) -> Result<f64, String> {
    number(text, "in degrees from 0.1 to 175", |v| (0.1..=175.0).contains(&v))
}

fn point(text: &str) -> Result<[f64; 2], String> {
    let coordinate = |text: &str| text.trim().parse().ok().filter(|v: &f64| v.is_finite());
    let point = text.split_once(',').and_then(|(x, y)| Some([coordinate(x)?, coordinate(y)?]));
    point.ok_or_else(|| "must be two numbers in m, such as 1.5,-2".to_owned())
}
