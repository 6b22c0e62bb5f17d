//! Exports the tracked parts to other programs.
//!
//! - [`svg`](mod@svg): one animated path for each part and each stroke
//! - [`after_effects`](mod@after_effects): a script that makes masks in After Effects
//! - [`archive`]: writes the XML archives of Boost
//! - [`natron`](mod@natron): a script that makes a Roto node in Natron
//! - [`natron_project`](mod@natron_project): a project of Natron with a Roto node
//! - [`nuke`](mod@nuke): a RotoPaint node for Nuke
//! - [`silhouette`](mod@silhouette): Silhouette shapes
//! - [`outlines`]: contours with the same number of points on every frame
//! - [`xml`]: escaping of text for XML

pub mod after_effects;
pub mod archive;
pub mod natron;
pub mod natron_project;
pub mod nuke;
pub mod outlines;
pub mod silhouette;
pub mod svg;
pub mod xml;

pub use after_effects::after_effects;
pub use natron::natron;
pub use natron_project::natron_project;
pub use nuke::nuke;
pub use silhouette::silhouette;
pub use svg::{Motion, SvgOptions, SvgStroke, svg, svg_with_strokes};

use rototoon_base::scene::Scene;

/// Indices of the parts in the order of shape lists: nearest first; of equal depths the later part first.
fn nearest_first(scene: &Scene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.sort_by(|&a, &b| scene.parts[b].depth.total_cmp(&scene.parts[a].depth).then(b.cmp(&a)));
    order
}

/// A coordinate to a ten-thousandth of a pixel, as scripts take it. A whole number has no point, and −0 is 0.
fn coordinate(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
