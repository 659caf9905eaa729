//! What the numbers of a run depend on besides its configuration.

use std::collections::BTreeMap;

/// Packages whose version can move a number.
const DECISIVE: [&str; 6] = ["libm", "parry2d-f64", "rand", "rand_chacha", "rand_distr", "rapier2d-f64"];

/// The versions of this program and of the packages that decide its numbers, from the lock file it
/// was built with.
pub fn versions() -> BTreeMap<String, String> {
    let mut versions = BTreeMap::from([("experiments".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]);
    let lock: toml::Table = include_str!("../../../Cargo.lock").parse().unwrap_or_default();
    for package in lock.get("package").and_then(|p| p.as_array()).into_iter().flatten() {
        let text = |key: &str| package.get(key).and_then(toml::Value::as_str);
        if let (Some(name), Some(version)) = (text("name"), text("version"))
            && DECISIVE.contains(&name)
        {
            versions.insert(name.to_owned(), version.to_owned());
        }
    }
    versions
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_lock_file_names_every_decisive_package() {
        assert_eq!(super::versions().len(), super::DECISIVE.len() + 1, "{:?}", super::versions());
    }
}
