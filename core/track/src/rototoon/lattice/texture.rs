//! A part's colours at a key, sampled over its lattice, and the energy of a pose: how badly it explains a picture.
//!
//! The energy is the weighted mean over the samples of the squared colour difference, limited to [`WORST`], plus a
//! little for bending. A sample outside the part shows background, which may change between the frames; its cost has
//! special rules (see [`UNSEEN`] and the cost of a texel).
//!
//! **Slivers.** An artist draws a part on where a nearer one hides it. What is left of its look at such a key is a few
//! samples, which fit nearly everywhere, so a mean over them alone would beat every right pose of a key that shows the
//! part. So where the other key shows more, the mean has the weight t, the share of the part's inside that is seen at the key, relative to
//! [`ENOUGH`], at most 1. What is missing costs [`WORST`]. A key of which nothing is seen says where the part is on its frame, and nothing about its look.

use super::mesh::{Binding, Mesh};
use super::shape;
use crate::shared::features::{Features, LEVELS, Padded, Sample, WORKING_LINES, difference};
use glam::Vec2;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::lanes::Lanes;
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;

/// Weight of samples in the band around the contour. They contain the outer side of the ink line. They are partly
/// background, so they count less than the inside.
const BAND_WEIGHT: f32 = 0.6;
/// Largest number of samples of a level.
const MOST_SAMPLES: usize = 700;
/// Divisor of the area that gives the sample spacing on the coarsest level.
const FINE_SAMPLES: f64 = 1200.0;
/// Squared colour difference (three channels of 0 to 1) from which on all colours are equally wrong.
pub const WORST: f32 = 0.15;
/// Cost of a sample that is not visible, as a squared colour difference. It is more than a right colour and less than a
/// wrong one.
pub const UNSEEN: f32 = 0.03;
/// Cost of a sample outside the part where the background differs from that at the key, as a squared colour difference.
/// It is more than the same background and less than the part's own colour.
const OTHER_GROUND: f32 = 0.015;
/// Squared colour difference at which the similarity of two colours has fallen to 1/e.
const ALIKE: f32 = 0.02;
/// Squared colour difference between a part and its background at the key, above which the two are distinguished.
pub const CONTRAST: f32 = 0.02;
/// Weight of the shape energy relative to the mean colour difference, and the upper limit of the shape energy.
const SHAPE: (f64, f64) = (0.02, 2.0);
/// Share of a part that must be seen at its key for the key to tell its look, and the same relative to the key that shows most of it: of
/// a ring behind a disc no key shows more than its rim.
const ENOUGH: f64 = 0.1;
const ENOUGH_OF_FULLEST: f64 = 0.2;
/// Places across the larger side of a part at which is looked how much of it is seen.
const LOOKS: f64 = 48.0;
/// Level (index in [`LEVELS`]) whose samples measure the energy of a pose.
const MEASURED_LEVEL: usize = 1;

/// Where the picture is hidden by nearer parts, in pixels of 2 × 2 working pixels. Places outside the picture count as
/// hidden too.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    hidden: Raster<bool>,
    any: bool,
    width: f64,
}

impl Cover {
    const PIXEL: f64 = 2.0;

    /// The cover by closed contours (working pixels) over a picture of `width` working pixels.
    pub fn new(contours: &[Vec<Point>], width: f64) -> Self {
        let pixels = |length: f64| (length / Self::PIXEL).ceil().max(1.0) as usize;
        let mut hidden = Raster::new(pixels(width), pixels(WORKING_LINES), false);
        for contour in contours {
            let scaled: Vec<Point> = contour.iter().map(|&p| p / Self::PIXEL).collect();
            let (width, height) = (hidden.width(), hidden.height());
            rototoon_base::geometry::polygon::for_each_span(&scaled, width, height, |y, x0, x1| {
                hidden.row_mut(y)[x0..x1].fill(true);
            });
        }
        Self { hidden, any: !contours.is_empty(), width }
    }

    /// Width of the picture in working pixels.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// A cover that hides nothing.
    pub fn none(width: f64) -> Self {
        Self::new(&[], width)
    }

    /// Whether the part is not visible at `p`, in working pixels: a nearer part hides it there, or `p` is outside the
    /// picture.
    #[inline(always)]
    pub fn hides(&self, p: Point) -> bool {
        !in_picture(p, self.width) || self.under(p)
    }

