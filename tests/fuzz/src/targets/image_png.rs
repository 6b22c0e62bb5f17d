//! Picture files of one format: Png.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_png(data: &[u8]) {
    pictures::read(data);
}
