//! Deformable texture lattices: a part's look at a key, on a lattice that bends with the part.
//!
//! - [`grid`]: cells of a grid, numbered
//! - [`mesh`]: cells, nodes, and points bound to them
//! - [`unknowns`]: which nodes an alignment moves together
//! - [`shape`]: how much a lattice is bent
//! - [`anchors`]: places that the artist fixed
//! - [`equations`]: linear equations of the nodes under those constraints
//! - [`texture`]: colours of the key on the lattice, and how well a pose explains a picture
//! - [`align`]: the pose that explains a picture best, by Gauss–Newton

pub mod align;
pub mod anchors;
pub mod equations;
pub mod grid;
pub mod mesh;
pub mod shape;
pub mod texture;
pub mod unknowns;
