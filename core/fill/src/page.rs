//! A drawing that is to be painted: its regions, its lines, and what is known about its colours.

use crate::evidence::Evidence;
use crate::layout::{Layout, boxes};
use crate::meet::Table;
use crate::outside::{Gap, leak};
use crate::regions::Regions;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};
use rototoon_lines::{Drawing, Options, Stroke, ink};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

/// Least confidence with which paper is known.
const SURE: f64 = 0.5;
/// Least share of itself that paper keeps where a click is parted from it.
const KEPT: f64 = 0.75;
/// Confidence in the colour of a region that leaks to the edge of the picture through a wide gap.
const LEAKING: f64 = 0.3;

/// A drawing with its regions.
pub struct Page {
    picture: Arc<Raster<Colour>>,
    options: Options,
    lines: OnceLock<Lines>,
    pub(crate) regions: Regions,
    pub(crate) layout: Layout,
}

/// The lines of a page, which are registered with those of others.
pub(crate) struct Lines {
    pub drawing: Drawing,
    pub strokes: Vec<Stroke>,
}

/// A place in a region, in pixels, and the number of its colour in a palette: a click with the paint bucket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Click {
    /// The place.
    pub at: Point,
    /// The colour's number. `None` says that the region stays without paint.
    pub colour: Option<usize>,
}

/// The colours of a page's regions.
///
/// *No paint* is a colour too, the one behind the palette: paper that shows between the limbs of a figure is followed like any other region.
#[derive(Clone, Debug)]
pub struct Paint {
    /// For each region the probability of each colour of the palette, and of no paint. The sum is 1, or 0 where nothing is known.
    pub(crate) colours: Table,
    /// The number of colours in the palette, and so the number of the colour *no paint*.
    pub(crate) blank: usize,
    /// For each region its number on all drawings.
    pub(crate) tracks: Vec<Option<usize>>,
    /// For each region the probability that its most probable colour is right.
    pub(crate) confidence: Vec<f64>,
    /// For each region from what its confidence was found; `None` where nothing was carried.
    pub(crate) evidence: Vec<Option<Evidence>>,
    /// Share of the regions in which an artist clicked.
    pub(crate) clicked: f64,
    /// For each region the probability that a click on a drawing that was carried gave its colour.
    pub(crate) corrected: Vec<f32>,
}

impl Page {
    /// Finds the regions and the lines of a picture.
    pub fn new(picture: Arc<Raster<Colour>>, options: &Options) -> Self {
        let ink = ink::measure(&picture, options);
        let regions = Regions::new(&ink.mask);
        let lines = Lines::new(Drawing::of(picture.clone(), ink, options));
        Self { lines: lines.into(), ..Self::known(picture, options, regions) }
    }

    /// A picture whose regions are known: those that [`Self::new`] finds with these options. Its lines are looked for when they are needed.
    pub fn known(picture: Arc<Raster<Colour>>, options: &Options, regions: Regions) -> Self {
        let layout = Layout::new(&regions);
        Self { picture, options: options.clone(), lines: OnceLock::new(), regions, layout }
    }

    /// Its regions.
    pub fn own(&self) -> &Regions {
        &self.regions
    }

    /// Its lines. They are not to be asked for by several tasks of one pool while nobody has them.
    pub(crate) fn lines(&self) -> &Lines {
        self.lines.get_or_init(|| Lines::new(Drawing::new(self.picture.clone(), &self.options)))
    }

    /// The region at a place in pixels, from 1: the one that it lies in, or to whose line it is near.
    pub fn at(&self, place: Point) -> Option<usize> {
        self.regions.at(place)
    }

    /// The number of regions.
    pub fn regions(&self) -> usize {
        self.regions.count
    }

    /// Paints the page by clicks. A region with clicks of several colours is [split](Regions::split) between them. Regions get
    /// numbers from `next` on, in the order of the clicks, and `next` is raised. The second value lists the clicks that lie
    /// on ink or outside of the picture and so paint nothing.
    pub fn painted(&mut self, clicks: &[Click], palette: usize, next: &mut usize) -> (Paint, Vec<usize>) {
        self.split(clicks);
        let paint = Paint::nothing(self.regions.count, palette);
        let (mut paint, missed) = self.clicked(paint, clicks, next);
        paint.settle();
        (paint, missed)
    }

