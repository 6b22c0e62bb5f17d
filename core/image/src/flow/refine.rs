//! Variational refinement of a dense flow.
//!
//! It minimises Σ ψ(brightness change) + γ ψ(gradient change) + α ψ(|∇u|² + |∇v|²) with ψ(s²) = √(s² + ε²). The picture
//! terms are linearised at the given flow (one warp). The weights ψ' are refitted between sweeps of successive
//! over-relaxation. The sweeps are red-black, so their order within a colour does not matter.
//!
//! Source: Brox, Bruhn, Papenberg & Weickert, "High Accuracy Optical Flow Estimation Based on a Theory for Warping"
//! (2004), eq. 4 and 5.

use super::Flow;
use super::patches::Level;
use super::plane::{Board, Plane};
use super::terms::Terms;
use rototoon_base::numeric::lanes::{LANES, Lanes};

/// Weight α of the smoothness (for 8-bit luma).
const SMOOTHNESS: f32 = 20.0;
/// Weight of the brightness term.
const BRIGHTNESS: f32 = 5.0;
/// Weight of the gradient term.
const GRADIENT: f32 = 10.0;
/// Rounding ε of ψ at zero.
const EPSILON: f32 = 0.001;
/// Number of refits of the robust weights.
const OUTER: usize = 5;
/// Number of relaxation sweeps after each refit.
const SWEEPS: usize = 5;
/// Factor of over-relaxation.
const RELAXATION: f32 = 1.6;

/// Improves `flow` in place.
#[inline(always)]
pub(super) fn refine(first: &Level, second: &Level, flow: &mut Flow) {
    if flow.width() < 3 || flow.height() < 3 {
        return;
    }
    let (width, height) = (flow.width(), flow.height());
    let terms = Terms::new(first, second, flow);
    let mut moved = planes(flow);
    let from = moved.clone();
    let mut equations = Equations::new(&from, width, height);
    for _ in 0..OUTER {
        moved.iter_mut().for_each(Plane::continue_border);
        equations.weigh(&terms, &from, &moved);
        for _ in 0..SWEEPS {
            for colour in 0..2 {
                equations.relax(colour);
            }
        }
        equations.moved.iter().zip(&mut moved).for_each(|(board, plane)| board.join(plane));
    }
    for y in 0..height {
        let [u, v] = moved.each_ref().map(|plane| plane.row(y));
        flow.row_mut(y).iter_mut().zip(u.iter().zip(v)).for_each(|(flow, (u, v))| *flow = [*u, *v]);
    }
}

/// The shifts along x and along y.
#[inline(always)]
fn planes(flow: &Flow) -> [Plane; 2] {
    [0, 1].map(|axis: usize| {
        let mut plane = Plane::zeros(flow.width(), flow.height());
        for y in 0..flow.height() {
            plane.row_mut(y).iter_mut().zip(flow.row(y)).for_each(|(value, shift)| *value = shift[axis]);
        }
        plane
    })
}

/// The equations of all pixels for their change of flow, and the flow itself.
struct Equations {
    width: usize,
    height: usize,
    /// Weights of the links to the right neighbour and to the lower neighbour; 0 where there is none.
    links: [Board; 2],
    /// Picture terms: xy, and both right-hand sides.
    cross: Board,
    right: [Board; 2],
    /// Inverse of the diagonal.
    inverse: [Board; 2],
    /// The flow at the start, and the present flow.
    from: [Board; 2],
    moved: [Board; 2],
}

impl Equations {
    #[inline(always)]
    fn new(from: &[Plane; 2], width: usize, height: usize) -> Self {
        let empty = Board::zeros(width, height);
        let both = || [empty.clone(), empty.clone()];
        let mut boards = both();
        for (board, plane) in boards.iter_mut().zip(from) {
            for y in 0..height {
                for x in (0..width).step_by(LANES) {
                    board.set(x, y, plane.lanes(x as isize, y as isize));
                }
            }
        }
        let (cross, links, right, inverse) = (empty.clone(), both(), both(), both());
        Self { width, height, links, cross, right, inverse, from: boards.clone(), moved: boards }
    }

