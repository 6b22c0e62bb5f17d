//! Motion from a neighbour: carries a pose from one drawing to the next.
//!
//! The starts on the next drawing are the pose itself, the pose moved by the dense flow below it (node by node, and as
//! a whole by the median), and the pose moved by its last motion. Starts that are too near to an earlier one are
//! dropped. Each start is aligned on the coarsest level. Of the aligned and the unaligned starts the best two are
//! aligned on the finer levels.
//!
//! The colours are always those of the key, so nothing drifts from drawing to drawing.

use super::lattice::align::{Aligner, Settler, Target, draw, settle};
use super::lattice::anchors::Anchors;
use super::lattice::limb::Limb;
use super::lattice::necks::Necks;
use super::lattice::texture::{Cover, Texture, in_picture};
use crate::contract::error::TrackError;
use crate::shared::features::Features;
use crate::shared::store::FLOW_LEVEL;
use rototoon_base::geometry::Point;
use rototoon_image::flow::Flow;

/// Least sample weight at a node for its flow to be known. Other nodes take the flow of the nearest known node.
const LEAST_FLOW_WEIGHT: f64 = 0.3;

/// Colour difference at which the evidence that a sample is in its right place has fallen to 1/e.
const FITS: f32 = 0.01;
/// Two poses with a smaller mean distance of their nodes (working pixels) become the same pose on finer levels.
const SAME_POSE: f64 = 1.0;
/// Two starts with a smaller mean distance of their nodes (working pixels) become the same pose. It is the step length
/// at which the coarsest level of an alignment ends.
const SAME_START: f64 = 2.4;
/// Weight that holds a node whose samples fit, relative to the lattice's stiffness.
const HOLD: f64 = 0.3;

/// A part's appearance at one key, ready to be aligned. Lengths are in working pixels.
pub struct Model {
    /// The key's colours on the lattice.
    pub texture: Texture,
    /// Aligns poses of the lattice.
    pub aligner: Aligner,
    /// The cover of the key's picture: where the part is hidden there.
    pub cover: Cover,
    /// The nodes of the lattice, moved to the other key's contour.
    pub there: Vec<Point>,
    /// The nodes in the shape of the other key, moved rigidly with scale onto this key's contour: the part if it only
    /// bent.
    pub bent: Vec<Point>,
    /// The part as a limb. None if it is not slender.
    pub limb: Option<Limb>,
    /// Where the part may turn.
    pub necks: Necks,
}

/// A drawing on which poses are searched.
pub struct Scenery<'a> {
    /// Features of its picture.
    pub features: &'a Features,
    /// The cover: where the part is hidden. The alignment leaves hidden samples out.
    pub cover: &'a Cover,
    /// Whether samples under the cover count as unseen when a pose is measured. If not, only samples outside the
    /// picture do.
    pub weighed: bool,
    /// The artist's corrections, as constraints on the model's lattice.
    pub anchors: &'a Anchors,
}

/// A possible pose of a model on a drawing, with its energy.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Places of the lattice's nodes, in working pixels.
    pub nodes: Vec<Point>,
    /// See [`Texture::energy`].
    pub energy: f64,
}

impl Model {
    /// Aligns each start on the coarsest level, then the best two on the finer levels, and returns the best pose.
    pub fn best_of(&self, scenery: &Scenery, starts: Vec<Vec<Point>>) -> Pose {
        let (target, settler) = (scenery.target(), self.settler(scenery));
        let mut poses = Vec::new();
        for start in distinct(starts) {
            let start = settler.settle(&start);
            let aligned = self.aligner.align(&self.texture, target, &start, &[0]);
            poses.push(self.ranked(scenery, aligned));
            poses.push(self.ranked(scenery, start));
        }
        poses.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        if poses.get(1).is_some_and(|second| mean_distance(&second.nodes, &poses[0].nodes) < SAME_POSE) {
            poses.truncate(1);
        }
        poses.truncate(2);
        let polished = poses.iter().map(|pose| {
            let nodes = self.aligner.align(&self.texture, target, &pose.nodes, &[1]);
            self.measured(scenery, nodes)
        });
        let best = polished.min_by(|a, b| a.energy.total_cmp(&b.energy));
        let nodes = best.map_or_else(|| self.texture.mesh.rest.clone(), |pose| pose.nodes);
        self.measured(scenery, self.aligner.align(&self.texture, target, &nodes, &[2]))
    }

