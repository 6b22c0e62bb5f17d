//! The pose of a lattice that explains a picture best, by Gauss–Newton from a start nearby.
//!
//! Minimises (cells / samples) Σ w ρ(‖I(y) − C‖²) + λ Σ shape over the nodes; y is where the pose puts a sample, C the
//! key's colour there. ρ is Geman & McClure's: its weight 1 / (1 + e/σ²)² lets go of samples that are covered or
//! recoloured. The picture's slope is the mean of what the picture has at y and of what the key has there, turned with
//! the lattice: to second order exact at the solution (Benhimane & Malis 2004), and worth 2 points of 100 over the
//! picture's own. Cells turn freely: their best turns are refitted in each iteration (local / global steps), and the key's
//! slope is turned with its cell.
//!
//! On the two coarser levels nodes move together with their neighbours ([`super::unknowns`]): one cell says too little there.
//!
//! Of a sample outside the part only the slope across the contour counts. What changes along the contour out there belongs
//! to the ground: where the outline of a head meets that of an ear before it, the corner is no place on the ear, and a
//! lattice that follows it is drawn along its part. It is worth 0.7 points of 100 over fourteen sequences, 5 where parts
//! slide over others of their own colour.

use super::anchors::Anchors;
use super::equations::Equations;
use super::mesh::Mesh;
use super::shape;
use super::texture::{Cover, PAIRS, Texel, Texture};
use crate::shared::features::{Features, LEVELS, Padded, Sample, total};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::BandMatrix;
use rototoon_base::numeric::lanes::Lanes;
use rototoon_base::numeric::vector::vectorised;

/// Weight of the shape energy.
const STIFFNESS: f64 = 0.05;
/// σ of ρ by level, in colour units.
const TOLERANCE: [f32; 3] = [0.35, 0.25, 0.18];
/// Iterations by level.
const ITERATIONS: [usize; 3] = [6, 5, 4];
/// Longest step of a node, in pixels of the level.
const LONGEST_STEP: f64 = 2.0;
/// A step shorter than this ends the level, in pixels of the level.
const SHORTEST_STEP: f64 = 0.3;
/// Samples below which a level says too little about a pose.
const FEWEST_SAMPLES: usize = 6;
/// Steps that the equations' matrix serves: it changes slowly, and to factor it is half of the work.
const EACH_SERVES: usize = 2;
/// Added to the diagonal: cells without contrast keep their place.
const RIDGE: f64 = 1e-7;
/// Local / global steps that bring a bare lattice to its anchors.
const SETTLING: usize = 8;

/// Steps in which a pose is drawn to its anchors, and local / global iterations of each.
const DRAWS: usize = 6;
const DRAW_ITERATIONS: usize = 3;

/// What a lattice is aligned to.
#[derive(Clone, Copy)]
pub struct Target<'a> {
    /// The frame's picture.
    pub picture: &'a Features,
    /// What hides the part on the frame: samples below it are left out.
    pub cover: &'a Cover,
    /// What the artist fixed on the frame.
    pub anchors: &'a Anchors,
}

/// What does not change from step to step: the weighted matrix of the shape term over the unknowns of each level. Made once
/// a lattice.
#[derive(Clone, Debug)]
pub struct Aligner {
    constants: [BandMatrix; LEVELS.len()],
}

impl Aligner {
    /// For the lattice of a texture.
    pub fn new(mesh: &Mesh) -> Self {
        let mut constant = mesh.matrix();
        constant.add_scaled(&shape::stiffness(mesh), STIFFNESS);
        (0..constant.size()).for_each(|i| constant.add(i, i, RIDGE));
        Self { constants: std::array::from_fn(|level| mesh.unknowns(level).restricted_matrix(&constant)) }
    }

    /// Improves a pose on the levels of the indices given (in [`LEVELS`]), in that order.
    pub fn align(&self, texture: &Texture, target: Target, start: &[Point], levels: &[usize]) -> Vec<Point> {
        let mut nodes = start.to_vec();
        for &level in levels {
            if texture.texels[level].len() < FEWEST_SAMPLES {
                continue;
            }
            let mut equations = None;
            for iteration in 0..ITERATIONS[level] {
                if iteration % EACH_SERVES == 0 {
                    equations = None;
                }
                let Some(longest) = self.step(texture, target, &mut nodes, level, &mut equations) else { break };
                if longest < SHORTEST_STEP * LEVELS[level] as f64 {
                    break;
                }
            }
        }
        nodes
    }

