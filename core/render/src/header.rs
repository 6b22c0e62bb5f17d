//! The headers of an OpenEXR file that is already encoded.
//!
//! A file begins with a magic number and its version. Then comes a header for each part: entries of name, type, size and value, and a zero after the last
//! entry. In a file of several parts an empty header follows the last one. Entries may stand in any order. Behind the headers are the places
//! of the chunks of pixels, counted from the file's beginning, and then the chunks. So what makes headers longer moves these places.
//!
//! Source: Technical Introduction to OpenEXR, OpenEXR File Layout and Standard Attributes, openexr.com; the chromaticities of ITU-R BT.709.

use std::ops::Range;

/// Length of the magic number and the version.
const START: usize = 8;
/// The number that every OpenEXR file begins with.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Beginnings of entries that facts replace.
const REPLACED: [&[u8]; 4] = [b"pixelAspectRatio\0", b"chromaticities\0", b"framesPerSecond\0", b"timeCode\0"];
/// The bit of the version's second byte that tells of several parts.
const SEVERAL: u8 = 0x10;
/// What comes before the width of a pixel divided by its height.
const PIXEL_ASPECT: &[u8] = b"pixelAspectRatio\0float\0\x04\0\0\0";

/// CIE x and y of red, green, blue and white of ITU-R BT.709, which sRGB has too.
pub const BT709: [f32; 8] = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290];

/// What a header says of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    /// Width of a pixel divided by its height.
    pub pixel_aspect: f32,
    /// CIE x and y of red, green, blue and white.
    pub chromaticities: [f32; 8],
    /// Frames per second.
    pub fps: f64,
    /// SMPTE 12M time code: time and flags, then user data.
    pub time_code: Option<[u32; 2]>,
}

/// Says facts in each header of a file of the encoder ([`super::layers`]). Bytes that are no OpenEXR file stay as they are.
pub fn describe(bytes: Vec<u8>, facts: &Facts) -> Vec<u8> {
    described(&bytes, facts).unwrap_or(bytes)
}

fn described(bytes: &[u8], facts: &Facts) -> Option<Vec<u8>> {
    if !bytes.starts_with(&MAGIC) {
        return None;
    }
    let headers = headers(bytes)?;
    let several = bytes.get(5)? & SEVERAL != 0;
    let table = headers.last()?.last()?.end + if several { 2 } else { 1 };
    let place = |at: usize| bytes.get(at..)?.first_chunk::<8>().map(|own| u64::from_le_bytes(*own));
    // The chunks are in their order, and the first one follows the table.
    let chunks = usize::try_from(place(table)?).ok()?.checked_sub(table).filter(|length| length % 8 == 0)? / 8;
    let mut out = bytes[..START].to_vec();
    for header in &headers {
        let mut entries: Vec<Vec<u8>> = header.iter().map(|entry| bytes[entry.clone()].to_vec()).collect();
        entries.retain(|entry| !REPLACED.iter().any(|name| entry.starts_with(name)));
        entries.extend(told(facts));
        entries.sort();
        out.extend(entries.concat());
        out.push(0);
    }
    out.extend(several.then_some(0));
    let moved = out.len() as i64 - table as i64;
    for chunk in 0..chunks {
        out.extend(place(table + 8 * chunk)?.checked_add_signed(moved)?.to_le_bytes());
    }
    out.extend(bytes.get(table + 8 * chunks..)?);
    Some(out)
}

/// The entries of facts.
fn told(facts: &Facts) -> Vec<Vec<u8>> {
    let entry = |name: &str, kind: &str, value: &[u8]| {
        let size = (value.len() as u32).to_le_bytes();
        [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &size, value].concat()
    };
    let mut found = vec![
        entry("pixelAspectRatio", "float", &facts.pixel_aspect.to_le_bytes()),
        entry("chromaticities", "chromaticities", facts.chromaticities.map(f32::to_le_bytes).as_flattened()),
    ];
    if let Some((numerator, denominator)) = rational(facts.fps) {
        let value = [numerator.to_le_bytes(), denominator.to_le_bytes()];
        found.push(entry("framesPerSecond", "rational", value.as_flattened()));
    }
    if let Some(code) = facts.time_code {
        found.push(entry("timeCode", "timecode", code.map(u32::to_le_bytes).as_flattened()));
    }
    found
}

/// A number of frames per second as a fraction: whole, a whole number of thousands over 1001, or thousandths. `None` for what is no
/// such number.
fn rational(fps: f64) -> Option<(u32, u32)> {
    if !(1e-3..=1e6).contains(&fps) {
        return None;
    }
    let film = (fps * 1.001).round();
    if (fps - fps.round()).abs() < 1e-6 {
        Some((fps.round() as u32, 1))
    } else if film >= 1.0 && (fps - film * 1000.0 / 1001.0).abs() < 6e-3 {
        Some((film as u32 * 1000, 1001))
    } else {
        let (mut a, mut b) = ((fps * 1000.0).round() as u32, 1000);
        let whole = (a, b);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        Some((whole.0 / a, whole.1 / a))
    }
}

/// Sorts the entries of each header by name. The encoder writes them in an order that changes between runs. `None` if the bytes
/// are no such file.
pub(super) fn sort(bytes: &mut [u8]) -> Option<()> {
    for header in headers(bytes)? {
        let mut entries: Vec<&[u8]> = header.iter().map(|entry| &bytes[entry.clone()]).collect();
        entries.sort();
        let sorted = entries.concat();
        let start = header.first().map_or(0, |entry| entry.start);
        bytes[start..start + sorted.len()].copy_from_slice(&sorted);
    }
    Some(())
}

