//! Triangulates the area that outlines enclose.
//!
//! The mesh is a constrained Delaunay triangulation, refined after Ruppert 1995 and Chew 1993 (crate `spade`). Edges of
//! the outlines stay edges. No angle is smaller than [`LEAST_ANGLE`], except where the outlines themselves are sharper.
//! No triangle is much larger than an equilateral triangle on the requested edge.
//!
//! Drawn outlines are not always clean, so they are repaired first. Points at one spot count once, and long segments
//! are divided. Where lines cross, the crossing becomes a vertex (`constraints.rs`). The winding number defines the enclosed area: it is
//! not 0 in the outlines and 0 in the holes. As in rendering, an outline that folds over itself has no hole at the
//! fold.
//!
//! Limits: triangles are not refined where an outline covers itself an even number of times. Detail finer than a tenth
//! of the requested edge is smoothed away. Triangles that remain slivers, at crossings of a tiny angle, are left out.

use rototoon_base::geometry::{Point, polygon, polyline};
use spade::{AngleLimit, RefinementParameters, Triangulation};
use std::collections::BTreeMap;

mod constraints;

use constraints::{Mesh, constrain, insert};

/// Smallest angle of refined triangles in degrees. Refinement is proven to end below 20.7; at this angle it nearly
/// always ends.
pub const LEAST_ANGLE: f64 = 25.0;
/// A point closer to the previous one than this share of the requested edge is left out.
const SHORTEST: f64 = 0.1;
/// Least distance of inner vertices that are given from each other and from the outlines, in edges.
const APART: f64 = 0.35;
/// Largest triangle, in areas of the equilateral triangle on the requested edge.
const LARGEST: f64 = 1.6;
/// Triangles smaller than this share of the square of the requested edge are not refined further. They occur at sharp
/// ends of outlines.
const SMALLEST: f64 = 0.04;
/// Triangles with less than this share of the area of the equilateral triangle on their longest edge are slivers.
const SLIVER: f64 = 1e-5;
/// Limit of the vertices that refinement adds: for each point of the outlines, and for each triangle of the largest
/// size in their bounding box.
const MOST: [f64; 2] = [10.0, 4.0];

/// Greatest number of edges around an outline. A character's part has 24 to 200; a hairy one has not ten times as many.
/// A single point set far away by mistake gives any number.
const MOST_EDGES: f64 = 4000.0;

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TriangulateError {
    /// A coordinate is not finite or too large.
    #[error("outline {outline}, point {point}: found {found}, expected numbers between -1e9 and 1e9")]
    Point {
        /// Index of the outline.
        outline: usize,
        /// Index of the point.
        point: usize,
        /// Its coordinates.
        found: Point,
    },
    /// An outline encloses no area.
    #[error("outline {outline}: found no enclosed area (its points are on a line or at one spot), expected some")]
    Flat {
        /// Index of the outline.
        outline: usize,
    },
    /// There are no outlines, or the holes take all of the area.
    #[error("outlines: found no area inside of them and outside of the holes, expected some")]
    Nothing,
    /// An outline is so long around its area that its mesh would grow without bound.
    #[error(
        "outline {outline}: found {length:.0} px around an area whose triangles have edges of {edge:.2} px, expected at \
         most {MOST_EDGES} such edges; point {point} is far away"
    )]
    Long {
        /// Index of the outline.
        outline: usize,
        /// Length of the outline in pixels.
        length: f64,
        /// The requested edge in pixels.
        edge: f64,
        /// Index of the point farthest from the median of the outline's points.
        point: usize,
    },
    /// The edge length is not positive and finite.
    #[error("edge: found {found}, expected a positive length")]
    Edge {
        /// The given length.
        found: f64,
    },
}

/// Vertices and triangles. Each triangle names three vertices, and all have the same orientation.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangles {
    /// Positions of the vertices.
    pub vertices: Vec<Point>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[usize; 3]>,
}

/// Triangulates the area within `outlines` and outside of `holes`, with edges of about the length `edge`, in pixels.
///
/// # Errors
///
/// A [`TriangulateError`]; holes are numbered after the outlines.
pub fn triangulate(outlines: &[Vec<Point>], holes: &[Vec<Point>], edge: f64) -> Result<Triangles, TriangulateError> {
    triangulate_with(outlines, holes, &[], edge)
}

