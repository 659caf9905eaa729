//! What is built at the first build: a package that a change adds shows in its diff, since all of them are paid for by
//! whoever tries the project.

use std::process::Command;

/// Packages that the default build compiles for a new user on Linux, the workspace's own among them.
const MOST: usize = 158;

#[test]
fn the_packages_of_the_default_build_are_known() {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--package", "experiments", "--edges", "normal,build"])
        .args(["--target", "x86_64-unknown-linux-gnu", "--prefix", "none", "--format", "{p}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let text = String::from_utf8(tree.stdout).expect("text");
    // Name and version; what follows is a path, or says that a package stands above already.
    let package = |line: &str| line.split(' ').take(2).collect::<Vec<_>>().join(" ");
    let mut packages: Vec<String> = text.lines().map(package).filter(|line| !line.is_empty()).collect();
    packages.sort();
    packages.dedup();
    let names: Vec<&str> = packages.iter().filter_map(|package| package.split(' ').next()).collect();
    insta::assert_snapshot!(names.join("\n"));
    assert!(packages.len() <= MOST, "{} packages: look for a lighter one, or leave something out", packages.len());
}
