//! Links between neighbouring control points, which preserve the shape of the keys.
//!
//! Points j and j + 1, j + 2, j + 4 are linked, with the weights 1, ½, ¼. Each link has a desired edge vector. For each
//! key it is the key's edge, rotated and scaled like the neighbourhood (±3 points) of either end between the key and
//! now. The two keys' vectors are averaged, weighted by time.
//!
//! A link has less weight if its edge does not fit the same rotation and scale from one key to the other: what bends
//! between the keys may bend.

use rototoon_base::geometry::Point;

/// Steps along the contour between linked points, and the weights of the links.
const STEPS: [(usize, f64); 3] = [(1, 1.0), (2, 0.5), (4, 0.25)];
/// Neighbours on either side to which a similarity is fitted.
const NEIGHBOURS: isize = 3;
/// Least share of the weight that a link keeps however much it bends, and the bend at which the rest is halved, in
/// working pixels.
const LOOSEST: f64 = 0.05;
const BENDING: f64 = 2.0;
/// Bounds of the scale of a neighbourhood.
const SCALE: (f64, f64) = (0.5, 2.0);

/// The links of a contour.
pub struct Links {
    /// Indices of both ends, and the weight.
    pub all: Vec<(usize, usize, f64)>,
    closed: bool,
}

impl Links {
    /// Links from the control points of both keys, in working pixels.
    pub fn new(keys: &[Vec<Point>; 2], closed: bool) -> Self {
        let count = keys[0].len();
        let turns = turns(&keys[0], &keys[1], closed);
        let mut all = Vec::new();
        for (step, weight) in STEPS {
            if step > 1 && step > count / 2 {
                continue;
            }
            for j in (0..count).filter(|j| closed || j + step < count) {
                let k = (j + step) % count;
                let edge = (turns[j] + turns[k]).rotate(keys[0][k] - keys[0][j]) * 0.5;
                let missed = (keys[1][k] - keys[1][j] - edge).length() / BENDING;
                all.push((j, k, weight * (LOOSEST + (1.0 - LOOSEST) / (1.0 + missed * missed))));
            }
        }
        Self { all, closed }
    }

    /// The desired edges of all links, for control points near `points`. `share` is the share of the time from the
    /// first key to the second.
    pub fn wanted(&self, keys: &[Vec<Point>; 2], points: &[Point], share: f64) -> Vec<Point> {
        let turns = [0, 1].map(|k: usize| turns(&keys[k], points, self.closed));
        let edge = |&(i, j, _): &(usize, usize, f64)| {
            let of = |k: usize| (turns[k][i] + turns[k][j]).rotate(keys[k][j] - keys[k][i]) * 0.5;
            of(0).lerp(of(1), share)
        };
        self.all.iter().map(edge).collect()
    }
}

/// Rotation and scale (as complex numbers) of the neighbourhood of each point from one contour to another.
fn turns(from: &[Point], to: &[Point], closed: bool) -> Vec<Point> {
    let count = from.len() as isize;
    let around = |j: isize| -> Vec<usize> {
        let offsets = if closed && 2 * NEIGHBOURS + 1 > count { 0..count } else { j - NEIGHBOURS..j + NEIGHBOURS + 1 };
        offsets.filter(|i| closed || (0..count).contains(i)).map(|i| i.rem_euclid(count) as usize).collect()
    };
    let turn = |j: isize| {
        let near = around(j);
        let share = 1.0 / near.len() as f64;
        let center = |of: &[Point]| near.iter().map(|&i| of[i]).sum::<Point>() * share;
        let (a, b) = (center(from), center(to));
        let (mut sum, mut norm) = (Point::ZERO, 1e-9);
        for &i in &near {
            let (p, q) = (from[i] - a, to[i] - b);
            sum += Point::new(p.dot(q), p.perp_dot(q));
            norm += p.length_squared();
        }
        let turn = sum / norm;
        let length = turn.length();
        if length > 1e-9 { turn * (length.clamp(SCALE.0, SCALE.1) / length) } else { Point::X }
    };
    (0..count).map(turn).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_keys_want_turned_edges_and_bent_links_are_loose() {
        let middle = Point::new(150.0, 7.0);
        let at = |k: i32| {
            if k < 20 { Point::new(15.0 * f64::from(k), 0.0) } else { Point::new(15.0 * f64::from(39 - k), 14.0) }
        };
        let bar: Vec<Point> = (0..40).map(at).collect();
        let turn = Point::from_angle(1.2);
        let bend = |p: Point| if p.x < middle.x { p } else { turn.rotate(p - middle) + middle };
        let bent: Vec<Point> = bar.iter().map(|&p| bend(p)).collect();
        let links = Links::new(&[bar.clone(), bar.clone()], true);
        assert!(links.all.iter().all(|(_, _, w)| [1.0, 0.5, 0.25].iter().any(|v| (v - w).abs() < 1e-9)));
        let turn = Point::from_angle(2.2) * 1.1;
        let now: Vec<Point> = bar.iter().map(|&p| turn.rotate(p) + Point::new(90.0, 5.0)).collect();
        for ((i, j, _), edge) in links.all.iter().zip(links.wanted(&[bar.clone(), bar.clone()], &now, 0.3)) {
            assert!(edge.distance(now[*j] - now[*i]) < 1e-9);
        }
        let loose = Links::new(&[bar.clone(), bent], true);
        let weight = |i: usize, j: usize| loose.all.iter().find(|l| (l.0, l.1) == (i, j)).unwrap().2;
        assert!(weight(9, 10) < 0.5 * weight(3, 4), "{} {}", weight(9, 10), weight(3, 4));
    }
}
