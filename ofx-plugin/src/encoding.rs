//! Conversion between the host's colours and display colours, which the core uses.

use crate::ofx::host;
use crate::pixels::Pixel;
use crate::pixels::{Depth, Format};
use rototoon::image::colour;
use rototoon::render::encode;

/// Beginnings of the names of hosts whose float pixels are linear light.
const LINEAR_HOSTS: [&str; 4] =
    ["uk.co.thefoundry.nuke", "fr.inria.Natron", "com.eyeonline.Fusion", "com.blackmagicdesign.Fusion"];

/// The encoding of an image of this host: linear light or display values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    linear: bool,
}

impl Encoding {
    /// The encoding of an image.
    pub fn of(format: &Format) -> Self {
        let name = host::name().unwrap_or_default();
        let linear = LINEAR_HOSTS.iter().any(|known| name.starts_with(known));
        Self { linear: linear && matches!(format.depth, Depth::Half | Depth::Float) }
    }

    /// Whether the image is linear light.
    pub fn is_linear(&self) -> bool {
        self.linear
    }

    /// Converts a value of the image to a display value (sRGB).
    pub fn shown(&self, value: f32) -> f32 {
        if self.linear { colour::encode(value) } else { value }
    }

    /// Converts a premultiplied pixel of the image to linear light.
    pub fn to_light(self, pixel: Pixel) -> Pixel {
        let [r, g, b, alpha] = pixel;
        if self.linear || alpha <= 0.0 {
            return pixel;
        }
        let [r, g, b] = [r, g, b].map(|value| colour::decode(value / alpha) * alpha);
        [r, g, b, alpha]
    }

    /// Converts a premultiplied pixel of linear light to one of the image.
    pub fn of_light(self, pixel: Pixel) -> Pixel {
        if self.linear { pixel } else { encode::displayed(pixel) }
    }

    /// Converts a display value (sRGB) to a value of the image.
    pub fn held(&self, value: f32) -> f32 {
        if self.linear { colour::decode(value) } else { value }
    }
}
