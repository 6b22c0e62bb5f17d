//! Motion from nowhere: a part's look searched over the whole picture, in all positions and many directions.
//!
//! The key's colours, turned all round in steps of 15°, are compared with every place of a coarse level by the
//! masked squared difference Σ m (I − t)² / Σ m, expanded into correlations (I² with m, I with m t) that the fast Fourier
//! transform gives for all places at once. The best places start alignments. This finds what a chain from neighbour to
//! neighbour has lost: jumps larger than a limb's width, and parts that come back from behind others.
//!
//! Limits: one scale, no bending while searching: long thin parts that bend are found by their larger half at best (the
//! alignment then starts from the shape of either key or halfway between them, whichever fits best).

use super::features::{Features, LEVELS, Level, WORKING_LINES};
use super::lattice::texture::Cover;
use super::propagate::Model;
use crate::geometry::{Point, polygon};
use crate::image::correlation::{Correlator, Spectrum};
use crate::scene::Raster;

/// Step of the turns tried, in degrees.
const TURN_STEP: usize = 15;
/// Pixels by which the picture is continued beyond its edges, so that parts that are half outside are found.
const MARGIN: usize = 12;
/// Places taken of each turn, and of all turns together.
const PLACES_OF_A_TURN: usize = 2;
const PLACES: usize = 6;
/// Parts of this size (working pixels) and smaller are searched on the middle level.
const SMALL: f64 = 70.0;
/// Parts larger than this share of the lines fill the picture: nothing to search.
const LARGEST: f64 = 0.45;
/// Two places are one if they are nearer than this share of the part's size, and turned by less than this (radians).
const SAME_PLACE: f64 = 0.25;
const SAME_TURN: f64 = 0.4;
/// Weight of the mask in the band around the contour.
const BAND_WEIGHT: f32 = 0.6;

/// The turned templates of a model, ready to be searched for.
pub struct Templates {
    level: usize,
    correlator: Correlator,
    size: f64,
    turned: Vec<Template>,
}

struct Template {
    angle: f64,
    /// Offset from the part's centre to the template's corner, in pixels of the level.
    corner: Point,
    width: usize,
    height: usize,
    /// Spectra of the mask and of −2 × mask × colour.
    spectra: Vec<Spectrum>,
    /// Σ mask × colour² and Σ mask.
    own: f32,
    weight: f32,
}

/// A place where a template fits.
#[derive(Clone, Copy, Debug)]
struct Place {
    difference: f32,
    center: Point,
    angle: f64,
}

impl Templates {
    /// Templates from the key's picture; `None` for parts that are too large to be searched, or hidden at the key.
    pub fn new(model: &Model, key: &Features, cover: &Cover, contour: &[Point], width: f64) -> Option<Self> {
        let size = model.texture.mesh.size;
        if size > LARGEST * WORKING_LINES {
            return None;
        }
        let level = usize::from(size <= SMALL);
        let source = key.level(level);
        let cut = Cut { model, source, cover, center: polygon::center(contour), width };
        let angles = (0..360).step_by(TURN_STEP).map(|degrees| f64::from(degrees).to_radians());
        let cuts: Vec<_> = angles.filter_map(|angle| cut.turned(angle, contour)).collect();
        let widest = cuts.iter().map(|(_, _, colours)| colours.width()).max()?;
        let highest = cuts.iter().map(|(_, _, colours)| colours.height()).max()?;
        let (columns, rows) = source.dimensions();
        let correlator = Correlator::new(columns + 2 * MARGIN + widest, rows + 2 * MARGIN + highest);
        let turned = cuts.into_iter().map(|(angle, corner, colours)| template(&correlator, angle, corner, &colours));
        Some(Self { level, turned: turned.collect(), correlator, size })
    }

    /// Poses of the model's lattice at the places of a picture where its templates fit best.
    pub fn find(&self, picture: &Features, model: &Model, contour: &[Point]) -> Vec<Vec<Point>> {
        let (spectra, columns, rows) = self.spectra(picture.level(self.level));
        let mut places = Vec::new();
        for pair in self.turned.chunks(2) {
            let second = pair.get(1).unwrap_or(&pair[0]);
            let results = self.correlator.correlate(&spectra, [&pair[0].spectra, &second.spectra]);
            for (template, result) in pair.iter().zip(results) {
                self.minima(template, result, columns, rows, &mut places);
            }
        }
        places.sort_by(|a, b| a.difference.total_cmp(&b.difference));
        let center = polygon::center(contour);
        let pose = |place: &Place| posed(model, picture, center, place);
        self.distinct(&places).iter().map(pose).collect()
    }

