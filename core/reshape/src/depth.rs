//! Depth order of parts from a few marks "in front" and "behind" (after Sýkora et al. 2010, "Adding Depth to Cartoons
//! Using Sparse Depth (In)equalities").
//!
//! A mark says that one part is in front of another, for a range of frames. The marks of one frame form a directed
//! graph. Marks contradict each other exactly if they form a cycle. The error lists the marks of the first cycle that
//! is found.
//!
//! Sýkora et al. then minimise Σ (d_p − d⁰_p)². Numbers are not what one sees, though: who raises a coat over an arm by the
//! least change of numbers raises it over the head between them too. Here the *order* of the drawing changes as little as
//! possible. Marks that do not hold are mended one after the other. Either the part behind goes to just behind the part in
//! front, or the part in front goes to just before the part behind. With it go
//!
//! - what belongs to it ([`Kin::with`]): a hand goes with its arm
//! - what marks keep on its side: a mark that holds is never broken, so the mending ends
//!
//! Of both ways the one is taken on which fewer pairs of body parts change places, then the one on which fewer pairs do, then
//! the one that moves fewer parts. Body parts come first because limbs are what swings before and behind a body; head and
//! coat meet on every frame. All others keep their depths. A part that moved has a depth of its own.
//!
//! Parts of equal depth have no order that could be kept. What marks say of them is spread out first, as Sýkora et al. do it: on
//! strips without depths, marks on half of the crossing pairs put more pairs right so than one mark after the other does.
//!
//! Limits: parts do not pass through each other within one frame, and marks apply to complete parts. Two marks may have a
//! better common way than the two that are best one after the other.

/// A mark: one part is in front of another, from a first to a last frame, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Index of the part in front.
    pub front: usize,
    /// Index of the part behind.
    pub behind: usize,
    /// First frame.
    pub first: i32,
    /// Last frame.
    pub last: i32,
}

/// Why no order exists.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DepthError {
    /// A mark names a part that does not exist.
    #[error("mark {mark}: found part {found}, expected one of {parts} parts")]
    Part {
        /// Index of the mark.
        mark: usize,
        /// The part that it names.
        found: usize,
        /// Number of parts.
        parts: usize,
    },
    /// Marks contradict each other.
    #[error("frame {frame}: marks {} contradict each other: each part would be in front of itself", list(marks))]
    Contradiction {
        /// The frame.
        frame: i32,
        /// The marks of one cycle, in order.
        marks: Vec<usize>,
    },
}

fn list(marks: &[usize]) -> String {
    marks.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// Least difference in depth of two parts of equal depth with a mark.
const GAP: f64 = 1.0;
/// Greatest number of sweeps over all marks. A chain of n parts needs about n².
const SWEEPS: usize = 10_000;
/// The sweeps end when none changes a depth by as much as this.
const TOLERANCE: f64 = 1e-9;
/// Room below the lowest part and above the highest one.
const ROOM: f64 = 1.0;
/// Least difference in depth of parts that are put between others. Documents have six decimals.
const LEAST: f64 = 1e-4;

/// What belongs together, by part.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Kin {
    /// The parts that go along where a part goes.
    pub with: Vec<Vec<usize>>,
    /// Whether it is of the body, and of no leg or limb.
    pub body: Vec<bool>,
}

/// Depths at a frame, larger values nearer to the viewer: in the order of the given depths, as far as the marks allow.
///
/// # Errors
///
/// [`DepthError::Part`] or [`DepthError::Contradiction`].
pub fn infer(depths: &[f64], marks: &[Mark], kin: &Kin, frame: i32) -> Result<Vec<f64>, DepthError> {
    for (mark, m) in marks.iter().enumerate() {
        if let Some(&found) = [m.front, m.behind].iter().find(|p| **p >= depths.len()) {
            return Err(DepthError::Part { mark, found, parts: depths.len() });
        }
    }
    let active: Vec<usize> = (0..marks.len()).filter(|&k| (marks[k].first..=marks[k].last).contains(&frame)).collect();
    if let Some(marks) = cycle(depths.len(), marks, &active) {
        return Err(DepthError::Contradiction { frame, marks });
    }
    let marks: Vec<(usize, usize)> = active.into_iter().map(|k| (marks[k].front, marks[k].behind)).collect();
    let depths = spread(depths, &marks);
    let mut order = Order { depths, marks: with_kin(marks, kin), kin };
    // Each turn mends a mark and breaks none.
    for _ in 0..order.marks.len() {
        let broken = order.marks.iter().find(|(front, behind)| order.depths[*front] <= order.depths[*behind]);
        let Some(&mark) = broken else { break };
        order.mend(mark);
    }
    Ok(order.depths)
}

