//! Long sections, fitted in chunks so that the work grows only linearly with the number of points.
//!
//! A first fit of the complete section, with a few nodes more than predicted, gives a curve that is right nearly
//! everywhere. The curve is cut at joints with small errors. The two nodes at each of these joints stay fixed, so the
//! chunks join as smoothly as before. Each chunk then searches for its own smallest number of nodes.

use super::count::{Unfit, fewest};
use super::profile::Profile;
use super::section::{End, Ends, piece};
use super::solve::Errors;
use super::trial::{Effort, Given, Trial};
use rototoon_base::geometry::Point;

/// Sections with more pieces than this are cut.
const LONG: f64 = 48.0;
/// Intended number of pieces of a chunk.
const CHUNK: usize = 28;
/// Number of joints on each side of the intended one among which the best is chosen.
const CHOICE: usize = 5;
/// Nodes of the first fit, as a multiple of the predicted number.
const AMPLE: f64 = 1.15;
/// A piece is crooked if the ratio of its length to the length of its points' line is outside this number to its
/// inverse.
const CROOKED: f64 = 0.7;
/// Rounds of joining chunks that cannot be fitted.
const JOININGS: usize = 3;
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

/// The joints at the start and the end of a chunk, each by the index of the piece that begins there; `None` at the
/// section's own ends.
type Joints = (Option<usize>, Option<usize>);

/// A stretch of the section between two joints of its first fit.
struct Chunk {
    joints: Joints,
    /// Indices of its points. In a closed section they may wrap around.
    points: Vec<usize>,
    ends: (End, End),
    held: [Point; 4],
}

impl Chunk {
    fn fit(&self, given: &Given) -> Result<Trial, Unfit> {
        let points: Vec<Point> = self.points.iter().map(|&j| given.points[j]).collect();
        let base = given.lengths[self.points[0]];
        let length = |&j: &usize| {
            let length = given.lengths[j] - base;
            if length < 0.0 { length + given.total } else { length }
        };
        let lengths: Vec<f64> = self.points.iter().map(length).collect();
        let total = lengths[lengths.len() - 1];
        let ends = Ends::Open(self.ends.0, self.ends.1);
        let held = self.held;
        let part = Given { points: &points, lengths: &lengths, total, ends, held, ..given.clone() };
        fewest(&part, Profile::grown(&points, &lengths, given.limit))
    }
}

/// Fits all chunks. A chunk that cannot be fitted is joined with its neighbour, at the joint nearer to the fault.
fn in_chunks(given: &Given, whole: &Trial) -> Result<Trial, Vec<Unfit>> {
    let mut joints = joints(given, whole);
    let mut done: Vec<(Joints, Trial)> = Vec::new();
    for round in 0..=JOININGS {
        let chunks = chunks(given, whole, &joints);
        let (mut bad_joints, mut failures) = (Vec::new(), Vec::new());
        for chunk in &chunks {
            if done.iter().any(|(joints, _)| *joints == chunk.joints) {
                continue;
            }
            match chunk.fit(given) {
                Ok(trial) => done.push((chunk.joints, trial)),
                Err(Unfit::Noise) => failures.push(Unfit::Noise),
                Err(Unfit::At(j)) => {
                    let near_start = 2 * j < chunk.points.len();
                    let (start, end) = chunk.joints;
                    bad_joints.extend(if near_start { start.or(end) } else { end.or(start) });
                    failures.push(Unfit::At(chunk.points[j]));
                }
            }
        }
        if failures.is_empty() {
            let mut merged = Merged::new(given);
            for chunk in &chunks {
                let trial = done.iter().find(|(joints, _)| *joints == chunk.joints);
                trial.iter().for_each(|(_, trial)| merged.add(chunk, trial));
            }
            return Ok(merged.finish());
        }
        if round == JOININGS || bad_joints.len() < failures.len() {
            return Err(failures);
        }
        joints.retain(|joint| !bad_joints.contains(joint));
        if given.ends == Ends::Periodic && joints.is_empty() {
            return Err(failures);
        }
    }
    Err(vec![Unfit::Noise])
}