    /// Clicks into a page whose regions have colours already. What was not clicked stays. The page must have been
    /// [split](Self::split) by the clicks before it was painted. A region whose colour changes gets a new number.
    pub fn clicked(&self, mut paint: Paint, clicks: &[Click], next: &mut usize) -> (Paint, Vec<usize>) {
        let blank = paint.blank;
        let mut missed = Vec::new();
        let mut own = BTreeSet::new();
        for (k, click) in clicks.iter().enumerate() {
            let Some(region) = self.regions.at(click.at).filter(|_| click.colour.is_none_or(|own| own < blank)) else {
                missed.push(k);
                continue;
            };
            match click.colour {
                None => paint.tracks[region] = None,
                Some(_) if paint.tracks[region].is_some() && paint.colour(region) == click.colour => {}
                Some(_) => {
                    paint.tracks[region] = Some(*next);
                    *next += 1;
                }
            }
            paint.give(region, click.colour.unwrap_or(blank));
            paint.corrected[region] = 1.0;
            own.insert(region);
        }
        paint.clicked = own.len() as f64 / self.regions.count.max(1) as f64;
        (paint, missed)
    }

    /// Leaves the regions at the edge of the picture without paint that have no colour: on a drawing that is painted otherwise, they are the
    /// paper around it, and stay so on other drawings.
    pub fn leave_paper(&self, paint: &mut Paint) {
        for region in self.outer() {
            if paint.colour(region).is_none() {
                paint.give(region, paint.blank);
            }
        }
    }

    /// Parts what is clicked from paper into which it leaks. `paint` is what is known of the page. Where it surely leaves a region at the edge of the picture
    /// without paint, a click with a colour means what a gap joins to that paper. So the region is [split](Regions::split) between the click and
    /// its deepest place, if a quarter of it at most is parted off: in open paper the click means the paper. True if anything was split. The paint does not fit
    /// the page then.
    pub fn part_from_paper(&mut self, paint: &Paint, clicks: &[Click]) -> bool {
        let outer = self.outer();
        let sure = |region: usize| paint.colour(region) == Some(paint.blank) && paint.confidence(region) >= SURE;
        let mut within: BTreeMap<usize, Vec<Point>> = BTreeMap::new();
        for click in clicks.iter().filter(|click| click.colour.is_some()) {
            if let Some(region) = self.regions.at(click.at).filter(|region| outer.contains(region) && sure(*region)) {
                within.entry(region).or_default().push(click.at);
            }
        }
        let mut split = false;
        for (region, places) in within {
            let mut parted = self.regions.clone();
            let Some(deepest) = parted.deepest(region) else { continue };
            parted.split(region, &[vec![deepest], places].concat());
            let area = |regions: &Regions| regions.inside.data().iter().filter(|own| **own as usize == region).count();
            if parted.count > self.regions.count && area(&parted) as f64 >= KEPT * area(&self.regions) as f64 {
                (self.regions, split) = (parted, true);
            }
        }
        if split {
            self.layout = Layout::new(&self.regions);
        }
        split
    }

    /// The clicks with a colour that leak to the edge of the picture, by their places, with their gaps. Regions are [split](Regions::split) at
    /// gaps that [can be closed](Gap::closes). So paper that nobody clicked is not flooded.
    pub fn part_from_outside(&mut self, clicks: &[Click]) -> Vec<(usize, Gap)> {
        let outer = self.outer();
        let mut within: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (k, click) in clicks.iter().enumerate() {
            if let Some(region) = self.regions.at(click.at).filter(|region| outer.contains(region)) {
                within.entry(region).or_default().push(k);
            }
        }
        let mut found = Vec::new();
        let mut split = false;
        // Where a click without a colour lies, the region has no paint, and no click floods it.
        for (region, own) in within.into_iter().filter(|(_, own)| own.iter().all(|&k| clicks[k].colour.is_some())) {
            let places: Vec<Point> = own.iter().map(|&k| clicks[k].at).collect();
            let Some(gap) = leak(&self.layout, region, &places) else { continue };
            if gap.closes {
                self.regions.split(region, &[vec![gap.beyond], places].concat());
                split = true;
            }
            found.extend(own.into_iter().map(|k| (k, gap)));
        }
        if split {
            self.layout = Layout::new(&self.regions);
        }
        found
    }

    /// Puts the region of a click that leaks in doubt: it is probably not what the artist meant.
    pub fn doubt(&self, paint: &mut Paint, click: &Click) {
        if let Some(region) = self.regions.at(click.at) {
            paint.confidence[region] = LEAKING;
        }
    }

    /// Width and height in pixels of the region at a place.
    pub fn extent(&self, place: Point) -> Option<[usize; 2]> {
        let region = self.regions.at(place)?;
        let [left, top, right, bottom] = boxes(&self.regions.inside, self.regions.count)[region];
        Some([right.saturating_sub(left), bottom.saturating_sub(top)])
    }

