//! From the pixels of a skeleton to chains between its ends and forks.
//!
//! Two pixels are joined if they share a side, or a corner without a common neighbour that shares a side with both. With
//! this rule a chain has two neighbours everywhere, an end has one, and a fork has three or more.

use crate::thin::AROUND;
use rototoon_base::scene::Raster;

const NONE: u32 = u32::MAX;

/// The pixels of a skeleton with their neighbours.
pub struct Skeleton {
    /// Columns and rows.
    pub pixels: Vec<(usize, usize)>,
    /// Indices of the joined pixels.
    pub joined: Vec<Vec<u32>>,
}

/// Pixels from one end or fork to the next. A closed chain begins anywhere, and its last pixel joins the first.
pub struct Chain {
    /// Indices of pixels, both ends included.
    pub pixels: Vec<u32>,
    /// Whether it is a ring without ends and forks.
    pub closed: bool,
}

impl Skeleton {
    /// The skeleton in a mask that [`crate::thin`] made.
    pub fn new(mask: &Raster<bool>) -> Self {
        let (width, height) = (mask.width(), mask.height());
        let mut id = Raster::new(width, height, NONE);
        let mut pixels = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            if mask.get(x, y) {
                id.set(x, y, pixels.len() as u32);
                pixels.push((x, y));
            }
        }
        let at = |x: usize, y: usize, (dx, dy): (isize, isize)| {
            let (u, v) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
            if u < width && v < height { id.get(u, v) } else { NONE }
        };
        let joined = pixels.iter().map(|&(x, y)| {
            let near = AROUND.map(|step| at(x, y, step));
            let kept =
                |&k: &usize| near[k] != NONE && (k % 2 == 0 || (near[k - 1] == NONE && near[(k + 1) % 8] == NONE));
            (0..8).filter(kept).map(|k| near[k]).collect()
        });
        Self { joined: joined.collect(), pixels }
    }

    fn degree(&self, pixel: u32) -> usize {
        self.joined[pixel as usize].len()
    }

    /// All chains. A pixel without neighbours is a chain of one.
    pub fn chains(&self) -> Vec<Chain> {
        let mut chains = Vec::new();
        let mut walked = vec![false; self.pixels.len()];
        for start in (0..self.pixels.len() as u32).filter(|&pixel| self.degree(pixel) != 2) {
            walked[start as usize] = true;
            if self.degree(start) == 0 {
                chains.push(Chain { pixels: vec![start], closed: false });
            }
            for &second in &self.joined[start as usize] {
                // A chain between two forks is found from both of them; one without pixels between from the lesser.
                let direct = self.degree(second) != 2;
                if if direct { second > start } else { !walked[second as usize] } {
                    chains.push(Chain { pixels: self.walk(start, second, &mut walked), closed: false });
                }
            }
        }
        for start in 0..self.pixels.len() as u32 {
            if !walked[start as usize] {
                walked[start as usize] = true;
                let mut pixels = self.walk(start, self.joined[start as usize][0], &mut walked);
                pixels.pop();
                chains.push(Chain { pixels, closed: true });
            }
        }
        chains
    }

    /// From `start` through `next` to the next end or fork, or back to `start`.
    fn walk(&self, start: u32, next: u32, walked: &mut [bool]) -> Vec<u32> {
        let mut pixels = vec![start, next];
        let (mut before, mut here) = (start, next);
        while here != start && self.degree(here) == 2 {
            walked[here as usize] = true;
            let near = &self.joined[here as usize];
            (before, here) = (here, if near[0] == before { near[1] } else { near[0] });
            pixels.push(here);
        }
        pixels
    }
}
