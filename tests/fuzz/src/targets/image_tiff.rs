//! Picture files of one format: Tiff.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_tiff(data: &[u8]) {
    pictures::read(data);
}
