//! Long sections in chunks, so that the work grows with the number of points and no faster.
//!
//! A first fit of the whole section, with a few nodes more than foretold, gives a curve that is right nearly everywhere. It
//! is cut at joints with small errors; the two nodes about each such joint stay as they are, so that the chunks join as
//! smoothly as before, and each chunk looks for its fewest nodes by itself.

use super::count::{Unfit, fewest};
use super::profile::Profile;
use super::section::{End, Ends};
use super::solve::Errors;
use super::trial::{Effort, Given, Trial};
use crate::geometry::Point;

/// Sections of more pieces than that are cut.
const LONG: f64 = 48.0;
/// Wanted pieces of a chunk.
const CHUNK: usize = 28;
/// Joints around the wanted one among which the best is taken.
const CHOICE: usize = 5;
/// Nodes of the first fit, as a multiple of those foretold.
const AMPLE: f64 = 1.15;
/// Work of the first fit.
const EFFORT: Effort = Effort { squares: 4, excess: 9 };

/// The fit of a section with the fewest nodes found.
pub(super) fn fit(given: &Given) -> Result<Trial, Vec<Unfit>> {
    let profile = Profile::grown(given.points, given.lengths, given.limit);
    if profile.total() <= LONG {
        return fewest(given, profile).map_err(|unfit| vec![unfit]);
    }
    let nodes = ((profile.total() * AMPLE).ceil() as usize + 2).max(given.ends.least());
    if nodes * 3 > given.points.len() {
        return Err(vec![Unfit::Noise]);
    }
    let whole = given.run(given.start(nodes, &profile), EFFORT, true);
    in_chunks(given, &whole)
}

/// A piece of the section between two joints of its first fit.
struct Chunk {
    /// Its points: indices, which go round in a closed section.
    points: Vec<usize>,
    ends: (End, End),
    held: [Point; 4],
}

fn in_chunks(given: &Given, whole: &Trial) -> Result<Trial, Vec<Unfit>> {
    let chunks = chunks(given, whole);
    let (mut merged, mut failures) = (Merged::new(given), Vec::new());
    for (k, chunk) in chunks.iter().enumerate() {
        let points: Vec<Point> = chunk.points.iter().map(|&j| given.points[j]).collect();
        let base = given.lengths[chunk.points[0]];
        let length = |&j: &usize| if given.lengths[j] < base { given.lengths[j] + given.total } else { given.lengths[j] } - base;
        let lengths: Vec<f64> = chunk.points.iter().map(length).collect();
        let total = lengths[lengths.len() - 1];
        let (ends, held) = (Ends::Open(chunk.ends.0, chunk.ends.1), chunk.held);
        let part = Given { points: &points, lengths: &lengths, total, ends, held, limit: given.limit };
        match fewest(&part, Profile::grown(&points, &lengths, given.limit)) {
            Ok(trial) => merged.add(chunk, &trial, k + 1 == chunks.len()),
            Err(Unfit::At(j)) => failures.push(Unfit::At(chunk.points[j])),
            Err(Unfit::Noise) => failures.push(Unfit::Noise),
        }
    }
    if failures.is_empty() { Ok(merged.finish()) } else { Err(failures) }
}

/// Joints at which to cut, by the index of the piece that begins there.
fn joints(given: &Given, whole: &Trial) -> Vec<usize> {
    let (_, errors) = given.measure(whole);
    let pieces = errors.len();
    let count = (pieces / CHUNK).max(1);
    let held = 3;
    let best = |wanted: usize| {
        let from = wanted.saturating_sub(CHOICE).max(held);
        let to = (wanted + CHOICE).min(pieces - held);
        (from..=to).min_by(|&a, &b| errors[a - 1].max(errors[a]).total_cmp(&errors[b - 1].max(errors[b])))
    };
    let first = usize::from(given.ends != Ends::Periodic);
    (first..count).filter_map(|k| best(k * pieces / count + if first == 0 { held + CHOICE } else { 0 })).collect()
}

fn chunks(given: &Given, whole: &Trial) -> Vec<Chunk> {
    let joints = joints(given, whole);
    let n = given.points.len();
    // The first point of each piece that begins at a joint; points follow the curve, small steps back aside.
    let starts: Vec<usize> = joints
        .iter()
        .map(|&i| {
            let ahead = |j: usize| {
                let t = whole.parameters[j];
                t >= i as f64 && t < (i + CHUNK / 2) as f64
            };
            (0..n).find(|&j| ahead(j)).unwrap_or(n - 1)
        })
        .collect();
    let about = |i: usize| whole.nodes[whole.slots[i].nodes[1]];
    let at = |i: usize| (about(i - 1), about(i));
    match given.ends {
        Ends::Periodic => (0..joints.len())
            .map(|k| {
                let next = (k + 1) % joints.len();
                let count = (starts[next] + n - starts[k] - 1) % n + 1;
                let points = (0..count).map(|j| (starts[k] + j) % n).collect();
                let ((a, b), (c, d)) = (at(joints[k]), at(joints[next]));
                Chunk { points, ends: (End::Joined, End::Joined), held: [a, b, c, d] }
            })
            .collect(),
        Ends::Open(start, end) => (0..=joints.len())
            .map(|k| {
                let from = if k == 0 { 0 } else { starts[k - 1] };
                let to = if k == joints.len() { n } else { starts[k] };
                let ends = (if k == 0 { start } else { End::Joined }, if k == joints.len() { end } else { End::Joined });
                let (a, b) = if k == 0 { (given.held[0], given.held[1]) } else { at(joints[k - 1]) };
                let (c, d) = if k == joints.len() { (given.held[2], given.held[3]) } else { at(joints[k]) };
                Chunk { points: (from..to).collect(), ends, held: [a, b, c, d] }
            })
            .collect(),
    }
}

/// Chunks put together.
struct Merged<'a> {
    given: &'a Given<'a>,
    nodes: Vec<Point>,
    parameters: Vec<f64>,
    pieces: usize,
    errors: Errors,
}

impl<'a> Merged<'a> {
    fn new(given: &'a Given<'a>) -> Self {
        let parameters = vec![0.0; given.points.len()];
        Self { given, nodes: Vec::new(), parameters, pieces: 0, errors: Errors::default() }
    }

    fn add(&mut self, chunk: &Chunk, trial: &Trial, last: bool) {
        let from = usize::from(chunk.ends.0 == End::Joined);
        let to = trial.nodes.len() - usize::from(chunk.ends.1 == End::Joined);
        debug_assert!(last || chunk.ends.1 == End::Joined);
        self.nodes.extend(&trial.nodes[from..to]);
        for (&j, t) in chunk.points.iter().zip(&trial.parameters) {
            self.parameters[j] = self.pieces as f64 + t;
        }
        self.pieces += trial.slots.len();
        if trial.errors.largest > self.errors.largest {
            self.errors.largest = trial.errors.largest;
            self.errors.at = chunk.points[trial.errors.at];
        }
        self.errors.squares += trial.errors.squares;
    }

    fn finish(self) -> Trial {
        let slots = self.given.ends.slots(self.nodes.len());
        debug_assert_eq!(slots.len(), self.pieces);
        Trial { nodes: self.nodes, slots, parameters: self.parameters, errors: self.errors }
    }
}