    /// Whether a nearer part hides the picture at `p`. For a place outside the picture, the nearest place on its edge
    /// decides.
    #[inline(always)]
    pub fn under(&self, p: Point) -> bool {
        if !self.any {
            return false;
        }
        let pixel = |at: f64, count: usize| (at * (1.0 / Self::PIXEL)).clamp(0.0, (count - 1) as f64) as i32 as usize;
        self.hidden.get(pixel(p.x, self.hidden.width()), pixel(p.y, self.hidden.height()))
    }
}

/// Whether a place in working pixels is in a picture of `width` working pixels.
#[inline(always)]
pub fn in_picture(p: Point, width: f64) -> bool {
    p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < WORKING_LINES
}

/// One sample of the key.
#[derive(Clone, Debug)]
pub struct Texel {
    /// Its place in the lattice.
    pub binding: Binding,
    /// Colour and slopes at the key.
    pub key: Sample,
    /// 1 inside the contour, less in the band.
    pub weight: f32,
    /// Unit vector across the contour at the key, for a sample outside a closed part. Along the contour the background
    /// changes by itself, and that says nothing about the place of the part.
    pub across: Option<[f32; 2]>,
    /// The part's colour at the mirror place inside the contour, for a sample outside that measures a pose. None if the
    /// two colours are alike.
    pub own: Option<Padded>,
    /// Index of its cell.
    pub cell: usize,
    /// The weights of the cell's nodes.
    pub weights: [f32; 4],
    /// Weights of the nodes of the unknowns' cell, stored twice.
    pub(crate) moved_by: Lanes,
    /// Products of these weights in pairs, in the order of [`PAIRS`].
    pub products: [f32; PAIRS.len()],
}

/// The pairs of a cell's nodes, and two empty entries: their number fills the processor's vectors.
pub const PAIRS: [Option<(usize, usize)>; 12] = [
    Some((0, 0)),
    Some((1, 0)),
    Some((1, 1)),
    Some((2, 0)),
    Some((2, 1)),
    Some((2, 2)),
    Some((3, 0)),
    Some((3, 1)),
    Some((3, 2)),
    Some((3, 3)),
    None,
    None,
];

/// A lattice with the key's colours at each level of the pyramid.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The lattice.
    pub mesh: Mesh,
    /// Samples by level, from coarse to fine. The samples of a cell are together, and so are those of a cell of the
    /// level's unknowns.
    pub texels: [Vec<Texel>; 3],
    /// Width of the picture in working pixels. Places outside the picture are not visible.
    width: f64,
    /// Share of the part that is seen at the key.
    shown: f64,
    /// Weight of the look in the energy.
    trust: f64,
}

impl Texture {
    /// Samples the key's picture over the lattice, except where a nearer part hides it or the picture ends.
    pub fn new(mesh: Mesh, key: &Features, cover: &Cover, width: f64) -> Self {
        let texels = std::array::from_fn(|level| sample_level(&mesh, key, cover, width, level));
        let shown = shown(&mesh, cover, width);
        Self { mesh, texels, width, shown, trust: 1.0 }
    }

    /// Forgets the difference between part and background, for measurements without it: samples outside have the same
    /// cost function and pull as samples inside.
    pub fn forget_figure(&mut self) {
        self.texels.iter_mut().flatten().for_each(|texel| (texel.own, texel.across) = (None, None));
    }

    /// How badly a pose explains a picture: mean colour difference (at most [`WORST`] per sample, [`UNSEEN`] outside
    /// the picture) plus a little for bending. `nodes` are in working pixels.
    pub fn energy(&self, picture: &Features, nodes: &[Point]) -> f64 {
        self.energy_where(picture, nodes, |p| in_picture(p, self.width))
    }

    /// The same as [`Texture::energy`], with [`UNSEEN`] for every place that is not `seen`.
    pub fn energy_where(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        self.energy_of::<1>(picture, nodes, seen)
    }

    /// The same as [`Texture::energy_where`], by every other sample of a cell. It is precise enough to compare poses.
    pub fn rough_energy_where(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        self.energy_of::<2>(picture, nodes, seen)
    }

