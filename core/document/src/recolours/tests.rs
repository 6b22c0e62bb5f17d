use super::*;
use crate::fills::FilledRegion;

fn document(fields: &str) -> Document {
    let text = format!(
        r#"{{"rototoon": 1, "footage": {{"pattern": "%d.png", "first": 0, "last": 9, "fps": 12, "width": 64,
        "height": 48}}, "parts": [], "note": 1, {fields}}}"#
    );
    Document::parse(&text, "a.json").unwrap()
}

fn named(name: &str) -> Hue {
    Hue { name: Some(name.into()), colour: [0.5; 3] }
}

fn entry(from: &str, to: &str, first: Option<FrameNumber>, last: Option<FrameNumber>) -> Recolour {
    Recolour { from: named(from), to: named(to), first, last }
}

/// The numbers and names of regions, one for each frame from 0 on.
fn changed(list: Vec<Recolour>, names: &[&str]) -> (Vec<usize>, Vec<String>, Vec<usize>) {
    let region = |name: &str| FilledRegion {
        outline: Vec::new(),
        holes: Vec::new(),
        colour: [0.5; 3],
        name: Some(name.into()),
        track: 4,
        confidence: 0.7,
    };
    let mut drawings: Vec<FilledDrawing> =
        names.iter().zip(0..).map(|(name, frame)| FilledDrawing { frame, regions: vec![region(name)] }).collect();
    let counts = Recolours::new(list, &[]).change(&mut drawings, 9);
    let regions: Vec<FilledRegion> = drawings.into_iter().flat_map(|own| own.regions).collect();
    assert!(regions.iter().all(|own| own.confidence == 0.7));
    (regions.iter().map(|own| own.track).collect(), regions.into_iter().filter_map(|own| own.name).collect(), counts)
}

#[test]
fn a_colour_becomes_another_one_on_its_frames_with_one_number() {
    let coats = ["coat"; 5];
    let (numbers, names, counts) = changed(vec![entry("coat", "wet", Some(1), Some(3))], &coats);
    assert_eq!((numbers, counts), (vec![4, 9, 9, 9, 4], vec![3]), "a number has one colour");
    assert_eq!(names, ["coat", "wet", "wet", "wet", "coat"]);
    let (_, names, _) = changed(vec![entry("coat", "wet", None, Some(1))], &coats);
    assert_eq!(names, ["wet", "wet", "coat", "coat", "coat"]);
    let (numbers, _, counts) = changed(vec![entry("hat", "wet", None, None)], &coats);
    assert_eq!((numbers, counts), (vec![4; 5], vec![0]));
}

#[test]
fn entries_change_what_the_ones_before_have_left() {
    let list = vec![entry("coat", "wet", Some(1), None), entry("wet", "icy", Some(3), None)];
    let (numbers, names, counts) = changed(list.clone(), &["coat"; 5]);
    assert_eq!(names, ["coat", "wet", "wet", "icy", "icy"]);
    assert_eq!((numbers, counts), (vec![4, 9, 9, 10, 10], vec![4, 2]));
    let at = rototoon_base::geometry::Point::ZERO;
    let coat = FillClick { at, colour: Some([0.5; 3]), name: Some("coat".into()) };
    let recolours = Recolours::new(list, &[FillClicks { frame: 0, clicks: vec![coat] }]);
    assert_eq!(recolours.meant(4, named("icy")), named("coat"), "a click means what was carried");
    assert_eq!(recolours.meant(2, named("icy")), named("icy"));
    assert_eq!(recolours.meant(0, named("wet")), named("wet"));
}

#[test]
fn a_new_colour_that_is_clicked_elsewhere_is_one_of_its_own() {
    let clicks = |frame, names: &[&str]| {
        let click = |name: &&str| FillClick {
            at: rototoon_base::geometry::Point::ZERO,
            colour: Some([0.5; 3]),
            name: Some((*name).to_owned()),
        };
        FillClicks { frame, clicks: names.iter().map(click).collect() }
    };
    let meant = |all: &[FillClicks]| {
        let mut mended = clicks(5, &["blue", "hat"]);
        Recolours::new(vec![entry("red", "blue", Some(3), None)], all).mean(&mut mended);
        mended.clicks[0].name.clone().unwrap()
    };
    assert_eq!(meant(&[clicks(0, &["red"]), clicks(5, &["blue"])]), "red");
    assert_eq!(meant(&[clicks(0, &["red", "blue"]), clicks(5, &["blue"])]), "blue", "the sky is blue before");
    assert_eq!(meant(&[clicks(4, &["red", "blue"])]), "blue", "both are on one drawing");
}

