//! What the numbers were measured on.

/// Name of the processor, as far as the system gives it.
pub(super) fn name() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model(&told).unwrap_or("unknown processor").to_owned()
}

/// The first model name of `/proc/cpuinfo`.
fn model(told: &str) -> Option<&str> {
    let named = told.lines().filter_map(|line| line.split_once(':')).find(|(key, _)| key.trim() == "model name");
    named.map(|(_, name)| name.trim()).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_the_first_model() {
        assert_eq!(
            model("processor\t: 0\nmodel name\t: Some CPU: 2 GHz \nmodel name\t: other\n"),
            Some("Some CPU: 2 GHz")
        );
        assert_eq!(model("processor\t: 0\nmodel name\t:\n"), None);
        assert_eq!(model(""), None);
    }
}
