//! Refuses OpenEXR files whose tiles are much larger than the picture.
//!
//! A decoder takes memory for one tile as its header describes it, before it reads the tile. A header of a few hundred
//! bytes could ask for any amount that way.

use super::error::DecodeError;
use exr::meta::{BlockDescription, Headers, MetaData, header::Header};
use rototoon_base::memory::Bytes;
use std::io::Read;

/// A tile may have this many bytes, whatever the size of the picture: 2048 × 2048 pixels of four floats.
const MOST_TILE_BYTES: u128 = 64 << 20;

/// Reads the header of an OpenEXR file and looks at its tiles.
///
/// # Errors
///
/// A header that cannot be read, and tiles that need more memory than the picture does and than [`MOST_TILE_BYTES`].
pub fn check(file: &mut impl Read) -> Result<(), DecodeError> {
    headers(file)?.iter().try_for_each(check_part)
}

/// The headers of the parts of a file.
///
/// # Errors
///
/// A header that cannot be read.
pub fn headers(file: &mut impl Read) -> Result<Headers, DecodeError> {
    let meta = MetaData::read_from_buffered(file, false).map_err(|e| DecodeError::Unreadable(e.to_string()))?;
    Ok(meta.headers)
}

fn check_part(header: &Header) -> Result<(), DecodeError> {
    let BlockDescription::Tiles(tiles) = header.blocks else { return Ok(()) };
    let bytes = |width: usize, height: usize| {
        (width as u128).saturating_mul(height as u128).saturating_mul(header.channels.bytes_per_pixel as u128)
    };
    let (width, height) = (tiles.tile_size.width(), tiles.tile_size.height());
    let most = MOST_TILE_BYTES.max(bytes(header.layer_size.width(), header.layer_size.height()));
    if bytes(width, height) <= most {
        return Ok(());
    }
    let [found, most] = [bytes(width, height), most].map(|bytes| Bytes(u64::try_from(bytes).unwrap_or(u64::MAX)));
    let reason = format!("tiles of {width}x{height} pixels need {found} of memory, expected at most {most}");
    Err(DecodeError::Unreadable(reason))
}

#[cfg(test)]
mod tests {
    use crate::decode::decode;
    use crate::error::DecodeError;
    use exr::prelude::{Blocks, Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage};

    /// A file of 4 × 4 pixels in one tile. The height of the tile in the header is replaced.
    fn file(height: u32) -> Vec<u8> {
        let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.x() as f32, 0.0f32, 1.0f32));
        let encoding = Encoding { blocks: Blocks::Tiles(Vec2(64, 64)), ..Encoding::FAST_LOSSLESS };
        let layer = Layer::new((4, 4), LayerAttributes::default(), encoding, channels);
        let mut bytes = std::io::Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        let mut bytes = bytes.into_inner();
        let name = b"tiledesc\0";
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len() + 8;
        assert_eq!(bytes[at..at + 4], 64u32.to_le_bytes());
        bytes[at..at + 4].copy_from_slice(&height.to_le_bytes());
        bytes
    }

    #[test]
    fn a_small_file_with_huge_tiles_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let read = |height: u32| {
            std::fs::write(&path, file(height)).unwrap();
            decode(&path, Some((4, 4)))
        };
        assert!(read(64).unwrap().get(0, 0)[2] > 0.999);
        assert!(read(4096).is_ok());
        for height in [0x0100_0040, 0x0700_0000] {
            let Err(DecodeError::Unreadable(reason)) = read(height) else { panic!("{height}") };
            assert!(reason.contains(&format!("tiles of 64x{height} pixels need")), "{reason}");
            assert!(reason.ends_with("expected at most 68 MB"), "{reason}");
        }
        assert!(read(u32::MAX).is_err());
    }
}
