//! Images of clips. They are released when dropped.
//!
//! Depth, components, bounds and bytes per row are read from each image and never assumed. In memory the first row may be
//! the bottom row or the top row.

use super::effect::Clip;
use super::failure::Failure;
use super::host::Suites;
use super::property::{Properties, call};
use crate::pixels::{Depth, Format, Layout, Premultiplication};
use openfx::sys::generic::core::{
    OfxPropertySetHandle, kOfxBitDepthByte, kOfxBitDepthFloat, kOfxBitDepthHalf, kOfxBitDepthShort,
};
use openfx::sys::image_effect_v1::image_effect::{
    kOfxImageComponentAlpha, kOfxImageComponentRGB, kOfxImageComponentRGBA, kOfxImageEffectPropComponents,
    kOfxImageEffectPropPixelDepth, kOfxImageEffectPropPreMultiplication, kOfxImageOpaque, kOfxImagePropBounds,
    kOfxImagePropData, kOfxImagePropRegionOfDefinition, kOfxImagePropRowBytes, kOfxImageUnPreMultiplied,
};
use std::marker::PhantomData;

/// A rectangle of pixels, y up. `x2` and `y2` are excluded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// First column.
    pub x1: i32,
    /// First row from the bottom.
    pub y1: i32,
    /// Column after the last.
    pub x2: i32,
    /// Row after the last.
    pub y2: i32,
}

impl Bounds {
    /// The intersection of two rectangles, which may be empty.
    pub fn shared(&self, other: &Self) -> Self {
        Self {
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
            x2: self.x2.min(other.x2),
            y2: self.y2.min(other.y2),
        }
    }

    /// Whether the rectangle has no pixels.
    pub fn is_empty(&self) -> bool {
        self.x1 >= self.x2 || self.y1 >= self.y2
    }

    /// The number of pixels in a row.
    pub fn width(&self) -> usize {
        (i64::from(self.x2) - i64::from(self.x1)).max(0) as usize
    }
}

/// An image of a clip. Dropping it releases it.
pub struct Image<'a> {
    handle: OfxPropertySetHandle,
    suites: Suites,
    data: *mut u8,
    row_bytes: isize,
    /// The rectangle of its pixels.
    pub bounds: Bounds,
    /// The rectangle of the complete picture in pixels, as the host says; `None` if it does not say.
    pub whole: Option<Bounds>,
    /// The format of its pixels.
    pub format: Format,
    clip: PhantomData<&'a ()>,
}

// SAFETY: the pixels are plain memory that the host does not touch until the image is released. Only `drop` uses the handle.
// Rows are shared for reading. Writing goes through `Rows`, which do not overlap.
unsafe impl Send for Image<'_> {}
// SAFETY: as above.
unsafe impl Sync for Image<'_> {}

impl Drop for Image<'_> {
    fn drop(&mut self) {
        let _ = call!(self.suites.effect, clipReleaseImage, self.handle);
    }
}

impl<'a> Image<'a> {
    pub(super) fn fetch(clip: &Clip<'a>, time: f64) -> Result<Option<Self>, Failure> {
        let mut handle = std::ptr::null_mut();
        let fetched = call!(clip.suites.effect, clipGetImage, clip.handle, time, std::ptr::null(), &mut handle);
        if fetched.is_err() || handle.is_null() {
            return Ok(None);
        }
        // From here on the image is released, even if an error follows.
        let mut image = Self {
            handle,
            suites: clip.suites,
            data: std::ptr::null_mut(),
            row_bytes: 0,
            bounds: Bounds::default(),
            whole: None,
            format: Format::default(),
            clip: PhantomData,
        };
        // SAFETY: the handle of the image, which is not released before `image` is dropped.
        let properties = unsafe { Properties::new(handle, clip.suites.property) };
        let [x1, y1, x2, y2] = properties.ints(kOfxImagePropBounds)?;
        image.bounds = Bounds { x1, y1, x2, y2 };
        let whole = properties.ints(kOfxImagePropRegionOfDefinition).ok();
        let whole = whole.map(|[x1, y1, x2, y2]| Bounds { x1, y1, x2, y2 });
        image.whole = whole.filter(|whole| !whole.is_empty());
        image.data = properties.pointer(kOfxImagePropData, 0)?.cast();
        image.row_bytes = properties.int(kOfxImagePropRowBytes, 0)? as isize;
        image.format = format(&properties)?;
        if image.bounds.is_empty() || image.data.is_null() {
            return Ok(None);
        }
        let needed = (image.bounds.width() * image.format.bytes()) as isize;
        if i64::from(y2) - i64::from(y1) > 1 && image.row_bytes.abs() < needed {
            let found = image.row_bytes;
            return Err(Failure::Format(format!("image: found {found} bytes per row, expected at least {needed}")));
        }
        Ok(Some(image))
    }

