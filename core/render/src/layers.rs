//! OpenEXR files with any number of named channels of 32-bit floats, compressed without loss.
//!
//! A channel `near arm.A` belongs to the layer `near arm`; all readers of OpenEXR follow this rule. Part names may be
//! any text. Characters that separate layers or are not allowed in names are replaced ([`layer_name`]).

use super::encode::EncodeError;
use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{Blocks, Compression};
use std::collections::BTreeSet;
use std::io::Cursor;

/// A channel of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name, with the layer's name before the last full stop.
    pub name: String,
    /// Values row by row, from the top left.
    pub values: Vec<f32>,
}

/// A text attribute of the file's header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    /// Name of the attribute.
    pub name: String,
    /// Value of the attribute.
    pub value: String,
}

/// Greatest length of a layer name in bytes. Together with the name of a channel it is within the limit of a file.
const LONGEST: usize = 240;

/// Converts a part's name to a layer name that is not in `taken`, and adds it there.
pub fn layer_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    let mut plain: String = name.chars().map(|c| if c == '.' || c.is_control() { '_' } else { c }).collect();
    while plain.len() > LONGEST {
        plain.pop();
    }
    if plain.trim().is_empty() {
        plain = "part".to_owned();
    }
    let numbered = (2..).map(|number| format!("{plain} {number}"));
    let free = std::iter::once(plain.clone()).chain(numbered).find(|name| !taken.contains(name));
    let chosen = free.unwrap_or(plain);
    taken.insert(chosen.clone());
    chosen
}

/// Encodes channels, each of `width` × `height` values, as OpenEXR.
///
/// # Errors
///
/// An [`EncodeError`] if a channel has another number of values or the encoder fails.
pub fn encode(
    width: usize,
    height: usize,
    channels: Vec<Channel>,
    attributes: &[Attribute],
) -> Result<Vec<u8>, EncodeError> {
    let failed = |reason: String| EncodeError { width, height, reason };
    let text = |value: &str| Text::from_slice_unchecked(value.as_bytes());
    let mut list = Vec::new();
    for channel in channels {
        if channel.values.len() != width * height {
            return Err(failed(format!("channel {:?} has {} values", channel.name, channel.values.len())));
        }
        list.push(AnyChannel::new(text(&channel.name), FlatSamples::F32(channel.values)));
    }
    let mut header = LayerAttributes::default();
    for Attribute { name, value } in attributes {
        header.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let layer = Layer::new((width, height), header, encoding, AnyChannels::sort(list.into_iter().collect()));
    let mut bytes = Cursor::new(Vec::new());
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes);
    written.map_err(|error| failed(error.to_string()))?;
    let mut bytes = bytes.into_inner();
    sort_header(&mut bytes).ok_or_else(|| failed("its header cannot be read again".to_owned()))?;
    Ok(bytes)
}

/// Sorts the entries of the header by name. The encoder writes them in an order that changes between runs.
fn sort_header(bytes: &mut [u8]) -> Option<()> {
    /// Magic number and version.
    const START: usize = 8;
    let mut entries: Vec<&[u8]> = Vec::new();
    let mut at = START;
    while *bytes.get(at)? != 0 {
        let name = bytes[at..].iter().position(|byte| *byte == 0)? + 1;
        let kind = bytes[at + name..].iter().position(|byte| *byte == 0)? + 1;
        let size = bytes.get(at + name + kind..at + name + kind + 4)?;
        let size = u32::from_le_bytes([size[0], size[1], size[2], size[3]]) as usize;
        let end = at + name + kind + 4 + size;
        entries.push(bytes.get(at..end)?);
        at = end;
    }
    entries.sort();
    let sorted = entries.concat();
    bytes[START..at].copy_from_slice(&sorted);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_have_names_of_their_own() {
        let mut taken = BTreeSet::new();
        let names: Vec<_> = ["a.b", "a_b", "", " ", "\u{1}", "été"].map(|name| layer_name(name, &mut taken)).into();
        assert_eq!(names, ["a_b", "a_b 2", "part", "part 2", "_", "été"]);
        assert!(layer_name(&"é".repeat(300), &mut taken).len() <= LONGEST);
    }

    #[test]
    fn the_same_picture_has_the_same_bytes() {
        let file = || {
            let channels = ["B", "near arm.A", "A"].map(|name| Channel { name: name.into(), values: vec![0.5; 12] });
            let attribute = |k: usize| Attribute { name: format!("n{k}"), value: format!("v{k}") };
            encode(4, 3, channels.into(), &(0..20).map(attribute).collect::<Vec<_>>()).unwrap()
        };
        let first = file();
        assert!((0..8).all(|_| file() == first));
        let image = exr::prelude::read_all_flat_layers_from_file;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, &first).unwrap();
        let read = image(&path).unwrap();
        assert_eq!(read.layer_data.len(), 1);
        let names: Vec<String> = read.layer_data[0].channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "near arm.A"]);
        assert_eq!(read.layer_data[0].attributes.other.len(), 20);
    }

    #[test]
    fn channels_of_another_size_are_refused() {
        let channel = Channel { name: "A".into(), values: vec![0.0; 3] };
        let error = encode(2, 2, vec![channel], &[]).unwrap_err();
        assert!(error.to_string().contains("channel \"A\" has 3 values"), "{error}");
    }
}
