//! Drawings between keys: written by tweening, and read again where they are drawn or exported.

use super::super::Document;
use super::super::fields::{array, by_frame, count, frame, given, object, share};
use super::super::save::rounded;
use super::read::stroke;
use super::{DrawingsError, DrawnStroke, lines, stroke_fields};
use rototoon_base::scene::FrameNumber;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// A generated drawing between keys.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnBetween {
    /// The frame.
    pub frame: FrameNumber,
    /// Strokes from back to front: track, opacity, stroke.
    pub strokes: Vec<(usize, f64, DrawnStroke)>,
}

impl Document {
    /// Puts the results of tweening into the document: matches, as JSON objects, and the drawings between keys.
    pub fn set_in_betweens(&mut self, matches: Vec<Value>, drawn: &[DrawnBetween]) {
        let written = drawn.iter().map(|between| {
            let stroke = |(track, opacity, stroke): &(usize, f64, DrawnStroke)| {
                let mut fields = Map::new();
                fields.insert("track".into(), json!(track));
                fields.extend(stroke_fields(stroke, rounded));
                fields.insert("opacity".into(), json!(rounded(*opacity)));
                Value::Object(fields)
            };
            json!({"frame": between.frame, "strokes": between.strokes.iter().map(stroke).collect::<Vec<_>>()})
        });
        self.set_other_field("in_betweens", lines(written));
        self.set_other_field("matches", lines(matches.into_iter()));
    }

    /// The drawings between keys; empty if the document has none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn in_betweens(&self) -> Result<Vec<DrawnBetween>, DrawingsError> {
        by_frame(&self.other_list("in_betweens")?, ["in_betweens", "strokes"], between)
    }

    /// By frame of a drawing on a key the numbers of its strokes, which in-betweens call `track`. A drawing is not in it if the
    /// document has no matches of it, or it has another number of strokes than when they were made.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn stroke_numbers(&self) -> Result<BTreeMap<FrameNumber, Vec<usize>>, DrawingsError> {
        let mut found = BTreeMap::new();
        for (k, value) in self.other_list("matches")?.iter().enumerate() {
            let place = format!("matches[{k}]");
            let fields = object(value, &place)?;
            let Some(tracks) = fields.get("tracks") else { continue };
            for (side, name) in ["frame", "next"].into_iter().enumerate() {
                let on = frame(fields.get(name), &format!("{place}.{name}"))?;
                let at = format!("{place}.tracks");
                let own = array(array(Some(tracks), &at)?.get(side), &format!("{at}[{side}]"))?.iter().enumerate();
                let numbers = own.map(|(i, number)| count(Some(number), &format!("{at}[{side}][{i}]")));
                found.insert(on, numbers.collect::<Result<Vec<usize>, _>>()?);
            }
        }
        let counts: BTreeMap<FrameNumber, usize> =
            self.drawings()?.drawings.iter().map(|own| (own.frame, own.strokes.len())).collect();
        found.retain(|on, numbers| counts.get(on) == Some(&numbers.len()));
        Ok(found)
    }
}

fn between(frame: FrameNumber, list: &[Value], place: &str) -> Result<DrawnBetween, DrawingsError> {
    let read = |(i, value): (usize, &Value)| {
        let place = format!("{place}[{i}]");
        let fields = object(value, &place)?;
        let track = count(fields.get("track"), &format!("{place}.track"))?;
        let opacity = given(fields, &place, "opacity", share)?.unwrap_or(1.0);
        // Pegs have moved it already.
        Ok((track, opacity, stroke(value, &place, &BTreeMap::new())?))
    };
    Ok(DrawnBetween { frame, strokes: list.iter().enumerate().map(read).collect::<Result<_, _>>()? })
}

#[cfg(test)]
mod tests {
    use super::super::tests::document as with;
    use super::*;
    use rototoon_base::geometry::Point;

    /// A document with these in-betweens.
    fn document(in_betweens: &str) -> Document {
        with(&format!(r#""in_betweens": {in_betweens}"#))
    }

    #[test]
    fn what_is_written_is_read_again() {
        let stroke = |x: f64, colour: Option<[f32; 3]>| DrawnStroke {
            points: vec![Point::new(x, 2.0), Point::new(7.5, 3.0)],
            closed: true,
            widths: if colour.is_some() { vec![1.5, 2.0] } else { Vec::new() },
            colour,
            ..DrawnStroke::default()
        };
        let drawn = [
            DrawnBetween {
                frame: 2,
                strokes: vec![(5, 0.5, stroke(1.25, None)), (0, 1.0, stroke(3.0, Some([0.5; 3])))],
            },
            DrawnBetween { frame: 3, strokes: vec![] },
        ];
        let mut document = document("[]");
        assert_eq!(document.in_betweens().unwrap(), []);
        document.set_in_betweens(Vec::new(), &drawn);
        let again = Document::parse(&document.to_json(), "a.json").unwrap();
        assert_eq!(again.in_betweens().unwrap(), drawn);
    }

    #[test]
    fn the_strokes_of_keys_have_numbers() {
        let stroke = r#"{"points": [[1, 2]], "closed": false}"#;
        let keys = format!(
            r#"[], "drawings": [{{"frame": 0, "strokes": [{stroke}, {stroke}]}}, {{"frame": 4, "strokes": [{stroke}]}},
            {{"frame": 7, "strokes": [{stroke}]}}]"#
        );
        let with = |tracks: &str| {
            let text = format!(
                r#"{keys}, "matches": [{{"frame": 0, "next": 4, "tracks": {tracks}}}, {{"frame": 4, "next": 7}}]"#
            );
            document(&text).stroke_numbers()
        };
        assert_eq!(with("[[0, 5], [5]]").unwrap(), BTreeMap::from([(0, vec![0, 5]), (4, vec![5])]));
        // The artist has drawn a stroke more since.
        assert_eq!(with("[[0], [5]]").unwrap(), BTreeMap::from([(4, vec![5])]));
        assert_eq!(with("[[0]]").unwrap_err().to_string(), "matches[0].tracks[1]: found nothing, expected a list");
        assert!(document("[]").stroke_numbers().unwrap().is_empty());
    }

    #[test]
    fn what_is_invalid_is_named() {
        let said = |text: &str| document(text).in_betweens().unwrap_err().to_string();
        assert_eq!(said("[3]"), "in_betweens[0]: found 3, expected an object");
        let stroke = r#"{"track": 0, "points": [], "closed": false, "opacity": 2}"#;
        assert!(
            said(&format!(r#"[{{"frame": 4, "strokes": [{stroke}]}}]"#))
                .starts_with("in_betweens[0] (frame 4).strokes[0].opacity: found 2, expected"),
        );
        assert_eq!(
            said(r#"[{"frame": 4, "strokes": []}, {"frame": 4, "strokes": []}]"#),
            "in_betweens[1].frame: found 4, expected more than 4, that of in_betweens[0]"
        );
    }
}
