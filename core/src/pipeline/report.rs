//! What became of every part of a tracked document: frames sure, doubtful and lost.

use super::unseen;
use crate::scene::outcome::confidence;
use crate::scene::{FrameNumber, Outcome, Scene};
use crate::track::{Exchange, WeakestFrame, twins, weakest_frame};
use serde::Serialize;
use std::collections::BTreeMap;

/// The report on a tracked document.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Numbers of contours over all parts.
    pub contours: Counts,
    /// The frame where the next key helps most. `None` if nothing was tracked between the keys.
    pub weakest_frame: Option<Weakest>,
    /// Each part, in the order of the document.
    pub parts: Vec<PartReport>,
    /// Parts that look alike and lie on one place.
    pub together: Vec<Together>,
    /// Parts that look alike and may have changed places.
    pub exchanges: Vec<Together>,
}

/// Two parts and the frames on which they have something in common: they lie on one place, so one of them is wrong there or hidden by the other one; or
/// nothing says which is which.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Together {
    /// Their names.
    pub parts: [String; 2],
    /// The frames.
    pub frames: Vec<FrameNumber>,
}

/// Numbers of tracked contours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Those that need no look.
    pub sure: usize,
    /// Those that deserve a look.
    pub doubtful: usize,
    /// Those that are probably wrong, and frames on which a part was lost.
    pub lost: usize,
}

/// The weakest frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Weakest {
    /// The frame.
    pub frame: FrameNumber,
    /// How much is in doubt there, in parts.
    pub score: f64,
    /// Names of the parts that are lost or doubtful there, the least sure one first.
    pub parts: Vec<String>,
}

/// The report on a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartReport {
    /// Its name.
    pub name: String,
    /// Frames on which it needs no look. Keys are not listed.
    pub sure: Vec<FrameNumber>,
    /// Frames that deserve a look.
    pub doubtful: Vec<FrameNumber>,
    /// Frames on which it is probably wrong, or was lost.
    pub lost: Vec<FrameNumber>,
    /// Frames just beyond the track of a part with one key, on which it needs another.
    pub wants_key: Vec<FrameNumber>,
    /// Frames on which it can probably not be seen ([`unseen`](fn@super::unseen)): a question for the artist.
    pub unseen: Vec<FrameNumber>,
    /// Mean confidence of its points, by frame.
    pub confidence: BTreeMap<FrameNumber, f64>,
}

impl Report {
    /// The report on a scene with tracks, of which tracking found that these parts may have changed places.
    pub fn of(scene: &Scene, exchanges: &[Exchange]) -> Self {
        let part = |(index, part): (usize, &crate::scene::Part)| {
            let Outcome { sure, doubtful, lost } = Outcome::of(part);
            let (name, wants_key) = (part.name.clone(), part.wants_key.clone());
            let rounded = |value: f64| (value * 1e4).round() / 1e4;
            let confidence = confidence(part).into_iter().map(|(frame, value)| (frame, rounded(value))).collect();
            PartReport { name, sure, doubtful, lost, wants_key, unseen: unseen(scene, index), confidence }
        };
        let parts: Vec<PartReport> = scene.parts.iter().enumerate().map(part).collect();
        let count = |of: fn(&PartReport) -> usize| parts.iter().map(of).sum();
        let contours = Counts {
            sure: count(|p| p.sure.len()),
            doubtful: count(|p| p.doubtful.len()),
            lost: count(|p| p.lost.len()),
        };
        let weakest = weakest_frame(&scene.parts).map(|WeakestFrame { frame, score, parts }| {
            let parts = parts.into_iter().map(|part| scene.parts[part].name.clone()).collect();
            Weakest { frame, score, parts }
        });
        let together = twins(&scene.parts)
            .into_iter()
            .map(|(pair, frames)| Together { parts: pair.map(|part| scene.parts[part].name.clone()), frames });
        let name = |part: usize| scene.parts[part].name.clone();
        let exchanges =
            exchanges.iter().map(|found| Together { parts: found.parts.map(name), frames: found.frames.clone() });
        Self { contours, weakest_frame: weakest, parts, together: together.collect(), exchanges: exchanges.collect() }
    }

