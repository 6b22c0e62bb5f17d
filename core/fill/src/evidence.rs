//! What is kept about each region from which the [`confidence`](crate::confidence) in its colour was found.

/// Number of pieces of evidence.
pub const COUNT: usize = 4;
/// Their names, in the order of [`Evidence`].
pub const NAMES: [&str; COUNT] = ["clear", "around", "crowd", "past"];
/// The evidence about a region's colour.
pub type Evidence = [f64; COUNT];