/// Sets the width of a pixel divided by its height. Bytes that are no OpenEXR file stay as they are.
pub fn set_pixel_aspect(bytes: &mut [u8], aspect: f32) {
    for entry in headers(bytes).into_iter().flatten().flatten() {
        if bytes[entry.clone()].starts_with(PIXEL_ASPECT) {
            bytes[entry.start + PIXEL_ASPECT.len()..entry.end].copy_from_slice(&aspect.to_le_bytes());
        }
    }
}

/// The places of the entries of each header.
fn headers(bytes: &[u8]) -> Option<Vec<Vec<Range<usize>>>> {
    let several = bytes.get(5)? & SEVERAL != 0;
    let (mut found, mut at) = (Vec::new(), START);
    loop {
        let mut header = Vec::new();
        while *bytes.get(at)? != 0 {
            let end = at + entry(bytes.get(at..)?)?;
            bytes.get(at..end)?;
            header.push(at..end);
            at = end;
        }
        found.push(header);
        at += 1;
        if !several || *bytes.get(at)? == 0 {
            return Some(found);
        }
    }
}

/// Length of the entry at the beginning of these bytes.
fn entry(bytes: &[u8]) -> Option<usize> {
    let name = bytes.iter().position(|byte| *byte == 0)? + 1;
    let kind = bytes[name..].iter().position(|byte| *byte == 0)? + 1;
    let size = bytes[name + kind..].first_chunk::<4>()?;
    (name + kind + 4).checked_add(usize::try_from(u32::from_le_bytes(*size)).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::Form;
    use crate::layers::{Channel, encode, encode_parts};
    use exr::meta::MetaData;
    use exr::prelude::{ReadChannels, ReadLayers};

    #[test]
    fn every_part_tells_the_facts_and_keeps_its_pixels() {
        let values: Vec<f32> = (0..40 * 70).map(|k| k as f32).collect();
        let channels = |name: &str| vec![Channel { name: name.into(), values: values.clone() }];
        let parts = vec![("a".to_owned(), channels("A")), ("b".to_owned(), channels("Z"))];
        let mut facts = Facts { pixel_aspect: 2.0, chromaticities: BT709, fps: 23.976, time_code: None };
        for plain in [
            encode((40, 70), channels("A"), &[], Form::default()).unwrap(),
            encode_parts((40, 70), parts, Form::default()).unwrap(),
        ] {
            let mut told = plain.clone();
            // Facts of a frame replace those of another one.
            for code in [Some([0x0102_0304, 7]), None, Some([0x1112_1314, 9])] {
                facts.time_code = code;
                told = describe(told, &facts);
                let read = exr::prelude::read()
                    .no_deep_data()
                    .largest_resolution_level()
                    .all_channels()
                    .all_layers()
                    .all_attributes()
                    .from_buffered(std::io::Cursor::new(&told))
                    .unwrap();
                let own = &read.attributes;
                assert_eq!(own.pixel_aspect, 2.0);
                let white = own.chromaticities.unwrap().white;
                assert_eq!([white.x(), white.y()], [0.3127, 0.3290]);
                let found =
                    own.time_code.map(|own| [own.pack_time_as_tv60_u32().unwrap(), own.pack_user_data_as_u32()]);
                assert_eq!(found, code);
                for layer in read.layer_data {
                    assert_eq!(layer.attributes.frames_per_second, Some((24000, 1001)));
                    assert!(layer.channel_data.list[0].sample_data.values_as_f32().eq(values.iter().copied()));
                }
            }
        }
        assert_eq!(describe(b"\x89PNG and more".to_vec(), &facts), b"\x89PNG and more");
        let whole = encode((40, 70), channels("A"), &[], Form::default()).unwrap();
        for end in 0..400 {
            assert_eq!(describe(whole[..end].to_vec(), &facts).get(..4), whole[..end].get(..4), "{end}");
        }
    }

    #[test]
    fn rates_are_fractions() {
        for (fps, expected) in [
            (24.0, (24, 1)),
            (23.976, (24000, 1001)),
            (24000.0 / 1001.0, (24000, 1001)),
            (29.97, (30000, 1001)),
            (59.94, (60000, 1001)),
            (12.5, (25, 2)),
            (0.5, (1, 2)),
            (0.004, (1, 250)),
        ] {
            assert_eq!(rational(fps), Some(expected), "{fps}");
        }
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(rational), [None; 4]);
    }

    #[test]
    fn every_part_gets_the_aspect_and_nothing_else_changes() {
        let channels = || vec![Channel { name: "A".into(), values: vec![0.5; 6] }];
        let parts = vec![("a".to_owned(), channels()), ("b".to_owned(), channels())];
        for plain in [
            encode((3, 2), channels(), &[], Form::default()).unwrap(),
            encode_parts((3, 2), parts, Form::default()).unwrap(),
        ] {
            let mut wide = plain.clone();
            set_pixel_aspect(&mut wide, 2.0);
            let meta = MetaData::read_from_buffered(&wide[..], true).unwrap();
            assert!(meta.headers.iter().all(|header| header.shared_attributes.pixel_aspect == 2.0));
            assert!(plain != wide);
            set_pixel_aspect(&mut wide, 1.0);
            assert_eq!(plain, wide);
        }
        for mut bytes in [vec![], vec![0; 9], b"\x89PNG and more".to_vec(), vec![1; 40]] {
            let before = bytes.clone();
            set_pixel_aspect(&mut bytes, 2.0);
            assert_eq!(before, bytes);
        }
    }
}
