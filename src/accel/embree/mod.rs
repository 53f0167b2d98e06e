//! Embree backend.
