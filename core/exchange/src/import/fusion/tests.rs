use super::*;
use crate::export;
use rototoon_base::scene::{Part, Scene};

fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 10, last: 19, fps: 12.5, width: 40, height: 32, held: false }
}

fn read(text: &str) -> Result<Shapes, ImportError> {
    fusion(text, &footage(), 12)
}

/// A setting with masks, of which each has a polyline and inputs.
fn setting(masks: &[(&str, &str, &str)], splines: &str) -> String {
    let mask = |(kind, name, inputs): &(&str, &str, &str)| format!("{name} = {kind} {{ Inputs = {{ {inputs} }} }},");
    format!("{{ Tools = ordered() {{ {} {splines} }} }}", masks.iter().map(mask).collect::<String>())
}

const SQUARE: &str = "Polyline { Closed = true, Points = { { Linear = true, X = -0.25, Y = 0.25 }, { X = 0.25, Y = 0.25 }, { X = 0.25, Y = -0.25 }, { X = -0.25, Y = -0.25 } } }";

#[test]
fn what_was_exported_comes_back() {
    let at = |frame: FrameNumber| {
        let x = f64::from(frame) * 1.25 - if frame > 14 { 7.0 } else { 0.0 };
        vec![Point::new(x, 1.0), Point::new(20.0, 30.5), Point::new(3.0, 16.0)]
    };
    let part = |name: &str, frames: &[FrameNumber]| {
        let keys: BTreeMap<_, _> = frames.iter().map(|&frame| (frame, at(frame))).collect();
        Part { name: name.into(), closed: name != "line", tracks: keys.clone(), keys, ..Part::default() }
    };
    let all: Vec<FrameNumber> = (10..20).collect();
    let parts = vec![part("body", &all), part("line", &all), part("hand", &[10, 11, 12, 16, 17, 18, 19])];
    let text = export::fusion(&Scene { footage: footage(), parts: parts.clone() }, 1.0);
    let found = read(&text).unwrap();
    assert_eq!(found.warnings, [""; 0]);
    let shapes = found.shapes;
    assert_eq!(shapes.iter().map(|shape| shape.name.as_str()).collect::<Vec<_>>(), ["body", "line", "hand"]);
    for (shape, part) in shapes.iter().zip(&parts) {
        assert_eq!(shape.closed, part.closed);
        let absent = if part.name == "hand" { vec![[13, 15]] } else { vec![] };
        assert_eq!(shape.absent, absent, "{}", part.name);
        for (frame, points) in &shape.keys {
            let far = points.iter().zip(&part.keys[frame]).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(far < 1e-5 && points.len() == 3, "{} on {frame}: {far}", part.name);
        }
    }
    assert_eq!(shapes[0].keys.keys().copied().collect::<Vec<_>>(), all);
}

#[test]
fn a_still_mask_has_one_key_and_its_handles_make_curves() {
    let round = "Polyline { Closed = true, Points = { { X = 0, Y = 0.25, LX = -0.1, RX = 0.1 }, { X = 0, Y = -0.25, LX = 0.1, RX = -0.1 } } }";
    let inputs = |shape: &str| {
        format!(
            "Polyline = Input {{ Value = {shape}, }}, Polyline2 = Input {{ Value = Polyline {{ }}, Disabled = true }},"
        )
    };
    let text = setting(&[("PolylineMask", "box", &inputs(SQUARE)), ("PolylineMask", "egg", &inputs(round))], "");
    let found = read(&text).unwrap();
    assert_eq!(found.warnings, [""; 0]);
    let [egg, square] = &found.shapes[..] else { panic!("{:?}", found.shapes) };
    let corners = [(10.0, 8.0), (30.0, 8.0), (30.0, 24.0), (10.0, 24.0)].map(|(x, y)| Point::new(x, y));
    assert_eq!(square.keys, BTreeMap::from([(12, corners.to_vec())]));
    let points = &egg.keys[&12];
    // Half way its bow is ¾ of the handles' 0.1 × 40 px away.
    let right = points.iter().map(|p| p.x).fold(0.0, f64::max);
    assert!(points.len() > 8 && (right - 23.0).abs() < 0.1, "{right}");
}

#[test]
fn eased_keys_and_held_ones_give_the_shapes_of_each_frame() {
    let moved = SQUARE.replace("0.25", "0.125");
    let spline = format!(
        "way = BezierSpline {{ KeyFrames = {{ [10] = {{ 0, RH = {{ 11.333333, 0 }}, Value = {SQUARE} }}, [14] = {{ 1, LH = {{ 12.666667, 1 }}, Flags = {{ StepOut = true }}, Value = {moved} }}, [17] = {{ 2, Value = {SQUARE} }} }} }}"
    );
    let inputs = "Polyline = Input { SourceOp = \"way\", Source = \"Value\", },";
    let found = read(&setting(&[("PolylineMask", "box", inputs)], &spline)).unwrap();
    let left: Vec<(FrameNumber, f64)> = found.shapes[0].keys.iter().map(|(f, points)| (*f, points[0].x)).collect();
    let eased = [0.0, 0.15625, 0.5, 0.84375, 1.0].map(|share| 10.0 + 5.0 * share);
    let expected = (10..15).zip(eased).chain([(15, 15.0), (16, 15.0), (17, 10.0)]);
    for ((frame, x), (at, expected)) in left.iter().zip(expected) {
        assert!(*frame == at && (x - expected).abs() < 1e-4, "{frame}: {x}, {at}: {expected}");
    }
    assert_eq!(left.len(), 8);
}

