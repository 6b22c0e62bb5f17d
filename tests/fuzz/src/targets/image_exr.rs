//! Picture files of one format: OpenExr.

use crate::pictures;

/// Reads the bytes as a picture file.
pub fn image_exr(data: &[u8]) {
    pictures::read(data);
}
