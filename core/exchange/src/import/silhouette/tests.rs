use super::*;
use rototoon_base::geometry::Point;

const FOOTAGE: fn() -> Footage =
    || Footage { pattern: "%d".into(), first: 10, last: 20, fps: 1.0, width: 200, height: 100, held: false };

fn file(shape: &str, path: &str) -> String {
    format!(
        "<Silhouette sessionStartFrame=\"10\">\n<Object type=\"Shape\" {shape}><Properties>\n<Property id=\"path\">{path}</Property></Properties></Object></Silhouette>"
    )
}

fn key(frame: i32, kind: &str, points: &[&str]) -> String {
    let points: String = points.iter().map(|p| format!("<Point>{p}</Point>")).collect();
    format!("<Key frame=\"{frame}\"><Path closed=\"True\" type=\"{kind}\">{points}</Path></Key>")
}

#[test]
fn handles_lead_on_whichever_way_they_are_written() {
    // A disc of radius 20 pixels about the middle of the picture.
    let round = 0.2 * 0.552_284_75;
    let knots = [(0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.0, -0.2)];
    let text = |(x, y): (f64, f64), turned: f64| {
        let (dx, dy) = (-y / 0.2 * round * turned, x / 0.2 * round * turned);
        format!("({x},{y}),({},{}),({},{})", x + dx, y + dy, x - dx, y - dy)
    };
    for turned in [1.0, -1.0] {
        let points: Vec<String> = knots.iter().map(|&knot| text(knot, turned)).collect();
        let points: Vec<&str> = points.iter().map(String::as_str).collect();
        let found = silhouette(&file("label=\"disc\"", &key(3, "Bezier", &points)), &FOOTAGE()).unwrap();
        let shape = &found.shapes[0];
        assert_eq!((shape.name.as_str(), shape.closed), ("disc", true));
        for p in &shape.keys[&13] {
            assert!((p.distance(Point::new(100.0, 50.0)) - 20.0).abs() < 0.02, "{p}");
        }
    }
}

#[test]
fn handles_are_places_or_offsets() {
    // Discs of radius 20 pixels, in the middle of the picture and beside it.
    let round = 0.2 * 0.552_284_75;
    for (x0, y0) in [(0.0, 0.0), (0.6, -0.2), (-0.9, 0.4)] {
        for (offsets, turned) in [(false, 1.0), (false, -1.0), (true, 1.0), (true, -1.0)] {
            let knot = |(x, y): (f64, f64)| {
                let (dx, dy) = (-y / 0.2 * round * turned, x / 0.2 * round * turned);
                let (x, y) = (x + x0, y + y0);
                let (u, v) = if offsets { (0.0, 0.0) } else { (x, y) };
                format!("({x},{y}),({},{}),({},{})", u + dx, v + dy, u - dx, v - dy)
            };
            let knots = [(0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.0, -0.2)].map(knot);
            let points: Vec<&str> = knots.iter().map(String::as_str).collect();
            let found = silhouette(&file("", &key(3, "Bezier", &points)), &FOOTAGE()).unwrap();
            let middle = Point::new(100.0 + 100.0 * x0, 50.0 + 100.0 * y0);
            for p in &found.shapes[0].keys[&13] {
                assert!((p.distance(middle) - 20.0).abs() < 0.02, "{offsets} {turned} {p}");
            }
        }
    }
    // Corners: handles at their points, or offsets of nothing.
    for handle in ["(0.3,0.1)", "(0,0)"] {
        let points = ["(0.3,0.1)", "(0.4,0.1)", "(0.3,0.3)"].map(|at| {
            let own = if handle == "(0,0)" { handle } else { at };
            format!("{at},{own},{own}")
        });
        let points: Vec<&str> = points.iter().map(String::as_str).collect();
        let found = silhouette(&file("", &key(0, "Bezier", &points)), &FOOTAGE()).unwrap();
        let shape = &found.shapes[0].keys[&10];
        let length: f64 = rototoon_base::geometry::polyline::length(shape, true);
        assert!((length - (10.0 + 20.0 + 500f64.sqrt())).abs() < 1e-6, "{handle} {shape:?}");
    }
}