    /// One Gauss–Newton step, with the equations given or with new ones; its length in working pixels. None where they
    /// have no solution.
    fn step(
        &self,
        texture: &Texture,
        target: Target,
        nodes: &mut [Point],
        level: usize,
        equations: &mut Option<Equations>,
    ) -> Option<f64> {
        let (mesh, unknowns) = (&texture.mesh, texture.mesh.unknowns(level));
        let rotations = shape::rotations(mesh, nodes);
        let mut matrix = equations.is_none().then(|| self.constants[level].clone());
        let mut bending = vec![0.0; 2 * nodes.len()];
        shape::add_gradient(mesh, nodes, &rotations, STIFFNESS, &mut bending);
        let mut gradient = unknowns.restricted(&bending);
        vectorised(
            #[inline(always)]
            || add_look(texture, target, nodes, level, &rotations, matrix.as_mut(), &mut gradient),
        );
        let anchors = target.anchors.of_shifts(nodes, unknowns);
        if let Some(matrix) = matrix {
            *equations = Some(Equations::new(matrix, &anchors)?);
        }
        gradient.iter_mut().for_each(|g| *g = -*g);
        let unmoved = vec![Point::ZERO; gradient.len() / 2];
        equations.as_ref()?.solve(&mut gradient, &unmoved, &anchors);
        let shifts = unknowns.spread(&gradient);
        moved(&shifts, nodes, LONGEST_STEP * LEVELS[level] as f64)
    }
}

/// Brings a bare lattice to its anchors with as little bending as possible. The equations are the same for every start.
pub struct Settler<'a> {
    mesh: &'a Mesh,
    anchors: &'a Anchors,
    equations: Option<Equations>,
}

impl<'a> Settler<'a> {
    /// For one lattice and what is fixed of it.
    pub fn new(mesh: &'a Mesh, anchors: &'a Anchors) -> Self {
        let equations = || {
            let mut matrix = shape::stiffness(mesh);
            (0..matrix.size()).for_each(|i| matrix.add(i, i, 1e-4));
            Equations::new(matrix, anchors)
        };
        Self { mesh, anchors, equations: if anchors.is_empty() { None } else { equations() } }
    }

    /// The nodes from `start`; those of the start where nothing is fixed.
    pub fn settle(&self, start: &[Point]) -> Vec<Point> {
        if self.anchors.is_empty() {
            return start.to_vec();
        }
        let mut nodes = self.anchors.approach(start);
        let Some(equations) = &self.equations else { return nodes };
        for _ in 0..SETTLING {
            let mut gradient = vec![0.0; 2 * nodes.len()];
            let rotations = shape::rotations(self.mesh, &nodes);
            shape::add_gradient(self.mesh, &nodes, &rotations, -1.0, &mut gradient);
            equations.solve(&mut gradient, &nodes, self.anchors);
            if moved(&points(&gradient), &mut nodes, f64::INFINITY).is_none() {
                break;
            }
        }
        nodes
    }
}

/// One pose settled.
pub fn settle(mesh: &Mesh, start: &[Point], anchors: &Anchors) -> Vec<Point> {
    Settler::new(mesh, anchors).settle(start)
}

/// A pose drawn to its anchors, while its nodes are held to where they are by the weights in `hold` (beside a lattice's
/// own stiffness of about 1): what fits the picture stays, and what does not follows the anchors.
///
/// The anchors are approached in several steps, so that a limb turns on its way and is not torn through itself.
pub fn draw(mesh: &Mesh, start: &[Point], anchors: &Anchors, hold: &[f64]) -> Vec<Point> {
    let mut nodes = start.to_vec();
    let inverse = 1.0 / (mesh.side * mesh.side);
    let mut matrix = shape::stiffness(mesh);
    (0..matrix.size()).for_each(|i| matrix.add(i, i, inverse * hold[i / 2] + 1e-6));
    let Some(equations) = Equations::new(matrix, anchors) else { return nodes };
    for step in 1..=DRAWS {
        let target = anchors.toward(&nodes, 1.0 / (DRAWS + 1 - step) as f64);
        for _ in 0..DRAW_ITERATIONS {
            let mut gradient = vec![0.0; 2 * nodes.len()];
            shape::add_gradient(mesh, &nodes, &shape::rotations(mesh, &nodes), -1.0, &mut gradient);
            for (n, (at, from)) in nodes.iter().zip(start).enumerate() {
                let pull = (*from - *at) * (inverse * hold[n]);
                gradient[2 * n] += pull.x;
                gradient[2 * n + 1] += pull.y;
            }
            equations.solve(&mut gradient, &nodes, &target);
            if moved(&points(&gradient), &mut nodes, f64::INFINITY).is_none() {
                return nodes;
            }
        }
    }
    nodes
}

