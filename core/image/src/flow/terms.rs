//! The picture terms of each pixel's flow, linearised.

use super::Flow;
use super::patches::Level;
use super::plane::Plane;
use rototoon_base::numeric::lanes::{LANES, Lanes};

/// The change of brightness, x-gradient and y-gradient at each pixel, in 8-bit units. Each is linear in the update:
/// value + x du + y dv. All are zero where the shift leaves the picture.
pub(super) struct Terms(pub [[Plane; 3]; 3]);

impl Terms {
    #[inline(always)]
    pub fn new(first: &Level, second: &Level, flow: &Flow) -> Self {
        let (width, height) = (flow.width(), flow.height());
        let (warped, seen) = warp(second, flow);
        let own = [&first.plane, &first.slopes[0], &first.slopes[1]];
        let mut terms = [(); 3].map(|()| [(); 3].map(|()| Plane::zeros(width, height)));
        for y in 0..height {
            for x in (0..width).step_by(LANES) {
                for (k, term) in terms.iter_mut().enumerate() {
                    let at = (x as isize, y as isize);
                    for (plane, value) in term.iter_mut().zip(linearised(own, &warped, k, at)) {
                        plane.set_lanes(x, y, value.kept(seen.lanes(at.0, at.1)));
                    }
                }
            }
        }
        Self(terms)
    }
}

/// Term `k` of some pixels from (`x`, `y`) on.
#[inline(always)]
fn linearised(own: [&Plane; 3], warped: &[Plane; 3], k: usize, (x, y): (isize, isize)) -> [Lanes; 3] {
    let (now, then) = (warped[k].lanes(x, y), 255.0 * own[k].lanes(x, y));
    // The derivatives of brightness are known. Averaged with those of the first picture, they are exact to second
    // order.
    let (along, down) = if k == 0 {
        let (then_along, then_down) = (255.0 * own[1].lanes(x, y), 255.0 * own[2].lanes(x, y));
        (warped[1].lanes(x, y) + then_along, warped[2].lanes(x, y) + then_down)
    } else {
        let along = warped[k].lanes(x + 1, y) - warped[k].lanes(x - 1, y);
        (along, warped[k].lanes(x, y + 1) - warped[k].lanes(x, y - 1))
    };
    [now - then, 0.5 * along, 0.5 * down]
}

/// The second picture's luma and derivatives at the places to which the flow leads (8-bit units), and a plane that is 1
/// where this place is in the picture and 0 elsewhere.
#[inline(always)]
fn warp(second: &Level, flow: &Flow) -> ([Plane; 3], Plane) {
    let (width, height) = (flow.width(), flow.height());
    let mut planes = [(); 4].map(|()| Plane::zeros(width, height));
    for y in 0..height {
        let [luma, along, down, inside] = &mut planes;
        let (luma, along, down, inside) = (luma.row_mut(y), along.row_mut(y), down.row_mut(y), inside.row_mut(y));
        for (x, [u, v]) in flow.row(y).iter().enumerate() {
            let (px, py) = (x as f32 + u, y as f32 + v);
            // A shift that leaves the picture has no value for comparison.
            let seen = px >= 0.0 && py >= 0.0 && px <= (width - 1) as f32 && py <= (height - 1) as f32;
            let values = 255.0 * super::read(&second.together, px, py);
            (luma[x], along[x], down[x]) = (values.x, values.y, values.z);
            inside[x] = f32::from(u8::from(seen));
        }
    }
    planes.iter_mut().for_each(Plane::continue_border);
    let [luma, x, y, seen] = planes;
    ([luma, x, y], seen)
}
