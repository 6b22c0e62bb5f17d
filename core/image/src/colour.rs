//! sRGB, luma and CIE Lab.
//!
//! - **sRGB** (IEC 61966-2-1): 0 to 1, encoded for the screen. [`encode`] turns light into it and [`decode`] turns it
//!   back. Outside 0 to 1 the curves continue, mirrored below 0, so that float pictures lose nothing.
//! - **Luma**: 0.299 R + 0.587 G + 0.114 B of the encoded values (ITU-R BT.601), the grey that edge detectors expect.
//! - **CIE Lab** (CIE 15) for the white of sRGB (D65): L from 0 to 100, a and b about −110 to 110. Equal distances look
//!   about equally different, which suits the matching of drawn colours.
//!
//! [`lab_picture`] is made for complete frames. It reads the decoding curve from a table and finds the cube root by
//! iteration. This vectorises and, unlike a system's mathematical library, gives the same bits on every system. It
//! agrees with the exact [`lab`] to 0.01.

use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSlice, ParallelSliceMut};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::{Colour, Raster};
use std::sync::LazyLock;

/// Linear light to an sRGB-encoded value.
#[inline]
pub fn encode(light: f32) -> f32 {
    let l = light.abs();
    let value = if l <= 0.003_130_8 { 12.92 * l } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
    value.copysign(light)
}

/// An sRGB-encoded value to linear light.
#[inline]
pub fn decode(value: f32) -> f32 {
    let v = value.abs();
    let light = if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    light.copysign(value)
}

/// The luma of an sRGB-encoded colour, on the same scale.
#[inline]
pub fn luma([r, g, b]: Colour) -> f32 {
    0.299 * r + 0.587 * g + 0.114 * b
}

/// The luma of each pixel of a picture.
pub fn luma_picture(picture: &Raster<Colour>) -> Raster<f32> {
    let mut out = Raster::new(picture.width(), picture.height(), 0.0);
    let pieces = out.data_mut().par_chunks_mut(PIECE).zip(picture.data().par_chunks(PIECE));
    pieces.for_each(|(out, pixels)| {
        for (out, &colour) in out.iter_mut().zip(pixels) {
            *out = luma(colour);
        }
    });
    out
}

/// Number of pixels in one task.
const PIECE: usize = 1 << 14;

/// Linear sRGB to X, Y and Z, each divided by that of the white. The rows sum to 1.
const TO_XYZ: [[f32; 3]; 3] =
    [[0.433_953, 0.376_219, 0.189_828], [0.212_671, 0.715_160, 0.072_169], [0.017_758, 0.109_477, 0.872_765]];

/// Value below which a tangent replaces the cube root of CIE Lab: (6/29)³.
const KNEE: f32 = 216.0 / 24389.0;
/// Slope of the tangent divided by 116: (29/3)³ / 116.
const TANGENT: f32 = 24389.0 / 27.0 / 116.0;

/// An sRGB-encoded colour in CIE Lab: L from 0 to 100, a, b.
pub fn lab(colour: Colour) -> [f32; 3] {
    let f = |t: f32| if t > KNEE { t.cbrt() } else { TANGENT * t + 16.0 / 116.0 };
    let light = colour.map(decode);
    let [x, y, z] = TO_XYZ.map(|row| f(row[0] * light[0] + row[1] * light[1] + row[2] * light[2]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Number of intervals of the decoding table over 0 to 1.
const TABLE: usize = 2040;

/// [`decode`] at i / 2040, so that all 8-bit values are entries of the table.
static DECODED: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=TABLE + 1).map(|i| decode((i as f64 / TABLE as f64) as f32)).collect());

/// Cube root of a positive number: an estimate from the exponent, then two steps of Halley's iteration.
#[inline(always)]
fn cbrt_fast(t: f32) -> f32 {
    let mut root = f32::from_bits(t.to_bits() / 3 + 0x2a51_1cd0);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * t) / (2.0 * cube + t);
    }
    root
}

/// A picture in CIE Lab, with colours clamped to 0 to 1. Each value is within 0.01 of [`lab`].
pub fn lab_picture(picture: &Raster<Colour>) -> Raster<[f32; 3]> {
    let table = DECODED.as_slice();
    let mut out = Raster::new(picture.width(), picture.height(), [0.0; 3]);
    let pieces = out.data_mut().par_chunks_mut(PIECE).zip(picture.data().par_chunks(PIECE));
    pieces.for_each(|(out, pixels)| {
        vectorised(
            #[inline(always)]
            || lab_piece(table, pixels, out),
        )
    });
    out
}

