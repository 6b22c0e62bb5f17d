//! Deformable texture lattices: a part's appearance at a key, on a lattice that bends with the part.
//!
//! The key's picture is sampled over square cells that cover the part. A pose is a set of places of the cells' corners,
//! the nodes. A pose is good if the picture has the key's colours at the moved samples and if the cells are only
//! rotated, shifted and slightly scaled. Cartoons have flat colours and clear lines, so this appearance identifies a
//! part even after large motions.
//!
//! - [`grid`]: cells of a grid, numbered
//! - [`mesh`]: cells, nodes, and points bound to them
//! - [`limb`]: long parts, which fold at joints
//! - [`necks`]: necks of a contour, and what is behind them turned
//! - [`unknowns`]: which nodes an alignment moves together
//! - [`shape`]: how much a lattice is bent
//! - [`anchors`]: the artist's corrections as constraints
//! - [`equations`]: linear equations of the nodes under these constraints
//! - [`texture`]: the key's colours on the lattice, and how well a pose explains a picture
//! - [`align`]: the pose that explains a picture best, by Gauss–Newton

pub mod align;
pub mod anchors;
pub mod equations;
pub mod grid;
pub mod limb;
pub mod mesh;
pub mod necks;
pub mod shape;
pub mod texture;
pub mod unknowns;
