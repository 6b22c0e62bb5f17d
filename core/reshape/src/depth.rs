//! Depth order of parts from a few marks "in front" and "behind" (after Sýkora et al. 2010, "Adding Depth to Cartoons
//! Using Sparse Depth (In)equalities").
//!
//! A mark says that one part is in front of another, for a range of frames. The marks of one frame form a directed
//! graph. Marks contradict each other exactly if they form a cycle. The error lists the marks of the first cycle that
//! is found.
//!
//! Without a cycle the depths minimise Σ (d_p − d⁰_p)² subject to d_front ≥ d_behind + 1, where d⁰ are the depths of
//! the drawing. This is a small convex quadratic problem. Hildreth's method (cyclic dual coordinate ascent) solves it
//! without a matrix. Parts without marks keep their depth. The others move as little as the marks allow.
//!
//! Limits: parts do not pass through each other within one frame, and marks apply to complete parts.

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

/// Least difference in depth between the part in front and the part behind.
const GAP: f64 = 1.0;
/// Greatest number of sweeps over all marks. A chain of n parts needs about n².
const SWEEPS: usize = 10_000;
/// The sweeps end when none changes a depth by as much as this.
const TOLERANCE: f64 = 1e-9;

/// Depths at a frame, larger values nearer to the viewer: as close to the given depths as the marks allow.
///
/// # Errors
///
/// [`DepthError::Part`] or [`DepthError::Contradiction`].
pub fn infer(depths: &[f64], marks: &[Mark], frame: i32) -> Result<Vec<f64>, DepthError> {
    for (mark, m) in marks.iter().enumerate() {
        if let Some(&found) = [m.front, m.behind].iter().find(|p| **p >= depths.len()) {
            return Err(DepthError::Part { mark, found, parts: depths.len() });
        }
    }
    let active: Vec<usize> = (0..marks.len()).filter(|&k| (marks[k].first..=marks[k].last).contains(&frame)).collect();
    if let Some(marks) = cycle(depths.len(), marks, &active) {
        return Err(DepthError::Contradiction { frame, marks });
    }
    let mut found = depths.to_vec();
    let mut pressure = vec![0.0; active.len()];
    for _ in 0..SWEEPS {
        let mut worst = 0.0f64;
        for (pressure, &k) in pressure.iter_mut().zip(&active) {
            let (front, behind) = (marks[k].front, marks[k].behind);
            let missing = GAP - (found[front] - found[behind]);
            let change = (missing / 2.0).max(-*pressure);
            worst = worst.max(change.abs());
            *pressure += change;
            found[front] += change;
            found[behind] -= change;
        }
        if worst < TOLERANCE {
            break;
        }
    }
    Ok(found)
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

    #[test]
    fn marks_hold_and_the_rest_stays() {
        let depths = [5.0, 1.0, 2.0, 3.0];
        let found = infer(&depths, &[mark(1, 3), mark(2, 1)], 4).unwrap();
        assert!(found[1] - found[3] > 1.0 - 1e-6 && found[2] - found[1] > 1.0 - 1e-6, "{found:?}");
        assert_eq!(found[0], 5.0);
        // The least change keeps the middle of the three: 1, 2, 3 become 2, 3, 1.
        assert!([2.0, 3.0, 1.0].iter().zip(&found[1..]).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn marks_hold_on_their_frames_only() {
        let marks = [Mark { front: 0, behind: 1, first: 3, last: 5 }];
        assert_eq!(infer(&[0.0, 1.0], &marks, 2).unwrap(), [0.0, 1.0]);
        let found = infer(&[0.0, 1.0], &marks, 5).unwrap();
        assert!(found[0] > found[1]);
        assert_eq!(infer(&[4.0, 1.0], &marks, 4).unwrap(), [4.0, 1.0]);
    }

    #[test]
    fn contradictions_are_named() {
        let marks = [mark(0, 1), mark(3, 0), mark(1, 2), mark(2, 0)];
        let error = infer(&[0.0; 4], &marks, 7).unwrap_err();
        assert_eq!(error, DepthError::Contradiction { frame: 7, marks: vec![0, 2, 3] });
        assert!(error.to_string().starts_with("frame 7: marks 0, 2, 3 contradict each other"));
        assert_eq!(
            infer(&[0.0], &[mark(0, 0)], 0).unwrap_err(),
            DepthError::Contradiction { frame: 0, marks: vec![0] }
        );
        let other = [Mark { last: 3, ..mark(0, 1) }, Mark { first: 4, ..mark(1, 0) }];
        assert!(infer(&[0.0; 2], &other, 3).is_ok() && infer(&[0.0; 2], &other, 4).is_ok());
        assert_eq!(infer(&[0.0], &[mark(0, 9)], 0).unwrap_err(), DepthError::Part { mark: 0, found: 9, parts: 1 });
    }

    #[test]
    fn a_diamond_is_no_cycle() {
        let marks = [mark(0, 1), mark(0, 2), mark(1, 3), mark(2, 3)];
        let found = infer(&[0.0; 4], &marks, 0).unwrap();
        assert!(marks.iter().all(|m| found[m.front] - found[m.behind] > 1.0 - 1e-6));
    }
}
