//! Grids that are turned: where their cells lie in the world.

use serde::Serialize;

use crate::GridSpec;

/// A grid whose rows may leave the world's x axis, as ROS maps' may: the grid, turned about its lower-left corner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Frame {
    /// The cells; `origin_m` is where their lower-left corner lies in the world, m.
    pub spec: GridSpec,
    /// Angle from the world's x axis to the rows, counter-clockwise, rad.
    pub yaw_rad: f64,
}

/// A map from points of one grid, in cells from its lower-left corner, to those of another: `columns * (u, v) + start`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellsToCells {
    /// Where one more column leads, and one more row, in cells.
    pub columns: [[f64; 2]; 2],
    /// Where the corner leads, in cells.
    pub start: [f64; 2],
}

impl Frame {
    /// A grid whose rows lie along x.
    pub fn straight(spec: GridSpec) -> Self {
        Self { spec, yaw_rad: 0.0 }
    }

    /// Where a point lies in the world, m; the point is in cells from the lower-left corner.
    pub fn to_world(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.yaw_rad);
        let [x, y] = [u, v].map(|cells| cells * self.spec.cell_m);
        [self.spec.origin_m[0] + cos * x - sin * y, self.spec.origin_m[1] + sin * x + cos * y]
    }

    /// Where a point of the world (m) lies, in cells from the lower-left corner.
    pub fn to_cells(&self, point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.yaw_rad);
        let [x, y] = [0, 1].map(|k| (point[k] - self.spec.origin_m[k]) / self.spec.cell_m);
        [cos * x + sin * y, -sin * x + cos * y]
    }

    /// The middle of the grid in the world, m.
    pub fn middle(&self) -> [f64; 2] {
        self.to_world([0.5 * self.spec.width as f64, 0.5 * self.spec.height as f64])
    }

    /// Where the points of this grid lie in another.
    pub fn cells_to(&self, other: &Self) -> CellsToCells {
        let scale = self.spec.cell_m / other.spec.cell_m;
        let (sin, cos) = libm::sincos(self.yaw_rad - other.yaw_rad);
        CellsToCells {
            columns: [[scale * cos, scale * sin], [-scale * sin, scale * cos]],
            start: other.to_cells(self.spec.origin_m),
        }
    }

    /// The grid after the world about `pivot` (m) was turned by `turn_rad` and then moved by `shift_m`.
    #[must_use]
    pub fn moved(&self, pivot: [f64; 2], shift_m: [f64; 2], turn_rad: f64) -> Self {
        let (sin, cos) = libm::sincos(turn_rad);
        let [x, y] = [0, 1].map(|k| self.spec.origin_m[k] - pivot[k]);
        let origin_m = [pivot[0] + cos * x - sin * y + shift_m[0], pivot[1] + sin * x + cos * y + shift_m[1]];
        Self { spec: GridSpec { origin_m, ..self.spec }, yaw_rad: self.yaw_rad + turn_rad }
    }
}

impl CellsToCells {
    /// Where a point leads.
    pub fn of(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| self.columns[0][k] * u + self.columns[1][k] * v + self.start[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame() -> impl Strategy<Value = Frame> {
        (0.01_f64..2.0, -50.0_f64..50.0, -50.0_f64..50.0, -3.0_f64..3.0).prop_map(|(cell_m, x, y, yaw_rad)| Frame {
            spec: GridSpec { cell_m, origin_m: [x, y], width: 30, height: 20 },
            yaw_rad,
        })
    }

    fn near(a: [f64; 2], b: [f64; 2]) -> bool {
        (0..2).all(|k| (a[k] - b[k]).abs() < 1e-9 * (1.0 + a[k].abs()) * 100.0)
    }

    #[test]
    fn a_quarter_turn_by_hand() {
        let spec = GridSpec { cell_m: 0.5, origin_m: [1.0, 2.0], width: 4, height: 2 };
        let frame = Frame { spec, yaw_rad: std::f64::consts::FRAC_PI_2 };
        assert!(near(frame.to_world([2.0, 1.0]), [0.5, 3.0]));
        assert!(near(frame.middle(), [0.5, 3.0]));
    }

    proptest! {
        #[test]
        fn there_and_back(frame in frame(), other in frame(), u in 0.0_f64..30.0, v in 0.0_f64..20.0) {
            prop_assert!(near(frame.to_cells(frame.to_world([u, v])), [u, v]));
            prop_assert!(near(frame.cells_to(&other).of([u, v]), other.to_cells(frame.to_world([u, v]))));
        }

        #[test]
        fn every_point_moves_as_the_world_does(
            frame in frame(), u in 0.0_f64..30.0, v in 0.0_f64..20.0,
            pivot in [-9.0_f64..9.0, -9.0..9.0], shift in [-9.0_f64..9.0, -9.0..9.0], turn in -3.0_f64..3.0,
        ) {
            let point = frame.to_world([u, v]);
            let (sin, cos) = turn.sin_cos();
            let [x, y] = [0, 1].map(|k| point[k] - pivot[k]);
            let expected = [pivot[0] + cos * x - sin * y + shift[0], pivot[1] + sin * x + cos * y + shift[1]];
            prop_assert!(near(frame.moved(pivot, shift, turn).to_world([u, v]), expected));
        }
    }
}
