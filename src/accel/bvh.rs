//! Pure-Rust BVH backend.
