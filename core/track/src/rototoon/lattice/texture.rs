//! A part's colours at a key, sampled over its lattice, and how well a pose of the lattice explains a picture.

use super::mesh::{Binding, Mesh};
use super::shape;
use crate::shared::features::{Features, LEVELS, Padded, Sample, WORKING_LINES, difference};
use glam::Vec2;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::lanes::Lanes;
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;

/// Weight of samples in the band around the contour. They hold the ink line's outer side; being background in part,
/// they count for less than the inside.
const BAND_WEIGHT: f32 = 0.6;
/// Samples of a level at the most.
const MOST_SAMPLES: usize = 700;
/// Samples of the finer levels that a region is divided into.
const FINE_SAMPLES: f64 = 1200.0;
/// Squared colour difference (three channels of 0 to 1) beyond which a sample is simply wrong.
pub const WORST: f32 = 0.15;
/// Cost of a sample that cannot be seen, as a squared colour difference: more than a right colour, less than a wrong one.
pub const UNSEEN: f32 = 0.03;
/// Cost of a sample outside the part where the ground is another than at the key, as a squared colour difference: less
/// than the part's own colour there, more than the same ground.
const OTHER_GROUND: f32 = 0.015;
/// Squared colour difference at which a colour is no longer much like another.
const ALIKE: f32 = 0.02;
/// Squared colour difference of a part from its ground, at the key, above which they are told apart.
pub const CONTRAST: f32 = 0.02;
/// Weight of the shape energy beside the mean colour difference, and the shape energy beyond which it stops to count.
const SHAPE: (f64, f64) = (0.02, 2.0);
/// Level (index in [`LEVELS`]) whose samples measure a pose.
const MEASURED_LEVEL: usize = 1;

/// Where nearer parts hide the picture, by working pixels of 2 × 2, and where it ends: what lies beyond its edges is
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

    /// Nothing is hidden.
    pub fn none(width: f64) -> Self {
        Self::new(&[], width)
    }

    /// Whether nothing of the part can be seen at `p`: a nearer part hides it there, or the picture has ended.
    #[inline(always)]
    pub fn hides(&self, p: Point) -> bool {
        !in_picture(p, self.width) || self.under(p)
    }

    /// Whether a nearer part hides the picture at `p`; outside the picture, what its nearest edge says.
    #[inline(always)]
    pub fn under(&self, p: Point) -> bool {
        if !self.any {
            return false;
        }
        let pixel = |at: f64, count: usize| (at * (1.0 / Self::PIXEL)).clamp(0.0, (count - 1) as f64) as i32 as usize;
        self.hidden.get(pixel(p.x, self.hidden.width()), pixel(p.y, self.hidden.height()))
    }
}

/// Whether a place in working pixels lies in a picture of `width` working pixels.
#[inline(always)]
pub fn in_picture(p: Point, width: f64) -> bool {
    p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < WORKING_LINES
}

/// One sample of the key.
#[derive(Clone, Debug)]
pub struct Texel {
    /// Where it lies in the lattice.
    pub binding: Binding,
    /// Colour and gradients of the key.
    pub key: Sample,
    /// 1 inside the contour, less in the band.
    pub weight: f32,
    /// Direction across the contour at the key, of length 1, for a sample outside a closed part: along the contour the
    /// ground changes by itself, and says nothing of where the part is.
    pub across: Option<[f32; 2]>,
    /// The part's colour across the contour, for a sample outside that measures a pose and differs from it.
    pub own: Option<Padded>,
    /// The cell it lies in.
    pub cell: usize,
    /// The weights of the cell's nodes.
    pub weights: [f32; 4],
    /// The weights of the nodes that an alignment moves it by, twice.
    pub(crate) moved_by: Lanes,
    /// Their products in pairs, in the order of [`PAIRS`].
    pub products: [f32; PAIRS.len()],
}

/// The pairs of a cell's nodes, and two that stay empty: their number fills the processor's vectors.
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
    /// Samples by level, from coarse to fine; those of a cell, and of a cell of the level's unknowns, are together.
    pub texels: [Vec<Texel>; 3],
    /// Width of the picture in working pixels: what lies outside is unseen.
    width: f64,
}

impl Texture {
    /// Samples the key's picture over the lattice, but where a nearer part hides it or the picture ends.
    pub fn new(mesh: Mesh, key: &Features, cover: &Cover, width: f64) -> Self {
        let texels = std::array::from_fn(|level| sample_level(&mesh, key, cover, width, level));
        Self { mesh, texels, width }
    }

    /// Forgets what tells the part from its ground: every wrong colour is just wrong, and pulls whichever way.
    pub fn forget_figure(&mut self) {
        self.texels.iter_mut().flatten().for_each(|texel| (texel.own, texel.across) = (None, None));
    }

    /// How badly a pose explains a picture: mean colour difference (at most [`WORST`]; [`UNSEEN`] outside the picture)
    /// plus a little for bending.
    pub fn energy(&self, picture: &Features, nodes: &[Point]) -> f64 {
        self.energy_where(picture, nodes, |p| in_picture(p, self.width))
    }

