//! The motion of a part: centre, translation, rotation and scale, and the corners of its rectangle.
//!
//! Rotation and scale are those of the similarity that maps the control points of the first frame to those of another frame
//! with the least sum of squared distances. With points relative to their middles and as complex numbers, it is
//! multiplication by Σ ā b ∕ Σ |a|². Corners move by the affine map with the least sum of squared distances, so they follow
//! shear and unequal growth too; if the points of the first frame lie on a line, they move by the similarity.
//!
//! Limits: both are fits. A part that bends has a motion only in the mean.
//!
//! Points are in the coordinates of the host, y up.

use rototoon::geometry::Point;

/// Share of the points' spread below which they count as lying on a line.
const FLAT: f64 = 1e-9;

/// The motion from the first shape to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Middle of the points.
    pub centre: Point,
    /// How far the middle has moved.
    pub translate: Point,
    /// Rotation anticlockwise in degrees.
    pub rotate: f64,
    /// Growth as a factor.
    pub scale: f64,
    /// The corners of the first shape's rectangle: lower left, lower right, upper right, upper left.
    pub corners: [Point; 4],
}

fn middle(points: &[Point]) -> Point {
    points.iter().sum::<Point>() / points.len().max(1) as f64
}

/// The motions from the first shape to each shape. The rotation is continuous over full turns. Shapes without points, or
/// with another number of points than the first, have none.
pub fn motions(shapes: &[Vec<Point>]) -> Vec<Option<Motion>> {
    let Some(first) = shapes.first().filter(|first| !first.is_empty()) else { return vec![None; shapes.len()] };
    let mut last = 0.0;
    let motion = |shape: &Vec<Point>| {
        let mut motion = (shape.len() == first.len()).then(|| between(first, shape))?;
        motion.rotate += ((last - motion.rotate) / 360.0f64).round() * 360.0;
        last = motion.rotate;
        Some(motion)
    };
    shapes.iter().map(motion).collect()
}

fn between(first: &[Point], shape: &[Point]) -> Motion {
    let (from, to) = (middle(first), middle(shape));
    let pairs = || first.iter().zip(shape).map(move |(a, b)| (*a - from, *b - to));
    let size: f64 = pairs().map(|(a, _)| a.length_squared()).sum();
    let turn = pairs().map(|(a, b)| Point::new(a.dot(b), a.perp_dot(b))).sum::<Point>();
    let turn = if size > 0.0 { turn / size } else { Point::X };
    let map = affine(&pairs().collect::<Vec<_>>()).unwrap_or([turn, turn.perp()]);
    let (least, most) = first.iter().fold((Point::MAX, Point::MIN), |(a, b), &p| (a.min(p), b.max(p)));
    let rectangle = [least, Point::new(most.x, least.y), most, Point::new(least.x, most.y)];
    Motion {
        centre: to,
        translate: to - from,
        rotate: turn.to_angle().to_degrees(),
        scale: turn.length(),
        corners: rectangle.map(|corner| to + map[0] * (corner - from).x + map[1] * (corner - from).y),
    }
}

/// The images of the two axes under the best linear map; `None` if the first points lie on a line.
fn affine(pairs: &[(Point, Point)]) -> Option<[Point; 2]> {
    let sum = |value: &dyn Fn(&(Point, Point)) -> f64| pairs.iter().map(value).sum::<f64>();
    let (xx, xy, yy) = (sum(&|(a, _)| a.x * a.x), sum(&|(a, _)| a.x * a.y), sum(&|(a, _)| a.y * a.y));
    let determinant = xx * yy - xy * xy;
    if determinant <= FLAT * (xx + yy) * (xx + yy) {
        return None;
    }
    let row = |b: &dyn Fn(&Point) -> f64| {
        let (x, y) = (sum(&|(a, p)| a.x * b(p)), sum(&|(a, p)| a.y * b(p)));
        [(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant]
    };
    let ([ax, bx], [ay, by]) = (row(&|p| p.x), row(&|p| p.y));
    Some([Point::new(ax, ay), Point::new(bx, by)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape() -> Vec<Point> {
        [(10.0, 0.0), (30.0, 5.0), (25.0, 40.0), (5.0, 20.0)].map(|(x, y)| Point::new(x, y)).to_vec()
    }

    #[test]
    fn a_similarity_is_found_again() {
        let about = middle(&shape());
        let turned = |degrees: f64, scale: f64| {
            let turn = Point::from_angle(degrees.to_radians()) * scale;
            shape().iter().map(|&p| about + Point::new(3.0, -4.0) + turn.rotate(p - about)).collect::<Vec<_>>()
        };
        let shapes = [shape(), turned(100.0, 1.5), turned(200.0, 1.0), turned(300.0, 0.5), turned(380.0, 1.0)];
        let found: Vec<Motion> = motions(&shapes).into_iter().flatten().collect();
        let rotations: Vec<f64> = found.iter().map(|motion| motion.rotate).collect();
        for (found, wanted) in rotations.iter().zip([0.0, 100.0, 200.0, 300.0, 380.0]) {
            assert!((found - wanted).abs() < 1e-9, "{rotations:?}");
        }
        assert!((found[1].scale - 1.5).abs() < 1e-12 && (found[3].scale - 0.5).abs() < 1e-12);
        assert!(found[2].translate.distance(Point::new(3.0, -4.0)) < 1e-12);
        assert_eq!(found[0].corners[2], Point::new(30.0, 40.0));
    }

    #[test]
    fn corners_follow_shear_and_lines_have_a_similarity() {
        let sheared: Vec<Point> = shape().iter().map(|p| Point::new(p.x + 0.5 * p.y, 2.0 * p.y)).collect();
        let motion = motions(&[shape(), sheared])[1].unwrap();
        assert!(motion.corners[2].distance(Point::new(50.0, 80.0)) < 1e-9, "{motion:?}");
        let line = |turn: Point| (0..5).map(|k| turn * f64::from(k)).collect::<Vec<_>>();
        let motion = motions(&[line(Point::X), line(Point::Y)])[1].unwrap();
        assert!((motion.rotate - 90.0).abs() < 1e-9 && motion.corners[1].distance(Point::new(0.0, 4.0)) < 1e-9);
        assert_eq!(motions(&[shape(), vec![Point::ONE]])[1], None);
        assert_eq!(motions(&[Vec::new(), shape()]), [None, None]);
    }
}