    /// Builds the equations with the robust weights of the present flow.
    #[inline(always)]
    fn weigh(&mut self, terms: &Terms, from: &[Plane; 2], moved: &[Plane; 2]) {
        let (width, height) = (self.width, self.height);
        let [right, below] = link_weights(moved, width, height);
        for y in 0..height {
            for x in (0..width).step_by(LANES) {
                let (xi, yi) = (x as isize, y as isize);
                let du = moved[0].lanes(xi, yi) - from[0].lanes(xi, yi);
                let dv = moved[1].lanes(xi, yi) - from[1].lanes(xi, yi);
                let weight =
                    right.lanes(xi, yi) + below.lanes(xi, yi) + right.lanes(xi - 1, yi) + below.lanes(xi, yi - 1);
                let sums = normal_equations(terms, (xi, yi), du, dv);
                self.links[0].set(x, y, right.lanes(xi, yi));
                self.links[1].set(x, y, below.lanes(xi, yi));
                self.cross.set(x, y, sums.xy);
                self.right[0].set(x, y, sums.bx);
                self.right[1].set(x, y, sums.by);
                self.inverse[0].set(x, y, Lanes::splat(1.0) / (sums.xx + weight));
                self.inverse[1].set(x, y, Lanes::splat(1.0) / (sums.yy + weight));
            }
        }
    }

    /// One relaxation of the pixels of one colour of the chequerboard.
    #[inline(always)]
    fn relax(&mut self, colour: usize) {
        let other = 1 - colour;
        for row in 1..=self.height {
            let shift = (row + 1 + colour) % 2;
            for k in (1..1 + self.width.div_ceil(2)).step_by(LANES) {
                let at = (other, k, row, shift);
                let weights = Near {
                    right: self.links[0].lanes(colour, k, row),
                    below: self.links[1].lanes(colour, k, row),
                    left: self.links[0].lanes(other, k + shift - 1, row),
                    above: self.links[1].lanes(other, k, row - 1),
                };
                let (hu, hv, cross) = (
                    self.from[0].lanes(colour, k, row),
                    self.from[1].lanes(colour, k, row),
                    self.cross.lanes(colour, k, row),
                );
                let (du, dv) = (self.moved[0].lanes(colour, k, row) - hu, self.moved[1].lanes(colour, k, row) - hv);
                let pu = weights.pull(Near::of(&self.moved[0], at), hu, self.right[0].lanes(colour, k, row));
                let pv = weights.pull(Near::of(&self.moved[1], at), hv, self.right[1].lanes(colour, k, row));
                let du = du + RELAXATION * ((pu - cross * dv) * self.inverse[0].lanes(colour, k, row) - du);
                let dv = dv + RELAXATION * ((pv - cross * du) * self.inverse[1].lanes(colour, k, row) - dv);
                self.moved[0].set_lanes(colour, k, row, hu + du);
                self.moved[1].set_lanes(colour, k, row, hv + dv);
            }
        }
    }
}

/// A value of each neighbour of some pixels.
struct Near {
    right: Lanes,
    below: Lanes,
    left: Lanes,
    above: Lanes,
}

impl Near {
    /// The values of a board at the neighbours; `colour` is that of the neighbours.
    #[inline(always)]
    fn of(board: &Board, (colour, k, row, shift): (usize, usize, usize, usize)) -> Self {
        Self {
            right: board.lanes(colour, k + shift, row),
            below: board.lanes(colour, k, row + 1),
            left: board.lanes(colour, k + shift - 1, row),
            above: board.lanes(colour, k, row - 1),
        }
    }

    /// The pull of the neighbours with these weights, minus the right-hand side.
    #[inline(always)]
    fn pull(&self, near: Near, here: Lanes, right_hand: Lanes) -> Lanes {
        -right_hand
            + self.right * (near.right - here)
            + self.below * (near.below - here)
            + self.left * (near.left - here)
            + self.above * (near.above - here)
    }
}