    fn energy_of<const STEP: usize>(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        let (sum, weights) = vectorised(
            #[inline(always)]
            || self.look::<STEP>(picture, nodes, seen),
        );
        let look = if weights > 0.0 { sum / weights } else { f64::from(WORST) };
        self.trust * look + (1.0 - self.trust) * f64::from(WORST) + self.bending(nodes)
    }

    /// Makes the looks of a part at several keys count by how much of it each of them shows.
    pub fn weigh(looks: &mut [&mut Self]) {
        let fullest = looks.iter().map(|look| look.shown).fold(0.0, f64::max);
        let enough = ENOUGH.min(ENOUGH_OF_FULLEST * fullest);
        for look in looks.iter_mut().filter(|look| look.shown < enough) {
            look.trust = look.shown / enough;
        }
    }

    /// Weight of the look in the energy: 1, or less if the key shows next to nothing of the part and another one more.
    pub fn trust(&self) -> f64 {
        self.trust
    }

    /// Sum of the weighted costs of every `STEP`-th measuring sample of each cell, and the sum of their weights.
    #[inline(always)]
    fn look<const STEP: usize>(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> (f64, f64) {
        let level = picture.level(MEASURED_LEVEL);
        let (mut sum, mut weights) = (0.0, 0.0);
        for cell in self.measured().chunk_by(|a, b| a.cell == b.cell) {
            let corners = self.corners(cell[0].cell, nodes);
            for texel in cell.iter().step_by(STEP) {
                let place = texel.place(&corners);
                let wrong = texel.cost(level.colour(place));
                sum += f64::from(texel.weight * if seen(place) { wrong } else { UNSEEN });
                weights += f64::from(texel.weight);
            }
        }
        (sum, weights)
    }

    /// The bending part of [`Texture::energy`].
    pub fn bending(&self, nodes: &[Point]) -> f64 {
        SHAPE.0 * shape::energy(&self.mesh, nodes).min(SHAPE.1)
    }

    /// The samples that measure a pose.
    pub fn measured(&self) -> &[Texel] {
        &self.texels[MEASURED_LEVEL]
    }

    /// Cost of each of the [`Texture::measured`] samples, at most [`WORST`], and [`UNSEEN`] outside the picture.
    pub fn differences(&self, picture: &Features, nodes: &[Point]) -> Vec<f32> {
        self.differences_where(picture, nodes, |p| in_picture(p, self.width))
    }

    /// The same as [`Texture::differences`], with [`UNSEEN`] for every place that is not `seen`.
    pub fn differences_where(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> Vec<f32> {
        let level = picture.level(MEASURED_LEVEL);
        let mut differences = Vec::with_capacity(self.measured().len());
        vectorised(
            #[inline(always)]
            || {
                for cell in self.measured().chunk_by(|a, b| a.cell == b.cell) {
                    let corners = self.corners(cell[0].cell, nodes);
                    for texel in cell {
                        let place = texel.place(&corners);
                        differences.push(if seen(place) { texel.cost(level.colour(place)) } else { UNSEEN });
                    }
                }
            },
        );
        differences
    }

    /// Places of the corners of a cell in a pose.
    #[inline(always)]
    pub fn corners(&self, cell: usize, nodes: &[Point]) -> Corners {
        let [a, b, c, d] = self.mesh.cells[cell];
        Corners([nodes[a].as_vec2(), nodes[b].as_vec2(), nodes[c].as_vec2(), nodes[d].as_vec2()])
    }
}

/// Places of the corners of a cell in a pose. They are read once for all samples of the cell.
pub struct Corners([Vec2; 4]);

impl Texel {
    /// Place of the sample if the corners of its cell are the ones given.
    #[inline(always)]
    pub fn place(&self, Corners([a, b, c, d]): &Corners) -> Point {
        let [wa, wb, wc, wd] = self.weights;
        ((*a * wa + *b * wb) + (*c * wc + *d * wd)).as_dvec2()
    }

    /// Cost of the sample where the picture has the colour `seen`: the squared difference, at most [`WORST`].
    ///
    /// Outside the part the background may have changed since the key, as when a limb swings from in front of the hair
    /// to in front of the sky. So any other colour costs at most [`OTHER_GROUND`]. But the part's own colour costs
    /// more, the more similar it is, up to [`WORST`]: it appears there if the contour has slipped inwards along its
    /// part.
    #[inline(always)]
    fn cost(&self, seen: Padded) -> f32 {
        let wrong = difference(seen, self.key.colour).min(WORST);
        let Some(own) = self.own.filter(|_| wrong > OTHER_GROUND) else { return wrong };
        wrong.min(OTHER_GROUND.max(WORST * (-difference(seen, own) / ALIKE).exp()))
    }
}

/// Share of a part that is seen at its key: in the picture, and not under a nearer part.
fn shown(mesh: &Mesh, cover: &Cover, width: f64) -> f64 {
    let (low, high) = mesh.bounds();
    let step = ((high - low).max_element() / LOOKS).max(1.0);
    let count = |length: f64| (length / step).ceil() as usize;
    // By whether a place is inside of a closed contour: all places, and those that are seen. A line has no inside.
    let mut counts = [[0usize; 2]; 2];
    for j in 0..count(high.y - low.y) {
        for i in 0..count(high.x - low.x) {
            let p = low + Point::new(i as f64 + 0.5, j as f64 + 0.5) * step;
            let (belongs, inside) = mesh.region(p);
            if belongs {
                let [all, seen] = &mut counts[usize::from(inside)];
                *all += 1;
                *seen += usize::from(in_picture(p, width) && !cover.hides(p));
            }
        }
    }
    let [band, inside] = counts;
    let [all, seen] = if inside[0] > 0 { inside } else { band };
    if all == 0 { 1.0 } else { seen as f64 / all as f64 }
}

fn sample_level(mesh: &Mesh, key: &Features, cover: &Cover, width: f64, level: usize) -> Vec<Texel> {
    let (pixel, unknowns) = (LEVELS[level] as f64, mesh.unknowns(level));
    let wanted = if level == 0 { (mesh.area() / FINE_SAMPLES).sqrt().max(pixel) } else { 0.75 * pixel };
    let step = wanted.min(mesh.side / 2.5).max(1.5).max((mesh.area() / 20_000.0).sqrt());
    let (low, high) = mesh.bounds();
    let mut texels = Vec::new();
    let count = |length: f64| (length / step).ceil() as usize;
    for j in 0..count(high.y - low.y) {
        for i in 0..count(high.x - low.x) {
            let p = low + Point::new(i as f64 + 0.5, j as f64 + 0.5) * step;
            let seen = in_picture(p, width) && !cover.hides(p);
            let (belongs, inside) = if seen { mesh.region(p) } else { (false, false) };
            if belongs {
                let (cell, binding) = mesh.bind_in_cell(p);
                let weight = if inside { 1.0 } else { BAND_WEIGHT };
                let weights = binding.weights.map(|w| w as f32);
                let moved_by = unknowns.weights(cell, &binding.nodes, &binding.weights).map(|w| w as f32);
                let products = PAIRS.map(|pair| pair.map_or(0.0, |(a, b)| moved_by[a] * moved_by[b]));
                let sample = key.level(level).sample(p);
                let own = if inside || level != MEASURED_LEVEL { None } else { own_colour(mesh, key, p, &sample) };
                let across = if inside { None } else { mesh.outward(p).map(|n| [n.x as f32, n.y as f32]) };
                let moved_by = Lanes::from_fn(|v| moved_by[v % 4]);
                texels.push(Texel { binding, key: sample, weight, cell, weights, moved_by, products, across, own });
            }
        }
    }
    let mut texels = thin(texels);
    texels.sort_by_key(|texel| (unknowns.cell_of[texel.cell], texel.cell));
    texels
}

/// The colour at the mirror place of `p` inside the part. None if it is like the sample's own colour.
fn own_colour(mesh: &Mesh, key: &Features, p: Point, sample: &Sample) -> Option<Padded> {
    let own = key.level(MEASURED_LEVEL).colour(mesh.across(p)?);
    Some(own).filter(|own| difference(*own, sample.colour) > CONTRAST)
}

/// At most [`MOST_SAMPLES`] of the samples, evenly spread over the list.
fn thin(texels: Vec<Texel>) -> Vec<Texel> {
    let count = texels.len();
    if count <= MOST_SAMPLES {
        return texels;
    }
    (0..MOST_SAMPLES).map(|k| texels[k * (count - 1) / (MOST_SAMPLES - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texel(own: Option<Padded>) -> Texel {
        let mesh = Mesh::new(&[(0.0, 0.0), (40.0, 0.0), (40.0, 40.0)].map(|(x, y)| Point::new(x, y)), true);
        let key = Sample { colour: Padded::new(0.9, 0.9, 0.9, 0.0), ..Sample::default() };
        let (weights, moved_by, products) = ([0.25; 4], Lanes::splat(0.25), [0.0625; PAIRS.len()]);
        let binding = mesh.bind(Point::new(30.0, 10.0));
        Texel { binding, key, weight: BAND_WEIGHT, across: None, own, cell: 0, weights, moved_by, products }
    }

    #[test]
    fn another_background_costs_little_and_the_parts_own_colour_much() {
        let [same, other, own] =
            [[0.9, 0.9, 0.9], [0.1, 0.3, 0.9], [0.8, 0.2, 0.1]].map(|[r, g, b]| Padded::new(r, g, b, 0.0));
        let outside = texel(Some(own));
        assert_eq!(outside.cost(same), 0.0);
        assert_eq!(outside.cost(other), OTHER_GROUND);
        assert_eq!(outside.cost(own), WORST);
        // Inside, and where part and background are alike, every wrong colour costs the same.
        assert_eq!(texel(None).cost(other), WORST);
        // A background that has changed a little costs the amount of its change.
        assert!((outside.cost(Padded::new(0.9, 0.9, 0.8, 0.0)) - 0.01).abs() < 1e-6);
    }

    #[test]
    fn the_mirror_place_is_as_far_inside_as_outside() {
        let square = [(10.0, 10.0), (50.0, 10.0), (50.0, 50.0), (10.0, 50.0)].map(|(x, y)| Point::new(x, y));
        let mesh = Mesh::new(&square, true);
        assert!(mesh.across(Point::new(30.0, 6.0)).unwrap().distance(Point::new(30.0, 14.0)) < 1e-9);
        assert_eq!(Mesh::new(&square, false).across(Point::new(30.0, 6.0)), None, "a line has no inside");
        assert_eq!(mesh.across(Point::new(30.0, -35.0)), None, "the mirror place is beyond the other side");
    }

    #[test]
    fn a_key_that_shows_a_sliver_says_little_unless_no_key_shows_more() {
        let square = |x: f64, y: f64, side: f64| {
            [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| Point::new(x + dx, y + dy)).to_vec()
        };
        let inside = |at: usize| (100..180).contains(&at);
        let picture =
            Features::new(&Raster::from_fn(
                400,
                540,
                |x, y| {
                    if inside(x) && inside(y) { [0.8, 0.3, 0.2] } else { [0.9; 3] }
                },
            ));
        let look = |hidden: &[Vec<Point>]| {
            let mesh = Mesh::new(&square(100.0, 100.0, 80.0), true);
            Texture::new(mesh, &picture, &Cover::new(hidden, 400.0), 400.0)
        };
        let nearer = [square(104.0, 90.0, 100.0)];
        let (mut sliver, mut whole) = (look(&nearer), look(&[]));
        let along: Vec<Point> = sliver.mesh.rest.iter().map(|p| *p + Point::new(0.0, 20.0)).collect();
        let aside: Vec<Point> = whole.mesh.rest.iter().map(|p| *p + Point::new(6.0, 0.0)).collect();
        let (wrong, rough) =
            (|look: &Texture| look.energy(&picture, &along), |look: &Texture| look.energy(&picture, &aside));
        assert!(wrong(&sliver) < 2.0 * rough(&whole), "on its own it fits along the edge");
        Texture::weigh(&mut [&mut sliver, &mut whole]);
        assert!(sliver.trust() < 0.7 && whole.trust() == 1.0);
        assert!(wrong(&sliver) > 2.0 * rough(&whole));
        let (mut one, mut other) = (look(&nearer), look(&nearer));
        Texture::weigh(&mut [&mut one, &mut other]);
        assert_eq!([one.trust(), other.trust()], [1.0; 2], "no key shows more");
    }
}
