use super::super::probes::{corners, footage};
use super::*;
use crate::export;
use rototoon_base::scene::{Part, Scene};

/// A script with one shape as Nuke writes it.
fn script(kind: &str, points: &str, after: &str) -> String {
    format!(
        "Roto {{\n output alpha\n curves {{{{{{v x3f99999a}}\n  {{f 0}}\n  {{n\n   {{layer Root\n    {{f 512}}\n    {{t x44b40000 x44070000}}\n    {{a}}\n    {{curvegroup Bezier1 512 {kind}\n     {{{{cc\n       {{f 8192}}\n       {points}}}     idem}}\n     {after}\n     {{a osw x41200000}}}}}}}}}}}}\n name Roto1\n}}\n"
    )
}

#[test]
fn what_is_exported_is_read_again() {
    let at = |x: f64| vec![Point::new(x, 2.0), Point::new(80.5, 2.25), Point::new(80.5, 60.0)];
    let part = |name: &str, depth, closed| Part {
        name: name.into(),
        closed,
        depth,
        keys: [(2, at(0.5)), (7, at(20.0))].into(),
        ..Part::default()
    };
    let mut scene = Scene { footage: footage(), parts: vec![part("far größe", 0.0, true), part("near", 2.0, false)] };
    scene.parts[0].falloff = Falloff { rate: 2.5, curve: None };
    let found = nuke(&export::nuke(&scene, 1.0), &footage(), 1).unwrap();
    assert_eq!(found.warnings, [""; 0]);
    for (shape, part) in found.shapes.iter().zip(&scene.parts) {
        assert_eq!((&shape.name, shape.closed, shape.falloff), (&part.name, part.closed, Some(part.falloff)));
        for (frame, points) in &part.keys {
            let apart = shape.keys[frame].iter().zip(points).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(apart < 1e-4 && shape.keys[frame].len() == points.len(), "{frame}: {:?}", shape.keys[frame]);
        }
    }
}

#[test]
fn a_falloff_is_read_and_one_with_keys_is_told() {
    let points = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let read = |value: &str| {
        nuke(&script("bezier", points, &format!("{{a ro 0 fo 1 ff {value} ft 0}}")), &footage(), 1).unwrap()
    };
    for (value, rate) in
        [("1", 1.0), ("x40200000", 2.5), ("0", Falloff::LEAST), ("90", Falloff::MOST), ("{{5 3}}", 3.0)]
    {
        let found = read(value);
        assert_eq!(found.shapes[0].falloff, Some(Falloff { rate, curve: None }), "{value}");
        assert_eq!(found.warnings, [""; 0]);
    }
    let moving = read("{{1 2} {9 4}}");
    assert_eq!(moving.shapes[0].falloff.unwrap().rate, 2.0);
    assert!(
        moving.warnings[0].contains("the falloff of \"Bezier1\" has keys: its first value is taken"),
        "{:?}",
        moving.warnings
    );
    // A shape whose falloff cannot be read is there all the same.
    assert_eq!(read("{=parent.size}").shapes[0].falloff, Some(Falloff::default()));
}

#[test]
fn a_disc_of_nuke_is_round() {
    // Radius 20 about (100, 60) with y up; handles relative, 0.5523 of the radius.
    let points = "{px x40a00000 {0 11.046} {120 60} {0 -11.046} {11.046 0} {100 40} {-11.046 0} {0 -11.046} {80 60} {0 11.046} {-11.046 0} {100 80} {11.046 0}}";
    let found = nuke(&script("bezier", points, "{tx x40a00000 x42c80000 x42700000}"), &footage(), 1).unwrap();
    let shape = &found.shapes[0];
    assert_eq!((shape.name.as_str(), shape.closed, shape.keys.len()), ("Bezier1", true, 1));
    assert!(shape.keys[&5].len() > 12);
    for p in &shape.keys[&5] {
        assert!((p.distance(Point::new(100.0, 40.0)) - 20.0).abs() < 0.02, "{p}");
    }
}

