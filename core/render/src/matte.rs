//! Coverage of the closed parts on a frame. The areas come from [`super::coverage`].
//!
//! Parts with a feather are masks of their own. All others are united exactly, whatever lies between them: masks that are added give the same in any order.

use super::composite::{Layer, Layers};
use super::coverage::{Shape, Window};
use super::mask::Mask;
use super::motion::segments_at;
use super::widths::{self, Piece};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Part, Raster, Scene};

/// Coverage, 0 to 1, of closed parts on a frame: of their union, with the feather of those that have one. `parts` selects parts by index; `None` takes all. Snapped
/// paths are used where they exist. Open parts and parts without a contour on the frame cover nothing.
pub fn matte(scene: &Scene, frame: FrameNumber, parts: Option<&[usize]>) -> Raster<f32> {
    let wanted = |index: usize| parts.is_none_or(|parts| parts.contains(&index));
    if scene.parts.iter().enumerate().any(|(index, part)| wanted(index) && part.closed && part.soft_widths().is_some())
    {
        return soft(scene, frame, &wanted);
    }
    let outlines: Vec<_> = scene
        .parts
        .iter()
        .enumerate()
        .filter(|(index, part)| wanted(*index) && part.closed)
        .filter_map(|(_, part): (usize, &Part)| part.outline(frame))
        .collect();
    coverage(&outlines, scene.footage.width, scene.footage.height)
}

/// The feather of a part at a time as pieces of its contour. `curves` as for [`segments_at`], `place` puts points into the
/// picture, and a pixel of the footage is `scale` pixels of the picture. Empty for a part without a feather.
pub fn feather_pieces(part: &Part, time: f64, curves: bool, place: &dyn Fn(Point) -> Point, scale: f64) -> Vec<Piece> {
    let Some(own) = part.soft_widths() else { return Vec::new() };
    let Some(mut segments) = segments_at(part, time, curves) else { return Vec::new() };
    segments.iter_mut().flatten().for_each(|p| *p = place(*p));
    widths::pieces(&segments, &own.iter().map(|width| width * scale).collect::<Vec<_>>())
}

/// The masks whose coverage is the [`matte`] of one part.
pub(super) fn layers_of(scene: &Scene, frame: FrameNumber, part: usize) -> Layers {
    soft_layers(scene, frame, &|index| index == part)
}

/// Coverage of closed parts of which some have a feather.
fn soft(scene: &Scene, frame: FrameNumber, wanted: &dyn Fn(usize) -> bool) -> Raster<f32> {
    let (width, height) = (scene.footage.width, scene.footage.height);
    let window = Window { left: 0, top: 0, right: width as i64, bottom: height as i64 };
    let drawn = soft_layers(scene, frame, wanted).draw(window, &mut || true);
    drawn.unwrap_or_else(|| Raster::new(width, height, 0.0))
}

/// The masks of closed parts: one for all without a feather, then the others, the farthest first.
fn soft_layers(scene: &Scene, frame: FrameNumber, wanted: &dyn Fn(usize) -> bool) -> Layers {
    let mut order: Vec<&Part> =
        scene.parts.iter().enumerate().filter(|(k, _)| wanted(*k)).map(|(_, part)| part).collect();
    order.retain(|part| part.closed && part.points_at(frame).is_some());
    order.sort_by(|a, b| a.depth_at(frame).total_cmp(&b.depth_at(frame)));
    let layer = |parts: &[&Part]| {
        let outlines: Vec<Vec<Point>> = parts.iter().filter_map(|part| part.outline(frame)).collect();
        let pieces = feather_pieces(parts[0], f64::from(frame), true, &|p| p, 1.0);
        // Parts without a feather are hard, so the falloff of the first one changes nothing where there are several.
        Layer::new(Mask::new(vec![outlines], 0.0, 0.0).with_widths(&pieces).with_falloff(parts[0].falloff))
    };
    let (hard, soft): (Vec<&Part>, Vec<&Part>) = order.into_iter().partition(|part| part.soft_widths().is_none());
    let groups = (!hard.is_empty()).then_some(&hard[..]).into_iter().chain(soft.chunks(1));
    Layers(groups.map(layer).collect())
}

/// The pixels of a frame, premultiplied, multiplied by the coverage of closed parts ([`matte`]).
pub fn cutout(
    scene: &Scene,
    frame: FrameNumber,
    pixels: &Raster<[f32; 4]>,
    parts: Option<&[usize]>,
) -> Raster<[f32; 4]> {
    let matte = matte(scene, frame, parts);
    Raster::from_fn(pixels.width(), pixels.height(), |x, y| pixels.get(x, y).map(|v| v * matte.get(x, y)))
}