/// Coordinates as points.
fn points(coordinates: &[f64]) -> Vec<Point> {
    coordinates.as_chunks().0.iter().copied().map(Point::from_array).collect()
}

/// Moves the nodes by a step, shortened to `longest`. Its length before; none, and no move, where it is not finite.
fn moved(step: &[Point], nodes: &mut [Point], longest: f64) -> Option<f64> {
    if !step.iter().all(|d| d.is_finite()) {
        return None;
    }
    let length = step.iter().fold(0.0f64, |most, d| most.max(d.abs().max_element()));
    let share = if length > longest { longest / length } else { 1.0 };
    for (p, step) in nodes.iter_mut().zip(step) {
        *p += *step * share;
    }
    Some(length)
}

/// Sums of one of the unknowns' cells: second derivatives (xx, xy, yy) for each of [`PAIRS`] of its nodes, first derivatives
/// for each node, by x and then by y.
struct CellSums {
    pairs: [[f32; PAIRS.len()]; 3],
    nodes: Lanes,
}

impl CellSums {
    #[inline(always)]
    fn new() -> Self {
        Self { pairs: [[0.0; PAIRS.len()]; 3], nodes: Lanes::splat(0.0) }
    }

    /// Adds a sample's 3 second derivatives.
    #[inline(always)]
    fn add_second(&mut self, texel: &Texel, second: [f32; 3]) {
        for (sums, value) in self.pairs.iter_mut().zip(second) {
            for (sum, product) in sums.iter_mut().zip(&texel.products) {
                *sum = product.mul_add(value, *sum);
            }
        }
    }

    /// Adds a sample's 2 first derivatives.
    #[inline(always)]
    fn add_first(&mut self, texel: &Texel, [x, y]: [f32; 2]) {
        self.nodes = texel.moved_by.mul_add(Lanes::of_fours(x, y), self.nodes);
    }

    #[inline(always)]
    fn scatter(&self, nodes: &[usize; 4], matrix: Option<&mut BandMatrix>, gradient: &mut [f64]) {
        let by_node = self.nodes.to_array();
        for (a, &n) in nodes.iter().enumerate() {
            gradient[2 * n] += f64::from(by_node[a]);
            gradient[2 * n + 1] += f64::from(by_node[4 + a]);
        }
        let Some(matrix) = matrix else { return };
        for (pair, (a, b)) in PAIRS.iter().enumerate().filter_map(|(k, pair)| Some((k, (*pair)?))) {
            let (i, j) = (2 * nodes[a], 2 * nodes[b]);
            let [xx, xy, yy] = self.pairs.map(|sums| f64::from(sums[pair]));
            matrix.add(i, j, xx);
            matrix.add(i + 1, j + 1, yy);
            matrix.add(i + 1, j, xy);
            if a != b {
                matrix.add(i, j + 1, xy);
            }
        }
    }
}

/// Adds the picture term's normal equations; those of second order where a matrix is given.
#[inline(always)]
fn add_look(
    texture: &Texture,
    target: Target,
    nodes: &[Point],
    level: usize,
    rotations: &[Point],
    mut matrix: Option<&mut BandMatrix>,
    gradient: &mut [f64],
) {
    let texels = &texture.texels[level];
    let unknowns = texture.mesh.unknowns(level);
    let share = (texture.mesh.cells.len() as f64 / texels.len() as f64) as f32;
    let inverse = 1.0 / (TOLERANCE[level] * TOLERANCE[level]);
    let picture = target.picture.level(level);
    for group in texels.chunk_by(|a, b| unknowns.cell_of[a.cell] == unknowns.cell_of[b.cell]) {
        let mut sums = CellSums::new();
        for cell in group.chunk_by(|a, b| a.cell == b.cell) {
            let turn = rotations[cell[0].cell].normalize_or(Point::X);
            let turn = [turn.x as f32, turn.y as f32];
            let corners = texture.corners(cell[0].cell, nodes);
            for texel in cell {
                let place = texel.place(&corners);
                if target.cover.hides(place) {
                    continue;
                }
                let seen = picture.sample(place);
                let (gx, gy) = slopes(&seen, texel, turn);
                let rest = seen.colour - texel.key.colour;
                let rho = 1.0 + total(rest * rest) * inverse;
                let weight = share * texel.weight / (rho * rho);
                sums.add_first(texel, [gx * rest, gy * rest].map(|v| weight * total(v)));
                if matrix.is_some() {
                    sums.add_second(texel, [gx * gx, gx * gy, gy * gy].map(|v| weight * total(v)));
                }
            }
        }
        sums.scatter(&unknowns.cells[unknowns.cell_of[group[0].cell]], matrix.as_deref_mut(), gradient);
    }
}

