//! Adds outlines to a Delaunay triangulation as edges that stay.
//!
//! An outline may cross itself and others. The two edges of a crossing become four, which meet in a new vertex. Its spot
//! is rounded, so a half may no longer lie on the line of its edge and may cross a third edge. Therefore every half is
//! added like an edge: it may be divided again.
//!
//! The crate divides edges as well (`add_constraint_and_split`), but it takes for granted that rounding changes no order
//! along a line. It panics where an outline runs back nearly over itself.
//!
//! Limit: after [`MOST_PER_EDGE`] divisions for each edge, edges that cross others are left out. The mesh then has the
//! same area, but its border is less exact there.

use rototoon_base::geometry::Point;
use spade::handles::{FixedUndirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// A mesh in the making.
pub type Mesh = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Divisions that are allowed for each edge of the outlines. Two random edges in a square cross with probability 25/108,
/// so a scribble of 1000 edges needs about 116 for each.
const MOST_PER_EDGE: usize = 1000;

/// Adds the edges of rings. Coordinates must be finite.
pub fn constrain(mesh: &mut Mesh, rings: &[Vec<Point>]) {
    let mut left = MOST_PER_EDGE * rings.iter().map(Vec::len).sum::<usize>();
    for ring in rings {
        let vertices: Vec<_> = ring.iter().filter_map(|&p| insert(mesh, p)).collect();
        for k in 0..vertices.len() {
            add(mesh, vertices[k], vertices[(k + 1) % vertices.len()], &mut left);
        }
    }
}

/// Adds one edge, divided where it crosses others.
fn add(mesh: &mut Mesh, from: FixedVertexHandle, to: FixedVertexHandle, left: &mut usize) {
    // Edges to add; the last one is next, so the halves of an edge come before what follows it.
    let mut edges = vec![(from, to)];
    while let Some((from, to)) = edges.pop() {
        if from == to || !mesh.try_add_constraint(from, to).is_empty() || *left == 0 {
            continue;
        }
        let Some((edge, ends)) = first_crossed(mesh, from, to) else { continue };
        let at = |vertex| position(mesh, vertex);
        let Some(spot) = crossing([at(from), at(to)], ends.map(at)) else { continue };
        *left -= 1;
        mesh.remove_constraint_edge(edge);
        let Some(middle) = insert(mesh, spot) else { continue };
        edges.extend([(middle, to), (from, middle), (middle, ends[1]), (ends[0], middle)]);
    }
}

/// The first edge of an outline that the line between two vertices crosses, with its ends.
fn first_crossed(
    mesh: &Mesh,
    from: FixedVertexHandle,
    to: FixedVertexHandle,
) -> Option<(FixedUndirectedEdgeHandle, [FixedVertexHandle; 2])> {
    let edge = mesh.get_conflicting_edges_between_vertices(from, to).next()?;
    Some((edge.as_undirected().fix(), edge.vertices().map(|vertex| vertex.fix())))
}

/// The spot where two lines cross. `None` if they are parallel.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Point> {
    let share = (c - a).perp_dot(d - c) / (b - a).perp_dot(d - c);
    share.is_finite().then(|| a.lerp(b, share.clamp(0.0, 1.0)))
}

fn position(mesh: &Mesh, vertex: FixedVertexHandle) -> Point {
    let p = mesh.vertex(vertex).position();
    Point::new(p.x, p.y)
}

pub fn insert(mesh: &mut Mesh, p: Point) -> Option<FixedVertexHandle> {
    mesh.insert(Point2::new(p.x, p.y)).ok()
}
