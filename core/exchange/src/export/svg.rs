//! SVG with one animated path for each part.
//!
//! Each part is a `path` with a `title` and a SMIL animation of its `d` over the footage. The animation loops, and
//! browsers play it directly. SMIL can interpolate only paths with the same number of points, so every frame gets the
//! same number ([`super::outlines`]), and curves on all frames or on none. A part is hidden on frames without a contour; one that
//! has nothing but keys says so in an attribute, since an import would take it for absent between them. The root says which frames of the document it shows. Parts are drawn in the order of
//! depth, far ones first.

use super::knot::Knot;
use super::names::written;
use super::outlines::{Detail, Outlines};
use super::xml::{escaped, plain};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::resample;
use rototoon_base::scene::palette;
use rototoon_base::scene::{Colour, FrameNumber, Scene};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Motion of a path between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    /// Each frame is held until the next one.
    #[default]
    Hold,
    /// Points move linearly.
    Linear,
}

impl Motion {
    /// All motions with their ids.
    pub const ALL: [(Self, &str); 2] = [(Self::Hold, "hold"), (Self::Linear, "linear")];

    /// The motion with this id; `None` if there is none.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(motion, _)| *motion)
    }
}

/// Options of the export.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgOptions {
    /// Motion between frames.
    pub motion: Motion,
    /// Distance between points of snapped paths, in pixels; at least 0.25.
    pub spacing: f64,
    /// If parts follow snapped paths by Bézier curves instead: how far these may be from the paths, in pixels.
    pub bezier: Option<f64>,
}

impl SvgOptions {
    fn detail(&self) -> Detail {
        self.bezier.map_or(Detail::Spacing(self.spacing), Detail::Bezier)
    }
}

impl Default for SvgOptions {
    fn default() -> Self {
        Self { motion: Motion::Hold, spacing: 2.0, bezier: None }
    }
}

/// Width of strokes in pixels, at 540 lines.
const LINE_WIDTH: f64 = 2.0;
/// Opacity of fills, low enough to show what is behind a part.
const FILL_OPACITY: f64 = 0.35;

/// The attribute of a part that has nothing but keys. It is drawn on these frames only, but it is not hidden on others.
const KEYS_ONLY: &str = "data-keys=\"only\"";

/// A stroke on several frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SvgStroke {
    /// Its name, such as "stroke 7". The id of its path is the same with dashes.
    pub name: String,
    /// Its points on each frame, in pixels of the footage.
    pub points: BTreeMap<FrameNumber, Vec<Point>>,
    /// Its opacity, 0 to 1, on frames on which it is not 1.
    pub opacities: BTreeMap<FrameNumber, f64>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Its width in pixels.
    pub width: f64,
    /// Its width in pixels on frames on which it is another one.
    pub widths: BTreeMap<FrameNumber, f64>,
    /// Its colour, sRGB-encoded, 0 to 1.
    pub colour: Colour,
    /// Its colour on frames on which it is another one.
    pub colours: BTreeMap<FrameNumber, Colour>,
    /// The colour of the fill of a stroke that has a line too, on each frame on which it has one.
    pub fills: BTreeMap<FrameNumber, Colour>,
    /// Whether what is inside is filled with the colour.
    pub fill: bool,
    /// Whether there is a line along it.
    pub lined: bool,
}

/// A painted region on several frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SvgFill {
    /// Its number.
    pub track: usize,
    /// The name of its colour.
    pub name: Option<String>,
    /// Its outline and those of its holes on each frame, in pixels of the footage.
    pub outlines: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// Its colour, sRGB-encoded, 0 to 1.
    pub colour: Colour,
}

/// The scene as an SVG document, in pixels of the footage.
pub fn svg(scene: &Scene, options: &SvgOptions) -> String {
    svg_with_drawn(scene, &[], &[], options)
}

/// The scene, painted regions behind it and strokes over it as an SVG document, in pixels of the footage. Each region is
/// a path with the id `fill-` and its number, each stroke one with `stroke-` and its number. Regions change from frame to frame
/// without motion between, since their outlines have no counterparts.
pub fn svg_with_drawn(scene: &Scene, fills: &[SvgFill], strokes: &[SvgStroke], options: &SvgOptions) -> String {
    let footage = &scene.footage;
    let (width, height) = (footage.width, footage.height);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" data-first=\"{}\" data-last=\"{}\">\n",
        footage.first, footage.last
    );
    let line = LINE_WIDTH * (height as f64 / 540.0).max(0.5);
    let _ = writeln!(out, "<g stroke-width=\"{line}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">");
    for painted in fills {
        fill(&mut out, scene, painted);
    }
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.sort_by(|&a, &b| scene.parts[a].depth.total_cmp(&scene.parts[b].depth));
    let names = written(scene, plain);
    for index in order {
        part(&mut out, scene, (index, &names[index]), options);
    }
    for drawn in strokes {
        stroke(&mut out, scene, drawn, options);
    }
    out + "</g>\n</svg>\n"
}