/// Number of pixels whose channels are computed side by side.
const GROUP: usize = 64;

/// The conversion of a few pixels. The table is read value by value; everything before and after it runs in vectors.
#[inline(always)]
fn lab_piece(table: &[f32], pixels: &[Colour], out: &mut [[f32; 3]]) {
    let mut values = [[0.0f32; 3]; GROUP];
    let mut light = [[0.0f32; GROUP]; 3];
    for (pixels, out) in pixels.chunks(GROUP).zip(out.chunks_mut(GROUP)) {
        values[..pixels.len()].copy_from_slice(pixels);
        let mut lows = [0i32; 3 * GROUP];
        let mut shares = [0.0f32; 3 * GROUP];
        for (i, value) in values.as_flattened().iter().enumerate() {
            let place = value.clamp(0.0, 1.0) * TABLE as f32;
            lows[i] = place as i32;
            shares[i] = place - lows[i] as f32;
        }
        for i in 0..GROUP {
            for c in 0..3 {
                let low = lows[3 * i + c] as usize;
                light[c][i] = table[low] + shares[3 * i + c] * (table[low + 1] - table[low]);
            }
        }
        let mut curved = [[0.0f32; GROUP]; 3];
        for (curved, row) in curved.iter_mut().zip(TO_XYZ) {
            for i in 0..GROUP {
                let t = row[0] * light[0][i] + row[1] * light[1][i] + row[2] * light[2][i];
                let (root, tangent) = (cbrt_fast(t), TANGENT * t + 16.0 / 116.0);
                curved[i] = if t > KNEE { root } else { tangent };
            }
        }
        let [x, y, z] = &curved;
        for (i, out) in out.iter_mut().enumerate() {
            *out = [116.0 * y[i] - 16.0, 500.0 * (x[i] - y[i]), 200.0 * (y[i] - z[i])];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: [f32; 3], b: [f32; 3], within: f32) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
    }

    #[test]
    fn known_colours() {
        assert!(close(lab([1.0, 1.0, 1.0]), [100.0, 0.0, 0.0], 0.02));
        assert!(close(lab([0.0, 0.0, 0.0]), [0.0, 0.0, 0.0], 1e-4));
        assert!(close(lab([1.0, 0.0, 0.0]), [53.24, 80.09, 67.20], 0.05), "{:?}", lab([1.0, 0.0, 0.0]));
        assert!(close(lab([0.0, 1.0, 0.0]), [87.73, -86.18, 83.18], 0.05), "{:?}", lab([0.0, 1.0, 0.0]));
        assert!(close(lab([0.0, 0.0, 1.0]), [32.30, 79.19, -107.86], 0.05), "{:?}", lab([0.0, 0.0, 1.0]));
        assert!((luma([1.0, 1.0, 1.0]) - 1.0).abs() < 1e-6);
        assert!((decode(0.5) - 0.214_041).abs() < 1e-5);
        assert!((encode(0.5) - 0.735_357).abs() < 1e-5);
    }

    proptest! {
        #[test]
        fn encoding_and_back(light in -4.0f32..4.0) {
            prop_assert!((decode(encode(light)) - light).abs() < 1e-5 * (1.0 + light.abs()));
        }

        #[test]
        fn fast_lab_is_lab(colours in prop::collection::vec(prop::array::uniform3(0.0f32..=1.0), 1..40)) {
            let picture = Raster::from_vec(colours.len(), 1, colours.clone()).unwrap();
            for (fast, colour) in lab_picture(&picture).data().iter().zip(colours) {
                prop_assert!(close(*fast, lab(colour), 0.01), "{fast:?} {:?}", lab(colour));
            }
        }

        #[test]
        fn fast_cube_root(t in 0.001f32..2.0) {
            prop_assert!((cbrt_fast(t) - t.cbrt()).abs() < 1e-6);
        }

        #[test]
        fn luma_of_each_pixel(colours in prop::collection::vec(prop::array::uniform3(0.0f32..=1.0), 1..40)) {
            let picture = Raster::from_vec(1, colours.len(), colours.clone()).unwrap();
            let wanted: Vec<_> = colours.iter().map(|&c| luma(c)).collect();
            prop_assert_eq!(luma_picture(&picture), Raster::from_vec(1, colours.len(), wanted).unwrap());
        }
    }
}
