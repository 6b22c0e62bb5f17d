//! OpenEXR files with any number of named channels of floats, in one part or in several, compressed without loss ([`super::form`]).
//!
//! A channel `near arm.A` belongs to the layer `near arm`; all readers of OpenEXR follow this rule. Part names may be
//! any text. Characters that separate layers or are not allowed in names are replaced ([`layer_name`]).

use super::encode::EncodeError;
use super::form::Form;
use super::header;
use exr::image::write::WritableImage;
use exr::image::write::layers::WritableLayers;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{Blocks, IntegerBounds};
use std::collections::{BTreeMap, BTreeSet};
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

/// Layer names of parts, in their order. A part whose name is a layer name keeps it; those that are changed get out of its way.
pub fn layer_names(names: &[&str], taken: &mut BTreeSet<String>) -> Vec<String> {
    let mut exact: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, name) in names.iter().enumerate() {
        if plain(name) == *name && !taken.contains(*name) {
            exact.entry(name).or_insert(k);
        }
    }
    taken.extend(exact.keys().map(|name| (*name).to_owned()));
    let keeps = |k: usize, name: &str| exact.get(name) == Some(&k);
    let each = names.iter().enumerate();
    each.map(|(k, name)| if keeps(k, name) { (*name).to_owned() } else { layer_name(name, taken) }).collect()
}

/// Converts a part's name to a layer name that is not in `taken`, and adds it there.
pub fn layer_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    let plain = plain(name);
    let numbered = (2..).map(|number| format!("{plain} {number}"));
    let free = std::iter::once(plain.clone()).chain(numbered).find(|name| !taken.contains(name));
    let chosen = free.unwrap_or(plain);
    taken.insert(chosen.clone());
    chosen
}

/// A name that a layer can have.
fn plain(name: &str) -> String {
    let mut plain: String = name.chars().map(|c| if c == '.' || c.is_control() { '_' } else { c }).collect();
    while plain.len() > LONGEST {
        plain.pop();
    }
    if plain.trim().is_empty() { "part".to_owned() } else { plain }
}