/// Pairs of parts that are in another order than in the drawing, the front one first, and that no mark names.
pub fn changed(depths: &[f64], found: &[f64], marks: &[Mark], frame: i32) -> Vec<(usize, usize)> {
    let named = |a: usize, b: usize| {
        let on = |m: &&Mark| (m.first..=m.last).contains(&frame);
        marks.iter().filter(on).any(|m| (m.front, m.behind) == (a, b))
    };
    let pairs = (0..depths.len()).flat_map(|a| (0..depths.len()).map(move |b| (a, b)));
    pairs.filter(|&(a, b)| found[a] > found[b] && depths[a] < depths[b] && !named(a, b)).collect()
}

/// Marks, and what they mean for the kin of their parts: what hides an arm hides its hand. Kin with marks of its own obeys those alone.
fn with_kin(marks: Vec<(usize, usize)>, kin: &Kin) -> Vec<(usize, usize)> {
    let of = |part: usize| kin.with.get(part).into_iter().flatten().copied();
    let mut all = marks.clone();
    let told: Vec<usize> = marks.iter().flat_map(|(front, behind)| [*front, *behind]).collect();
    for (front, behind) in marks {
        let below = of(behind).filter(|&k| !of(front).any(|own| own == k)).map(|k| (front, k));
        let above = of(front).filter(|&k| !of(behind).any(|own| own == k)).map(|k| (k, behind));
        for (a, b) in below.chain(above).collect::<Vec<_>>() {
            let own = if a == front { b } else { a };
            if !told.contains(&own) && !leads(&all, b, a) {
                all.push((a, b));
            }
        }
    }
    all
}

/// Whether marks put a part in front of another, or it is that one.
fn leads(marks: &[(usize, usize)], front: usize, behind: usize) -> bool {
    let (mut seen, mut open) = (vec![front], vec![front]);
    while let Some(part) = open.pop() {
        let next = marks.iter().filter(|(from, _)| *from == part).map(|(_, to)| *to);
        let new: Vec<usize> = next.filter(|to| !seen.contains(to)).collect();
        seen.extend(&new);
        open.extend(new);
    }
    seen.contains(&behind)
}

/// The depths with parts of equal depth apart where marks say so: the least change, which Hildreth's method (cyclic dual coordinate
/// ascent) finds. They stay between the depths below and above.
fn spread(depths: &[f64], marks: &[(usize, usize)]) -> Vec<f64> {
    let equal: Vec<(usize, usize)> = marks.iter().filter(|(a, b)| depths[*a] == depths[*b]).copied().collect();
    let mut moves = vec![0.0; depths.len()];
    let mut pressure = vec![0.0; equal.len()];
    for _ in 0..SWEEPS {
        let mut worst = 0.0f64;
        for (pressure, &(front, behind)) in pressure.iter_mut().zip(&equal) {
            let change = ((GAP - (moves[front] - moves[behind])) / 2.0).max(-*pressure);
            worst = worst.max(change.abs());
            *pressure += change;
            moves[front] += change;
            moves[behind] -= change;
        }
        if worst < TOLERANCE {
            break;
        }
    }
    let placed = |k: usize| {
        let group = || (0..depths.len()).filter(|&other| depths[other] == depths[k]);
        let most = group().map(|other| moves[other].abs()).fold(0.0, f64::max);
        let others = depths.iter().map(|depth| (depth - depths[k]).abs()).filter(|apart| *apart > 0.0);
        let room = others.fold(f64::INFINITY, f64::min) / 3.0;
        depths[k] + moves[k] * if most > room { room / most } else { 1.0 }
    };
    (0..depths.len()).map(placed).collect()
}

/// The order of parts on one frame.
struct Order<'a> {
    depths: Vec<f64>,
    /// Front and behind.
    marks: Vec<(usize, usize)>,
    kin: &'a Kin,
}