/// Coverage, 0 to 1, of the union of closed polygons in a picture of `width` × `height` pixels.
pub fn coverage(polygons: &[Vec<Point>], width: usize, height: usize) -> Raster<f32> {
    let window = Window { left: 0, top: 0, right: width as i64, bottom: height as i64 };
    let drawn = Shape::new(&[polygons.to_vec()]).draw(window, &mut || true);
    drawn.unwrap_or_else(|| Raster::new(width, height, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::polygon;
    use rototoon_base::scene::Footage;

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
        vec![Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)]
    }

    #[test]
    fn upright_borders_cover_exactly() {
        let picture = coverage(&[rectangle(0.25, 0.3, 2.5, 1.0)], 4, 2);
        let near = |x, value: f32| assert!((picture.get(x, 0) - value).abs() < 1e-6, "{x}");
        near(0, 0.75 * 0.7);
        near(1, 0.7);
        near(2, 0.5 * 0.7);
        near(3, 0.0);
        assert!(picture.row(1).iter().all(|value| *value == 0.0));
    }

    #[test]
    fn parts_that_touch_leave_no_seam_and_overlap_counts_once() {
        let touching = coverage(&[rectangle(0.0, 0.0, 1.5, 1.0), rectangle(1.5, 0.0, 3.0, 1.0)], 3, 1);
        assert!(touching.data().iter().all(|value| (value - 1.0).abs() < 1e-6));
        let doubled = coverage(&[rectangle(0.0, 0.0, 1.5, 1.0), rectangle(0.5, 0.0, 1.5, 1.0)], 2, 1);
        assert!((doubled.get(1, 0) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_contour_that_folds_over_itself_has_no_hole() {
        let mut twice = rectangle(0.0, 0.0, 2.0, 2.0);
        twice.extend(rectangle(0.0, 0.0, 2.0, 2.0));
        assert!(coverage(&[twice], 2, 2).data().iter().all(|value| (value - 1.0).abs() < 1e-6));
    }

    #[test]
    fn a_part_with_a_feather_is_soft_and_others_stay() {
        let part = |name: &str, x: f64, feather: &[f64]| Part {
            name: name.into(),
            closed: true,
            keys: [(0, rectangle(x, 10.0, x + 20.0, 30.0))].into(),
            feather: feather.into(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 0, fps: 24.0, width: 80, height: 40, held: false };
        let parts = vec![part("hard", 4.0, &[]), part("soft", 50.0, &[0.0, 8.0, 8.0, 0.0]), part("odd", 24.0, &[5.0])];
        let scene = Scene { footage, parts };
        let all = matte(&scene, 0, None);
        let [hard, soft] = [0, 1].map(|index| matte(&scene, 0, Some(&[index])));
        let row = all.row(20);
        // The left border of the soft part is sharp, the right one falls from 62 to 78. Two hard parts meet at 24.
        assert!(row[48] == 0.0 && row[52] == 1.0 && row[23] == 1.0 && row[24] == 1.0 && row[3] == 0.0, "{row:?}");
        assert!((row[69] + row[70] - 1.0).abs() < 0.01 && row[64] < 1.0 && row[75] > 0.0 && row[78] == 0.0, "{row:?}");
        assert_eq!((hard.get(10, 20), soft.row(20)[46..].to_vec()), (1.0, row[46..].to_vec()));
    }

    #[test]
    fn a_soft_part_whose_depth_is_between_two_others_leaves_no_seam_between_them() {
        let part = |x: f64, width: f64, depth: f64, feather: &[f64]| Part {
            closed: true,
            keys: [(0, rectangle(x, 4.0, x + width, 16.0))].into(),
            depth,
            feather: feather.into(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 0, fps: 24.0, width: 80, height: 20, held: false };
        let parts = vec![part(4.0, 6.5, 0.0, &[]), part(50.0, 20.0, 1.0, &[3.0; 4]), part(10.5, 6.5, 2.0, &[])];
        let all = matte(&Scene { footage, parts }, 0, None);
        assert!(all.row(10)[4..17].iter().all(|value| (value - 1.0).abs() < 1e-6), "{:?}", all.row(10));
        assert!(all.get(48, 10) > 0.0 && all.get(48, 10) < 1.0);
    }

    #[test]
    fn contours_off_the_picture_and_without_area_cover_nothing() {
        let flat = vec![Point::new(1.0, 1.0), Point::new(3.0, 3.0)];
        let far = rectangle(-1e6, -1e6, -10.0, -10.0);
        let picture = coverage(&[flat, far, Vec::new(), vec![Point::ONE]], 5, 5);
        assert!(picture.data().iter().all(|value| *value == 0.0));
    }

    proptest! {
        #[test]
        fn the_coverage_of_a_triangle_sums_to_its_area(points in prop::array::uniform6(1.0f64..19.0)) {
            let triangle: Vec<_> = points.chunks(2).map(|p| Point::new(p[0], p[1])).collect();
            let sum: f64 = coverage(std::slice::from_ref(&triangle), 20, 20).data().iter().map(|v| f64::from(*v)).sum();
            prop_assert!((sum - polygon::signed_area(&triangle).abs()).abs() < 1e-3);
        }

        #[test]
        fn coverage_is_that_of_many_samples(points in prop::array::uniform6(-2.0f64..8.0)) {
            const SAMPLES: usize = 40;
            let triangle: Vec<_> = points.chunks(2).map(|p| Point::new(p[0], p[1])).collect();
            let picture = coverage(std::slice::from_ref(&triangle), 6, 6);
            let at = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
            for y in 0..6 {
                for x in 0..6 {
                    let hits = (0..SAMPLES * SAMPLES)
                        .filter(|k| {
                            let p = Point::new(x as f64 + at(k % SAMPLES), y as f64 + at(k / SAMPLES));
                            polygon::contains(&triangle, p)
                        })
                        .count();
                    let reference = hits as f32 / (SAMPLES * SAMPLES) as f32;
                    prop_assert!((picture.get(x, y) - reference).abs() < 0.04, "{x} {y}: {} {reference}", picture.get(x, y));
                }
            }
        }
    }
}
