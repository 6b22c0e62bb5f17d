use super::*;
use rototoon_base::geometry::polygon;

fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 5, last: 8, fps: 10.0, width: 200, height: 100, held: false }
}

fn read(content: &str) -> Result<Shapes, ImportError> {
    svg(&format!("<svg viewBox=\"10 0 100 50\">{content}</svg>"), &footage(), 6)
}

#[test]
fn painted_regions_and_strokes_of_an_export_are_counted_and_left_out() {
    use crate::export::{SvgFill, SvgOptions, SvgStroke, svg_with_drawn};
    let footage = Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.0, width: 40, height: 30, held: false };
    let corners = |n: usize| -> Vec<Point> { (0..n).map(|k| Point::new(k as f64, (k * k) as f64)).collect() };
    let part = rototoon_base::scene::Part {
        name: "arm".into(),
        closed: true,
        keys: [(0, corners(3))].into(),
        ..Default::default()
    };
    // The outline of a region has another number of points on every frame.
    let outlines = (0..4).map(|frame| (frame, vec![corners(4 + frame as usize)])).collect();
    let fill = SvgFill { track: 5, name: None, outlines, colour: [1.0, 0.0, 0.0] };
    // The title of a region is the name of its colour.
    let fills = [SvgFill { track: 6, name: Some("coat & \u{1}hat".into()), ..fill.clone() }, fill];
    let stroke = |name: &str| SvgStroke { name: name.into(), points: [(1, corners(2))].into(), ..SvgStroke::default() };
    let strokes = [stroke("stroke 7"), stroke("frame -3 stroke 2")];
    let scene = rototoon_base::scene::Scene { footage: footage.clone(), parts: vec![part] };
    let text = svg_with_drawn(&scene, &fills, &strokes, &SvgOptions::default());
    let found = svg(&text, &footage, 0).unwrap();
    assert_eq!(found.shapes.iter().map(|shape| shape.name.as_str()).collect::<Vec<_>>(), ["arm"]);
    let told = "painted regions (2) and strokes (2) that Rototoon has written are left out: they are no parts";
    assert_eq!(found.warnings, [told]);
    // Without a part the strokes are what there is to import.
    let bare = rototoon_base::scene::Scene { parts: Vec::new(), ..scene };
    let found = svg(&svg_with_drawn(&bare, &fills, &strokes, &SvgOptions::default()), &footage, 0).unwrap();
    assert_eq!(found.shapes.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["stroke 7", "frame -3 stroke 2"]);
    assert!(found.warnings[0].starts_with("painted regions (2) that"), "{:?}", found.warnings);
    let text = svg_with_drawn(&bare, &fills, &[], &SvgOptions::default());
    assert!(svg(&text, &footage, 0).unwrap_err().to_string().contains("painted regions that Rototoon has written"));
    // A part of such a name is a part.
    let own = "<svg><path id='a' d='M0 0L9 9'><title>stroke 7</title></path></svg>";
    assert_eq!(svg(own, &footage, 0).unwrap().shapes[0].name, "stroke 7");
}

#[test]
fn every_basic_shape_has_its_outline() {
    let found = read(
        "<!-- far --><rect id=\"r\" x=\"10\" width=\"20\" height=\"10\"/><g transform=\"translate(10 5) scale(2)\">
        <circle r=\"4\"><title>disc</title></circle><ellipse cx=\"3\" rx=\"2\" ry=\"1\"/></g>
        <rect x=\"20\" y=\"20\" width=\"20\" height=\"10\" rx=\"2\"/><line x2=\"10\"/><polyline points=\"10,0 20,0 20,5\"/>
        <polygon points=\"10,0 20,0 20,5\"/><path id=\"r\" d=\"M10 0q10 0 10 10M30 0h10v10z\"/><defs><rect width=\"1\" height=\"1\"/></defs>",
    )
    .unwrap();
    let area = |index: usize| polygon::signed_area(&found.shapes[index].keys[&6]).abs();
    let names: Vec<_> = found.shapes.iter().map(|shape| (shape.name.as_str(), shape.closed)).collect();
    let expected =
        [("r", true), ("disc", true), ("shape", true), ("shape 2", true), ("shape 3", false), ("shape 4", true)];
    assert_eq!(names[..6], expected);
    assert_eq!(names[6..], [("shape 5", true), ("r 2", false), ("r 3", true)], "a path of one segment has no area");
    assert_eq!(
        found.shapes[0].keys[&6],
        [(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)].map(|(x, y)| Point::new(x, y))
    );
    let round = std::f64::consts::PI;
    assert!((area(1) - round * 256.0).abs() < 8.0 && (area(2) - round * 32.0).abs() < 3.0);
    assert!((area(3) - (800.0 - 16.0 * (4.0 - round))).abs() < 2.0, "{}", area(3));
    assert_eq!(area(8), 200.0);
}

