use super::super::probes::{corners, footage};
use super::*;

/// A number of a control point with its keys, as an archive has it.
fn animated(name: &str, still: f64, keys: &[(f64, f64)]) -> String {
    let key = |(time, value): &(f64, f64)| {
        format!(
            "<item><Time>{time:e}</Time><Value>{value:e}</Value><InterpolationMethod>1</InterpolationMethod><LeftDerivative>0</LeftDerivative><RightDerivative>0</RightDerivative></item>"
        )
    };
    let keys: String = keys.iter().map(key).collect();
    format!(
        "<{name}>{still:e}</{name}><{name}_animation><KeyFrameSet><count>0</count><item_version>0</item_version>{keys}</KeyFrameSet></{name}_animation>"
    )
}

/// A control point whose x is moved by each key's value from `x`.
fn point(tag: &str, (x, y): (f64, f64), handle: (f64, f64), keys: &[(f64, f64)]) -> String {
    let number = |name: &str, value: f64, keys: &[(f64, f64)]| {
        let keys: Vec<_> = keys.iter().map(|(time, by)| (*time, value + by)).collect();
        animated(name, value, &keys)
    };
    let parts = [
        number("X", x, keys),
        number("Y", y, &[]),
        number("Left_X", x - handle.0, keys),
        number("Left_Y", y - handle.1, &[]),
        number("Right_X", x + handle.0, keys),
        number("Right_Y", y + handle.1, &[]),
    ];
    format!("<{tag} class_id=\"17\" tracking_level=\"0\" version=\"5\">{}<Broken>0</Broken></{tag}>", parts.concat())
}

/// A parameter with the values, each a number or keys.
fn parameter(name: &str, values: &[&str]) -> String {
    let value = |text: &&str| {
        let curve = if text.starts_with('<') { *text } else { "" };
        let plain = if curve.is_empty() { *text } else { "7" };
        format!(
            "<item><Enabled>1</Enabled><HasAnimation>{}</HasAnimation>{curve}<Value>{plain}</Value><Default>0</Default><HasMaster>0</HasMaster><Expression></Expression><ExprHasRet>0</ExprHasRet></item>",
            i32::from(!curve.is_empty())
        )
    };
    let values: String = values.iter().map(value).collect();
    format!(
        "<Item><Name>{name}</Name><Type>Double</Type><Dimension>1</Dimension><Secret>0</Secret><MasterIsAlias>0</MasterIsAlias>{values}<UserKnob>0</UserKnob></Item>"
    )
}

fn own(name: &str, label: &str) -> String {
    format!(
        "<RotoItemSerialization><Name>{name}</Name><Label>{label}</Label><Activated>1</Activated><ParentLayer>Layer1</ParentLayer><Locked>0</Locked></RotoItemSerialization>"
    )
}

fn bezier(label: &str, parameters: &str, points: &[String], closed: bool) -> String {
    let pairs: String = points.iter().map(|cp| cp.clone() + &cp.replace("CP", "FP")).collect();
    format!(
        "<Type>0</Type>\n<Item class_id=\"15\" tracking_level=\"0\" version=\"4\"><RotoDrawableItemSerialization>{}<NbItems>1</NbItems>{parameters}<OC.r>1</OC.r></RotoDrawableItemSerialization><NumPoints>{}</NumPoints>{pairs}<Closed>{}</Closed><OpenBezier>0</OpenBezier></Item>",
        own("Bezier1", label),
        points.len(),
        i32::from(closed)
    )
}

fn project(items: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n<!DOCTYPE boost_serialization>\n<boost_serialization signature=\"serialization::archive\" version=\"12\">\n<Project><Nodes><item><Plugin_id>fr.inria.built-in.Roto</Plugin_id><HasRotoContext>1</HasRotoContext><RotoContext class_id=\"12\" tracking_level=\"0\" version=\"2\"><BaseLayer>{}<NumChildren>1</NumChildren>{items}</BaseLayer><AutoKeying>1</AutoKeying></RotoContext></item></Nodes></Project></boost_serialization>",
        own("Layer1", "Layer1")
    )
}

/// The rectangle (40, 20) to (60, 30), y up, with straight sides.
fn rectangle(keys: &[(f64, f64)]) -> Vec<String> {
    [(40.0, 20.0), (60.0, 20.0), (60.0, 30.0), (40.0, 30.0)].map(|p| point("CP", p, (0.0, 0.0), keys)).to_vec()
}

