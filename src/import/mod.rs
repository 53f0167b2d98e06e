//! Files to scene descriptions: one module per format.
