//! OpenEXR files whose pixels come line by line, in one part or in several.
//!
//! A file with the matte of each of hundreds of parts would fill memory if all its channels were there at once, and ids of a frame of 3840×2160 with 11 parts held 0.39 GB in that way. Here a channel is
//! asked for one line after the other, from the top. A block of lines is compressed without loss and written before the next one
//! is asked for. Otherwise the files are as those of [`super::layers`].

use super::encode::EncodeError;
use super::form::{Form, half};
use super::header;
use super::layers::{Attribute, text};
use exr::block::writer::{ChunksWriter, write_chunks_with};
use exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::error::UnitResult;
use exr::meta::BlockDescription;
use exr::meta::attribute::{AttributeValue, ChannelDescription, LineOrder, SampleType};
use exr::meta::header::{Header, LayerAttributes};
use std::io::Cursor;

/// Writes the values of a line, counted from 0 at the top. Lines come in their order, each once.
pub(super) type Line<'a> = Box<dyn FnMut(usize, &mut [f32]) + 'a>;

/// A part of a file.
pub(super) struct Part<'a> {
    /// Its name. The only part of a file needs none.
    pub name: Option<String>,
    /// Names of channels, and their values. The names differ.
    pub channels: Vec<(String, Line<'a>)>,
    /// Text attributes of its header.
    pub attributes: Vec<Attribute>,
}

/// Encodes pictures of `width` × `height` pixels as the parts of one OpenEXR file. Their names differ.
///
/// # Errors
///
/// An [`EncodeError`] if the encoder fails.
pub(super) fn encode(
    (width, height): (usize, usize),
    mut parts: Vec<Part>,
    form: Form,
) -> Result<Vec<u8>, EncodeError> {
    let failed = |reason: String| EncodeError { width, height, reason };
    for part in &mut parts {
        part.channels.sort_by(|a, b| a.0.as_bytes().cmp(b.0.as_bytes()));
    }
    let headers = parts.iter().map(|part| header_of(part, (width, height), form)).collect();
    let mut bytes = Cursor::new(Vec::new());
    let written = write_chunks_with(&mut bytes, headers, true, |meta, writer| -> UnitResult {
        let mut values = vec![0.0f32; width];
        for (index, block) in enumerate_ordered_header_block_indices(&meta.headers) {
            let mut problem = Ok(());
            let block = UncompressedBlock::from_lines(&meta.headers[block.layer].channels, block, |line| {
                let place = line.location;
                values.fill(0.0);
                (parts[place.layer].channels[place.channel].1)(place.position.y(), &mut values);
                let channel = &parts[place.layer].channels[place.channel].0;
                let written = match form.kind(channel) {
                    SampleType::F16 => line.write_samples(|at| half(values[at])),
                    _ => line.write_samples_from_slice(&values),
                };
                if let Err(error) = written {
                    problem = Err(error);
                }
            });
            problem?;
            writer.write_chunk(index, block.compress_to_chunk(&meta.headers)?)?;
        }
        Ok(())
    });
    written.map_err(|error| failed(error.to_string()))?;
    let mut bytes = bytes.into_inner();
    header::sort(&mut bytes).ok_or_else(|| failed("its header cannot be read again".to_owned()))?;
    Ok(bytes)
}

fn header_of(part: &Part, size: (usize, usize), form: Form) -> Header {
    let channel = |(name, _): &(String, Line)| ChannelDescription::named(text(name), form.kind(name));
    let mut own = part.name.as_ref().map_or_else(LayerAttributes::default, |name| LayerAttributes::named(text(name)));
    for Attribute { name, value } in &part.attributes {
        own.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    Header::new(text(""), size, part.channels.iter().map(channel).collect())
        .with_encoding(form.packing.compression(), BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::{Bits, Packing};
    use crate::layers::{self, Channel};

    fn value(channel: usize, x: usize, y: usize) -> f32 {
        (channel * 10_000 + y * 50 + x) as f32
    }

    #[test]
    fn files_are_those_of_whole_pictures() {
        let (width, height) = (7, 40);
        let names = [vec!["R", "G", "B", "A", "é.A", "arm.A"], vec!["A"], vec!["A"]];
        let line = |channel: usize| -> Line<'static> {
            let mut next = 0;
            Box::new(move |y, row| {
                assert_eq!(y, next);
                next += 1;
                row.iter_mut().enumerate().for_each(|(x, own)| *own = value(channel, x, y));
            })
        };
        let whole = |channel: usize, name: &str| Channel {
            name: name.into(),
            values: (0..width * height).map(|at| value(channel, at % width, at / width)).collect(),
        };
        let streamed = |names: &[&str]| names.iter().enumerate().map(|(k, name)| ((*name).into(), line(k))).collect();
        let kept = |names: &[&str]| names.iter().enumerate().map(|(k, name)| whole(k, name)).collect::<Vec<_>>();
        for form in
            Bits::ALL.map(|(bits, _)| Form { bits, packing: Packing::Zips }).into_iter().chain([Form::default()])
        {
            let attribute = |k: usize| Attribute { name: format!("n{k}"), value: format!("v{k}é") };
            let attributes: Vec<Attribute> = (0..9).map(attribute).collect();
            let own = Part { name: None, channels: streamed(&names[0]), attributes: attributes.clone() };
            let one = encode((width, height), vec![own], form).unwrap();
            assert!(one == layers::encode((width, height), kept(&names[0]), &attributes, form).unwrap(), "{form:?}");
            let parts = ["rgba", "a", "é"].iter().zip(&names);
            let part = |(name, names): (&&str, &Vec<&str>)| Part {
                name: Some((*name).into()),
                channels: streamed(names),
                attributes: Vec::new(),
            };
            let several = encode((width, height), parts.clone().map(part).collect(), form).unwrap();
            let expected = parts.map(|(name, names)| ((*name).to_owned(), kept(names))).collect();
            assert!(several == layers::encode_parts((width, height), expected, form).unwrap(), "{form:?}");
        }
    }
}
