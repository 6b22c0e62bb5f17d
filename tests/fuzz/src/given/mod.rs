//! Values that are decoded from bytes, so that a fuzzer that changes bytes changes structure.
//!
//! Counts are small, so that a run is short. Numbers, names and frames are not limited. Most of them are ordinary, because
//! a document with a single impossible number is refused and reaches no stage.

pub mod clips;
pub mod document;
pub mod drawings;
pub mod limbs;

use arbitrary::{Result, Unstructured};
use rototoon::geometry::Point;
use rototoon::scene::Footage;
use std::borrow::Cow;

/// Numbers at which arithmetic breaks.
const ODD: [f64; 20] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    5e-324,
    -0.0,
    1e9,
    -1e9,
    1e6,
    -1e6,
    1e-9,
    1e15,
    0.1,
    1.0,
    0.5,
    4_294_967_296.0,
    -2_147_483_648.0,
    9_007_199_254_740_993.0,
];

/// Frames at the ends of their ranges.
const ODD_FRAMES: [i32; 8] = [i32::MIN, i32::MAX, i32::MIN + 1, i32::MAX - 1, 1_000_000_000, -1_000_000_000, -1, 100];

/// Names that formats and programs trip over.
const NAMES: [&str; 10] = ["near arm", "coat", "a", "", "a b", "\u{0}\u{1f}", "<&\"'>", "größe", "[x]{y};\n", "a,*"];

/// Width and height of the footage of decoded documents, in pixels.
pub const SIZE: [u32; 2] = [48, 40];

/// Any number: of uniform bytes one in 512 is odd, so that most documents have none.
pub fn number(u: &mut Unstructured) -> Result<f64> {
    let code: u16 = u.arbitrary()?;
    Ok(match code {
        0xFFC0.. => ODD[usize::from(code) % ODD.len()],
        0xFFA0..0xFFC0 => f64::from_bits(u.arbitrary()?),
        0xFF90..0xFFA0 => f64::from(u.arbitrary::<i32>()?),
        0xFF80..0xFF90 => f64::from(u.arbitrary::<i16>()?),
        _ => f64::from(code) / 1024.0,
    })
}

/// A point; now and then one that was there before, because repeated points are a case of their own.
pub fn point(u: &mut Unstructured) -> Result<Point> {
    Ok(Point::new(number(u)?, number(u)?))
}

/// At most `most` points, and at least `least`.
pub fn points(u: &mut Unstructured, least: usize, most: usize) -> Result<Vec<Point>> {
    let count = u.int_in_range(least..=most)?;
    let mut found: Vec<Point> = Vec::with_capacity(count);
    for _ in 0..count {
        let repeated = !found.is_empty() && u.ratio(1u8, 16)?;
        let next = if repeated { *u.choose(&found)? } else { point(u)? };
        found.push(next);
    }
    Ok(found)
}

/// Any frame, mostly one of the first six.
pub fn frame(u: &mut Unstructured) -> Result<i32> {
    Ok(match u.arbitrary::<u8>()? {
        255 => *u.choose(&ODD_FRAMES)?,
        254 => u.arbitrary()?,
        code => i32::from(code % 6),
    })
}

/// Any name, mostly one of the few that others have too.
pub fn name(u: &mut Unstructured) -> Result<String> {
    Ok(match u.int_in_range(0..=31u8)? {
        31 => {
            let count = u.int_in_range(0..=24usize)?;
            String::from_utf8_lossy(u.bytes(count.min(u.len()))?).into_owned()
        }
        30 => (*u.choose(&NAMES)?).to_owned(),
        _ => (*u.choose(&NAMES[..3])?).to_owned(),
    })
}

/// A footage of a few tiny frames, for readers that need one.
pub fn footage() -> Footage {
    Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 12.0, width: 48, height: 40, held: false }
}

/// The text of an input: the bytes themselves where they begin with `begins`, otherwise what `decode` makes of them.
///
/// So a seed can be a plain file, and the fuzzer changes both texts and structure.
pub fn text<'a>(
    data: &'a [u8],
    begins: &str,
    decode: impl FnOnce(&mut Unstructured<'a>) -> Result<String>,
) -> Cow<'a, str> {
    let (text, _) = text_and_rest(data, begins, decode);
    text
}

/// The same, and what is left of the input to decode options from. A plain text leaves nothing.
pub fn text_and_rest<'a>(
    data: &'a [u8],
    begins: &str,
    decode: impl FnOnce(&mut Unstructured<'a>) -> Result<String>,
) -> (Cow<'a, str>, Unstructured<'a>) {
    if data.starts_with(begins.as_bytes()) {
        return (String::from_utf8_lossy(data), Unstructured::new(&[]));
    }
    let mut u = Unstructured::new(data);
    let text = decode(&mut u).unwrap_or_default();
    (Cow::Owned(text), u)
}

/// A number as JSON. What JSON cannot say becomes null or a number that is too large.
pub(crate) fn json_number(value: f64) -> String {
    match value {
        v if v.is_nan() => "null".into(),
        v if v.is_infinite() => if v > 0.0 { "1e999" } else { "-1e999" }.into(),
        // This form has an exponent for large numbers, where the ordinary one has hundreds of digits.
        v => format!("{v:?}"),
    }
}

/// A text as JSON.
pub(crate) fn json_text(value: &str) -> String {
    serde_json::Value::from(value).to_string()
}

/// Points as JSON.
pub(crate) fn json_points(points: &[Point]) -> String {
    let pairs: Vec<String> = points.iter().map(|p| format!("[{}, {}]", json_number(p.x), json_number(p.y))).collect();
    format!("[{}]", pairs.join(", "))
}

/// A list as JSON: `least` to `most` items.
pub(crate) fn list(
    u: &mut Unstructured,
    least: usize,
    most: usize,
    mut item: impl FnMut(&mut Unstructured) -> Result<String>,
) -> Result<String> {
    let count = u.int_in_range(least..=most)?;
    let items = (0..count).map(|_| item(u)).collect::<Result<Vec<_>>>()?;
    Ok(format!("[{}]", items.join(", ")))
}

/// An object with frames as names: mostly ascending ones, `least` to `most`.
pub(crate) fn by_frame(
    u: &mut Unstructured,
    least: usize,
    most: usize,
    mut value: impl FnMut(&mut Unstructured) -> Result<String>,
) -> Result<String> {
    let count = u.int_in_range(least..=most)?;
    // Most begin with the first frame, so that parts have contours on the same frames.
    let mut on = if count > 0 && u.ratio(1u8, 8)? { frame(u)? } else { 0 };
    let mut entries = Vec::with_capacity(count);
    for _ in 0..count {
        entries.push(format!("\"{on}\": {}", value(u)?));
        on = on.wrapping_add(u.int_in_range(1..=2)?);
    }
    Ok(format!("{{{}}}", entries.join(", ")))
}
