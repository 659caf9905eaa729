//! Several rays in lockstep, a lane to each, so that a processor's vector units work on all of them at once.
//!
//! Everything is written as plain loops over [`Lanes`]; what the processor has is found at run time. No operation is
//! contracted or reordered, so that every processor gives the same bits.

/// Number of lanes.
pub const LANES: usize = 8;

/// A value for every lane.
pub type Lanes<T> = [T; LANES];

/// A value for every lane from its number.
#[inline(always)]
pub fn each<T: Copy + Default>(value: impl Fn(usize) -> T) -> Lanes<T> {
    let mut lanes = [T::default(); LANES];
    for (l, lane) in lanes.iter_mut().enumerate() {
        *lane = value(l);
    }
    lanes
}

/// The readings of several rays, in the sensor's unit, and their bearings, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beams {
    /// One reading per lane.
    pub reading: Lanes<f64>,
    /// One bearing per lane, rad.
    pub bearing_rad: Lanes<f64>,
}

/// Defines a function that is compiled for the widest vectors that a processor has, and for those that all have.
///
/// Its body is one call of a function marked `#[inline(always)]`. A closure for [`pulp`]'s `dispatch` would do the same, but
/// is compiled for narrow vectors where it is too long to be inlined.
#[macro_export]
macro_rules! in_lanes {
    ($(#[$doc:meta])* $vis:vis fn $name:ident<$life:lifetime>($($argument:ident: $type:ty),+ $(,)?) $body:block) => {
        $(#[$doc])*
        $vis fn $name<$life>($($argument: $type),+) {
            struct Job<$life> {
                $($argument: $type),+
            }
            impl<$life> $crate::lanes::pulp::WithSimd for Job<$life> {
                type Output = ();

                #[inline(always)]
                fn with_simd<S: $crate::lanes::pulp::Simd>(self, _: S) {
                    let Self { $($argument),+ } = self;
                    $body
                }
            }
            $crate::lanes::pulp::Arch::new().dispatch(Job { $($argument),+ });
        }
    };
}

#[doc(hidden)]
pub use pulp;
