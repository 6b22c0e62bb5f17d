//! The pixel types of the filters: a few `f32` channels next to each other.
//!
//! A filter that treats all channels alike runs over the flat channels of a row. The compiler vectorises this loop for
//! grey and coloured pictures.

/// A pixel made of `f32` channels.
pub trait Pixel: Copy + Send + Sync + 'static {
    /// Number of channels.
    const CHANNELS: usize;
    /// All channels zero.
    const ZERO: Self;

    /// The channels of the pixels, one after the other.
    fn flat(pixels: &[Self]) -> &[f32];

    /// The channels of the pixels, one after the other, for writing.
    fn flat_mut(pixels: &mut [Self]) -> &mut [f32];

    /// `self + weight * other`, channel by channel.
    fn plus(self, weight: f32, other: Self) -> Self;
}

impl Pixel for f32 {
    const CHANNELS: usize = 1;
    const ZERO: Self = 0.0;

    fn flat(pixels: &[Self]) -> &[f32] {
        pixels
    }

    fn flat_mut(pixels: &mut [Self]) -> &mut [f32] {
        pixels
    }

    #[inline]
    fn plus(self, weight: f32, other: Self) -> Self {
        self + weight * other
    }
}

impl<const N: usize> Pixel for [f32; N] {
    const CHANNELS: usize = N;
    const ZERO: Self = [0.0; N];

    fn flat(pixels: &[Self]) -> &[f32] {
        pixels.as_flattened()
    }

    fn flat_mut(pixels: &mut [Self]) -> &mut [f32] {
        pixels.as_flattened_mut()
    }

    #[inline]
    fn plus(mut self, weight: f32, other: Self) -> Self {
        for channel in 0..N {
            self[channel] += weight * other[channel];
        }
        self
    }
}