/// The joints at which to cut, by the index of the piece that begins there.
fn joints(given: &Given, whole: &Trial) -> Vec<usize> {
    let (cuts, errors) = given.measure(whole);
    let pieces = errors.len();
    let count = (pieces / CHUNK).max(1);
    let margin = 3;
    // A piece much longer or shorter than its points' line turns back somewhere.
    let crooked = |i: usize| {
        let piece = piece(&whole.nodes, &whole.slots[i]);
        let ratio = piece.length() / (cuts[i + 1] - cuts[i]);
        !(CROOKED..=1.0 / CROOKED).contains(&ratio)
    };
    let score = |i: usize| {
        let around = i - 2..i + 2;
        let worst = around.clone().map(|k| errors[k]).fold(0.0, f64::max);
        worst + given.limit * 10.0 * around.filter(|&k| crooked(k)).count() as f64
    };
    let best = |wanted: usize| {
        let from = wanted.saturating_sub(CHOICE).max(margin);
        let to = (wanted + CHOICE).min(pieces - margin);
        (from..=to).min_by(|&a, &b| score(a).total_cmp(&score(b)))
    };
    let periodic = given.ends == Ends::Periodic;
    let (first, shift) = if periodic { (0, margin + CHOICE) } else { (1, 0) };
    (first..count).filter_map(|k| best(k * pieces / count + shift)).collect()
}

/// The stretches between the joints.
fn chunks(given: &Given, whole: &Trial, joints: &[usize]) -> Vec<Chunk> {
    let n = given.points.len();
    // The first point of the piece that begins at a joint. Points follow the curve, apart from small steps back.
    let first_of = |i: usize| {
        let after = |&t: &f64| t >= i as f64 && t < (i + CHUNK / 2) as f64;
        whole.parameters.iter().position(after).unwrap_or(n - 1)
    };
    let about = |i: usize| whole.nodes[whole.slots[i].nodes[1]];
    let chunk = |from: Option<usize>, to: Option<usize>| {
        let Ends::Open(start, end) = given.ends else { return cyclic_chunk(from, to, n, &first_of, &about) };
        let (begin, stop) = (from.map_or(0, first_of), to.map_or(n, first_of));
        let [a, b] = from.map_or([given.held[0], given.held[1]], |i| [about(i - 1), about(i)]);
        let [c, d] = to.map_or([given.held[2], given.held[3]], |i| [about(i - 1), about(i)]);
        let ends = (from.map_or(start, |_| End::Joined), to.map_or(end, |_| End::Joined));
        Chunk { joints: (from, to), points: (begin..stop).collect(), ends, held: [a, b, c, d] }
    };
    let at = |k: usize| Some(joints[k]);
    match given.ends {
        Ends::Periodic => (0..joints.len()).map(|k| chunk(at(k), at((k + 1) % joints.len()))).collect(),
        Ends::Open(..) if joints.is_empty() => vec![chunk(None, None)],
        Ends::Open(..) => {
            let last = joints.len() - 1;
            let inner = (0..last).map(|k| chunk(at(k), at(k + 1)));
            std::iter::once(chunk(None, at(0))).chain(inner).chain([chunk(at(last), None)]).collect()
        }
    }
}

/// A stretch of a closed section. It may run across the start.
fn cyclic_chunk(
    from: Option<usize>,
    to: Option<usize>,
    n: usize,
    first_of: &impl Fn(usize) -> usize,
    about: &impl Fn(usize) -> Point,
) -> Chunk {
    let (i, k) = (from.unwrap_or(1), to.unwrap_or(1));
    let (begin, stop) = (first_of(i), first_of(k));
    let count = (stop + n - begin - 1) % n + 1;
    let points = (0..count).map(|j| (begin + j) % n).collect();
    let held = [about(i - 1), about(i), about(k - 1), about(k)];
    Chunk { joints: (from, to), points, ends: (End::Joined, End::Joined), held }
}

/// Chunks that are put together.
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

    fn add(&mut self, chunk: &Chunk, trial: &Trial) {
        let from = usize::from(chunk.ends.0 == End::Joined);
        let to = trial.nodes.len() - usize::from(chunk.ends.1 == End::Joined);
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
