//! SVG with one animated path for each part.
//!
//! Each part is a `path` with a `title` and a SMIL animation of its `d` over the footage. The animation loops, and
//! browsers play it directly. SMIL can interpolate only paths with the same number of points, so every frame gets the
//! same number ([`super::outlines`]), and curves on all frames or on none. A part is hidden on frames without a contour. One that
//! has nothing but keys goes evenly from one to the next, as in other formats, and an attribute names the frames of its keys for an import. The root says which frames of the document it shows. Parts are drawn in the order of
//! depth, far ones first.
//!
//! Painted regions, contours and lines are groups below the root, in the order in which they lie: [`PAINT`], [`CONTOURS`] and [`LINES`]. Programs for drawing show such groups as layers of
//! these names; Inkscape needs attributes of its own for it. A group with nothing in it is left out. No path has the id of a group, since those of paths end in a number.

use super::knot::Knot;
use super::names::written;
use super::outlines::{Detail, Outlines};
use super::xml::{escaped, plain};
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::{resample, segments};
use rototoon_base::scene::palette;
use rototoon_base::scene::{Colour, Footage, FrameNumber, Part, Scene};
use std::collections::{BTreeMap, BTreeSet};
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

/// How much earlier than its frame a held value begins, as a share of the frame. At 60 frames a second it is half a millisecond, by which a clock of whole
/// milliseconds may be late.
const EARLY: f64 = 1.0 / 32.0;
/// Least number of digits of a share of an animation.
const LEAST_DIGITS: i32 = 6;

/// The ids of the groups, and their names in Inkscape: painted regions.
pub const PAINT: [&str; 2] = ["paint", "Paint"];
/// Contours of parts.
pub const CONTOURS: [&str; 2] = ["contours", "Contours"];
/// Strokes.
pub const LINES: [&str; 2] = ["lines", "Lines"];
/// The namespace of Inkscape's attributes.
const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// The attribute of a part that has nothing but keys: their frames.
const KEYS: &str = "data-keys";

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
    /// Frames on which that is otherwise.
    pub turned: BTreeSet<FrameNumber>,
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

/// The scene, painted regions behind it and strokes over it as an SVG document, in pixels of the footage. Each of the three is a group. Each region is
/// a path with the id `fill-` and its number, each stroke one with `stroke-` and its number. Regions change from frame to frame
/// without motion between, since their outlines have no counterparts.
pub fn svg_with_drawn(scene: &Scene, fills: &[SvgFill], strokes: &[SvgStroke], options: &SvgOptions) -> String {
    let footage = &scene.footage;
    let (width, height) = (footage.width, footage.height);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"{INKSCAPE}\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" data-first=\"{}\" data-last=\"{}\">\n",
        footage.first, footage.last
    );
    let mut painted = String::new();
    for each in fills {
        fill(&mut painted, scene, each);
    }
    let (mut order, depths): (Vec<usize>, _) = ((0..scene.parts.len()).collect(), super::depths(scene));
    order.sort_by(|&a, &b| depths[a].total_cmp(&depths[b]));
    let names = written(scene, plain);
    let mut contours = String::new();
    for index in order {
        part(&mut contours, scene, (index, &names[index]), options);
    }
    let mut lines = String::new();
    for drawn in strokes {
        stroke(&mut lines, scene, drawn, options);
    }
    let width = LINE_WIDTH * (height as f64 / 540.0).max(0.5);
    for (group, paths) in [(PAINT, painted), (CONTOURS, contours), (LINES, lines)] {
        layer(&mut out, group, width, &paths);
    }
    out + "</svg>\n"
}

