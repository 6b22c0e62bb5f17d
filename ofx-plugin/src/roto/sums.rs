//! Sums of an image's pixels, by which a later image of the same frame is recognised as another one.
//!
//! Each row is divided into segments of [`SEGMENT`] columns, and each segment has a sum of its bytes. Hosts give pieces of a
//! picture, for tiles and for what lies around the shapes, and the complete segments of each piece can be compared. Two
//! different segments have the same sum by a chance of 1 in 2³².

use crate::ofx::{Bounds, Image};
use crate::pixels::Format;

/// Columns of a segment. Segments begin at multiples of this.
const SEGMENT: i32 = 8;
const PRIME: u64 = 0x9e37_79b9_7f4a_7c15;

/// The sums of an image, and the properties that another image must share to be compared with it.
#[derive(Debug)]
pub struct Sums {
    format: Format,
    whole: Option<Bounds>,
    bounds: Bounds,
    /// Row by row from the bottom.
    sums: Vec<u32>,
}

impl Sums {
    /// The sums of an image.
    pub fn of(image: &Image) -> Self {
        let bounds = image.bounds;
        let mut sums = Vec::new();
        for y in bounds.y1..bounds.y2 {
            let row = segments(bounds).map(|[x1, x2]| image.row(y, x1, x2).map_or(0, sum));
            sums.extend(row);
        }
        Self { format: image.format, whole: image.whole, bounds, sums }
    }

    /// Whether another image shows the same picture at the same size and in the same format, so that its pixels can be compared.
    pub fn compares(&self, other: &Image) -> bool {
        (self.format, self.whole) == (other.format, other.whole)
    }

    /// Whether row `y` of another image differs from column `x1` to `x2`. Segments that are not completely in both are not compared.
    pub fn differs(&self, other: &Image, y: i32, x1: i32, x2: i32) -> bool {
        if !(self.bounds.y1..self.bounds.y2).contains(&y) {
            return false;
        }
        let count = segments(self.bounds).count();
        let row = &self.sums[(y - self.bounds.y1) as usize * count..][..count];
        let changed = |([from, to], known): ([i32; 2], &u32)| {
            let inside = x1 <= from && to <= x2;
            inside && other.row(y, from, to).is_some_and(|bytes| sum(bytes) != *known)
        };
        segments(self.bounds).zip(row).any(changed)
    }
}

/// First column and column after the last of each segment, which are cut off at the bounds.
fn segments(bounds: Bounds) -> impl Iterator<Item = [i32; 2]> {
    let first = bounds.x1.div_euclid(SEGMENT);
    let last = (bounds.x2 - 1).div_euclid(SEGMENT);
    (first..=last).map(move |k| [bounds.x1.max(k * SEGMENT), bounds.x2.min((k + 1).saturating_mul(SEGMENT))])
}

/// A sum of bytes. Each step but the last is reversible.
fn sum(bytes: &[u8]) -> u32 {
    let step = |sum: u64, word: [u8; 8]| (sum.rotate_left(29) ^ u64::from_le_bytes(word)).wrapping_mul(PRIME);
    let (words, last) = bytes.as_chunks::<8>();
    let mut end = [0; 8];
    end[..last.len()].copy_from_slice(last);
    let sum = words.iter().fold(bytes.len() as u64, |sum, word| step(sum, *word));
    (step(step(sum, end), [0; 8]) >> 32) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_changed_bit_changes_the_sum() {
        for length in [0, 1, 7, 8, 63, 64, 65, 200] {
            let bytes: Vec<u8> = (0..length).map(|k| (k * 37) as u8).collect();
            let plain = sum(&bytes);
            for bit in 0..8 * length {
                let mut other = bytes.clone();
                other[bit / 8] ^= 1 << (bit % 8);
                assert_ne!(sum(&other), plain, "bit {bit} of {length} bytes");
            }
            let longer: Vec<u8> = bytes.iter().copied().chain([0]).collect();
            assert_ne!(sum(&longer), plain, "a zero after {length} bytes");
        }
    }

    #[test]
    fn segments_cover_the_columns_and_begin_at_the_same_places() {
        let of = |x1, x2| segments(Bounds { x1, y1: 0, x2, y2: 1 }).collect::<Vec<_>>();
        assert_eq!(of(0, 16), [[0, 8], [8, 16]]);
        assert_eq!(of(-5, 10), [[-5, 0], [0, 8], [8, 10]]);
        assert_eq!(of(-16, -8), [[-16, -8]]);
    }
}