    /// Spectra of Σ colour² and of each colour of a picture with its margin, and its size.
    fn spectra(&self, level: &Level) -> (Vec<Spectrum>, usize, usize) {
        let (columns, rows) = level.dimensions();
        let (columns, rows) = (columns + 2 * MARGIN, rows + 2 * MARGIN);
        let pixel = level.pixel();
        let colours = Raster::from_fn(columns, rows, |x, y| {
            level.colour(Point::new(x as f64 + 0.5 - MARGIN as f64, y as f64 + 0.5 - MARGIN as f64) * pixel)
        });
        let mut spectra = vec![self.correlator.transform(&colours.map(|c| c.iter().map(|v| v * v).sum()))];
        spectra.extend((0..3).map(|k| self.correlator.transform(&colours.map(|c| c[k]))));
        (spectra, columns, rows)
    }

    /// Adds the best places of one template, suppressing what is near one taken already.
    fn minima(&self, t: &Template, mut map: Raster<f32>, columns: usize, rows: usize, places: &mut Vec<Place>) {
        if columns < t.width || rows < t.height {
            return;
        }
        let (across, down) = (columns - t.width + 1, rows - t.height + 1);
        let reach = ((t.width.min(t.height) as f64 * 0.3) as usize).max(2);
        let pixel = LEVELS[self.level] as f64;
        for _ in 0..PLACES_OF_A_TURN {
            let mut best = (f32::INFINITY, 0, 0);
            for y in 0..down {
                for (x, &value) in map.row(y)[..across].iter().enumerate() {
                    if value < best.0 {
                        best = (value, x, y);
                    }
                }
            }
            let (value, x, y) = best;
            if value == f32::INFINITY {
                return;
            }
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

/// The lattice of a model at a place: in the shape of either key or halfway between them, whichever fits best.
fn posed(model: &Model, picture: &Features, center: Point, place: &Place) -> Vec<Point> {
    let turn = Point::from_angle(place.angle);
    let placed = |share: f64| -> Vec<Point> {
        let shape = model.texture.mesh.rest.iter().zip(&model.bent).map(|(a, b)| a.lerp(*b, share));
        shape.map(|q| turn.rotate(q - center) + place.center).collect()
    };
    let energy = |nodes: &Vec<Point>| model.texture.energy(picture, nodes);
    let shapes = [0.0, 0.5, 1.0].map(placed);
    shapes.into_iter().min_by(|a, b| energy(a).total_cmp(&energy(b))).unwrap_or_default()
}

/// What templates are cut from.
struct Cut<'a> {
    model: &'a Model,
    source: &'a Level,
    cover: &'a Cover,
    center: Point,
    width: f64,
}

/// Colour and mask weight.
type Masked = [f32; 4];

impl Cut<'_> {
    /// The part turned by `angle`: its corner relative to the centre in pixels of the level, and its pixels.
    fn turned(&self, angle: f64, contour: &[Point]) -> Option<(f64, Point, Raster<Masked>)> {
        let (pixel, turn) = (self.source.pixel(), Point::from_angle(angle));
        let around: Vec<Point> = contour.iter().map(|&p| turn.rotate(p - self.center)).collect();
        let (low, high) = polygon::bounds(&around)?;
        let band = Point::splat(self.model.texture.mesh.band);
        let corner = ((low - band) / pixel).floor() - Point::ONE;
        let extent = ((high + band) / pixel).ceil() + Point::ONE - corner;
        let back = Point::from_angle(-angle);
        let pixels = Raster::from_fn(extent.x as usize, extent.y as usize, |x, y| {
            let place = (corner + Point::new(x as f64 + 0.5, y as f64 + 0.5)) * pixel;
            self.masked(back.rotate(place) + self.center)
        });
        let weight: f32 = pixels.data().iter().map(|p| p[3]).sum();
        (weight >= 3.0).then_some((angle, corner, pixels))
    }

    fn masked(&self, p: Point) -> Masked {
        let seen = p.x >= 0.0 && p.y >= 0.0 && p.x < self.width && p.y < WORKING_LINES && !self.cover.hides(p);
        let (belongs, inside) = if seen { self.model.texture.mesh.region(p) } else { (false, false) };
        let [r, g, b] = self.source.colour(p);
        [
            r,
            g,
            b,
            if inside {
                1.0
            } else if belongs {
                BAND_WEIGHT
            } else {
                0.0
            },
        ]
    }
}

fn template(correlator: &Correlator, angle: f64, corner: Point, pixels: &Raster<Masked>) -> Template {
    let mut spectra = vec![correlator.transform(&pixels.map(|p| p[3]))];
    spectra.extend((0..3).map(|k| correlator.transform(&pixels.map(|p| -2.0 * p[3] * p[k]))));
    let own = pixels.data().iter().map(|p| p[3] * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2])).sum();
    let weight = pixels.data().iter().map(|p| p[3]).sum();
    Template { angle, corner, width: pixels.width(), height: pixels.height(), spectra, own, weight }
}
