//! A sensor for every mapper.

use crate::{FastKernel, InverseModel};

/// A sensor that any mapper can be made for: a [`Kernel`](crate::Kernel), with what the conventional rules ask
/// ([`InverseModel`]) and what mappers ask to be fast ([`FastKernel`]). A sensor of your own implements the kernel, and takes
/// over of the other two what it likes.
pub trait SensorModel: InverseModel + FastKernel {}

impl<S: InverseModel + FastKernel + ?Sized> SensorModel for S {}
