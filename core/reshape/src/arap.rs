//! As-rigid-as-possible shape manipulation in two linear steps (Igarashi, Moscovich & Hughes 2005).
//!
//! A triangle with corners v₀, v₁, v₂ knows v₂ in the frame of the other two: v₂ = v₀ + x (v₁ − v₀) + y R₉₀ (v₁ − v₀).
//!
//! 1. **Similarity.** Place all vertices so that in each triangle each corner stands, as well as possible, where this
//!    says it should, handles given: least squares in coordinates x and y together (their section 4.1). The result may
//!    shrink and grow.
//! 2. **Scale.** Each triangle as it was is turned to fit its placed corners best, without scaling, and the vertices
//!    are placed anew so that edges match those of the turned triangles (section 4.2). x and y are separate here.
//!
//! Both matrices depend on the mesh and on which vertices are handles, not on where these are: they are factored once
//! ([`Solver::new`]); a frame costs two substitutions ([`Solver::solve`]). Written with complex numbers z = x + iy,
//! step 1 has a Hermitian matrix of half the size; here it is solved as the real symmetric one, by sparse Cholesky.
//!
//! Each triangle may be given a weight (per-limb rigidity): both steps minimise weighted sums.
//!
//! Limits: step 1 needs two handles that do not coincide, otherwise scale and turn are free; with one handle (or
//! several on one spot) the mesh is shifted. Triangles without area have no frame and are refused by [`Mesh::new`].

use rototoon_base::geometry::Point;
use rototoon_base::numeric::cholesky::SparseCholesky;

/// Triangles with less than this share of the area of an equilateral one on their longest edge are slivers.
const SLIVER: f64 = 1e-6;
/// Handles within this share of the mesh's size of each other are on one spot.
const ONE_SPOT: f64 = 1e-12;

/// What is wrong with a mesh or its handles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArapError {
    /// A vertex is not finite.
    #[error("vertex {vertex}: found {found}, expected finite coordinates")]
    Vertex {
        /// Its index.
        vertex: usize,
        /// What was found.
        found: Point,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle}: found vertex {found}, expected 0 to {last}")]
    Corner {
        /// Its index.
        triangle: usize,
        /// The vertex it names.
        found: usize,
        /// The last vertex.
        last: usize,
    },
    /// A triangle has no area.
    #[error("triangle {triangle}: found area {found}, expected a triangle that is not a sliver")]
    Sliver {
        /// Its index.
        triangle: usize,
        /// Its area.
        found: f64,
    },
    /// A vertex belongs to no triangle.
    #[error("vertex {vertex}: found in no triangle, expected in at least one")]
    Loose {
        /// Its index.
        vertex: usize,
    },
    /// There is not exactly one positive, finite weight for each triangle.
    #[error("rigidity: found {found} weights, expected {triangles} positive ones, one for each triangle")]
    Weights {
        /// Number of weights.
        found: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A handle is not there, or stands twice.
    #[error("handle {handle}: found vertex {found}, expected each of 0 to {last} at most once")]
    Handle {
        /// Its place in the list.
        handle: usize,
        /// The vertex it names.
        found: usize,
        /// The last vertex.
        last: usize,
    },
    /// There is not exactly one finite position for each handle.
    #[error("places: found {found}, expected {expected} finite ones, one for each handle")]
    Places {
        /// Number of places.
        found: usize,
        /// Number of handles.
        expected: usize,
    },
    /// A piece of the mesh has no handle, or only one if the mesh has several pieces. Its rotation would be
    /// undetermined.
    #[error(
        "vertex {vertex}: found too few handles on its piece of the mesh, expected two (one if the mesh is one piece)"
    )]
    Adrift {
        /// A vertex of the piece.
        vertex: usize,
    },
}

/// A triangle mesh at rest.
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vec<Point>,
    triangles: Vec<[usize; 3]>,
    weights: Vec<f64>,
}