/// Sums of the normal equations of some pixels.
struct Sums {
    xx: Lanes,
    xy: Lanes,
    yy: Lanes,
    bx: Lanes,
    by: Lanes,
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, weight: Lanes, term: &[Lanes; 3]) {
        let [rest, x, y] = *term;
        self.xx = self.xx + weight * (x * x);
        self.xy = self.xy + weight * (x * y);
        self.yy = self.yy + weight * (y * y);
        self.bx = self.bx + weight * (rest * x);
        self.by = self.by + weight * (rest * y);
    }
}

/// One kind of term at some pixels: the change, and its derivatives along x and y.
#[inline(always)]
fn term([change, x_slope, y_slope]: &[Plane; 3], (x, y): (isize, isize)) -> [Lanes; 3] {
    [change.lanes(x, y), x_slope.lanes(x, y), y_slope.lanes(x, y)]
}

/// The square of the change that remains after the update.
#[inline(always)]
fn rest([change, x, y]: &[Lanes; 3], du: Lanes, dv: Lanes) -> Lanes {
    let rest = *change + *x * du + *y * dv;
    rest * rest
}

/// The factor that turns a change into a distance by its slope, so that strong edges do not outweigh weak ones (Zimmer
/// 2011).
#[inline(always)]
fn flat([_, x, y]: &[Lanes; 3]) -> Lanes {
    Lanes::splat(1.0) / (*x * *x + *y * *y + Lanes::splat(0.01))
}

/// The derivative ψ'.
#[inline(always)]
fn robust(square: Lanes) -> Lanes {
    Lanes::splat(1.0) / (square + Lanes::splat(EPSILON * EPSILON)).sqrt()
}

/// Normal equations of some pixels with robust weights.
#[inline(always)]
fn normal_equations(Terms(terms): &Terms, at: (isize, isize), du: Lanes, dv: Lanes) -> Sums {
    let (brightness, gx, gy) = (term(&terms[0], at), term(&terms[1], at), term(&terms[2], at));
    let (nb, nx, ny) = (flat(&brightness), flat(&gx), flat(&gy));
    let wb = BRIGHTNESS * nb * robust(nb * rest(&brightness, du, dv));
    let wg = GRADIENT * robust(nx * rest(&gx, du, dv) + ny * rest(&gy, du, dv));
    let zero = Lanes::splat(0.0);
    let mut sums = Sums { xx: zero, xy: zero, yy: zero, bx: zero, by: zero };
    sums.add(wb, &brightness);
    sums.add(wg * nx, &gx);
    sums.add(wg * ny, &gy);
    sums
}

/// Squared difference between the shifts of some pixels and those at `to`.
#[inline(always)]
fn apart(moved: &[Plane; 2], (x, y): (isize, isize), to: (isize, isize)) -> Lanes {
    let u = moved[0].lanes(x, y) - moved[0].lanes(to.0, to.1);
    let v = moved[1].lanes(x, y) - moved[1].lanes(to.0, to.1);
    u * u + v * v
}

