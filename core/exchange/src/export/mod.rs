//! Exports the tracked parts to other programs.
//!
//! - [`svg`](mod@svg): one animated path for each part and each stroke
//! - [`after_effects`](mod@after_effects): a script that makes masks in After Effects
//! - [`archive`]: writes the XML archives of Boost
//! - [`natron`](mod@natron): a script that makes a Roto node in Natron
//! - [`natron_project`](mod@natron_project): a project of Natron with a Roto node
//! - [`nuke`](mod@nuke): a RotoPaint node for Nuke
//! - [`silhouette`](mod@silhouette): Silhouette shapes
//! - `names`: names of parts in the characters of a format
//! - [`outlines`]: contours with the same number of points on every frame
//! - `presence`: when a part is there
//! - [`xml`]: escaping of text for XML

pub mod after_effects;
pub mod archive;
mod names;
pub mod natron;
pub mod natron_project;
pub mod nuke;
pub mod outlines;
mod presence;
pub mod silhouette;
pub mod svg;
pub mod xml;

pub use after_effects::after_effects;
pub use names::renamed;
pub use natron::natron;
pub use natron_project::natron_project;
pub use nuke::nuke;
pub use silhouette::silhouette;
pub use svg::{Motion, SvgFill, SvgOptions, SvgStroke, svg, svg_with_drawn};

use rototoon_base::scene::{Falloff, FalloffCurve, Scene};

/// Indices of the parts in the order of shape lists: nearest first; of equal depths the later part first.
fn nearest_first(scene: &Scene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.sort_by(|&a, &b| scene.parts[b].depth.total_cmp(&scene.parts[a].depth).then(b.cmp(&a)));
    order
}

/// Whether a file with this extension has all of a falloff.
pub fn has_falloff(extension: &str, falloff: Falloff) -> bool {
    let curve = falloff.curve.unwrap_or_default();
    match extension {
        "nk" => curve == FalloffCurve::Smooth,
        "py" | "ntp" => curve == FalloffCurve::Smooth && falloff.rate <= natron::MOST_FALLOFF,
        "jsx" => falloff.rate == 1.0 && matches!(curve, FalloffCurve::Smooth | FalloffCurve::Linear),
        _ => falloff.is_plain(),
    }
}

/// A coordinate to a ten-thousandth of a pixel, as scripts take it. A whole number has no point, and −0 is 0.
fn coordinate(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_form_has_what_it_can_of_a_falloff() {
        let plain = Falloff::default();
        let rate = Falloff { rate: 3.0, curve: None };
        let fast = Falloff { rate: 8.0, curve: None };
        let even = Falloff { rate: 1.0, curve: Some(FalloffCurve::Linear) };
        let eased = Falloff { rate: 1.0, curve: Some(FalloffCurve::EaseIn) };
        for (extension, has) in [
            ("nk", [true, true, true, false, false]),
            ("py", [true, true, false, false, false]),
            ("ntp", [true, true, false, false, false]),
            ("jsx", [true, false, false, true, false]),
            ("fxs", [true, false, false, false, false]),
            ("svg", [true, false, false, false, false]),
        ] {
            assert_eq!(
                [plain, rate, fast, even, eased].map(|falloff| has_falloff(extension, falloff)),
                has,
                "{extension}"
            );
        }
    }
}