impl Mesh {
    /// A mesh of equal rigidity everywhere.
    pub fn new(vertices: Vec<Point>, triangles: Vec<[usize; 3]>) -> Result<Self, ArapError> {
        let weights = vec![1.0; triangles.len()];
        Self::with_rigidity(vertices, triangles, weights)
    }

    /// A mesh with a weight a triangle: of two triangles that cannot both stay rigid, the heavier bends less.
    pub fn with_rigidity(
        vertices: Vec<Point>,
        triangles: Vec<[usize; 3]>,
        weights: Vec<f64>,
    ) -> Result<Self, ArapError> {
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(ArapError::Vertex { vertex, found: vertices[vertex] });
        }
        if weights.len() != triangles.len() || weights.iter().any(|w| !(*w > 0.0 && w.is_finite())) {
            return Err(ArapError::Weights { found: weights.len(), triangles: triangles.len() });
        }
        let mut used = vec![false; vertices.len()];
        for (triangle, corners) in triangles.iter().enumerate() {
            for &corner in corners {
                let last = vertices.len().saturating_sub(1);
                *used.get_mut(corner).ok_or(ArapError::Corner { triangle, found: corner, last })? = true;
            }
            let [a, b, c] = corners.map(|corner| vertices[corner]);
            let area = 0.5 * (b - a).perp_dot(c - a);
            let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            // Not finite or zero: no frame either.
            if area.abs().partial_cmp(&(SLIVER * 0.433 * longest)) != Some(std::cmp::Ordering::Greater) {
                return Err(ArapError::Sliver { triangle, found: area });
            }
        }
        match used.iter().position(|is| !is) {
            Some(vertex) => Err(ArapError::Loose { vertex }),
            None => Ok(Self { vertices, triangles, weights }),
        }
    }

    /// The vertices at rest.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// The triangles, three vertices each.
    pub fn triangles(&self) -> &[[usize; 3]] {
        &self.triangles
    }
}

/// A symmetric matrix of free unknowns, factored, and what handles contribute to the right-hand side.
struct System {
    factor: Option<SparseCholesky>,
    /// Row, column among handles, value: −value · handle is added to the right-hand side.
    coupling: Vec<(usize, usize, f64)>,
}

impl System {
    /// From entries of the whole symmetric matrix, which are summed; `place[v]` is `Ok(free)` or `Err(handle)`.
    fn new(entries: &[(usize, usize, f64)], place: &[Result<usize, usize>], free: usize) -> Option<Self> {
        let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); free];
        let mut coupling = Vec::new();
        for &(a, b, value) in entries {
            match (place[a], place[b]) {
                (Ok(i), Ok(j)) if i >= j => columns[j].push((i, value)),
                (Ok(i), Err(h)) => coupling.push((i, h, value)),
                _ => {}
            }
        }
        if free == 0 {
            return Some(Self { factor: None, coupling });
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::<f64>::new());
        for column in &mut columns {
            column.sort_by_key(|(row, _)| *row); // stable: sums keep the order of the triangles
            let first = rows.len();
            for &(row, value) in column.iter() {
                if rows.len() > first && rows.last() == Some(&row) {
                    *values.last_mut()? += value;
                } else {
                    rows.push(row);
                    values.push(value);
                }
            }
            starts.push(rows.len());
        }
        let mut factor = SparseCholesky::new(free, starts, rows);
        factor.factor(&values).ok()?;
        Some(Self { factor: Some(factor), coupling })
    }

    fn solve(&mut self, right: &mut [f64]) {
        if let Some(factor) = &mut self.factor {
            factor.solve(right);
        }
    }
}

/// A mesh with chosen handles, ready to be posed again and again.
pub struct Solver {
    mesh: Mesh,
    handles: Vec<usize>,
    place: Vec<Result<usize, usize>>,
    free: usize,
    similarity: Option<System>,
    scale: System,
    /// Places of the first step, kept between frames.
    first: Vec<Point>,
}

