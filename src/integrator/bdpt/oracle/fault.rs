//! What no rounding explains.

use std::fmt;

/// A mistake in the structure of densities or techniques, as against one of digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structural {
    /// Next-event estimation has no chance to find what shines on the receiver.
    LightMissed,
    /// The two directions of travel give a vertex different densities.
    Densities,
    /// The same of a delta lobe's ratio of densities.
    DeltaDensities,
    /// The production code refuses to make a path that carries light.
    Refused,
}

impl fmt::Display for Structural {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LightMissed => "the choice of the light misses what shines on the receiver",
            Self::Densities => "densities at a vertex differ by the direction of travel",
            Self::DeltaDensities => "densities of a delta lobe differ by the direction of travel",
            Self::Refused => "a technique refuses a path that carries light",
        })
    }
}

/// One of them, with its numbers.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Which it is.
    pub kind: Structural,
    /// Its numbers.
    pub details: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.details.as_str() {
            "" => write!(f, "{}", self.kind),
            details => write!(f, "{}: {details}", self.kind),
        }
    }
}

/// The first of them, and how many there were.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// The first.
    pub first: Option<Fault>,
    /// How many.
    pub count: u64,
}

impl Faults {
    /// One more.
    pub fn push(&mut self, fault: Fault) {
        self.count += 1;
        self.first.get_or_insert(fault);
    }

    /// These, then the others.
    #[must_use]
    pub fn merge(self, o: Self) -> Self {
        Self { first: self.first.or(o.first), count: self.count + o.count }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.first, self.count) {
            (None, _) => f.write_str("none"),
            (Some(first), 1) => write!(f, "{first}"),
            (Some(first), n) => write!(f, "{first} (the first of {n} such paths)"),
        }
    }
}