impl Order<'_> {
    /// Lets a mark hold.
    fn mend(&mut self, mark: (usize, usize)) {
        let ways = [self.group(mark, false), self.group(mark, true)];
        let costs = [self.cost(&ways[0], mark, false), self.cost(&ways[1], mark, true)];
        let rise = costs[1] < costs[0];
        let [lowered, raised] = ways;
        self.put(if rise { raised } else { lowered }, mark, rise);
    }

    /// Whether a part is on the wrong side of the mark's other part, or beside it.
    fn is_beyond(&self, part: usize, (front, behind): (usize, usize), rise: bool) -> bool {
        match rise {
            false => part != front && self.depths[part] >= self.depths[front],
            true => part != behind && self.depths[part] <= self.depths[behind],
        }
    }

    /// The parts that go: the one behind if it is lowered, else the one in front, with their kin and what marks keep on their side.
    fn group(&self, mark: (usize, usize), rise: bool) -> Vec<usize> {
        let (mover, other) = if rise { (mark.0, mark.1) } else { (mark.1, mark.0) };
        // Marks lead from one part to the next that has to be on the same side.
        let next = |part: usize| {
            let ends =
                self.marks.iter().map(move |&(front, behind)| if rise { (behind, front) } else { (front, behind) });
            ends.filter(move |(from, _)| *from == part).map(|(_, to)| to)
        };
        let leads_to_other = |start: usize| match rise {
            false => leads(&self.marks, start, other),
            true => leads(&self.marks, other, start),
        };
        let (mut group, mut open) = (vec![mover], vec![mover]);
        while let Some(part) = open.pop() {
            let kin = self.kin.with.get(part).into_iter().flatten().copied();
            let kin = kin.filter(|&to| !leads_to_other(to));
            let more: Vec<usize> = kin.chain(next(part)).filter(|&to| self.is_beyond(to, mark, rise)).collect();
            for to in more {
                if !group.contains(&to) {
                    group.push(to);
                    open.push(to);
                }
            }
        }
        group.sort_by(|a, b| self.depths[*a].total_cmp(&self.depths[*b]).then(a.cmp(b)));
        group
    }

    /// Pairs of body parts that would change places, all pairs that would, parts that would move.
    fn cost(&self, group: &[usize], mark: (usize, usize), rise: bool) -> (usize, usize, usize) {
        let is_body = |part: usize| self.kin.body.get(part).copied().unwrap_or(false);
        let (mut body, mut all) = (0, 0);
        for &moved in group {
            for stays in (0..self.depths.len()).filter(|k| !group.contains(k)) {
                let passed = match rise {
                    false => self.depths[stays] >= self.depths[mark.0] && self.depths[stays] < self.depths[moved],
                    true => self.depths[stays] <= self.depths[mark.1] && self.depths[stays] > self.depths[moved],
                };
                let asked = if rise { (moved, stays) } else { (stays, moved) };
                if passed && !self.marks.contains(&asked) {
                    all += 1;
                    body += usize::from(is_body(moved) && is_body(stays));
                }
            }
        }
        (body, all, group.len())
    }

    /// Puts a group just behind the part in front, or just before the one behind.
    fn put(&mut self, group: Vec<usize>, mark: (usize, usize), rise: bool) {
        let at = self.depths[if rise { mark.1 } else { mark.0 }];
        let others = || (0..self.depths.len()).filter(|k| !group.contains(k)).map(|k| self.depths[k]);
        let next = match rise {
            false => others().filter(|depth| *depth < at).max_by(f64::total_cmp).unwrap_or(at - ROOM),
            true => others().filter(|depth| *depth > at).min_by(f64::total_cmp).unwrap_or(at + ROOM),
        };
        let (low, mut high) = (next.min(at), next.max(at));
        let places = (group.len() + 1) as f64;
        if high - low < LEAST * places {
            // Too narrow: all above make room.
            let above: Vec<usize> =
                (0..self.depths.len()).filter(|&k| self.depths[k] >= high && !group.contains(&k)).collect();
            above.into_iter().for_each(|k| self.depths[k] += ROOM);
            high += ROOM;
        }
        for (k, part) in group.into_iter().enumerate() {
            self.depths[part] = low + (high - low) * (k + 1) as f64 / places;
        }
    }
}