fn part(out: &mut String, scene: &Scene, (index, name): (usize, &str), options: &SvgOptions) {
    let part = &scene.parts[index];
    let outlines = Outlines::new(part, options.detail());
    let shape = |frame: FrameNumber| {
        let knots = outlines.at(frame)?;
        if outlines.bent() {
            return Some(bent(&knots, part.closed));
        }
        Some(data(&knots.iter().map(|knot| knot.at).collect::<Vec<_>>(), part.closed))
    };
    let colour = palette::hex(part.shown_colour(index));
    let fill = if part.closed { colour.as_str() } else { "none" };
    let keys = if part.tracks.is_empty() && part.keys.len() > 1 { format!(" {KEYS_ONLY}") } else { String::new() };
    let style =
        format!("id=\"part-{index}\"{keys} fill=\"{fill}\" fill-opacity=\"{FILL_OPACITY}\" stroke=\"{colour}\"");
    path(out, scene, &style, (&escaped(name), &BTreeMap::new(), ""), options.motion, shape);
}

fn fill(out: &mut String, scene: &Scene, fill: &SvgFill) {
    let shape = |frame: FrameNumber| {
        let outlines = fill.outlines.get(&frame)?;
        Some(outlines.iter().map(|outline| data(outline, true)).collect::<String>())
    };
    let (track, colour) = (fill.track, palette::hex(fill.colour));
    let named = fill.name.as_ref().map_or_else(String::new, |name| format!("data-colour=\"{}\" ", escaped(name)));
    let style = format!("id=\"fill-{track}\" {named}fill=\"{colour}\" fill-rule=\"evenodd\" stroke=\"none\"");
    let name = fill.name.as_ref().map_or_else(|| format!("region {track}"), |name| escaped(name).to_string());
    path(out, scene, &style, (&name, &BTreeMap::new(), ""), Motion::Hold, shape);
}

fn stroke(out: &mut String, scene: &Scene, stroke: &SvgStroke, options: &SvgOptions) {
    // The same number of points on every frame, as for parts.
    let most = stroke.points.values().map(Vec::len).max().unwrap_or(0);
    let shape = |frame: FrameNumber| {
        let points = stroke.points.get(&frame).filter(|points| !points.is_empty())?;
        let even = if points.len() == most { points.clone() } else { resample(points, stroke.closed, most) };
        Some(data(&even, stroke.closed))
    };
    let (id, colour, width) = (stroke.name.replace(' ', "-"), palette::hex(stroke.colour), decimal(stroke.width, 2));
    let start = (scene.footage.first..=scene.footage.last).find(|frame| stroke.points.contains_key(frame));
    let fill = if stroke.fill { colour.clone() } else { start.map_or("none".into(), |frame| fill_on(stroke, frame)) };
    let line = match stroke.lined {
        true => format!("stroke=\"{colour}\" stroke-width=\"{width}\""),
        false => "stroke=\"none\"".into(),
    };
    let style = format!("id=\"{id}\" fill=\"{fill}\" {line}");
    let looks = looks(scene, stroke, options.motion);
    path(out, scene, &style, (&stroke.name, &stroke.opacities, &looks), options.motion, shape);
}

/// The animations of a stroke's width and colours; none of what is always the same.
fn looks(scene: &Scene, stroke: &SvgStroke, motion: Motion) -> String {
    let mut out = String::new();
    let mut changing = |attribute: &str, value: &dyn Fn(FrameNumber) -> String| {
        out += &changes(scene, stroke, motion, attribute, value);
    };
    let colour = |frame| palette::hex(*stroke.colours.get(&frame).unwrap_or(&stroke.colour));
    if stroke.lined {
        changing("stroke-width", &|frame| decimal(*stroke.widths.get(&frame).unwrap_or(&stroke.width), 2).to_string());
        changing("stroke", &colour);
    }
    if stroke.fill {
        changing("fill", &colour);
    } else {
        changing("fill", &|frame| fill_on(stroke, frame));
    }
    out
}

/// The fill under the line of a stroke.
fn fill_on(stroke: &SvgStroke, frame: FrameNumber) -> String {
    stroke.fills.get(&frame).map_or("none".into(), |colour| palette::hex(*colour))
}

/// The animation of an attribute of a stroke; none if it is always the same. Where the stroke is not, it is the one before, or the
/// first.
fn changes(
    scene: &Scene,
    stroke: &SvgStroke,
    motion: Motion,
    attribute: &str,
    value: &dyn Fn(FrameNumber) -> String,
) -> String {
    let on = |frame| stroke.points.contains_key(&frame).then(|| value(frame));
    let all: Vec<Option<String>> = (scene.footage.first..=scene.footage.last).map(on).collect();
    let mut out = String::new();
    if let Some(first) = all.iter().flatten().next()
        && all.iter().flatten().any(|value| value != first)
    {
        let seconds = all.len() as f64 / scene.footage.fps;
        animate(&mut out, attribute, seconds, motion, &nearest(&all, first));
    }
    out
}

