//! Documents of which shapes for other programs would be an empty file.

use super::strokes;
use crate::project::Document;
use crate::scene::{FrameNumber, Part};

/// Why a file with this extension would have nothing of a document, as a message for the user; `None` if it has something. All forms
/// take the contours of parts; SVG takes strokes and painted regions too. `extension` is in small letters.
pub fn nothing_for(document: &Document, extension: &str) -> Option<String> {
    let footage = &document.scene.footage;
    let within = |frame: &FrameNumber| (footage.first..=footage.last).contains(frame);
    let has_contour =
        |part: &Part| part.keys.iter().chain(&part.tracks).any(|(frame, points)| within(frame) && !points.is_empty());
    if document.scene.parts.iter().any(has_contour) {
        return None;
    }
    // Fields that cannot be read have an error of their own where they are needed.
    let strokes = strokes::strokes(document)
        .map_or(0, |found| found.iter().filter(|(frame, own)| within(frame) && !own.is_empty()).count());
    let painted = document
        .filled()
        .map_or(0, |found| found.iter().filter(|own| within(&own.frame) && !own.regions.is_empty()).count());
    let on = |what: &str, frames: usize| {
        let plural = if frames == 1 { "frame" } else { "frames" };
        (frames > 0).then(|| format!("{what} on {frames} {plural}"))
    };
    let drawn: Vec<String> = [on("strokes", strokes), on("painted regions", painted)].into_iter().flatten().collect();
    match (drawn.is_empty(), extension) {
        (true, "svg") => Some("found no contour, stroke or painted region, expected one of them".into()),
        (true, _) => Some(format!("found no contour of a part, expected one: .{extension} has contours only")),
        (false, "svg") => None,
        (false, _) => Some(format!(
            "found no contour of a part, expected one: .{extension} has contours only. The document has {}; .svg and .json take them",
            drawn.join(" and ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(fields: &str, extension: &str) -> Option<String> {
        let footage = r#"{"pattern": "%d", "first": 0, "last": 9, "fps": 1, "width": 9, "height": 9}"#;
        let text = format!("{{\"rototoon\": 1, \"footage\": {footage}, {fields}}}");
        nothing_for(&Document::parse(&text, "p").unwrap(), extension)
    }

    #[test]
    fn it_says_what_there_is_and_which_forms_take_it() {
        let stroke = r#"{"track": 0, "points": [[1, 1], [5, 1]], "closed": false}"#;
        let traced =
            format!(r#""parts": [], "traced": [{{"frame": 0, "strokes": [{stroke}]}}, {{"frame": 2, "strokes": []}}]"#);
        let said = told(&traced, "nk").unwrap();
        assert!(said.contains(".nk has contours only. The document has strokes on 1 frame; .svg and .json"), "{said}");
        assert_eq!(told(&traced, "svg"), None);
        assert!(told(r#""parts": []"#, "svg").unwrap().contains("no contour, stroke or painted region"));
        assert!(told(r#""parts": [{"name": "a", "keys": {}}]"#, "fxs").unwrap().ends_with(".fxs has contours only"));
        assert_eq!(told(r#""parts": [{"name": "a", "keys": {"1": [[1, 1], [2, 1], [2, 2]]}}]"#, "fxs"), None);
    }
}
