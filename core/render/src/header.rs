//! The headers of an OpenEXR file that is already encoded.
//!
//! A file begins with a magic number and its version. Then comes a header for each part: entries of name, type, size and value, and a zero after the last
//! entry. In a file of several parts an empty header follows the last one. Entries may stand in any order. What is changed here keeps
//! the length, so the places of the pixels stay right.
//!
//! Source: Technical Introduction to OpenEXR and OpenEXR File Layout, openexr.com.

use std::ops::Range;

/// Length of the magic number and the version.
const START: usize = 8;
/// The bit of the version's second byte that tells of several parts.
const SEVERAL: u8 = 0x10;
/// What comes before the width of a pixel divided by its height.
const PIXEL_ASPECT: &[u8] = b"pixelAspectRatio\0float\0\x04\0\0\0";

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
    use crate::layers::{Channel, encode, encode_parts};
    use exr::meta::MetaData;

    #[test]
    fn every_part_gets_the_aspect_and_nothing_else_changes() {
        let channels = || vec![Channel { name: "A".into(), values: vec![0.5; 6] }];
        let parts = vec![("a".to_owned(), channels()), ("b".to_owned(), channels())];
        for plain in [encode(3, 2, channels(), &[]).unwrap(), encode_parts(3, 2, parts).unwrap()] {
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
