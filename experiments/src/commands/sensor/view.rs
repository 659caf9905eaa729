//! A camera, and what its readings say.

use scene::Scene;
use sensor::{InverseModel as _, Kernel as _, Stereo};

use crate::output::table::{Table, aligned, rounded};
use crate::worlds::claims::{self, Claim};

/// At most so many columns of Figure 7.
const MOST_COLUMNS: usize = 900;

/// A density that integrates to this much less or more is not one.
const ROUNDING: f64 = 1e-4;

/// A camera and what is shown of it.
pub(super) struct View {
    pub(super) stereo: Stereo,
    /// Chord of a cell, m.
    pub(super) cell_m: f64,
    /// Range of Figure 6, m.
    pub(super) range_m: f64,
}

/// The readings of an obstacle in one cell.
pub(super) struct Column {
    enter_m: f64,
    exit_m: f64,
    /// Integral of the density over the search range.
    integral: f64,
    /// What it should be: correct matches that stay in the search range, and all false ones.
    expected: f64,
}

impl View {
    pub(super) fn of(scene: &Scene, range_m: Option<f64>) -> Self {
        let stereo = scene.matcher.stereo;
        let range_m = range_m.unwrap_or_else(|| stereo.range(stereo.max_disparity / 6.0, 0.0));
        Self { stereo, cell_m: scene.grid.cell_m, range_m }
    }

    /// Figure 7 ends where the disparity is a sixtieth of the search range: 1 px for the paper's camera.
    pub(super) fn far_m(&self) -> f64 {
        self.stereo.range(self.stereo.max_disparity / 60.0, 0.0)
    }

    pub(super) fn density(&self, reading: f64, enter_m: f64, exit_m: f64) -> f64 {
        let mut density = [0.0];
        self.stereo.likelihood(reading, 0.0, &[enter_m, exit_m], &mut density);
        density[0]
    }

    /// The cells of Figure 7, or as many of them as are drawn.
    pub(super) fn cells(&self) -> Vec<(f64, f64)> {
        let cells = (self.far_m() / self.cell_m).ceil().max(1.0);
        let drawn = cells.min(MOST_COLUMNS as f64) as usize;
        (0..drawn)
            .map(|i| {
                let cell = (i as f64 * cells / drawn as f64).floor();
                (cell * self.cell_m, (cell + 1.0) * self.cell_m)
            })
            .collect()
    }

    pub(super) fn columns(&self) -> Vec<Column> {
        self.cells().into_iter().map(|(enter_m, exit_m)| self.column(enter_m, exit_m)).collect()
    }

    /// Integrates the density of a chord: the mean of many points where the Gaussian is, the floor elsewhere.
    fn column(&self, enter_m: f64, exit_m: f64) -> Column {
        let Stereo { disparity_sigma: sigma, max_disparity, correct_match, .. } = self.stereo;
        let [near, far] = [enter_m, exit_m].map(|range| self.stereo.disparity(range, 0.0));
        let low = (far - 9.0 * sigma).clamp(0.0, max_disparity);
        let high = (near + 9.0 * sigma).clamp(0.0, max_disparity);
        let points = ((high - low) / sigma * 16.0).clamp(64.0, 100_000.0) as usize;
        let step = (high - low) / points as f64;
        let inside: f64 =
            (0..points).map(|i| self.density(low + (i as f64 + 0.5) * step, enter_m, exit_m)).sum::<f64>() * step;
        let floor = (1.0 - correct_match) * (max_disparity - (high - low)) / max_disparity;
        let half = 0.5 * max_disparity;
        let kept = self.stereo.bin_probability(half, half, 0.0, enter_m, exit_m);
        Column { enter_m, exit_m, integral: inside + floor, expected: correct_match * kept + 1.0 - correct_match }
    }

    pub(super) fn claims(&self, columns: &[Column]) -> Vec<Claim> {
        let point = self.column(self.range_m, self.range_m);
        let off = |c: &Column| (c.integral - c.expected).abs();
        let worst = columns.iter().map(off).fold(0.0, f64::max);
        let whole = columns.iter().filter(|c| (c.expected - 1.0).abs() < 1e-9).count();
        vec![
            Claim {
                claim: format!("Figure 6: the density over the search range, at {} m", rounded(self.range_m)),
                measured: format!("integrates to {:.6}, should be {:.6}", point.integral, point.expected),
                holds: off(&point) <= ROUNDING,
            },
            Claim {
                claim: "Figure 7: every column integrates to one, less the matches it loses".to_owned(),
                measured: format!(
                    "off by at most {worst:.1e}, allowed are {ROUNDING:e}; {whole} of {} columns lose none",
                    columns.len()
                ),
                holds: worst <= ROUNDING,
            },
        ]
    }

    /// Some cells, nearest first.
    pub(super) fn table(&self, columns: &[Column]) -> Table {
        let shown = 16.min(columns.len());
        let some = (0..shown).map(|i| &columns[i * (columns.len() - 1) / (shown - 1).max(1)]);
        let rows: Vec<(f64, &Column)> = some.map(|column| (0.5 * (column.enter_m + column.exit_m), column)).collect();
        let disparity = |range_m| self.stereo.disparity(range_m, 0.0);
        // One standard deviation of disparity as a length: it grows with the square of the range.
        let sigma_m = |middle: f64| self.stereo.disparity_sigma * middle * middle / self.stereo.focal_baseline;
        Table::of(
            &rows,
            &[
                ("range_m", &|(middle, _)| rounded(*middle)),
                ("disparity_px", &|(middle, _)| rounded(disparity(*middle))),
                ("spans_px", &|(_, column)| rounded(disparity(column.enter_m) - disparity(column.exit_m))),
                ("sigma_m", &|(middle, _)| rounded(sigma_m(*middle))),
                ("lost_matches", &|(_, column)| rounded(1.0 - column.expected)),
                ("integral", &|(_, column)| rounded(column.integral)),
            ],
        )
    }

    pub(super) fn text(&self, name: &str, table: &Table, claims: &[Claim]) -> String {
        let s = &self.stereo;
        let mut text = format!(
            "{name}: {} px·m, sigma {} px, correct matches {}, search range 0 to {} px\n\n",
            s.focal_baseline, s.disparity_sigma, s.correct_match, s.max_disparity
        );
        let shown = |value: &serde_json::Value| {
            let value = value.as_f64();
            value.map_or_else(|| "-".to_owned(), |v| if v.abs() < 1e3 { format!("{v:.4}") } else { format!("{v:.4e}") })
        };
        let rows: Vec<Vec<String>> = table.rows().iter().map(|row| row.iter().map(shown).collect()).collect();
        text += &aligned(&["range, m", "disparity, px", "cell spans, px", "sigma, m", "lost", "integral"], &rows);
        text += &claims::below(claims);
        text + "\n"
    }
}
