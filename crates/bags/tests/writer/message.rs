//! Messages in every encoding.

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Form {
    Ros1,
    Little,
    Big,
}

pub(crate) const FORMS: [Form; 3] = [Form::Ros1, Form::Little, Form::Big];

/// A message that grows.
pub(crate) struct Writer {
    form: Form,
    bytes: Vec<u8>,
}

pub(crate) const S: u64 = 1_000_000_000;

impl Writer {
    pub(crate) fn new(form: Form) -> Self {
        let bytes = match form {
            Form::Ros1 => Vec::new(),
            Form::Little => vec![0, 1, 0, 0],
            Form::Big => vec![0, 0, 0, 0],
        };
        Self { form, bytes }
    }

    fn number(mut self, bytes: &[u8]) -> Self {
        if self.form != Form::Ros1 {
            while !(self.bytes.len() - 4).is_multiple_of(bytes.len()) {
                self.bytes.push(0xaa); // what pads has no meaning
            }
        }
        let mut bytes = bytes.to_vec();
        if self.form == Form::Big {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
        self
    }

    pub(crate) fn u8(self, value: u8) -> Self {
        self.number(&[value])
    }

    pub(crate) fn u32(self, value: u32) -> Self {
        self.number(&value.to_le_bytes())
    }

    pub(crate) fn f32(self, value: f32) -> Self {
        self.number(&value.to_le_bytes())
    }

    pub(crate) fn f64s(self, values: &[f64]) -> Self {
        values.iter().fold(self, |writer, value| writer.number(&value.to_le_bytes()))
    }

    pub(crate) fn raw(mut self, bytes: &[u8]) -> Self {
        self = self.u32(bytes.len() as u32);
        self.bytes.extend(bytes);
        self
    }

    pub(crate) fn text(self, text: &str) -> Self {
        let end: &[u8] = if self.form == Form::Ros1 { &[] } else { &[0] };
        self.raw(&[text.as_bytes(), end].concat())
    }

    pub(crate) fn header(mut self, stamp_ns: u64, frame: &str) -> Self {
        if self.form == Form::Ros1 {
            self = self.u32(7);
        }
        self.u32((stamp_ns / S) as u32).u32((stamp_ns % S) as u32).text(frame)
    }

    /// A place at height 0.3 m, turned about the vertical axis.
    pub(crate) fn pose(self, [x, y, theta]: [f64; 3]) -> Self {
        self.f64s(&[x, y, 0.3, 0.0, 0.0, (0.5 * theta).sin(), (0.5 * theta).cos()])
    }

    pub(crate) fn done(self) -> Vec<u8> {
        self.bytes
    }
}

/// A scan whose beams go from -1 rad on in steps of `step`.
pub(crate) fn laser(form: Form, stamp_ns: u64, frame: &str, step: f32, ranges: &[f32]) -> Vec<u8> {
    let last = -1.0 + step * ranges.len().saturating_sub(1) as f32;
    let writer = Writer::new(form).header(stamp_ns, frame);
    let writer = [-1.0, last, step, 0.0, 0.1, 0.2, 10.0].iter().fold(writer, |writer, value| writer.f32(*value));
    let writer = ranges.iter().fold(writer.u32(ranges.len() as u32), |writer, range| writer.f32(*range));
    writer.u32(0).done()
}

pub(crate) fn odometry(form: Form, stamp_ns: u64, child: &str, pose: [f64; 3]) -> Vec<u8> {
    Writer::new(form).header(stamp_ns, "odom").text(child).pose(pose).f64s(&[0.0; 36]).f64s(&[0.0; 42]).done()
}

pub(crate) fn posed(form: Form, stamp_ns: u64, frame: &str, pose: [f64; 3]) -> Vec<u8> {
    Writer::new(form).header(stamp_ns, frame).pose(pose).done()
}

/// Transforms: parent, child, and place with turn as a quaternion.
pub(crate) fn transforms(form: Form, stamp_ns: u64, all: &[(&str, &str, [f64; 7])]) -> Vec<u8> {
    let writer = Writer::new(form).u32(all.len() as u32);
    all.iter()
        .fold(writer, |writer, (parent, child, seven)| writer.header(stamp_ns, parent).text(child).f64s(seven))
        .done()
}

/// A place in the plane as seven numbers.
pub(crate) fn flat([x, y, theta]: [f64; 3]) -> [f64; 7] {
    [x, y, 0.0, 0.0, 0.0, (0.5 * theta).sin(), (0.5 * theta).cos()]
}

pub(crate) fn camera(form: Form, stamp_ns: u64, frame: &str, focal: f64, [u, v]: [f64; 2]) -> Vec<u8> {
    let own = [focal, 0.0, u, 0.0, focal, v, 0.0, 0.0, 1.0];
    let projection = [focal, 0.0, u, 0.0, 0.0, focal, v, 0.0, 0.0, 0.0, 1.0, 0.0];
    let writer = Writer::new(form).header(stamp_ns, frame).u32(3).u32(5).text("plumb_bob");
    writer.u32(5).f64s(&[0.0; 5]).f64s(&own).f64s(&[0.0; 9]).f64s(&projection).done()
}

/// An image of three rows of five pixels.
fn image(writer: Writer, stamp_ns: u64, frame: &str, encoding: &str, pixels: &[u8]) -> Writer {
    let step = pixels.len() as u32 / 3;
    writer.header(stamp_ns, frame).u32(3).u32(5).text(encoding).u8(0).u32(step).raw(pixels)
}

/// Depths in mm, three rows of five.
pub(crate) fn depths_mm(form: Form, stamp_ns: u64, frame: &str, depths: &[[u16; 5]; 3]) -> Vec<u8> {
    let pixels: Vec<u8> = depths.iter().flatten().flat_map(|depth| depth.to_le_bytes()).collect();
    image(Writer::new(form), stamp_ns, frame, "16UC1", &pixels).done()
}

/// Depths in m, three rows of five.
pub(crate) fn depths_m(form: Form, stamp_ns: u64, frame: &str, depths: &[[f32; 5]; 3]) -> Vec<u8> {
    let pixels: Vec<u8> = depths.iter().flatten().flat_map(|depth| depth.to_le_bytes()).collect();
    image(Writer::new(form), stamp_ns, frame, "32FC1", &pixels).done()
}

/// Disparities, three rows of five, of a focal length of 50 px, a baseline of 0.3 m, 1 to 64 px.
pub(crate) fn disparities(form: Form, stamp_ns: u64, frame: &str, disparities: &[[f32; 5]; 3]) -> Vec<u8> {
    let pixels: Vec<u8> = disparities.iter().flatten().flat_map(|disparity| disparity.to_le_bytes()).collect();
    let writer = image(Writer::new(form).header(stamp_ns, frame), stamp_ns, frame, "32FC1", &pixels);
    let writer = writer.f32(50.0).f32(0.3).u32(0).u32(0).u32(3).u32(5).u8(0);
    writer.f32(1.0).f32(64.0).f32(0.125).done()
}
