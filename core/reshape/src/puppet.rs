//! A drawn part that follows the limbs that carry it (Liang et al. 2012, section 5).
//!
//! A part is triangulated from its outline ([`super::triangulate`]), with vertices at the key points of its limbs and at
//! samples of the limbs' splines (sub-key points, eq. 11). They become handles; where a place is too near the outline or
//! another one, the nearest vertex does. Each handle belongs
//! to a point of the spline at rest. On a frame this point moves to the same parameter of the new spline; the offset
//! from it to the vertex rotates with the spline. At a joint a vertex follows both limbs. The mesh follows as rigidly as
//! possible ([`super::arap`]), and every point bound to the mesh follows it.
//!
//! The paper moves sub-key points from frame to frame, with both key points and then to the nearest point of the new
//! spline (eqs. 12 to 14, [`follow`]). As it says itself, errors then accumulate. Here each frame starts from the
//! drawing at rest, and the points keep their parameters. With [`Options::printed`] they move to the nearest point
//! instead; on a strongly curved limb they then slide together.
//!
//! Without sub-key points ([`Options::sub_keys`] 0) this is plain as-rigid-as-possible manipulation by key points,
//! which the paper compares with. Between the key points limbs then leave their splines. Sub-key points do not preserve
//! the width at a sharp elbow: they keep both limbs straight, and the inside of the bend is compressed.
//!
//! A part whose limbs carry it *whole* moves without bending or growing, however the lengths of its limbs change. A
//! head is an example: its key points are closer together than its width, and a skull neither stretches nor bends. The
//! part stays at the start of its first limb. Its rotation about that point fits the ends of all its limbs by least
//! squares; farther ends count more. A mesh would follow every change of the neck's length in the picture and stretch
//! into a drop.
//!
//! A part on a limb's end with fewer than two handles (a hand, a shoe, a hat) is rigid. It moves with the nearest point
//! of the spline and takes a share of its rotation.
//!
//! Limits: limbs and parts are planar. A part that turns out of the picture's plane needs a new drawing.

use super::arap::{ArapError, Mesh, Solver};
use super::limb::{Bend, follow, samples, sub_keys};
use super::triangulate::{Held, Triangles, TriangulateError, triangulate_with};
use rototoon_base::curve::quadratic::Quadratic;
use rototoon_base::geometry::{Point, polygon};

/// Triangle edges along a side of a square as large as the part.
const EDGES: f64 = 6.0;

/// Options of reshaping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Sub-key points of each limb; 0 gives plain as-rigid-as-possible manipulation by key points.
    pub sub_keys: usize,
    /// Whether sub-key points move to the nearest point of their spline, as printed ([`follow`]). Otherwise they keep
    /// their parameter along it. On strongly curved limbs the printed rule makes them slide together.
    pub printed: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { sub_keys: 5, printed: false }
    }
}

/// A limb on a frame, or in the drawing at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbPose {
    /// Its key points, start and end.
    pub ends: (Point, Point),
    /// Its bend.
    pub bend: Bend,
}

impl LimbPose {
    /// Its spline.
    pub fn spline(&self) -> Quadratic {
        self.bend.spline(self.ends.0, self.ends.1)
    }
}

/// A limb that carries a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrier {
    /// Index of the limb.
    pub limb: usize,
    /// Share of the limb's rotation that a rigid part takes.
    pub turn: f64,
    /// Weight of the triangles near the limb.
    pub rigidity: f64,
    /// Whether the part keeps its shape and size if all its carriers say so.
    pub whole: bool,
}

