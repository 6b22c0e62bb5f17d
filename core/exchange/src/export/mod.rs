//! Exports the tracked parts to other programs.
//!
//! - [`svg`](mod@svg): one animated path for each part and each stroke
//! - [`after_effects`](mod@after_effects): a script that makes masks in After Effects
//! - [`archive`]: writes the XML archives of Boost
//! - `bezier`: snapped contours as Bézier curves of few points
//! - [`fusion`](mod@fusion): Polygon masks for Fusion
//! - [`natron`](mod@natron): a script that makes a Roto node in Natron
//! - [`natron_project`](mod@natron_project): a project of Natron with a Roto node
//! - [`nuke`](mod@nuke): a RotoPaint node for Nuke
//! - [`silhouette`](mod@silhouette): Silhouette shapes
//! - `names`: names of parts in the characters of a format
//! - `knot`: points with handles
//! - [`outlines`]: contours with the same number of points on every frame
//! - `presence`: when a part is there
//! - [`xml`]: escaping of text for XML

pub mod after_effects;
pub mod archive;
mod bezier;
pub mod fusion;
pub(crate) mod knot;
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
pub use fusion::fusion;
pub use natron::natron;
pub use natron_project::natron_project;
pub use nuke::nuke;
pub use outlines::{Detail, ShapeOptions};
pub use silhouette::silhouette;
pub use svg::{Motion, SvgFill, SvgOptions, SvgStroke, svg, svg_with_drawn};

use rototoon_base::scene::{Falloff, FalloffCurve, Scene};

/// Indices of the parts in the order of shape lists: nearest first; of equal depths the later part first.
fn nearest_first(scene: &Scene) -> Vec<usize> {
    let (mut order, depths): (Vec<usize>, _) = ((0..scene.parts.len()).collect(), depths(scene));
    order.sort_by(|&a, &b| depths[b].total_cmp(&depths[a]).then(b.cmp(&a)));
    order
}

/// The depth by which each part lies in a file, which has one order for all frames: that on all frames of the footage, else that of the part alone.
fn depths(scene: &Scene) -> Vec<f64> {
    let frames = scene.footage.first..=scene.footage.last;
    scene.parts.iter().map(|part| part.depth_in(frames.clone()).unwrap_or(part.depth)).collect()
}

/// Whether a file with this extension says how wide the pixels of the footage are.
pub fn has_pixel_aspect(extension: &str) -> bool {
    ["nk", "fxs", "setting", "jsx"].contains(&extension)
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

/// The parts whose name a file with this extension cannot write, each with its name there.
pub fn renamed<'a>(scene: &'a Scene, extension: &str) -> Vec<(&'a str, String)> {
    let names = match extension {
        "nk" => names::written(scene, nuke::plain),
        "setting" => names::joined(scene, "_", fusion::plain),
        "ntp" | "fxs" | "svg" => names::written(scene, xml::plain),
        _ => return Vec::new(),
    };
    let both = scene.parts.iter().map(|part| part.name.as_str()).zip(names);
    both.filter(|(name, written)| name != written).collect()
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
            ("setting", [true, false, false, false, false]),
            ("svg", [true, false, false, false, false]),
        ] {
            assert_eq!(
                [plain, rate, fast, even, eased].map(|falloff| has_falloff(extension, falloff)),
                has,
                "{extension}"
            );
        }
    }

    #[test]
    fn a_depth_that_is_the_same_on_all_frames_counts() {
        use rototoon_base::scene::{Footage, Part};
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
        let part = |depth: f64, depths: &[(i32, f64)]| Part {
            depth,
            depths: depths.iter().copied().collect(),
            ..Part::default()
        };
        let marked = part(0.0, &[0, 1, 2, 3].map(|frame| (frame, 5.0)));
        let scene = Scene { footage, parts: vec![marked, part(1.0, &[]), part(0.5, &[(2, 9.0)])] };
        assert_eq!(nearest_first(&scene), [0, 1, 2]);
    }

    #[test]
    fn each_form_tells_the_names_that_it_changes() {
        use rototoon_base::scene::{Footage, Part};
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
        let parts = ["a\"b", "a_b", "\u{1}", "c\u{2}"].map(|name| Part { name: name.into(), ..Part::default() });
        let scene = Scene { footage, parts: parts.into() };
        let nuke = [("a\"b", "a_b 2".into()), ("\u{1}", "_".into()), ("c\u{2}", "c_".into())];
        assert_eq!(renamed(&scene, "nk"), nuke);
        for extension in ["ntp", "fxs", "svg"] {
            assert_eq!(renamed(&scene, extension), [("\u{1}", "part".into()), ("c\u{2}", "c".into())]);
        }
        let fusion = [("a\"b", "a_b_2".into()), ("\u{1}", "_".into()), ("c\u{2}", "c_".into())];
        assert_eq!(renamed(&scene, "setting"), fusion);
        assert_eq!(renamed(&scene, "jsx"), []);
    }
}
