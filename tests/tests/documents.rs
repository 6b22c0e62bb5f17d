//! Tests of project documents: fields that are kept, documents that are refused, and their messages.

use proptest::prelude::*;
use rototoon::geometry::Point;
use rototoon::project::{Document, LoadError};
use rototoon::scene::{Falloff, FalloffCurve, Part};
use std::collections::BTreeMap;
use std::fs;

const FOOTAGE: &str = r#"{"pattern": "f_%03d.png", "first": 0, "last": 20, "fps": 12.5, "width": 64, "height": 48}"#;
const TRIANGLE: &str = "[[1, 2], [30.5, 4], [7, 40]]";

/// A document of one part with a name and these fields.
fn with_part(fields: &str) -> String {
    format!(r#"{{"rototoon": 1, "footage": {FOOTAGE}, "parts": [{{"name": "arm", {fields}}}]}}"#)
}

fn with_footage(footage: &str) -> String {
    format!(r#"{{"rototoon": 1, "footage": {footage}, "parts": []}}"#)
}

fn parse(json: &str) -> Result<Document, LoadError> {
    Document::parse(json, "p.json")
}

fn errors(json: &str) -> Vec<String> {
    parse(json).expect_err("the document is bad").lines()
}

fn warnings(json: &str) -> Vec<String> {
    parse(json).unwrap().problems().warnings().map(ToString::to_string).collect()
}

#[test]
fn a_small_document_is_read() {
    let document = parse(&with_part(&format!(
        r#""keys": {{"11": {TRIANGLE}, "2": {TRIANGLE}}}, "pins": {{"5": {{"1": [3, 4]}}}}, "centers": {{"6": [9, 8]}}"#
    )))
    .unwrap();
    let part = &document.scene.parts[0];
    assert!(part.closed, "closed is the default");
    assert_eq!(part.depth, 0.0);
    assert_eq!(part.keys.keys().copied().collect::<Vec<_>>(), [2, 11]);
    assert_eq!(part.keys[&2][1], Point::new(30.5, 4.0));
    assert_eq!(part.pins[&5][&1], Point::new(3.0, 4.0));
    assert_eq!(part.centers[&6], Point::new(9.0, 8.0));
    assert!(document.problems().is_empty(), "{:?}", document.problems());
}

#[test]
fn every_problem_is_named_with_its_place() {
    let cases: [(&str, &str); 13] = [
        (r#""keys": {"0": [[1, 2], [3, null]]}"#, r#".keys."0"[1][1]: found null, expected a finite number"#),
        (r#""keys": {"0": [[1, 2], ["x", 3]]}"#, r#".keys."0"[1][0]: found the text "x", expected a finite number"#),
        (r#""keys": {"0": [[1, 2, 3]]}"#, r#".keys."0"[0]: found a list of 3, expected a point [x, y]"#),
        (r#""keys": {"0": [7]}"#, r#".keys."0"[0]: found 7.0, expected a point [x, y]"#),
        (r#""keys": []"#, r#".keys: found a list, expected an object"#),
        (r#""keys": {"1.5": []}"#, r#".keys: found the key "1.5", expected a frame number such as "11""#),
        (r#""keys": {"01": []}"#, r#".keys: found the key "01", expected a frame number such as "11""#),
        (r#""keys": {}, "keys": {}"#, r#": found the field "keys" twice, expected it once"#),
        (r#""keys": {"1": [], "1": []}"#, r#".keys."1": found twice, expected once"#),
        (r#""keys": {}, "closed": 1"#, r#".closed: found 1.0, expected true or false"#),
        (
            r#""keys": {"0": [[2e6, 0]]}"#,
            r#".keys."0"[0]: found [2000000.0, 0.0], expected coordinates from -1000000 to 1000000"#,
        ),
        (r#""keys": {"21": []}"#, r#".keys."21": found frame 21, expected one of the footage, 0 to 20"#),
        (r#""depth": 1"#, r#": the field "keys" is missing"#),
    ];
    for (fields, message) in cases {
        assert_eq!(errors(&with_part(fields)), [format!(r#"p.json: parts[0] "arm"{message}"#)], "{fields}");
    }
}

#[test]
fn unequal_keys_and_pins_out_of_range_are_errors() {
    let keys = format!(r#""keys": {{"0": {TRIANGLE}, "9": [[1, 1], [2, 2]]}}"#);
    let found = "p.json: parts[0] \"arm\".keys.\"9\": found 2 points, expected 3 as on the part's first key, frame 0";
    assert_eq!(errors(&with_part(&keys)), [found]);
    let pins = format!(r#""keys": {{"0": {TRIANGLE}, "9": {TRIANGLE}}}, "pins": {{"4": {{"3": [0, 0]}}}}"#);
    assert_eq!(
        errors(&with_part(&pins)),
        ["p.json: parts[0] \"arm\".pins.\"4\".\"3\": found point 3, expected one of 0 to 2"]
    );
}

#[test]
fn all_errors_are_reported_at_once() {
    let json = r#"{"footage": {"pattern": "a.png", "first": 5, "last": 2, "fps": 0, "width": 0},
        "parts": [{"keys": {}}, {"name": "a", "keys": {}}, {"keys": {"0": [[0]]}, "name": "a"}]}"#;
    assert_eq!(
        errors(json),
        [
            "p.json: footage: the field \"height\" is missing",
            "p.json: footage.pattern: pattern \"a.png\" has no frame number: expected one %d or %0Nd",
            "p.json: footage.width: found 0, expected 1 to 65535",
            "p.json: footage.fps: found 0.0, expected 0.001 to 1000000",
            "p.json: footage.last: found 2, expected at least the first frame, 5",
            "p.json: parts[0]: the field \"name\" is missing",
            "p.json: parts[2] \"a\".keys.\"0\"[0]: found a list of 1, expected a point [x, y]",
            "p.json: the field \"rototoon\" is missing",
            "p.json: parts[0] \"\".name: found no name, expected a unique one",
            "p.json: parts[2] \"a\".name: found the name of parts[1], expected a unique one",
        ]
    );
}

#[test]
fn impossible_footage_is_refused() {
    for (field, value, message) in [
        ("\"f_%03d.png\"", "\"%d/%d.png\"", "pattern \"%d/%d.png\" has 2 frame numbers: expected one %d or %0Nd"),
        ("12.5", "-1", "footage.fps: found -1.0, expected 0.001 to 1000000"),
        ("64", "1.5", "footage.width: found 1.5, expected a whole number"),
        ("48", "70000", "footage.height: found 70000, expected 1 to 65535"),
        ("20", "1e18", "footage.last: found 1e18, expected a whole number"),
        ("20", "3000000", "footage.last: found 3000001 frames, expected at most 1000000"),
    ] {
        let lines = errors(&with_footage(&FOOTAGE.replacen(field, value, 1)));
        assert!(lines.len() == 1 && lines[0].contains(message), "{lines:?}");
    }
}

#[test]
fn held_gaps_of_the_footage_are_read_written_and_checked() {
    let with = |gaps: &str| with_footage(&FOOTAGE.replace('}', &format!(r#", {gaps}}}"#)));
    let document = parse(&with(r#""gaps": "held""#)).unwrap();
    assert!(document.scene.footage.held && document.misspelt().is_empty());
    let again = parse(&document.to_json()).unwrap();
    assert!(again.scene.footage.held && again.to_json() == document.to_json());
    let mut open = parse(&with_footage(FOOTAGE)).unwrap();
    assert!(!open.scene.footage.held && !open.to_json().contains("gaps"), "{}", open.to_json());
    open.scene.footage.held = true;
    assert!(parse(&open.to_json()).unwrap().scene.footage.held);
    let mut closed = document;
    closed.scene.footage.held = false;
    assert!(!closed.to_json().contains("gaps"), "{}", closed.to_json());
    assert_eq!(
        errors(&with(r#""gaps": "hold""#)),
        [r#"p.json: footage.gaps: found "hold", expected "held", or no such field"#]
    );
    assert_eq!(errors(&with(r#""gaps": true"#)), [r#"p.json: footage.gaps: found true, expected a text"#]);
}

#[test]
fn a_later_version_is_refused_and_named() {
    let later = r#"{"parts": "something new", "rototoon": 2, "footage": 7}"#;
    let message = parse(later).unwrap_err().to_string();
    assert_eq!(message, "p.json: found a document of version 2, expected version 1: a newer Rototoon wrote it");
    let minor = with_part(r#""keys": {}"#).replace("\"rototoon\": 1", "\"rototoon\": 1.3");
    assert!(parse(&minor).unwrap().to_json().contains("\"rototoon\": 1.3,"));
    assert_eq!(
        errors(&minor.replace("1.3", "\"1\""))[0],
        "p.json: rototoon: found the text \"1\", expected the version 1"
    );
}

#[test]
fn errors_of_broken_text_name_the_place() {
    let whole = with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}"#));
    let cut = &whole[..whole.find("30.5").unwrap()];
    let place = "parts[0] \"arm\".keys.\"0\"[1][0]: the document ends too early: it was cut short";
    assert_eq!(errors(cut), [format!("p.json: line 1, column {}, in {place}", cut.len())]);
    for word in ["NaN", "Infinity", "-Infinity"] {
        let line = &errors(&whole.replace("30.5", word))[0];
        assert!(line.contains(&format!("[1][0]: found {word}, expected a finite number")), "{line}");
    }
    assert!(errors(&whole.replace("30.5", "1e999"))[0].contains(".keys.\"0\"[1]"));
    assert!(errors("")[0].ends_with("the document is empty"));
    assert!(errors(&(whole.clone() + "x"))[0].contains("trailing characters"));
    assert_eq!(errors("[]"), ["p.json: found a list, expected a project document"]);
    assert!(parse(&format!("\u{feff}{whole}")).is_ok(), "a byte order mark is no error");
}

#[test]
fn corrections_without_effect_are_kept_with_a_warning() {
    assert_eq!(
        warnings(&with_part(r#""keys": {}, "pins": {"3": {"9": [0, 0]}}"#)),
        [
            "parts[0] \"arm\".keys: there is no key, so the part is not tracked",
            "parts[0] \"arm\".pins.\"3\": frame 3 is not between two keys, so the correction is kept but has no effect",
        ]
    );
    let json = with_part(&format!(
        r#""keys": {{"2": {TRIANGLE}, "9": {TRIANGLE}}}, "pins": {{"2": {{"0": [0, 0]}}}}, "centers": {{"15": [0, 0]}}"#
    ));
    let texts = warnings(&json);
    assert!(texts[0].contains("pins.\"2\": frame 2 is on a key"), "{texts:?}");
    assert!(texts[1].contains("centers.\"15\": frame 15 is not between two keys"), "{texts:?}");
    let saved = parse(&parse(&json).unwrap().to_json()).unwrap();
    assert_eq!(saved.scene.parts[0].centers.len() + saved.scene.parts[0].pins.len(), 2);
}

#[test]
fn a_feather_is_read_written_and_checked() {
    let with = |more: &str| with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}{more}"#));
    let document = parse(&with(r#", "feather": [0, 2.5, 12]"#)).unwrap();
    assert_eq!(document.scene.parts[0].soft_widths(), Some(&[0.0, 2.5, 12.0][..]));
    assert_eq!(parse(&document.to_json()).unwrap().scene, document.scene);
    assert!(document.to_json().contains(r#""feather": [0, 2.5, 12]"#));
    assert!(!parse(&with("")).unwrap().to_json().contains("feather"), "old documents stay as they are");
    let wrong = errors(&with(r#", "feather": [0, -1, 4000]"#));
    assert_eq!(
        wrong,
        [
            r#"p.json: parts[0] "arm".feather[1]: found -1, expected a width from 0 to 2048"#,
            r#"p.json: parts[0] "arm".feather[2]: found 4000, expected a width from 0 to 2048"#
        ]
    );
    assert!(errors(&with(r#", "feather": 3"#))[0].contains("feather"));
    let odd = with(r#", "feather": [1, 2]"#);
    assert!(warnings(&odd)[0].contains("found 2 widths, but the keys have 3 points"), "{:?}", warnings(&odd));
    assert_eq!(parse(&odd).unwrap().scene.parts[0].soft_widths(), None);
}

#[test]
fn a_falloff_and_a_colour_are_read_written_and_checked() {
    let with = |more: &str| with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}{more}"#));
    let said = r#", "falloff": 2.5, "falloff_curve": "ease_in", "color": [1, 0.25, 0]"#;
    let mut document = parse(&with(said)).unwrap();
    let part = &document.scene.parts[0];
    assert_eq!(part.falloff, Falloff { rate: 2.5, curve: Some(FalloffCurve::EaseIn) });
    assert_eq!(part.colour, Some([1.0, 0.25, 0.0]));
    assert_eq!(parse(&document.to_json()).unwrap().scene, document.scene);
    // Where they are taken away, what is written can be read.
    (document.scene.parts[0].falloff, document.scene.parts[0].colour) = (Falloff::default(), None);
    assert_eq!(parse(&document.to_json()).unwrap().scene, document.scene);
    let old = parse(&with("")).unwrap().to_json();
    assert!(!old.contains("falloff") && !old.contains("color"), "old documents stay as they are");
    for (more, wrong) in [
        (r#", "falloff": 0"#, r#"p.json: parts[0] "arm".falloff: found 0, expected a rate from 0.1 to 10"#),
        (
            r#", "falloff_curve": "bent""#,
            r#"p.json: parts[0] "arm".falloff_curve: found the text "bent", expected "smooth", "linear", "ease_in" or "ease_out""#,
        ),
        (
            r#", "color": [1, 2, 0]"#,
            r#"p.json: parts[0] "arm".color: found [1, 2, 0], expected a colour [red, green, blue], each from 0 to 1"#,
        ),
        (
            r#", "color": [1, 0]"#,
            r#"p.json: parts[0] "arm".color: found [1, 0], expected a colour [red, green, blue], each from 0 to 1"#,
        ),
    ] {
        assert_eq!(errors(&with(more)), [wrong]);
    }
    assert!(errors(&with(r#", "color": "red", "falloff": null"#)).len() == 2);
}

#[test]
fn odd_contours_are_valid_with_a_warning() {
    for (points, warning) in [
        ("[]", "the part has no points"),
        ("[[1, 1]]", "the part is closed but has 1 point"),
        ("[[1, 1], [2, 2]]", "the part is closed but has 2 points"),
        ("[[1, 1], [2, 2], [3, 3]]", "the contour encloses no area"),
        ("[[-9, 1], [-2, 2], [-3, 9]]", "the contour is completely outside of the picture of 64x48 pixels"),
    ] {
        let texts = warnings(&with_part(&format!(r#""keys": {{"0": {points}, "4": {points}}}"#)));
        assert!(texts.iter().all(|text| text.contains(warning)) && !texts.is_empty(), "{points}: {texts:?}");
    }
    let one = warnings(&with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}"#)));
    assert_eq!(one, [""; 0], "a part with one key is tracked outward from it");
}

#[test]
fn unknown_fields_keep_their_place_and_their_text() {
    let json = r#"{
  "made by": {"tool": "x",   "big": 123456789012345678901234567890},
  "parts": [
    {
      "colour": [1.00, 0],
      "keys": {
        "0": [[1, 2], [3, 4.25]]
      },
      "name": "arm",
      "note": null,
      "closed": false,
      "depth": 13
    }
  ],
  "rototoon": 1,
  "footage": {"width": 64, "look": "LUT \u00e9", "pattern": "f_%03d.png", "first": 0, "last": 20, "fps": 12.5, "height": 48},
  "end": []
}
"#;
    assert_eq!(parse(json).unwrap().to_json(), json);
}

#[test]
fn fields_of_a_part_follow_it_when_parts_move() {
    let json = format!(
        r#"{{"rototoon": 1, "footage": {FOOTAGE}, "parts": [{{"name": "a", "keys": {{}}, "x": 1}}, {{"name": "b", "keys": {{}}, "x": 2}}]}}"#
    );
    let mut document = parse(&json).unwrap();
    document.scene.parts.reverse();
    let saved = document.to_json();
    assert!(saved.find("\"x\": 2").unwrap() < saved.find("\"x\": 1").unwrap());
}

#[test]
fn tracks_are_rounded_but_keys_and_pins_are_not() {
    let exact = Point::new(0.1 + 0.2, 1.0 / 3.0);
    let mut document = parse(&with_part(&format!(r#""keys": {{"0": {TRIANGLE}, "2": {TRIANGLE}}}"#))).unwrap();
    let part = &mut document.scene.parts[0];
    part.keys.get_mut(&0).unwrap()[0] = exact;
    part.pins.insert(1, BTreeMap::from([(1, exact)]));
    part.tracks = BTreeMap::from([(0, part.keys[&0].clone()), (1, vec![exact; 3]), (2, part.keys[&2].clone())]);
    let part = &parse(&document.to_json()).unwrap().scene.parts[0];
    assert_eq!(part.tracks[&0], part.keys[&0]);
    assert_eq!(part.keys[&0][0], exact);
    assert_eq!(part.tracks[&1], [Point::new(0.3, 0.3333), exact, Point::new(0.3, 0.3333)]);
}

#[test]
fn a_document_is_saved_and_loaded_and_bad_ones_are_not_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.json");
    let mut document = parse(&with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}"#))).unwrap();
    document.save(&path).unwrap();
    assert_eq!(Document::load(&path).unwrap().scene, document.scene);
    let before = fs::read(&path).unwrap();
    document.scene.parts[0].keys.get_mut(&0).unwrap()[1].x = f64::NAN;
    let error = document.save(&path).unwrap_err().to_string();
    assert!(error.contains(r#"parts[0] "arm".keys."0"[1]: found [NaN, 4.0]"#), "{error}");
    assert_eq!(fs::read(&path).unwrap(), before);
    fs::write(&path, b"\xff").unwrap();
    assert!(Document::load(&path).unwrap_err().to_string().ends_with("byte 0 is not UTF-8 text"));
    // What editors of Windows call "Unicode".
    fs::write(&path, b"\xff\xfe{\0").unwrap();
    assert!(
        Document::load(&path)
            .unwrap_err()
            .to_string()
            .ends_with("found a text in UTF-16, expected UTF-8: save it as UTF-8")
    );
    assert!(
        Document::load(&folder.path().join("none")).unwrap_err().to_string().contains("none: cannot read the document")
    );
}

#[test]
fn a_document_of_many_points_is_read_and_written() {
    let mut document = parse(&with_part(&format!(r#""keys": {{"0": {TRIANGLE}}}"#))).unwrap();
    let path: Vec<_> = (0..200_000).map(|i| Point::new(f64::from(i) * 0.25, 7.0)).collect();
    document.scene.parts[0].curves = BTreeMap::from([(0, vec![path.clone(), path, Vec::new()])]);
    assert_eq!(parse(&document.to_json()).unwrap().scene, document.scene);
}

fn point() -> impl Strategy<Value = Point> + Clone {
    (-1e6..1e6, -1e6..1e6).prop_map(|(x, y)| Point::new(x, y))
}

/// Valid parts with all fields. Computed coordinates have the decimals that are written.
fn part() -> impl Strategy<Value = Part> {
    let grid = |p: Point| (p * 1e4).round() / 1e4;
    (0usize..6, any::<bool>(), -1e3..1e3).prop_flat_map(move |(count, closed, depth)| {
        let points = prop::collection::vec(point(), count);
        let keys = prop::collection::btree_map(0..=20, points.clone(), 0..4);
        let tracks = prop::collection::btree_map(0..=20, points, 0..4);
        let pins =
            prop::collection::btree_map(0..=20, prop::collection::btree_map(0..count.max(1), point(), 0..2), 0..3);
        (keys, pins, tracks, prop::collection::btree_map(-5..30, point(), 0..3)).prop_map(
            move |(keys, mut pins, tracks, centers)| {
                if count == 0 {
                    pins.clear();
                }
                let tracks: BTreeMap<_, Vec<_>> =
                    tracks.into_iter().map(|(f, points)| (f, points.into_iter().map(grid).collect())).collect();
                let confidence = tracks.iter().map(|(&f, points)| (f, vec![0.25; points.len()])).collect();
                let curves = tracks.iter().map(|(&f, points)| (f, vec![points.clone(); 2])).collect();
                let wants_key = keys.keys().take(2).map(|&frame| frame - 1).collect();
                let depths = keys.keys().take(1).map(|&frame| (frame, 0.5 - depth)).collect();
                let absent = keys.keys().take(2).map(|&frame| [frame - 3, frame - 1]).collect();
                let name = String::new();
                let feather = (0..count).map(|k| 0.1 * k as f64).collect();
                Part {
                    name,
                    closed,
                    depth,
                    keys,
                    pins,
                    centers,
                    tracks,
                    confidence,
                    curves,
                    wants_key,
                    depths,
                    absent,
                    feather,
                    falloff: Falloff { rate: 0.1 + 0.01 * count as f64, curve: closed.then_some(FalloffCurve::Linear) },
                    colour: closed.then_some([0.25, 0.1, depth.abs().fract()]),
                }
            },
        )
    })
}

proptest! {
    #[test]
    fn written_documents_are_read_again(parts in prop::collection::vec(part(), 0..4), name in ".{0,8}") {
        let mut document = parse(&with_footage(FOOTAGE)).unwrap();
        document.scene.parts = parts;
        for (i, part) in document.scene.parts.iter_mut().enumerate() {
            part.name = format!("{name}{i}");
        }
        let json = document.to_json();
        let again = parse(&json).unwrap();
        prop_assert_eq!(&again.scene, &document.scene);
        prop_assert_eq!(again.to_json(), json);
    }

    #[test]
    fn damaged_documents_are_refused_or_read_but_never_panic(
        cut in 0usize..2000, at in 0usize..2000, byte in any::<u8>(), insert in any::<bool>(),
    ) {
        let whole = with_part(&format!(
            r#""keys": {{"0": {TRIANGLE}, "9": {TRIANGLE}}}, "pins": {{"4": {{"2": [0, 0]}}}}, "x": [null, {{"é": 1}}],
            "tracks": {{"0": {TRIANGLE}}}, "confidence": {{"0": [1, 0.5, 0]}}, "curves": {{"0": [[[1, 1]], [], []]}}"#
        ));
        let mut bytes = whole.into_bytes();
        if insert {
            bytes.insert(at % bytes.len(), byte);
        } else {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        for bytes in [&bytes[..], &bytes[..cut % bytes.len()]] {
            if let Ok(document) = parse(&String::from_utf8_lossy(bytes)) {
                prop_assert!(parse(&document.to_json()).is_ok());
            }
        }
    }
}
