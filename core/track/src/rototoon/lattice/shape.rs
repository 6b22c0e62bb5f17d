//! The bending energy of a lattice: as-rigid-as-possible, with a free scale between 0.9 and 1.12 in each cell.
//!
//! A cell's energy is Σ |x̃ − r q̃|² / h² over its four nodes. A tilde means "minus the cell's mean", q are the nodes
//! at the key, and h is the side of a cell. The complex number r is the best rotation and scale of the cell, with its
//! length kept within the bounds. So a drawn limb may swell or foreshorten a little without cost.

use super::mesh::Mesh;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::BandMatrix;

/// Bounds of a cell's free scale.
const SCALE: (f64, f64) = (0.9, 1.12);

/// Bounds of a cell's learned stiffness.
const SOFTEST: f64 = 0.1;
const STIFFEST: f64 = 4.0;
/// Bend at which a cell's stiffness is halfway between the bounds: root mean square distance of its nodes from the best
/// similar square, in sides of a cell.
const HALFWAY: f64 = 0.03;

/// The best rotation and scale of each cell, as complex numbers.
pub fn rotations(mesh: &Mesh, nodes: &[Point]) -> Vec<Point> {
    let rest = rest_cell(mesh);
    let norm: f64 = rest.iter().map(|q| q.length_squared()).sum();
    let best = |cell: &[usize; 4]| {
        let r = cell.iter().zip(&rest).map(|(&n, q)| Point::new(q.dot(nodes[n]), q.perp_dot(nodes[n]))).sum::<Point>();
        let r = r / norm;
        let length = r.length();
        if length > 1e-9 { r * (length.clamp(SCALE.0, SCALE.1) / length) } else { Point::X }
    };
    mesh.cells.iter().map(best).collect()
}

/// Mean energy of the cells, weighted with their stiffness.
pub fn energy(mesh: &Mesh, nodes: &[Point]) -> f64 {
    let rest = rest_cell(mesh);
    let rotations = rotations(mesh, nodes);
    let sum: f64 = residuals(mesh, nodes, &rotations, &rest).zip(&mesh.stiffness).map(|(e, s)| e * s).sum();
    sum / (mesh.side * mesh.side * mesh.cells.len() as f64)
}

/// Sum of the squared distances of each cell's nodes from its best similar square.
fn residuals<'a>(
    mesh: &'a Mesh,
    nodes: &'a [Point],
    rotations: &'a [Point],
    rest: &'a [Point; 4],
) -> impl Iterator<Item = f64> + 'a {
    mesh.cells.iter().zip(rotations).map(move |(cell, r)| {
        let mean = cell.iter().map(|&n| nodes[n]).sum::<Point>() / 4.0;
        cell.iter().zip(rest).map(|(&n, q)| (nodes[n] - mean - r.rotate(*q)).length_squared()).sum::<f64>()
    })
}

/// Sets the stiffness of each cell by its bend in `shape`, which are the nodes of a shape that the part is known to
/// take. A cell that keeps its shape from one key to the other stays stiff between them. A cell that bends becomes
/// soft.
pub fn learn_stiffness(mesh: &mut Mesh, shape: &[Point]) {
    let (rest, rotations) = (rest_cell(mesh), rotations(mesh, shape));
    let half = 4.0 * (HALFWAY * mesh.side).powi(2);
    let of_cell = |bend: f64| SOFTEST + (STIFFEST - SOFTEST) / (1.0 + bend / half);
    mesh.stiffness = residuals(mesh, shape, &rotations, &rest).map(of_cell).collect();
}

/// Half of the second derivative of the sum of the cells' energies, for fixed rotations.
pub fn stiffness(mesh: &Mesh) -> BandMatrix {
    let mut matrix = mesh.matrix();
    let inverse = 1.0 / (mesh.side * mesh.side);
    for (cell, stiffness) in mesh.cells.iter().zip(&mesh.stiffness) {
        for (a, &i) in cell.iter().enumerate() {
            for (b, &j) in cell.iter().enumerate() {
                if i >= j {
                    let value = inverse * stiffness * (f64::from(u8::from(a == b)) - 0.25);
                    matrix.add(2 * i, 2 * j, value);
                    matrix.add(2 * i + 1, 2 * j + 1, value);
                }
            }
        }
    }
    matrix
}