    /// The same; what is not `seen` costs [`UNSEEN`].
    pub fn energy_where(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        self.energy_of::<1>(picture, nodes, seen)
    }

    /// The same by every other sample of a cell: enough to see which of some poses are worth more.
    pub fn rough_energy_where(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        self.energy_of::<2>(picture, nodes, seen)
    }

    fn energy_of<const STEP: usize>(&self, picture: &Features, nodes: &[Point], seen: impl Fn(Point) -> bool) -> f64 {
        let (sum, weights) = vectorised(
            #[inline(always)]
            || self.look::<STEP>(picture, nodes, seen),
        );
        let look = if weights > 0.0 { sum / weights } else { f64::from(WORST) };
        look + self.bending(nodes)
    }

    /// Weighted colour differences of each `STEP`-th sample of those that measure a pose, cell by cell, and their weights.
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

    /// The part of [`Texture::energy`] that a pose's shape costs.
    pub fn bending(&self, nodes: &[Point]) -> f64 {
        SHAPE.0 * shape::energy(&self.mesh, nodes).min(SHAPE.1)
    }

    /// The samples that measure a pose.
    pub fn measured(&self) -> &[Texel] {
        &self.texels[MEASURED_LEVEL]
    }

    /// Colour difference of each of the [`Texture::measured`] samples, at most [`WORST`]; [`UNSEEN`] outside the picture.
    pub fn differences(&self, picture: &Features, nodes: &[Point]) -> Vec<f32> {
        self.differences_where(picture, nodes, |p| in_picture(p, self.width))
    }

    /// The same; what is not `seen` is [`UNSEEN`].
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

    /// Where a pose puts the corners of a cell.
    #[inline(always)]
    pub fn corners(&self, cell: usize, nodes: &[Point]) -> Corners {
        let [a, b, c, d] = self.mesh.cells[cell];
        Corners([nodes[a].as_vec2(), nodes[b].as_vec2(), nodes[c].as_vec2(), nodes[d].as_vec2()])
    }
}

/// Where a pose puts the corners of a cell: what is done once for all its samples.
pub struct Corners([Vec2; 4]);

impl Texel {
    /// Where it is when its cell's corners are there.
    #[inline(always)]
    pub fn place(&self, Corners([a, b, c, d]): &Corners) -> Point {
        let [wa, wb, wc, wd] = self.weights;
        ((*a * wa + *b * wb) + (*c * wc + *d * wd)).as_dvec2()
    }

    /// What it costs where the picture has the colour `seen`: the squared difference, at most [`WORST`].
    ///
    /// Outside the part the ground may have changed since the key, as it does when a limb swings from before the hair to
    /// before the sky: any other colour costs no more than [`OTHER_GROUND`], but the part's own colour costs as much as it
    /// is like it. A contour that has slid inwards along its part shows just that.
    #[inline(always)]
    fn cost(&self, seen: Padded) -> f32 {
        let wrong = difference(seen, self.key.colour).min(WORST);
        let Some(own) = self.own.filter(|_| wrong > OTHER_GROUND) else { return wrong };
        wrong.min(OTHER_GROUND.max(WORST * (-difference(seen, own) / ALIKE).exp()))
    }
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

/// The colour inside the part across the contour from `p`, where it differs from the sample there.
fn own_colour(mesh: &Mesh, key: &Features, p: Point, sample: &Sample) -> Option<Padded> {
    let own = key.level(MEASURED_LEVEL).colour(mesh.across(p)?);
    Some(own).filter(|own| difference(*own, sample.colour) > CONTRAST)
}

/// Every k-th sample, so that at most [`MOST_SAMPLES`] are left.
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
    fn another_ground_costs_little_but_the_part_s_own_colour_much() {
        let [same, other, own] =
            [[0.9, 0.9, 0.9], [0.1, 0.3, 0.9], [0.8, 0.2, 0.1]].map(|[r, g, b]| Padded::new(r, g, b, 0.0));
        let outside = texel(Some(own));
        assert_eq!(outside.cost(same), 0.0);
        assert_eq!(outside.cost(other), OTHER_GROUND);
        assert_eq!(outside.cost(own), WORST);
        // Inside, and where the part was like its ground, a wrong colour is just wrong.
        assert_eq!(texel(None).cost(other), WORST);
        // A ground that has changed a little costs what it has changed by.
        assert!((outside.cost(Padded::new(0.9, 0.9, 0.8, 0.0)) - 0.01).abs() < 1e-6);
    }

    #[test]
    fn across_a_contour_lies_as_far_inside_as_outside() {
        let square = [(10.0, 10.0), (50.0, 10.0), (50.0, 50.0), (10.0, 50.0)].map(|(x, y)| Point::new(x, y));
        let mesh = Mesh::new(&square, true);
        assert!(mesh.across(Point::new(30.0, 6.0)).unwrap().distance(Point::new(30.0, 14.0)) < 1e-9);
        assert_eq!(Mesh::new(&square, false).across(Point::new(30.0, 6.0)), None, "a line has no inside");
        assert_eq!(mesh.across(Point::new(30.0, -35.0)), None, "it comes out on the other side");
    }
}
