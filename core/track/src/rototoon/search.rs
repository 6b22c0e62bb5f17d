//! Search for a part's appearance in the complete picture, at all places and in many directions.
//!
//! The key's colours, rotated in steps of 15°, are compared with every place of a coarse level. The measure is the
//! masked squared difference Σ m (I − t)² / Σ m, with the mask m, the picture I and the template t. It expands into
//! correlations (I² with m, and I with m t), which the fast Fourier transform computes for all places at once. The best
//! places are starts of alignments. The search finds what a chain from neighbour to neighbour has lost: jumps larger
//! than a limb's width, and parts that come back from behind others.
//!
//! Limits: one scale, and no bending during the search. A long thin part that bends is at best found by its larger
//! half. The alignment then starts from the shape of either key or halfway between them, whichever fits best.

use super::lattice::texture::Cover;
use super::propagate::Model;
use crate::shared::features::{Features, LEVELS, Level, WORKING_LINES};
use crate::shared::sought::{MARGIN, Sought, searched_size};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;
use rototoon_image::correlation::{Correlator, Spectrum};

/// Step of the rotations, in degrees.
const TURN_STEP: usize = 15;
/// Places taken of each turn, and of all turns together.
const PLACES_OF_A_TURN: usize = 2;
const PLACES: usize = 8;
/// Parts of at most this size (working pixels) are searched on the middle level.
const SMALL: f64 = 50.0;
/// Parts larger than this share of the lines are not searched, because they fill the picture.
const LARGEST: f64 = 0.45;
/// Two places count as one if their distance is at most this share of the part's size and their rotations differ by at
/// most the second value, in radians.
const SAME_PLACE: f64 = 0.25;
const SAME_TURN: f64 = 0.4;
/// Weight of the mask in the band around the contour.
const BAND_WEIGHT: f32 = 0.6;

/// The rotated templates of a model, prepared for the search.
pub struct Templates {
    level: usize,
    correlator: Correlator,
    size: f64,
    turned: Vec<Pair>,
}

/// Two rotations that are transformed together, with the spectra of their masks and of −2 × mask × colour.
struct Pair {
    templates: Vec<Template>,
    spectra: Vec<Spectrum>,
}

struct Template {
    angle: f64,
    /// Offset from the part's centre to the template's corner, in pixels of the level.
    corner: Point,
    width: usize,
    height: usize,
    /// Σ mask × colour² and Σ mask.
    own: f32,
    weight: f32,
}

/// A place where a template fits. `center` is in working pixels, `angle` in radians.
#[derive(Clone, Copy, Debug)]
struct Place {
    difference: f32,
    center: Point,
    angle: f64,
}

impl Templates {
    /// Templates from the key's picture; `contour` and `width` are in working pixels. `None` for parts that are too
    /// large for the search or hidden at the key.
    pub fn new(model: &Model, key: &Features, cover: &Cover, contour: &[Point], width: f64) -> Option<Self> {
        let size = model.texture.mesh.size;
        if size > LARGEST * WORKING_LINES {
            return None;
        }
        let level = usize::from(size <= SMALL);
        let source = key.level(level);
        let (columns, rows) = searched_size(source);
        let cut = Cut::new(model, source, cover, polygon::center(contour), width);
        let angles = (0..360).step_by(TURN_STEP).map(|degrees| f64::from(degrees).to_radians());
        let fits = |pixels: &Raster<Masked>| pixels.width() <= columns && pixels.height() <= rows;
        let cuts: Vec<_> =
            angles.filter_map(|angle| cut.turned(angle, contour)).filter(|(_, _, pixels)| fits(pixels)).collect();
        let correlator = Correlator::new(columns, rows);
        let turned: Vec<Pair> = cuts.chunks(2).map(|cuts| pair(&correlator, cuts)).collect();
        (!turned.is_empty()).then_some(Self { level, turned, correlator, size })
    }

    /// The level (index in [`LEVELS`]) of the search.
    pub fn level(&self) -> usize {
        self.level
    }