#[test]
fn what_has_no_outline_is_told_and_left_out() {
    let found = read("<path d=\"M0 0h5\"/>\n<text>a</text><g display=\"none\"><path d=\"M0 0h5\"/></g>").unwrap();
    assert_eq!(found.shapes.len(), 1);
    let told = [
        "line 2, column 1: <text> has no outline here and is left out",
        "line 2, column 15: the hidden <g> \"\" is left out (display: none)",
    ];
    assert_eq!(found.warnings, told);
}

#[test]
fn what_is_hidden_is_told_and_left_out() {
    let shown = "<path id='shown' d='M0 0h5v5'/>";
    for (hidden, said) in [
        ("<path id='a' visibility='hidden' d='M0 0h5'/>", "the hidden <path> \"a\" is left out (visibility: hidden)"),
        ("<g id='a' opacity='0'><path d='M0 0h5'/></g>", "the hidden <g> \"a\" is left out (opacity: 0)"),
        (
            "<style>.h{display:none}</style><path id='a' class='h' d='M0 0h5'/>",
            "<path> \"a\" is left out (display: none)",
        ),
        (
            "<g visibility='hidden'><rect id='a' width='5' height='5'/></g>",
            "<rect> \"a\" is left out (visibility: hidden)",
        ),
    ] {
        let found = read(&(hidden.to_owned() + shown)).unwrap();
        assert_eq!((found.shapes.len(), found.shapes[0].name.as_str()), (1, "shown"));
        assert!(found.warnings.len() == 1 && found.warnings[0].contains(said), "{:?}", found.warnings);
    }
    let moves = "<path id='a' d='M0 0h5v5'><animateTransform attributeName='transform' type='translate' values='0 0;9 9' dur='1s'/></path>";
    let found = read(moves).unwrap();
    assert!(found.shapes.len() == 1 && found.warnings[0].contains("\"a\" moves by an animated transformation"));
}

#[test]
fn a_fill_closes_a_path() {
    let closed = |path: &str| read(path).unwrap().shapes[0].closed;
    assert!(closed("<path fill='#f00' d='M0 0h5v5'/>") && closed("<path d='M0 0h5v5'/>"));
    assert!(!closed("<path fill='none' d='M0 0h5v5'/>") && !closed("<g style='fill:none'><path d='M0 0h5v5'/></g>"));
    let found = read("<path d='M0 0h5v5'/>").unwrap();
    assert_eq!(found.shapes[0].keys[&6].len(), 3);
}

#[test]
fn nested_documents_and_css_have_their_places() {
    let start = |content: &str| read(content).unwrap().shapes[0].keys[&6][0] * 0.5 + Point::new(10.0, 0.0);
    let nested = |more: &str| format!("<svg x='30' y='10' width='40' height='20' {more}><path d='M2 3h5v5'/></svg>");
    assert_eq!(start(&nested("")), Point::new(32.0, 13.0));
    assert_eq!(start(&nested("viewBox='0 0 80 40'")), Point::new(31.0, 11.5));
    assert_eq!(start(&nested("viewBox='1 0 20 20'")), Point::new(30.0 + 10.0 + 1.0, 13.0));
    assert_eq!(start(&nested("viewBox='0 0 20 20' preserveAspectRatio='none'")), Point::new(34.0, 13.0));
    assert_eq!(
        start(&nested("viewBox='0 0 20 20' preserveAspectRatio='xMinYMax slice'")),
        Point::new(34.0, 10.0 - 20.0 + 6.0)
    );
    let all = "<svg viewBox='0 0 50 25'><path d='M2 3h5v5'/></svg>";
    assert_eq!(start(all), Point::new(4.0, 6.0), "as large as what is around it");
    assert_eq!(start("<path style='transform:translate(20px,4px)' d='M2 3h5v5'/>"), Point::new(22.0, 7.0));
}