    /// Lines for a person: one for each part that was tracked, and one for all.
    pub fn lines(&self) -> Vec<String> {
        let tracked = |part: &&PartReport| !(part.confidence.is_empty() && part.lost.is_empty());
        let mut lines: Vec<String> = self.parts.iter().filter(tracked).map(PartReport::line).collect();
        if lines.len() > 1 {
            let Counts { sure, doubtful, lost } = self.contours;
            lines.push(format!("all {} parts: {}", lines.len(), counted([sure, doubtful, lost])));
        }
        lines.extend(self.parts.iter().filter(|part| !part.unseen.is_empty()).map(PartReport::question));
        lines.extend(self.together.iter().map(Together::on_one_place));
        lines.extend(self.exchanges.iter().map(Together::exchanged));
        lines.extend(self.weakest_frame.as_ref().and_then(|weakest| self.advice(weakest)));
        lines
    }
}

impl Report {
    /// On which frame the next key of which parts helps most. `None` if every contour is sure.
    fn advice(&self, weakest: &Weakest) -> Option<String> {
        let frame = weakest.frame;
        if weakest.parts.is_empty() {
            return (self.contours.doubtful + self.contours.lost > 0)
                .then(|| format!("the next key helps most on frame {frame}"));
        }
        let is_lost = |name: &&String| self.parts.iter().any(|part| part.name == **name && part.lost.contains(&frame));
        let (lost, doubtful): (Vec<&String>, Vec<&String>) = weakest.parts.iter().partition(is_lost);
        let said = [(lost, "lost"), (doubtful, "doubtful")].into_iter().filter(|(names, _)| !names.is_empty());
        let said: Vec<String> = said.map(|(names, what)| format!("{} ({what})", quoted(&names))).collect();
        Some(format!("the next key helps most on frame {frame}: {}", said.join(", ")))
    }
}

/// Names in quotes, with commas between them.
fn quoted(names: &[&String]) -> String {
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}

impl Together {
    fn on_one_place(&self) -> String {
        let [a, b] = &self.parts;
        format!("parts {a:?} and {b:?} lie on one place on {}: a key of one of them parts them", runs(&self.frames))
    }

    /// The line for a person about parts that may have changed places. The frames rise.
    pub fn exchanged(&self) -> String {
        let ([a, b], frames) = (&self.parts, runs(&self.frames));
        format!(
            "parts {a:?} and {b:?} look alike and may have changed places on {frames}: a key or a pin there says which is which"
        )
    }
}

impl PartReport {
    fn question(&self) -> String {
        let (name, frames) = (&self.name, runs(&self.unseen));
        format!(
            "part {name:?} can probably not be seen on {frames}: if so, `rototoon absent` removes its contour there"
        )
    }

    fn line(&self) -> String {
        let numbers = counted([self.sure.len(), self.doubtful.len(), self.lost.len()]);
        let named = [("doubtful", &self.doubtful), ("lost", &self.lost)];
        let places = named.iter().filter(|(_, frames)| !frames.is_empty());
        let places: Vec<String> = places.map(|(what, frames)| format!("{what}: {}", runs(frames))).collect();
        let places = if places.is_empty() { String::new() } else { format!(" ({})", places.join("; ")) };
        format!("part {:?}: {numbers}{places}", self.name)
    }
}

/// For example "12 frames sure, 2 doubtful, 1 lost". Of doubtful and lost frames only those that are.
fn counted([sure, doubtful, lost]: [usize; 3]) -> String {
    let mut text = format!("{sure} {} sure", if sure == 1 { "frame" } else { "frames" });
    for (count, what) in [(doubtful, "doubtful"), (lost, "lost")] {
        if count > 0 {
            text += &format!(", {count} {what}");
        }
    }
    text
}

