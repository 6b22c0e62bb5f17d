//! Thinning: the ink's skeleton, one pixel wide.
//!
//! Guo & Hall 1989, parallel thinning in two passes. Lines become 8-connected chains of pixels, ends stay, and no part of
//! the ink falls apart. Only pixels at the border of what is left are looked at, so the time is that of the ink's area.

use rototoon_base::scene::Raster;

/// The eight neighbours, clockwise from above.
pub const AROUND: [(isize, isize); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];

/// The skeleton of a mask. The picture's border counts as empty.
pub fn thinned(mask: &Raster<bool>) -> Raster<bool> {
    let (width, height) = (mask.width() + 2, mask.height() + 2);
    let mut ink = Raster::new(width, height, false);
    for y in 0..mask.height() {
        ink.row_mut(y + 1)[1..width - 1].copy_from_slice(mask.row(y));
    }
    let steps = AROUND.map(|(dx, dy)| dy * width as isize + dx);
    let data = ink.data_mut();
    let around = |data: &[bool], i: usize| {
        steps
            .iter()
            .enumerate()
            .fold(0usize, |bits, (k, &step)| bits | usize::from(data[i.wrapping_add_signed(step)]) << k)
    };
    let removable = [table(0), table(1)];
    let mut border: Vec<usize> = (0..data.len()).filter(|&i| data[i] && around(data, i) != 255).collect();
    let mut listed: Vec<bool> = vec![false; data.len()];
    border.iter().for_each(|&i| listed[i] = true);
    let mut still = 0;
    let mut pass = 0;
    while still < 2 {
        let removed: Vec<usize> = border.iter().copied().filter(|&i| removable[pass][around(data, i)]).collect();
        removed.iter().for_each(|&i| data[i] = false);
        border.retain(|&i| data[i]);
        for i in removed.iter().flat_map(|&i| steps.map(|step| i.wrapping_add_signed(step))) {
            if data[i] && !listed[i] {
                listed[i] = true;
                border.push(i);
            }
        }
        still = if removed.is_empty() { still + 1 } else { 0 };
        pass = 1 - pass;
    }
    Raster::from_fn(mask.width(), mask.height(), |x, y| ink.get(x + 1, y + 1))
}

/// Whether a pixel may go, by the bits of its neighbours.
fn table(pass: usize) -> [bool; 256] {
    let mut out = [false; 256];
    for (bits, may_go) in out.iter_mut().enumerate() {
        let p = |k: usize| bits >> (k % 8) & 1 == 1;
        let crossings = [0, 2, 4, 6].iter().filter(|&&k| !p(k) && (p(k + 1) || p(k + 2))).count();
        let one = [0, 2, 4, 6].iter().filter(|&&k| p(k + 7) || p(k)).count();
        let two = [0, 2, 4, 6].iter().filter(|&&k| p(k) || p(k + 1)).count();
        let side = match pass {
            0 => (p(0) || p(1) || !p(3)) && p(2),
            _ => (p(4) || p(5) || !p(7)) && p(6),
        };
        *may_go = crossings == 1 && (2..=3).contains(&one.min(two)) && !side;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broad_line_becomes_a_chain_and_keeps_its_length() {
        let mask = Raster::from_fn(60, 30, |x, y| (5..55).contains(&x) && (10..17).contains(&y));
        let thin = thinned(&mask);
        let count = thin.data().iter().filter(|&&b| b).count();
        assert!((42..=50).contains(&count), "{count}");
        assert!((8..52).all(|x| (0..30).filter(|&y| thin.get(x, y)).count() == 1));
    }

    #[test]
    fn a_ring_stays_a_ring() {
        let radius = |x: usize, y: usize| (x as f64 - 30.0).hypot(y as f64 - 30.0);
        let thin = thinned(&Raster::from_fn(60, 60, |x, y| (15.0..22.0).contains(&radius(x, y))));
        for i in (0..3600).filter(|&i| thin.data()[i]) {
            let (x, y) = (i % 60, i / 60);
            let around =
                AROUND.iter().filter(|&&(dx, dy)| thin.get(x.wrapping_add_signed(dx), y.wrapping_add_signed(dy)));
            assert!(around.count() >= 2, "no end at {x} {y}");
        }
    }
}