/// Slopes along x and y that a sample is moved by: the mean of the picture's and of the key's, `turn`ed with its cell (cosine
/// and sine); outside the part what of them leads across the contour.
#[inline(always)]
fn slopes(seen: &Sample, texel: &Texel, [cos, sin]: [f32; 2]) -> (Padded, Padded) {
    let ([sx, sy], [kx, ky]) = (seen.slopes, texel.key.slopes);
    let (gx, gy) = (0.5 * (sx + cos * kx - sin * ky), 0.5 * (sy + cos * ky + sin * kx));
    let Some([x, y]) = texel.across else { return (gx, gy) };
    let (x, y) = (cos * x - sin * y, sin * x + cos * y);
    let across = x * gx + y * gy;
    (x * across, y * across)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rototoon::propagate::mean_distance;
    use rototoon_base::scene::{Colour, Raster};

    const WIDTH: f64 = 300.0;

    /// An upright bar of one colour, before a wall above and a floor below `line`, working pixels.
    fn picture(line: usize) -> Features {
        let colour = |x: usize, y: usize| -> Colour {
            match ((130..170).contains(&x) && (150..390).contains(&y), y < line) {
                (true, _) => [0.7, 0.4, 0.2],
                (_, true) => [0.85, 0.9, 0.95],
                (_, false) => [0.2, 0.25, 0.2],
            }
        };
        Features::new(&Raster::from_fn(WIDTH as usize, 540, colour))
    }

    fn bar() -> Texture {
        let corners = [(130.0, 150.0), (170.0, 150.0), (170.0, 390.0), (130.0, 390.0)];
        let mesh = Mesh::new(&corners.map(|(x, y)| Point::new(x, y)), true);
        Texture::new(mesh, &picture(270), &Cover::none(WIDTH), WIDTH)
    }

    #[test]
    fn a_ground_that_moves_along_the_contour_does_not_draw_the_part_with_it() {
        let (picture, cover) = (picture(258), Cover::none(WIDTH));
        let moved = |texture: &Texture| {
            let anchors = Anchors::default();
            let target = Target { picture: &picture, cover: &cover, anchors: &anchors };
            let nodes = Aligner::new(&texture.mesh).align(texture, target, &texture.mesh.rest, &[0, 1, 2]);
            mean_distance(&nodes, &texture.mesh.rest)
        };
        let mut plain = bar();
        let held = moved(&plain);
        plain.forget_figure();
        // What is left is the blur of the coarsest level, through which the ground shows inside the part too.
        assert!(held < 2.5 && moved(&plain) > 2.5 * held, "{held} px, {} without", moved(&plain));
    }

    #[test]
    fn outside_slopes_lead_across_the_contour_as_it_is_turned() {
        let texture = bar();
        let group = |first: usize| [0, 1, 2].map(|k| ((first + k) as f32 * 1.3).sin());
        let padded = |[a, b, c]: [f32; 3]| Padded::new(a, b, c, 0.0);
        let seen = Sample { colour: padded(group(0)), slopes: [4, 8].map(|first| padded(group(first))) };
        let turn = Point::from_angle(0.6);
        for texel in &texture.texels[1] {
            let (gx, gy) = slopes(&seen, texel, [turn.x as f32, turn.y as f32]);
            let Some(across) = texel.across else { continue };
            let along = turn.rotate(Point::new(f64::from(across[0]), f64::from(across[1]))).perp();
            let rest = [0, 1, 2].map(|k| along.dot(Point::new(f64::from(gx[k]), f64::from(gy[k]))));
            assert!(rest.iter().all(|v| v.abs() < 1e-6), "{rest:?}");
            assert!(!texture.mesh.region(texel.binding.at(&texture.mesh.rest)).1, "it lies outside");
        }
        assert!(texture.texels[1].iter().any(|texel| texel.across.is_some()));
    }
}