#[test]
fn errors_name_the_element_and_what_was_expected() {
    for (content, place, message) in [
        ("\n <path d=\"M0 0 L5\"/>", "line 2, column 2: <path>: d: found", "expected path data"),
        ("<circle r=\"-1\"/>", "<circle>", "r: found \"-1\", expected a length from 0"),
        ("<circle/>", "<circle>", "r: found nothing, expected a length from 0"),
        ("<path d=\"M0 0A5 1e40 0 0 1 9 9\"/>", "<path>", "d: found 1e40, expected numbers from -1e7 to 1e7"),
        ("<path d=\"M0 0a5e62 5 0 0 1 9 9\"/>", "<path>", "d: found 5e62, expected numbers"),
        ("<path d=\"M0 0h9999999h9999999\"/>", "<path>", "found a point at (1.33"),
        ("<g transform=\"scale(1e300)\"><path d=\"M1 1h1\"/></g>", "<path>", "found a point at ("),
        ("<circle r=\"1e30\"/>", "<circle>", "d: found 1e30, expected numbers"),
        ("<rect width=\"a\" height=\"1\"/>", "<rect>", "width: found \"a\", expected a number"),
        ("<polygon points=\"1 2 3\"/>", "<polygon>", "expected pairs of numbers"),
        ("<g transform=\"turn(3)\"><path d=\"M0 0h1\"/></g>", "<g>", "transform: found \"turn(3)\""),
        ("<g/>", "found no shape", "expected a path"),
        ("<g>", "found text that is not XML", ""),
    ] {
        let error = read(content).unwrap_err().to_string();
        assert!(error.contains(place) && error.contains(message), "{error}");
    }
    let wide = svg("<svg viewBox=\"0 0 100 100\"><path d=\"M0 0h1\"/></svg>", &footage(), 6).unwrap_err().to_string();
    assert!(wide.contains("found a picture of 100x100, expected the footage's proportions, 200x100"), "{wide}");
}

#[test]
fn what_cannot_be_read_is_left_out_and_the_others_come_in() {
    let good = "<path id='good' d='M0 0h5v5'/>";
    for (bad, said) in [
        ("<circle id='c' r='-5'/>", "<circle> \"c\" is left out: r: found \"-5\", expected a length from 0"),
        ("<rect id='a' width='NaN' height='1'/>", "width: found \"NaN\", expected a number, a length"),
        ("<rect width='2em' height='1'/>", "<rect> \"\" is left out: width: found \"2em\""),
        ("<path id='a' d='M0 0 Lx'/>", "<path> \"a\" is left out: d: found"),
        ("<path d='M0 0h1e30'/>", "d: found 1e30, expected numbers"),
        ("<polygon id='p' points='1 2 3'/>", "<polygon> \"p\" is left out: points: found \"1 2 3\""),
        ("<g id='g' transform='turn(3)'><path d='M0 0h1'/></g>", "<g> \"g\" is left out: transform: found"),
        ("<svg id='s' width='0'><path d='M0 0h1'/></svg>", "<svg> \"s\" is left out: width: found \"0\""),
        (
            "<path id='m' d='M0 0h1'><animate attributeName='d' dur='0.2s' values='M0 0h1;M0 0h1v1'/></path>",
            "<path> \"m\" is left out: found paths of several kinds",
        ),
        // The value at the very end is one frame after the footage, and no key.
        (
            "<path id='e' d='M0 0h1v1z'><animate attributeName='d' dur='0.375s' values='M0 0h1v1z;M3 3h2v1l-5 3z'/></path>",
            "<path> \"e\" is left out: found paths of several kinds, expected the commands of frame",
        ),
    ] {
        let found = read(&(bad.to_owned() + good)).unwrap();
        assert_eq!((found.shapes.len(), found.shapes[0].name.as_str()), (1, "good"), "{bad}");
        assert!(found.warnings.len() == 1 && found.warnings[0].contains(said), "{:?}", found.warnings);
    }
}

