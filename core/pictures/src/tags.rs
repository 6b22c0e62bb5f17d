//! What the tags of a TIFF file say of its pixels: whether its colours are multiplied by alpha, of what kind its numbers are, and
//! in which order its bits.
//!
//! The tag `ExtraSamples` says it: 1 is alpha that the colours are multiplied by, 2 is alpha that they are not. Programs that composite write 1, as
//! OpenImageIO does without being asked; painting programs write 2. With any other value the fourth channel
//! is not alpha, and the decoder leaves it out. Without the tag a fourth channel is alpha that the colours are not multiplied by.
//!
//! The decoder takes all numbers of 32 bits for floats, whatever `SampleFormat` says.

use std::io::{Read, Seek};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// The value of `ExtraSamples` for colours that are multiplied by alpha.
const ASSOCIATED: u16 = 1;
/// The value of `SampleFormat` for floats.
const FLOATS: u16 = 3;
/// The value of `FillOrder` for bytes whose first pixel is in the lowest bit.
const REVERSED: u16 = 2;
/// The value of `Compression` for JPEG.
const JPEG: u16 = 7;

/// Whether a file says that its colours are multiplied by alpha. A file that cannot be read does not: its decoder tells why.
pub fn multiplied(file: &mut (impl Read + Seek)) -> bool {
    let samples = Decoder::new(file).and_then(|mut file| file.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples));
    samples.ok().flatten().is_some_and(|samples| samples.first() == Some(&ASSOCIATED))
}

/// Whether a file has whole numbers of 32 bits, which the decoder would read as floats. A file that cannot be read has not: its
/// decoder tells why.
pub fn wide_whole_numbers(file: &mut (impl Read + Seek)) -> bool {
    let Ok(mut file) = Decoder::new(file) else { return false };
    let mut values = |tag| file.find_tag_unsigned_vec::<u16>(tag).ok().flatten().unwrap_or_default();
    let (bits, kinds) = (values(Tag::BitsPerSample), values(Tag::SampleFormat));
    // Without the tag, numbers are whole.
    bits.contains(&32) && !kinds.contains(&FLOATS)
}

/// Whether the bits in each byte of a file are in reversed order, of which the decoder takes no notice. Scanners and programs for faxes write
/// such files. JPEG in a TIFF file has an order of its own. A file that cannot be read has not: its decoder tells why.
pub fn reversed_bits(file: &mut (impl Read + Seek)) -> bool {
    let Ok(mut file) = Decoder::new(file) else { return false };
    let mut value = |tag| file.find_tag_unsigned::<u16>(tag).ok().flatten();
    value(Tag::FillOrder) == Some(REVERSED) && value(Tag::Compression) != Some(JPEG)
}

#[cfg(test)]
mod tests {
    use crate::decode::{decode, decode_layer, probe};
    use rototoon_image::colour::decode as to_light;
    use std::fs::File;
    use std::path::Path;
    use tiff::encoder::colortype::{ColorType, Gray8, RGB8, RGBA8, RGBA16, RGBA32, RGBA32Float};
    use tiff::encoder::{TiffEncoder, TiffValue};
    use tiff::tags::Tag;

    /// A file of one pixel.
    fn write<C: ColorType>(path: &Path, pixel: [C::Inner; 4], samples: u16)
    where
        [C::Inner]: TiffValue,
    {
        let mut file = TiffEncoder::new(File::create(path).unwrap()).unwrap();
        let mut image = file.new_image::<C>(1, 1).unwrap();
        image.encoder().write_tag(Tag::ExtraSamples, &[samples][..]).unwrap();
        image.write_data(&pixel).unwrap();
    }

    #[test]
    fn colours_that_are_multiplied_by_alpha_are_told_by_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        // An alpha of 0.4, and a straight red of 0.5.
        let want = [0.4 * to_light(0.5), 0.0, 0.4, 0.4];
        let over = [0.5, 0.3, 0.7];
        let is = |what: &str| {
            let (layer, colour) =
                (decode_layer(&path, None).unwrap().get(0, 0), decode(&path, None).unwrap().get(0, 0));
            assert!(layer.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-3), "{what}: {layer:?} {want:?}");
            assert!(colour.iter().zip(over).all(|(a, b)| (a - b).abs() < 1e-3), "{what}: {colour:?} {over:?}");
        };
        write::<RGBA8>(&path, [51, 0, 102, 102], 1);
        is("multiplied");
        write::<RGBA16>(&path, [13107, 0, 26214, 26214], 1);
        is("multiplied, 16 bits");
        write::<RGBA16>(&path, [32768, 0, 65535, 26214], 2);
        is("straight");
        // Of a fourth channel nobody says what it is.
        write::<RGBA8>(&path, [51, 0, 102, 102], 0);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [to_light(0.2), 0.0, to_light(0.4), 1.0]);
        write::<RGBA32Float>(&path, [0.2, 0.0, 0.4, 0.4], 1);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [0.2, 0.0, 0.4, 0.4]);
        write::<RGBA32Float>(&path, [0.5, 0.0, 1.0, 0.4], 2);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [0.2, 0.0, 0.4, 0.4]);
        // Colours that are brighter than their alpha allows.
        write::<RGBA8>(&path, [255, 0, 0, 51], 1);
        assert_eq!(decode_layer(&path, None).unwrap().get(0, 0), [0.2, 0.0, 0.0, 0.2]);
    }

    #[test]
    fn whole_numbers_of_32_bits_are_no_floats() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        write::<RGBA32>(&path, [u32::MAX / 2; 4], 2);
        let said = decode(&path, None).unwrap_err().to_string();
        assert!(said.contains("whole numbers of 32 bits"), "{said}");
    }

    #[test]
    fn reversed_bits_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        let write = |order: u16| {
            let mut file = TiffEncoder::new(File::create(&path).unwrap()).unwrap();
            let mut image = file.new_image::<Gray8>(2, 1).unwrap();
            image.encoder().write_tag(Tag::FillOrder, order).unwrap();
            image.write_data(&[255, 0]).unwrap();
        };
        write(1);
        assert_eq!(decode(&path, None).unwrap().data(), [[1.0; 3], [0.0; 3]]);
        write(2);
        let said = decode(&path, None).unwrap_err().to_string();
        assert!(said.contains("reversed bits (FillOrder 2)"), "{said}");
        assert_eq!(probe(&path).unwrap_err().to_string(), said);
    }

    #[test]
    fn big_tiff_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tif");
        let mut file = TiffEncoder::new_big(File::create(&path).unwrap()).unwrap();
        file.write_image::<RGB8>(2, 1, &[255, 0, 51, 0, 255, 0]).unwrap();
        assert_eq!(probe(&path), Ok((2, 1)));
        assert_eq!(decode(&path, None).unwrap().data(), [[1.0, 0.0, 0.2], [0.0, 1.0, 0.0]]);
    }
}