#[test]
fn shapes_of_layers_have_their_names_order_and_keys() {
    let far = bezier("Größe &amp; more", "", &rectangle(&[(2.0, 0.0), (6.0, 8.0)]), true);
    let near = bezier("", "", &rectangle(&[])[..3], false);
    let layer = format!("<Type>2</Type><Item>{}<NumChildren>1</NumChildren>{near}</Item>", own("Layer2", "inner"));
    let stroke = "<Type>1</Type><Item><RotoDrawableItemSerialization><RotoItemSerialization><Name>Pencil1</Name></RotoItemSerialization></RotoDrawableItemSerialization><BrushType>0</BrushType></Item>";
    let found = natron(&project(&(far + &layer + stroke)), &footage(), 3).unwrap();
    let seen: Vec<_> = found.shapes.iter().map(|shape| (shape.name.as_str(), shape.closed, shape.keys.len())).collect();
    assert_eq!(seen, [("Größe & more", true, 2), ("Bezier1", false, 1)]);
    assert_eq!(found.shapes[1].keys[&3][2], Point::new(60.0, 70.0));
    corners(&found.shapes[0], 6, [(48.0, 20.0), (68.0, 20.0), (68.0, 30.0), (48.0, 30.0)]);
    assert_eq!(found.warnings.len(), 1);
    assert!(found.warnings[0].contains("the paint stroke \"Pencil1\" is left out"), "{:?}", found.warnings);
}

#[test]
fn a_disc_is_round() {
    let round = 20.0 * 0.552_284_75;
    let points = [
        point("CP", (120.0, 60.0), (0.0, round), &[]),
        point("CP", (100.0, 80.0), (-round, 0.0), &[]),
        point("CP", (80.0, 60.0), (0.0, -round), &[]),
        point("CP", (100.0, 40.0), (round, 0.0), &[]),
    ];
    let found = natron(&project(&bezier("disc", "", &points, true)), &footage(), 5).unwrap();
    let points = &found.shapes[0].keys[&5];
    assert!(points.len() > 12);
    for p in points {
        assert!((p.distance(Point::new(100.0, 40.0)) - 20.0).abs() < 0.02, "{p}");
    }
}

#[test]
fn a_shape_is_where_its_transformation_puts_it() {
    let read =
        |parameters: &str| natron(&project(&bezier("a", parameters, &rectangle(&[]), true)), &footage(), 4).unwrap();
    let moved = [("translate", ["5", "1"]), ("center", ["40", "20"]), ("scale", ["2", "3"])];
    let moved: String = moved.iter().map(|(name, values)| parameter(name, values)).collect();
    let turned = moved + &parameter("rotate", &["90"]);
    let found = read(&turned);
    assert_eq!(found.warnings, [""; 0]);
    corners(&found.shapes[0], 4, [(45.0, 21.0), (45.0, 61.0), (15.0, 61.0), (15.0, 21.0)]);
    // A uniform scale takes that of x.
    let found = read(&(turned + &parameter("uniform", &["1"])));
    corners(&found.shapes[0], 4, [(45.0, 21.0), (45.0, 61.0), (25.0, 61.0), (25.0, 21.0)]);
    // Skew about (40, 20): (20, 10) goes to (20 · 1.1 + 10 · 0.5, 20 · 0.2 + 10).
    let skew = parameter("skewx", &["0.5"]) + &parameter("skewy", &["0.2"]) + &parameter("center", &["40", "20"]);
    let found = read(&skew);
    corners(&found.shapes[0], 4, [(40.0, 20.0), (62.0, 24.0), (67.0, 34.0), (45.0, 30.0)]);
    let found = read(&(skew + &parameter("skewOrder", &["1"])));
    corners(&found.shapes[0], 4, [(40.0, 20.0), (60.0, 24.0), (65.0, 35.0), (45.0, 31.0)]);
    let matrix = parameter("extraMatrix", &["1", "0", "3", "0", "2", "0", "0", "0", "1"]);
    corners(&read(&matrix).shapes[0], 4, [(43.0, 40.0), (63.0, 40.0), (63.0, 60.0), (43.0, 60.0)]);
}

#[test]
fn keys_of_a_transformation_are_keys_of_the_shape() {
    let key = |time: i32, value: f64| format!("<item><Time>{time}</Time><Value>{value}</Value></item>");
    let keys = key(3, 0.0) + &key(5, 8.0) + &key(90, 8.0);
    let curve = format!("<Curve><KeyFrameSet><count>3</count>{keys}</KeyFrameSet></Curve>");
    let text = project(&bezier("a", &parameter("translate", &[&curve, "0"]), &rectangle(&[]), true));
    let found = natron(&text, &footage(), 1).unwrap();
    let shape = &found.shapes[0];
    assert_eq!(shape.keys.keys().copied().collect::<Vec<_>>(), [3, 5, 9]);
    corners(shape, 5, [(48.0, 20.0), (68.0, 20.0), (68.0, 30.0), (48.0, 30.0)]);
}

