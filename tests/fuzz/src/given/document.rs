//! Project documents as text.

use super::drawings::drawings;
use super::limbs::limbs;
use super::{SIZE, by_frame, frame, json_number, json_points, json_text, name, number, point, points};
use arbitrary::{Result, Unstructured};

/// The largest number of parts.
const PARTS: usize = 4;
/// The largest number of points of a contour.
const POINTS: usize = 16;
/// The largest number of frames of a field.
const FRAMES: usize = 4;

/// The text of a document: mostly a valid one.
pub fn document(u: &mut Unstructured) -> Result<String> {
    let footage = footage(u)?;
    let count = if u.ratio(1u8, 16)? { 0 } else { u.int_in_range(1..=PARTS)? };
    let parts = (0..count).map(|k| part(u, k)).collect::<Result<Vec<_>>>()?;
    let mut fields = vec![
        "\"rototoon\": 1".to_owned(),
        format!("\"footage\": {footage}"),
        format!("\"parts\": [{}]", parts.join(", ")),
    ];
    if u.ratio(3u8, 4)? {
        fields.push(drawings(u)?);
    }
    if u.ratio(3u8, 4)? {
        fields.push(limbs(u)?);
    }
    if u.ratio(1u8, 8)? {
        fields.push(format!("{}: [{}]", json_text(&name(u)?), json_number(number(u)?)));
    }
    Ok(format!("{{{}}}", fields.join(", ")))
}

/// The text of a footage.
pub fn footage(u: &mut Unstructured) -> Result<String> {
    let (mut first, mut last) = (0, 9);
    let (mut fps, mut size) = ("12".to_owned(), SIZE);
    if u.ratio(1u8, 16)? {
        (first, last) = (frame(u)?, frame(u)?);
        fps = json_number(number(u)?);
        size = [u.int_in_range(0..=128)?, u.int_in_range(0..=128)?];
    }
    let patterns = ["f%03d.png", "%d.png", "/x/%04d.exr", "f.png", "%%%d", "%99999d", "%0d"];
    let pattern = if u.ratio(1u8, 32)? { *u.choose(&patterns)? } else { patterns[0] };
    let [width, height] = size;
    Ok(format!(
        "{{\"pattern\": {}, \"first\": {first}, \"last\": {last}, \"fps\": {fps}, \"width\": {width}, \"height\": {height}}}",
        json_text(pattern)
    ))
}

/// The text of a part. `index` gives it the name that limbs know.
pub fn part(u: &mut Unstructured, index: usize) -> Result<String> {
    // Names are unique, or the document is refused.
    let own = if u.ratio(31u8, 32)? { ["near arm", "coat", "a", "b"][index % 4].to_owned() } else { name(u)? };
    let count = if u.ratio(1u8, 8)? { u.int_in_range(1..=3)? } else { u.int_in_range(4..=POINTS)? };
    let mut fields = vec![format!("\"name\": {}", json_text(&own)), format!("\"closed\": {}", u.arbitrary::<bool>()?)];
    let contour = |u: &mut Unstructured| {
        // One contour with another number of points now and then: it is no contour of the part.
        let least = if u.ratio(1u8, 128)? { 0 } else { count };
        Ok(json_points(&points(u, least, count)?))
    };
    fields.push(format!("\"keys\": {}", by_frame(u, 1, FRAMES, contour)?));
    if u.arbitrary()? {
        fields.push(format!("\"depth\": {}", json_number(number(u)?)));
    }
    if u.arbitrary()? {
        fields.push(format!("\"tracks\": {}", by_frame(u, 0, FRAMES, contour)?));
    }
    if u.ratio(1u8, 4)? {
        fields.extend(corrections(u, count)?);
    }
    if u.ratio(1u8, 4)? {
        fields.extend(results(u, count)?);
    }
    Ok(format!("{{{}}}", fields.join(", ")))
}

/// Pins and centres.
fn corrections(u: &mut Unstructured, count: usize) -> Result<[String; 2]> {
    let pin = |u: &mut Unstructured| {
        let index = if u.ratio(1u8, 32)? { u.arbitrary::<u64>()? } else { u.int_in_range(0..=count as u64 - 1)? };
        let p = point(u)?;
        Ok(format!("{{\"{index}\": [{}, {}]}}", json_number(p.x), json_number(p.y)))
    };
    let pins = by_frame(u, 0, FRAMES, pin)?;
    let centre = |u: &mut Unstructured| {
        let p = point(u)?;
        Ok(format!("[{}, {}]", json_number(p.x), json_number(p.y)))
    };
    let centers = by_frame(u, 0, FRAMES, centre)?;
    Ok([format!("\"pins\": {pins}"), format!("\"centers\": {centers}")])
}

/// Confidence, snapped paths, wanted keys, depths and absence.
fn results(u: &mut Unstructured, count: usize) -> Result<[String; 5]> {
    let confidence = by_frame(u, 0, FRAMES, |u| {
        let values = (0..count).map(|_| Ok(json_number(f64::from(u.arbitrary::<u8>()?) / 255.0)));
        Ok(format!("[{}]", values.collect::<Result<Vec<_>>>()?.join(", ")))
    })?;
    let curves = by_frame(u, 0, 2, |u| {
        let paths = (0..count).map(|_| Ok(json_points(&points(u, 0, 4)?)));
        Ok(format!("[{}]", paths.collect::<Result<Vec<_>>>()?.join(", ")))
    })?;
    let wanted = format!("[{}, {}]", frame(u)?, frame(u)?);
    let depths = by_frame(u, 0, FRAMES, |u| Ok(json_number(number(u)?)))?;
    Ok([
        format!("\"confidence\": {confidence}"),
        format!("\"curves\": {curves}"),
        format!("\"wants_key\": {wanted}"),
        format!("\"depths\": {depths}"),
        format!("\"absent\": [[{}, {}]]", frame(u)?, frame(u)?),
    ])
}
