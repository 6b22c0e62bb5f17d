//! Measures the overlap order inferred from sparse marks, on synthetic limbs.
//!
//! A figure is a few strips at random places of a square, which cross in many places. Its true depth order is random. The
//! order changes in the middle of twenty frames, where one limb moves from the back to the front, so marks are valid for
//! ranges of frames. A random share of the crossing pairs is marked. Depths are inferred from the marks, and every crossing
//! pair on every frame is compared with the truth. A tie counts as wrong. The alternative are marks between neighbours in
//! the true order, which are one fewer than there are limbs.

use super::Random;
use anyhow::Result;
use rototoon::geometry::Point;
use rototoon::reshape::depth::{Kin, Mark, infer};
use serde::Serialize;

/// Number of figures for each number of limbs.
const FIGURES: usize = 200;
/// Numbers of limbs.
const LIMBS: [usize; 3] = [6, 10, 14];
/// Shares of crossing pairs that are marked.
const SHARES: [f64; 7] = [0.0, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0];
/// Number of frames. The order changes in the middle.
const FRAMES: i32 = 20;

/// The measurement of one number of limbs and one share of marks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ordered {
    /// Number of limbs.
    pub limbs: usize,
    /// Share of crossing pairs that are marked; `None` for marks between neighbours in the true order.
    pub share: Option<f64>,
    /// Mean number of marks on a frame.
    pub marks: f64,
    /// Share of crossing pairs in the right order.
    pub right: f64,
}

struct Figure {
    crossing: Vec<(usize, usize)>,
    /// True depths before and after the change.
    depths: [Vec<usize>; 2],
}

/// Measures all numbers of limbs with all shares.
pub fn measure() -> Result<Vec<Ordered>> {
    let mut found = Vec::new();
    for limbs in LIMBS {
        let mut random = Random::new(limbs as u64);
        let figures: Vec<Figure> = (0..FIGURES).map(|_| figure(limbs, &mut random)).collect();
        for share in SHARES.map(Some).into_iter().chain([None]) {
            found.push(ordered(limbs, &figures, share, &mut random)?);
        }
    }
    Ok(found)
}

fn figure(limbs: usize, random: &mut Random) -> Figure {
    let mut strips = Vec::new();
    for _ in 0..limbs {
        let middle = Point::new(random.unit(), random.unit());
        let half = Point::from_angle(std::f64::consts::PI * random.unit()) * (0.2 + 0.2 * random.unit());
        strips.push((middle - half, middle + half));
    }
    let pairs = (0..limbs).flat_map(|a| (a + 1..limbs).map(move |b| (a, b)));
    let crossing = pairs.filter(|&(a, b)| cross(strips[a], strips[b])).collect();
    let mut before: Vec<usize> = (0..limbs).collect();
    random.shuffle(&mut before);
    // The limb at the back moves to the front. The others keep their order.
    let after = before.iter().map(|depth| if *depth == 0 { limbs - 1 } else { depth - 1 }).collect();
    Figure { crossing, depths: [before, after] }
}

fn cross(a: (Point, Point), b: (Point, Point)) -> bool {
    let side = |line: (Point, Point), p: Point| (line.1 - line.0).perp_dot(p - line.0) > 0.0;
    side(a, b.0) != side(a, b.1) && side(b, a.0) != side(b, a.1)
}

impl Figure {
    fn marks(&self, share: Option<f64>, random: &mut Random) -> Vec<Mark> {
        let mut marks = Vec::new();
        for (half, depths) in self.depths.iter().enumerate() {
            let first = half as i32 * FRAMES / 2;
            let mark = |(a, b): (usize, usize)| {
                let (front, behind) = if depths[a] > depths[b] { (a, b) } else { (b, a) };
                Mark { front, behind, first, last: first + FRAMES / 2 - 1 }
            };
            let chosen: Vec<(usize, usize)> = match share {
                Some(share) => {
                    let mut pairs = self.crossing.clone();
                    random.shuffle(&mut pairs);
                    pairs.truncate((share * pairs.len() as f64).round() as usize);
                    pairs
                }
                None => {
                    let mut order: Vec<usize> = (0..depths.len()).collect();
                    order.sort_by_key(|&limb| depths[limb]);
                    order.windows(2).map(|pair| (pair[0], pair[1])).collect()
                }
            };
            marks.extend(chosen.into_iter().map(mark));
        }
        marks
    }
}

fn ordered(limbs: usize, figures: &[Figure], share: Option<f64>, random: &mut Random) -> Result<Ordered> {
    let (mut right, mut all, mut count) = (0usize, 0usize, 0usize);
    for figure in figures {
        let marks = figure.marks(share, random);
        count += marks.len();
        for frame in 0..FRAMES {
            let found = infer(&vec![0.0; limbs], &marks, &Kin::default(), frame)?;
            let truth = &figure.depths[(frame >= FRAMES / 2) as usize];
            let is = |&&(a, b): &&(usize, usize)| {
                let (front, behind) = if truth[a] > truth[b] { (a, b) } else { (b, a) };
                found[front] > found[behind]
            };
            right += figure.crossing.iter().filter(is).count();
            all += figure.crossing.len();
        }
    }
    let marks = count as f64 / (2 * figures.len()) as f64;
    Ok(Ordered { limbs, share, marks, right: right as f64 / all.max(1) as f64 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_marks_give_the_full_order_and_no_marks_give_none() {
        let mut random = Random::new(3);
        let figures: Vec<Figure> = (0..5).map(|_| figure(8, &mut random)).collect();
        assert!(figures.iter().all(|figure| figure.crossing.len() > 1));
        for (share, right) in [(Some(0.0), 0.0), (Some(1.0), 1.0), (None, 1.0)] {
            assert_eq!(ordered(8, &figures, share, &mut random).unwrap().right, right);
        }
    }
}
