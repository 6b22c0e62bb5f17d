//! Command line of Rototoon.
fn main() {}
