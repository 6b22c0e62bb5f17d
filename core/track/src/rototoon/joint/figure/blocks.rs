//! Sets of blocks of a picture: one bit per block, in rows of words from a corner on.

use rototoon_base::geometry::{Point, polygon};
use std::ops::Range;

/// Side of a block, in working pixels.
pub const BLOCK: f64 = 4.0;
const BITS: usize = u64::BITS as usize;

/// A set of blocks. Those outside its box are not in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blocks {
    /// First row of the box, and its first column in words.
    row: usize,
    word: usize,
    /// Words of a row.
    words: usize,
    bits: Vec<u64>,
}

impl Blocks {
    /// The blocks of a picture of `columns` × `rows` blocks for which `holds` is true.
    pub fn where_true((columns, rows): (usize, usize), holds: impl Fn(usize, usize) -> bool) -> Self {
        let words = columns.div_ceil(BITS);
        let mut bits = vec![0; words * rows];
        for y in 0..rows {
            for x in (0..columns).filter(|&x| holds(x, y)) {
                bits[y * words + x / BITS] |= 1 << (x % BITS);
            }
        }
        Self { row: 0, word: 0, words, bits }
    }

    /// The blocks whose centres are inside a closed contour (working pixels), in a picture of `columns` × `rows` blocks.
    pub fn inside(contour: &[Point], (columns, rows): (usize, usize)) -> Self {
        let scaled: Vec<Point> = contour.iter().map(|&p| p / BLOCK).collect();
        let Some((low, high)) = polygon::bounds(&scaled).filter(|(a, b)| a.is_finite() && b.is_finite()) else {
            return Self::default();
        };
        let within = |v: f64, most: usize| v.clamp(0.0, most as f64) as usize;
        let (row, end) = (within(low.y.floor(), rows), within(high.y.ceil(), rows));
        let word = within(low.x.floor(), columns) / BITS;
        let words = within(high.x.ceil(), columns).div_ceil(BITS).max(word) - word;
        let mut bits = vec![0; words * (end - row)];
        polygon::for_each_span(&scaled, columns, rows, |y, x0, x1| {
            for x in x0..x1 {
                bits[(y - row) * words + x / BITS - word] |= 1 << (x % BITS);
            }
        });
        Self { row, word, words, bits }
    }

    /// Number of blocks.
    pub fn count(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Takes out the blocks of another set.
    pub fn remove(&mut self, other: &Self) {
        let Some(both) = self.meet(other) else { return };
        for row in both.rows.clone() {
            let theirs = both.words_of(other, row);
            let own = both.range(self, row);
            self.bits[own].iter_mut().zip(theirs).for_each(|(own, theirs)| *own &= !theirs);
        }
    }

    /// The number of blocks that are in both sets.
    pub fn shared(&self, other: &Self) -> usize {
        let Some(both) = self.meet(other) else { return 0 };
        let of_row = |row: usize| {
            let words = both.words_of(self, row).iter().zip(both.words_of(other, row));
            words.map(|(a, b)| (a & b).count_ones() as usize).sum::<usize>()
        };
        both.rows.clone().map(of_row).sum()
    }

    /// The blocks that are in both sets.
    pub fn common(&self, other: &Self) -> Self {
        let mut common = Self { bits: vec![0; self.bits.len()], ..*self };
        let Some(both) = self.meet(other) else { return common };
        for row in both.rows.clone() {
            let words = both.words_of(self, row).iter().zip(both.words_of(other, row));
            let to = both.range(self, row);
            common.bits[to].iter_mut().zip(words).for_each(|(to, (a, b))| *to = a & b);
        }
        common
    }

    /// The rows and words that the boxes of both sets contain.
    fn meet(&self, other: &Self) -> Option<Both> {
        if self.words == 0 || other.words == 0 {
            return None;
        }
        let end = |set: &Self| set.row + set.bits.len() / set.words;
        let words = self.word.max(other.word)..(self.word + self.words).min(other.word + other.words);
        let rows = self.row.max(other.row)..end(self).min(end(other));
        (!words.is_empty() && !rows.is_empty()).then_some(Both { rows, words })
    }
}

/// What the boxes of two sets have in common: rows and words, counted in the picture.
struct Both {
    rows: Range<usize>,
    words: Range<usize>,
}

impl Both {
    /// Where the words of a row are in the bits of one of the sets.
    fn range(&self, set: &Blocks, row: usize) -> Range<usize> {
        let begin = (row - set.row) * set.words + self.words.start - set.word;
        begin..begin + self.words.len()
    }

    fn words_of<'a>(&self, set: &'a Blocks, row: usize) -> &'a [u64] {
        &set.bits[self.range(set, row)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: (usize, usize) = (150, 24);

    fn quad(x: f64, y: f64, width: f64, height: f64) -> Vec<Point> {
        [(0.0, 0.0), (1.0, 0.1), (1.0, 1.0), (-0.1, 0.9)]
            .map(|(u, v)| Point::new(x + u * width, y + v * height) * BLOCK)
            .to_vec()
    }

    /// The set block by block.
    fn cells(set: &Blocks) -> Vec<bool> {
        let has = |x: usize, y: usize| {
            let inside = y >= set.row && x / BITS >= set.word && x / BITS < set.word + set.words;
            let word = inside.then(|| set.bits.get((y - set.row) * set.words + x / BITS - set.word));
            word.flatten().is_some_and(|word| word >> (x % BITS) & 1 == 1)
        };
        (0..SIZE.0 * SIZE.1).map(|k| has(k % SIZE.0, k / SIZE.0)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Sets with boxes of any place agree with sets of single blocks, also beyond the picture.
        #[test]
        fn sets_behave_as_sets(
            a in (-20.0f64..150.0, -10.0f64..24.0, 0.5f64..90.0, 0.5f64..30.0),
            b in (-20.0f64..150.0, -10.0f64..24.0, 0.5f64..90.0, 0.5f64..30.0),
        ) {
            let (one, two) = (quad(a.0, a.1, a.2, a.3), quad(b.0, b.1, b.2, b.3));
            let (first, second) = (Blocks::inside(&one, SIZE), Blocks::inside(&two, SIZE));
            let inside = |contour: &[Point], k: usize| {
                let center = Point::new((k % SIZE.0) as f64 + 0.5, (k / SIZE.0) as f64 + 0.5) * BLOCK;
                polygon::contains(contour, center)
            };
            let (has, other) = (cells(&first), cells(&second));
            for k in 0..SIZE.0 * SIZE.1 {
                prop_assert_eq!(has[k], inside(&one, k));
            }
            let both = has.iter().zip(&other).filter(|(a, b)| **a && **b).count();
            prop_assert_eq!(first.count(), has.iter().filter(|h| **h).count());
            prop_assert_eq!(first.shared(&second), both);
            prop_assert_eq!(second.common(&first).count(), both);
            let mut rest = first.clone();
            rest.remove(&second);
            prop_assert_eq!(rest.count(), first.count() - both);
        }
    }

    #[test]
    fn contours_without_an_inside_have_no_blocks() {
        for contour in [vec![], vec![Point::ZERO; 3], vec![Point::new(f64::NAN, 1.0); 4], quad(500.0, 3.0, 9.0, 9.0)] {
            let set = Blocks::inside(&contour, SIZE);
            assert_eq!((set.count(), set.shared(&Blocks::where_true(SIZE, |_, _| true))), (0, 0));
        }
    }
}
