use super::*;
use rototoon_base::scene::{Footage, Part};

fn scene() -> Scene {
    let at = |x: f64| vec![Point::new(x, 0.0), Point::new(x + 8.0, 0.0), Point::new(x, 8.0)];
    let part = Part {
        name: "a < \"b\" & \u{1}c".into(),
        closed: true,
        keys: BTreeMap::from([(1, at(0.0)), (3, at(2.0))]),
        tracks: BTreeMap::from([(1, at(0.0)), (2, at(0.0)), (3, at(2.0))]),
        ..Part::default()
    };
    let footage = Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
    Scene { footage, parts: vec![part] }
}

fn attribute<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    text.split(&format!(" {name}=\"")).skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

#[test]
fn a_part_is_one_path_over_the_footage() {
    let text = svg(&scene(), &SvgOptions::default());
    assert_eq!(attribute(&text, "viewBox"), ["0 0 40 30"]);
    assert!(text.contains("<title>a &lt; &quot;b&quot; &amp; c</title>"));
    assert_eq!(attribute(&text, "dur"), ["0.32s", "0.32s"]);
    assert_eq!(attribute(&text, "values"), ["M0 0L8 0 0 8Z;M2 0L10 0 2 8Z", "hidden;visible"]);
    assert_eq!(attribute(&text, "keyTimes"), ["0;0.742187", "0;0.242187"]);
    assert_eq!(attribute(&text, "visibility"), ["hidden"], "on the first frame, for readers without animation");
}

#[test]
fn even_motion_ends_at_one_with_the_last_frame() {
    let text = svg(&scene(), &SvgOptions { motion: Motion::Linear, ..SvgOptions::default() });
    assert_eq!(attribute(&text, "keyTimes")[0], "0;0.25;0.5;0.75;1");
    let values: Vec<_> = attribute(&text, "values")[0].split(';').collect();
    assert_eq!(values.len(), 5);
    assert_eq!(values[3], values[4]);
}

#[test]
fn snapped_paths_have_the_same_number_of_points_on_each_frame() {
    let mut scene = scene();
    let bent = |y: f64| {
        let p = |x: f64, y: f64| Point::new(x, y);
        vec![vec![p(0.0, 0.0), p(4.0, y), p(8.0, 0.0)], vec![p(8.0, 0.0), p(0.0, 8.0)], vec![p(0.0, 8.0), p(0.0, 0.0)]]
    };
    scene.parts[0].curves = BTreeMap::from([(1, bent(0.0)), (2, bent(-30.0))]);
    let text = svg(&scene, &SvgOptions::default());
    let lengths: Vec<_> =
        attribute(&text, "values")[0].split(';').map(|value| value.split([' ', 'L']).count()).collect();
    assert_eq!(lengths.len(), 3, "{text}");
    assert!(lengths[0] > 60 && lengths.iter().all(|length| *length == lengths[0]), "{lengths:?}");
}

