//! Nothing but its `Cargo.toml`, which says why it exists.