#[test]
fn keys_of_numbers_are_keys_of_the_shape() {
    let points = "{p {0 0} {{{2 10} {6 30}} 0} {0 0} {0 0} {50 {{4 0} {6 20}}} {0 0} {0 0} {50 90} {0 0}}";
    let shape = &nuke(&script("bezier", points, ""), &footage(), 1).unwrap().shapes[0];
    assert_eq!(shape.keys.keys().copied().collect::<Vec<_>>(), [2, 4, 6]);
    assert_eq!(shape.keys[&4][..2], [Point::new(20.0, 100.0), Point::new(50.0, 100.0)]);
    let still = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    assert!(nuke(&script("bezier", still, ""), &footage(), 3).unwrap().shapes[0].keys.contains_key(&3));
}

#[test]
fn what_would_be_wrong_is_left_out_or_told() {
    let points = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let same = "{t {{x3f800000 5}} 7 0 0 0 0 0 0 0 1 {{x3f800000 1}} 1}";
    assert_eq!(nuke(&script("bezier", points, same), &footage(), 1).unwrap().shapes.len(), 1);
    for (kind, after, said) in [
        ("cubic", "", "expected bezier or bspline"),
        ("bspline", "", "found handles beside the points"),
        ("bezier", "{t 5 7 0 0 0 0 x41200000 0 0 1 1 1}", "in depth"),
        ("bezier", "{t 5 7 0 0 0 x41200000 0 0 0 1 1 1}", "in depth"),
        ("bezier", "{t 5 7 0 0 0 0 0 0 {{1 0} {5 30}} 1 1 1 {{1 0} {5 x41200000}}}", "skewed"),
        ("bezier", "{t 5 7 0 0 0 0 0 0 0 1 1 1 0 1 0 0}", "matrix"),
        ("bezier", "{t 5 7 0 {=parent.x x41200000}}", "expression"),
    ] {
        let found = nuke(&script(kind, points, after), &footage(), 1).unwrap();
        let told = "line 10, column 5: the shape \"Bezier1\" is left out: ";
        assert!(found.shapes.is_empty() && found.warnings[0].contains(said), "{:?}", found.warnings);
        assert!(found.warnings[0].starts_with(told), "{:?}", found.warnings);
    }
    for (points, said) in [
        ("{p {0 0 1} {50 0 1} {50 90 x40000000} {0 90 1}}", "weights"),
        ("{p {0 0} {{=parent.x x41200000} 0} {50 90} {0 90}}", "expression"),
    ] {
        let found = nuke(&script("bspline", points, ""), &footage(), 1).unwrap();
        assert!(found.shapes.is_empty() && found.warnings[0].contains(said), "{:?}", found.warnings);
    }
    let open = script("bspline", "{p {0 0} {50 0} {50 90} {0 90}}", "").replace("{f 8192}", "{f 8224}");
    assert!(nuke(&open, &footage(), 1).unwrap().warnings[0].contains("open B-spline"));
    for (points, said) in [
        ("{p {0 0} {10 0}}", "found 2 pairs"),
        ("{p {0 0} {nan 0} {0 0} {0 0} {1 1} {0 0}}", "expected a number"),
        ("{p {0 0} {x7f800000 0} {0 0} {0 0} {1 1} {0 0}}", "expected a number"),
        (
            "{p {0 0} {{{77 0} {78 4}} 0} {0 0} {0 0} {1 1} {0 0}}",
            "found 2 keys on frames 77 to 78, expected a frame of the footage, 1 to 9",
        ),
        ("{q}", "found no points"),
    ] {
        let error = nuke(&script("bezier", points, ""), &footage(), 1).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("line"), "{error}");
    }
    assert!(nuke("Blur {\n size 3\n}", &footage(), 1).unwrap_err().to_string().contains("found no shape"));
}

/// The rectangle (40, 20) to (60, 30), y up, with straight sides.
const BOX: &str = "{p {0 0} {40 20} {0 0} {0 0} {60 20} {0 0} {0 0} {60 30} {0 0} {0 0} {40 30} {0 0}}";

#[test]
fn a_shape_is_scaled_then_turned_about_its_pivot_and_moved() {
    // Pivot (40, 20), moved by (5, 1), a quarter turn from x to y, scaled by 2 and 3.
    let text = script("bezier", BOX, "{t 40 20 0 5 1 0 0 0 90 2 3 1 0}");
    let found = nuke(&text, &footage(), 4).unwrap();
    assert_eq!(found.warnings, [""; 0]);
    corners(&found.shapes[0], 4, [(45.0, 21.0), (45.0, 61.0), (15.0, 61.0), (15.0, 21.0)]);
}

