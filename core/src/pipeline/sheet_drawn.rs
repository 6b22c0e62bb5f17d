//! What a contact sheet shows of strokes and painted regions.
//!
//! A stroke is drawn as the contour of a part is, in a colour of its own: its own ink would not show on the ink of the frame. So
//! it becomes a part that is tracked on its frames. A lost stroke then looks like a lost contour, and marks its frame. Painted regions lie under
//! the frame, and one that is in doubt makes the frame a doubtful one.

use super::fill::DOUBT;
use super::paint::Cels;
use super::{PipelineError, strokes};
use crate::project::Document;
use crate::scene::{Colour, palette};
use crate::scene::{FrameNumber, Part, Raster, Scene, Verdict};
use std::collections::BTreeMap;

/// The contents of a sheet.
pub(super) struct Contents {
    /// The document's parts, and its strokes as parts.
    pub scene: Scene,
    regions: Cels,
}

impl Contents {
    /// Reads what a document shows on its frames.
    ///
    /// # Errors
    ///
    /// [`PipelineError::Field`] if strokes or regions cannot be read.
    pub fn of(document: &Document) -> Result<Self, PipelineError> {
        let mut scene = document.scene.clone();
        scene.parts.extend(parts(document)?);
        Ok(Self { scene, regions: Cels::regions(document)? })
    }

    /// The picture of a frame over its painted regions.
    pub fn below(&self, frame: FrameNumber, picture: &Raster<Colour>) -> Option<Raster<Colour>> {
        self.regions.under_picture(frame, picture)
    }

    /// Frames with painted regions that are in doubt, with the verdict on them.
    pub fn doubts(&self) -> impl Iterator<Item = (FrameNumber, Verdict)> + '_ {
        let frames = self.regions.least_confidence();
        frames.filter(|(_, least)| *least < DOUBT).map(|(frame, _)| (frame, Verdict::Doubtful))
    }
}

/// The strokes of all frames, each number as a part.
fn parts(document: &Document) -> Result<impl Iterator<Item = Part>, PipelineError> {
    let mut found: BTreeMap<strokes::Id, Part> = BTreeMap::new();
    for (frame, own) in strokes::strokes(document)? {
        for strokes::Seen { id, stroke, .. } in own {
            let (strokes::Id::Track(index) | strokes::Id::Drawn(_, index)) = id;
            let colour = Some(palette::distinct(index).map(f64::from));
            let part = found.entry(id).or_insert_with(|| Part { name: id.to_string(), colour, ..Part::default() });
            part.closed = stroke.closed;
            part.confidence.extend(stroke.confidence.map(|value| (frame, vec![value; stroke.points.len()])));
            part.tracks.insert(frame, stroke.points);
        }
    }
    Ok(found.into_values())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_parts_and_paint_is_below() {
        let text = r#"{"rototoon": 1, "footage": {"pattern": "%d", "first": 0, "last": 9, "fps": 1, "width": 9, "height": 9}, "parts": [],
            "traced": [{"frame": 1, "strokes": [{"track": 4, "points": [[1, 1], [5, 1]], "closed": false},
                {"track": 2, "points": [[1, 3], [5, 3]], "closed": false, "confidence": 0.2}]}],
            "filled": [{"frame": 1, "regions": [{"outline": [[0, 0], [4, 0], [4, 9], [0, 9]], "colour": [1, 0, 0], "track": 0, "confidence": 1}]},
                {"frame": 2, "regions": [{"outline": [[0, 0], [4, 0], [4, 9], [0, 9]], "colour": [1, 0, 0], "track": 0, "confidence": 0.3}]}]}"#;
        let contents = Contents::of(&Document::parse(text, "p").unwrap()).unwrap();
        let names: Vec<_> = contents.scene.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["stroke 2", "stroke 4"]);
        let verdicts = [0, 1].map(|k: usize| Verdict::on(&contents.scene.parts[k], 1));
        assert_eq!(verdicts, [Some(Verdict::Lost), None]);
        assert_eq!(contents.doubts().collect::<Vec<_>>(), [(2, Verdict::Doubtful)]);
        let white = Raster::new(9, 9, [1.0; 3]);
        let below = contents.below(1, &white).unwrap();
        assert!(below.get(2, 2)[1] < 0.01 && below.get(7, 2)[1] > 0.99, "{:?}", below.get(2, 2));
        assert!(contents.below(0, &white).is_none());
    }
}
