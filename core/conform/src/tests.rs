//! Films that were delivered again.

use super::*;
use Source::{New, Redrawn, Same};
use rototoon_base::scene::Silent;

/// Pictures in memory.
struct Film {
    footage: Footage,
    pictures: Vec<Arc<Raster<Colour>>>,
}

impl Film {
    fn of(first: FrameNumber, pictures: Vec<Raster<Colour>>) -> Self {
        let last = first + pictures.len() as FrameNumber - 1;
        let (width, height) = (pictures[0].width(), pictures[0].height());
        let footage = Footage { pattern: "%d.png".into(), first, last, fps: 24.0, width, height, held: false };
        Self { footage, pictures: pictures.into_iter().map(Arc::new).collect() }
    }

    fn plate(&self) -> Plate<'_> {
        Plate { footage: &self.footage, frames: self }
    }
}

impl FrameSource for Film {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        Ok(self.pictures[(frame - self.footage.first) as usize].clone())
    }
}

/// How a film is delivered.
#[derive(Clone, Copy)]
struct Delivery {
    size: [usize; 2],
    placement: Placement,
    dark: f32,
    light: f32,
}

const PLAIN: Delivery = Delivery { size: [160, 120], placement: Placement::SAME, dark: 0.1, light: 0.9 };

/// A drawing of a figure of two lines and a ring before a wall. `at` moves the figure; `arm` bends it.
fn drawing(at: f64, arm: f64, delivery: &Delivery) -> Raster<Colour> {
    let segment = |p: Point, a: Point, b: Point| {
        let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + share * (b - a))
    };
    let head = Point::new(40.0 + at, 38.0);
    let hip = head + Point::new(2.0, 44.0);
    let hand = head + Point::new(0.0, 18.0) + 26.0 * Point::from_angle(arm);
    let softness = delivery.placement.scale;
    let ink =
        |p: Point| {
            let figure = ((p.distance(head) - 11.0).abs())
                .min(segment(p, head + Point::new(0.0, 11.0), hip))
                .min(segment(p, head + Point::new(0.0, 18.0), hand));
            let wall = segment(p, Point::new(8.0, 104.0), Point::new(150.0, 100.0));
            figure.min(wall)
        };
    Raster::from_fn(delivery.size[0], delivery.size[1], |x, y| {
        let p = delivery.placement.old_place(Point::new(x as f64 + 0.5, y as f64 + 0.5));
        let inside = p.min_element() >= 0.0 && p.x < 160.0 && p.y < 120.0;
        let cover = if inside { ((1.2 - ink(p)) * softness + 0.5).clamp(0.0, 1.0) as f32 } else { 0.0 };
        [delivery.light + (delivery.dark - delivery.light) * cover; 3]
    })
}

/// Drawing k of the film: it moves by 4 px and the arm swings.
fn k(k: i32, delivery: &Delivery) -> Raster<Colour> {
    drawing(4.0 * f64::from(k), 0.4 * f64::from(k), delivery)
}

fn film(first: FrameNumber, drawings: &[i32], delivery: &Delivery) -> Film {
    Film::of(first, drawings.iter().map(|&number| k(number, delivery)).collect())
}

fn sources(conform: &Conform) -> Vec<Source> {
    conform.frames.sources().values().copied().collect()
}

fn compared(old: &Film, new: &Film) -> Conform {
    compare(old.plate(), new.plate(), &Given::default(), &Silent).unwrap()
}

#[test]
fn the_same_film_is_where_it_was() {
    let old = film(1, &[0, 1, 2, 3, 4, 5], &PLAIN);
    let conform = compared(&old, &film(1001, &[0, 1, 2, 3, 4, 5], &PLAIN));
    assert_eq!(conform.placement, Placement::SAME);
    assert!(conform.frames.only_renumbers());
    assert_eq!(conform.frames.made(3), Some(1003));
}

#[test]
fn a_plate_of_twice_the_size_with_a_border_in_another_grade() {
    let placement = Placement { scale: 2.0, shift: Point::new(32.0, 18.0) };
    let delivery = Delivery { size: [384, 276], placement, dark: 0.25, light: 0.7 };
    let old = film(1, &[0, 1, 2, 3, 4, 5], &PLAIN);
    let conform = compared(&old, &film(1, &[0, 1, 2, 3, 4, 5], &delivery));
    assert_eq!(conform.placement, placement);
    assert_eq!(sources(&conform), (1..=6).map(Same).collect::<Vec<_>>());
}