    /// The regions at the edge of the picture.
    fn outer(&self) -> BTreeSet<usize> {
        let inside = &self.regions.inside;
        let (width, height) = (inside.width(), inside.height());
        let rows = [0, height.saturating_sub(1)].into_iter().flat_map(|y| (0..width).map(move |x| (x, y)));
        let columns = [0, width.saturating_sub(1)].into_iter().flat_map(|x| (0..height).map(move |y| (x, y)));
        rows.chain(columns).map(|(x, y)| inside.get(x, y) as usize).filter(|&region| region > 0).collect()
    }

    /// The clicks that lie in a region which a later click has given another colour: no line was found between the two.
    pub fn overruled(&self, paint: &Paint, clicks: &[Click]) -> Vec<usize> {
        let other = |click: &Click| {
            let colour = click.colour.unwrap_or(paint.blank);
            self.regions.at(click.at).is_some_and(|region| paint.colour(region).is_some_and(|own| own != colour))
        };
        (0..clicks.len()).filter(|&k| other(&clicks[k])).collect()
    }

    /// Splits regions between places.
    pub(crate) fn close(&mut self, leaks: &[(usize, Vec<Point>)]) {
        leaks.iter().for_each(|(region, places)| self.regions.split(*region, places));
        if !leaks.is_empty() {
            self.layout = Layout::new(&self.regions);
        }
    }

    /// Splits regions in which clicks have different colours, so that each click has a region of its own.
    pub fn split(&mut self, clicks: &[Click]) {
        let mut within: BTreeMap<usize, Vec<Click>> = BTreeMap::new();
        for click in clicks {
            if let Some(region) = self.regions.at(click.at) {
                within.entry(region).or_default().push(*click);
            }
        }
        let mixed = |own: &&Vec<Click>| own.iter().any(|click| click.colour != own[0].colour);
        let mut split = false;
        for (region, own) in within.iter().filter(|(_, own)| mixed(own)) {
            self.regions.split(*region, &own.iter().map(|click| click.at).collect::<Vec<_>>());
            split = true;
        }
        if split {
            self.layout = Layout::new(&self.regions);
        }
    }
}

impl Lines {
    fn new(drawing: Drawing) -> Self {
        Self { strokes: drawing.strokes(), drawing }
    }
}

impl Paint {
    /// Nothing is painted.
    pub(crate) fn nothing(regions: usize, palette: usize) -> Self {
        Self {
            colours: vec![vec![0.0; palette + 1]; regions + 1],
            blank: palette,
            tracks: vec![None; regions + 1],
            confidence: vec![0.0; regions + 1],
            evidence: vec![None; regions + 1],
            clicked: 0.0,
            corrected: vec![0.0; regions + 1],
        }
    }

    /// Gives a region a colour that the artist has said.
    fn give(&mut self, region: usize, colour: usize) {
        self.colours[region].fill(0.0);
        self.colours[region][colour] = 1.0;
        self.confidence[region] = 1.0;
        self.evidence[region] = None;
    }

    /// Lowers the confidence in each region's colour to a bound.
    pub(crate) fn bound(&mut self, most: impl IntoIterator<Item = f64>) {
        self.confidence.iter_mut().zip(most).for_each(|(own, most)| *own = own.min(most));
    }

    /// From here on the clicks are no corrections of what was carried: the drawing is one from which others are painted.
    pub fn settle(&mut self) {
        self.corrected.fill(0.0);
    }

    /// The share of the regions in which an artist clicked, 0 to 1.
    pub fn clicked(&self) -> f64 {
        self.clicked
    }

    /// The probability that the colour of a region is right, 0 to 1.
    pub fn confidence(&self, region: usize) -> f64 {
        self.confidence[region]
    }

    /// From what the confidence of a region was found. `None` where an artist clicked, and where nothing is painted.
    pub fn evidence(&self, region: usize) -> Option<&Evidence> {
        self.evidence[region].as_ref()
    }

    /// The most probable colour of a region, if it is paint.
    pub fn painted(&self, region: usize) -> Option<usize> {
        self.colour(region).filter(|&colour| colour < self.blank)
    }

