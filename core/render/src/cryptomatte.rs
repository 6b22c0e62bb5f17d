//! Cryptomatte layers: which parts (or painted regions) are in a pixel, and how much of it each covers. A keyer that reads the layers
//! recovers the matte of each part by its name, exactly even at antialiased and overlapping borders.
//!
//! The parts of each pixel are ranked by their visible area. A rank consists of two channels: the id of the part and
//! its coverage. Two ranks make a layer `CryptoObject00`, `CryptoObject01`, …, the first in red and green, the second
//! in blue and alpha. An id is the MurmurHash3_32 of the part's name, used as the bits of a float. If the exponent of
//! the hash is all zeros or all ones (denormal, infinite or not a number), its lowest bit is inverted. The file's
//! header contains the manifest, a JSON object of names and ids as eight hexadecimal digits, and the names of the
//! rules.
//!
//! There are six ranks, as is usual, and more if a pixel of the frame needs them, so no part is ever left out.
//!
//! Source: J. Friedman, A. C. Jones: Fully automatic ID mattes with support for motion blur and transparency. SIGGRAPH
//! posters, 2015. The Cryptomatte specification, version 1.2.

use super::form;
use super::layers::Attribute;
use super::streamed::Line;
use super::visible::{Share, Visible};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::rc::Rc;

/// Name of the layers, without their number.
pub const LAYER: &str = form::CRYPTOMATTE;
/// Least number of ranks.
const RANKS: usize = 6;

/// Two names have the same id, so a keyer cannot distinguish them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{first:?} and {second:?} have the same Cryptomatte id: expected another name for one of them")]
pub struct SameId {
    /// A name.
    pub first: String,
    /// Another one.
    pub second: String,
}

/// The MurmurHash3_32 of some bytes, with seed 0.
pub fn murmur3(bytes: &[u8]) -> u32 {
    murmur3::murmur3_32(&mut Cursor::new(bytes), 0).expect("bytes in memory can be read")
}

/// The id of a name: the bits of a finite, normal float.
pub fn id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    let exponent = hash >> 23 & 0xff;
    if exponent == 0 || exponent == 0xff { hash ^ 1 << 23 } else { hash }
}

/// The attributes of the file's header: name, rules and manifest of the layers, with the names of all that may be in them.
///
/// # Errors
///
/// [`SameId`] if two names have the same id.
pub fn attributes<'a>(names: impl Iterator<Item = &'a str>) -> Result<Vec<Attribute>, SameId> {
    let mut manifest = serde_json::Map::new();
    let mut ids: BTreeMap<u32, &str> = BTreeMap::new();
    for name in names {
        let id = id(name);
        // Several things may have one name: they are one matte.
        if let Some(first) = ids.insert(id, name).filter(|first| *first != name) {
            return Err(SameId { first: first.to_owned(), second: name.to_owned() });
        }
        manifest.insert(name.to_owned(), format!("{id:08x}").into());
    }
    let key = &format!("{:08x}", murmur3(LAYER.as_bytes()))[..7];
    let attribute = |field: &str, value: String| Attribute { name: format!("cryptomatte/{key}/{field}"), value };
    Ok(vec![
        attribute("name", LAYER.to_owned()),
        attribute("hash", "MurmurHash3_32".to_owned()),
        attribute("conversion", "uint32_to_float32".to_owned()),
        attribute("manifest", serde_json::Value::from(manifest).to_string()),
    ])
}

/// The channels of all ranks, line by line. `names` are those of the indices in `visible`.
pub(super) fn lines<'a>(names: &[&str], visible: &'a Visible) -> Vec<(String, Line<'a>)> {
    let ids = names.iter().map(|name| f32::from_bits(id(name))).collect();
    let ranks = visible.most().max(RANKS).next_multiple_of(2);
    let values = vec![vec![0.0; visible.width()]; 2 * ranks];
    let shared = Rc::new(RefCell::new(Row { visible, ids, y: None, values }));
    let names =
        (0..ranks / 2).flat_map(|layer| ["R", "G", "B", "A"].map(|channel| format!("{LAYER}{layer:02}.{channel}")));
    let line = |channel: usize| -> Line<'a> {
        let row = Rc::clone(&shared);
        Box::new(move |y, line| line.copy_from_slice(row.borrow_mut().channel(y, channel)))
    };
    names.enumerate().map(|(channel, name)| (name, line(channel))).collect()
}

/// The channels of a row of pixels. They are made together when the first one is asked for, because the ranks of a pixel are in all of them.
struct Row<'a> {
    visible: &'a Visible,
    /// The ids of all names.
    ids: Vec<f32>,
    /// The row that is there.
    y: Option<usize>,
    /// For each channel its values.
    values: Vec<Vec<f32>>,
}

impl Row<'_> {
    fn channel(&mut self, y: usize, channel: usize) -> &[f32] {
        if self.y != Some(y) {
            self.y = Some(y);
            self.fill(y);
        }
        &self.values[channel]
    }

    fn fill(&mut self, y: usize) {
        let Self { visible, ids, values, .. } = self;
        values.iter_mut().for_each(|line| line.fill(0.0));
        let mut ranked: Vec<Share> = Vec::new();
        for (x, pixel) in visible.row(y).enumerate() {
            ranked.clear();
            for share in pixel {
                match ranked.iter_mut().find(|own| ids[own.part].to_bits() == ids[share.part].to_bits()) {
                    Some(own) => own.coverage += share.coverage,
                    None => ranked.push(*share),
                }
            }
            // Of equal shares the nearer part comes first.
            ranked.sort_by(|a, b| b.coverage.total_cmp(&a.coverage));
            for (rank, share) in ranked.iter().enumerate() {
                values[2 * rank][x] = ids[share.part];
                values[2 * rank + 1][x] = share.coverage;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn things_of_one_name_are_one_matte() {
        let found = attributes(["coat", "hair", "coat"].into_iter()).unwrap();
        assert_eq!(found.len(), 4);
    }

    #[test]
    fn the_hash_has_its_published_values() {
        for (text, hash) in [
            ("", 0),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
    }

    #[test]
    fn the_header_names_all() {
        let found = attributes(["near \"arm\"", "été"].into_iter()).unwrap();
        assert!(found.iter().all(|attribute| attribute.name.len() < 32));
        let manifest: serde_json::Value = serde_json::from_str(&found[3].value).unwrap();
        assert_eq!(manifest.as_object().unwrap().len(), 2);
        assert_eq!(manifest["near \"arm\""], format!("{:08x}", id("near \"arm\"")));
        assert!(found[3].value.contains("été"));
        // These two have the same hash.
        assert_eq!(attributes(["leg 88781", "leg", "leg 112392"].into_iter()).unwrap_err().second, "leg 112392");
    }

    proptest! {
        #[test]
        fn an_id_is_a_normal_number(name in ".*") {
            prop_assert!(f32::from_bits(id(&name)).is_normal());
            prop_assert!((id(&name) ^ murmur3(name.as_bytes())) & !(1 << 23) == 0);
        }
    }
}