#[test]
fn lengths_have_units_and_shares_of_the_view() {
    let corner = |content: &str| read(content).unwrap().shapes[0].keys[&6][2];
    // The view is 100 × 50 and half as large as the footage.
    let from = |x: f64, y: f64| Point::new(2.0 * (x - 10.0), 2.0 * y);
    assert_eq!(corner("<rect width='100%' height='100%' fill='white'/>"), from(100.0, 50.0));
    assert_eq!(corner("<rect x='25%' y='10%' width='72pt' height='3px'/>"), from(25.0 + 96.0, 8.0));
    assert_eq!(corner("<rect style='x:2px;width:1in' y='1' width='5' height='4'/>"), from(98.0, 5.0));
    let inner = "<svg x='10%' y='10%' width='50%' height='50%'><rect width='100%' height='50%'/></svg>";
    assert_eq!(corner(inner), from(10.0 + 50.0, 5.0 + 12.5));
    let line = read("<line x1='10%' y1='0' x2='50%' y2='50%'/>").unwrap();
    assert_eq!(line.shapes[0].keys[&6], [from(10.0, 0.0), from(50.0, 25.0)]);
    let first = |content: &str| read(content).unwrap().shapes[0].keys[&6][0];
    assert_eq!(first("<ellipse cx='50%' cy='50%' rx='10%'/>"), from(60.0, 25.0));
    let radius = first("<circle cx='50' cy='25' r='20%'/>").x - from(50.0, 0.0).x;
    assert!((radius - 2.0 * 0.2 * (0.5f64 * (100.0 * 100.0 + 50.0 * 50.0)).sqrt()).abs() < 1e-9);
    // Without a view box the document is as large as it says.
    let found = svg("<svg width='150pt' height='75pt'><path d='M50 50h5v5'/></svg>", &footage(), 6).unwrap();
    assert_eq!(found.shapes[0].keys[&6][0], Point::new(50.0, 50.0));
}

#[test]
fn shapes_stand_about_their_origins_and_rules_hide_them() {
    let corners = |content: &str| {
        let text = format!("<svg width='200' height='100'>{content}</svg>");
        let found = svg(&text, &footage(), 6).unwrap();
        found.shapes.iter().map(|shape| (shape.name.clone(), shape.keys[&6][0])).collect::<Vec<_>>()
    };
    let one = |name: &str, x: f64, y: f64| vec![(name.to_owned(), Point::new(x, y))];
    let turned = "<path id='a' d='M100 100H200V300H100Z' transform='rotate(180)' transform-origin='150 200'/>";
    assert_eq!(corners(turned), one("a", 200.0, 300.0));
    let sheet = "<style>g.ref path{display:none}</style><g class='ref'><path id='r' d='M0 0h9v9'/></g>";
    assert_eq!(corners(&format!("{sheet}<path id='good' d='M1 2h9v9'/>")), one("good", 1.0, 2.0));
    let told = "<style>a + b{display:none}</style><path d='M0 0h9' style='rotate:3deg'/>";
    let text = format!("<svg width='200' height='100' transform='scale(2)'>{told}</svg>");
    let warnings = svg(&text, &footage(), 6).unwrap().warnings.join("; ");
    for said in ["of the style sheet: \"a + b\"", "is moved by `rotate` of its style", "of the whole document is not"] {
        assert!(warnings.contains(said), "{warnings}");
    }
}

#[test]
fn holes_clips_and_masks_are_told_once_for_each_with_the_names() {
    let text = "<svg viewBox='0 0 200 100'><defs><clipPath id='eye'><circle r='9'/></clipPath><clipPath id='all'><rect width='200' height='100'/></clipPath>\
        <mask id='m'/></defs>\n<path id='ring' fill-rule='evenodd' d='M10 10h40v40h-40z M20 20h20v20h-20z'/>\
        <g style='clip-path:url(#eye)'><path id='pupil' d='M0 0h5v5z'/><g mask='url(#m)'><path id='both' d='M0 0h5v5z'/></g></g>\
        <path id='frame' d='M60 10h40v40h-40z M70 20v20h20v-20z M75 25h5v5h-5z'/>\
        <g clip-path='url(\"#all\")'><path id='whole' d='M-50 0h900v50z'/></g><path id='none' clip-path='url(#gone)' d='M0 0h5v5z'/>\
        <path id='lines' fill='none' d='M10 10h40v40h-40z M20 20h20v20h-20z'/></svg>";
    let found = svg(text, &footage(), 6).unwrap();
    let names: Vec<&str> = found.shapes.iter().map(|shape| shape.name.as_str()).collect();
    assert_eq!(names, ["ring", "pupil", "both", "frame", "frame 2", "whole", "none", "lines", "lines 2"]);
    assert_eq!(found.shapes[4].keys[&6][0], Point::new(75.0, 25.0), "an island in a hole is a part");
    let told: Vec<&str> = found.warnings.iter().map(|line| line.split_once(": ").unwrap().1).collect();
    assert_eq!(
        told,
        [
            "holes are left out, since a part has none and covers what shows through them: \"ring\", \"frame\"",
            "clipping paths are not read, so these shapes come in whole: \"pupil\", \"both\"",
            "masks are not read, so these shapes come in whole: \"both\"",
        ]
    );
    assert!(found.warnings[0].starts_with("line 2, column 1: "), "{:?}", found.warnings);
}

