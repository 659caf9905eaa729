//! The cells that maps are scored on.

use grid::Raster;
use score::Region;

use super::truth::Truth;

/// The regions in the order of tables, and the cells that can be missed.
pub(super) struct Regions {
    pub(super) masks: Vec<(String, Raster<bool>)>,
    pub(super) surface: Raster<bool>,
}

impl Regions {
    /// The whole known truth, every occupied cell of which can be missed, and what the scene names.
    pub(super) fn whole(truth: &Truth) -> Self {
        let all = truth.cells.map(Option::is_some);
        let surface = truth.cells.map(|cell| *cell == Some(true));
        Self { masks: std::iter::once((Region::All.name().to_owned(), all)).chain(named(truth)).collect(), surface }
    }

    /// The cells of the first region that the terminal shows.
    pub(super) fn first(&self) -> &Raster<bool> {
        let first = self.shown().into_iter().next();
        let found = self.masks.iter().find(|(name, _)| Some(name) == first.as_ref());
        found.map_or(&self.surface, |(_, mask)| mask)
    }

    /// The regions that the terminal shows: what could be seen, if that is known, and what the scene names.
    pub(super) fn shown(&self) -> Vec<String> {
        let parts = [Region::Visible, Region::Surface, Region::Shell, Region::Hidden].map(Region::name);
        let names = self.masks.iter().map(|(name, _)| name).filter(|name| !parts.contains(&name.as_str()));
        names.cloned().collect()
    }
}

/// The regions that the scene names.
fn named(truth: &Truth) -> Vec<(String, Raster<bool>)> {
    let regions = truth.scene.iter().flat_map(|scene| &scene.regions);
    regions.map(|region| (region.name.clone(), region.mask(truth.cells.spec()))).collect()
}