    /// The bytes of row `y` from column `x1` to `x2` (excluded). `None` if the image does not have all of them.
    pub fn row(&self, y: i32, x1: i32, x2: i32) -> Option<&[u8]> {
        let (start, length) = self.place(y, x1, x2)?;
        // SAFETY: `place` checks the row against the bounds that the host gave with the pointer. Writing needs `Rows` of a
        // mutable borrow of the image, so nothing is written during this borrow.
        Some(unsafe { std::slice::from_raw_parts(start, length) })
    }

    fn place(&self, y: i32, x1: i32, x2: i32) -> Option<(*mut u8, usize)> {
        let b = &self.bounds;
        if y < b.y1 || y >= b.y2 || x1 < b.x1 || x2 > b.x2 || x1 > x2 {
            return None;
        }
        let column = (x1 - b.x1) as usize * self.format.bytes();
        // SAFETY: row and column are within the bounds, so the address is within the image's memory.
        let start = unsafe { self.data.offset((y - b.y1) as isize * self.row_bytes).add(column) };
        Some((start, (x2 - x1) as usize * self.format.bytes()))
    }

    /// Divides the rows of a window into bands of at most `height` rows, which different threads may write. Pixels outside
    /// the image are left out.
    pub fn bands(&mut self, window: Bounds, height: i32) -> Vec<Rows<'_>> {
        let window = window.shared(&self.bounds);
        if window.is_empty() {
            return Vec::new();
        }
        let image = &*self;
        let bands = (window.y1..window.y2).step_by(height.max(1) as usize);
        bands
            .map(|y1| Rows { image, window: Bounds { y1, y2: window.y2.min(y1.saturating_add(height)), ..window } })
            .collect()
    }
}

/// Rows of an image that nobody else reads or writes.
pub struct Rows<'a> {
    image: &'a Image<'a>,
    /// The rectangle of the pixels.
    pub window: Bounds,
}

impl Rows<'_> {
    /// The format of the pixels.
    pub fn format(&self) -> Format {
        self.image.format
    }

    /// The bytes of row `y` of the window.
    pub fn row(&mut self, y: i32) -> Option<&mut [u8]> {
        let w = self.window;
        let (start, length) = (w.y1..w.y2).contains(&y).then(|| self.image.place(y, w.x1, w.x2)).flatten()?;
        // SAFETY: as in `Image::row`. Bands do not overlap, and this one is borrowed mutably.
        Some(unsafe { std::slice::from_raw_parts_mut(start, length) })
    }
}

fn format(properties: &Properties) -> Result<Format, Failure> {
    let depth = properties.text(kOfxImageEffectPropPixelDepth, 0)?;
    let layout = properties.text(kOfxImageEffectPropComponents, 0)?;
    let premultiplication = properties.text(kOfxImageEffectPropPreMultiplication, 0).unwrap_or_default();
    let is = |text: &str, name: &std::ffi::CStr| text.as_bytes() == name.to_bytes();
    let depth = match depth.as_str() {
        name if is(name, kOfxBitDepthByte) => Depth::Byte,
        name if is(name, kOfxBitDepthShort) => Depth::Short,
        name if is(name, kOfxBitDepthHalf) => Depth::Half,
        name if is(name, kOfxBitDepthFloat) => Depth::Float,
        other => {
            return Err(Failure::Format(format!("image: found depth {other:?}, expected byte, short, half or float")));
        }
    };
    let layout = match layout.as_str() {
        name if is(name, kOfxImageComponentRGBA) => Layout::Rgba,
        name if is(name, kOfxImageComponentRGB) => Layout::Rgb,
        name if is(name, kOfxImageComponentAlpha) => Layout::Alpha,
        other => {
            return Err(Failure::Format(format!("image: found components {other:?}, expected RGBA, RGB or alpha")));
        }
    };
    let premultiplication = match premultiplication.as_str() {
        name if is(name, kOfxImageOpaque) => Premultiplication::Opaque,
        name if is(name, kOfxImageUnPreMultiplied) => Premultiplication::Separate,
        _ => Premultiplication::Multiplied,
    };
    Ok(Format { depth, layout, premultiplication })
}