/// Writes a group that programs for drawing show as a layer; none of nothing.
fn layer(out: &mut String, [id, label]: [&str; 2], width: f64, paths: &str) {
    if !paths.is_empty() {
        let own = format!("id=\"{id}\" inkscape:groupmode=\"layer\" inkscape:label=\"{label}\"");
        let lines = format!("stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"");
        let _ = writeln!(out, "<g {own} {lines}>\n{paths}</g>");
    }
}

fn part(out: &mut String, scene: &Scene, (index, name): (usize, &str), options: &SvgOptions) {
    let part = &scene.parts[index];
    let outlines = Outlines::new(part, options.detail());
    let shape = |frame: FrameNumber| {
        let knots = outlines.shown(frame)?;
        if outlines.bent() {
            return Some(bent(&knots, part.closed));
        }
        Some(data(&knots.iter().map(|knot| knot.at).collect::<Vec<_>>(), part.closed))
    };
    let colour = palette::hex(part.shown_colour(index));
    let fill = if part.closed { colour.as_str() } else { "none" };
    let keys = keys_alone(part, &scene.footage);
    let style =
        format!("id=\"part-{index}\"{keys} fill=\"{fill}\" fill-opacity=\"{FILL_OPACITY}\" stroke=\"{colour}\"");
    path(out, scene, &style, (&escaped(name), &BTreeMap::new(), ""), options.motion, shape);
}

/// The attribute with the frames of the keys of a part that has nothing else; none for other parts.
fn keys_alone(part: &Part, footage: &Footage) -> String {
    let frames = part.keys.range(footage.first..=footage.last).map(|(frame, _)| frame.to_string());
    let frames: Vec<String> = frames.collect();
    if part.tracks.is_empty() && frames.len() > 1 { format!(" {KEYS}=\"{}\"", frames.join(" ")) } else { String::new() }
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
    // The same number of points on every frame that is shown, as for parts.
    let shown = stroke.points.range(scene.footage.first..=scene.footage.last);
    let most = shown.map(|(_, points)| points.len()).max().unwrap_or(0);
    let shape = |frame: FrameNumber| {
        let points = stroke.points.get(&frame).filter(|points| !points.is_empty())?;
        let closed = stroke.closed != stroke.turned.contains(&frame);
        let even = match options.motion {
            _ if points.len() == most => points.clone(),
            // Points go evenly from place to place.
            Motion::Linear => resample(points, closed, most),
            Motion::Hold => filled(points, closed, most),
        };
        Some(data(&even, closed))
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

/// The same line with `count` points. Its own points stay, so corners do too; others are put where two are farthest apart.
fn filled(points: &[Point], closed: bool, count: usize) -> Vec<Point> {
    let sides: Vec<(Point, Point)> = segments(points, closed).collect();
    let mut pieces = vec![1; sides.len()];
    let gap = |k: usize, pieces: &[usize]| sides[k].0.distance(sides[k].1) / pieces[k] as f64;
    for _ in points.len()..count {
        let widest = (0..sides.len()).reduce(|best, k| if gap(k, &pieces) > gap(best, &pieces) { k } else { best });
        match widest {
            Some(k) => pieces[k] += 1,
            None => return resample(points, closed, count),
        }
    }
    let along = sides
        .iter()
        .zip(&pieces)
        .flat_map(|(&(a, b), &pieces)| (0..pieces).map(move |k| a.lerp(b, k as f64 / pieces as f64)));
    along.chain(points.last().copied().filter(|_| !closed)).collect()
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
    let times: Vec<_> = kept.iter().map(|(frame, _)| share(*frame, n, motion)).collect();
    let texts: Vec<_> = kept.iter().map(|(_, value)| *value).collect();
    let _ = writeln!(
        out,
        "<animate attributeName=\"{attribute}\" dur=\"{}s\" repeatCount=\"indefinite\" calcMode=\"{mode}\" keyTimes=\"{}\" values=\"{}\"/>",
        decimal(seconds, 6),
        times.join(";"),
        texts.join(";")
    );
}

/// When a frame begins, as a share of an animation of `n` frames.
///
/// A program that makes pictures of the film seeks to the time frame ∕ rate. A held value must be there by then. Clocks round this time: Chrome's has
/// 32 bits and counts whole microseconds, Firefox's counts milliseconds. So a held value begins [`EARLY`] of a frame before, and digits
/// that do not fit make it earlier too. There are enough of them for an error of less than 1 ∕ 64 of a frame.
fn share(frame: usize, n: usize, motion: Motion) -> String {
    let digits = ((64.0 * n as f64).log10().ceil() as i32).max(LEAST_DIGITS);
    let scale = 10f64.powi(digits);
    let early = if frame == 0 || motion == Motion::Linear { 0.0 } else { EARLY };
    let steps = (frame as f64 - early) / n as f64 * scale;
    decimal(steps.floor() / scale, digits).to_string()
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
mod tests;