#[test]
fn keys_of_transformations_are_keys_of_the_shape() {
    // The shape goes right by 8 from frame 2 to 6, its layer up by 4 from frame 4 to 40, which is past the footage.
    let own = "{tx 2 0 0 0 {{2 0} {6 8}} 0 0}";
    let text = script("bezier", BOX, own)
        .replace("{t x44b40000 x44070000}", "{t 10 20 0 0 {{4 0} {40 4 1 0 257}} 0 0 0 0 {{4 1}} 1 1 {{4 0}}}");
    let found = nuke(&text, &footage(), 1).unwrap();
    let shape = &found.shapes[0];
    assert_eq!(shape.keys.keys().copied().collect::<Vec<_>>(), [2, 4, 6, 9]);
    let moved =
        |x: f64, y: f64| [(40.0 + x, 20.0 + y), (60.0 + x, 20.0 + y), (60.0 + x, 30.0 + y), (40.0 + x, 30.0 + y)];
    for (frame, x) in [(2, 0.0), (4, 4.0), (6, 8.0), (9, 8.0)] {
        corners(shape, frame, moved(x, f64::from(frame - 4).max(0.0) / 9.0));
    }
}

#[test]
fn a_layer_turns_what_its_shapes_did_before() {
    // The shape moves by (10, 0); then the layer turns all by a half turn about (50, 50).
    let text =
        script("bezier", BOX, "{t 0 0 0 10 0 0}").replace("{t x44b40000 x44070000}", "{t 50 50 0 0 0 0 0 0 180}");
    let shape = &nuke(&text, &footage(), 1).unwrap().shapes[0];
    corners(shape, 1, [(50.0, 80.0), (30.0, 80.0), (30.0, 70.0), (50.0, 70.0)]);
    // A layer that can't be read leaves out its shapes, not the others.
    let skewed = "{layer Skewed {t 0 0 0 0 0 0 0 0 0 1 1 1 5} {curvegroup Lost 512 bezier {{cc {f 8192} ";
    let inner = format!("{skewed}{BOX}}}}} idem}}}}\n    {{curvegroup Bezier1");
    let found = nuke(&text.replace("{curvegroup Bezier1", &inner), &footage(), 1).unwrap();
    assert_eq!((found.shapes.len(), found.warnings.len()), (1, 1));
    assert!(found.warnings[0].contains("\"Lost\" is left out: it or its layer is skewed"), "{:?}", found.warnings);
}

#[test]
fn a_closed_spline_is_uniform_and_cubic() {
    let text = script("bspline", "{px 3 {40 20 1} {60 20} {60 30} {{{3 40} {7 52}} 30}}", "{t 50 25 0 0 10}");
    let found = nuke(&text, &footage(), 1).unwrap();
    let shape = &found.shapes[0];
    assert_eq!((found.warnings.len(), shape.closed, shape.keys.len()), (0, true, 2));
    // Knots are (before + 4 own + after) ∕ 6, moved up by 10.
    let guides = |x: f64| [(40.0, 30.0), (60.0, 30.0), (60.0, 40.0), (x, 40.0)].map(|(x, y)| Point::new(x, 100.0 - y));
    for (frame, x) in [(3, 40.0), (7, 52.0)] {
        let guides = guides(x);
        for k in 0..4 {
            let knot = (guides[(k + 3) % 4] + 4.0 * guides[k] + guides[(k + 1) % 4]) / 6.0;
            let apart = shape.keys[&frame].iter().map(|p| p.distance(knot)).fold(f64::INFINITY, f64::min);
            assert!(apart < 1e-9, "{knot}: {:?}", shape.keys[&frame]);
        }
    }
}