    /// Poses of the model's lattice, in working pixels, at the places of a picture where its templates fit best.
    pub fn find(&self, picture: &Features, sought: &Sought, model: &Model, contour: &[Point]) -> Vec<Vec<Point>> {
        let mut places = Vec::new();
        for pair in &self.turned {
            let results = self.correlator.correlate(&sought.spectra, &pair.spectra);
            for (template, result) in pair.templates.iter().zip(results) {
                self.minima(template, result, sought, &mut places);
            }
        }
        places.sort_by(|a, b| a.difference.total_cmp(&b.difference));
        let center = polygon::center(contour);
        let pose = |place: &Place| posed(model, picture, center, place);
        self.distinct(&places).iter().map(pose).collect()
    }

    /// Adds the best places of one template. Places near one that was already taken are skipped.
    fn minima(&self, t: &Template, mut map: Raster<f32>, sought: &Sought, places: &mut Vec<Place>) {
        let (across, down) = (sought.columns - t.width + 1, sought.rows - t.height + 1);
        let reach = ((t.width.min(t.height) as f64 * 0.3) as usize).max(2);
        let pixel = LEVELS[self.level] as f64;
        for _ in 0..PLACES_OF_A_TURN {
            let Some((value, x, y)) = least(&map, across, down) else { return };
            let center = (Point::new(x as f64, y as f64) - Point::splat(MARGIN as f64) - t.corner) * pixel;
            places.push(Place { difference: (value + t.own) / t.weight, center, angle: t.angle });
            for row in y.saturating_sub(reach)..(y + reach + 1).min(down) {
                map.row_mut(row)[x.saturating_sub(reach)..(x + reach + 1).min(across)].fill(f32::INFINITY);
            }
        }
    }

    fn distinct(&self, sorted: &[Place]) -> Vec<Place> {
        let mut kept: Vec<Place> = Vec::new();
        for place in sorted {
            let same = |k: &Place| {
                k.center.distance(place.center) <= SAME_PLACE * self.size && (k.angle - place.angle).abs() <= SAME_TURN
            };
            if kept.len() < PLACES && !kept.iter().any(same) {
                kept.push(*place);
            }
        }
        kept
    }
}

/// The least value of a map's first columns and rows, the first of them in reading order; none where all are infinite.
fn least(map: &Raster<f32>, across: usize, down: usize) -> Option<(f32, usize, usize)> {
    let mut best: Option<(f32, usize, usize)> = None;
    for y in 0..down {
        let row = &map.row(y)[..across];
        let low = vectorised(
            #[inline(always)]
            || lowest(row),
        );
        if low < best.map_or(f32::INFINITY, |(value, ..)| value) {
            best = row.iter().position(|&v| v == low).map(|x| (low, x, y));
        }
    }
    best
}

/// The least of some values, in eight interleaved runs.
#[inline(always)]
fn lowest(values: &[f32]) -> f32 {
    let less = |a: f32, b: f32| if b < a { b } else { a };
    let (groups, rest) = values.as_chunks::<8>();
    let runs = groups.iter().fold([f32::INFINITY; 8], |runs, group| std::array::from_fn(|k| less(runs[k], group[k])));
    runs.into_iter().chain(rest.iter().copied()).fold(f32::INFINITY, less)
}

/// The nodes of a model at a place: in the shape of either key or halfway between them, whichever fits best.
fn posed(model: &Model, picture: &Features, center: Point, place: &Place) -> Vec<Point> {
    let turn = Point::from_angle(place.angle);
    let placed = |share: f64| -> Vec<Point> {
        let shape = model.texture.mesh.rest.iter().zip(&model.bent).map(|(a, b)| a.lerp(*b, share));
        shape.map(|q| turn.rotate(q - center) + place.center).collect()
    };
    let measured = |nodes: Vec<Point>| (model.texture.energy(picture, &nodes), nodes);
    let shapes = [0.0, 0.5, 1.0].map(placed).map(measured);
    shapes.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, nodes)| nodes).unwrap_or_default()
}

