//! What a reading of a scene's camera means for range: the paper's Section 3.1, Figures 6 and 7.

mod disparity;
mod kernel;
mod options;
mod outputs;
mod view;

pub use options::SensorOptions;

use scene::Scene;
use std::path::Path;

use self::view::View;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::folder::{self, Purpose, Staging};
use crate::output::note;
use crate::worlds::claims;

/// Shows the camera of a scene, and checks that its densities are densities.
///
/// # Errors
/// Bad input before any work, I/O, and densities that do not integrate to what they should.
pub fn run(options: &SensorOptions) -> Result<(), Failure> {
    interruption::watch();
    let scene = Scene::load(&options.scene, None)?;
    let camera = View::of(&scene, options.range);
    let out = options.out.clone().unwrap_or_else(|| folder::for_scene(Path::new("results/sensor"), &options.scene));
    let purpose = Purpose::new("sensor", &[&options.scene], options.paper.files(&outputs::FILES));
    let mut staging = Staging::open(&out, &purpose)?;
    let columns = camera.columns();
    let claims = camera.claims(&columns);
    camera.write(&mut staging, &options.scene.display().to_string(), &claims, &options.paper)?;
    staging.publish()?;
    note(out.join("kernel.png").display());

    let table = camera.table(&columns);
    table.print(options.print.format, || camera.text(&scene.name, &table, &claims))?;
    claims::all_hold(&claims)
}
