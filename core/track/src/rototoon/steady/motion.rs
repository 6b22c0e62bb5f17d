//! The motion of a part as three series: centre, pose, and shape.
//!
//! Let B be the blend of the two keys at the time of a drawing, about its centre, and X the part there about its centre. The
//! pose is the complex number f for which f B is nearest to X. The shape is X − f B. A pose is given times the part's size, so
//! all series are in pixels.

use nalgebra::Complex;
use rototoon_base::geometry::Point;

/// The motion of a part, with an entry for each drawing.
pub struct Motion {
    /// The mean of the points: x and y.
    pub centres: Vec<Vec<f64>>,
    /// The pose times the size: real and imaginary part.
    pub poses: Vec<Vec<f64>>,
    /// The shape: x and y of each point.
    pub shapes: Vec<Vec<f64>>,
    blends: Vec<Vec<Complex<f64>>>,
    /// The root mean square distance of the points from their centre at the first key.
    pub size: f64,
}

/// Added to sizes that divide, in working pixels.
const TINY: f64 = 1e-6;

impl Motion {
    /// The motion of a part with the points given at these times. The first and the last are the keys.
    pub fn of(times: &[f64], points: &[Vec<Point>]) -> Self {
        let mut motion =
            Self { centres: Vec::new(), poses: Vec::new(), shapes: Vec::new(), blends: Vec::new(), size: TINY };
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return motion };
        motion.size += (about_centre(first).1.iter().map(|z| z.norm_sqr()).sum::<f64>() / count(first)).sqrt();
        let duration = (times[times.len() - 1] - times[0]).max(TINY);
        for (&time, points) in times.iter().zip(points) {
            let share = (time - times[0]) / duration;
            let blend: Vec<Point> = first.iter().zip(last).map(|(a, b)| a.lerp(*b, share)).collect();
            motion.push(about_centre(&blend).1, points);
        }
        motion
    }

    fn push(&mut self, blend: Vec<Complex<f64>>, points: &[Point]) {
        let (centre, own) = about_centre(points);
        let product: Complex<f64> = blend.iter().zip(&own).map(|(b, x)| b.conj() * x).sum();
        let pose = product / (blend.iter().map(|b| b.norm_sqr()).sum::<f64>() + TINY);
        self.centres.push(vec![centre.x, centre.y]);
        self.poses.push(vec![pose.re * self.size, pose.im * self.size]);
        self.shapes.push(blend.iter().zip(&own).flat_map(|(b, x)| [(x - pose * b).re, (x - pose * b).im]).collect());
        self.blends.push(blend);
    }

    /// The poses as pure numbers.
    pub fn turns(&self) -> Vec<Vec<f64>> {
        self.poses.iter().map(|pose| pose.iter().map(|x| x / self.size).collect()).collect()
    }

    /// The points of each drawing that have these centres, poses and shapes.
    pub fn points(&self, centres: &[Vec<f64>], poses: &[Vec<f64>], shapes: &[Vec<f64>]) -> Vec<Vec<Point>> {
        let on_drawing = |d: usize| {
            let pose = Complex::new(poses[d][0], poses[d][1]) / self.size;
            let point = |(b, shape): (&Complex<f64>, &[f64])| {
                let z = pose * b;
                Point::new(centres[d][0] + z.re + shape[0], centres[d][1] + z.im + shape[1])
            };
            self.blends[d].iter().zip(shapes[d].chunks(2)).map(point).collect()
        };
        (0..self.blends.len()).map(on_drawing).collect()
    }
}

fn count(points: &[Point]) -> f64 {
    points.len().max(1) as f64
}

/// The centre of points, and the points about it.
fn about_centre(points: &[Point]) -> (Point, Vec<Complex<f64>>) {
    let centre = points.iter().sum::<Point>() / count(points);
    (centre, points.iter().map(|&p| Complex::new(p.x - centre.x, p.y - centre.y)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaf() -> Vec<Point> {
        (0..7).map(|k| Point::new(f64::from(k * k), f64::from(k % 3) * 2.5)).collect()
    }

    #[test]
    fn its_series_give_the_points_again() {
        let points: Vec<Vec<Point>> = (0..5)
            .map(|d| {
                leaf().iter().map(|&p| p.rotate(Point::from_angle(f64::from(d))) * 1.1 + Point::new(3.0, p.x)).collect()
            })
            .collect();
        let motion = Motion::of(&[1.0, 2.5, 4.0, 5.0, 6.0], &points);
        let again = motion.points(&motion.centres, &motion.poses, &motion.shapes);
        for (a, b) in points.iter().flatten().zip(again.iter().flatten()) {
            assert!(a.distance(*b) < 1e-9, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_part_that_turns_and_grows_has_a_pose_and_no_shape() {
        let turned = |angle: f64, scale: f64| -> Vec<Point> {
            leaf().iter().map(|&p| p.rotate(Point::from_angle(angle)) * scale + Point::new(9.0, -2.0)).collect()
        };
        let motion = Motion::of(&[0.0, 1.0, 2.0], &[turned(0.0, 1.0), turned(0.4, 1.3), turned(0.0, 1.0)]);
        let size = motion.poses[0][0];
        let pose = Complex::new(motion.poses[1][0], motion.poses[1][1]) / size;
        assert!((pose - Complex::from_polar(1.3, 0.4)).norm() < 1e-6, "{pose}");
        assert!(motion.shapes.iter().flatten().all(|x| x.abs() < 1e-5));
    }

    #[test]
    fn contours_of_one_point_and_of_none_have_a_motion() {
        let motion = Motion::of(&[0.0, 1.0], &[vec![Point::ONE], vec![Point::ZERO]]);
        assert_eq!(motion.points(&motion.centres, &motion.poses, &motion.shapes), [[Point::ONE], [Point::ZERO]]);
        assert!(Motion::of(&[], &[]).centres.is_empty());
        assert!(Motion::of(&[0.0, 1.0], &[vec![], vec![]]).shapes.iter().all(Vec::is_empty));
    }
}
