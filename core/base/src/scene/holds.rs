//! Clips on twos and threes: frames that repeat the drawing before.
//!
//! Hand-drawn animation shows most drawings for two or three frames. In a clip of it a posture comes, stays, and is followed
//! by the next one. A frame that repeats a drawing tells nothing new: a foot that does not move there may be in the middle
//! of its swing. So work on movement is done on the *drawings*, each at the time of its first frame, and every frame then
//! shows its drawing.
//!
//! **A repeat** is a frame whose posture is that of the frame before, wherever it is: a drawing may travel while it is held.
//! Captured contours are a little noisy, so a change of posture also counts as none if it is below [`NOISE`] and a small share
//! ([`QUIET`]) of changes shortly before it and after it.
//!
//! **On twos is a stretch of a clip, not a frame.** Movement on ones repeats a posture too, by chance, where it turns back,
//! and where the figure rests. A hold counts only where most drawings beside it are held as well.
//!
//! **A pause** within such a stretch is longer than [`LONGEST`] frames: the figure rests, and so do its feet. It counts as two
//! drawings, the second as long before its end as a drawing is usually held.
//!
//! **Travel.** Where the root goes on during holds in one direction, the drawing travels. Otherwise what it moves there is noise, and
//! the frames of a hold are the same.
//!
//! Limits: a stretch of fewer than three drawings is not known as one. A turn of the whole figure during a hold is a change.

use super::Template;
use crate::geometry::Point;

/// A change of posture below this may be noise, as a root mean square of the key points in torso lengths.
const NOISE: f64 = 0.01;
/// And it is no more than this share of the changes beside it.
const QUIET: f64 = 0.25;
/// Frames in which there is such a change, on both sides.
const BESIDE: usize = 3;
/// A drawing is held if most drawings within so many are.
const AROUND: usize = 2;
/// A drawing is held for no more frames; after them the figure rests.
const LONGEST: usize = 4;
/// The root travels during holds if this share of what it moves there is in one direction.
const ONE_WAY: f64 = 0.5;

/// The drawings of a clip that is on twos or threes, at least in part.
#[derive(Clone, Debug, PartialEq)]
pub struct Holds {
    /// For each frame the first one of its drawing.
    shown: Vec<usize>,
    /// The frames whose postures are looked at: the first of each drawing, and the second time of a pause.
    drawings: Vec<usize>,
    /// How long a drawing is usually held.
    usual: usize,
    /// Whether the root goes on during a hold.
    travels: bool,
}

impl Holds {
    /// The drawings of a clip; none if it is on ones.
    pub fn of(template: &Template, postures: &[Vec<Point>]) -> Option<Self> {
        let runs = confirmed(&runs(&repeats(template, postures)));
        let mut lengths: Vec<usize> = runs.iter().map(|run| run.len()).filter(|n| (2..=LONGEST).contains(n)).collect();
        lengths.sort_unstable();
        let usual = *lengths.get(lengths.len().saturating_sub(1) / 2)?;
        let shown = runs.iter().flat_map(|run| run.clone().map(|_| run.start)).collect();
        let again = |run: &std::ops::Range<usize>| (run.len() > LONGEST).then(|| run.end - usual);
        let drawings = runs.iter().flat_map(|run| std::iter::once(run.start).chain(again(run))).collect();
        let travels = travels(postures, &runs);
        Some(Self { shown, drawings, usual, travels })
    }

    /// The frame on which the drawing of a frame begins.
    pub fn begin(&self, frame: usize) -> usize {
        self.shown[frame]
    }

    /// What there is for each frame, for each drawing.
    pub fn drawings<T: Clone>(&self, frames: &[T]) -> Vec<T> {
        self.drawings.iter().map(|&frame| frames[frame].clone()).collect()
    }

    /// When each drawing begins. The unit is how long a drawing is usually held: on twos or threes throughout, a drawing is a
    /// frame.
    pub fn times(&self) -> Vec<f64> {
        self.drawings.iter().map(|&frame| frame as f64 / self.usual as f64).collect()
    }

    /// What there is for each drawing, for each frame.
    pub fn held<T: Clone>(&self, drawings: &[T]) -> Vec<T> {
        let of = |first: &usize| drawings[self.drawings.partition_point(|frame| frame < first)].clone();
        self.shown.iter().map(of).collect()
    }