impl Solver {
    /// Factors both steps for handles at these vertices.
    pub fn new(mesh: Mesh, handles: &[usize]) -> Result<Self, ArapError> {
        let n = mesh.vertices.len();
        let mut place: Vec<Result<usize, usize>> = vec![Ok(0); n];
        for (k, &vertex) in handles.iter().enumerate() {
            let found = ArapError::Handle { handle: k, found: vertex, last: n.saturating_sub(1) };
            match place.get_mut(vertex) {
                Some(slot @ Ok(_)) => *slot = Err(k),
                _ => return Err(found),
            }
        }
        let mut free = 0;
        for slot in place.iter_mut().flatten() {
            *slot = free;
            free += 1;
        }
        if let Some(vertex) = adrift(&mesh, handles) {
            return Err(ArapError::Adrift { vertex });
        }
        // Unknown 2v is x of vertex v, 2v + 1 its y; of handles likewise.
        let double = |slot: &Result<usize, usize>, axis: usize| match slot {
            Ok(i) => Ok(2 * i + axis),
            Err(h) => Err(2 * h + axis),
        };
        let both: Vec<Result<usize, usize>> =
            place.iter().flat_map(|slot| [double(slot, 0), double(slot, 1)]).collect();
        let similarity = System::new(&similarity_entries(&mesh), &both, 2 * free);
        let scale = System::new(&edge_entries(&mesh), &place, free).ok_or(ArapError::Adrift { vertex: 0 })?;
        let first = mesh.vertices.clone();
        Ok(Self { mesh, handles: handles.to_vec(), place, free, similarity, scale, first })
    }

    /// Places of all vertices for places of the handles, in their order.
    pub fn solve(&mut self, places: &[Point]) -> Result<Vec<Point>, ArapError> {
        if places.len() != self.handles.len() || places.iter().any(|p| !p.is_finite()) {
            return Err(ArapError::Places { found: places.len(), expected: self.handles.len() });
        }
        if self.on_one_spot() {
            let shift = places[0] - self.mesh.vertices[self.handles[0]];
            return Ok(self.mesh.vertices.iter().map(|v| *v + shift).collect());
        }
        self.place_similar(places);
        Ok(self.place_rigid(places))
    }

    /// The mesh at rest.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn on_one_spot(&self) -> bool {
        let at = |h: usize| self.mesh.vertices[self.handles[h]];
        let size = self.mesh.vertices.iter().map(|v| v.distance_squared(at(0))).fold(0.0, f64::max);
        self.similarity.is_none()
            || (1..self.handles.len()).all(|h| at(h).distance_squared(at(0)) <= ONE_SPOT * ONE_SPOT * size)
    }

    fn place_similar(&mut self, places: &[Point]) {
        let Some(system) = &mut self.similarity else { return };
        let mut right = vec![0.0; 2 * self.free];
        for &(row, handle, value) in &system.coupling {
            right[row] -= value * places[handle / 2][handle % 2];
        }
        system.solve(&mut right);
        for (vertex, slot) in self.place.iter().enumerate() {
            self.first[vertex] = match slot {
                Ok(i) => Point::new(right[2 * i], right[2 * i + 1]),
                Err(h) => places[*h],
            };
        }
    }

    fn place_rigid(&mut self, places: &[Point]) -> Vec<Point> {
        let n = self.free;
        let mut right = vec![0.0; 2 * n];
        for (corners, weight) in self.mesh.triangles.iter().zip(&self.mesh.weights) {
            let rest = corners.map(|c| self.mesh.vertices[c]);
            let now = corners.map(|c| self.first[c]);
            let turn = rotation(&rest, &now);
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let edge = turn.rotate(rest[b] - rest[a]) * *weight;
                for (corner, sign) in [(a, -1.0), (b, 1.0)] {
                    if let Ok(i) = self.place[corners[corner]] {
                        right[i] += sign * edge.x;
                        right[n + i] += sign * edge.y;
                    }
                }
            }
        }
        for &(row, handle, value) in &self.scale.coupling {
            right[row] -= value * places[handle].x;
            right[n + row] -= value * places[handle].y;
        }
        self.scale.solve(&mut right);
        let at = |slot: &Result<usize, usize>| match slot {
            Ok(i) => Point::new(right[*i], right[n + *i]),
            Err(h) => places[*h],
        };
        self.place.iter().map(at).collect()
    }
}

