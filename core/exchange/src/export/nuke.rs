//! Shapes for Nuke: a RotoPaint node as text (`.nk`), to open as a script or to paste into one.
//!
//! Each part is a Bézier shape in the root layer; the nearest comes first, as in the node's list. A point consists of
//! three pairs of numbers: the handle before it, its position, and the handle after it. Handles are relative to their
//! point. They are zero where the sides are straight. If a part has several frames, each number
//! that changes is a curve of keys `{{frame value} …}`. Where the number stays the same for several frames, two keys at each end hold
//! it: the format's keys have no kind of way to the next one here, and with two of them no smooth way swings between. Coordinates are pixels with x right, y up and the origin at the
//! lower left. The lifetime of a shape is the range of its frames. Where a part is not there between its frames, the opacity
//! of its shape (`opc`) is 0. Of the falloff of a soft border it has the rate (`ff`). The numbers of its curves (`ft`) are not
//! public.
//!
//! Source: Foundry, Nuke Developer Kit, "Roto serialisation format" (version 1.2 of the curves, since Nuke 7). As in
//! Nuke, a number is an `x` and the hexadecimal digits of a 32-bit float.

use super::knot::Knot;
use super::names::written;
use super::outlines::{Detail, Keys, Outlines, ShapeOptions};
use super::presence::presence;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene};
use std::fmt::Write;

/// Flag: handles are relative to their point.
const RELATIVE_HANDLES: u32 = 8192;
/// Flag: the last point does not join the first.
const OPEN: u32 = 32;
/// Type of lifetime: a range of frames.
const FRAME_RANGE: f64 = 4.0;

/// The scene's parts as a RotoPaint node. `options` say how they follow snapped paths, and how wide the pixels are.
pub fn nuke(scene: &Scene, options: impl Into<ShapeOptions>) -> String {
    let ShapeOptions { detail, pixel_aspect } = options.into();
    let (width, height) = (scene.footage.width, scene.footage.height);
    let mut out = String::from("set cut_paste_input [stack 0]\nversion 7.0 v1\nRotoPaint {\n inputs 0\n");
    let _ = writeln!(out, " format \"{width} {height} 0 0 {width} {height} {pixel_aspect} \"");
    let (x, y) = (number(0.5 * width as f64), number(0.5 * height as f64));
    let version = number(1.2);
    let _ = write!(
        out,
        " curves {{{{{{v {version}}}\n  {{f 0}}\n  {{n\n   {{layer Root\n    {{f 0}}\n    {{t {x} {y}}}\n    {{a}}"
    );
    let names = written(scene, plain);
    for index in super::nearest_first(scene) {
        shape(&mut out, scene, (index, &names[index]), detail);
    }
    out + "}}}}\n name Rototoon\n}\n"
}

fn shape(out: &mut String, scene: &Scene, (index, name): (usize, &str), detail: Detail) {
    let part = &scene.parts[index];
    let keys = Outlines::new(part, detail).within(scene.footage.first, scene.footage.last);
    let (Some((first, start)), Some((last, _))) = (keys.first(), keys.last()) else { return };
    let flag = if part.closed { RELATIVE_HANDLES } else { RELATIVE_HANDLES | OPEN };
    let _ = write!(out, "\n    {{curvegroup \"{name}\" 512 bezier\n     {{{{cc\n       {{f {flag}}}\n       {{p");
    let height = scene.footage.height as f64;
    for point in 0..start.len() {
        let channel =
            |value: &dyn Fn(&Knot) -> f64| channel(keys.iter().map(|(frame, knots)| (*frame, value(&knots[point]))));
        let _ = write!(
            out,
            "\n        {{{} {}}}\n        {{{} {}}}\n        {{{} {}}}",
            channel(&|knot| knot.before.x),
            channel(&|knot| -knot.before.y),
            channel(&|knot| knot.at.x),
            channel(&|knot| height - knot.at.y),
            channel(&|knot| knot.after.x),
            channel(&|knot| -knot.after.y),
        );
    }
    let middle = start.iter().map(|knot| knot.at).sum::<Point>() / start.len() as f64;
    let [r, g, b] = part.shown_colour(index).map(|c| number(c.into()));
    // Nuke's own value is 1.
    let rate = part.falloff.rate;
    let falloff = if rate == 1.0 { String::new() } else { format!(" ff {}", number(rate)) };
    let _ = write!(
        out,
        "}}}}     idem}}\n     {{tx {} {} {}}}\n     {{a ro {r} go {g} bo {b} ao 1{falloff}{} ltn {} ltm {} ltt {}}}}}",
        number((*first).into()),
        number(middle.x),
        number(height - middle.y),
        opacity(part, &keys, &scene.footage),
        number((*first).into()),
        number((*last).into()),
        number(FRAME_RANGE),
    );
}

/// The opacity of a part that is not always there between its first and its last contour; empty otherwise. Nuke's own value is 1.
/// A key on every frame makes steps, however Nuke interpolates.
fn opacity(part: &Part, keys: &Keys, footage: &Footage) -> String {
    let (begin, end) = (keys[0].0, keys[keys.len() - 1].0);
    let changes = presence(part, keys, footage);
    if !changes.iter().any(|(at, there)| *at < end && !there && *at > begin) {
        return String::new();
    }
    let there = |frame| changes.partition_point(|(at, _)| *at <= frame).checked_sub(1).is_some_and(|k| changes[k].1);
    format!(" opc {}", channel((begin..=end).map(|frame| (frame, f64::from(u8::from(there(frame)))))))
}

