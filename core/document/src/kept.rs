//! Results that are written in place of earlier ones, and keep the text of what has not changed: also what other programs have written there.

use super::Document;
use super::drawings::lines_of;
use super::fields::{FieldError, wrong};
use super::fills::{FilledDrawing, FilledRegion, written_colour};
use rototoon_base::scene::FrameNumber;
use serde_json::value::RawValue;
use serde_json::{Value, json};
use std::collections::BTreeMap;

impl Document {
    /// The text of a list of drawings, of which each that is as in `earlier`, what the field has now, keeps its text.
    pub(super) fn keeping<T: PartialEq>(
        &self,
        field: &str,
        [earlier, now]: [&[T]; 2],
        frame: impl Fn(&T) -> FrameNumber,
        written: impl Fn(&T) -> Value,
    ) -> String {
        let known: BTreeMap<FrameNumber, (&T, &str)> =
            earlier.iter().zip(self.texts(field)).map(|(own, text)| (frame(own), (own, text))).collect();
        lines_of(now.iter().map(|own| match known.get(&frame(own)) {
            Some((same, text)) if *same == own => (*text).to_owned(),
            _ => written(own).to_string(),
        }))
    }

    /// The texts of the elements of a list; none if it is missing or no list.
    fn texts(&self, field: &str) -> Vec<&str> {
        let read = self.other_field(field).map(serde_json::from_str::<Vec<&RawValue>>);
        read.and_then(Result::ok).unwrap_or_default().into_iter().map(RawValue::get).collect()
    }

    /// Gives painted regions the colours and numbers of `now`, which has the frames and regions of the document. All else stays as it was written.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn recolour_filled(&mut self, now: &[FilledDrawing]) -> Result<(), FieldError> {
        let earlier = self.filled()?;
        let drawings = self.texts("filled").into_iter().zip(earlier.iter().zip(now));
        let written = drawings.map(|(text, (before, now))| match before == now {
            true => Ok(text.to_owned()),
            false => recoloured(text, before, now),
        });
        let written = lines_of(written.collect::<Result<Vec<_>, _>>()?.into_iter());
        self.set_other_field("filled", written);
        Ok(())
    }
}

/// The text of a drawing of which some regions have other colours.
fn recoloured(text: &str, before: &FilledDrawing, now: &FilledDrawing) -> Result<String, FieldError> {
    let mut value: Value = serde_json::from_str(text).map_err(|error| wrong("filled", &error.to_string(), "JSON"))?;
    let regions = value["regions"].as_array_mut().into_iter().flatten();
    for (region, (_, now)) in regions.zip(before.regions.iter().zip(&now.regions)).filter(|(_, (a, b))| a != b) {
        let FilledRegion { name, colour, track, .. } = now;
        let Some(fields) = region.as_object_mut() else { continue };
        match name {
            Some(name) => fields.insert("name".into(), json!(name)),
            None => fields.shift_remove("name"),
        };
        fields.insert("colour".into(), json!(written_colour(*colour)));
        fields.insert("track".into(), json!(track));
    }
    Ok(value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILLED: &str = r#"[
    {"frame": 0, "note": "ok", "regions": [{"outline": [[1.123456, 1.0], [5, 1], [5, 5]], "colour": [1, 0, 0], "name": "coat", "track": 0, "by": "Ann"}]},
    {"frame": 1, "note": 2.50, "regions": [{"outline": [[1, 1], [5, 1], [5, 5]], "colour": [1, 0, 0], "name": "coat", "track": 0, "by": "Ann"}]}
  ]"#;

    fn document() -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "%d.png", "first": 0, "last": 3, "fps": 12, "width": 64,
            "height": 48}}, "parts": [], "palette": {{"coat": [0, 0, 1]}}, "filled": {FILLED}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    /// The text of the list, one element in each line.
    fn elements(document: &Document) -> Vec<String> {
        document.texts("filled").into_iter().map(str::to_owned).collect()
    }

    #[test]
    fn regions_with_another_colour_keep_the_rest_and_others_keep_their_text() {
        let mut document = document();
        let (before, mut now) = (elements(&document), document.filled().unwrap());
        let region = &mut now[1].regions[0];
        (region.name, region.colour, region.track) = (Some("wet".into()), [0.0, 1.0, 0.0], 1);
        document.recolour_filled(&now).unwrap();
        let found = elements(&document);
        assert_eq!(found[0], before[0]);
        let changed: Value = serde_json::from_str(&found[1]).unwrap();
        let region = &changed["regions"][0];
        assert_eq!((&changed["note"], &region["by"], &region["name"]), (&json!(2.5), &json!("Ann"), &json!("wet")));
        assert_eq!((&region["colour"], &region["track"]), (&json!([0.0, 1.0, 0.0]), &json!(1)));
        assert_eq!(document.filled().unwrap(), now);
    }

    #[test]
    fn drawings_that_stay_keep_their_text() {
        let mut document = document();
        let (before, mut now) = (elements(&document), document.filled().unwrap());
        now[1].regions[0].confidence = 0.5;
        document.set_filled(&now);
        assert_eq!(elements(&document)[0], before[0]);
        assert_eq!(document.filled().unwrap(), now);
    }
}