/// Adds half of the gradient of the sum of the cells' energies, times `weight`, to `gradient`, for the rotations given.
pub fn add_gradient(mesh: &Mesh, nodes: &[Point], rotations: &[Point], weight: f64, gradient: &mut [f64]) {
    let rest = rest_cell(mesh);
    let factor = weight / (mesh.side * mesh.side);
    for ((cell, r), stiffness) in mesh.cells.iter().zip(rotations).zip(&mesh.stiffness) {
        let mean = cell.iter().map(|&n| nodes[n]).sum::<Point>() / 4.0;
        for (&n, q) in cell.iter().zip(&rest) {
            let g = (nodes[n] - mean - r.rotate(*q)) * (factor * stiffness);
            gradient[2 * n] += g.x;
            gradient[2 * n + 1] += g.y;
        }
    }
}

/// The nodes of a cell at the key, relative to its centre. Every cell is the same square.
fn rest_cell(mesh: &Mesh) -> [Point; 4] {
    let half = 0.5 * mesh.side;
    [(-half, -half), (half, -half), (-half, half), (half, half)].map(|(x, y)| Point::new(x, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh() -> Mesh {
        Mesh::new(&[(0.0, 0.0), (60.0, 10.0), (40.0, 70.0)].map(|(x, y)| Point::new(x, y)), true)
    }

    #[test]
    fn turning_shifting_and_a_little_scaling_cost_nothing() {
        let mesh = mesh();
        let turn = Point::from_angle(2.0) * 1.1;
        let moved: Vec<Point> = mesh.rest.iter().map(|&q| turn.rotate(q) + Point::new(300.0, 7.0)).collect();
        assert!(energy(&mesh, &moved) < 1e-20);
        let grown: Vec<Point> = mesh.rest.iter().map(|&q| q * 1.5).collect();
        // Each cell misses 1.5 − 1.12 of its size: 4 nodes at distance h/√2 · 0.38.
        assert!((energy(&mesh, &grown) - 4.0 * 0.5 * 0.38 * 0.38).abs() < 1e-12);
    }

    #[test]
    fn cells_learn_to_be_soft_where_the_keys_bend() {
        let bar = [(0.0, 0.0), (200.0, 0.0), (200.0, 24.0), (0.0, 24.0)].map(|(x, y)| Point::new(x, y));
        let mut mesh = Mesh::new(&bar, true);
        let bent = |q: Point| {
            let turn = Point::from_angle(((q.x - 90.0) / 20.0).clamp(0.0, 1.0));
            if q.x < 90.0 { q } else { turn.rotate(q - Point::new(90.0, 12.0)) + Point::new(90.0, 12.0) }
        };
        let shape: Vec<Point> = mesh.rest.iter().map(|&q| bent(q)).collect();
        learn_stiffness(&mut mesh, &shape);
        for (cell, &stiffness) in mesh.cells.iter().zip(&mesh.stiffness) {
            let xs = cell.map(|n| mesh.rest[n].x);
            let (left, right) = (xs[0], xs[1]);
            if right < 85.0 || left > 115.0 {
                assert!(stiffness > 0.9 * STIFFEST, "{left}: {stiffness}");
            }
        }
        let softest = mesh.stiffness.iter().copied().fold(STIFFEST, f64::min);
        assert!((SOFTEST..0.25 * STIFFEST).contains(&softest), "{softest}");
    }

    #[test]
    fn the_gradient_is_the_derivative_of_the_energy() {
        let mesh = mesh();
        let bent = |k: usize| Point::new((k as f64 * 1.7).sin(), (k as f64 * 2.3).cos()) * 3.0;
        let nodes: Vec<Point> = mesh.rest.iter().enumerate().map(|(k, &q)| q * 1.4 + bent(k)).collect();
        let mut gradient = vec![0.0; 2 * nodes.len()];
        add_gradient(&mesh, &nodes, &rotations(&mesh, &nodes), 1.0, &mut gradient);
        let cells = mesh.cells.len() as f64;
        for k in 0..gradient.len() {
            let moved = |d: f64| {
                let mut nodes = nodes.clone();
                nodes[k / 2][k % 2] += d;
                energy(&mesh, &nodes) * cells
            };
            // The rotations are the best ones, so they may be fixed: a clamped length has no first-order effect across
            // the rotation. The length bound makes the derivative one-sided only at the bound itself.
            let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((2.0 * gradient[k] - slope).abs() < 1e-6, "{k}: {} for {slope}", 2.0 * gradient[k]);
        }
    }
}
