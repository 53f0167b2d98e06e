//! Scenes: as written (`desc`), and as rendered (`prepare`).

pub mod desc;