/// A number, or a curve of keys if the value changes between frames.
fn channel(values: impl Iterator<Item = (FrameNumber, f64)>) -> String {
    let keys: Vec<_> = values.map(|(frame, value)| (number(frame.into()), number(value))).collect();
    match keys.first() {
        Some((_, value)) if keys.iter().all(|(_, other)| other == value) => value.clone(),
        _ => {
            let keys = held(&keys).map(|(frame, value)| format!("{{{frame} {value}}}")).collect::<Vec<_>>();
            format!("{{{}}}", keys.join(" "))
        }
    }
}

/// Keys without those that have two of the same value on both sides. The way between those that are left is flat, also where its slope on
/// a key comes from the keys beside it.
fn held(keys: &[(String, String)]) -> impl Iterator<Item = &(String, String)> {
    let same = |k: usize| keys[k - 2..=k + 2].iter().all(|(_, value)| *value == keys[k].1);
    (0..keys.len()).filter(move |&k| k < 2 || k + 2 >= keys.len() || !same(k)).map(|k| &keys[k])
}

/// The bits of a 32-bit float in hexadecimal digits.
fn number(value: f64) -> String {
    let bits = (value as f32).to_bits();
    // −0 is 0.
    if bits << 1 == 0 { "0".to_owned() } else { format!("x{bits:x}") }
}

/// A name as it may stand in quotes: characters that would end or escape it become underscores.
pub(super) fn plain(name: &str) -> String {
    let plain = |c: char| if "\"'\\{}[]$".contains(c) || c.is_control() { '_' } else { c };
    name.chars().map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Footage, Part};
    use std::collections::BTreeMap;

    fn scene() -> Scene {
        let at = |x: f64| vec![Point::new(x, 2.0), Point::new(8.0, 2.0), Point::new(8.0, 10.0)];
        let part = |name: &str, depth, closed| Part {
            name: name.into(),
            closed,
            depth,
            keys: BTreeMap::from([(1, at(0.5)), (3, at(2.0))]),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d".into(), first: 0, last: 3, fps: 12.5, width: 40, height: 30, held: false };
        Scene { footage, parts: vec![part("far {arm}", 0.0, true), part("near", 2.0, false)] }
    }

    #[test]
    fn braces_balance_and_shapes_come_nearest_first() {
        let text = nuke(&scene(), 1.0);
        assert_eq!(text.matches('{').count(), text.matches('}').count(), "{text}");
        let names: Vec<_> = text.split("curvegroup ").skip(1).map(|rest| rest.split('"').nth(1).unwrap()).collect();
        assert_eq!(names, ["near", "far _arm_"]);
        assert!(text.contains("{f 8224}") && text.contains("{f 8192}"));
        assert!(text.contains("format \"40 30 0 0 40 30 1 \""));
        let wide = nuke(&scene(), ShapeOptions { pixel_aspect: 2.0, ..1.0.into() });
        assert_eq!(wide, text.replace("40 30 1 ", "40 30 2 "), "points are in pixels");
    }

    #[test]
    fn what_moves_has_keys_and_what_rests_has_none() {
        let text = nuke(&scene(), 1.0);
        // Frames 1 and 3 as floats, 0.5 and 2; y points up: 28 and 20.
        let moving = "{{{x3f800000 x3f000000} {x40400000 x40000000}} x41e00000}";
        assert!(text.contains(moving), "{text}");
        assert!(text.contains("{x41000000 x41a00000}"), "{text}");
        assert!(text.contains("ltn x3f800000 ltm x40400000 ltt x40800000"), "{text}");
    }

    #[test]
    fn a_part_is_transparent_where_it_is_not_there() {
        assert!(!nuke(&scene(), 1.0).contains("opc"));
        let mut scene = scene();
        scene.parts.truncate(1);
        scene.parts[0].absent = vec![[2, 2]];
        let text = nuke(&scene, 1.0);
        let keys = "ao 1 opc {{x3f800000 x3f800000} {x40000000 0} {x40400000 x3f800000}} ltn x3f800000 ltm x40400000";
        assert!(text.contains(keys), "{text}");
        assert_eq!(text.matches('{').count(), text.matches('}').count());
        // Keys alone are shapes between which Nuke moves; tracks have a contour wherever the part is.
        scene.parts[0].absent.clear();
        scene.parts[0].tracks = scene.parts[0].keys.clone();
        assert!(nuke(&scene, 1.0).contains(keys));
        let between = scene.parts[0].keys[&1].clone();
        scene.parts[0].tracks.insert(2, between);
        assert!(!nuke(&scene, 1.0).contains("opc"));
    }

    #[test]
    fn a_number_that_is_held_has_two_keys_at_each_end() {
        let frames = |values: &[i32]| {
            let text = channel((0..).zip(values.iter().map(|&value| f64::from(value))));
            let keys = text.trim_matches(['{', '}']).split("} {").map(|key| key.split(' ').next().unwrap().to_owned());
            keys.collect::<Vec<_>>()
        };
        let of = |frames: &[i32]| frames.iter().map(|&frame| number(frame.into())).collect::<Vec<_>>();
        assert_eq!(
            frames(&[1, 1, 1, 1, 1, 1, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4]),
            of(&[0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 15])
        );
        assert_eq!(frames(&[1, 1, 1, 2]), of(&[0, 1, 2, 3]));
    }

    #[test]
    fn numbers_are_the_bits_of_floats() {
        assert_eq!([number(0.0), number(1024.0), number(-1.0)], ["0", "x44800000", "xbf800000"]);
    }
}