#[test]
fn keys_beyond_the_footage_give_the_form_on_its_ends() {
    let points = |keys: &str| {
        format!("{{p {{0 0}} {{{{{keys}}} 0}} {{0 0}} {{0 0}} {{50 0}} {{0 0}} {{0 0}} {{50 90}} {{0 0}}}}")
    };
    for (keys, expected, said) in [
        ("{-3 0} {5 80}", vec![(1, 40.0), (5, 80.0)], "has a key on frame -3, beyond the footage's frames 1 to 9"),
        ("{5 0} {8 30} {13 80}", vec![(5, 0.0), (8, 30.0), (9, 40.0)], "has a key on frame 13,"),
        ("{-3 0} {13 16}", vec![(1, 4.0), (9, 12.0)], "has 2 keys on frames -3 to 13,"),
    ] {
        let found = nuke(&script("bezier", &points(keys), ""), &footage(), 1).unwrap();
        let x: Vec<_> = found.shapes[0].keys.iter().map(|(frame, points)| (*frame, points[0].x)).collect();
        assert_eq!(x, expected);
        assert_eq!(found.warnings.len(), 1);
        assert!(found.warnings[0].starts_with("line 10, column 5: the shape \"Bezier1\" "), "{:?}", found.warnings);
        assert!(found.warnings[0].contains(said), "{:?}", found.warnings);
    }
    // A still shape may have been drawn on any frame.
    let still = "{px 77 {0 0} {1 0} {0 0} {0 0} {1 1} {0 0}}";
    let found = nuke(&script("bezier", still, ""), &footage(), 1).unwrap();
    assert_eq!((found.shapes[0].keys.keys().copied().collect::<Vec<_>>(), found.warnings.len()), (vec![9], 1));
    // Beside keys that is the time of the last change.
    let moving = "{px 77 {0 0} {{{2 0} {4 1}} 0} {0 0} {0 0} {1 1} {0 0}}";
    assert_eq!(nuke(&script("bezier", moving, ""), &footage(), 1).unwrap().warnings, [""; 0]);
    // A shape beyond the footage keeps its held form beside another one.
    let late = script("bezier", &points("{20 7} {30 8}"), "").replace("Bezier1", "Late");
    let found = nuke(&(script("bezier", &points("{2 0} {4 1}"), "") + &late), &footage(), 1).unwrap();
    let keys: Vec<_> =
        found.shapes.iter().map(|shape| shape.keys.iter().map(|(f, p)| (*f, p[0].x)).collect::<Vec<_>>()).collect();
    assert_eq!(keys, [vec![(9, 7.0)], vec![(2, 0.0), (4, 1.0)]]);
}

#[test]
fn invisible_inverted_and_subtracting_shapes_are_told() {
    let read = |attributes: &str| nuke(&script("bezier", BOX, &format!("{{a {attributes}}}")), &footage(), 4).unwrap();
    for (attributes, said) in [
        ("inv 1", "is inverted; it comes in as it is drawn"),
        ("osw 1 bm x41400000", "subtracts its area; it comes in as it is drawn"),
        ("bm 5 inv 1", "is inverted and keeps only what is inside of it"),
        ("bm 13", "has the blending mode 13"),
    ] {
        let found = read(attributes);
        let told = format!("line 10, column 5: the shape \"Bezier1\" {said}");
        assert!(found.shapes.len() == 1 && found.warnings[0].starts_with(&told), "{:?}", found.warnings);
    }
    for plain in ["inv 0 bm 0 vis 1", "bm 4"] {
        assert_eq!((read(plain).shapes.len(), read(plain).warnings.len()), (1, 0));
    }
    let found = read("vis 0");
    assert!(
        found.shapes.is_empty() && found.warnings[0].contains("is left out: it is invisible"),
        "{:?}",
        found.warnings
    );
    let found = read("vis {{1 1} {3 0} {6 1}}");
    assert_eq!(found.shapes[0].keys.keys().copied().collect::<Vec<_>>(), [2, 6]);
    assert_eq!((&found.shapes[0].absent[..], found.warnings.len()), (&[[3, 5]][..], 0));
    let layer = script("bezier", BOX, "").replace("{a}", "{a vis 0}");
    let found = nuke(&layer, &footage(), 4).unwrap();
    assert!(found.shapes.is_empty() && found.warnings[0].contains("its layer is invisible"), "{:?}", found.warnings);
}

#[test]
fn each_kind_of_lifetime_hides_the_frames_outside_of_it() {
    let points = "{p {{{2 0} {7 5}} 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let hidden = |kind: &str| {
        let found = nuke(&script("bezier", points, &format!("{{a ltn 4 ltm 6 ltt {kind}}}")), &footage(), 1).unwrap();
        let shape = &found.shapes[0];
        (footage().first..=footage().last).filter(|&frame| shape.extent.hides(frame)).collect::<Vec<_>>()
    };
    let all: Vec<_> = (footage().first..=footage().last).collect();
    let but = |shown: std::ops::RangeInclusive<FrameNumber>| {
        all.iter().copied().filter(|frame| !shown.contains(frame)).collect::<Vec<_>>()
    };
    assert!(hidden("0").is_empty());
    assert_eq!(hidden("1"), but(FrameNumber::MIN..=6));
    assert_eq!(hidden("2"), but(4..=4));
    assert_eq!(hidden("3"), but(4..=FrameNumber::MAX));
    assert_eq!(hidden("4"), but(4..=6));
}