/// Like [`triangulate`], with vertices at the places `inner`, in pixels. A place outside, or nearer than 0.35 edges to an outline or
/// to a place before it, has none.
///
/// # Errors
///
/// As for [`triangulate`].
pub fn triangulate_with(
    outlines: &[Vec<Point>],
    holes: &[Vec<Point>],
    inner: &[Point],
    edge: f64,
) -> Result<Triangles, TriangulateError> {
    if !(edge > 0.0 && edge.is_finite()) {
        return Err(TriangulateError::Edge { found: edge });
    }
    let rings: Vec<Vec<Point>> =
        outlines.iter().chain(holes).enumerate().map(|(k, ring)| cleaned(k, ring, edge)).collect::<Result<_, _>>()?;
    let (outside, inside) = rings.split_at(outlines.len());
    let mut mesh = Mesh::new();
    constrain(&mut mesh, &rings);
    for p in apart(inner, &rings, APART * edge) {
        insert(&mut mesh, p);
    }
    let largest = LARGEST * 3f64.sqrt() / 4.0 * edge * edge;
    // The area outside of the outlines is not refined: the flat angles between an outline and its hull would produce
    // tiny triangles.
    let parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_deg(LEAST_ANGLE))
        .with_max_allowed_area(largest)
        .with_min_required_area(SMALLEST * edge * edge)
        .with_max_additional_vertices(most(&rings, largest));
    mesh.refine(parameters);
    collect(&mesh, outside, inside)
}

/// The places within rings that are at least this far from the rings and from the places before them.
fn apart(places: &[Point], rings: &[Vec<Point>], least: f64) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for &p in places.iter().filter(|p| p.is_finite()) {
        let free = rings.iter().all(|ring| polyline::distance(p, ring, true) >= least)
            && kept.iter().all(|q| q.distance(p) >= least);
        if free && rings.iter().any(|ring| winding(ring, p) != 0) {
            kept.push(p);
        }
    }
    kept
}

/// A ring without repeated points and without segments longer than an edge.
fn cleaned(outline: usize, ring: &[Point], edge: f64) -> Result<Vec<Point>, TriangulateError> {
    if let Some(point) = polyline::first_unusable(ring) {
        return Err(TriangulateError::Point { outline, point, found: ring[point] });
    }
    let mut kept: Vec<Point> = Vec::with_capacity(ring.len());
    for &p in ring {
        if kept.last().is_none_or(|last| last.distance(p) > SHORTEST * edge) {
            kept.push(p);
        }
    }
    while kept.len() > 1 && kept[0].distance(kept[kept.len() - 1]) <= SHORTEST * edge {
        kept.pop();
    }
    let length = polyline::length(&kept, true);
    let encloses = |share: f64| kept.len() >= 3 && encloses(&kept, share * length * length);
    // Beside a point far away any area is a small share, so here only rounding counts as none.
    if length > MOST_EDGES * edge && encloses(f64::EPSILON) {
        return Err(TriangulateError::Long { outline, length, edge, point: farthest(ring) });
    }
    if !encloses(1e-6) {
        return Err(TriangulateError::Flat { outline });
    }
    let mut divided = Vec::with_capacity(kept.len());
    for (a, b) in polyline::segments(&kept, true) {
        let pieces = (a.distance(b) / edge).round().max(1.0);
        divided.extend((0..pieces as usize).map(|k| a.lerp(b, k as f64 / pieces)));
    }
    Ok(divided)
}

