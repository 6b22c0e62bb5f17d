//! The form of OpenEXR files: the bits of their numbers, and how blocks of lines are compressed. Every compression here keeps each bit.
//!
//! Numbers of 16 bits ("half") make files about half as large. They have 11 bits of precision: a coverage or a display colour between 0 and
//! 1 is at most 0.00025 away. Numbers beyond 65504, the greatest half, become that. Ids of Cryptomatte are the bits of numbers of 32 bits,
//! and its specification asks for 32 bits in all of its channels. So these keep them.
//!
//! Limits: compressions that lose something (B44, DWA, and PXR24 with 32 bits) are left out: mattes would not be exact.

use exr::image::FlatSamples;
use exr::meta::attribute::SampleType;
use exr::prelude::{Compression, f16};

/// What the names of the channels of Cryptomatte begin with.
pub(super) const CRYPTOMATTE: &str = "CryptoObject";

/// The bits of a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 32 bits.
    #[default]
    Float,
    /// 16 bits.
    Half,
}

/// How the lines of a file are compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Packing {
    /// Deflate, 16 lines at a time.
    #[default]
    Zip,
    /// Deflate, each line by itself: quicker to read in programs that work line by line.
    Zips,
    /// Wavelets, 32 lines at a time: small files of pictures with grain.
    Piz,
    /// Runs of equal bytes.
    Rle,
    /// Nothing.
    None,
}

/// The form of an OpenEXR file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// The bits of all numbers but those of Cryptomatte.
    pub bits: Bits,
    /// How its lines are compressed.
    pub packing: Packing,
}

impl Bits {
    /// All with their ids.
    pub const ALL: [(Self, &str); 2] = [(Self::Float, "float"), (Self::Half, "half")];

    /// Those with this id; `None` if there are none.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(bits, _)| *bits)
    }
}

impl Packing {
    /// All with their ids.
    pub const ALL: [(Self, &str); 5] =
        [(Self::Zip, "zip"), (Self::Zips, "zips"), (Self::Piz, "piz"), (Self::Rle, "rle"), (Self::None, "none")];

    /// The one with this id; `None` if there is none.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(packing, _)| *packing)
    }

    pub(super) fn compression(self) -> Compression {
        match self {
            Self::Zip => Compression::ZIP16,
            Self::Zips => Compression::ZIP1,
            Self::Piz => Compression::PIZ,
            Self::Rle => Compression::RLE,
            Self::None => Compression::Uncompressed,
        }
    }
}

impl Form {
    /// Whether the numbers of a channel have 16 bits.
    fn is_half(self, channel: &str) -> bool {
        self.bits == Bits::Half && !channel.starts_with(CRYPTOMATTE)
    }

    /// The kind of number in a channel.
    pub(super) fn kind(self, channel: &str) -> SampleType {
        if self.is_half(channel) { SampleType::F16 } else { SampleType::F32 }
    }

    /// The values of a channel.
    pub(super) fn samples(self, channel: &str, values: Vec<f32>) -> FlatSamples {
        if self.is_half(channel) {
            FlatSamples::F16(values.into_iter().map(half).collect())
        } else {
            FlatSamples::F32(values)
        }
    }
}

/// The nearest number of 16 bits.
pub(super) fn half(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::{Channel, encode};
    use exr::prelude::read_all_flat_layers_from_file;

    /// Names, kinds and bits of the channels of a file.
    fn read(bytes: &[u8]) -> (Compression, Vec<(String, SampleType, Vec<f32>)>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, bytes).unwrap();
        let image = read_all_flat_layers_from_file(&path).unwrap();
        let layer = &image.layer_data[0];
        let kind = |samples: &FlatSamples| match samples {
            FlatSamples::F16(_) => SampleType::F16,
            FlatSamples::F32(_) => SampleType::F32,
            FlatSamples::U32(_) => SampleType::U32,
        };
        let list = layer.channel_data.list.iter();
        let channels =
            list.map(|c| (c.name.to_string(), kind(&c.sample_data), c.sample_data.values_as_f32().collect()));
        (layer.encoding.compression, channels.collect())
    }

    #[test]
    fn every_packing_keeps_each_number_and_cryptomatte_has_all_its_bits() {
        let (width, height) = (37, 70);
        let noise = |seed: usize| (0..width * height).map(move |at| ((at * 7919 + seed) % 1013) as f32 / 1013.0);
        let ids: Vec<f32> =
            (0..width * height).map(|at| f32::from_bits(0x3f12_3457 + (at % 9) as u32 * 0x0101)).collect();
        for (packing, _) in Packing::ALL {
            for (bits, _) in Bits::ALL {
                let form = Form { bits, packing };
                let channels = vec![
                    Channel { name: "R".into(), values: noise(3).map(|v| v * 1e6).collect() },
                    Channel { name: "CryptoObject00.R".into(), values: ids.clone() },
                    Channel { name: "A".into(), values: noise(0).collect() },
                ];
                let file = encode((width, height), channels, &[], form).unwrap();
                let (found, read) = read(&file);
                assert_eq!(found, packing.compression());
                let names: Vec<(&str, SampleType)> = read.iter().map(|(name, kind, _)| (&name[..], *kind)).collect();
                let own = if bits == Bits::Half { SampleType::F16 } else { SampleType::F32 };
                assert_eq!(names, [("A", own), ("CryptoObject00.R", SampleType::F32), ("R", own)]);
                assert!(read[1].2.iter().zip(&ids).all(|(a, b)| a.to_bits() == b.to_bits()), "{form:?}");
                let kept = |value: f32| if bits == Bits::Half { half(value).to_f32() } else { value };
                assert!(noise(0).map(kept).eq(read[0].2.iter().copied()), "{form:?}");
                assert!(noise(3).map(|v| kept(v * 1e6)).eq(read[2].2.iter().copied()), "{form:?}");
                assert!(read[2].2.iter().all(|v| v.is_finite()), "what is too large for a half is the greatest one");
            }
        }
    }

    #[test]
    fn a_coverage_of_16_bits_is_as_near_as_is_said() {
        let worst =
            (0..=100_000).map(|k| k as f32 / 100_000.0).map(|v| (half(v).to_f32() - v).abs()).fold(0.0, f32::max);
        assert!(worst < 0.00025, "{worst}");
    }
}
