//! SMIL animations of path data, as keys on frames.
//!
//! An `animate` element of `d` has values at shares of its duration: those of `keyTimes`, or even ones. A held value
//! (`calcMode="discrete"`) gives a key on the first and on the last frame of its interval. Any other value gives a key
//! on the frame nearest to its time. An `animate` element of `visibility` removes the keys of hidden frames. What it
//! hides, or an `animate` element of `opacity`, is hidden.
//!
//! Limits: an animation starts on the first frame of the footage, and repeats are ignored. Values after the last frame of the
//! footage are left out (`range`). A form that moves to one of them has a key on the last frame, on its way there. The value at
//! the very end of an animation as long as the footage is such a value too: it is one frame after the footage.

use super::ImportError;
use super::channel::Channel;
use super::problem::quoted;
use super::range::Kept;
use rototoon_base::scene::{Footage, FrameNumber};
use roxmltree::Node;

/// Values of `visibility` that hide.
const HIDING: [&str; 2] = ["hidden", "collapse"];

/// Path data on a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Keyed {
    /// The frame.
    pub frame: FrameNumber,
    /// The path data.
    pub text: String,
    /// The path data that it moves to, and the share of the way that it has come.
    pub toward: Option<(String, f64)>,
}

/// The keys of an animation.
#[derive(Debug)]
pub(super) struct Keys {
    /// Those within the footage.
    pub keys: Vec<Keyed>,
    /// All of them.
    pub kept: Kept,
}

/// An animation: its values with the frames on which they begin, counted from the first frame of the footage.
struct Animation<'a> {
    values: Vec<(i64, &'a str)>,
    held: bool,
}

/// The keys of an element's path data; `None` if it is not animated.
pub(super) fn keyed(node: Node, footage: &Footage) -> Result<Option<Keys>, ImportError> {
    let Some(data) = animation(node, "d", footage)? else { return Ok(None) };
    let visibility = animation(node, "visibility", footage)?;
    let count = i64::from(footage.last) - i64::from(footage.first) + 1;
    let key = |frame: i64, value: usize, toward| Keyed {
        frame: (frame + i64::from(footage.first)) as FrameNumber,
        text: data.values[value].1.to_owned(),
        toward,
    };
    let mut keys = Vec::new();
    for Run { value, first, last } in runs(&data, visibility.as_ref(), count) {
        let start = data.values[value].0;
        let mut frames = if data.held { vec![first, last] } else { vec![start] };
        frames.retain(|frame| (first..=last).contains(frame));
        frames.dedup();
        keys.extend(frames.into_iter().map(|frame| key(frame, value, None)));
        if let Some((next, to)) = data.values.get(value + 1).filter(|_| !data.held && start < last && last + 1 == count)
        {
            let share = (last - start) as f64 / (next - start) as f64;
            keys.push(key(last, value, Some(((*to).to_owned(), share))));
        }
    }
    let end = |time: &i64| !data.held && *time == count;
    let times = data.values.iter().map(|(start, _)| *start).filter(|time| !end(time));
    let kept = Kept::of(times.map(|time| time as f64 + f64::from(footage.first)), footage);
    Ok(Some(Keys { keys, kept }))
}

/// Why an element's animation of an attribute cannot be read; `None` if it can, or if there is none.
pub(super) fn problem(node: Node, attribute: &str, footage: &Footage) -> Option<String> {
    match animation(node, attribute, footage) {
        Err(ImportError::Element { message, .. }) => Some(format!("which cannot be read: {message}")),
        Err(other) => Some(other.to_string()),
        Ok(_) => None,
    }
}

/// The times in which an element is not shown. An animation that cannot be read hides nothing.
pub(super) fn hidden(node: Node, footage: &Footage) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for attribute in ["visibility", "opacity"] {
        let Ok(Some(Animation { values, held })) = animation(node, attribute, footage) else { continue };
        let shown = |text: &str| if HIDING.contains(&text) { 0.0 } else { text.parse().unwrap_or(1.0) };
        let keys = values.iter().map(|(start, text)| (*start as f64 + f64::from(footage.first), shown(text)));
        // Visibility is always held.
        let held = held || attribute == "visibility";
        found.extend(Channel::keyed(keys.collect()).into_iter().flat_map(|channel| channel.zeros(held)));
    }
    found
}

/// Frames, counted from the first of the footage, on which one value is shown.
struct Run {
    /// Index of the value.
    value: usize,
    first: i64,
    last: i64,
}