#[test]
fn what_would_be_wrong_is_left_out_or_told() {
    let linked = parameter("translate", &["5", "0"]).replace("<HasMaster>0", "<HasMaster>1");
    let computed = parameter("rotate", &["5"]).replace("<Expression>", "<Expression>frame");
    let perspective = parameter("extraMatrix", &["1", "0", "0", "0", "1", "0", "0.5", "0", "1"]);
    for (parameters, said) in [(linked, "linked"), (computed, "expression"), (perspective, "perspective")] {
        let found = natron(&project(&bezier("a", &parameters, &rectangle(&[]), true)), &footage(), 4).unwrap();
        assert!(found.shapes.is_empty() && found.warnings[0].contains(said), "{:?}", found.warnings);
        assert!(
            found.warnings[0].starts_with("line 5, column 1: the shape \"a\" is left out: "),
            "{:?}",
            found.warnings
        );
    }
    let curve = bezier("a", "", &rectangle(&[]), true);
    for (items, said) in [
        (curve.replace("<NumPoints>4", "<NumPoints>5"), "found 4 <CP> and NumPoints 5"),
        (curve.replace("<X>4e1</X>", "<X>nan</X>"), "<X>: found \"nan\", expected a number"),
        (curve.replacen("<Y>2e1</Y>", "", 1), "<CP>: found no <Y>"),
        (bezier("a", "", &rectangle(&[(77.0, 0.0)]), true), "found a key on frame 77, expected a frame of the footage"),
    ] {
        let error = natron(&project(&items), &footage(), 1).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("line"), "{error}");
    }
    let none = natron("<boost_serialization/>", &footage(), 1).unwrap_err().to_string();
    assert!(none.contains("found no shape, expected a Bézier curve"), "{none}");
    let yaml = natron("Nodes:\n  - A", &footage(), 1).unwrap_err().to_string();
    assert!(yaml.contains("not XML"), "{yaml}");
}

#[test]
fn a_falloff_is_read_with_its_ramp() {
    let points: Vec<String> =
        [(10.0, 10.0), (60.0, 10.0), (60.0, 50.0)].map(|at| point("CP", at, (0.0, 0.0), &[])).into();
    let keyed = "<Curve><KeyFrameSet><item><Time>2</Time><Value>3</Value></item><item><Time>6</Time><Value>1</Value></item></KeyFrameSet></Curve>";
    for (rate, ramp, falloff) in [
        ("2.5", "0", Falloff { rate: 2.5, curve: None }),
        ("2", "1", Falloff { rate: 6.0, curve: Some(FalloffCurve::Linear) }),
        ("0.001", "2", Falloff { rate: Falloff::LEAST, curve: Some(FalloffCurve::EaseIn) }),
        ("1", "4", Falloff { rate: 1.0, curve: Some(FalloffCurve::Smooth) }),
        (keyed, "3", Falloff { rate: 3.0, curve: Some(FalloffCurve::EaseOut) }),
    ] {
        let parameters = parameter("featherFallOff", &[rate]) + &parameter("fallOffType", &[ramp]);
        let text = project(&bezier("soft", &parameters, &points, true));
        let found = natron(&text, &footage(), 1).unwrap();
        assert_eq!(found.shapes[0].falloff, Some(falloff), "{rate} {ramp}");
        assert_eq!(found.warnings.len(), usize::from(rate == keyed), "{:?}", found.warnings);
    }
}

#[test]
fn keys_that_hold_do_so_until_the_next_one_and_curves_are_told() {
    let method =
        |text: &str, number: u8| text.replace("<InterpolationMethod>1<", &format!("<InterpolationMethod>{number}<"));
    let plain = project(&bezier("arm", "", &rectangle(&[(2.0, 0.0), (6.0, 8.0), (9.0, 8.0)]), true));
    let held = natron(&method(&plain, 0), &footage(), 1).unwrap();
    assert_eq!(held.warnings, [""; 0]);
    assert_eq!(held.shapes[0].keys.keys().copied().collect::<Vec<_>>(), [2, 5, 6, 9]);
    corners(&held.shapes[0], 5, [(40.0, 20.0), (60.0, 20.0), (60.0, 30.0), (40.0, 30.0)]);
    corners(&held.shapes[0], 6, [(48.0, 20.0), (68.0, 20.0), (68.0, 30.0), (48.0, 30.0)]);
    let curved = natron(&method(&plain, 2), &footage(), 1).unwrap();
    assert_eq!(curved.shapes, natron(&plain, &footage(), 1).unwrap().shapes);
    assert!(curved.warnings.len() == 1 && curved.warnings[0].contains("goes in curves"), "{:?}", curved.warnings);
}

#[test]
fn a_curve_that_turns_between_keys_has_a_key_on_every_frame() {
    let keys = |number: u8| {
        let key = |time: u8, value: u8| {
            format!(
                "<item><Time>{time}</Time><Value>{value}</Value><InterpolationMethod>{number}</InterpolationMethod></item>"
            )
        };
        format!("<Curve><KeyFrameSet>{}{}</KeyFrameSet></Curve>", key(2, 0), key(6, 180))
    };
    let read = |number: u8| {
        let turned = [parameter("rotate", &[&keys(number)]), parameter("center", &["50", "25"])].concat();
        natron(&project(&bezier("arm", &turned, &rectangle(&[]), true)), &footage(), 1).unwrap().shapes.remove(0)
    };
    let turned = read(1);
    assert_eq!(turned.keys.keys().copied().collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
    corners(&turned, 4, [(55.0, 15.0), (55.0, 35.0), (45.0, 35.0), (45.0, 15.0)]);
    let held = read(0);
    assert_eq!(held.keys.keys().copied().collect::<Vec<_>>(), [2, 5, 6]);
    corners(&held, 5, [(40.0, 20.0), (60.0, 20.0), (60.0, 30.0), (40.0, 30.0)]);
}
