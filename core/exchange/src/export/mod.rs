//! What was found, for other programs.
//!
//! - [`svg`](mod@svg): one animated path a part
//! - [`nuke`](mod@nuke): a RotoPaint node
//! - [`silhouette`](mod@silhouette): Silhouette shapes
//! - [`outlines`]: contours with one number of points
//! - [`xml`]: text in XML

pub mod nuke;
pub mod outlines;
pub mod silhouette;
pub mod svg;
pub mod xml;

pub use nuke::nuke;
pub use silhouette::silhouette;
pub use svg::{Motion, SvgOptions, svg};

use rototoon_base::scene::Scene;

/// The parts as lists of shapes hold them: the nearest first, of equal depths the later one.
fn nearest_first(scene: &Scene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.sort_by(|&a, &b| scene.parts[b].depth.total_cmp(&scene.parts[a].depth).then(b.cmp(&a)));
    order
}