/// Index of the point farthest from the median of a ring's points.
fn farthest(ring: &[Point]) -> usize {
    let median = |of: fn(&Point) -> f64| {
        let mut values: Vec<f64> = ring.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let middle = Point::new(median(|p| p.x), median(|p| p.y));
    let away = |k: &usize| ring[*k].distance_squared(middle);
    (0..ring.len()).max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
}

/// Whether a ring encloses more than an area. Loops of opposite orientation do not cancel.
fn encloses(ring: &[Point], least: f64) -> bool {
    let fan: f64 = (1..ring.len() - 1).map(|k| (ring[k] - ring[0]).perp_dot(ring[k + 1] - ring[0]).abs()).sum();
    polygon::signed_area(ring).abs() > least || fan > 4.0 * least
}

/// Greatest number of vertices to add. Sharp ends would need ever more of them.
fn most(rings: &[Vec<Point>], largest: f64) -> usize {
    let points: Vec<Point> = rings.iter().flatten().copied().collect();
    let size = polygon::bounds(&points).map_or(Point::ZERO, |(low, high)| high - low);
    (MOST[0] * points.len() as f64 + MOST[1] * size.x * size.y / largest) as usize
}

/// Winding number of a ring about a point.
fn winding(ring: &[Point], p: Point) -> i32 {
    polyline::segments(ring, true)
        .map(|(a, b)| match (a.y <= p.y, b.y <= p.y) {
            (true, false) if (b - a).perp_dot(p - a) > 0.0 => 1,
            (false, true) if (b - a).perp_dot(p - a) < 0.0 => -1,
            _ => 0,
        })
        .sum()
}

fn collect(mesh: &Mesh, outlines: &[Vec<Point>], holes: &[Vec<Point>]) -> Result<Triangles, TriangulateError> {
    let mut number = vec![usize::MAX; mesh.num_vertices()];
    let mut found = Triangles { vertices: Vec::new(), triangles: Vec::new() };
    for face in mesh.inner_faces() {
        let corners = face.vertices();
        let at = corners.map(|v| Point::new(v.position().x, v.position().y));
        let middle = (at[0] + at[1] + at[2]) / 3.0;
        // Each outline counts by itself: two of opposite orientation do not cancel.
        let within = |rings: &[Vec<Point>]| rings.iter().any(|ring| winding(ring, middle) != 0);
        if !within(outlines) || within(holes) || is_sliver(&at) {
            continue;
        }
        found.triangles.push(std::array::from_fn(|k| {
            let slot = &mut number[corners[k].fix().index()];
            if *slot == usize::MAX {
                *slot = found.vertices.len();
                found.vertices.push(at[k]);
            }
            *slot
        }));
    }
    if found.triangles.is_empty() { Err(TriangulateError::Nothing) } else { Ok(found) }
}

fn is_sliver([a, b, c]: &[Point; 3]) -> bool {
    let longest = a.distance_squared(*b).max(b.distance_squared(*c)).max(c.distance_squared(*a));
    (*b - *a).perp_dot(*c - *a).abs() < 2.0 * SLIVER * 0.433 * longest
}

/// A point bound to a triangle. It moves as the weighted mean of the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Vertex indices of the corners.
    pub corners: [usize; 3],
    /// Weights of the corners; their sum is 1. A point outside of the mesh has negative weights.
    pub weights: [f64; 3],
}

impl Held {
    /// The point for given positions of the vertices.
    pub fn at(&self, places: &[Point]) -> Point {
        (0..3).map(|k| places[self.corners[k]] * self.weights[k]).sum()
    }
}

impl Triangles {
    /// The pieces of the mesh that are connected by edges, in descending order of area.
    pub fn pieces(&self) -> Vec<Self> {
        let mut owner: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut piece: Vec<usize> = (0..self.triangles.len()).collect();
        for (t, [a, b, c]) in self.triangles.iter().enumerate() {
            for (v, w) in [(a, b), (b, c), (c, a)] {
                if let Some(&other) = owner.get(&(*v.min(w), *v.max(w))) {
                    let (x, y) = (root(&mut piece, t), root(&mut piece, other));
                    piece[x.max(y)] = x.min(y);
                }
                owner.insert((*v.min(w), *v.max(w)), t);
            }
        }
        let mut found: BTreeMap<usize, Vec<[usize; 3]>> = BTreeMap::new();
        for (t, corners) in self.triangles.iter().enumerate() {
            found.entry(root(&mut piece, t)).or_default().push(*corners);
        }
        let mut pieces: Vec<Self> = found.into_values().map(|triangles| self.part(&triangles)).collect();
        pieces.sort_by(|a, b| b.area().total_cmp(&a.area()));
        pieces
    }

    /// Some of the triangles, with their vertices.
    fn part(&self, triangles: &[[usize; 3]]) -> Self {
        let mut number: BTreeMap<usize, usize> = BTreeMap::new();
        let mut vertices = Vec::new();
        let mut renumbered = |v: usize| {
            *number.entry(v).or_insert_with(|| {
                vertices.push(self.vertices[v]);
                vertices.len() - 1
            })
        };
        let triangles = triangles.iter().map(|corners| corners.map(&mut renumbered)).collect();
        Self { vertices, triangles }
    }

    fn area(&self) -> f64 {
        self.triangles.iter().map(|t| polygon::signed_area(&t.map(|v| self.vertices[v])).abs()).sum()
    }

