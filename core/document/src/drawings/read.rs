//! Reads drawings, pairs and pegs from JSON values.
//!
//! An invalid value is recorded as a problem, and reading continues with the default in its place. Indices therefore
//! stay valid, and one reading finds all problems. A value that depends on an unreadable field causes no further
//! problem.

use super::super::Document;
use super::super::fields::{array, count, described, flag, frame, given, number, object, point, share, wrong};
use super::super::line::{self, Line};
use super::{
    Drawing, Drawings, DrawingsError, DrawnPair, DrawnPeg, DrawnPegKey, DrawnStroke, WrittenTiming, drawing_place,
    pair_place, peg_key_place, peg_place,
};
use rototoon_base::scene::FrameNumber;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Reads a movement function or spacing chart; `place` names it in errors.
pub fn read_timing(value: &Value, place: &str) -> Result<WrittenTiming, DrawingsError> {
    timing(Some(value), place)
}

/// Reads pegs.
///
/// # Errors
///
/// The first invalid field.
pub fn read_pegs(values: &[Value]) -> Result<Vec<DrawnPeg>, DrawingsError> {
    let mut reader = Reader::default();
    let pegs = reader.pegs(values);
    reader.problems.into_iter().next().map_or(Ok(pegs), Err)
}

/// Collects the problems found so far.
#[derive(Default)]
pub(super) struct Reader {
    problems: Vec<DrawingsError>,
}

/// A drawing, as far as it can be read.
struct Read {
    drawing: Drawing,
    /// The frame, if it can be read.
    frame: Option<FrameNumber>,
    /// Whether the number of its strokes is known.
    counted: bool,
}

impl Reader {
    /// Reads all data of a document. Pegs come first, since strokes name them.
    pub fn document(mut self, document: &Document) -> (Drawings, Vec<DrawingsError>) {
        let mut list = |name| self.noted(document.other_list(name));
        let (pegs, drawings, pairs) = (list("pegs"), list("drawings"), list("pairs"));
        // Pairs are not checked against drawings that cannot be read.
        let listed = drawings.is_some();
        let (pegs, drawings, pairs) =
            (pegs.unwrap_or_default(), drawings.unwrap_or_default(), pairs.unwrap_or_default());
        let pegs = self.pegs(&pegs);
        let names: BTreeMap<&str, usize> = pegs.iter().enumerate().map(|(k, peg)| (peg.name.as_str(), k)).collect();
        let read: Vec<Read> = drawings.iter().enumerate().map(|(k, value)| self.drawing(value, k, &names)).collect();
        self.order(&read);
        let known = listed && read.iter().all(|read| read.frame.is_some());
        let pairs = self.pairs(&pairs, &read, known);
        let drawings = read.into_iter().map(|read| read.drawing).collect();
        (Drawings { drawings, pairs, pegs }, self.problems)
    }

    /// The value read. On failure it is `None`, and the problem is recorded.
    fn noted<T>(&mut self, read: Result<T, DrawingsError>) -> Option<T> {
        read.map_err(|problem| self.problems.push(problem)).ok()
    }

    fn drawing(&mut self, value: &Value, k: usize, pegs: &BTreeMap<&str, usize>) -> Read {
        let mut place = format!("drawings[{k}]");
        let none = Read { drawing: Drawing::default(), frame: None, counted: false };
        let Some(fields) = self.noted(object(value, &place)) else { return none };
        let on = self.noted(frame(fields.get("frame"), &format!("{place}.frame")));
        if let Some(on) = on {
            place = drawing_place(k, on);
        }
        let list = self.noted(array(fields.get("strokes"), &format!("{place}.strokes")));
        let strokes = list.into_iter().flatten().enumerate();
        let strokes = strokes.map(|(i, s)| self.noted(stroke(s, &format!("{place}.strokes[{i}]"), pegs)));
        let drawing = Drawing {
            frame: on.unwrap_or_default(),
            strokes: strokes.map(Option::unwrap_or_default).collect(),
            spacing: self.noted(given(fields, &place, "spacing", timing)).flatten().unwrap_or_default(),
            corner: self.noted(given(fields, &place, "corner", flag)).flatten().unwrap_or_default(),
        };
        Read { drawing, frame: on, counted: list.is_some() }
    }