    /// Postures of drawings on all frames. `before` are the postures of all frames of which the drawings were made: they tell how far a
    /// held drawing travels.
    pub fn postures(&self, before: &[Vec<Point>], drawings: &[Vec<Point>]) -> Vec<Vec<Point>> {
        let mut made = self.held(drawings);
        for (frame, posture) in
            made.iter_mut().enumerate().filter(|(frame, _)| self.travels && self.shown[*frame] != *frame)
        {
            let way = before[frame][0] - before[self.shown[frame]][0];
            posture.iter_mut().for_each(|p| *p += way);
        }
        made
    }
}

/// For each frame whether its posture repeats that of the frame before.
fn repeats(template: &Template, postures: &[Vec<Point>]) -> Vec<bool> {
    let torso = postures.first().map_or(0.0, |p| template.torso_length(p));
    let change = |pair: &[Vec<Point>]| {
        let count = pair[0].len().max(1) as f64;
        let way = || pair[0].iter().zip(&pair[1]).map(|(a, b)| *b - *a);
        let travel = way().sum::<Point>() / count;
        (way().map(|way| (way - travel).length_squared()).sum::<f64>() / count).sqrt()
    };
    let changes: Vec<f64> = postures.windows(2).map(change).collect();
    let one = |k: usize| {
        let sides = [&changes[k.saturating_sub(BESIDE)..k], &changes[(k + 1)..(k + 1 + BESIDE).min(changes.len())]];
        let quiet = |side: &[f64]| side.iter().any(|change| changes[k] <= QUIET * change);
        // At an end of the clip the other side tells it.
        changes[k] <= NOISE * torso
            && sides.iter().all(|side| side.len() < BESIDE || quiet(side))
            && sides.iter().any(|side| quiet(side))
    };
    std::iter::once(false).take(postures.len()).chain((0..changes.len()).map(one)).collect()
}

/// The frames of each drawing, if every repeat is a hold.
fn runs(repeats: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for (frame, repeats) in repeats.iter().enumerate() {
        match runs.last_mut().filter(|_| *repeats) {
            Some(run) => run.end = frame + 1,
            None => runs.push(frame..frame + 1),
        }
    }
    runs
}

/// The frames of each drawing. A hold among movement on ones is none.
fn confirmed(runs: &[std::ops::Range<usize>]) -> Vec<std::ops::Range<usize>> {
    let held = |k: usize| {
        let around = k.saturating_sub(AROUND)..(k + AROUND + 1).min(runs.len());
        let count = around.len();
        count > AROUND && 2 * runs[around].iter().filter(|run| run.len() > 1).count() > count
    };
    let of = |(k, run): (usize, &std::ops::Range<usize>)| -> Vec<std::ops::Range<usize>> {
        if held(k) { vec![run.clone()] } else { run.clone().map(|frame| frame..frame + 1).collect() }
    };
    runs.iter().enumerate().flat_map(of).collect()
}