/// Poses a mesh once; the same as a [`Solver`] that is used once.
pub fn deform(mesh: &Mesh, handles: &[usize], places: &[Point]) -> Result<Vec<Point>, ArapError> {
    Solver::new(mesh.clone(), handles)?.solve(places)
}

/// A vertex of a piece with too few handles.
fn adrift(mesh: &Mesh, handles: &[usize]) -> Option<usize> {
    let mut parent: Vec<usize> = (0..mesh.vertices.len()).collect();
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    for [a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (x, y) = (root(&mut parent, *a), root(&mut parent, *other));
            parent[x.max(y)] = x.min(y);
        }
    }
    let mut held = vec![0; mesh.vertices.len()];
    for &handle in handles {
        held[root(&mut parent, handle)] += 1;
    }
    let pieces = (0..parent.len()).filter(|&v| parent[v] == v).count();
    let needed = if pieces > 1 { 2 } else { 1 };
    (0..mesh.vertices.len()).find(|&v| held[root(&mut parent, v)] < needed)
}

/// The unit complex number that turns centred `rest` best onto centred `now`.
fn rotation(rest: &[Point; 3], now: &[Point; 3]) -> Point {
    let middle = |p: &[Point; 3]| (p[0] + p[1] + p[2]) / 3.0;
    let (r, q) = (middle(rest), middle(now));
    let sum = (0..3).map(|k| {
        let (a, b) = (rest[k] - r, now[k] - q);
        Point::new(a.dot(b), a.perp_dot(b))
    });
    sum.sum::<Point>().try_normalize().unwrap_or(Point::X)
}

/// Step 1: Σ w ‖v_c − v_a − x (v_b − v_a) − y R (v_b − v_a)‖² over triangles and their three corners.
fn similarity_entries(mesh: &Mesh) -> Vec<(usize, usize, f64)> {
    let mut entries = Vec::with_capacity(36 * mesh.triangles.len());
    for (corners, weight) in mesh.triangles.iter().zip(&mesh.weights) {
        let mut local = [[0.0; 6]; 6];
        for k in 0..3 {
            let [a, b, c] = [k, (k + 1) % 3, (k + 2) % 3];
            let at = |corner: usize| mesh.vertices[corners[corner]];
            let (base, arm) = (at(b) - at(a), at(c) - at(a));
            let frame = Point::new(base.dot(arm), base.perp_dot(arm)) / base.length_squared();
            let (x, y) = (frame.x, frame.y);
            // R(x, y) = (−y, x): the rows of the residual's x and y.
            let rows = [
                [(2 * c, 1.0), (2 * a, x - 1.0), (2 * b, -x), (2 * a + 1, -y), (2 * b + 1, y)],
                [(2 * c + 1, 1.0), (2 * a + 1, x - 1.0), (2 * b + 1, -x), (2 * a, y), (2 * b, -y)],
            ];
            for row in rows {
                for (i, p) in row {
                    row.iter().for_each(|&(j, q)| local[i][j] += weight * p * q);
                }
            }
        }
        let global = |i: usize| 2 * corners[i / 2] + i % 2;
        entries.extend((0..36).map(|k| (global(k / 6), global(k % 6), local[k / 6][k % 6])));
    }
    entries
}

/// Step 2: Σ w ‖(v_b − v_a) − edge‖².
fn edge_entries(mesh: &Mesh) -> Vec<(usize, usize, f64)> {
    let corner =
        |k: usize, corners: &[usize; 3]| (corners[k / 3], corners[k % 3], if k / 3 == k % 3 { 2.0 } else { -1.0 });
    let of = |(corners, weight): (&[usize; 3], &f64)| -> [(usize, usize, f64); 9] {
        std::array::from_fn(|k| {
            let (i, j, value) = corner(k, corners);
            (i, j, weight * value)
        })
    };
    mesh.triangles.iter().zip(&mesh.weights).flat_map(of).collect()
}

#[cfg(test)]
mod tests;