    /// The most probable colour of a region, which may be that of no paint.
    pub(crate) fn colour(&self, region: usize) -> Option<usize> {
        let row = &self.colours[region];
        // Of equal ones the first is taken.
        let best = (0..row.len()).rev().max_by(|&a, &b| row[a].total_cmp(&row[b]))?;
        (row[best] > 0.0).then_some(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with a wall that has a gap.
    fn page() -> Page {
        let line = |x: usize, y: usize| {
            let edge = x.abs_diff(60).max(y.abs_diff(40)) == 30;
            edge || (x == 60 && (12..68).contains(&y) && !(38..42).contains(&y))
        };
        let ink = |x: usize, y: usize| (0..2).any(|u| (0..2).any(|v| x >= u && y >= v && line(x - u, y - v)));
        let picture = Raster::from_fn(121, 81, |x, y| if ink(x, y) { [0.05; 3] } else { [1.0; 3] });
        Page::new(Arc::new(picture), &Options::default())
    }

    #[test]
    fn clicks_of_two_colours_split_a_region_that_leaks() {
        let click = |x: f64, colour: usize| Click { at: Point::new(x, 30.0), colour: Some(colour) };
        let mut page = page();
        let whole = page.regions();
        let mut next = 5;
        let (paint, missed) = page.painted(&[click(40.0, 1), click(80.0, 0), click(10.0, 0)], 2, &mut next);
        assert_eq!((page.regions(), missed.len(), next), (whole + 1, 0, 8));
        let at = |x: f64, y: f64| page.regions.at(Point::new(x, y)).and_then(|region| paint.colour(region));
        assert_eq!((at(50.0, 60.0), at(75.0, 60.0), at(5.0, 5.0)), (Some(1), Some(0), Some(0)));
    }

    #[test]
    fn clicks_outside_of_the_picture_are_told() {
        let mut page = page();
        let (_, missed) = page.painted(&[Click { at: Point::new(500.0, 3.0), colour: Some(0) }], 1, &mut 0);
        assert_eq!(missed, [0]);
    }

    #[test]
    fn a_click_is_parted_from_the_paper_into_which_it_leaks() {
        // A cuff with an open corner, on paper.
        let ink = |x: usize, y: usize| {
            let edge = x.abs_diff(60).max(y.abs_diff(40)) == 14;
            edge && !(x > 70 && (36..40).contains(&y))
        };
        let thick = |x: usize, y: usize| (0..2).any(|u| (0..2).any(|v| x >= u && y >= v && ink(x - u, y - v)));
        let picture = Arc::new(Raster::from_fn(160, 120, |x, y| if thick(x, y) { [0.05; 3] } else { [1.0; 3] }));
        let mut page = Page::new(picture, &Options::default());
        let mut known = Paint::nothing(page.regions(), 1);
        page.leave_paper(&mut known);
        let (cuff, paper) = (Point::new(60.0, 40.0), Point::new(20.0, 100.0));
        let clicked = |at: Point| [Click { at, colour: Some(0) }];
        assert_eq!(page.regions.at(cuff), page.regions.at(paper), "it leaks");
        let whole = page.regions();
        assert!(!page.part_from_paper(&known, &clicked(paper)), "open paper stays whole");
        known.confidence.fill(0.3);
        assert!(!page.part_from_paper(&known, &clicked(cuff)), "that it is paper is not sure");
        known.confidence.fill(0.9);
        assert!(page.part_from_paper(&known, &clicked(cuff)));
        assert_eq!(page.regions(), whole + 1);
        assert_ne!(page.regions.at(cuff), page.regions.at(paper));
    }

    #[test]
    fn paper_around_a_painted_drawing_has_no_paint() {
        let click = |x: f64, colour| Click { at: Point::new(x, 30.0), colour };
        let mut page = page();
        let mut next = 0;
        let (mut paint, _) = page.painted(&[click(40.0, Some(1)), click(80.0, None)], 2, &mut next);
        let at = |x: f64| page.regions.at(Point::new(x, 30.0)).unwrap();
        assert_eq!((paint.colour(at(5.0)), next), (None, 1));
        page.leave_paper(&mut paint);
        assert_eq!([5.0, 40.0, 80.0].map(|x| paint.colour(at(x))), [Some(2), Some(1), Some(2)]);
        assert_eq!([5.0, 40.0, 80.0].map(|x| paint.painted(at(x))), [None, Some(1), None]);
        assert_eq!([5.0, 40.0, 80.0].map(|x| paint.tracks[at(x)].is_some()), [false, true, false]);
    }

    #[test]
    fn of_equal_colours_the_first_is_taken() {
        let mut paint = Paint::nothing(1, 3);
        assert_eq!(paint.colour(1), None);
        paint.colours[1] = vec![0.2, 0.4, 0.4, 0.0];
        assert_eq!(paint.colour(1), Some(1));
    }
}