/// The runs of an animation that are visible, within the `count` frames of the footage. Their number depends on the
/// values alone: a footage may have any number of frames.
fn runs(data: &Animation, visibility: Option<&Animation>, count: i64) -> Vec<Run> {
    let shown = visibility.map_or(&[][..], |visibility| &visibility.values);
    // Between two neighbouring starts nothing changes.
    let mut starts: Vec<i64> = data.values.iter().chain(shown).map(|(start, _)| *start).chain([0]).collect();
    starts.retain(|start| (0..count).contains(start));
    starts.sort_unstable();
    starts.dedup();
    let current =
        |values: &[(i64, &str)], frame: i64| values.partition_point(|(start, _)| *start <= frame).checked_sub(1);
    let mut runs: Vec<Run> = Vec::new();
    for (k, &first) in starts.iter().enumerate() {
        let last = starts.get(k + 1).copied().unwrap_or(count) - 1;
        let visible = current(shown, first).is_none_or(|k| !HIDING.contains(&shown[k].1));
        let Some(value) = current(&data.values, first).filter(|_| visible) else { continue };
        match runs.last_mut() {
            Some(run) if run.value == value && run.last + 1 == first => run.last = last,
            _ => runs.push(Run { value, first, last }),
        }
    }
    runs
}

fn animation<'a>(node: Node<'a, 'a>, attribute: &str, footage: &Footage) -> Result<Option<Animation<'a>>, ImportError> {
    let is_it =
        |child: &Node| child.tag_name().name() == "animate" && child.attribute("attributeName") == Some(attribute);
    let Some(animate) = node.children().find(is_it) else { return Ok(None) };
    let expect = |name: &str, message: &str| {
        let found = quoted(animate.attribute(name));
        ImportError::at(animate, format!("{name}: found {found}, expected {message}"))
    };
    let list = |name: &str| {
        animate.attribute(name).map(|text| text.trim().trim_end_matches(';').split(';').map(str::trim).collect())
    };
    let ends = || Some(vec![animate.attribute("from")?.trim(), animate.attribute("to")?.trim()]);
    let values: Vec<&str> =
        list("values").or_else(ends).ok_or_else(|| expect("values", "values separated by semicolons"))?;
    let seconds = seconds(animate.attribute("dur").unwrap_or(""))
        .ok_or_else(|| expect("dur", "seconds such as 2.5s, or a clock such as 00:02.5"))?;
    let held = animate.attribute("calcMode") == Some("discrete");
    let even = |index: usize| index as f64 / if held { values.len() } else { (values.len() - 1).max(1) } as f64;
    let times: Vec<f64> = match list("keyTimes") {
        None => (0..values.len()).map(even).collect(),
        Some(texts) => {
            let texts: Vec<&str> = texts;
            let times: Option<Vec<f64>> = texts.iter().map(|text| text.parse().ok()).collect();
            let rising = |times: &Vec<f64>| times.is_sorted() && times.iter().all(|time| (0.0..=1.0).contains(time));
            times
                .filter(|times| times.len() == values.len() && rising(times))
                .ok_or_else(|| expect("keyTimes", &format!("{} rising numbers from 0 to 1", values.len())))?
        }
    };
    let frames = seconds * footage.fps;
    let values = times.iter().map(|time| (time * frames).round() as i64).zip(values).collect();
    Ok(Some(Animation { values, held }))
}

/// A duration in seconds: a number with a unit or without one, or a clock such as `01:30` or `0:01:30.5`.
pub(super) fn seconds(text: &str) -> Option<f64> {
    let text = text.trim();
    let units = [("ms", 1e-3), ("min", 60.0), ("h", 3600.0), ("s", 1.0), ("", 1.0)];
    let counted = || {
        let (unit, factor) = units.into_iter().find(|(unit, _)| text.ends_with(unit))?;
        Some(text.strip_suffix(unit)?.parse::<f64>().ok()? * factor)
    };
    let found = if text.contains(':') { clock(text) } else { counted() };
    found.filter(|seconds| seconds.is_finite() && *seconds > 0.0)
}

