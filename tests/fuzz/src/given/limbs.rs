//! The fields of a document that reshaping reads: limbs, swapped sides, depth marks.

use super::{by_frame, frame, json_number, json_text, list, number, point};
use arbitrary::{Result, Unstructured};
use rototoon::scene::skeleton::{COUNT, NAMES, PARENTS};

/// The parts that limbs lie on; the decoder of documents gives parts these names.
const PARTS: [&str; 3] = ["near arm", "coat", "a"];

/// Limbs, swaps and marks, as fields of a document.
pub fn limbs(u: &mut Unstructured) -> Result<String> {
    // Reshaping wants a torso. So there mostly is one, on the first part.
    let mut found: Vec<String> = Vec::new();
    for k in [1, 2] {
        if u.ratio(15u8, 16)? {
            found.push(limb(u, k)?);
        }
    }
    for _ in 0..u.int_in_range(0..=3usize)? {
        let k = u.int_in_range(1..=COUNT - 1)?;
        found.push(limb(u, k)?);
    }
    let swaps = list(u, 0, 1, range)?;
    let mut fields = vec![format!("\"limbs\": [{}]", found.join(", ")), format!("\"limb_swaps\": {swaps}")];
    if u.ratio(1u8, 8)? {
        fields.push(format!("\"depth_marks\": {}", list(u, 0, 3, mark)?));
    }
    Ok(fields.join(", "))
}

/// The limb that ends at key point `k`.
fn limb(u: &mut Unstructured, k: usize) -> Result<String> {
    let (from, to) = if u.ratio(1u8, 16)? { (k, PARENTS[k]) } else { (PARENTS[k], k) };
    let mut fields = vec![
        format!("\"from\": {}, \"to\": {}", json_text(NAMES[from]), json_text(NAMES[to])),
        format!("\"start\": {}", end(u)?),
        format!("\"end\": {}", end(u)?),
    ];
    if u.ratio(1u8, 4)? {
        let carried = |u: &mut Unstructured| {
            let part = json_text(u.choose(&PARTS)?);
            Ok(if u.arbitrary()? {
                part
            } else {
                format!("{{\"part\": {part}, \"turn\": {}}}", json_number(share(u)?))
            })
        };
        fields.push(format!("\"carries\": {}", list(u, 0, 3, carried)?));
    }
    if u.ratio(1u8, 4)? {
        fields.push(format!("\"bends\": {}", by_frame(u, 0, 3, place)?));
    }
    if u.ratio(1u8, 4)? {
        fields.push(format!("\"rigidity\": {}", json_number(number(u)?)));
    }
    Ok(format!("{{{}}}", fields.join(", ")))
}

fn end(u: &mut Unstructured) -> Result<String> {
    let points = format!("[{}, {}]", calibration(u)?, calibration(u)?);
    let share = if u.ratio(1u8, 4)? { format!(", \"share\": {}", json_number(share(u)?)) } else { String::new() };
    Ok(format!("{{\"points\": {points}{share}}}"))
}

fn calibration(u: &mut Unstructured) -> Result<String> {
    let part = json_text(if u.ratio(1u8, 8)? { u.choose(&PARTS)? } else { PARTS[0] });
    Ok(if u.ratio(3u8, 4)? {
        format!("{{\"part\": {part}, \"at\": {}}}", json_number(f64::from(u.int_in_range(0..=12u8)?) / 4.0))
    } else if u.arbitrary()? {
        format!("{{\"part\": {part}, \"at\": {}}}", json_number(number(u)?))
    } else {
        format!("{{\"part\": {part}, \"drawn\": {}}}", by_frame(u, 0, 3, place)?)
    })
}

/// Two frames, mostly the first one first.
fn range(u: &mut Unstructured) -> Result<String> {
    let (a, b) = (frame(u)?, frame(u)?);
    Ok(if u.ratio(1u8, 16)? { format!("[{a}, {b}]") } else { format!("[{}, {}]", a.min(b), a.max(b)) })
}

fn place(u: &mut Unstructured) -> Result<String> {
    let p = point(u)?;
    Ok(format!("[{}, {}]", json_number(p.x), json_number(p.y)))
}

fn share(u: &mut Unstructured) -> Result<f64> {
    if u.ratio(1u8, 64)? { number(u) } else { Ok(f64::from(u.arbitrary::<u8>()?) / 255.0) }
}

fn mark(u: &mut Unstructured) -> Result<String> {
    let (front, behind) = (json_text(u.choose(&PARTS[..2])?), json_text(u.choose(&PARTS[..2])?));
    let range =
        if u.arbitrary()? { format!(", \"first\": {}, \"last\": {}", frame(u)?, frame(u)?) } else { String::new() };
    Ok(format!("{{\"front\": {front}, \"behind\": {behind}{range}}}"))
}
