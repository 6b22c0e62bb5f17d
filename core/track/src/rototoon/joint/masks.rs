//! Bit masks of hidden samples, for all pairs of hypotheses of a far and a near contender on one drawing of the far one.
//!
//! Most pairs of hypotheses do not touch each other, and a joint choice asks for masks many millions of times. So the masks
//! of a drawing are in one list of words, with an index of where each begins.

/// Where there is no mask.
const NONE: u32 = u32::MAX;

/// The masks of one drawing.
#[derive(Debug, Default, PartialEq)]
pub struct Masks {
    /// Number of the near contender's hypotheses.
    near: usize,
    /// By hypothesis of the far contender: words of a mask.
    lengths: Vec<u32>,
    /// By hypothesis of the far contender, then of the near one: where its mask begins.
    begins: Vec<u32>,
    words: Vec<u64>,
}

impl Masks {
    /// No masks yet, for a near contender with so many hypotheses on the drawing.
    pub fn new(near: usize) -> Self {
        Self { near, ..Self::default() }
    }

    /// Adds a hypothesis of the far contender whose masks have so many bits. `masks` are its masks by the near hypotheses;
    /// none where a near hypothesis hides no sample.
    pub fn push(&mut self, bits: usize, masks: impl Iterator<Item = Option<Vec<u64>>>) {
        self.lengths.push(bits.div_ceil(64) as u32);
        let end = self.begins.len() + self.near;
        for mask in masks {
            self.begins.push(mask.as_ref().map_or(NONE, |_| self.words.len() as u32));
            self.words.extend(mask.unwrap_or_default());
        }
        self.begins.resize(end, NONE);
    }

    /// Whether no near hypothesis hides a sample.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The samples of a far hypothesis that a near one hides. `None` if it hides none.
    pub fn get(&self, far: usize, near: usize) -> Option<&[u64]> {
        if near >= self.near {
            return None;
        }
        let begin = *self.begins.get(far * self.near + near).filter(|begin| **begin != NONE)? as usize;
        self.words.get(begin..begin + self.lengths[far] as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pair_has_its_mask() {
        let mut masks = Masks::new(2);
        masks.push(70, [None, Some(vec![5, 6])].into_iter());
        assert!(!masks.is_empty());
        masks.push(3, [Some(vec![7]), None].into_iter());
        masks.push(3, std::iter::empty());
        let found: Vec<Option<&[u64]>> = (0..4).flat_map(|far| [0, 1, 2].map(|near| masks.get(far, near))).collect();
        let [five, seven]: [&[u64]; 2] = [&[5, 6], &[7]];
        let none = [None; 3];
        assert_eq!(found, [[None, Some(five), None], [Some(seven), None, None], none, none].concat());
    }

    #[test]
    fn masks_of_nothing_are_empty() {
        let mut masks = Masks::new(1);
        masks.push(10, [None].into_iter());
        assert!(masks.is_empty() && Masks::default().is_empty());
    }
}
