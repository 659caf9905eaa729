//! Colours and lettering.

use std::sync::OnceLock;

use plotters::prelude::*;
use plotters::style::{FontStyle, register_font as register};

use crate::failure::Failure;

/// Text.
pub const INK: RGBColor = RGBColor(34, 34, 34);

/// Captions and frames that should step back.
pub const FAINT: RGBColor = RGBColor(120, 120, 120);

/// A named region.
pub const REGION: RGBColor = RGBColor(213, 94, 0);

/// The robot and its route.
pub const ROUTE: RGBColor = RGBColor(0, 114, 178);

/// Cells whose truth is not known.
pub const UNKNOWN: RGBColor = RGBColor(214, 222, 230);

/// Line colours that colour-blind readers can tell apart (Okabe and Ito 2008).
pub const LINES: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];

/// Sizes of lettering, px.
pub const TITLE: u32 = 22;
pub const LABEL: u32 = 20;

static FONT: OnceLock<bool> = OnceLock::new();

/// Makes the bundled font known, once.
pub fn register_font() -> Result<(), Failure> {
    let bytes = include_bytes!("../../fonts/OpenSans-Regular.ttf");
    let known = FONT.get_or_init(|| register("sans-serif", FontStyle::Normal, bytes).is_ok());
    if *known { Ok(()) } else { Err(Failure::internal("the bundled font cannot be read")) }
}

/// Lettering of the given size and colour.
pub fn letters(size: u32, colour: &RGBColor) -> TextStyle<'_> {
    ("sans-serif", size).into_font().color(colour)
}

/// Colour of an occupancy: white for free, black for occupied, and light grey for the prior, so that
/// what is not known does not look free. Linear in log odds between those, since evidence is.
pub fn occupancy(p: f64, prior: f64) -> RGBColor {
    const CERTAIN: f64 = 4.6; // log odds of 0.99
    const AT_PRIOR: f64 = 200.0;
    let odds = |p: f64| libm::log(p / (1.0 - p));
    let (at, from) = (odds(p.clamp(1e-9, 1.0 - 1e-9)), odds(prior.clamp(1e-3, 1.0 - 1e-3)));
    let level = if at <= from {
        let share = ((from - at) / (CERTAIN + from).max(1.0)).min(1.0);
        AT_PRIOR + share * (255.0 - AT_PRIOR)
    } else {
        let share = ((at - from) / (CERTAIN - from)).min(1.0);
        AT_PRIOR * (1.0 - share)
    };
    let level = level.round() as u8;
    RGBColor(level, level, level)
}

/// Colour of the truth: as a map without doubt.
pub fn truth(cell: Option<bool>) -> RGBColor {
    match cell {
        Some(true) => BLACK,
        Some(false) => WHITE,
        None => UNKNOWN,
    }
}