/// A path with its title, its opacities other than 1, other animations, and its animation. `shape` gives its data on a frame.
fn path(
    out: &mut String,
    scene: &Scene,
    style: &str,
    (title, opacities, more): (&str, &BTreeMap<FrameNumber, f64>, &str),
    motion: Motion,
    shape: impl Fn(FrameNumber) -> Option<String>,
) {
    let shapes: Vec<Option<String>> = (scene.footage.first..=scene.footage.last).map(shape).collect();
    let Some(start) = shapes.iter().flatten().next().cloned() else { return };
    // Readers without animation show the first frame.
    let hidden = if shapes[0].is_none() { " visibility=\"hidden\"" } else { "" };
    let faint = opacities.get(&scene.footage.first).map(|opacity| format!(" opacity=\"{}\"", decimal(*opacity, 3)));
    let faint = faint.unwrap_or_default();
    let _ = writeln!(out, "<path {style}{hidden}{faint} d=\"{start}\">\n<title>{title}</title>");
    let seconds = shapes.len() as f64 / scene.footage.fps;
    let filled = nearest(&shapes, &start);
    animate(out, "d", seconds, motion, &filled);
    let visible: Vec<_> = shapes.iter().map(|shape| if shape.is_some() { "visible" } else { "hidden" }).collect();
    if visible.contains(&"hidden") {
        animate(out, "visibility", seconds, Motion::Hold, &visible);
    }
    if !opacities.is_empty() {
        let opacity = |frame| decimal(opacities.get(&frame).copied().unwrap_or(1.0), 3).to_string();
        let all: Vec<String> = (scene.footage.first..=scene.footage.last).map(opacity).collect();
        animate(out, "opacity", seconds, Motion::Hold, &all.iter().map(String::as_str).collect::<Vec<_>>());
    }
    *out += more;
    *out += "</path>\n";
}

/// Fills gaps with the previous shape; before the first shape with `first`.
fn nearest<'a>(shapes: &'a [Option<String>], first: &'a str) -> Vec<&'a str> {
    let mut last = first;
    shapes
        .iter()
        .map(|shape| {
            last = shape.as_deref().unwrap_or(last);
            last
        })
        .collect()
}

/// Writes one animation. Held values are written only where they change; a single frame is a picture that stands still.
fn animate(out: &mut String, attribute: &str, seconds: f64, motion: Motion, values: &[&str]) {
    let n = values.len();
    if n == 1 {
        return;
    }
    let mut kept: Vec<(usize, &str)> = values.iter().copied().enumerate().collect();
    match motion {
        Motion::Hold => kept.dedup_by_key(|(_, value)| *value),
        // The last frame lasts as long as the others.
        Motion::Linear => kept.push((n, values[n - 1])),
    }
    let mode = if motion == Motion::Hold { "discrete" } else { "linear" };
    let times: Vec<_> = kept.iter().map(|(frame, _)| decimal(*frame as f64 / n as f64, 6).to_string()).collect();
    let texts: Vec<_> = kept.iter().map(|(_, value)| *value).collect();
    let _ = writeln!(
        out,
        "<animate attributeName=\"{attribute}\" dur=\"{}s\" repeatCount=\"indefinite\" calcMode=\"{mode}\" keyTimes=\"{}\" values=\"{}\"/>",
        decimal(seconds, 6),
        times.join(";"),
        texts.join(";")
    );
}

/// The path of a contour.
fn data(line: &[Point], closed: bool) -> String {
    let mut text = String::new();
    for (i, &p) in line.iter().enumerate() {
        text += match i {
            0 => "M",
            1 => "L",
            _ => " ",
        };
        write_point(&mut text, p);
    }
    if closed {
        text += "Z";
    }
    text
}

/// The path of a contour of Bézier curves. Straight sides are curves too: animations need the same commands on all frames.
fn bent(knots: &[Knot], closed: bool) -> String {
    let mut text = String::from("M");
    let Some(first) = knots.first() else { return String::new() };
    write_point(&mut text, first.at);
    let nexts = knots.iter().skip(1).chain(closed.then_some(first));
    for (k, (knot, next)) in knots.iter().zip(nexts).enumerate() {
        text += if k == 0 { "C" } else { " " };
        write_point(&mut text, knot.handles()[1]);
        for p in [next.handles()[0], next.at] {
            text += " ";
            write_point(&mut text, p);
        }
    }
    if closed {
        text += "Z";
    }
    text
}

fn write_point(out: &mut String, p: Point) {
    let _ = write!(out, "{} {}", decimal(p.x, 2), decimal(p.y, 2));
}

/// A number with at most `digits` decimals, without negative zero.
fn decimal(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
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
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
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
        assert_eq!(attribute(&text, "keyTimes"), ["0;0.75", "0;0.25"]);
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
            vec![
                vec![p(0.0, 0.0), p(4.0, y), p(8.0, 0.0)],
                vec![p(8.0, 0.0), p(0.0, 8.0)],
                vec![p(0.0, 8.0), p(0.0, 0.0)],
            ]
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
        assert!(
            filled.contains("id=\"stroke-7\" fill=\"#000000\" stroke=\"none\" visibility=\"hidden\" d="),
            "{filled}"
        );
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
        let changing =
            svg_with_drawn(&bare, &[], &[SvgStroke { colours, fills, ..both.clone() }], &SvgOptions::default());
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
}