#[test]
fn a_spline_lies_within_its_guides_and_reaches_open_ends() {
    let points = ["(-0.2,-0.2)", "(0.2,-0.2)", "(0.2,0.2)", "(-0.2,0.2)"];
    let closed = silhouette(&file("", &key(0, "Bspline", &points)), &FOOTAGE()).unwrap();
    let far = |p: &Point| p.distance(Point::new(100.0, 50.0));
    assert!(closed.shapes[0].keys[&10].iter().all(|p| far(p) > 12.0 && far(p) < 20.0));
    let text = file("", &key(0, "Bspline", &points)).replace("True", "False");
    let open = &silhouette(&text, &FOOTAGE()).unwrap().shapes[0];
    assert!(!open.closed);
    let ends = [open.keys[&10][0], *open.keys[&10].last().unwrap()];
    assert!(ends[0].distance(Point::new(80.0, 30.0)) < 1e-9 && ends[1].distance(Point::new(80.0, 70.0)) < 1e-9);
}

#[test]
fn errors_name_the_element_and_what_was_expected() {
    let points = ["(0,0)", "(0.1,0)", "(0,0.1)"];
    let good = key(0, "Bezier", &points);
    for (text, place, message) in [
        (
            file("", &key(30, "Bezier", &points)),
            "line 3, column 21: <Key>",
            "found a key on frame 40, expected a frame of the footage, 10 to 20",
        ),
        (file("", &key(0, "Oval", &points)), "<Path>", "found \"Oval\", expected \"Bezier\" or \"Bspline\""),
        (file("", &key(0, "Bezier", &["(0;0)"])), "<Point>", "found \"(0;0)\", expected (x,y)"),
        (file("", &key(0, "Bezier", &["(NaN,0)"])), "<Point>", "expected (x,y)"),
        (file("", &key(0, "Bezier", &[])), "<Path>", "found no <Point>"),
        (
            file("label=\"a\"", &(good.clone() + &key(1, "Bezier", &points[..2]))),
            "<Property>",
            "3 on frame 10, 2 on frame 11",
        ),
        (file("label=\"a\"", ""), "<Property>", "found no key"),
        (file("", &good).replace("\"path\"", "\"p\""), "<Object>", "expected one"),
        (file("", &good).replace("Silhouette", "Svg"), "<Svg>", "expected <Silhouette>"),
        (file("hidden=\"True\"", &good), "found no shape", "not hidden"),
        ("<Silhouette>".into(), "found text that is not XML", ""),
    ] {
        let error = silhouette(&text, &FOOTAGE()).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(message), "{error}");
    }
}

