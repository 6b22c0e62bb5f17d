//! Exact Manhattan distance to the nearest edge.
//!
//! The Manhattan distance |Δx| + |Δy| is a sum of one term per axis. The transform therefore has two passes (Rosenfeld
//! & Pfaltz, "Sequential operations in digital picture processing", 1966; Felzenszwalb & Huttenlocher, "Distance
//! transforms of sampled functions", 2012, §4). The first pass finds the distance along each row to the nearest edge of
//! the row. The second pass finds, along each column, the minimum of that distance plus the number of rows between.
//! Rows are independent and run in parallel. The column pass sweeps complete rows down and up, which vectorises.
//!
//! Distances are between pixel centres, in pixels. **Without any edge** every pixel has the distance [`without_edge`].
//! This is farther than any edge of the picture could be, but finite, so an energy that reads it stays finite and has
//! no slope.

use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSlice, ParallelSliceMut};
use rototoon_base::scene::Raster;

/// The distance used in a picture of this size without an edge: width + height, in pixels.
pub fn without_edge(width: usize, height: usize) -> f32 {
    (width + height) as f32
}

/// For each pixel the Manhattan distance to the nearest set pixel of `edges`, in pixels; [`without_edge`] where there
/// is none.
pub fn manhattan(edges: &Raster<bool>) -> Raster<f32> {
    let (width, height) = (edges.width(), edges.height());
    let far = without_edge(width, height);
    let mut out = Raster::new(width, height, far);
    if width == 0 || height == 0 {
        return out;
    }
    out.data_mut()
        .par_chunks_mut(width)
        .zip(edges.data().par_chunks(width))
        .for_each(|(out, edges)| along_row(edges, far, out));
    for y in 1..height {
        let (above, below) = out.data_mut().split_at_mut(y * width);
        step(&above[(y - 1) * width..], &mut below[..width]);
    }
    for y in (1..height).rev() {
        let (above, below) = out.data_mut().split_at_mut(y * width);
        step(&below[..width], &mut above[(y - 1) * width..]);
    }
    out
}

/// Distances within a row, at most `far`: counted from the left, then compared with the count from the right.
fn along_row(edges: &[bool], far: f32, out: &mut [f32]) {
    let cap = far as i32;
    let mut count = cap;
    for (out, &edge) in out.iter_mut().zip(edges) {
        count = if edge { 0 } else { (count + 1).min(cap) };
        *out = count as f32;
    }
    let mut count = cap;
    for (out, &edge) in out.iter_mut().zip(edges).rev() {
        count = if edge { 0 } else { (count + 1).min(cap) };
        *out = out.min(count as f32);
    }
}

/// Limits each distance to that of the neighbouring row plus one.
fn step(from: &[f32], to: &mut [f32]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = if from + 1.0 < *to { from + 1.0 } else { *to };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The definition: the minimum of the distances to all edges.
    fn naive(edges: &Raster<bool>) -> Raster<f32> {
        let pixels = || (0..edges.height()).flat_map(|y| (0..edges.width()).map(move |x| (x, y)));
        Raster::from_fn(edges.width(), edges.height(), |x, y| {
            let distances = pixels().filter(|&(i, j)| edges.get(i, j)).map(|(i, j)| x.abs_diff(i) + y.abs_diff(j));
            distances.min().map_or(without_edge(edges.width(), edges.height()), |d| d as f32)
        })
    }

    proptest! {
        #[test]
        fn equals_the_definition(width in 0usize..20, height in 0usize..20, seed: u64, one_in in 1u64..60) {
            let mut state = seed | 1;
            let edges = Raster::from_fn(width, height, |_, _| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33).is_multiple_of(one_in)
            });
            prop_assert_eq!(manhattan(&edges), naive(&edges));
        }
    }

    #[test]
    fn two_edges() {
        let edges = Raster::from_vec(5, 3, [0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1].map(|v| v != 0).to_vec());
        let want = [1, 2, 3, 3, 2, 0, 1, 2, 2, 1, 1, 2, 2, 1, 0].map(|v| v as f32);
        assert_eq!(manhattan(&edges.unwrap()).data(), want);
    }

    #[test]
    fn no_edge_is_far_but_finite() {
        assert_eq!(manhattan(&Raster::new(4, 3, false)), Raster::new(4, 3, 7.0));
    }
}
