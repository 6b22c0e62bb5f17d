//! Colours as the host has them, and as the screen shows them: core looks at the latter.

use crate::ofx::host;
use crate::pixels::{Depth, Format};
use rototoon::image::colour;

/// Hosts whose floats are light, not what the screen shows.
const LINEAR_HOSTS: [&str; 4] =
    ["uk.co.thefoundry.nuke", "fr.inria.Natron", "com.eyeonline.Fusion", "com.blackmagicdesign.Fusion"];

/// Whether an image of this host holds linear light.
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

    /// A value as the screen shows it.
    pub fn shown(&self, value: f32) -> f32 {
        if self.linear { colour::encode(value) } else { value }
    }

    /// The reverse.
    pub fn held(&self, value: f32) -> f32 {
        if self.linear { colour::decode(value) } else { value }
    }
}