/// The marks of a cycle, found by depth-first search.
fn cycle(parts: usize, marks: &[Mark], active: &[usize]) -> Option<Vec<usize>> {
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); parts];
    active.iter().for_each(|&k| leaving[marks[k].front].push(k));
    let mut done = vec![false; parts];
    for start in 0..parts {
        // The marks on the path to this part, and for each part on the path the next mark to try.
        let mut path: Vec<usize> = Vec::new();
        let mut stack = vec![(start, 0)];
        while let Some((part, next)) = stack.last_mut() {
            let Some(&mark) = leaving[*part].get(*next).filter(|_| !done[*part]) else {
                done[*part] = true;
                stack.pop();
                path.pop();
                continue;
            };
            *next += 1;
            let to = marks[mark].behind;
            if let Some(place) = stack.iter().position(|(part, _)| *part == to) {
                path.push(mark);
                return Some(path[place..].to_vec());
            }
            if !done[to] {
                path.push(mark);
                stack.push((to, 0));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(front: usize, behind: usize) -> Mark {
        Mark { front, behind, first: 0, last: 10 }
    }

    /// Parts of which nothing is known.
    fn alone(depths: &[f64], marks: &[Mark], frame: i32) -> Result<Vec<f64>, DepthError> {
        infer(depths, marks, &Kin::default(), frame)
    }

    #[test]
    fn marks_hold_and_the_rest_stays() {
        let depths = [5.0, 1.0, 2.0, 3.0];
        let found = alone(&depths, &[mark(1, 3), mark(2, 1)], 4).unwrap();
        assert_eq!(found, [5.0, 1.0, 2.0, 0.5], "one part goes, and only its own pairs change");
    }

    #[test]
    fn a_limb_goes_behind_the_body_with_what_is_on_it() {
        // Coat, head, eye, arm, hand; the hand hangs on the arm.
        let depths = [6.0, 7.0, 8.0, 9.0, 10.0];
        let kin =
            Kin { with: vec![vec![], vec![2], vec![], vec![4], vec![]], body: vec![true, true, true, false, false] };
        let found = infer(&depths, &[mark(0, 3)], &kin, 0).unwrap();
        assert_eq!(found[..3], depths[..3], "the head stays before the coat");
        assert!(found[3] < found[4] && found[4] < found[0], "{found:?}");
        let pairs = changed(&depths, &found, &[mark(0, 3)], 0);
        assert_eq!(pairs, [(0, 4), (1, 3), (1, 4), (2, 3), (2, 4)]);
        // A mark that says otherwise of the hand counts more.
        let found = infer(&depths, &[mark(0, 3), mark(4, 1)], &kin, 0).unwrap();
        assert!(found[3] < found[0] && found[4] == 10.0, "{found:?}");
        // A body part among body parts takes what is on it along.
        let found = infer(&depths, &[mark(0, 1)], &kin, 0).unwrap();
        assert!(found[1] < found[2] && found[2] < found[0], "{found:?}");
    }

    #[test]
    fn parts_of_one_depth_are_spread_between_the_others() {
        let found = alone(&[2.0, 2.0, 2.0, 2.0, 2.5], &[mark(0, 1), mark(1, 2)], 0).unwrap();
        assert_eq!((found[3], found[4]), (2.0, 2.5), "parts without marks stay");
        assert!(found[2] < found[1] && found[1] < found[0] && found[0] < 2.5 && found[2] > 1.5, "{found:?}");
    }

    #[test]
    fn depths_are_never_equal_and_no_mark_is_broken() {
        // A fixed sequence of pseudo-random numbers.
        let mut state = 12345u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for _ in 0..500 {
            let depths: Vec<f64> = (0..9).map(|k| f64::from(k) * if next(2) == 0 { 1.0 } else { 1e-5 }).collect();
            let marks: Vec<Mark> = (0..7).map(|_| mark(next(9) as usize, next(9) as usize)).collect();
            let with = (0..9).map(|_| vec![next(9) as usize]).collect();
            let kin = Kin { with, body: (0..9).map(|_| next(2) == 0).collect() };
            let Ok(found) = infer(&depths, &marks, &kin, 0) else { continue };
            assert!(marks.iter().all(|m| found[m.front] > found[m.behind] + 1e-6), "{depths:?} {marks:?} {found:?}");
            let same = |a: usize, b: usize| (found[a] - found[b]).abs() < 1e-6 && (depths[a] - depths[b]).abs() > 1e-9;
            assert!(!(0..9).any(|a| (0..a).any(|b| same(a, b))), "{depths:?} {marks:?} {found:?}");
        }
    }

    #[test]
    fn marks_hold_on_their_frames_only() {
        let marks = [Mark { front: 0, behind: 1, first: 3, last: 5 }];
        assert_eq!(alone(&[0.0, 1.0], &marks, 2).unwrap(), [0.0, 1.0]);
        let found = alone(&[0.0, 1.0], &marks, 5).unwrap();
        assert!(found[0] > found[1]);
        assert_eq!(alone(&[4.0, 1.0], &marks, 4).unwrap(), [4.0, 1.0]);
    }

    #[test]
    fn contradictions_are_named() {
        let marks = [mark(0, 1), mark(3, 0), mark(1, 2), mark(2, 0)];
        let error = alone(&[0.0; 4], &marks, 7).unwrap_err();
        assert_eq!(error, DepthError::Contradiction { frame: 7, marks: vec![0, 2, 3] });
        assert!(error.to_string().starts_with("frame 7: marks 0, 2, 3 contradict each other"));
        assert_eq!(
            alone(&[0.0], &[mark(0, 0)], 0).unwrap_err(),
            DepthError::Contradiction { frame: 0, marks: vec![0] }
        );
        let other = [Mark { last: 3, ..mark(0, 1) }, Mark { first: 4, ..mark(1, 0) }];
        assert!(alone(&[0.0; 2], &other, 3).is_ok() && alone(&[0.0; 2], &other, 4).is_ok());
        assert_eq!(alone(&[0.0], &[mark(0, 9)], 0).unwrap_err(), DepthError::Part { mark: 0, found: 9, parts: 1 });
    }

    #[test]
    fn a_diamond_is_no_cycle() {
        let marks = [mark(0, 1), mark(0, 2), mark(1, 3), mark(2, 3)];
        let found = alone(&[0.0; 4], &marks, 0).unwrap();
        assert!(marks.iter().all(|m| found[m.front] - found[m.behind] > 1e-6));
    }
}