#[test]
fn polygons_of_one_mask_are_shapes_of_their_own() {
    let one = |k: usize, level: f64| {
        format!(
            "[\"PolyMask{k}.Level\"] = Input {{ Value = {level} }}, [\"PolyMask{k}.Polyline\"] = Input {{ Value = {SQUARE} }}, [\"PolyMask{k}.Polyline2\"] = Input {{ Value = Polyline {{ }} }},"
        )
    };
    let found = read(&setting(&[("MultiPoly", "land", &(one(1, 1.0) + &one(2, -1.0)))], "")).unwrap();
    let names: Vec<&str> = found.shapes.iter().map(|shape| shape.name.as_str()).collect();
    assert_eq!(names, ["land PolyMask2", "land PolyMask1"]);
    assert_eq!(found.warnings.len(), 1);
    assert!(found.warnings[0].contains("\"land PolyMask2\" takes its area away"), "{:?}", found.warnings);
}

#[test]
fn what_would_be_wrong_is_left_out_or_told() {
    let shape = format!("Polyline = Input {{ Value = {SQUARE} }},");
    for (kind, inputs, message) in [
        ("BSplineMask", shape.clone(), "is left out: found a BSplineMask, expected a PolylineMask"),
        ("PolylineMask", shape.clone() + "Center = Input { Value = { 0.5, 0.6 } }", "its Center is set"),
        ("PolylineMask", shape.clone() + "Size = Input { SourceOp = \"x\", Source = \"Value\" }", "its Size is set"),
        ("PolylineMask", shape.clone() + "Invert = Input { Value = 1 }", "is inverted; it comes in as it is drawn"),
        (
            "PolylineMask",
            shape.clone() + "PaintMode = Input { Value = FuID { \"Subtract\" } }",
            "has the mode \"Subtract\"",
        ),
        ("PolylineMask", shape.clone() + "Level = Input { Value = 0 }", "the file shows the shape \"box\" on no frame"),
        ("PolylineMask", "Polyline = Input { SourceOp = \"Tracker1\" }".into(), "comes from \"Tracker1\""),
        ("PolylineMask", "Polyline = Input { Expression = \"x\" }".into(), "found an expression"),
        ("PolylineMask", "Polyline = Input { Value = Polyline { } }".into(), "found 0 points"),
        ("PolylineMask", String::new(), "found no Polyline"),
    ] {
        let found = read(&setting(&[(kind, "box", &inputs)], "")).unwrap();
        assert!(found.warnings.iter().any(|warning| warning.contains(message)), "{message}: {:?}", found.warnings);
    }
    // What changes nothing is none of it.
    let plain = shape
        + "Center = Input { Value = { 0.5, 0.5 } }, Size = Input { Value = 1 }, SoftEdge = Input { Value = 0.02 }, PaintMode = Input { Value = FuID { \"Merge\" } }";
    assert_eq!(read(&setting(&[("PolylineMask", "box", &plain)], "")).unwrap().warnings, [""; 0]);
}

#[test]
fn files_without_shapes_and_wrong_points_are_refused() {
    let error = |text: &str| read(text).unwrap_err().to_string();
    assert_eq!(error("{ Tools = ordered() { } }"), "found no shape, expected a PolylineMask");
    assert!(error("{ a = PolylineMask { } }").contains("<PolylineMask>: found no Inputs"));
    let far = setting(
        &[(
            "PolylineMask",
            "box",
            "Polyline = Input { Value = Polyline { Points = { { X = 1e7, Y = 0 }, { X = 0, Y = 0 } } } }",
        )],
        "",
    );
    assert!(error(&far).contains("<Polyline>: found a place more than 10000000 pixels away"), "{}", error(&far));
    let bare =
        setting(&[("PolylineMask", "box", "Polyline = Input { Value = Polyline { Points = { { X = 1 } } } }")], "");
    assert!(error(&bare).contains("found no X and Y"));
    let late = format!("way = BezierSpline {{ KeyFrames = {{ [40] = {{ 0, Value = {SQUARE} }} }} }}");
    let late =
        setting(&[("PolylineMask", "box", "Polyline = Input { SourceOp = \"way\", Source = \"Value\" }")], &late);
    assert!(
        error(&late).contains("found a key on frame 40, expected a frame of the footage, 10 to 19"),
        "{}",
        error(&late)
    );
}

#[test]
fn a_mask_that_is_switched_off_is_told() {
    let input = format!("Polyline = Input {{ Value = {SQUARE}, }},");
    let text = setting(&[("PolylineMask", "box", &input)], "").replace("{ Inputs =", "{ PassThrough = true, Inputs =");
    let found = read(&text).unwrap();
    assert_eq!(found.shapes.len(), 1);
    let said = "the shape \"box\" is switched off; it comes in as it is drawn";
    assert!(found.warnings[0].contains(said), "{:?}", found.warnings);
}