    /// Binds a point to the triangle that contains it, or to the nearest one.
    pub fn hold(&self, p: Point) -> Held {
        let weights = |corners: &[usize; 3]| {
            let [a, b, c] = corners.map(|v| self.vertices[v]);
            let area = (b - a).perp_dot(c - a);
            let (u, v) = ((p - a).perp_dot(c - a) / area, (b - a).perp_dot(p - a) / area);
            [1.0 - u - v, u, v]
        };
        let away = |corners: &[usize; 3]| {
            if weights(corners).iter().all(|w| *w >= 0.0) {
                return 0.0;
            }
            let [a, b, c] = corners.map(|v| self.vertices[v]);
            [(a, b), (b, c), (c, a)]
                .into_iter()
                .map(|(s, e)| p.distance_squared(polyline::nearest_on_segment(p, s, e)))
                .fold(f64::INFINITY, f64::min)
        };
        let mut best = (f64::INFINITY, self.triangles[0]);
        for corners in &self.triangles {
            let distance = away(corners);
            if distance < best.0 {
                best = (distance, *corners);
            }
        }
        Held { corners: best.1, weights: weights(&best.1) }
    }
}

/// The representative of the piece that a triangle belongs to (union–find).
fn root(piece: &mut [usize], mut t: usize) -> usize {
    while piece[t] != t {
        piece[t] = piece[piece[t]];
        t = piece[t];
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::slice::from_ref;

    fn ring(count: usize, radius: f64, wave: f64) -> Vec<Point> {
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / count as f64;
            Point::from_angle(angle) * (radius + wave * (5.0 * angle).sin()) + Point::new(100.0, 80.0)
        };
        (0..count).map(at).collect()
    }

    fn area(mesh: &Triangles) -> f64 {
        let of = |t: &[usize; 3]| polygon::signed_area(&t.map(|v| mesh.vertices[v]));
        mesh.triangles.iter().map(|t| of(t).abs()).sum()
    }

    fn least_angle(mesh: &Triangles) -> f64 {
        let angle = |t: &[usize; 3], k: usize| {
            let [a, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]].map(|v| mesh.vertices[v]);
            (b - a).angle_to(c - a).abs().to_degrees()
        };
        mesh.triangles.iter().flat_map(|t| (0..3).map(|k| angle(t, k))).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_wavy_ring_is_filled_with_good_triangles() {
        let outline = ring(60, 50.0, 8.0);
        let mesh = triangulate(std::slice::from_ref(&outline), &[], 6.0).unwrap();
        assert!((area(&mesh) / polygon::signed_area(&outline).abs() - 1.0).abs() < 1e-3);
        assert!(least_angle(&mesh) > 20.0, "{}", least_angle(&mesh));
        assert!((200..1200).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
        crate::arap::Mesh::new(mesh.vertices, mesh.triangles).unwrap();
    }

    #[test]
    fn a_point_far_away_is_named() {
        let spike = |far: f64| {
            let ring = [[71.0, 22.0], [71.0, 58.0], [61.0, 58.0], [61.0, far], [61.0, 34.0], [61.0, 22.0]];
            triangulate(&[ring.map(|[x, y]| Point::new(x, y)).into()], &[], 3.0)
        };
        assert!(spike(3000.0).is_ok());
        for far in [1e5, 1e6, 1e9] {
            let error = spike(far).unwrap_err();
            assert!(matches!(error, TriangulateError::Long { outline: 0, point: 3, .. }), "{error}");
        }
    }

    #[test]
    fn holes_stay_open() {
        let (outline, hole) = (ring(60, 50.0, 0.0), ring(30, 20.0, 0.0));
        let mesh = triangulate(from_ref(&outline), from_ref(&hole), 6.0).unwrap();
        let wanted = polygon::signed_area(&outline).abs() - polygon::signed_area(&hole).abs();
        assert!((area(&mesh) / wanted - 1.0).abs() < 1e-2);
        assert!(least_angle(&mesh) > 20.0);
        assert_eq!(triangulate(from_ref(&hole), &[outline], 6.0), Err(TriangulateError::Nothing));
    }

    #[test]
    fn an_outline_that_crosses_itself_is_filled_by_winding() {
        let v = Point::new;
        // Two squares in a figure of eight, and an outline that folds over itself.
        let eight = vec![v(0.0, 0.0), v(40.0, 40.0), v(40.0, 0.0), v(0.0, 40.0)];
        let mesh = triangulate(&[eight], &[], 5.0).unwrap();
        assert!((area(&mesh) - 800.0).abs() < 1.0, "{}", area(&mesh));
        assert_eq!(mesh.pieces().len(), 2, "its halves touch in a point");
        let mut twice = vec![v(0.0, 0.0), v(30.0, 0.0), v(30.0, 30.0), v(0.0, 30.0)];
        twice.extend([v(0.0, 0.0), v(20.0, 0.0), v(20.0, 20.0), v(0.0, 20.0)]);
        let mesh = triangulate(&[twice], &[], 5.0).unwrap();
        assert!((area(&mesh) - 900.0).abs() < 1.0, "{}", area(&mesh));
    }

    #[test]
    fn an_outline_that_runs_back_nearly_over_itself_is_filled_by_winding() {
        // Found by fuzzing: rounded crossings lie so that they change the order along a line.
        let ring = [
            [8.056640625, 11.0478515625],
            [27.849609375, 29.1083984375],
            [8.056640625, 11.0478515625],
            [14.6201171875, 24.3486328125],
            [25.34765625, 29.109375],
            [8.6123046875, 14.533203125],
            [12.0361328125, 25.0498046875],
            [27.609375, 8.6005859375],
            [8.53125, 26.349609375],
            [29.1123046875, 14.533203125],
            [8.056640625, 11.0478515625],
            [8.53125, 24.35546875],
            [8.61328125, 8.056640625],
            [8.04296875, 25.533203125],
        ]
        .map(|[x, y]| Point::new(x, y));
        let mesh = triangulate(&[ring.into()], &[], 2.272419664151746).unwrap();
        let inside =
            |k: i32| winding(&ring, Point::new(f64::from(k % 300), f64::from(k / 300)) * 0.1 + Point::splat(5.03));
        let wanted = (0..300 * 300).filter(|&k| inside(k) != 0).count() as f64 * 0.01;
        assert!((area(&mesh) / wanted - 1.0).abs() < 0.01, "found {}, expected {wanted}", area(&mesh));
    }

    #[test]
    fn sharp_tips_end() {
        let v = Point::new;
        let needle = vec![v(0.0, 0.0), v(200.0, 1.0), v(0.0, 2.0)];
        let mesh = triangulate(&[needle], &[], 4.0).unwrap();
        assert!(mesh.vertices.len() < 3_000, "{}", mesh.vertices.len());
        crate::arap::Mesh::new(mesh.vertices, mesh.triangles).unwrap();
    }

    #[test]
    fn points_are_held_inside_and_outside() {
        let mesh = triangulate(&[ring(24, 30.0, 0.0)], &[], 8.0).unwrap();
        for p in [Point::new(101.0, 82.0), Point::new(140.0, 80.0), mesh.vertices[3]] {
            let held = mesh.hold(p);
            assert!(held.at(&mesh.vertices).distance(p) < 1e-9);
            let turn = |q: &Point| Point::from_angle(0.4).rotate(*q) + Point::new(3.0, 4.0);
            let moved: Vec<Point> = mesh.vertices.iter().map(turn).collect();
            assert!(held.at(&moved).distance(turn(&p)) < 1e-9);
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let v = Point::new;
        let flat = vec![v(0.0, 0.0), v(5.0, 5.0), v(10.0, 10.0)];
        assert_eq!(triangulate(&[ring(9, 5.0, 0.0), flat], &[], 1.0), Err(TriangulateError::Flat { outline: 1 }));
        assert_eq!(triangulate(&[vec![]], &[], 1.0), Err(TriangulateError::Flat { outline: 0 }));
        let broken = vec![v(0.0, 0.0), v(f64::NAN, 0.0), v(1.0, 1.0)];
        let error = triangulate(&[broken], &[], 1.0).unwrap_err().to_string();
        assert!(error.starts_with("outline 0, point 1: found [NaN, 0], expected"), "{error}");
        assert!(matches!(triangulate(&[], &[], 0.0), Err(TriangulateError::Edge { found: 0.0 })));
        assert_eq!(triangulate(&[], &[], 1.0), Err(TriangulateError::Nothing));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn any_scribble_gives_a_usable_mesh_or_an_error(points in prop::collection::vec((0.0f64..60.0, 0.0f64..60.0), 3..14)) {
            let outline: Vec<Point> = points.into_iter().map(Point::from).collect();
            if let Ok(mesh) = triangulate(std::slice::from_ref(&outline), &[], 6.0) {
                prop_assert!(crate::arap::Mesh::new(mesh.vertices.clone(), mesh.triangles.clone()).is_ok());
                prop_assert_eq!(triangulate(&[outline], &[], 6.0).unwrap(), mesh);
            }
        }
    }
}
