//! Confidence over time as a small picture in SVG.

use crate::findings::Findings;
use rototoon::scene::FrameNumber;
use std::fmt::Write;

/// Size of the picture in its own units.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 72.0;

/// The least confidence of any part over the frames, with a mark at each frame that wants a key. Empty without tracks.
pub fn confidence(findings: &Findings) -> String {
    let (Some(first), Some(last)) = (findings.least.keys().next(), findings.least.keys().next_back()) else {
        return String::new();
    };
    let span = (f64::from(*last) - f64::from(*first)).max(1.0);
    let x = |frame: FrameNumber| (f64::from(frame) - f64::from(*first)) / span * WIDTH;
    let y = |value: f64| (1.0 - value) * HEIGHT;
    let points: Vec<String> = findings.least.iter().map(|(&f, &v)| format!("{:.1},{:.1}", x(f), y(v))).collect();
    let mut out = format!(
        "<svg class=\"chart\" viewBox=\"-2 -2 {} {}\" preserveAspectRatio=\"none\" role=\"img\" \
         aria-label=\"Least confidence from frame {first} to frame {last}\">",
        WIDTH + 4.0,
        HEIGHT + 4.0
    );
    let _ = write!(out, "<line class=\"half\" x1=\"0\" x2=\"{WIDTH}\" y1=\"{0}\" y2=\"{0}\"/>", HEIGHT / 2.0);
    for key in findings.wanted.iter().filter(|key| (*first..=*last).contains(&key.frame)) {
        let _ =
            write!(out, "<line class=\"want\" x1=\"{0:.1}\" x2=\"{0:.1}\" y1=\"0\" y2=\"{HEIGHT}\"/>", x(key.frame));
    }
    let _ = write!(out, "<polyline points=\"{}\"/></svg>", points.join(" "));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::WantedKey;

    #[test]
    fn the_line_runs_from_the_first_frame_to_the_last() {
        let findings = Findings {
            least: [(10, 1.0), (11, 0.5), (12, 0.0)].into(),
            wanted: vec![WantedKey { frame: 12, ..WantedKey::default() }],
            ..Findings::default()
        };
        let picture = confidence(&findings);
        assert!(picture.contains("points=\"0.0,0.0 320.0,36.0 640.0,72.0\""), "{picture}");
        assert!(picture.contains("class=\"want\" x1=\"640.0\""));
        assert_eq!(confidence(&Findings::default()), "");
    }
}