/// Encodes channels, each of `width` × `height` values, as OpenEXR.
///
/// # Errors
///
/// An [`EncodeError`] if a channel has another number of values or the encoder fails.
pub fn encode(
    (width, height): (usize, usize),
    channels: Vec<Channel>,
    attributes: &[Attribute],
    form: Form,
) -> Result<Vec<u8>, EncodeError> {
    let mut header = LayerAttributes::default();
    for Attribute { name, value } in attributes {
        header.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let layer = layer((width, height), channels, header, form)?;
    written((width, height), &Image::from_layer(layer))
}

/// Encodes pictures of `width` × `height` pixels as the parts of one OpenEXR file. Each has its own channels. The names must
/// differ. A reader that takes only one part of a file takes the first.
///
/// # Errors
///
/// An [`EncodeError`] if there is no part, two have the same name, a channel has another number of values, or the encoder
/// fails.
pub fn encode_parts(
    (width, height): (usize, usize),
    parts: Vec<(String, Vec<Channel>)>,
    form: Form,
) -> Result<Vec<u8>, EncodeError> {
    let failed = |reason: String| EncodeError { width, height, reason };
    let mut names = BTreeSet::new();
    if let Some((name, _)) = parts.iter().find(|(name, _)| !names.insert(name)) {
        return Err(failed(format!("two parts of the file have the name {name:?}")));
    }
    if parts.is_empty() {
        return Err(failed("found no part: expected at least one".to_owned()));
    }
    let part =
        |(name, channels): (String, _)| layer((width, height), channels, LayerAttributes::named(text(&name)), form);
    let layers: Vec<_> = parts.into_iter().map(part).collect::<Result<_, _>>()?;
    let shown = ImageAttributes::new(IntegerBounds::from_dimensions((width, height)));
    written((width, height), &Image::from_layers(shown, layers))
}

/// Text in UTF-8. All readers take the bytes as they are.
pub(super) fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

/// A part of a file, compressed without loss.
fn layer(
    (width, height): (usize, usize),
    channels: Vec<Channel>,
    header: LayerAttributes,
    form: Form,
) -> Result<Layer<AnyChannels<FlatSamples>>, EncodeError> {
    let mut list = Vec::new();
    for channel in channels {
        if channel.values.len() != width * height {
            let reason = format!("channel {:?} has {} values", channel.name, channel.values.len());
            return Err(EncodeError { width, height, reason });
        }
        list.push(AnyChannel::new(text(&channel.name), form.samples(&channel.name, channel.values)));
    }
    let encoding = Encoding {
        compression: form.packing.compression(),
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    Ok(Layer::new((width, height), header, encoding, AnyChannels::sort(list.into_iter().collect())))
}

/// The bytes of a file.
fn written<'a, L>((width, height): (usize, usize), image: &'a Image<L>) -> Result<Vec<u8>, EncodeError>
where
    L: WritableLayers<'a>,
{
    let failed = |reason: String| EncodeError { width, height, reason };
    let mut bytes = Cursor::new(Vec::new());
    let written = image.write().non_parallel().to_buffered(&mut bytes);
    written.map_err(|error| failed(error.to_string()))?;
    let mut bytes = bytes.into_inner();
    header::sort(&mut bytes).ok_or_else(|| failed("its header cannot be read again".to_owned()))?;
    Ok(bytes)
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
        let found = layer_names(&["a.b", "a_b", "rgba", "", "a_b", "part"], &mut BTreeSet::from(["rgba".to_owned()]));
        assert_eq!(found, ["a_b 2", "a_b", "rgba 2", "part 2", "a_b 3", "part"]);
    }

    #[test]
    fn the_same_picture_has_the_same_bytes() {
        let file = || {
            let channels = ["B", "near arm.A", "A"].map(|name| Channel { name: name.into(), values: vec![0.5; 12] });
            let attribute = |k: usize| Attribute { name: format!("n{k}"), value: format!("v{k}") };
            encode((4, 3), channels.into(), &(0..20).map(attribute).collect::<Vec<_>>(), Form::default()).unwrap()
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
    fn parts_of_a_file_keep_names_order_and_values() {
        let channel = |name: &str, value: f32| Channel { name: name.into(), values: vec![value; 12] };
        let file = || {
            let parts = vec![
                ("rgba".to_owned(), vec![channel("R", 0.25), channel("A", 0.5)]),
                ("près.1 \"x\"".to_owned(), vec![channel("A", 0.75)]),
                ("arm".to_owned(), vec![channel("A", 1.0)]),
            ];
            encode_parts((4, 3), parts, Form::default()).unwrap()
        };
        let first = file();
        assert!((0..8).all(|_| file() == first));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, &first).unwrap();
        let read = exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
        let found: Vec<_> = read
            .layer_data
            .iter()
            .map(|layer| {
                let name = String::from_utf8(layer.attributes.layer_name.as_ref().unwrap().as_slice().to_vec());
                let of = |c: &AnyChannel<FlatSamples>| (c.name.to_string(), c.sample_data.values_as_f32().next());
                (name.unwrap(), layer.channel_data.list.iter().map(of).collect::<Vec<_>>())
            })
            .collect();
        let one = |value| vec![("A".to_owned(), Some(value))];
        let expected = [
            ("rgba".to_owned(), vec![("A".to_owned(), Some(0.5)), ("R".to_owned(), Some(0.25))]),
            ("près.1 \"x\"".to_owned(), one(0.75)),
            ("arm".to_owned(), one(1.0)),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn parts_of_a_file_without_names_of_their_own_are_refused() {
        let part = |name: &str| (name.to_owned(), vec![Channel { name: "A".into(), values: vec![0.0; 4] }]);
        let told = |parts: Vec<_>| encode_parts((2, 2), parts, Form::default()).unwrap_err().to_string();
        assert!(told(vec![part("arm"), part("leg"), part("arm")]).contains("have the name \"arm\""));
        assert!(told(vec![]).contains("found no part"));
    }

    #[test]
    fn channels_of_another_size_are_refused() {
        let channel = Channel { name: "A".into(), values: vec![0.0; 3] };
        let error = encode((2, 2), vec![channel], &[], Form::default()).unwrap_err();
        assert!(error.to_string().contains("channel \"A\" has 3 values"), "{error}");
    }
}