/// Whether the root goes on in one direction while drawings are held.
fn travels(postures: &[Vec<Point>], runs: &[std::ops::Range<usize>]) -> bool {
    let step = |frame: usize| postures[frame][0].x - postures[frame - 1][0].x;
    let within: Vec<f64> = runs.iter().flat_map(|run| run.clone().skip(1)).map(step).collect();
    let across: Vec<f64> = runs.iter().skip(1).map(|run| step(run.start)).collect();
    let size = |steps: &[f64]| steps.iter().map(|x| x.abs()).sum::<f64>() / steps.len().max(1) as f64;
    let one_way = within.iter().sum::<f64>().abs() / within.len().max(1) as f64;
    size(&within) > 0.0 && one_way > ONE_WAY * size(&within) && size(&within) > QUIET * size(&across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A human whose key points swing about the pelvis, every other one a quarter of the way later; its pelvis at x.
    fn swung(angle: f64, x: f64) -> Vec<Point> {
        let swing = |(k, p): (usize, &Point)| {
            let late = if k % 2 == 0 { 0.0 } else { std::f64::consts::FRAC_PI_2 };
            Point::from_angle(0.3 * (angle + late).sin()).rotate(*p) + Point::new(x, 0.0)
        };
        Template::human().typical().iter().enumerate().map(swing).collect()
    }

    /// The same, all key points at once: it turns back.
    fn waved(angle: f64) -> Vec<Point> {
        let turn = Point::from_angle(0.3 * angle.sin());
        Template::human().typical().iter().map(|p| turn.rotate(*p)).collect()
    }

    /// Drawings held for the given numbers of frames, each as far on as its first frame is.
    fn clip(holds: &[usize], noise: f64, travel: f64) -> Vec<Vec<Point>> {
        let mut made: Vec<Vec<Point>> = Vec::new();
        for &count in holds {
            let first = made.len() as f64;
            for again in 0..count {
                let k = made.len() as f64;
                let shake = |(j, p): (usize, Point)| {
                    p + noise * Point::new((7.1 * k + j as f64).sin(), (3.3 * k * j as f64).cos())
                };
                made.push(
                    swung(0.35 * first, 0.2 * first + travel * again as f64)
                        .into_iter()
                        .enumerate()
                        .map(shake)
                        .collect(),
                );
            }
        }
        made
    }

    fn of(clip: &[Vec<Point>]) -> Option<Holds> {
        Holds::of(&Template::human(), clip)
    }

    #[test]
    fn drawings_are_found_on_twos_on_threes_and_on_both() {
        for (holds, usual) in
            [(vec![2; 9], 2), (vec![3; 6], 3), (vec![2, 2, 3, 2, 1, 2, 2, 3, 2], 2), (vec![1, 2, 2, 2, 2, 1], 2)]
        {
            for noise in [0.0, 0.002] {
                let clip = clip(&holds, noise, 0.0);
                let found = of(&clip).unwrap();
                let starts: Vec<usize> = holds.iter().scan(0, |at, n| Some(std::mem::replace(at, *at + n))).collect();
                assert_eq!((&found.drawings, found.usual, found.travels), (&starts, usual, false), "{holds:?} {noise}");
                let back = found.postures(&clip, &found.drawings(&clip));
                for (frame, posture) in back.iter().enumerate() {
                    assert_eq!(posture, &clip[found.begin(frame)]);
                }
                assert_eq!(found.times()[1], holds[0] as f64 / usual as f64);
            }
        }
    }

    #[test]
    fn a_drawing_may_travel_while_it_is_held() {
        let clip = clip(&[2; 9], 0.0, 0.2);
        let found = of(&clip).unwrap();
        assert!(found.travels && found.drawings.len() == 9);
        let back = found.postures(&clip, &found.drawings(&clip));
        assert!(back.iter().flatten().zip(clip.iter().flatten()).all(|(a, b)| a.distance(*b) < 1e-12));
    }

    #[test]
    fn a_clip_on_ones_has_no_holds_even_if_it_turns_back_or_rests() {
        let ones = |angles: &[f64]| -> Vec<Vec<Point>> { angles.iter().map(|a| waved(*a)).collect() };
        let turning: Vec<f64> = (0..40).map(|k| std::f64::consts::TAU * (f64::from(k) + 0.5) / 16.0).collect();
        let resting: Vec<f64> = (0..30).map(|k: i32| 0.1 * f64::from(k.min(18)).powi(2) / 18.0).collect();
        let slowing: Vec<f64> = (0..30).map(|k| 1.5 * (1.0 - f64::powi(0.5, k))).collect();
        for (name, clip) in [
            ("turns", turning),
            ("rests", resting),
            ("slows", slowing),
            ("still", vec![0.0; 12]),
            ("one", vec![0.0]),
            ("none", Vec::new()),
        ] {
            assert_eq!(of(&ones(&clip)), None, "{name}");
        }
    }

    #[test]
    fn a_pause_among_holds_is_a_drawing_twice() {
        let clip = clip(&[2, 2, 2, 2, 8, 2, 2, 2], 0.0, 0.0);
        let found = of(&clip).unwrap();
        assert_eq!(found.drawings, [0, 2, 4, 6, 8, 14, 16, 18, 20]);
        assert_eq!(
            found.held(&found.drawings),
            [0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 8, 8, 8, 8, 8, 8, 16, 16, 18, 18, 20, 20]
        );
    }
}