#[test]
fn a_plate_that_was_cut() {
    let placement = Placement { scale: 1.0, shift: Point::new(-20.0, -11.0) };
    let delivery = Delivery { size: [120, 100], placement, ..PLAIN };
    let old = film(1, &[0, 1, 2, 3, 4], &PLAIN);
    assert_eq!(compared(&old, &film(1, &[0, 1, 2, 3, 4], &delivery)).placement, placement);
}

#[test]
fn handles_left_out_and_added_and_redrawn_frames_are_told() {
    let old = film(1, &[0, 1, 2, 3, 4, 5, 6, 7], &PLAIN);
    let mut new = film(101, &[20, 0, 1, 1, 3, 4, 5, 15, 6, 7], &PLAIN);
    // Only the arm of drawing 4 is another one.
    new.pictures[5] = Arc::new(drawing(16.0, 2.6, &PLAIN));
    let conform = compared(&old, &new);
    let expected = [New, Same(1), Same(2), Same(2), Same(4), Redrawn(5), Same(6), New, Same(7), Same(8)];
    assert_eq!(sources(&conform), expected);
    assert_eq!(conform.frames.removed().collect::<Vec<_>>(), [3]);
}

#[test]
fn other_exposures_keep_the_order() {
    let old = film(1, &[0, 0, 1, 1, 2, 2, 3, 3], &PLAIN);
    let conform = compared(&old, &film(1, &[0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3], &PLAIN));
    let drawing = |source| match source {
        Same(at) => (at - 1) / 2,
        other => panic!("{other:?}"),
    };
    let drawings: Vec<_> = sources(&conform).into_iter().map(drawing).collect();
    assert_eq!(drawings, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3]);
    let ones = compared(&old, &film(1, &[0, 1, 2, 3], &PLAIN));
    assert_eq!((1..=8).map(|frame| ones.frames.made(frame)).collect::<Vec<_>>(), [1, 1, 2, 2, 3, 3, 4, 4].map(Some));
}

#[test]
fn a_given_placement_stays() {
    let old = film(1, &[0, 1, 2, 3], &PLAIN);
    let given = Given { scale: Some(1.0), shift: Some(Point::new(0.25, 0.0)) };
    let conform = compare(old.plate(), old.plate(), &given, &Silent).unwrap();
    assert_eq!(conform.placement, Placement { scale: 1.0, shift: Point::new(0.25, 0.0) });
}

#[test]
fn another_film_is_refused() {
    let old = film(1, &[0, 1, 2, 3], &PLAIN);
    let other = |x: usize, y: usize, k: usize| if (x / 9 + y / 7 + k).is_multiple_of(3) { [0.2; 3] } else { [0.8; 3] };
    let pictures = (0..4).map(|k| Raster::from_fn(160, 120, |x, y| other(x, y, k))).collect();
    let error = compare(old.plate(), Film::of(1, pictures).plate(), &Given::default(), &Silent).unwrap_err();
    assert_eq!(error, ConformError::NothingInCommon);
}

#[test]
fn pictures_that_show_nothing_of_each_other_have_nothing_in_common() {
    let old = film(1, &[0, 1, 2, 3], &PLAIN);
    let given = Given { scale: Some(1.0), shift: Some(Point::new(155.0, 0.0)) };
    let error = compare(old.plate(), old.plate(), &given, &Silent).unwrap_err();
    assert_eq!(error, ConformError::NothingInCommon);
}

#[test]
fn the_work_can_be_cancelled() {
    struct Never;
    impl Progress for Never {
        fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
            if done > 0.3 { Err(Cancelled) } else { Ok(()) }
        }
    }
    let old = film(1, &[0, 1, 2, 3], &PLAIN);
    let error = compare(old.plate(), old.plate(), &Given::default(), &Never).unwrap_err();
    assert_eq!(error, ConformError::Cancelled(Cancelled));
}
