use super::*;
use crate::export;
use rototoon_base::scene::{Part, Scene};

fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 1, last: 9, fps: 24.0, width: 200, height: 100 }
}

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
    let scene = Scene { footage: footage(), parts: vec![part("far größe", 0.0, true), part("near", 2.0, false)] };
    let found = nuke(&export::nuke(&scene, 1.0), &footage(), 1).unwrap();
    assert_eq!(found.warnings, [""; 0]);
    for (shape, part) in found.shapes.iter().zip(&scene.parts) {
        assert_eq!((&shape.name, shape.closed), (&part.name, part.closed));
        for (frame, points) in &part.keys {
            let apart = shape.keys[frame].iter().zip(points).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(apart < 1e-4 && shape.keys[frame].len() == points.len(), "{frame}: {:?}", shape.keys[frame]);
        }
    }
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
        ("bspline", "", "expected bezier"),
        ("bezier", "{t 5 7 0 x41200000 0 0 0 0 0 1 1 1}", "transformation"),
        ("bezier", "{t 5 7 0 0 0 0 0 0 {{1 0} {5 30}} 1 1 1}", "transformation"),
    ] {
        let found = nuke(&script(kind, points, after), &footage(), 1).unwrap();
        assert!(found.shapes.is_empty() && found.warnings[0].contains(said), "{:?}", found.warnings);
        assert!(found.warnings[0].starts_with("line 10, column 5"), "{:?}", found.warnings);
    }
    for (points, said) in [
        ("{p {0 0} {10 0}}", "found 2 pairs"),
        ("{p {0 0} {nan 0} {0 0} {0 0} {1 1} {0 0}}", "expected a number"),
        ("{p {0 0} {x7f800000 0} {0 0} {0 0} {1 1} {0 0}}", "expected a number"),
        ("{px 77 {0 0} {1 0} {0 0} {0 0} {1 1} {0 0}}", "found a key on frame 77"),
        ("{q}", "found no points"),
    ] {
        let error = nuke(&script("bezier", points, ""), &footage(), 1).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("line"), "{error}");
    }
    assert!(nuke("Blur {\n size 3\n}", &footage(), 1).unwrap_err().to_string().contains("found no shape"));
}
