//! Where everything that moves was at each scan.

use crate::{Origin, Shape};

/// What kind of thing moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThingKind {
    /// A `[[mover]]`.
    Person,
    /// A `[[door]]`.
    Door,
    /// A `[[chair]]`.
    Chair,
}

/// Something that moves.
#[derive(Debug, Clone, PartialEq)]
struct Thing {
    kind: ThingKind,
    texture: f64,
    origin: Origin,
}

/// Where everything that moves was at each scan of a drive. Things are numbered from 0: movers, then doors, then
/// chairs, each in the order of the file. Empty for a scene in which nothing moves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    things: Vec<Thing>,
    /// All things at the first scan, then all at the second, and so on.
    shapes: Vec<Shape>,
}

impl Motion {
    /// No scans yet, of the things of a scene.
    pub(crate) fn of(scene: &crate::Scene) -> Self {
        let thing = |kind, texture, origin: &Origin| Thing { kind, texture, origin: origin.clone() };
        let movers = scene.movers.iter().map(|m| thing(ThingKind::Person, m.texture, &m.origin));
        let doors = scene.doors.iter().map(|d| thing(ThingKind::Door, d.texture, &d.origin));
        let chairs = scene.chairs.iter().map(|c| thing(ThingKind::Chair, c.texture, &c.origin));
        Self { things: movers.chain(doors).chain(chairs).collect(), shapes: Vec::new() }
    }

    /// Adds a scan: one shape per thing.
    pub(crate) fn add<'a>(&mut self, shapes: impl Iterator<Item = &'a Shape>) {
        self.shapes.extend(shapes.cloned());
        debug_assert!(self.things.is_empty() || self.shapes.len().is_multiple_of(self.things.len()));
    }

    /// Whether nothing moves in the scene.
    pub fn is_empty(&self) -> bool {
        self.things.is_empty()
    }

    /// Number of things.
    pub fn len(&self) -> usize {
        self.things.len()
    }

    /// The same things at these scans of it only, in this order.
    ///
    /// # Panics
    /// If something moves and there is no such scan.
    pub fn at(&self, scans: &[usize]) -> Self {
        let n = self.things.len();
        let shapes = match n {
            0 => Vec::new(),
            n => scans.iter().flat_map(|scan| &self.shapes[scan * n..(scan + 1) * n]).cloned().collect(),
        };
        Self { things: self.things.clone(), shapes }
    }

    /// What kind of thing it is.
    ///
    /// # Panics
    /// If there is no such thing.
    pub fn kind(&self, thing: usize) -> ThingKind {
        self.things[thing].kind
    }

    /// Where the scene file describes it.
    ///
    /// # Panics
    /// If there is no such thing.
    pub fn origin(&self, thing: usize) -> &Origin {
        &self.things[thing].origin
    }

    /// Factor on the detection rate of readings on it, 0 to 1.
    ///
    /// # Panics
    /// If there is no such thing.
    pub fn texture(&self, thing: usize) -> f64 {
        self.things[thing].texture
    }

    /// What messages call the things, such as `mover 2 (line 31)`.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.things.iter().map(|thing| thing.origin.to_string())
    }

    /// Number and shape of every thing, placed in the world as it was at a scan, counted from 0.
    ///
    /// # Panics
    /// If something moves and there is no such scan.
    pub fn shapes_at(&self, scan: usize) -> impl Iterator<Item = (usize, &Shape)> {
        let n = self.things.len();
        self.shapes[scan * n..(scan + 1) * n].iter().enumerate()
    }
}
