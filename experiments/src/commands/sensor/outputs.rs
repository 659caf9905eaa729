//! The files that `sensor` leaves behind.

use serde_json::json;

use super::kernel::Kernel;
use super::view::View;
use super::{disparity, kernel};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::folder::Staging;
use crate::output::record::Record;
use crate::output::table::{Table, rounded};
use crate::worlds::claims::Claim;

/// Points of the curve of Figure 6 and rows of Figure 7.
const DISPARITIES: usize = 600;

/// The files, beside the record.
pub(super) const FILES: [&str; 4] = ["density.csv", "density.png", "kernel.csv", "kernel.png"];

impl View {
    pub(super) fn write(
        &self,
        staging: &mut Staging,
        scene: &str,
        claims: &[Claim],
        paper: &Paper,
    ) -> Result<(), Failure> {
        let d = self.stereo.max_disparity;
        let at = |i: usize| i as f64 * d / DISPARITIES as f64;
        let curve: Vec<(f64, f64)> =
            (0..=DISPARITIES).map(|i| (at(i), self.density(at(i), self.range_m, self.range_m))).collect();
        let floor = (1.0 - self.stereo.correct_match) / d;
        let density = Table::of(
            &curve,
            &[
                ("disparity_px", &|(o, _)| rounded(*o)),
                ("density_per_px", &|(_, l)| rounded(*l)),
                ("correct_per_px", &|(_, l)| rounded(l - floor)),
                ("false_per_px", &|_| rounded(floor)),
            ],
        );
        density.save(staging, "density.csv")?;

        let cells = self.cells();
        // Every fifth disparity and at most sixty cells: enough to draw again, few enough to keep.
        let some = cells.iter().step_by(cells.len().div_ceil(60));
        let rows: Vec<_> = some.flat_map(|cell| (0..=DISPARITIES).step_by(5).map(move |i| (*cell, at(i)))).collect();
        let table = Table::of(
            &rows,
            &[
                ("range_m", &|((enter, exit), _)| rounded(0.5 * (enter + exit))),
                ("disparity_px", &|(_, disparity)| rounded(*disparity)),
                ("density_per_px", &|((enter, exit), disparity)| rounded(self.density(*disparity, *enter, *exit))),
            ],
        );
        table.save(staging, "kernel.csv")?;

        let title = format!(
            "Obstacle at {} m, true disparity {} px",
            rounded(self.range_m),
            rounded(self.stereo.disparity(self.range_m, 0.0))
        );
        paper.save(staging, "density.png", &disparity::draw(&title, d, &curve, paper))?;
        let middle = |i: usize| (i as f64 + 0.5) * d / DISPARITIES as f64;
        let row = |i: usize| cells.iter().map(|&(enter, exit)| self.density(middle(i), enter, exit)).collect();
        let far_m = (self.far_m() / self.cell_m).ceil().max(1.0) * self.cell_m;
        let picture = Kernel { far_m, max_disparity: d, density: (0..DISPARITIES).map(row).collect() };
        let title = "P(o | F): density of the reading if the first obstacle is in a cell";
        paper.save(staging, "kernel.png", &kernel::draw(title, &picture, paper))?;
        let configuration = json!({
            "scene": scene,
            "range_m": rounded(self.range_m),
            "cell_m": self.cell_m,
            "sensor": self.stereo,
        });
        staging.record(&Record::new("sensor", json!({ "configuration": configuration, "claims": claims })))
    }
}
