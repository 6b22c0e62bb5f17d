//! The pose of a lattice that explains a picture best, by Gauss–Newton from a start nearby.
//!
//! Minimises (cells / samples) Σ w ρ(‖I(y) − C‖²) + λ Σ shape over the nodes; y is where the pose puts a sample, C the
//! key's colour there. ρ is Geman & McClure's: its weight 1 / (1 + e/σ²)² lets go of samples that are covered or
//! recoloured. The picture's slope is the mean of what the picture has at y and of what the key has there, turned with
//! the lattice: to second order exact at the solution (Benhimane & Malis 2004), and worth 2 points of 100 over the
//! picture's own. Cells turn freely: their best turns are refitted in each iteration (local / global steps).

use super::anchors::Anchors;
use super::mesh::Mesh;
use super::shape;
use super::texture::{Cover, Texture, difference};
use crate::geometry::Point;
use crate::numeric::banded::BandMatrix;
use crate::track::features::{Features, LEVELS};

/// Weight of the shape energy.
const STIFFNESS: f64 = 0.05;
/// σ of ρ by level, in colour units.
const TOLERANCE: [f32; 3] = [0.35, 0.25, 0.18];
/// Iterations by level.
const ITERATIONS: [usize; 3] = [6, 5, 4];
/// Longest step of a node, in pixels of the level.
const LONGEST_STEP: f64 = 2.0;
/// A step shorter than this ends the level, in pixels of the level.
const SHORTEST_STEP: f64 = 0.06;
/// Samples below which a level says too little about a pose.
const FEWEST_SAMPLES: usize = 6;
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

/// The shape term's constant part: its matrix. Made once a lattice.
#[derive(Clone, Debug)]
pub struct Aligner {
    stiffness: BandMatrix,
}

impl Aligner {
    /// For the lattice of a texture.
    pub fn new(mesh: &Mesh) -> Self {
        Self { stiffness: shape::stiffness(mesh) }
    }

    /// Improves a pose on the levels of the indices given (in [`LEVELS`]), in that order.
    pub fn align(&self, texture: &Texture, target: Target, start: &[Point], levels: &[usize]) -> Vec<Point> {
        let mut nodes = start.to_vec();
        for &level in levels {
            if texture.texels[level].len() < FEWEST_SAMPLES {
                continue;
            }
            for _ in 0..ITERATIONS[level] {
                let Some(longest) = self.step(texture, target, &mut nodes, level) else { break };
                if longest < SHORTEST_STEP * LEVELS[level] as f64 {
                    break;
                }
            }
        }
        nodes
    }

    /// One Gauss–Newton step; its length in working pixels. None where the equations have no solution.
    fn step(&self, texture: &Texture, target: Target, nodes: &mut [Point], level: usize) -> Option<f64> {
        let mesh = &texture.mesh;
        let rotations = shape::rotations(mesh, nodes);
        let mut matrix = mesh.matrix();
        let mut gradient = vec![0.0; 2 * nodes.len()];
        let turn = rotations.iter().sum::<Point>().normalize_or(Point::X);
        add_look(texture, target, nodes, level, turn, &mut matrix, &mut gradient);
        matrix.add_scaled(&self.stiffness, STIFFNESS);
        (0..gradient.len()).for_each(|i| matrix.add(i, i, RIDGE));
        shape::add_gradient(mesh, nodes, &rotations, STIFFNESS, &mut gradient);
        gradient.iter_mut().for_each(|g| *g = -*g);
        solve_and_move(matrix, gradient, target.anchors, nodes, LONGEST_STEP * LEVELS[level] as f64)
    }
}

/// A bare lattice brought to its anchors with as little bending as possible, from `start`.
pub fn settle(mesh: &Mesh, start: &[Point], anchors: &Anchors) -> Vec<Point> {
    if anchors.is_empty() {
        return start.to_vec();
    }
    let mut nodes = anchors.approach(start);
    let stiffness = shape::stiffness(mesh);
    for _ in 0..SETTLING {
        let mut matrix = stiffness.clone();
        (0..matrix.size()).for_each(|i| matrix.add(i, i, 1e-4));
        let mut gradient = vec![0.0; 2 * nodes.len()];
        shape::add_gradient(mesh, &nodes, &shape::rotations(mesh, &nodes), -1.0, &mut gradient);
        if solve_and_move(matrix, gradient, anchors, &mut nodes, f64::INFINITY).is_none() {
            break;
        }
    }
    nodes
}