#[test]
fn a_clip_is_told_where_it_hides_something() {
    let told = |clip: &str, rest: &str| {
        let text = format!("<svg viewBox='0 0 200 100'><clipPath id='c' {clip}</clipPath>{rest}</svg>");
        !svg(&text, &footage(), 6).unwrap().warnings.is_empty()
    };
    let path = "<path clip-path='url(#c)' d='M10 10h30v30z'/>";
    assert!(
        !told("><rect x='10' y='10' width='30' height='30'/>", path)
            && told("><rect x='10.2' y='10' width='30' height='30'/>", path)
    );
    assert!(!told("><rect width='50%' height='50%'/>", path) && told("><rect width='15%' height='50%'/>", path));
    for other in [
        "clipPathUnits='objectBoundingBox'><rect width='200' height='100'/>",
        "><rect width='200' height='100' rx='3'/>",
        "><rect width='200' height='100' transform='scale(.1)'/>",
        "><rect width='200' height='100'/><rect width='1' height='1'/>",
        "><path d='M0 0H200V100H0Z'/>",
        ">",
    ] {
        assert!(told(other, path), "{other}");
    }
    // The rectangle is in the units of what it clips.
    let turned = |angle: u32| {
        format!("<g transform='translate(100 0) rotate({angle})' clip-path='url(#c)'><path d='M0 0h30v30z'/></g>")
    };
    assert!(!told("><rect width='100' height='100'/>", &turned(90)));
    assert!(
        told("><rect width='20' height='100'/>", &turned(90))
            && !told("><rect width='100' height='20'/>", &turned(180))
    );
    assert!(told("><rect width='100' height='100'/>", "<path style='clip-path:circle(5px)' d='M0 0h5v5z'/>"));
}

#[test]
fn an_edit_of_a_film_of_rototoon_is_the_form_on_its_first_frame() {
    use crate::export::{SvgOptions, svg as written};
    let at = |x: f64| vec![Point::new(x, 0.0), Point::new(x + 8.0, 0.0), Point::new(x, 8.0)];
    let part = rototoon_base::scene::Part {
        name: "arm".into(),
        closed: true,
        keys: [(6, at(1.0)), (8, at(3.0))].into(),
        tracks: [(6, at(1.0)), (7, at(2.0)), (8, at(3.0))].into(),
        ..Default::default()
    };
    let scene = rototoon_base::scene::Scene { footage: footage(), parts: vec![part] };
    let text = written(&scene, &SvgOptions::default());
    let plain = svg(&text, &footage(), 5).unwrap();
    let edited = |d: &str| svg(&text.replacen("d=\"M1 0L9 0 1 8Z\"", &format!("d=\"{d}\""), 1), &footage(), 5).unwrap();
    // Another program writes the same form in other words.
    assert_eq!(edited("m1.001 0h8L1 8z"), plain);
    let found = edited("M1 -2L9 0 1 8Z");
    let mut expected = plain.clone();
    expected.shapes[0].keys.get_mut(&6).unwrap()[0].y = -2.0;
    assert_eq!(found, expected);
    for other in ["M1 0L9 0 5 5 1 8Z", "M1 0C4 9 6 9 9 0L1 8Z", "M1 0L9 0 1 8ZM1 1L2 2 3 1Z", "nothing"] {
        let found = edited(other);
        assert_eq!(found.shapes, plain.shapes, "{other}");
        let told = "the edit of \"arm\" on frame 6 is left out: it has other points";
        assert!(found.warnings.len() == 1 && found.warnings[0].contains(told), "{:?}", found.warnings);
    }
    // In the film of another program the animation counts.
    let foreign = text.replace("data-first", "first").replacen("d=\"M1 0L", "d=\"M1 -2L", 1);
    assert_eq!(svg(&foreign, &footage(), 5).unwrap().shapes[0].keys[&6], at(1.0));
}

#[test]
fn numbers_of_points_need_no_blanks_between_them() {
    let found = |points: &str| read(&format!("<polygon points='{points}'/>")).unwrap().shapes.remove(0).keys;
    let wanted = found("10 -20 30 -40 50 -60");
    for points in ["10-20 30-40 50-60", "10-20,30-40,50-60", "1e1-2e1,30-40 5e+1-60"] {
        assert_eq!(found(points), wanted, "{points}");
    }
    assert_eq!(found("10.5.5 30 40 50 60"), found("10.5 0.5 30 40 50 60"));
    assert!(read("<polygon points='10-20-30'/>").is_err() && read("<polygon points='1 2 3 4 x'/>").is_err());
}
