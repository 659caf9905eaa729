//! Maps that there are not: programs that failed, draws that do not agree.

use crate::failure::Failure;

/// Refuses to call a run good in which a mapper gave no map; a fault is a line with the name of the mapper and the place.
///
/// # Errors
/// The first fault, and how many there are.
pub fn none(faults: &[String]) -> Result<(), Failure> {
    match faults {
        [] => Ok(()),
        [one] => Err(Failure::Claim(format!("a mapper gave no map: {one}"))),
        [first, ..] => Err(Failure::Claim(format!("mappers gave no map {} times, first {first}", faults.len()))),
    }
}
