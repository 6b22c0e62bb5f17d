//! The fields of a document that tweening reads: drawings, pairs, pegs.

use super::{frame, json_number, json_points, json_text, list, number, point, points};
use arbitrary::{Result, Unstructured};

/// The largest number of strokes of a drawing.
const STROKES: usize = 4;
/// The largest number of points of a stroke.
const POINTS: usize = 12;

/// The movement functions by name.
const TIMINGS: [&str; 8] = ["constant", "linear", "ease_in", "ease_out", "ease_in_out", "cosine", "bounce", "smooth"];

/// The names of the pegs.
const PEGS: [&str; 3] = ["arm", "body", "leg"];

/// Drawings, pairs and pegs, as fields of a document.
pub fn drawings(u: &mut Unstructured) -> Result<String> {
    let count = if u.ratio(1u8, 8)? { 1 } else { u.int_in_range(2..=4usize)? };
    let mut on = if u.ratio(1u8, 8)? { frame(u)? } else { 0 };
    let mut drawn = Vec::with_capacity(count);
    let hung = u.ratio(1u8, 4)?;
    for _ in 0..count {
        drawn.push(drawing(u, on, hung)?);
        on = on.wrapping_add(u.int_in_range(1..=4)?);
    }
    let mut fields = vec![format!("\"drawings\": [{}]", drawn.join(", "))];
    if u.ratio(1u8, 4)? {
        fields.push(format!("\"pairs\": {}", list(u, 0, 1, pair)?));
    }
    if hung {
        let known = u.int_in_range(1..=2usize)?;
        let pegs = (0..=known).map(|k| peg(u, k)).collect::<Result<Vec<_>>>()?;
        fields.push(format!("\"pegs\": [{}]", pegs.join(", ")));
    }
    Ok(fields.join(", "))
}

fn drawing(u: &mut Unstructured, on: i32, hung: bool) -> Result<String> {
    let strokes = list(u, 0, STROKES, |u| stroke(u, hung))?;
    let mut fields = vec![format!("\"frame\": {on}"), format!("\"strokes\": {strokes}")];
    if u.ratio(1u8, 3)? {
        fields.push(format!("\"spacing\": {}", timing(u)?));
    }
    if u.ratio(1u8, 4)? {
        fields.push("\"corner\": true".into());
    }
    Ok(format!("{{{}}}", fields.join(", ")))
}

fn stroke(u: &mut Unstructured, hung: bool) -> Result<String> {
    let mut fields = vec![
        format!("\"points\": {}", json_points(&points(u, 0, POINTS)?)),
        format!("\"closed\": {}", u.arbitrary::<bool>()?),
    ];
    if u.ratio(1u8, 4)? {
        fields.push(format!("\"colour\": [{}, 0.5, 1]", json_number(f64::from(u.arbitrary::<u8>()?) / 255.0)));
        fields.push(format!("\"material\": {}", u.int_in_range(0..=2u8)?));
        fields.push(format!("\"layer\": {}", if u.ratio(1u8, 64)? { u.arbitrary()? } else { 1u64 }));
    }
    if hung && u.arbitrary()? {
        fields.push(format!("\"peg\": {}", json_text(u.choose(&PEGS[..2])?)));
    }
    Ok(format!("{{{}}}", fields.join(", ")))
}

fn pair(u: &mut Unstructured) -> Result<String> {
    let to = if u.ratio(1u8, 4)? { "null".to_owned() } else { u.int_in_range(0..=3u8)?.to_string() };
    Ok(format!(
        "{{\"frame\": {}, \"from\": {}, \"to\": {to}}}",
        if u.ratio(1u8, 4)? { frame(u)? } else { 0 },
        u.int_in_range(0..=3u8)?
    ))
}

fn peg(u: &mut Unstructured, index: usize) -> Result<String> {
    let pivot = point(u)?;
    let keys = list(u, 0, 3, |u| {
        let shift = point(u)?;
        let (turn, scale) = (json_number(number(u)?), json_number(number(u)?));
        Ok(format!(
            "{{\"frame\": {}, \"shift\": [{}, {}], \"turn\": {turn}, \"scale\": {scale}, \"timing\": {}}}",
            frame(u)?,
            json_number(shift.x),
            json_number(shift.y),
            timing(u)?
        ))
    })?;
    let parent =
        if u.ratio(1u8, 3)? { format!("\"parent\": {}, ", json_text(u.choose(&PEGS[..2])?)) } else { String::new() };
    let pivot = format!("[{}, {}]", json_number(pivot.x), json_number(pivot.y));
    Ok(format!("{{\"name\": {}, {parent}\"pivot\": {pivot}, \"keys\": {keys}}}", json_text(PEGS[index % 3])))
}

/// A movement function or a spacing chart.
fn timing(u: &mut Unstructured) -> Result<String> {
    Ok(match u.int_in_range(0..=5u8)? {
        0 => list(u, 0, 3, |u| Ok(json_number(number(u)? / 64.0)))?,
        1 => format!("{{\"bounce\": {}}}", if u.ratio(1u8, 16)? { u.arbitrary()? } else { 3u32 }),
        2 => {
            let places = list(u, 0, 4, |u| {
                let p = point(u)?;
                Ok(format!("[{}, {}]", json_number(p.x / 64.0), json_number(p.y / 64.0)))
            })?;
            format!("{{\"curve\": {places}}}")
        }
        _ => json_text(u.choose(&TIMINGS)?),
    })
}