    /// A rough pose moved to its anchors and aligned on the two finer levels.
    pub fn polished(&self, scenery: &Scenery, start: &[Point]) -> Pose {
        let start = settle(&self.texture.mesh, start, scenery.anchors);
        let nodes = self.aligner.align(&self.texture, scenery.target(), &start, &[1, 2]);
        self.measured(scenery, nodes)
    }

    /// The best `count` of some rough poses, moved to their anchors and aligned on the two finer levels. They are
    /// ranked after the first of these levels. Poses that become the same count as one.
    pub fn best_polished(&self, scenery: &Scenery, starts: &[Vec<Point>], count: usize) -> Vec<Pose> {
        let align = |start: &[Point], level: usize| {
            self.measured(scenery, self.aligner.align(&self.texture, scenery.target(), start, &[level]))
        };
        let settler = self.settler(scenery);
        let mut poses: Vec<Pose> = starts.iter().map(|start| align(&settler.settle(start), 1)).collect();
        poses.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        let mut best: Vec<Pose> = Vec::with_capacity(count);
        for pose in poses {
            if best.len() < count && best.iter().all(|b| mean_distance(&b.nodes, &pose.nodes) >= SAME_POSE) {
                best.push(pose);
            }
        }
        best.iter().map(|pose| align(&pose.nodes, 2)).collect()
    }

    /// A settler that moves poses to the anchors of a drawing.
    pub fn settler<'a>(&'a self, scenery: &Scenery<'a>) -> Settler<'a> {
        Settler::new(&self.texture.mesh, scenery.anchors)
    }

    /// A pose moved to its anchors, while its samples that fit the picture stay in place. `differences` are those of
    /// [`Texture::differences`].
    pub fn drawn(&self, scenery: &Scenery, start: &[Point], differences: &[f32]) -> Pose {
        let mut hold = vec![(0.0, 1e-9); start.len()];
        for (texel, difference) in self.texture.measured().iter().zip(differences) {
            let fits = f64::from((-difference / FITS).exp());
            for (n, w) in texel.binding.nodes.into_iter().zip(texel.binding.weights) {
                hold[n] = (hold[n].0 + w.max(0.0) * fits, hold[n].1 + w.max(0.0));
            }
        }
        let hold: Vec<f64> = hold.into_iter().map(|(sum, weight)| HOLD * (sum / weight).powi(2)).collect();
        self.measured(scenery, draw(&self.texture.mesh, start, scenery.anchors, &hold))
    }

    /// A pose aligned on all levels, or only on the two finer levels if that gives less energy.
    pub fn realigned(&self, scenery: &Scenery, start: &[Point]) -> Pose {
        let first = self.aligner.align(&self.texture, scenery.target(), start, &[0]);
        let coarse = self.aligner.align(&self.texture, scenery.target(), &first, &[1, 2]);
        if mean_distance(&first, start) < SAME_POSE {
            return self.measured(scenery, coarse);
        }
        let fine = self.aligner.align(&self.texture, scenery.target(), start, &[1, 2]);
        let (coarse, fine) = (self.measured(scenery, coarse), self.measured(scenery, fine));
        if coarse.energy < fine.energy { coarse } else { fine }
    }

    /// A pose aligned on the two finer levels to its visible samples, from where it is.
    pub fn seen(&self, scenery: &Scenery, start: &[Point]) -> Pose {
        let nodes = self.aligner.align(&self.texture, scenery.target(), start, &[1, 2]);
        self.measured(scenery, nodes)
    }

    /// A pose with a rough energy, which is only used to rank poses before they are aligned further.
    pub fn ranked(&self, scenery: &Scenery, nodes: Vec<Point>) -> Pose {
        let seen = |p| if scenery.weighed { !scenery.cover.hides(p) } else { in_picture(p, scenery.cover.width()) };
        Pose { energy: self.texture.rough_energy_where(scenery.features, &nodes, seen), nodes }
    }

    /// A pose with its energy.
    pub fn measured(&self, scenery: &Scenery, nodes: Vec<Point>) -> Pose {
        let energy = if scenery.weighed {
            self.texture.energy_where(scenery.features, &nodes, |p| !scenery.cover.hides(p))
        } else {
            self.texture.energy(scenery.features, &nodes)
        };
        Pose { energy, nodes }
    }

    /// Cost of each sample that measures a pose.
    pub fn differences(&self, scenery: &Scenery, nodes: &[Point]) -> Vec<f32> {
        if scenery.weighed {
            self.texture.differences_where(scenery.features, nodes, |p| !scenery.cover.hides(p))
        } else {
            self.texture.differences(scenery.features, nodes)
        }
    }

