//! Development commands of Rototoon.
fn main() {}
