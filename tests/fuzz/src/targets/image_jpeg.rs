//! Picture files of one format: Jpeg.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_jpeg(data: &[u8]) {
    pictures::read(data);
}
