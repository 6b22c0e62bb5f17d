//! New drawings on key frames of a document.
//!
//! Drawings that the document has are the artist's. They stay as they are written, fields that nobody knows included, and none
//! is replaced. A pair made by hand joins a drawing to the next one; so no drawing comes between two that have pairs.

use super::super::Document;
use super::super::fields::wrong;
use super::super::save::rounded;
use super::{Drawing, DrawingsError, drawing_place, lines, pair_place, stroke_fields};
use serde_json::{Value, json};
use std::collections::BTreeMap;

impl Document {
    /// Adds drawings. Their spacing, corners and pegs are not written: a new drawing has none. In-betweens of an earlier run go from
    /// their frames.
    ///
    /// # Errors
    ///
    /// A drawing of the document on the frame of a new one; a pair of the document between whose drawings a new one comes; or
    /// drawings that cannot be read. Then nothing is added.
    pub fn add_drawings(&mut self, new: &[Drawing]) -> Result<(), DrawingsError> {
        let known = self.drawings()?;
        let mut all: BTreeMap<_, Value> =
            known.drawings.iter().map(|own| own.frame).zip(self.other_list("drawings")?).collect();
        for drawing in new {
            let frame = drawing.frame;
            if let Some(k) = known.drawings.iter().position(|own| own.frame == frame) {
                return Err(wrong(&drawing_place(k, frame), "a drawing", "none: a new drawing comes there"));
            }
            let next = known.drawings.partition_point(|own| own.frame < frame);
            let pair = known.pairs.iter().position(|pair| pair.drawing + 1 == next);
            if let Some(k) = pair.filter(|_| next < known.drawings.len()) {
                let [first, last] = [next - 1, next].map(|k| known.drawings[k].frame);
                let found = format!("a pair of frames {first} and {last}");
                let expected = format!("none: a new drawing comes between them, on frame {frame}");
                return Err(wrong(&pair_place(k, first), &found, &expected));
            }
            let strokes: Vec<Value> =
                drawing.strokes.iter().map(|stroke| Value::Object(stroke_fields(stroke, rounded))).collect();
            all.insert(frame, json!({"frame": frame, "strokes": strokes}));
        }
        self.set_other_field("drawings", lines(all.into_values()));
        // What was generated on a frame does not hide the drawing that comes there.
        if self.other_field("in_betweens").is_some() {
            let on = |frame: &Value| new.iter().any(|drawing| frame.as_i64() == Some(i64::from(drawing.frame)));
            let kept = self.other_list("in_betweens")?.into_iter().filter(|own| !on(&own["frame"]));
            self.set_other_field("in_betweens", lines(kept));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::DrawnStroke;
    use super::super::tests::document;
    use super::*;
    use rototoon_base::geometry::Point;

    fn drawing(frame: i32) -> Drawing {
        let points = vec![Point::new(1.0 / 3.0, 2.0), Point::new(5.0, 2.0)];
        Drawing {
            frame,
            strokes: vec![DrawnStroke { points, widths: vec![2.0, 1.0 / 3.0], ..DrawnStroke::default() }],
            ..Drawing::default()
        }
    }

    const OWN: &str = r#""drawings": [{"frame": 0, "strokes": [{"points": [[1.23456, 2]], "closed": false, "mine": 7}]},
        {"frame": 8, "spacing": "linear", "strokes": [{"points": [[3, 2]], "closed": false}]}]"#;

    #[test]
    fn drawings_are_added_in_the_order_of_frames() {
        let mut doc = document(OWN);
        doc.add_drawings(&[drawing(12), drawing(4), drawing(-3)]).unwrap();
        let text = doc.to_json();
        let again = Document::parse(&text, "a.json").unwrap();
        let read = again.drawings().unwrap().drawings;
        assert_eq!(read.iter().map(|own| own.frame).collect::<Vec<_>>(), [-3, 0, 4, 8, 12]);
        assert_eq!((&read[2].strokes[0].widths[..], read[2].strokes[0].points[0].x), (&[2.0, 0.3333][..], 0.3333));
        assert!(text.contains(r#""mine":7"#) && text.contains("1.23456") && text.contains("linear"), "{text}");
    }

    #[test]
    fn an_in_between_makes_room_for_a_drawing() {
        let mut doc = document(&format!(
            r#"{OWN}, "in_betweens": [{{"frame": 4, "strokes": []}}, {{"frame": 5, "strokes": []}}]"#
        ));
        doc.add_drawings(&[drawing(4)]).unwrap();
        assert_eq!(doc.in_betweens().unwrap().iter().map(|own| own.frame).collect::<Vec<_>>(), [5]);
    }

    #[test]
    fn nothing_of_the_artist_is_replaced_or_parted() {
        let mut doc = document(OWN);
        let said = doc.add_drawings(&[drawing(3), drawing(8)]).unwrap_err().to_string();
        assert_eq!(said, "drawings[1] (frame 8): found a drawing, expected none: a new drawing comes there");
        let mut paired = document(&format!(r#"{OWN}, "pairs": [{{"frame": 0, "from": 0, "to": 0}}]"#));
        let said = paired.add_drawings(&[drawing(3)]).unwrap_err().to_string();
        assert_eq!(
            said,
            "pairs[0] (frame 0): found a pair of frames 0 and 8, expected none: a new drawing comes between them, on frame 3"
        );
        paired.add_drawings(&[drawing(-1), drawing(9)]).expect("it parts no pair");
        assert_eq!(doc.drawings().unwrap().drawings.len(), 2);
    }
}