    /// Checks that frames ascend.
    fn order(&mut self, read: &[Read]) {
        let mut last: Option<(usize, FrameNumber)> = None;
        for (k, frame) in read.iter().enumerate().filter_map(|(k, read)| Some((k, read.frame?))) {
            match last {
                Some((before, least)) if frame <= least => {
                    let expected = format!("more than {least}, that of drawings[{before}]");
                    let place = format!("{}.frame", drawing_place(k, frame));
                    self.problems.push(wrong(&place, &frame.to_string(), &expected));
                }
                _ => last = Some((k, frame)),
            }
        }
    }

    /// Reads the pairs; `known` says whether the frames of all drawings are known.
    fn pairs(&mut self, list: &[Value], drawings: &[Read], known: bool) -> Vec<DrawnPair> {
        let mut seen = BTreeMap::new();
        let mut found = Vec::new();
        for (k, value) in list.iter().enumerate() {
            let Some(pair) = self.noted(pair(value, k, drawings, known)).flatten() else { continue };
            let place = pair_place(k, drawings[pair.drawing].drawing.frame);
            let sides = [("from", 0, Some(pair.from)), ("to", 1, pair.to)];
            for (field, side, stroke) in sides.into_iter().filter_map(|(f, side, stroke)| Some((f, side, stroke?))) {
                let place = format!("{place}.{field}");
                let read = &drawings[pair.drawing + side];
                let (count, on) = (read.drawing.strokes.len(), read.drawing.frame);
                if stroke >= count && read.counted {
                    let expected = format!("the index of one of the {count} strokes on frame {on}");
                    self.problems.push(wrong(&place, &stroke.to_string(), &expected));
                } else if let Some(first) = seen.insert((pair.drawing, side, stroke), k) {
                    let expected = format!("a stroke that pairs[{first}] does not use");
                    self.problems.push(wrong(&place, &format!("stroke {stroke} on frame {on}"), &expected));
                }
            }
            found.push(pair);
        }
        found
    }

    fn pegs(&mut self, list: &[Value]) -> Vec<DrawnPeg> {
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        for (k, value) in list.iter().enumerate() {
            let Some(fields) = self.noted(object(value, &format!("pegs[{k}]"))) else { continue };
            let name = fields.get("name");
            let text = name.and_then(Value::as_str).unwrap_or_default();
            if text.is_empty() {
                self.problems.push(wrong(&format!("pegs[{k}].name"), &described(name), "a unique name"));
            } else if let Some(first) = names.get(text) {
                let expected = format!("a unique name: it is that of pegs[{first}]");
                self.problems.push(wrong(&format!("{}.name", peg_place(k, text)), &described(name), &expected));
            } else {
                names.insert(text, k);
            }
        }
        list.iter().enumerate().map(|(k, value)| self.peg(value, k, &names)).collect()
    }

    /// Reads a peg. A value that is not an object gives a peg without a name; its problem is already recorded.
    fn peg(&mut self, value: &Value, k: usize, names: &BTreeMap<&str, usize>) -> DrawnPeg {
        let none = Map::new();
        let fields = value.as_object().unwrap_or(&none);
        let name = fields.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        let mut peg = DrawnPeg { name, ..DrawnPeg::default() };
        if !value.is_object() {
            return peg;
        }
        let place = if peg.name.is_empty() { format!("pegs[{k}]") } else { peg_place(k, &peg.name) };
        let parent = |value: Option<&Value>, place: &str| match value {
            Some(Value::Null) => Ok(None),
            value => named(value, place, names).map(Some),
        };
        peg.parent = self.noted(given(fields, &place, "parent", parent)).flatten().flatten();
        peg.pivot = self.noted(point(fields.get("pivot"), &format!("{place}.pivot"))).unwrap_or_default();
        let keys = self.noted(array(fields.get("keys"), &format!("{place}.keys")));
        let keys = keys.into_iter().flatten().enumerate();
        peg.keys = keys.filter_map(|(j, value)| self.noted(peg_key(value, &place, j))).collect();
        peg
    }
}

