//! Picture files of one format: Bmp.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_bmp(data: &[u8]) {
    pictures::read(data);
}
