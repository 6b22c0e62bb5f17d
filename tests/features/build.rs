//! Does nothing. It exists because only a package with a build script can have build dependencies.

fn main() {}
