//! The cases.

mod geometry;
mod lights;
mod room;
mod surfaces;

use super::Case;

/// All cases; `full` adds those that take minutes.
pub fn cases(full: bool) -> Vec<Case> {
    let mut all = geometry::cases();
    all.extend(lights::cases(full));
    all.extend(surfaces::cases(full));
    all
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn names_are_unique() {
        let all = cases(true);
        let names: BTreeSet<&str> = all.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names.len(), all.len());
    }
}