pub(super) fn stroke(value: &Value, place: &str, pegs: &BTreeMap<&str, usize>) -> Result<DrawnStroke, DrawingsError> {
    let fields = object(value, place)?;
    let Line { points, closed, fill, widths, colour, fill_colour } = line::read(fields, place, share)?;
    let peg = |value: Option<&Value>, place: &str| named(value, place, pegs);
    Ok(DrawnStroke {
        points,
        closed,
        fill,
        widths,
        colour,
        fill_colour,
        material: given(fields, place, "material", count)?,
        layer: given(fields, place, "layer", count)?,
        peg: given(fields, place, "peg", peg)?,
    })
}

fn named(value: Option<&Value>, place: &str, pegs: &BTreeMap<&str, usize>) -> Result<usize, DrawingsError> {
    let found = value.and_then(Value::as_str).and_then(|name| pegs.get(name));
    found.copied().ok_or_else(|| wrong(place, &described(value), "the name of a peg"))
}

/// Reads a pair; `None` if its drawing could not be read.
fn pair(value: &Value, k: usize, drawings: &[Read], known: bool) -> Result<Option<DrawnPair>, DrawingsError> {
    let place = format!("pairs[{k}]");
    let fields = object(value, &place)?;
    let at = format!("{place}.frame");
    let on = frame(fields.get("frame"), &at)?;
    let drawing = drawings.iter().position(|read| read.frame == Some(on)).filter(|&k| k + 1 < drawings.len());
    let Some(drawing) = drawing else {
        let missing = || wrong(&at, &on.to_string(), "the frame of a drawing that has a next one");
        return if known { Err(missing()) } else { Ok(None) };
    };
    let place = pair_place(k, on);
    let to = match fields.get("to") {
        Some(Value::Null) => None,
        value => Some(count(value, &format!("{place}.to"))?),
    };
    Ok(Some(DrawnPair { drawing, from: count(fields.get("from"), &format!("{place}.from"))?, to }))
}

fn peg_key(value: &Value, peg: &str, k: usize) -> Result<DrawnPegKey, DrawingsError> {
    let place = format!("{peg}.keys[{k}]");
    let fields = object(value, &place)?;
    let on = frame(fields.get("frame"), &format!("{place}.frame"))?;
    let place = peg_key_place(peg, k, on);
    Ok(DrawnPegKey {
        frame: on,
        shift: given(fields, &place, "shift", point)?.unwrap_or_default(),
        turn: given(fields, &place, "turn", number)?.unwrap_or(0.0),
        scale: given(fields, &place, "scale", number)?.unwrap_or(1.0),
        timing: given(fields, &place, "timing", timing)?.unwrap_or_default(),
    })
}

fn timing(value: Option<&Value>, place: &str) -> Result<WrittenTiming, DrawingsError> {
    match value {
        Some(Value::String(name)) if name == "smooth" => Ok(WrittenTiming::Smooth),
        Some(Value::String(name)) => Ok(WrittenTiming::Named(name.clone())),
        Some(Value::Array(list)) => {
            let share = |(k, v): (usize, &Value)| number(Some(v), &format!("{place}[{k}]"));
            list.iter().enumerate().map(share).collect::<Result<_, _>>().map(WrittenTiming::Chart)
        }
        Some(Value::Object(fields)) if fields.contains_key("bounce") => {
            count(fields.get("bounce"), &format!("{place}.bounce")).map(WrittenTiming::Bounce)
        }
        Some(Value::Object(fields)) => {
            let place = format!("{place}.curve");
            let list = array(fields.get("curve"), &place)?;
            if list.is_empty() {
                return Err(wrong(&place, "an empty list", "at least one pair of time and share"));
            }
            let pair = |(k, v): (usize, &Value)| point(Some(v), &format!("{place}[{k}]")).map(|p| (p.x, p.y));
            list.iter().enumerate().map(pair).collect::<Result<_, _>>().map(WrittenTiming::Curve)
        }
        other => Err(wrong(place, &described(other), "a movement function or a spacing chart")),
    }
}