/// Why a part cannot be reshaped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PuppetError {
    /// The outline cannot be triangulated.
    #[error(transparent)]
    Outline(#[from] TriangulateError),
    /// The mesh cannot be posed.
    #[error(transparent)]
    Mesh(#[from] ArapError),
    /// No limb carries the part.
    #[error("carries: found no limb for the part, expected at least one")]
    NoCarrier,
}

/// A vertex that follows a limb.
#[derive(Clone, Copy, Debug)]
struct Handle {
    limb: usize,
    /// The point of the spline at rest.
    on: Point,
    /// Offset from that point to the vertex.
    offset: Point,
}

enum Drive {
    /// Moves with a point of a limb's spline.
    Rigid { carrier: Carrier, parameter: f64, points: Vec<Point> },
    /// Keeps its shape and size, and stays at the start of its first limb.
    Whole { limbs: Vec<usize>, turn: f64, points: Vec<Point> },
    /// Bends with its limbs.
    Mesh { solver: Box<Solver>, handles: Vec<Vec<Handle>>, held: Vec<Held> },
}

/// A part that can be posed repeatedly.
pub struct Puppet {
    rest: Vec<LimbPose>,
    drive: Drive,
    printed: bool,
}

impl Puppet {
    /// Prepares a part from its outline at rest, the points that shall follow it, all limbs of the character at rest,
    /// and the limbs that carry it.
    ///
    /// # Errors
    ///
    /// A [`PuppetError`].
    pub fn new(
        outline: &[Point],
        points: &[Point],
        rest: &[LimbPose],
        carriers: &[Carrier],
        options: &Options,
    ) -> Result<Self, PuppetError> {
        let Some(first) = carriers.first() else { return Err(PuppetError::NoCarrier) };
        let drive = match mesh(outline, points, rest, carriers, options)? {
            Some(_) if carriers.iter().all(|carrier| carrier.whole) => whole(points, rest, carriers),
            Some(drive) => drive,
            None => hanging(outline, points, rest, carriers).unwrap_or(Drive::Rigid {
                carrier: *first,
                parameter: 1.0,
                points: points.to_vec(),
            }),
        };
        Ok(Self { rest: rest.to_vec(), drive, printed: options.printed })
    }

    /// Whether the part moves without bending.
    pub fn is_rigid(&self) -> bool {
        !matches!(self.drive, Drive::Mesh { .. })
    }

    /// Positions of the points for the limbs of a frame. `limbs` contains all limbs of the character, in the order of
    /// the rest pose.
    ///
    /// # Errors
    ///
    /// [`PuppetError::Mesh`].
    pub fn pose(&mut self, limbs: &[LimbPose]) -> Result<Vec<Point>, PuppetError> {
        match &mut self.drive {
            Drive::Rigid { carrier, parameter, points } => {
                let (rest, now) = (self.rest[carrier.limb].spline(), limbs[carrier.limb].spline());
                let turn = Point::from_angle(carrier.turn * angle(&rest, &now, *parameter, *parameter));
                let (from, to) = (rest.point(*parameter), now.point(*parameter));
                Ok(points.iter().map(|p| to + turn.rotate(*p - from)).collect())
            }
            Drive::Whole { limbs: own, turn, points } => {
                let (from, to) = (self.rest[own[0]].ends.0, limbs[own[0]].ends.0);
                let ends = own.iter().map(|&k| (self.rest[k].ends.1 - from, limbs[k].ends.1 - to));
                let turn = Point::from_angle(*turn * turn_between(ends));
                Ok(points.iter().map(|p| to + turn.rotate(*p - from)).collect())
            }
            Drive::Mesh { solver, handles, held } => {
                let place = |h: &Handle| target(h, &self.rest[h.limb], &limbs[h.limb], self.printed);
                let mean = |on: &Vec<Handle>| on.iter().map(place).sum::<Point>() / on.len() as f64;
                let places: Vec<Point> = handles.iter().map(mean).collect();
                let vertices = solver.solve(&places)?;
                Ok(held.iter().map(|h| h.at(&vertices)).collect())
            }
        }
    }
}

/// The position of a handle on a frame.
fn target(handle: &Handle, rest: &LimbPose, now: &LimbPose, printed: bool) -> Point {
    let (before, after) = (rest.spline(), now.spline());
    let at = before.nearest(handle.on).parameter;
    let (on, there) = if printed {
        let on = follow(handle.on, rest.ends, now.ends, &after);
        (on, after.nearest(on).parameter)
    } else {
        (after.point(at), at)
    };
    let turn = angle(&before, &after, at, there);
    on + Point::from_angle(turn).rotate(handle.offset)
}

/// The angle from the direction of a spline at a parameter to that of another spline; 0 if one has no direction.
fn angle(from: &Quadratic, to: &Quadratic, at: f64, there: f64) -> f64 {
    let direction = |spline: &Quadratic, u: f64| {
        let tangent = (spline.p1 - spline.p0).lerp(spline.p2 - spline.p1, u);
        if tangent.length_squared() > 1e-18 { tangent } else { spline.p2 - spline.p0 }
    };
    let (a, b) = (direction(from, at), direction(to, there));
    if a.length_squared() > 1e-18 && b.length_squared() > 1e-18 { a.angle_to(b) } else { 0.0 }
}

/// The rotation about the origin that fits the first points of the pairs to the second by least squares, in radians.
fn turn_between(pairs: impl Iterator<Item = (Point, Point)>) -> f64 {
    let (cosine, sine) = pairs.fold((0.0, 0.0), |(c, s), (a, b)| (c + a.dot(b), s + a.perp_dot(b)));
    if cosine == 0.0 && sine == 0.0 { 0.0 } else { sine.atan2(cosine) }
}

/// A part that keeps its shape. It stays at the limb that starts where no other limb ends.
fn whole(points: &[Point], rest: &[LimbPose], carriers: &[Carrier]) -> Drive {
    let hangs = |a: &Carrier| {
        let start = rest[a.limb].ends.0;
        carriers.iter().any(|b| b.limb != a.limb && rest[b.limb].ends.1.distance(start) <= 1e-6)
    };
    let mut order = carriers.to_vec();
    order.sort_by_key(hangs); // stable: the first given limb wins ties
    let limbs = order.iter().map(|carrier| carrier.limb).collect();
    Drive::Whole { limbs, turn: order[0].turn, points: points.to_vec() }
}

/// The mesh of a part; `None` if it has too few handles.
fn mesh(
    outline: &[Point],
    points: &[Point],
    rest: &[LimbPose],
    carriers: &[Carrier],
    options: &Options,
) -> Result<Option<Drive>, PuppetError> {
    let edge = (polygon::signed_area(outline).abs().sqrt() / EDGES).max(1e-9);
    let inner = on_limbs(rest, carriers, options.sub_keys);
    let whole = triangulate_with(&[outline.to_vec()], &[], &inner, edge)?;
    // A piece joined to the rest by one vertex could rotate freely about it. Therefore only one piece, the largest with
    // enough handles, is posed. It carries all points.
    let posed = whole.pieces().into_iter().find_map(|piece| {
        let (vertices, handles) = handles(&piece, edge, rest, carriers, options);
        (vertices.len() > 1).then_some((piece, vertices, handles))
    });
    let Some((shape, vertices, handles)) = posed else { return Ok(None) };
    let weight = |corners: &[usize; 3]| {
        let middle = corners.map(|v| shape.vertices[v]).iter().sum::<Point>() / 3.0;
        let nearest = carriers.iter().min_by(|a, b| {
            let away = |c: &Carrier| rest[c.limb].spline().nearest(middle).distance;
            away(a).total_cmp(&away(b))
        });
        nearest.map_or(1.0, |carrier| carrier.rigidity)
    };
    let weights = shape.triangles.iter().map(weight).collect();
    let held = points.iter().map(|p| shape.hold(*p)).collect();
    let mesh = Mesh::with_rigidity(shape.vertices, shape.triangles, weights)?;
    match Solver::new(mesh, &vertices) {
        Ok(solver) => Ok(Some(Drive::Mesh { solver: Box::new(solver), handles, held })),
        // No limb reaches a piece of a torn outline; then the complete part is rigid.
        Err(ArapError::Adrift { .. }) => Ok(None),
        Err(other) => Err(other.into()),
    }
}

/// Places of limbs on which the mesh gets vertices: the ends first, then the samples between them. A vertex beside the limb would turn about
/// it, and where it lies is chance. They are in the order of their places, so that the order of the limbs changes nothing.
fn on_limbs(rest: &[LimbPose], carriers: &[Carrier], count: usize) -> Vec<Point> {
    let splines = || carriers.iter().map(|carrier| rest[carrier.limb].spline());
    let ends = splines().flat_map(|spline| [spline.p0, spline.p2]);
    let between = splines().flat_map(|spline| samples(&spline, count).collect::<Vec<_>>());
    let in_order = |mut places: Vec<Point>| {
        places.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        places
    };
    [in_order(ends.collect()), in_order(between.collect())].concat()
}

/// Vertices that follow limbs, each once, with the limbs that they follow. A point farther than an edge from the nearest vertex gets no
/// handle. At a joint two limbs take the same vertex: it follows both, whichever limb comes first.
fn handles(
    shape: &Triangles,
    edge: f64,
    rest: &[LimbPose],
    carriers: &[Carrier],
    options: &Options,
) -> (Vec<usize>, Vec<Vec<Handle>>) {
    let (mut vertices, mut found): (Vec<usize>, Vec<Vec<Handle>>) = (Vec::new(), Vec::new());
    for carrier in carriers {
        let pose = &rest[carrier.limb];
        let spline = pose.spline();
        let nearest = |p: Point| {
            let away = |v: &Point| v.distance_squared(p);
            (0..shape.vertices.len()).min_by(|&a, &b| away(&shape.vertices[a]).total_cmp(&away(&shape.vertices[b])))
        };
        let ends = [pose.ends.0, pose.ends.1].map(|p| (nearest(p), p));
        let between = sub_keys(&spline, &shape.vertices, options.sub_keys);
        let between = between.into_iter().map(|v| (Some(v), spline.nearest(shape.vertices[v]).point));
        for (vertex, on) in ends.into_iter().chain(between) {
            let Some(vertex) = vertex.filter(|v| shape.vertices[*v].distance(on) <= edge) else { continue };
            let handle = Handle { limb: carrier.limb, on, offset: shape.vertices[vertex] - on };
            match vertices.iter().position(|v| *v == vertex) {
                Some(known) if found[known].iter().any(|other: &Handle| other.limb == carrier.limb) => {}
                Some(known) => found[known].push(handle),
                None => {
                    vertices.push(vertex);
                    found.push(vec![handle]);
                }
            }
        }
    }
    (vertices, found)
}

/// A rigid part on the nearest of its limbs.
fn hanging(outline: &[Point], points: &[Point], rest: &[LimbPose], carriers: &[Carrier]) -> Option<Drive> {
    let middle = polygon::center(outline);
    let near = |carrier: &Carrier| rest[carrier.limb].spline().nearest(middle);
    let carrier = carriers.iter().min_by(|a, b| near(a).distance.total_cmp(&near(b).distance))?;
    Some(Drive::Rigid { carrier: *carrier, parameter: near(carrier).parameter, points: points.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::polyline;

    fn v(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    /// A straight arm of two limbs along x, 100 long and 20 wide.
    fn arm() -> (Vec<Point>, Vec<LimbPose>) {
        let straight = |a: Point, b: Point| LimbPose { ends: (a, b), bend: Bend::STRAIGHT };
        let line = [v(-5.0, -10.0), v(105.0, -10.0), v(105.0, 10.0), v(-5.0, 10.0)];
        let outline = polyline::resample(&line, true, 52);
        (outline, vec![straight(v(0.0, 0.0), v(50.0, 0.0)), straight(v(50.0, 0.0), v(100.0, 0.0))])
    }

    fn carrier(limb: usize) -> Carrier {
        Carrier { limb, turn: 1.0, rigidity: 1.0, whole: false }
    }

    fn bent(elbow: f64) -> Vec<LimbPose> {
        let (_, mut limbs) = arm();
        limbs[1].ends.1 = v(50.0, 0.0) + Point::from_angle(elbow) * 50.0;
        limbs
    }

    #[test]
    fn limbs_moved_rigidly_move_the_part_rigidly() {
        let (outline, rest) = arm();
        let mut puppet =
            Puppet::new(&outline, &outline, &rest, &[carrier(0), carrier(1)], &Options::default()).unwrap();
        assert!(!puppet.is_rigid());
        let turn = |p: Point| Point::from_angle(2.2).rotate(p) + v(30.0, -8.0);
        let moved: Vec<LimbPose> =
            rest.iter().map(|l| LimbPose { ends: (turn(l.ends.0), turn(l.ends.1)), ..*l }).collect();
        let found = puppet.pose(&moved).unwrap();
        assert!(outline.iter().zip(&found).all(|(a, b)| turn(*a).distance(*b) < 1e-8));
    }

    #[test]
    fn neither_the_order_of_limbs_nor_where_an_outline_begins_changes_a_bent_arm() {
        let (outline, rest) = arm();
        let posed = |outline: &[Point], order: [usize; 2]| -> Vec<Point> {
            let carriers = order.map(carrier);
            let mut puppet = Puppet::new(outline, outline, &rest, &carriers, &Options::default()).unwrap();
            puppet.pose(&bent(1.9)).unwrap()
        };
        let farthest = |a: &[Point], b: &[Point]| a.iter().zip(b).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
        let wanted = posed(&outline, [0, 1]);
        let off = farthest(&wanted, &posed(&outline, [1, 0]));
        assert!(off < 1e-6, "the other limb comes first: {off} px");
        for start in [1, 7, 20, 33] {
            let mut other = outline.clone();
            other.rotate_left(start);
            let mut found = posed(&other, [0, 1]);
            found.rotate_right(start);
            let off = farthest(&wanted, &found);
            assert!(off < 0.3, "begun at point {start}: {off} px");
        }
    }

    #[test]
    fn sub_key_points_keep_limbs_on_their_splines() {
        let (outline, rest) = arm();
        let middle: Vec<Point> = (1..10).map(|k| v(10.0 * k as f64, 0.0)).collect();
        let strayed = |sub_keys: usize, limbs: &[LimbPose]| {
            let options = Options { sub_keys, ..Options::default() };
            let mut puppet = Puppet::new(&outline, &middle, &rest, &[carrier(0), carrier(1)], &options).unwrap();
            let away = |p: &Point| limbs.iter().map(|l| l.spline().nearest(*p).distance).fold(f64::INFINITY, f64::min);
            puppet.pose(limbs).unwrap().iter().map(away).sum::<f64>()
        };
        let mut curved = bent(0.5);
        curved.iter_mut().for_each(|limb| limb.bend = Bend { along: 0.5, across: 0.3 });
        for limbs in [bent(1.6), curved] {
            assert!(strayed(5, &limbs) < 0.5 * strayed(0, &limbs), "{} {}", strayed(5, &limbs), strayed(0, &limbs));
        }
    }

    #[test]
    fn a_drawn_sleeve_bends_at_the_elbow() {
        let points = [
            (286.65087781207876, 237.52800161289488),
            (275.4858133122582, 260.41842547509924),
            (267.2832869578837, 282.48407364878403),
            (262.00127940390485, 303.742315298805),
            (259.5972008032425, 324.2365926872229),
            (249.5526814625554, 325.9994401606485),
            (239.60279919675747, 323.7634073127771),
            (241.26372059609517, 300.43268470119494),
            (246.13671304211624, 276.41592635121594),
            (254.17918668774192, 251.7565745249007),
            (265.34912218792124, 226.47199838710512),
            (280.14600120967117, 224.01184164094093),
        ];
        let outline = points.map(Point::from).to_vec();
        let across = |a: usize, b: usize| outline[a].midpoint(outline[b]);
        let [shoulder, elbow, wrist] = [across(0, 10), across(2, 8), across(4, 6)];
        let straight = |a: Point, b: Point| LimbPose { ends: (a, b), bend: Bend::STRAIGHT };
        let rest = [straight(shoulder, elbow), straight(elbow, wrist)];
        for turn in [-2.0, -1.0, 1.0, 2.0] {
            let hand = elbow + Point::from_angle(turn).rotate(wrist - elbow);
            let limbs = [straight(shoulder, elbow), straight(elbow, hand)];
            let mut puppet =
                Puppet::new(&outline, &[wrist, shoulder], &rest, &[carrier(0), carrier(1)], &Options::default())
                    .unwrap();
            let found = puppet.pose(&limbs).unwrap();
            assert!(found[0].distance(hand) < 2.0 && found[1].distance(shoulder) < 2.0, "{turn}: {found:?} {hand}");
        }
    }

    #[test]
    fn what_hangs_on_an_end_is_rigid_and_takes_its_share_of_the_turn() {
        let (_, rest) = arm();
        let hand = [v(104.0, -6.0), v(124.0, -6.0), v(124.0, 6.0), v(104.0, 6.0)];
        let pose = |turn: f64| {
            let carriers = [Carrier { turn, ..carrier(1) }];
            let mut puppet = Puppet::new(&hand, &hand, &rest, &carriers, &Options::default()).unwrap();
            assert!(puppet.is_rigid());
            puppet.pose(&bent(std::f64::consts::FRAC_PI_2)).unwrap()
        };
        assert!(pose(1.0)[0].distance(v(56.0, 54.0)) < 1e-9, "{}", pose(1.0)[0]);
        assert!(pose(0.0)[0].distance(v(54.0, 44.0)) < 1e-9, "{}", pose(0.0)[0]);
    }

    #[test]
    fn a_head_keeps_its_shape_on_a_neck_that_grows() {
        let (_, rest) = arm(); // neck from 0 to 50, head from 50 to 100
        let head = polyline::resample(&[v(20.0, -40.0), v(110.0, -40.0), v(110.0, 40.0), v(20.0, 40.0)], true, 40);
        let points = [head.clone(), vec![v(0.0, 0.0)]].concat();
        let posed = |whole: bool, limbs: &[LimbPose]| {
            let carriers = [1, 0].map(|limb| Carrier { whole, ..carrier(limb) });
            let mut puppet = Puppet::new(&head, &points, &rest, &carriers, &Options::default()).unwrap();
            assert_eq!(puppet.is_rigid(), whole);
            puppet.pose(limbs).unwrap()
        };
        let mut limbs = rest.clone();
        (limbs[0].ends.1, limbs[1].ends) = (v(0.0, 80.0), (v(0.0, 80.0), v(0.0, 170.0)));
        let found = posed(true, &limbs);
        assert!(points.iter().zip(&found).all(|(a, b)| a.perp().distance(*b) < 1e-9), "turned about the neck");
        let grown = polygon::signed_area(&posed(false, &limbs)[..40]) / polygon::signed_area(&head);
        assert!((grown - 1.0).abs() > 0.1, "a mesh grows with its limbs: {grown}");
        limbs.iter_mut().for_each(|limb| limb.ends = (v(3.0, 4.0), v(3.0, 4.0)));
        assert_eq!(posed(true, &limbs)[40], v(3.0, 4.0));
    }

    #[test]
    fn a_limb_that_shrinks_to_a_point_leaves_finite_places() {
        let (outline, mut limbs) = arm();
        let mut puppet =
            Puppet::new(&outline, &outline, &limbs, &[carrier(0), carrier(1)], &Options::default()).unwrap();
        limbs[1].ends.1 = limbs[1].ends.0;
        assert!(puppet.pose(&limbs).unwrap().iter().all(|p| p.is_finite()));
        let none = Puppet::new(&outline, &outline, &limbs, &[], &Options::default());
        assert!(matches!(none, Err(PuppetError::NoCarrier)));
        let flat = Puppet::new(&outline[..1], &[], &limbs, &[carrier(0)], &Options::default());
        assert!(matches!(flat, Err(PuppetError::Outline(TriangulateError::Flat { outline: 0 }))));
    }
}