    /// Carries `pose` to another drawing. `flow` leads to it; `moved` is the last motion of the nodes.
    pub fn carry(&self, pose: &[Point], flow: Option<&Flow>, moved: Option<&[Point]>, scenery: &Scenery) -> Pose {
        let add = |shift: &dyn Fn(usize) -> Point| (0..pose.len()).map(|n| pose[n] + shift(n)).collect();
        let mut starts: Vec<Vec<Point>> = vec![pose.to_vec()];
        if let Some((shifts, median)) = flow.and_then(|flow| self.flow_below(pose, flow)) {
            starts.push(add(&|n| shifts[n]));
            starts.push(add(&|_| median));
        }
        if let Some(moved) = moved {
            starts.push(add(&|n| moved[n]));
        }
        self.best_of(scenery, starts)
    }

    /// The flow below a pose: its mean at each node, and its median over the part. None if three samples or fewer are
    /// inside the contour.
    fn flow_below(&self, pose: &[Point], flow: &Flow) -> Option<(Vec<Point>, Point)> {
        let pixel = crate::shared::features::LEVELS[FLOW_LEVEL] as f64;
        let inside: Vec<_> = self.texture.texels[1].iter().filter(|texel| texel.weight == 1.0).collect();
        if inside.len() <= 3 {
            return None;
        }
        let mut sums = vec![(Point::ZERO, 0.0); pose.len()];
        let mut all = Vec::with_capacity(inside.len());
        for texel in inside {
            let at = texel.binding.at(pose) / pixel;
            let [u, v] = flow.clamped(at.x.floor() as isize, at.y.floor() as isize);
            let shift = Point::new(f64::from(u), f64::from(v)) * pixel;
            all.push(shift);
            for (n, w) in texel.binding.nodes.into_iter().zip(texel.binding.weights) {
                sums[n].0 += shift * w;
                sums[n].1 += w;
            }
        }
        let known: Vec<usize> = (0..sums.len()).filter(|&n| sums[n].1 >= LEAST_FLOW_WEIGHT).collect();
        let rest = &self.texture.mesh.rest;
        let nearest = |n: usize| {
            known
                .iter()
                .copied()
                .min_by(|&a, &b| rest[a].distance_squared(rest[n]).total_cmp(&rest[b].distance_squared(rest[n])))
        };
        let shift_of = |n: usize| sums[n].0 / sums[n].1;
        let shifts = (0..sums.len()).map(|n| nearest(n).map_or(Point::ZERO, shift_of)).collect();
        Some((shifts, median(&all)))
    }
}

impl Scenery<'_> {
    /// The drawing as the aligner needs it.
    pub fn target(&self) -> Target<'_> {
        Target { picture: self.features, cover: self.cover, anchors: self.anchors }
    }
}

/// The starts without those that are too near to an earlier one.
fn distinct(starts: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let mut kept: Vec<Vec<Point>> = Vec::with_capacity(starts.len());
    for start in starts {
        if kept.iter().all(|k| mean_distance(k, &start) >= SAME_START) {
            kept.push(start);
        }
    }
    kept
}

/// Mean distance of the points of two poses of the same model.
pub(super) fn mean_distance(a: &[Point], b: &[Point]) -> f64 {
    a.iter().zip(b).map(|(p, q)| p.distance(*q)).sum::<f64>() / a.len().max(1) as f64
}

/// Median along each axis.
fn median(shifts: &[Point]) -> Point {
    let along = |axis: usize| {
        let mut values: Vec<f64> = shifts.iter().map(|s| s[axis]).collect();
        values.sort_by(f64::total_cmp);
        0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
    };
    Point::new(along(0), along(1))
}

/// Carries a pose through `count` drawings in order, with `step(pose, moved, position)`. Returns the pose on each
/// drawing. `moved` is the last motion of the nodes.
///
/// # Errors
///
/// The first error of `step`.
pub fn chain(
    start: Vec<Point>,
    count: usize,
    mut step: impl FnMut(&[Point], Option<&[Point]>, usize) -> Result<Pose, TrackError>,
) -> Result<Vec<Pose>, TrackError> {
    let mut poses: Vec<Pose> = Vec::with_capacity(count);
    let mut moved: Option<Vec<Point>> = None;
    for position in 0..count {
        let before = poses.last().map_or(&start, |pose| &pose.nodes);
        let pose = step(before, moved.as_deref(), position)?;
        moved = Some(pose.nodes.iter().zip(before).map(|(a, b)| *a - *b).collect());
        poses.push(pose);
    }
    Ok(poses)
}
