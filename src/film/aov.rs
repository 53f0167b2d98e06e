//! Auxiliary images (arbitrary output variables) that go beside the picture into one file.

/// One channel of an auxiliary image.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Layer and channel as EXR spells them: `albedo.R`.
    pub name: String,
    /// One value per pixel, row-major from the top left.
    pub samples: Samples,
}

/// A channel's values.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Quantities.
    Float(Vec<f32>),
    /// Identifiers; 0 is none.
    Uint(Vec<u32>),
}

impl Samples {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Float(v) => v.len(),
            Self::Uint(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Channel {
    /// A channel of quantities.
    pub fn float(name: impl Into<String>, values: impl IntoIterator<Item = f32>) -> Self {
        Self { name: name.into(), samples: Samples::Float(values.into_iter().collect()) }
    }

    /// A channel of identifiers.
    pub fn uint(name: impl Into<String>, values: impl IntoIterator<Item = u32>) -> Self {
        Self { name: name.into(), samples: Samples::Uint(values.into_iter().collect()) }
    }

    /// Three channels of one layer, `layer.` and a name of `names` each.
    pub fn triple(layer: &str, names: [&str; 3], values: &[[f32; 3]]) -> [Self; 3] {
        [0, 1, 2].map(|i| Self::float(format!("{layer}.{}", names[i]), values.iter().map(|v| v[i])))
    }
}
