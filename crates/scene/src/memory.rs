//! How much memory a scene may take.

use std::fs;

/// What a few mappers, their results and the truth keep per cell, bytes. Measured with the three
/// mappers that `room` runs by default: 213, of which a pairwise map with its sums takes 72.
pub(crate) const BYTES_PER_CELL: u64 = 220;

/// What a simulation keeps per ray, bytes: bearing, reading and true range.
pub(crate) const BYTES_PER_RAY: u64 = 40;

/// Taken for free where the system does not tell (no `/proc/meminfo`): 4 GiB.
const FALLBACK: u64 = 4 << 30;

/// Memory that a new program can use without swapping, bytes.
pub(crate) fn available() -> u64 {
    fs::read_to_string("/proc/meminfo").ok().and_then(|text| free(&text)).unwrap_or(FALLBACK)
}

fn free(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meminfo_is_in_kibibytes() {
        assert_eq!(free("MemTotal:  16 kB\nMemAvailable:    7 kB\n"), Some(7168));
        assert_eq!(free("MemTotal: 16 kB\n"), None);
        assert_eq!(free("MemAvailable: lots"), None);
    }
}