#[test]
fn a_stroke_is_a_path_that_is_hidden_where_it_is_not() {
    let at = |x: f64, count: usize| (0..count).map(|k| Point::new(x + k as f64, 5.0)).collect::<Vec<_>>();
    let points = BTreeMap::from([(1, at(0.0, 2)), (2, at(3.0, 4))]);
    let red = SvgStroke {
        name: "stroke 7".into(),
        points,
        closed: false,
        width: 2.5,
        colour: [1.0, 0.0, 0.0],
        ..SvgStroke::default()
    };
    let stroke = SvgStroke { lined: true, ..red.clone() };
    let bare = Scene { parts: Vec::new(), ..scene() };
    let text = svg_with_drawn(&bare, &[], std::slice::from_ref(&stroke), &SvgOptions::default());
    assert!(text.contains("id=\"stroke-7\" fill=\"none\" stroke=\"#ff0000\" stroke-width=\"2.5\""), "{text}");
    let black = SvgStroke { closed: true, colour: [0.0; 3], fill: true, ..red };
    let filled = svg_with_drawn(&bare, &[], &[black], &SvgOptions::default());
    assert!(filled.contains("id=\"stroke-7\" fill=\"#000000\" stroke=\"none\" visibility=\"hidden\" d="), "{filled}");
    let faint = SvgStroke { opacities: BTreeMap::from([(2, 0.25)]), ..stroke.clone() };
    let faint = svg_with_drawn(&bare, &[], &[faint], &SvgOptions::default());
    assert!(faint.contains("attributeName=\"opacity\"") && faint.contains("values=\"1;0.25;1\""), "{faint}");
    assert!(!text.contains("attributeName=\"opacity\"") && !faint.contains(" opacity=\"0.25\""));
    let first = scene().footage.first;
    let faint = SvgStroke {
        points: BTreeMap::from([(first, at(0.0, 2))]),
        opacities: BTreeMap::from([(first, 0.25)]),
        ..stroke.clone()
    };
    let faint = svg_with_drawn(&bare, &[], &[faint], &SvgOptions::default());
    assert!(faint.contains(" opacity=\"0.25\" d="), "readers without animation show the first frame: {faint}");
    let wide = SvgStroke { widths: BTreeMap::from([(2, 4.0)]), ..stroke.clone() };
    let wide = svg_with_drawn(&bare, &[], &[wide], &SvgOptions::default());
    assert!(wide.contains("attributeName=\"stroke-width\"") && wide.contains("values=\"2.5;4\""), "{wide}");
    assert!(!text.contains("attributeName=\"stroke-width\""));
    let (blue, green) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let fills = BTreeMap::from([(1, blue), (2, blue)]);
    let both = SvgStroke { closed: true, fills, ..stroke.clone() };
    let plain = svg_with_drawn(&bare, &[], std::slice::from_ref(&both), &SvgOptions::default());
    assert!(plain.contains("id=\"stroke-7\" fill=\"#0000ff\" stroke=\"#ff0000\" stroke-width=\"2.5\""), "{plain}");
    assert!(!plain.contains("attributeName=\"fill\"") && !plain.contains("attributeName=\"stroke\""));
    let (colours, fills) = (BTreeMap::from([(2, blue)]), BTreeMap::from([(1, blue), (2, green)]));
    let changing = svg_with_drawn(&bare, &[], &[SvgStroke { colours, fills, ..both.clone() }], &SvgOptions::default());
    let animated = |attribute: &str| {
        let rest = changing.split(&format!("attributeName=\"{attribute}\"")).nth(1).unwrap();
        self::attribute(rest, "values")[0].to_owned()
    };
    assert_eq!([animated("stroke"), animated("fill")], ["#ff0000;#0000ff", "#0000ff;#00ff00"]);
    let late = SvgStroke { fills: BTreeMap::from([(2, green)]), ..both };
    let late = svg_with_drawn(&bare, &[], &[late], &SvgOptions::default());
    assert!(late.contains("fill=\"none\"") && late.contains("values=\"none;#00ff00\""), "{late}");
    assert_eq!(attribute(&text, "visibility"), ["hidden"], "on the first frame");
    let values = attribute(&text, "values");
    assert_eq!(values[1], "hidden;visible;hidden");
    let counts: Vec<usize> = values[0].split(';').map(|d| d.split([' ', 'L']).count()).collect();
    assert!(counts.iter().all(|count| *count == counts[0]), "{values:?}");
}

#[test]
fn parts_without_contour_are_left_out() {
    let mut scene = scene();
    scene.parts[0].keys.clear();
    scene.parts[0].tracks.clear();
    assert!(!svg(&scene, &SvgOptions::default()).contains("<path"));
    scene.parts[0].keys.insert(0, Vec::new());
    assert!(!svg(&scene, &SvgOptions::default()).contains("<path"));
}

#[test]
fn painted_regions_have_holes_and_are_hidden_where_they_are_not() {
    let scene = scene();
    let square = |at: f64, size: f64| {
        [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| Point::new(at + x, at + y)).to_vec()
    };
    let outlines = BTreeMap::from([(scene.footage.first, vec![square(1.0, 9.0), square(3.0, 2.0)])]);
    let fill = SvgFill { track: 3, name: None, outlines, colour: [1.0, 0.0, 0.0] };
    let text = svg_with_drawn(&scene, std::slice::from_ref(&fill), &[], &SvgOptions::default());
    let expected = "<path id=\"fill-3\" fill=\"#ff0000\" fill-rule=\"evenodd\" stroke=\"none\" \
                    d=\"M1 1L10 1 10 10 1 10ZM3 3L5 3 5 5 3 5Z\">";
    assert!(text.contains(expected), "{text}");
    let named = SvgFill { name: Some("M & <W>".into()), ..fill.clone() };
    let told = svg_with_drawn(&scene, &[named], &[], &SvgOptions::default());
    let expected = "<path id=\"fill-3\" data-colour=\"M &amp; &lt;W&gt;\" fill=\"#ff0000\"";
    assert!(told.contains(expected) && told.contains("<title>M &amp; &lt;W&gt;</title>"), "{told}");
    let (region, rest) = (text.find("fill-3").unwrap(), text.find("part-0").unwrap());
    assert!(region < rest, "paint is behind the parts");
    assert!(text[region..rest].contains("visible;hidden"), "{text}");
}