/// The source of templates.
struct Cut<'a> {
    model: &'a Model,
    source: &'a Level,
    center: Point,
    /// Mask weights at the key, from `corner` on in squares with the side `step`.
    mask: Raster<f32>,
    corner: Point,
    step: f64,
}

/// Colour (0 to 2) and mask weight (3).
type Masked = [f32; 4];

impl<'a> Cut<'a> {
    fn new(model: &'a Model, source: &'a Level, cover: &Cover, center: Point, width: f64) -> Self {
        let mesh = &model.texture.mesh;
        let (corner, end) = mesh.bounds();
        let step = 0.5 * source.pixel();
        let count = |length: f64| (length / step).ceil().max(1.0) as usize;
        let weight = |x: usize, y: usize| {
            let p = corner + Point::new(x as f64 + 0.5, y as f64 + 0.5) * step;
            let seen = p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < WORKING_LINES && !cover.hides(p);
            match if seen { mesh.region(p) } else { (false, false) } {
                (_, true) => 1.0,
                (true, false) => BAND_WEIGHT,
                (false, false) => 0.0,
            }
        };
        let mask = Raster::from_fn(count(end.x - corner.x), count(end.y - corner.y), weight);
        Self { model, source, center, mask, corner, step }
    }

    /// The part rotated by `angle`: the angle, its corner relative to the centre in pixels of the level, and its
    /// pixels. None if almost nothing of it is visible.
    fn turned(&self, angle: f64, contour: &[Point]) -> Option<(f64, Point, Raster<Masked>)> {
        let (pixel, turn) = (self.source.pixel(), Point::from_angle(angle));
        let around: Vec<Point> = contour.iter().map(|&p| turn.rotate(p - self.center)).collect();
        let (low, high) = polygon::bounds(&around)?;
        let band = Point::splat(self.model.texture.mesh.band);
        let corner = ((low - band) / pixel).floor() - Point::ONE;
        let extent = ((high + band) / pixel).ceil() + Point::ONE - corner;
        let back = Point::from_angle(-angle);
        let at = |x: usize, y: usize| {
            let place = (corner + Point::new(x as f64 + 0.5, y as f64 + 0.5)) * pixel;
            self.masked(back.rotate(place) + self.center)
        };
        let pixels = vectorised(
            #[inline(always)]
            || Raster::from_fn(extent.x as usize, extent.y as usize, at),
        );
        let weight: f32 = pixels.data().iter().map(|p| p[3]).sum();
        (weight >= 3.0).then_some((angle, corner, pixels))
    }

    #[inline(always)]
    fn masked(&self, p: Point) -> Masked {
        let at = (p - self.corner) / self.step;
        let within = at.x >= 0.0 && at.y >= 0.0;
        let (x, y) = (at.x as usize, at.y as usize);
        if !within || x >= self.mask.width() || y >= self.mask.height() || self.mask.get(x, y) == 0.0 {
            return [0.0; 4];
        }
        let [r, g, b, _] = self.source.colour(p).to_array();
        [r, g, b, self.mask.get(x, y)]
    }
}

/// One or two rotations, transformed together.
fn pair(correlator: &Correlator, cuts: &[(f64, Point, Raster<Masked>)]) -> Pair {
    let both = |value: &dyn Fn(Masked) -> f32| {
        let planes: Vec<Raster<f32>> = cuts.iter().map(|(_, _, pixels)| pixels.map(value)).collect();
        let none = Raster::new(0, 0, 0.0);
        correlator.patterns([planes.first().unwrap_or(&none), planes.get(1).unwrap_or(&none)])
    };
    let mut spectra = vec![both(&|p| p[3])];
    spectra.extend((0..3).map(|k| both(&move |p| -2.0 * p[3] * p[k])));
    Pair { templates: cuts.iter().map(template).collect(), spectra }
}

fn template((angle, corner, pixels): &(f64, Point, Raster<Masked>)) -> Template {
    let own = pixels.data().iter().map(|p| p[3] * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2])).sum();
    let weight = pixels.data().iter().map(|p| p[3]).sum();
    Template { angle: *angle, corner: *corner, width: pixels.width(), height: pixels.height(), own, weight }
}