/// The seconds of a clock with minutes and seconds, and perhaps hours before them.
fn clock(text: &str) -> Option<f64> {
    let plain = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    let parts: Vec<&str> = text.split(':').collect();
    let [whole @ .., last] = &parts[..] else { return None };
    let mut sum = 0.0;
    for part in whole {
        sum = 60.0 * (sum + f64::from(part.parse::<u32>().ok()?));
    }
    let last: f64 = last.parse().ok().filter(|_| plain(last))?;
    (whole.len() <= 2 && last < 60.0).then_some(sum + last)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(animations: &str) -> Result<Vec<(FrameNumber, String)>, ImportError> {
        let footage =
            Footage { pattern: "%d".into(), first: 5, last: 14, fps: 10.0, width: 20, height: 10, held: false };
        let text = format!("<path>{animations}</path>");
        let document = roxmltree::Document::parse(&text).unwrap();
        let Some(found) = keyed(document.root_element(), &footage)? else { return Ok(Vec::new()) };
        let text = |key: Keyed| match key.toward {
            Some((to, share)) => format!("{} {share:.2} {to}", key.text),
            None => key.text,
        };
        let mut keys: Vec<_> = found.keys.into_iter().map(|key| (key.frame, text(key))).collect();
        keys.extend(found.kept.told("a", &footage).map(|told| (0, told)));
        Ok(keys)
    }

    fn expected(keys: &[(FrameNumber, &str)]) -> Vec<(FrameNumber, String)> {
        keys.iter().map(|(frame, text)| (*frame, (*text).to_owned())).collect()
    }

    const HELD: &str = "<animate attributeName='d' dur='1s' calcMode='discrete' keyTimes='0;0.3;0.4' values='a;b;c;'/>";

    #[test]
    fn held_values_have_keys_at_both_ends() {
        let found = keys(HELD).unwrap();
        assert_eq!(found, expected(&[(5, "a"), (7, "a"), (8, "b"), (9, "c"), (14, "c")]));
    }

    #[test]
    fn what_is_hidden_has_no_keys() {
        let hidden = "<animate attributeName='visibility' dur='1000ms' calcMode='discrete' keyTimes='0;0.1;0.6'
            values='hidden;visible;hidden'/>";
        let found = keys(&format!("{HELD}{hidden}")).unwrap();
        assert_eq!(found, expected(&[(6, "a"), (7, "a"), (8, "b"), (9, "c"), (10, "c")]));
    }

    #[test]
    fn moving_values_have_keys_at_their_times() {
        let found = keys("<animate attributeName='d' dur='1' values='a;b;c'/>").unwrap();
        assert_eq!(found, expected(&[(5, "a"), (10, "b"), (14, "b 0.80 c")]));
        let found = keys("<animate attributeName='d' dur='1' from='a' to='b'/>").unwrap();
        assert_eq!(found, expected(&[(5, "a"), (14, "a 0.90 b")]));
        assert!(keys("<animate attributeName='fill' dur='1' values='a'/>").unwrap().is_empty());
    }

    #[test]
    fn values_beyond_the_footage_are_told() {
        let found = keys("<animate attributeName='d' dur='4s' values='a;b;c'/>").unwrap();
        assert_eq!(found[..2], expected(&[(5, "a"), (14, "a 0.45 b")]));
        assert!(found[2].1.contains("has 2 keys on frames 25 to 45, beyond the footage's frames 5 to 14"), "{found:?}");
        let found = keys(&HELD.replace("1s", "3s")).unwrap();
        assert_eq!(found[..3], expected(&[(5, "a"), (13, "a"), (14, "b")]));
        assert!(found[3].1.contains("has a key on frame 17,"), "{found:?}");
    }

    #[test]
    fn errors_say_what_was_expected() {
        for (from, to, message) in [
            ("1s", "soon", "dur: found \"soon\", expected seconds"),
            ("0;0.3", "0.5;0.3", "expected 3 rising numbers from 0 to 1"),
            ("values", "to", "values: found nothing"),
        ] {
            let error = keys(&HELD.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains("line 1, column 7: <animate>: ") && error.contains(message), "{error}");
        }
    }

    #[test]
    fn durations_have_units_or_are_clocks() {
        for (text, wanted) in [
            ("2", 2.0),
            (" 2.5s ", 2.5),
            ("250ms", 0.25),
            ("1.5min", 90.0),
            ("0.5h", 1800.0),
            ("00:01", 1.0),
            ("02:30.5", 150.5),
            ("1:00:01", 3601.0),
        ] {
            assert_eq!(seconds(text), Some(wanted), "{text}");
        }
        for text in
            ["", "s", "soon", "indefinite", "0", "-1s", "1:", ":1", "1:61", "1:2:3:4", "1:-2", "-1:02", "1:1e1", "inf"]
        {
            assert_eq!(seconds(text), None, "{text}");
        }
    }
}