#[test]
fn a_shape_that_stands_still_speaks_of_its_lifetime_alone() {
    let points = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let spoken = |first: FrameNumber, last: FrameNumber| {
        let found =
            nuke(&script("bezier", points, &format!("{{a ltn {first} ltm {last} ltt 4}}")), &footage(), 1).unwrap();
        let shape = &found.shapes[0];
        (footage().first..=footage().last).filter(|&frame| shape.extent.speaks_of(frame, false)).collect::<Vec<_>>()
    };
    assert_eq!(spoken(4, 4), [4]);
    assert_eq!(spoken(4, 6), [4, 5, 6]);
}

#[test]
fn a_shape_that_turns_between_keys_has_a_key_on_every_frame() {
    let points = "{p {0 0} {10 50} {0 0} {0 0} {50 50} {0 0} {0 0} {50 90} {0 0}}";
    let read =
        |t: &str| nuke(&script("bezier", points, &format!("{{t {t}}}")), &footage(), 1).unwrap().shapes.remove(0);
    let turned = read("50 50 0 0 0 0 0 0 {{2 0} {6 180}}");
    assert_eq!(turned.keys.keys().copied().collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
    // A quarter turn about (50, 50), y up, in a picture of 100 lines.
    for (found, wanted) in turned.keys[&4].iter().zip([(50.0, 90.0), (50.0, 50.0), (10.0, 50.0)]) {
        assert!(found.distance(Point::new(wanted.0, wanted.1)) < 1e-3, "{:?}", turned.keys[&4]);
    }
    assert_eq!(read("50 50 0 0 0 0 0 0 {{2 0} {6 360}}").keys.len(), 5, "a whole turn");
    assert_eq!(read("50 50 0 {{2 0} {6 9}} 0 0 0 0 30").keys.len(), 2, "a move goes straight");
    assert_eq!(read("50 50 0 0 0 0 0 0 0 {{2 1} {6 2}} 1 1").keys.len(), 2, "and so does a growth");
    assert_eq!(
        read("{{2 0} {6 50}} 50 0 0 0 0 0 0 0 {{2 1} {6 2}} 1 1").keys.len(),
        5,
        "but not about a pivot that moves"
    );
}

#[test]
fn shapes_beside_labels_and_python_are_all_read() {
    let points = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let shape = |name: &str| script("bezier", points, "").replace("Bezier1", name);
    for text in [
        r#" label "5\" board""#,
        r#" knobChanged "d = \{\"a\": 1\}\nif d:\n  print(\"\}\")""#,
        r" label \{hello",
        r#" label {5" board}"#,
        " # a comment with { brace and \" quote",
    ] {
        let note = if text.contains('#') { format!("{}\n", text.trim()) } else { format!("NoOp {{\n{text}\n}}\n") };
        let whole = format!("#! /usr/Nuke -nx\n{note}{}{note}{}{note}", shape("first"), shape("second"));
        let found = nuke(&whole, &footage(), 1).unwrap();
        let names: Vec<_> = found.shapes.iter().map(|shape| shape.name.as_str()).collect();
        assert_eq!(names, ["second", "first"], "{text}");
    }
}

#[test]
fn a_node_that_is_disabled_is_told() {
    let points = "{p {0 0} {10 0} {0 0} {0 0} {50 0} {0 0} {0 0} {50 90} {0 0}}";
    let read = |value: &str| {
        let node = script("bezier", points, "").replace(" name Roto1", &format!(" disable {value}\n name Roto1"));
        nuke(&node, &footage(), 1).unwrap()
    };
    let found = read("true");
    assert_eq!((found.shapes.len(), found.warnings.len()), (1, 1));
    let said = "the node Roto is disabled; its shapes come in as they are drawn";
    assert!(found.warnings[0].contains(said), "{:?}", found.warnings);
    assert_eq!(read("false").warnings, [""; 0]);
}