/// A square of 20 pixels whose middle is `x` pixels right of the picture's.
fn square(frame: i32, x: f64) -> String {
    let corner = |dx: f64, dy: f64| format!("({},{})", (x + dx) / 100.0, dy / 100.0);
    let corners = [corner(-10.0, -10.0), corner(10.0, -10.0), corner(10.0, 10.0), corner(-10.0, 10.0)];
    let points: Vec<String> = corners.iter().map(|at| format!("{at},{at},{at}")).collect();
    key(frame, "Bezier", &points.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The middle of a shape on each of its keys, from the middle of the picture.
fn middles(shape: &Shape) -> Vec<(FrameNumber, f64, f64)> {
    let middle = |points: &Vec<Point>| points.iter().sum::<Point>() / points.len() as f64 - Point::new(100.0, 50.0);
    let rounded = |value: f64| (value * 1e6).round() / 1e6;
    let found = shape.keys.iter().map(|(frame, points)| (*frame, middle(points)));
    found.map(|(frame, p)| (frame, rounded(p.x), rounded(p.y))).collect()
}

/// The shapes of a file in which layers with these properties lie within each other.
fn layered(layers: &[&str], shape: &str) -> Result<Shapes, ImportError> {
    let open = |properties: &&str| format!("<Object type=\"Layer\"><Properties>{properties}<Property id=\"objects\">");
    let (start, end): (String, String) =
        (layers.iter().map(open).collect(), "</Property></Properties></Object>".repeat(layers.len()));
    let text = file("label=\"a\"", shape).replace("<Object type=\"Shape\"", &format!("{start}<Object type=\"Shape\""));
    silhouette(&text.replace("</Silhouette>", &format!("{end}</Silhouette>")), &FOOTAGE())
}

fn matrix(keys: &str) -> String {
    format!("<Property id=\"transform.matrix\">{keys}</Property>")
}

#[test]
fn layers_move_their_shapes_from_the_inside_out() {
    let right = matrix("<Value>(1,0,0,0,0,1,0,0,0,0,1,0,0.2,0.1,0,1)</Value>");
    let double = matrix("<Value>(2,0,0,0,0,2,0,0,0,0,1,0,0,0,0,1)</Value>");
    let still =
        "<Value>".to_owned() + square(0, 30.0).split_once('>').unwrap().1.trim_end_matches("</Key>") + "</Value>";
    for shape in [square(0, 30.0), still] {
        let found = |layers: &[&str]| layered(layers, &shape).unwrap();
        assert_eq!(middles(&found(&[&right, &double]).shapes[0]), [(10, 80.0, 10.0)]);
        assert_eq!(middles(&found(&[&double, &right]).shapes[0]), [(10, 100.0, 20.0)]);
        assert_eq!(found(&[&double]).warnings, [""; 0]);
    }
    // Rounding is no movement, and a keyed one gives keys.
    let noise = matrix("<Key frame=\"3\">(1,0.000001,0,0,0,1,0,0,0,0,1,0,-0.000001,0,0,1)</Key>");
    assert_eq!(middles(&layered(&[&noise], &square(0, 30.0)).unwrap().shapes[0]), [(10, 30.0, 0.0)]);
    let key = |frame: i32, x: f64| format!("<Key frame=\"{frame}\">(1,0,0,0,0,1,0,0,0,0,1,0,{x},0,0,1)</Key>");
    let keyed = matrix(&(key(2, 0.0) + &key(6, 0.4) + &key(30, 0.6)));
    let found = layered(&[&keyed], &(square(0, 0.0) + &square(4, 8.0))).unwrap();
    assert_eq!(
        middles(&found.shapes[0]),
        [(10, 0.0, 0.0), (12, 4.0, 0.0), (14, 28.0, 0.0), (16, 48.0, 0.0), (20, 8.0 + 40.0 + 20.0 / 6.0, 0.0)]
            .map(|(f, x, y): (_, f64, f64)| (f, (x * 1e6).round() / 1e6, y))
    );
}

#[test]
fn a_shape_of_another_kind_keeps_no_other_one_out() {
    let points = ["(0,0)", "(0.1,0)", "(0,0.1)"];
    let shape = |label: &str, path: &str| file(&format!("label=\"{label}\""), path);
    let good = shape("good", &key(0, "Bezier", &points));
    let object = |text: &str| text[text.find("<Object").unwrap()..text.rfind("</Object>").unwrap() + 9].to_owned();
    for (kind, points, said) in [
        ("Xspline", &points[..], "<Path>: type: found \"Xspline\", expected \"Bezier\" or \"Bspline\""),
        ("Circle", &points, "<Path>: type: found \"Circle\""),
        ("Bezier", &["(NaN,0)"], "<Point>: found \"(NaN,0)\", expected (x,y)"),
    ] {
        let bad = object(&shape("x", &key(0, kind, points)));
        let found = silhouette(&good.replace("</Object>", &format!("</Object>{bad}")), &FOOTAGE()).unwrap();
        assert_eq!((found.shapes.len(), found.shapes[0].name.as_str()), (1, "good"));
        let told = format!("the shape \"x\" is left out: {said}");
        assert!(found.warnings.len() == 1 && found.warnings[0].contains(&told), "{:?}", found.warnings);
    }
}

#[test]
fn what_cannot_be_placed_is_left_out_and_told() {
    let horizon = matrix("<Value>(1,0,0,-9,0,1,0,0,0,0,1,0,0,0,0,1)</Value>");
    for (layer, said) in [
        (matrix("<Value>(1,0,0)</Value>"), "found \"(1,0,0)\", expected 16 numbers"),
        (horizon, "on frame 10 a perspective puts it beyond its horizon"),
    ] {
        let found = layered(&[&layer], &square(0, 30.0)).unwrap();
        assert!(found.shapes.is_empty() && found.warnings.len() == 1);
        assert!(
            found.warnings[0].contains("the shape \"a\" is left out: ") && found.warnings[0].contains(said),
            "{found:?}"
        );
    }
}

#[test]
fn pixels_may_be_wide() {
    let text = file("", &square(0, 30.0));
    let of = |aspect: &str| text.replace("<Silhouette ", &format!("<Silhouette pixelAspect=\"{aspect}\" "));
    let found = silhouette(&of("2"), &FOOTAGE()).unwrap();
    assert_eq!(middles(&found.shapes[0]), [(10, 15.0, 0.0)]);
    let points = &found.shapes[0].keys[&10];
    assert_eq!([points[1].x - points[0].x, points[2].y - points[1].y].map(f64::round), [10.0, 20.0]);
    for wrong in ["0", "-1", "1e9"] {
        let error = silhouette(&of(wrong), &FOOTAGE()).unwrap_err().to_string();
        assert!(
            error.contains("<Silhouette>: pixelAspect: found") && error.contains("expected 0.01 to 100"),
            "{error}"
        );
    }
}

#[test]
fn held_keys_end_before_the_next_one() {
    let held = |frame, x| square(frame, x).replace("<Key ", "<Key interp=\"hold\" ");
    let found = silhouette(&file("", &(held(0, 0.0) + &held(1, 5.0) + &square(4, 8.0) + &square(6, 0.0))), &FOOTAGE());
    let x = [(10, 0.0), (11, 5.0), (13, 5.0), (14, 8.0), (16, 0.0)].map(|(frame, x)| (frame, x, 0.0));
    assert_eq!(middles(&found.unwrap().shapes[0]), x);
}

#[test]
fn keys_beyond_the_footage_give_the_form_on_its_ends() {
    let found =
        silhouette(&file("label=\"a\"", &(square(-10, 0.0) + &square(4, 14.0) + &square(20, 30.0))), &FOOTAGE());
    let found = found.unwrap();
    assert_eq!(middles(&found.shapes[0]), [(10, 10.0, 0.0), (14, 14.0, 0.0), (20, 20.0, 0.0)]);
    assert_eq!(found.warnings.len(), 1);
    assert!(
        found.warnings[0]
            .contains("the shape \"a\" has 2 keys on frames 0 to 30, beyond the footage's frames 10 to 20")
    );
    let held = |frame, x| square(frame, x).replace("<Key ", "<Key interp=\"hold\" ");
    let found = silhouette(&file("", &(held(-10, 3.0) + &held(30, 9.0))), &FOOTAGE()).unwrap();
    assert_eq!(middles(&found.shapes[0]), [(10, 3.0, 0.0), (20, 3.0, 0.0)]);
}

#[test]
fn hidden_inverted_and_subtracting_shapes_are_told() {
    let set =
        |id: &str, value: &str| format!("<Property constant=\"True\" id=\"{id}\"><Value>{value}</Value></Property>");
    let told = |layer: &str, shape: &str| {
        let shape = square(0, 0.0) + "</Property>" + shape + "<Property id=\"other\">";
        layered(&[layer], &shape).unwrap().warnings
    };
    assert_eq!(told(&set("invert", "false"), &(set("mode", "Add") + &set("invert", "False"))), [""; 0]);
    let inverted = told("", &set("invert", "true"));
    assert!(
        inverted[0].contains("the shape \"a\" or its layer is inverted; it comes in as it is drawn"),
        "{inverted:?}"
    );
    let both = told("", &(set("invert", "true") + &set("mode", "Subtract")));
    assert!(both[0].contains("is inverted and has the mode \"Subtract\""), "{both:?}");
    assert!(told(&set("mode", "Inside"), "")[0].contains("has the mode \"Inside\""));
    let text = file("", &square(0, 0.0));
    let shown = text
        .replace("<Object", "<Object type=\"Layer\" hidden=\"False\"><Object")
        .replace("</Object>", "</Object></Object>");
    assert_eq!(silhouette(&shown, &FOOTAGE()).unwrap().warnings, [""; 0]);
    let hidden = silhouette(&shown.replace("\"False\"", "\"True\""), &FOOTAGE()).unwrap_err().to_string();
    assert!(hidden.contains("found no shape"), "{hidden}");
}

#[test]
fn flags_may_be_numbers() {
    let points = ["(0,0)", "(0.2,0)", "(0.2,0.2)"];
    let read = |attributes: &str, closed: &str| {
        let key = key(3, "Bezier", &points).replace("closed=\"True\"", &format!("closed=\"{closed}\""));
        silhouette(&file(attributes, &key), &FOOTAGE()).unwrap()
    };
    for (closed, wanted) in [("1", true), ("true", true), ("0", false), ("False", false)] {
        assert_eq!(read("label=\"a\"", closed).shapes[0].closed, wanted, "{closed}");
    }
    let hidden = silhouette(&file("label=\"a\" hidden=\"1\"", &key(3, "Bezier", &points)), &FOOTAGE());
    assert!(hidden.is_err() || hidden.is_ok_and(|found| found.shapes.is_empty()));
}