#[test]
fn entries_are_read_written_and_removed() {
    let clicks = r#""fills": [{"frame": 0, "regions": [{"at": [1, 1], "name": "coat", "colour": [1, 0, 0]}, {"at": [2, 2], "colour": [0, 1, 0]}]}]"#;
    let mut doc = document(clicks);
    assert_eq!(doc.recolours().unwrap(), Recolours::default());
    let wet = Hue { name: Some("wet".into()), colour: [0.1, 0.2, 0.3] };
    let coat = Hue { name: Some("coat".into()), colour: [1.0, 0.0, 0.0] };
    let plain = |colour| Hue { name: None, colour };
    let list = [
        Recolour { from: coat, to: wet.clone(), first: Some(3), last: None },
        Recolour { from: plain([0.0, 1.0, 0.0]), to: plain([0.0, 0.5, 0.0]), first: Some(2), last: Some(2) },
        Recolour { from: wet, to: plain([0.0; 3]), first: None, last: Some(9) },
    ];
    list.iter().for_each(|own| doc.add_recolour(own).unwrap());
    let mut again = Document::parse(&doc.to_json(), "a.json").unwrap();
    assert_eq!(again.recolours().unwrap().list(), list);
    let told: Vec<String> = list.iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        [
            r#""coat" becomes "wet" from frame 3 on"#,
            "#00ff00 becomes #008000 on frame 2",
            r#""wet" becomes #000000 up to frame 9"#
        ]
    );
    let mut other = again.clone();
    other.set_recolours_json(r#"[{"from": {"name": "coat"}, "to": {"colour": [0, 0, 0]}, "first": 7}]"#).unwrap();
    assert_eq!(other.recolours().unwrap().list()[0].first, Some(7));
    assert!(other.set_recolours_json(r#"[{"from": 7}]"#).is_err() && other.set_recolours_json("[").is_err());
    assert_eq!(other.recolours().unwrap().list().len(), 1, "nothing was changed");
    other.set_recolours_json("[]").unwrap();
    assert!(!other.to_json().contains("recolours"));
    again.remove_recolours(&[0]).unwrap();
    let left: Vec<String> = again.recolours().unwrap().list().iter().map(ToString::to_string).collect();
    assert_eq!(left, told[1..]);
    again.remove_recolours(&[0, 1]).unwrap();
    assert!(!again.to_json().contains("recolours") && again.to_json().contains("\"note\""));
}

#[test]
fn a_look_with_many_digits_is_found_again() {
    let mut doc =
        document(r#""fills": [{"frame": 0, "regions": [{"at": [1, 1], "colour": [0.123456789, 0.2, 0.3]}]}]"#);
    let clicked = doc.fills().unwrap()[0].clicks[0].hue().unwrap();
    doc.add_recolour(&Recolour { from: clicked.clone(), ..entry("", "wet", None, None) }).unwrap();
    let read = doc.recolours().unwrap();
    assert!(read.list()[0].from.is_same(&clicked), "{read:?}");
}

#[test]
fn a_name_looks_as_palette_click_or_the_entry_before_says() {
    let entries = r#""recolours": [{"from": {"name": "coat", "colour": [1, 0, 0]}, "to": {"name": "wet", "colour": [1, 1, 1]}},
        {"from": {"name": "hat", "colour": [0, 1, 0]}, "to": {"name": "wet", "colour": [0, 0, 0]}}]"#;
    let looks = |fields: &str| -> Vec<Colour> {
        document(&format!("{entries}{fields}")).recolours().unwrap().list().iter().map(|own| own.to.colour).collect()
    };
    assert_eq!(looks(""), [[1.0; 3]; 2], "one name has one look");
    assert_eq!(looks(r#", "palette": {"wet": [0.5, 0.5, 0.5]}"#), [[0.5; 3]; 2]);
    let mut doc = document(
        r#""recolours": [{"from": {"colour": [1, 0, 0]}, "to": {"name": "wet", "colour": [1, 1, 1]}}, {"from": {"colour": [0, 1, 0]}, "to": {"name": "wet"}}]"#,
    );
    doc.remove_recolours(&[0]).unwrap();
    assert_eq!(doc.recolours().unwrap().list()[0].to.colour, [1.0; 3], "its look is handed on");
}

#[test]
fn errors_name_entry_and_field() {
    let told = |text: &str| document(&format!(r#""recolours": {text}"#)).recolours().unwrap_err().to_string();
    assert_eq!(told("7"), "recolours: found 7, expected a list");
    let whole = r#""from": {"name": "a", "colour": [1, 1, 1]}, "to": {"colour": [0, 0, 0]}"#;
    assert_eq!(
        told(&format!(r#"[{{{whole}, "first": 5, "last": 4}}]"#)),
        "recolours[0].last: found 4, expected at least 5, the first frame"
    );
    assert_eq!(
        told(&format!(r#"[{{{whole}, "first": 0.5}}]"#)),
        "recolours[0].first: found 0.5, expected a frame number"
    );
    assert_eq!(
        told(r#"[{"from": {"name": "a"}, "to": {"colour": [0, 0, 0]}}]"#),
        "recolours[0].from.name: found \"a\", expected a name of the field palette or of a click, or a colour beside it"
    );
    assert_eq!(
        told(r#"[{"from": {"colour": [1, 1, 1]}, "to": {"name": "b"}}]"#),
        "recolours[0].to.name: found \"b\", expected a name of the field palette or of a click, or a colour beside it"
    );
    assert_eq!(
        told(r#"[{"from": {"name": "a", "colour": [1, 1, 1]}, "to": {"name": "a", "colour": [0, 0, 0]}}]"#),
        "recolours[0].to: found \"a\", expected another colour than that of \"from\""
    );
    assert!(told(r#"[{"to": {"name": "a"}}]"#).starts_with("recolours[0].from: found nothing"));
    assert!(told(r#"[{"from": {}, "to": {}}]"#).starts_with("recolours[0].from: found no name and no colour"));
}