/// Frames that rise, with runs as ranges: "3, 7-9".
pub(super) fn runs(frames: &[FrameNumber]) -> String {
    let runs = frames.chunk_by(|a, b| *b == a + 1).map(|run| match run {
        [first, .., last] => format!("{first}-{last}"),
        [one] => one.to_string(),
        [] => String::new(),
    });
    runs.collect::<Vec<_>>().join(", ")
}

/// The first and last frames of stretches as text: "4-6, 9".
pub(super) fn ranges(frames: impl Iterator<Item = (FrameNumber, FrameNumber)>) -> String {
    let text = |(first, last)| if first == last { format!("{first}") } else { format!("{first}-{last}") };
    frames.map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::{Footage, Part};

    fn scene() -> Scene {
        let part = |name: &str, confidence: &[f64]| Part {
            name: name.into(),
            keys: [(0, vec![Point::ZERO]), (9, vec![Point::ZERO])].into(),
            confidence: (1..).zip(confidence.iter().map(|&c| vec![c])).collect(),
            ..Part::default()
        };
        let parts =
            vec![part("arm", &[0.9, 0.9, 0.6, 0.1, 0.2, 0.9, 0.3, 0.9]), part("head", &[1.0]), part("hat", &[])];
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 64, height: 48, held: false };
        Scene { footage, parts }
    }

    #[test]
    fn every_tracked_part_has_a_line() {
        let expected = [
            "part \"arm\": 4 frames sure, 1 doubtful, 3 lost (doubtful: 3; lost: 4-5, 7)",
            "part \"head\": 1 frame sure",
            "all 2 parts: 5 frames sure, 1 doubtful, 3 lost",
            "the next key helps most on frame 4: \"arm\" (lost)",
        ];
        assert_eq!(Report::of(&scene(), &[]).lines(), expected);
    }

    #[test]
    fn parts_on_one_place_are_named_together() {
        let mut scene = scene();
        let square = |x: f64| [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0)].map(|(dx, dy)| Point::new(x + dx, dy)).to_vec();
        for (part, places) in scene.parts.iter_mut().zip([[0.0, 20.0, 20.0], [20.0; 3]]) {
            part.closed = true;
            part.tracks = (1..).zip(places.map(square)).collect();
            part.confidence = (1..4).map(|frame| (frame, vec![0.7; 3])).collect();
        }
        let lines = Report::of(&scene, &[]).lines();
        let expected = "parts \"arm\" and \"head\" lie on one place on 2-3: a key of one of them parts them";
        assert!(lines.iter().any(|line| line == expected), "{lines:?}");
    }

    #[test]
    fn parts_that_may_have_changed_places_are_named() {
        let report = Report::of(&scene(), &[Exchange { parts: [0, 1], frames: vec![2, 3, 4, 7] }]);
        let expected = "parts \"arm\" and \"head\" look alike and may have changed places on 2-4, 7: a key or a pin there says which is which";
        assert!(report.lines().iter().any(|line| line == expected), "{:?}", report.lines());
        let json = serde_json::to_value(report).unwrap();
        assert_eq!(json["exchanges"], serde_json::json!([{"parts": ["arm", "head"], "frames": [2, 3, 4, 7]}]));
    }

    #[test]
    fn the_report_holds_all_frames() {
        let report = serde_json::to_value(Report::of(&scene(), &[])).unwrap();
        assert_eq!(report["contours"], serde_json::json!({"sure": 5, "doubtful": 1, "lost": 3}));
        assert_eq!(report["parts"][0]["lost"], serde_json::json!([4, 5, 7]));
        assert_eq!(report["parts"][0]["confidence"]["3"], 0.6);
        assert_eq!(report["weakest_frame"]["frame"], 4);
        assert_eq!(report["weakest_frame"]["parts"], serde_json::json!(["arm"]));
    }
}