/// Weights of the smoothness links of each pixel to its right and to its lower neighbour.
#[inline(always)]
fn link_weights(moved: &[Plane; 2], width: usize, height: usize) -> [Plane; 2] {
    let mut diffusivity = Plane::zeros(width, height);
    for y in 0..height {
        for x in (0..width).step_by(LANES) {
            let (x, y) = (x as isize, y as isize);
            let squares = apart(moved, (x, y), (x + 1, y)) + apart(moved, (x, y), (x, y + 1));
            let sum = squares + Lanes::splat(EPSILON * EPSILON);
            diffusivity.set_lanes(x as usize, y as usize, Lanes::splat(SMOOTHNESS) / sum.sqrt());
        }
    }
    let mut links = [Plane::zeros(width, height), Plane::zeros(width, height)];
    for y in 0..height {
        for x in (0..width).step_by(LANES) {
            let (xi, yi) = (x as isize, y as isize);
            let here = diffusivity.lanes(xi, yi);
            links[0].set_lanes(x, y, 0.5 * (here + diffusivity.lanes(xi + 1, yi)));
            if y + 1 < height {
                links[1].set_lanes(x, y, 0.5 * (here + diffusivity.lanes(xi, yi + 1)));
            }
        }
        links[0].row_mut(y)[width - 1] = 0.0;
    }
    links
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arbitrary number for each pixel, 0 to 1.
    fn plane(width: usize, height: usize, seed: usize) -> Plane {
        let mut plane = Plane::zeros(width, height);
        for y in 0..height {
            for (x, value) in plane.row_mut(y).iter_mut().enumerate() {
                *value = ((x * 7 + y * 13 + seed * 29) as f32 * 1.7).sin().abs();
            }
        }
        plane
    }

    fn board(plane: &Plane, width: usize, height: usize) -> Board {
        let mut board = Board::zeros(width, height);
        for y in 0..height {
            for x in (0..width).step_by(LANES) {
                board.set(x, y, plane.lanes(x as isize, y as isize));
            }
        }
        board
    }

    /// One pixel after the other, as the equations are written.
    fn relax_naively(planes: &[Plane; 9], moved: &mut [Plane; 2], colour: usize, (width, height): (usize, usize)) {
        let at = |k: usize, x: usize, y: usize| planes[k].row(y)[x];
        for y in 0..height {
            for x in (0..width).filter(|x| (x + y) % 2 == colour) {
                let right = if x + 1 < width { at(0, x, y) } else { 0.0 };
                let below = if y + 1 < height { at(1, x, y) } else { 0.0 };
                let left = if x > 0 { at(0, x - 1, y) } else { 0.0 };
                let above = if y > 0 { at(1, x, y - 1) } else { 0.0 };
                let near =
                    [(right, x + 1, y), (below, x, y + 1), (left, x.wrapping_sub(1), y), (above, x, y.wrapping_sub(1))];
                let here = [at(7, x, y), at(8, x, y)];
                let mut pull = [-at(3, x, y), -at(4, x, y)];
                for (weight, x, y) in near.into_iter().filter(|(weight, ..)| *weight != 0.0) {
                    pull[0] += weight * (moved[0].row(y)[x] - here[0]);
                    pull[1] += weight * (moved[1].row(y)[x] - here[1]);
                }
                let [du, dv] = [moved[0].row(y)[x] - here[0], moved[1].row(y)[x] - here[1]];
                let du = du + RELAXATION * ((pull[0] - at(2, x, y) * dv) * at(5, x, y) - du);
                let dv = dv + RELAXATION * ((pull[1] - at(2, x, y) * du) * at(6, x, y) - dv);
                (moved[0].row_mut(y)[x], moved[1].row_mut(y)[x]) = (here[0] + du, here[1] + dv);
            }
        }
    }

    #[test]
    fn relaxation_by_colours_equals_relaxation_pixel_by_pixel() {
        for (width, height) in [(3, 3), (8, 5), (16, 4), (17, 9), (21, 6)] {
            let mut planes: [Plane; 9] = std::array::from_fn(|seed| plane(width, height, seed));
            (0..height).for_each(|y| planes[0].row_mut(y)[width - 1] = 0.0);
            planes[1].row_mut(height - 1).fill(0.0);
            let mut moved = [plane(width, height, 9), plane(width, height, 10)];
            let [right, below, cross, bx, by, ix, iy, u, v] = planes.each_ref().map(|p| board(p, width, height));
            let mut equations = Equations {
                width,
                height,
                links: [right, below],
                cross,
                right: [bx, by],
                inverse: [ix, iy],
                from: [u, v],
                moved: moved.each_ref().map(|p| board(p, width, height)),
            };
            for colour in [0, 1, 0] {
                equations.relax(colour);
                relax_naively(&planes, &mut moved, colour, (width, height));
            }
            let mut fast = [Plane::zeros(width, height), Plane::zeros(width, height)];
            equations.moved.iter().zip(&mut fast).for_each(|(board, plane)| board.join(plane));
            for (fast, naive) in fast.iter().zip(&moved) {
                (0..height).for_each(|y| assert_eq!(fast.row(y), naive.row(y), "{width} x {height}, row {y}"));
            }
        }
    }
}
