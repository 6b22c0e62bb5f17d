//! Refuses OpenEXR files whose blocks are much larger than the picture.
//!
//! A decoder takes memory for a whole block, a tile or a band of up to 256 scan lines, as the header describes it, before it reads the
//! block. A header of a few hundred bytes could ask for any amount that way: a failed allocation ends the process. Sizes are compared
//! with the picture that is made, which is that of the display window; the window of the pixels may be of any size.

use super::error::DecodeError;
use exr::meta::{BlockDescription, Headers, MetaData, header::Header};
use rototoon_base::memory::{self, Bytes};
use std::io::Read;
use std::thread::available_parallelism;

/// A block may have this many bytes, whatever the size of the picture: 2048 × 2048 pixels of four floats.
const MOST_BLOCK_BYTES: u64 = 64 << 20;

/// Reads the header of an OpenEXR file and looks at the blocks of all its parts, since a decoder may walk through all of them.
///
/// # Errors
///
/// A header that cannot be read, and blocks that need more memory than the picture does and than [`MOST_BLOCK_BYTES`], or than the
/// system grants.
pub fn check(file: &mut impl Read) -> Result<(), DecodeError> {
    headers(file)?.iter().try_for_each(check_part)
}

/// The headers of the parts of a file.
///
/// # Errors
///
/// A header that cannot be read.
pub fn headers(file: &mut impl Read) -> Result<Headers, DecodeError> {
    let meta = MetaData::read_from_buffered(file, false).map_err(|error| DecodeError::unreadable(&error))?;
    Ok(meta.headers)
}

fn check_part(header: &Header) -> Result<(), DecodeError> {
    let bytes = |width: usize, height: usize| {
        let pixels = (width as u64).saturating_mul(height as u64);
        pixels.saturating_mul(header.channels.bytes_per_pixel as u64)
    };
    let (what, width, height) = match header.blocks {
        BlockDescription::Tiles(tiles) => ("tiles", tiles.tile_size.width(), tiles.tile_size.height()),
        BlockDescription::ScanLines => {
            let lines = header.compression.scan_lines_per_block().min(header.layer_size.height());
            ("blocks", header.layer_size.width(), lines)
        }
    };
    let shown = header.shared_attributes.display_window.size;
    let most = MOST_BLOCK_BYTES.max(bytes(shown.width(), shown.height()));
    let found = bytes(width, height);
    let needed = || format!("{what} of {width}x{height} pixels need");
    if found > most {
        let reason = format!("{} {} of memory, expected at most {}", needed(), Bytes(found), Bytes(most));
        return Err(DecodeError::Unreadable(reason));
    }
    // Each thread has one block, two more wait, and each is there as compressed and as decoded.
    let threads = available_parallelism().map_or(1, usize::from);
    let at_once = header.chunk_count.min(threads + 2) as u64;
    memory::ask(found.saturating_mul(2 * at_once))
        .map_err(|error| DecodeError::Unreadable(format!("{} too much memory: {error}", needed())))
}

#[cfg(test)]
mod tests {
    use crate::decode::decode;
    use crate::error::DecodeError;
    use exr::prelude::{
        Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2, WritableImage,
    };

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

    /// A file of `width` × 16 pixels in one block of scan lines, of which a picture of 4 × 4 is shown.
    fn wide(width: usize) -> Vec<u8> {
        let channels = SpecificChannels::rgb(|at: Vec2<usize>| (at.x() as f32, 0.0f32, 1.0f32));
        let blocks = Blocks::ScanLines;
        let encoding = Encoding { compression: Compression::ZIP16, blocks, line_order: LineOrder::Increasing };
        let layer = Layer::new((width, 16), LayerAttributes::default(), encoding, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.display_window.size = Vec2(4, 4);
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_small_file_with_huge_scan_lines_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        std::fs::write(&path, wide(64)).unwrap();
        assert!(decode(&path, Some((4, 4))).is_ok(), "pixels outside of the picture are no fault");
        let width = 500_000;
        std::fs::write(&path, wide(width)).unwrap();
        let Err(DecodeError::Unreadable(reason)) = decode(&path, Some((4, 4))) else { panic!() };
        assert_eq!(reason, "blocks of 500000x16 pixels need 96 MB of memory, expected at most 68 MB");
    }
}
