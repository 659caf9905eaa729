//! Pinhole geometry.

/// The columns of a pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Number of image columns, one viewing ray each.
    pub columns: usize,
    /// Full horizontal field of view, rad, below pi.
    pub field_of_view_rad: f64,
}

impl Camera {
    /// Angle of every column's ray to the optical axis, rad, from the right to the left.
    ///
    /// The columns, not the angles, are evenly spaced: rays are denser towards the borders.
    pub fn bearings_rad(&self) -> Vec<f64> {
        let half_width = libm::tan(0.5 * self.field_of_view_rad);
        let step = 2.0 * half_width / self.columns as f64;
        (0..self.columns).map(|column| libm::atan((column as f64 + 0.5) * step - half_width)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_evenly_spaced_and_symmetric() {
        let bearings = Camera { columns: 120, field_of_view_rad: 1.2 }.bearings_rad();
        let tangents: Vec<f64> = bearings.iter().map(|b| b.tan()).collect();
        let step = 2.0 * 0.6f64.tan() / 120.0;
        for pair in tangents.windows(2) {
            assert!((pair[1] - pair[0] - step).abs() < 1e-14);
        }
        assert!((bearings[0] + bearings[119]).abs() < 1e-15);
        assert!(bearings[119] < 0.6 && bearings[119] > 0.59);
    }
}
