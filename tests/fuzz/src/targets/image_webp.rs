//! Picture files of one format: WebP.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_webp(data: &[u8]) {
    pictures::read(data);
}