#[test]
fn paint_contours_and_lines_are_layers_in_the_order_in_which_they_lie() {
    let square = vec![Point::new(1.0, 1.0), Point::new(9.0, 1.0), Point::new(9.0, 9.0)];
    let points = BTreeMap::from([(0, square.clone())]);
    let fill = |track| SvgFill { track, outlines: BTreeMap::from([(0, vec![square.clone()])]), ..SvgFill::default() };
    let line = SvgStroke { name: "stroke 3".into(), points, lined: true, width: 1.0, ..SvgStroke::default() };
    let text = svg_with_drawn(&scene(), &[fill(3), fill(4)], &[line], &SvgOptions::default());
    assert_eq!(attribute(&text, "id"), ["paint", "fill-3", "fill-4", "contours", "part-0", "lines", "stroke-3"]);
    let document = roxmltree::Document::parse(&text).unwrap();
    let layers: Vec<_> = document.root_element().children().filter(roxmltree::Node::is_element).collect();
    let inkscape = |name: &str| -> Vec<_> { layers.iter().filter_map(|own| own.attribute((INKSCAPE, name))).collect() };
    assert_eq!(inkscape("label"), ["Paint", "Contours", "Lines"]);
    assert_eq!(inkscape("groupmode"), ["layer"; 3]);
    assert!(layers.iter().all(|own| own.has_tag_name("g") && own.attribute("stroke-linejoin") == Some("round")));
    // A group with nothing in it is left out.
    let bare = Scene { parts: Vec::new(), ..scene() };
    let text = svg_with_drawn(&bare, &[fill(3)], &[], &SvgOptions::default());
    assert_eq!(attribute(&text, "id"), ["paint", "fill-3"]);
    assert_eq!(text.matches("<g ").count(), text.matches("</g>").count());
}

/// Decimal digits as a whole number of steps of 10^-12.
fn steps(text: &str) -> i128 {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    assert!(fraction.len() <= 12, "{text}");
    format!("{whole}{fraction:0<12}").parse().unwrap()
}

#[test]
fn a_picture_at_the_time_of_a_frame_shows_that_frame() {
    const ONE: i128 = 1_000_000_000_000;
    for (numerator, denominator) in [(24_000, 1001), (24, 1), (25, 1), (30_000, 1001), (12, 1), (25, 2), (60, 1)] {
        let fps = f64::from(numerator) / f64::from(denominator);
        for n in [2, 3, 7, 24, 29, 100, 999, 5000, 200_000] {
            let values: Vec<String> = (0..n).map(|k| k.to_string()).collect();
            let values: Vec<&str> = values.iter().map(String::as_str).collect();
            let mut text = String::new();
            animate(&mut text, "d", n as f64 / fps, Motion::Hold, &values);
            let length = steps(attribute(&text, "dur")[0].trim_end_matches('s'));
            let times: Vec<i128> = attribute(&text, "keyTimes")[0].split(';').map(steps).collect();
            assert_eq!((times.len(), times[0]), (n, 0));
            // All in units of 10^-24 ∕ numerator of a second: the frame begins at k · denominator ∕ numerator.
            let begins = |k: usize| k as i128 * i128::from(denominator) * ONE * ONE;
            let frame = begins(1);
            for (k, time) in times.iter().enumerate().skip(1) {
                let shown = time * length * i128::from(numerator);
                assert!(shown < begins(k) && shown > begins(k) - frame / 16, "{k} of {n} at {fps}");
                assert!(*time > times[k - 1]);
            }
            // Clocks of 64 and of 32 bits, of whole microseconds and milliseconds.
            let seconds = length as f64 / ONE as f64;
            for (k, time) in times.iter().enumerate() {
                let (at, time) = (k as f64 / fps, *time as f64 / ONE as f64);
                for clock in [at, (f64::from(at as f32) * 1e6).floor() / 1e6, (at * 1e3).round() / 1e3] {
                    // 32 bits count in steps of a tenth of a millisecond after half an hour.
                    assert!(n > 5000 || clock / seconds >= time, "{k} of {n} at {fps}: {clock}");
                }
            }
        }
    }
}

#[test]
fn a_stroke_keeps_its_corners_and_is_closed_by_frame() {
    let of = |points: &[(f64, f64)]| points.iter().copied().map(Point::from).collect::<Vec<_>>();
    let corner = of(&[(2.0, 2.0), (52.0, 2.0), (52.0, 20.0)]);
    assert_eq!(filled(&corner, false, 4), of(&[(2.0, 2.0), (27.0, 2.0), (52.0, 2.0), (52.0, 20.0)]));
    assert_eq!(filled(&corner, true, 4).len(), 4);
    assert_eq!(filled(&corner[..1], false, 2).len(), 2);
    let points = BTreeMap::from([(1, corner.clone()), (2, of(&[(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)]))]);
    let line = SvgStroke {
        name: "stroke 3".into(),
        points,
        turned: [2].into(),
        lined: true,
        width: 1.0,
        ..SvgStroke::default()
    };
    let footage = Footage { pattern: "%d".into(), first: 1, last: 2, fps: 10.0, width: 64, height: 48, held: false };
    let scene = Scene { footage, parts: Vec::new() };
    let text = svg_with_drawn(&scene, &[], std::slice::from_ref(&line), &SvgOptions::default());
    assert_eq!(attribute(&text, "values"), ["M2 2L27 2 52 2 52 20;M0 0L9 0 9 9 0 9Z"]);
    let one = Scene { footage: Footage { last: 1, ..scene.footage }, parts: Vec::new() };
    let text = svg_with_drawn(&one, &[], &[line], &SvgOptions::default());
    assert!(text.contains("d=\"M2 2L52 2 52 20\""), "a frame alone has its own points: {text}");
}