/// A pose drawn to its anchors, while its nodes are held to where they are by the weights in `hold` (beside a lattice's
/// own stiffness of about 1): what fits the picture stays, and what does not follows the anchors.
///
/// The anchors are approached in several steps, so that a limb turns on its way and is not torn through itself.
pub fn draw(mesh: &Mesh, start: &[Point], anchors: &Anchors, hold: &[f64]) -> Vec<Point> {
    let mut nodes = start.to_vec();
    let stiffness = shape::stiffness(mesh);
    for step in 1..=DRAWS {
        let target = anchors.toward(&nodes, 1.0 / (DRAWS + 1 - step) as f64);
        for _ in 0..DRAW_ITERATIONS {
            let mut matrix = stiffness.clone();
            let mut gradient = vec![0.0; 2 * nodes.len()];
            shape::add_gradient(mesh, &nodes, &shape::rotations(mesh, &nodes), -1.0, &mut gradient);
            let inverse = 1.0 / (mesh.side * mesh.side);
            for (n, (at, from)) in nodes.iter().zip(start).enumerate() {
                let weight = inverse * hold[n] + 1e-6;
                let pull = (*from - *at) * (inverse * hold[n]);
                for (axis, pull) in [pull.x, pull.y].into_iter().enumerate() {
                    matrix.add(2 * n + axis, 2 * n + axis, weight);
                    gradient[2 * n + axis] += pull;
                }
            }
            if solve_and_move(matrix, gradient, &target, &mut nodes, f64::INFINITY).is_none() {
                return nodes;
            }
        }
    }
    nodes
}

/// Solves for a step, makes the anchors hold, shortens it to `longest`, and moves the nodes. Its length.
fn solve_and_move(
    matrix: BandMatrix,
    mut step: Vec<f64>,
    anchors: &Anchors,
    nodes: &mut [Point],
    longest: f64,
) -> Option<f64> {
    let factor = matrix.factor().ok()?;
    factor.solve_in_place(&mut step);
    if !anchors.is_empty() {
        anchors.constrain(&factor, nodes, &mut step);
    }
    let length = step.iter().fold(0.0f64, |most, d| most.max(d.abs()));
    if !length.is_finite() {
        return None;
    }
    let share = if length > longest { longest / length } else { 1.0 };
    for (n, p) in nodes.iter_mut().enumerate() {
        *p += Point::new(step[2 * n], step[2 * n + 1]) * share;
    }
    Some(length)
}

/// Sums of one cell: second derivatives for each pair of its nodes (xx, xy, yy), first derivatives for each node.
#[derive(Default)]
struct CellSums {
    pairs: [[f64; 3]; 10],
    nodes: [[f64; 2]; 4],
}

impl CellSums {
    /// Adds a sample: weights of the nodes, and its 2×2 second and 2 first derivatives.
    fn add(&mut self, weights: &[f64; 4], second: [f64; 3], first: [f64; 2]) {
        let mut pair = 0;
        for a in 0..4 {
            for b in 0..=a {
                let w = weights[a] * weights[b];
                for k in 0..3 {
                    self.pairs[pair][k] += w * second[k];
                }
                pair += 1;
            }
            self.nodes[a][0] += weights[a] * first[0];
            self.nodes[a][1] += weights[a] * first[1];
        }
    }

    fn scatter(&self, nodes: &[usize; 4], matrix: &mut BandMatrix, gradient: &mut [f64]) {
        let mut pair = 0;
        for a in 0..4 {
            for b in 0..=a {
                let (i, j) = (2 * nodes[a], 2 * nodes[b]);
                let [xx, xy, yy] = self.pairs[pair];
                matrix.add(i, j, xx);
                matrix.add(i + 1, j + 1, yy);
                matrix.add(i + 1, j, xy);
                if a != b {
                    matrix.add(i, j + 1, xy);
                }
                pair += 1;
            }
            gradient[2 * nodes[a]] += self.nodes[a][0];
            gradient[2 * nodes[a] + 1] += self.nodes[a][1];
        }
    }
}

/// Adds the picture term's normal equations.
fn add_look(
    texture: &Texture,
    target: Target,
    nodes: &[Point],
    level: usize,
    turn: Point,
    matrix: &mut BandMatrix,
    gradient: &mut [f64],
) {
    let texels = &texture.texels[level];
    let share = (texture.mesh.cells.len() as f64 / texels.len() as f64) as f32;
    let inverse = 1.0 / (TOLERANCE[level] * TOLERANCE[level]);
    let (cos, sin) = (turn.x as f32, turn.y as f32);
    let picture = target.picture.level(level);
    for cell in texels.chunk_by(|a, b| a.cell == b.cell) {
        let mut sums = CellSums::default();
        for texel in cell {
            let place = texel.binding.at(nodes);
            if target.cover.hides(place) {
                continue;
            }
            let (seen, key) = (picture.sample(place), &texel.key);
            let rho = 1.0 + difference(&seen, key) * inverse;
            let weight = share * texel.weight / (rho * rho);
            let (mut second, mut first) = ([0.0f32; 3], [0.0f32; 2]);
            for k in 0..3 {
                let gx = 0.5 * (seen[3 + k] + cos * key[3 + k] - sin * key[6 + k]);
                let gy = 0.5 * (seen[6 + k] + sin * key[3 + k] + cos * key[6 + k]);
                let rest = seen[k] - key[k];
                second = [second[0] + gx * gx, second[1] + gx * gy, second[2] + gy * gy];
                first = [first[0] + gx * rest, first[1] + gy * rest];
            }
            let scaled = |v: f32| f64::from(weight * v);
            sums.add(&texel.binding.weights, second.map(scaled), first.map(scaled));
        }
        sums.scatter(&texture.mesh.cells[cell[0].cell], matrix, gradient);
    }
}
