//! The stages joined.
