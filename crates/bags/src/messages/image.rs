//! Images that tell distances: `sensor_msgs/Image` of depths with its `CameraInfo`, and `stereo_msgs/DisparityImage`.

use std::ops::Range;

use super::fields::{Fields, Short};
use super::header::Header;
use crate::record::Encoding;

/// An image, whose pixels stay where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<'a> {
    /// When, and in which frame: that of the camera, z forward and x to the right (REP 103).
    pub header: Header,
    /// Number of rows.
    pub height: usize,
    /// Number of columns.
    pub width: usize,
    /// How pixels are written, such as `16UC1`.
    pub encoding: String,
    is_big: bool,
    /// Bytes from one row to the next.
    step: usize,
    data: &'a [u8],
}

/// What a camera is.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraInfo {
    /// When, and in which frame.
    pub header: Header,
    /// Focal length in pixels along a row; 0 where the camera is not calibrated.
    pub focal_px: f64,
    /// The column and the row in which the axis of the camera is seen, px from the middle of the first pixel.
    pub centre_px: [f64; 2],
}

/// Disparities of a stereo camera.
#[derive(Debug, Clone, PartialEq)]
pub struct DisparityImage<'a> {
    /// When, and in which frame.
    pub header: Header,
    /// The disparities, px, `32FC1`.
    pub image: Image<'a>,
    /// Focal length, px.
    pub focal_px: f64,
    /// Distance of the cameras, m.
    pub baseline_m: f64,
    /// Disparities below are no match, px.
    pub min_px: f64,
    /// Disparities above are not searched, px.
    pub max_px: f64,
}

impl<'a> Image<'a> {
    /// Its type.
    pub const KIND: &'static str = "sensor_msgs/Image";

    /// Reads a message.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, String> {
        Self::of(&mut Fields::of(encoding, bytes)?)
    }

    fn of(fields: &mut Fields<'a>) -> Result<Self, Short> {
        let header = Header::of(fields)?;
        let [height, width] = [fields.u32()? as usize, fields.u32()? as usize];
        let encoding = fields.text()?;
        let is_big = fields.u8()? != 0;
        let step = fields.u32()? as usize;
        Ok(Self { header, height, width, encoding, is_big, step, data: fields.byte_list()? })
    }

    /// Whether the pixels are depths: `16UC1` in mm or `32FC1` in m (REP 118).
    pub fn is_of_depths(&self) -> bool {
        matches!(self.encoding.as_str(), "16UC1" | "32FC1")
    }

    /// Depths in some of the rows, m, row after row; NaN where there is none.
    ///
    /// # Errors
    /// Another encoding; rows that the image does not have.
    pub fn depths_m(&self, rows: Range<usize>) -> Result<Vec<Vec<f64>>, String> {
        match self.encoding.as_str() {
            "16UC1" => self.rows(rows, |pixel: [u8; 2], is_big| {
                let mm = if is_big { u16::from_be_bytes(pixel) } else { u16::from_le_bytes(pixel) };
                if mm == 0 { f64::NAN } else { f64::from(mm) / 1000.0 }
            }),
            "32FC1" => self.rows(rows, single),
            other => {
                let other: String = other.chars().take(20).collect();
                Err(format!("the image has pixels of {other:?}, of which depths are 16UC1 (mm) or 32FC1 (m)"))
            }
        }
    }

    fn rows<const N: usize>(
        &self,
        rows: Range<usize>,
        pixel: impl Fn([u8; N], bool) -> f64,
    ) -> Result<Vec<Vec<f64>>, String> {
        let long = self.width.checked_mul(N).filter(|long| *long <= self.step);
        let whole = self.step.checked_mul(self.height).filter(|whole| *whole <= self.data.len());
        let (Some(long), Some(_), true) = (long, whole, rows.end <= self.height) else {
            return Err(format!(
                "the image claims {} rows of {} pixels, {} bytes from row to row, and has {} bytes",
                self.height,
                self.width,
                self.step,
                self.data.len()
            ));
        };
        let row = |row: usize| {
            let bytes = &self.data[row * self.step..][..long];
            bytes.as_chunks::<N>().0.iter().map(|bytes| pixel(*bytes, self.is_big)).collect()
        };
        Ok(rows.map(row).collect())
    }
}

fn single(pixel: [u8; 4], is_big: bool) -> f64 {
    f64::from(if is_big { f32::from_be_bytes(pixel) } else { f32::from_le_bytes(pixel) })
}

impl CameraInfo {
    /// Its type.
    pub const KIND: &'static str = "sensor_msgs/CameraInfo";

    /// Reads a message. The images are taken for rectified: of the projection matrix P, else of the camera's own matrix K.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        let header = Header::of(&mut fields)?;
        let _ = [fields.u32()?, fields.u32()?];
        fields.text()?;
        fields.pass_f64_list()?;
        let own: [f64; 9] = fields.f64s()?;
        let _: [f64; 9] = fields.f64s()?;
        let projection: [f64; 12] = fields.f64s()?;
        let (focal_px, centre_px) = match projection {
            [focal, _, u, _, _, _, v, ..] if focal > 0.0 => (focal, [u, v]),
            _ => (own[0], [own[2], own[5]]),
        };
        Ok(Self { header, focal_px, centre_px })
    }
}

impl<'a> DisparityImage<'a> {
    /// Its type.
    pub const KIND: &'static str = "stereo_msgs/DisparityImage";

    /// Reads a message.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        let header = Header::of(&mut fields)?;
        let image = Image::of(&mut fields)?;
        let [focal_px, baseline_m] = [fields.f32()?, fields.f32()?];
        let _ = [fields.u32()?, fields.u32()?, fields.u32()?, fields.u32()?]; // the window in which there can be matches
        fields.u8()?;
        let [min_px, max_px] = [fields.f32()?, fields.f32()?];
        Ok(Self { header, image, focal_px, baseline_m, min_px, max_px })
    }

    /// Disparities in some of the rows, px, row after row; NaN where there is no match: below the least, or not finite.
    ///
    /// # Errors
    /// Pixels that are not `32FC1`; rows that the image does not have.
    pub fn disparities_px(&self, rows: Range<usize>) -> Result<Vec<Vec<f64>>, String> {
        if self.image.encoding != "32FC1" {
            let other: String = self.image.encoding.chars().take(20).collect();
            return Err(format!("the disparities have pixels of {other:?}, which must be 32FC1"));
        }
        let mut rows = self.image.rows(rows, single)?;
        let is_match = |disparity: f64| disparity > 0.0 && disparity >= self.min_px;
        rows.iter_mut()
            .flatten()
            .filter(|disparity| !is_match(**disparity))
            .for_each(|disparity| *disparity = f64::NAN);
        Ok(rows)
    }
}
