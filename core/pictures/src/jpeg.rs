//! Whether a JPEG file is complete.
//!
//! Decoders fill the missing rest of a cut file with grey and report success. A tracker would take that grey for a
//! drawing. A complete file ends with the marker "end of image" (ITU-T T.81, B.1.1.3), so a file whose segments and
//! scans never lead to that marker is cut.
//!
//! The walk follows the lengths of segments, so the markers of a thumbnail inside of a segment do not count. It does not
//! decode the scans: damage inside of a scan is not found.

const END_OF_IMAGE: u8 = 0xD9;
const START_OF_SCAN: u8 = 0xDA;

/// Whether the segments and scans of a JPEG file lead to its end-of-image marker. Bytes after that marker are ignored.
pub fn complete(bytes: &[u8]) -> bool {
    let mut at = 0;
    while let Some(marker) = marker(bytes, &mut at) {
        match marker {
            END_OF_IMAGE => return true,
            // Start of image, restart markers and the marker for private use in arithmetic coding have no length.
            0x01 | 0xD0..=0xD8 => {}
            _ => {
                let Some(&[high, low]) = bytes.get(at..at + 2) else { return false };
                at += usize::from(u16::from_be_bytes([high, low]));
                if marker == START_OF_SCAN {
                    skip_scan(bytes, &mut at);
                }
            }
        }
    }
    false
}

/// The next marker from `at` on, which then is behind it.
fn marker(bytes: &[u8], at: &mut usize) -> Option<u8> {
    loop {
        let start = *at + bytes.get(*at..)?.iter().position(|byte| *byte == 0xFF)?;
        // Any number of 0xFF may precede a marker.
        let code = start + bytes[start..].iter().position(|byte| *byte != 0xFF)?;
        *at = code + 1;
        if bytes[code] != 0 {
            return Some(bytes[code]);
        }
    }
}

/// Moves `at` to the marker that ends a scan. In a scan 0xFF is followed by 0 or by a restart marker.
fn skip_scan(bytes: &[u8], at: &mut usize) {
    while let Some(pair) = bytes.get(*at..*at + 2) {
        if pair[0] == 0xFF && !matches!(pair[1], 0 | 0xD0..=0xD7 | 0xFF) {
            return;
        }
        *at += 1;
    }
    *at = bytes.len();
}

#[cfg(test)]
mod tests {
    use super::complete;
    use image::{ImageBuffer, Rgb};
    use proptest::prelude::{any, proptest};

    fn picture() -> Vec<u8> {
        let mut bytes = Vec::new();
        let noise = |x: u32, y: u32| (x * 31 + y * 77) as u8;
        let image = ImageBuffer::from_fn(40, 30, |x, y| Rgb([noise(x, y), noise(y, x), 90]));
        image.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Jpeg).unwrap();
        bytes
    }

    #[test]
    fn a_file_cut_anywhere_is_not_complete() {
        let whole = picture();
        assert!(complete(&whole));
        for length in 0..whole.len() {
            assert!(!complete(&whole[..length]), "{length} of {} bytes", whole.len());
        }
        assert!(complete(&[&whole[..], b"notes of a camera"].concat()));
    }

    #[test]
    fn the_end_of_a_thumbnail_does_not_count() {
        let whole = picture();
        let segment = [&[0xFF, 0xE1, 0, 6][..], &[0xFF, 0xD8, 0xFF, 0xD9]].concat();
        let with = [&whole[..2], &segment, &whole[2..]].concat();
        assert!(complete(&with));
        assert!(!complete(&with[..with.len() - 1]));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            complete(&[&[0xFF, 0xD8][..], &bytes].concat());
        }
    }
}
