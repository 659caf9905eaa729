//! How much memory a scene may take.

use std::fs;
use std::path::Path;

/// What a few mappers, their results and the truth keep per cell, bytes. Measured with the three
/// mappers that `room` runs by default: 213, of which a pairwise map with its sums takes 72.
pub(crate) const BYTES_PER_CELL: u64 = 220;

/// What a simulation keeps per ray, bytes: bearing, reading and true range.
pub(crate) const BYTES_PER_RAY: u64 = 40;

/// What a drive keeps per scan of everything that moves, bytes: its shape.
pub(crate) const BYTES_PER_THING: u64 = 64;

/// Taken for free where the system does not tell (no `/proc/meminfo`): 4 GiB.
const FALLBACK: u64 = 4 << 30;

/// Memory that this program can still use without swapping, bytes: what the system has free, or what the program's control group
/// leaves it, if that is less. 4 GiB where the system tells neither.
pub fn available() -> u64 {
    let system = fs::read_to_string("/proc/meminfo").ok().and_then(|text| free(&text)).unwrap_or(FALLBACK);
    let group = fs::read_to_string("/proc/self/cgroup").ok().and_then(|groups| left_to(&groups));
    group.map_or(system, |left| left.min(system))
}

/// What the control groups of `/proc/self/cgroup` leave: the least of all folders up to the root that have a limit.
fn left_to(groups: &str) -> Option<u64> {
    let folders = groups.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        match controllers {
            "" => Some((Path::new("/sys/fs/cgroup"), path.to_owned(), ["memory.max", "memory.current"])),
            _ if controllers.split(',').any(|name| name == "memory") => {
                let files = ["memory.limit_in_bytes", "memory.usage_in_bytes"];
                Some((Path::new("/sys/fs/cgroup/memory"), path.to_owned(), files))
            }
            _ => None,
        }
    });
    let left = folders.flat_map(|(root, path, [limit, usage])| {
        let levels: Vec<_> = Path::new(&path).ancestors().map(|level| root.join(level)).collect();
        levels.into_iter().filter_map(move |level| left_in(&level.join(limit), &level.join(usage)))
    });
    left.min()
}

/// A limit less what is used; none without a limit (`max`).
fn left_in(limit: &Path, usage: &Path) -> Option<u64> {
    let number = |path: &Path| fs::read_to_string(path).ok()?.trim().parse::<u64>().ok();
    Some(number(limit)?.saturating_sub(number(usage)?))
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
    fn a_group_leaves_its_limit_less_its_use() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let [limit, usage] = ["memory.max", "memory.current"].map(|name| folder.path().join(name));
        fs::write(&limit, "1000\n").expect("writable");
        assert_eq!(left_in(&limit, &usage), None, "no use is told");
        fs::write(&usage, "400\n").expect("writable");
        assert_eq!(left_in(&limit, &usage), Some(600));
        fs::write(&limit, "max\n").expect("writable");
        assert_eq!(left_in(&limit, &usage), None);
        assert_eq!(left_to("3:cpuset:/\n1:cpu,cpuacct:/a\nnonsense"), None);
    }

    #[test]
    fn meminfo_is_in_kibibytes() {
        assert_eq!(free("MemTotal:  16 kB\nMemAvailable:    7 kB\n"), Some(7168));
        assert_eq!(free("MemTotal: 16 kB\n"), None);
        assert_eq!(free("MemAvailable: lots"), None);
    }
}
