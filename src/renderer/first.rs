// SPDX-License-Identifier: MIT OR Apache-2.0
//! The order in which adapters are tried until one opens. Knows no adapter.

/// The reason why one does not serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The host has asked for what it cannot do.
    Unfit,
    /// The driver gives no device.
    Closed,
}

/// The first of `found`, the best first, that opens. Hardware goes before software, that also which only `more` finds:
/// it is asked where hardware was found and does not open.
pub fn first_that_opens<A, T>(
    found: Vec<A>,
    is_software: impl Fn(&A) -> bool,
    more: impl FnOnce() -> Vec<A>,
    mut open: impl FnMut(A) -> Result<T, Refusal>,
) -> Option<T> {
    let (software, hardware) = found.into_iter().partition::<Vec<_>, _>(is_software);
    let mut closed = false;
    for adapter in hardware {
        match open(adapter) {
            Ok(opened) => return Some(opened),
            Err(refusal) => closed |= refusal == Refusal::Closed,
        }
    }
    let more = if closed { more() } else { Vec::new() };
    more.into_iter().chain(software).find_map(|adapter| open(adapter).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names that are tried, and the one that opens; `more` is there to be found.
    fn search(
        found: &[&'static str],
        more: &[&'static str],
        opens: &[&str],
    ) -> (Vec<&'static str>, Option<&'static str>) {
        let mut tried = Vec::new();
        let open = |name: &'static str| {
            tried.push(name);
            let refusal = if name.ends_with("elsewhere") { Refusal::Unfit } else { Refusal::Closed };
            if opens.contains(&name) { Ok(name) } else { Err(refusal) }
        };
        let opened = first_that_opens(found.to_vec(), |name| name.starts_with("soft"), || more.to_vec(), open);
        (tried, opened)
    }

    #[test]
    fn hardware_that_does_not_open_has_gl_tried_before_software() {
        let found = ["d3d12", "software"];
        let everything = ["d3d12", "software", "gl"];
        assert_eq!(search(&found, &["gl"], &everything), (vec!["d3d12"], Some("d3d12")));
        assert_eq!(search(&found, &["gl", "fxc"], &everything[1..]), (vec!["d3d12", "gl"], Some("gl")));
        assert_eq!(search(&found, &["gl", "fxc"], &["software"]).0, ["d3d12", "gl", "fxc", "software"]);
        assert_eq!(search(&found, &[], &["software"]), (vec!["d3d12", "software"], Some("software")));
        assert_eq!(search(&found, &["gl"], &[]), (vec!["d3d12", "gl", "software"], None));
    }

    #[test]
    fn gl_is_not_looked_for_where_no_driver_has_failed() {
        // Without hardware the search that found this has looked at GL already.
        assert_eq!(search(&["software"], &["gl"], &["software", "gl"]), (vec!["software"], Some("software")));
        // A window that hardware cannot present to is none that GL could.
        let found = ["vulkan elsewhere", "software"];
        assert_eq!(search(&found, &["gl"], &["software", "gl"]).1, Some("software"));
    }
}
