//! Painted regions and strokes of a drawing: as a picture with alpha, below the drawing, and as ids for keyers.
//!
//! Regions of a drawing lie side by side, and their outlines meet in the middle of the line between them. Drawn one over the
//! other with opacities, they would leave seams there: two halves of a pixel cover three quarters of it. Two strokes at one
//! place would be denser than one. So shares of a pixel are areas. From the front to the back, each region shows where it is,
//! times its opacity, times what the regions before it leave there. That is exact: where the borders of several regions meet
//! in a pixel, it is cut into the cells between them ([`super::cells`]).
//!
//! The area of a region is the union of its polygons minus that of its holes ([`super::coverage`]). A stroke is a region too
//! ([`super::stroke`]). Colours are mixed in linear light.
//!
//! The drawing lies over its paint as with the mode *multiply* of other programs (W3C, Compositing and Blending Level 1,
//! equation for `multiply` with alpha): ink darkens the paint below it, white paper leaves it, and where nothing is painted the
//! drawing is as it is. Limits: grey paper darkens the paint too.

use super::cells::{self, Borders};
use super::coverage::{Shape, Window};
use super::cryptomatte;
use super::encode::{self, EncodeError, Format};
use super::streamed::{self, Line, Part};
use super::visible::{LEAST, Share, Visible};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::colour;

/// Rows of a window that are shared out at once.
const ROWS: usize = 64;

/// A painted region, or a stroke, on one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name in Cryptomatte layers. A region has the same name on all frames.
    pub name: String,
    /// Closed polygons in pixels of the picture. The region is their union.
    pub areas: Vec<Vec<Point>>,
    /// Closed outlines of its holes.
    pub holes: Vec<Vec<Point>>,
    /// Its colour, sRGB-encoded, 0 to 1.
    pub colour: Colour,
    /// Its opacity, 0 to 1: the share of its area that it covers.
    pub opacity: f32,
}

impl Region {
    /// The region with each of its points moved.
    #[must_use]
    pub fn moved(mut self, to: impl Fn(Point) -> Point) -> Self {
        self.areas.iter_mut().chain(&mut self.holes).flatten().for_each(|point| *point = to(*point));
        self
    }
}

/// The share of each region in each pixel of a picture. Regions go from the back to the front; a share's `part` is an index of them.
pub fn shares(regions: &[Region], width: usize, height: usize) -> Visible {
    Visible::in_bands(width, height, |band| shown_in(regions, band, &mut || true).unwrap_or_default())
}

/// The paint of a window alone: linear light multiplied by alpha, and alpha. The value of a pixel does not depend on the window. Calls
/// `go_on` for each row, and each row of a region, and returns `None` if it returns false.
pub fn paint_in(regions: &[Region], window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<[f32; 4]>> {
    let colours = lights(regions);
    let mut picture = Raster::new(window.width(), window.height(), [0.0; 4]);
    for top in (window.top..window.bottom).step_by(ROWS) {
        // Shares take much more memory than pixels.
        let band = Window { top, bottom: window.bottom.min(top + ROWS as i64), ..window };
        let first = (top - window.top) as usize * window.width();
        for (pixel, shown) in picture.data_mut()[first..].iter_mut().zip(shown_in(regions, band, go_on)?) {
            shown.iter().for_each(|share| add(pixel, colours[share.part], share.coverage));
        }
    }
    Some(picture)
}

/// A rectangle of whole pixels that contains all regions; `None` if there are none.
pub fn bounds(regions: &[Region]) -> Option<Window> {
    regions.iter().flat_map(|region| &region.areas).filter_map(|area| Window::around(area)).reduce(Window::united)
}

/// What each region shows in each pixel of a band, from the front to the back. `None` if `go_on` returns false.
fn shown_in(regions: &[Region], band: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<Vec<Share>>> {
    let mut own = vec![Vec::new(); band.width() * band.height()];
    let mut left = vec![1.0f32; own.len()];
    for (part, region) in regions.iter().enumerate().rev() {
        if !go_on() {
            return None;
        }
        let Some((window, polygons)) = near(region, band) else { continue };
        let area = area(polygons, &region.holes, window, go_on)?;
        for (row, y) in (window.top..window.bottom).enumerate() {
            let first = (y - band.top) as usize * band.width() + (window.left - band.left) as usize;
            for (x, &coverage) in area.row(row).iter().enumerate() {
                if coverage < LEAST || left[first + x] < LEAST {
                    continue;
                }
                own[first + x].push(Share { part, coverage });
                if coverage == 1.0 {
                    left[first + x] *= 1.0 - region.opacity;
                }
            }
        }
    }
    let mut pixels = Pixels { regions, band, borders: vec![None; regions.len()] };
    let mut shown = Vec::with_capacity(own.len());
    for (at, own) in own.into_iter().enumerate() {
        if at % band.width() == 0 && !go_on() {
            return None;
        }
        shown.push(pixels.shown(at, own));
    }
    Some(shown)
}

/// Pixels of a band, of which each is shared out by itself.
struct Pixels<'a> {
    regions: &'a [Region],
    band: Window,
    /// The borders of each region that were needed so far.
    borders: Vec<Option<Borders>>,
}

impl Pixels<'_> {
    /// What each region shows in a pixel. `own` are the areas of the regions there, the nearest first, as if each were alone.
    fn shown(&mut self, at: usize, own: Vec<Share>) -> Vec<Share> {
        if own.iter().filter(|share| share.coverage < 1.0).count() > 1 {
            return self.divided(at, &own);
        }
        // The others cover the pixel, so what they leave is the same all over it.
        let mut left = 1.0;
        let alone = |share: Share| {
            let own = f64::from(self.regions[share.part].opacity * share.coverage) * left;
            left -= own;
            (share.part, own)
        };
        let each: Vec<(usize, f64)> = own.into_iter().map(alone).collect();
        rounded(each.into_iter())
    }

    /// The same where the borders of several regions meet.
    fn divided(&mut self, at: usize, own: &[Share]) -> Vec<Share> {
        let (regions, band) = (self.regions, self.band);
        let partly = |share: &&Share| share.coverage < 1.0;
        for &Share { part, .. } in own.iter().filter(partly) {
            let made = || Borders::new(&regions[part].areas, &regions[part].holes, band);
            self.borders[part].get_or_insert_with(made);
        }
        let layer = |share: &Share| {
            let borders = self.borders[share.part].as_ref().filter(|_| share.coverage < 1.0);
            (borders.map_or(cells::Layer::Whole, cells::Layer::Partly), regions[share.part].opacity)
        };
        let layers: Vec<_> = own.iter().map(layer).collect();
        let (x, y) = (at % band.width(), at / band.width());
        let shown = cells::shown(&layers, band.left + x as i64, band.top + y as i64);
        rounded(own.iter().map(|share| share.part).zip(shown))
    }
}

/// Shares in whole steps of a float below 1, so that their sum is exact: a pixel that is full has an alpha of exactly 1.
fn rounded(shares: impl Iterator<Item = (usize, f64)>) -> Vec<Share> {
    const STEPS: f64 = (1 << 24) as f64;
    let (mut sum, mut before, mut found) = (0.0, 0.0, Vec::new());
    for (part, own) in shares {
        sum += own;
        let now = (sum * STEPS).round().min(STEPS);
        let coverage = ((now - before) / STEPS) as f32;
        if coverage >= LEAST {
            found.push(Share { part, coverage });
            before = now;
        }
    }
    found
}

/// The polygons of a region in the rows of a band, and the part of the band that contains them. All polygons of a row count,
/// also those beside the band: each cuts the row where it has a corner, and a pixel must not depend on the band.
fn near(region: &Region, band: Window) -> Option<(Window, Vec<Vec<Point>>)> {
    let in_rows = |own: &Window| own.top < band.bottom && own.bottom > band.top;
    let near = region.areas.iter().filter_map(|polygon| Some((Window::around(polygon).filter(in_rows)?, polygon)));
    let (windows, polygons): (Vec<Window>, Vec<&Vec<Point>>) = near.unzip();
    let window = windows.into_iter().filter_map(|own| own.common(band)).reduce(Window::united)?;
    Some((window, polygons.into_iter().cloned().collect()))
}

/// The area of polygons without holes in each pixel of a window. `None` if `go_on` returns false.
fn area(
    polygons: Vec<Vec<Point>>,
    holes: &[Vec<Point>],
    window: Window,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Raster<f32>> {
    let mut own = Shape::new(&[polygons]).draw(window, go_on)?;
    if !holes.is_empty() {
        let holes = Shape::new(&[holes.to_vec()]).draw(window, go_on)?;
        own.data_mut().iter_mut().zip(holes.data()).for_each(|(own, hole)| *own = (*own - hole).max(0.0));
    }
    Some(own)
}

/// The colour of each region as linear light.
fn lights(regions: &[Region]) -> Vec<[f32; 3]> {
    regions.iter().map(|region| region.colour.map(colour::decode)).collect()
}

/// Adds a share of a colour to a pixel.
fn add(sum: &mut [f32; 4], [r, g, b]: [f32; 3], coverage: f32) {
    for (sum, value) in sum.iter_mut().zip([r, g, b, 1.0]) {
        *sum += coverage * value;
    }
}

/// The paint alone: linear light multiplied by alpha, and alpha.
pub fn paint(regions: &[Region], shares: &Visible) -> Raster<[f32; 4]> {
    let colours = lights(regions);
    let mut pixels = shares.pixels();
    Raster::from_fn(shares.width(), shares.height(), |_, _| {
        let mut sum = [0.0; 4];
        let shown = pixels.next().unwrap_or(&[]);
        shown.iter().for_each(|share| add(&mut sum, colours[share.part], share.coverage));
        sum
    })
}

/// A drawing over its paint, both as linear light multiplied by alpha, and alpha.
pub fn painted(drawing: &Raster<[f32; 4]>, paint: &Raster<[f32; 4]>) -> Raster<[f32; 4]> {
    Raster::from_fn(drawing.width(), drawing.height(), |x, y| multiplied(drawing.get(x, y), paint.get(x, y)))
}

/// A pixel of a drawing over one of its paint, as in [`painted`].
pub fn multiplied(over: [f32; 4], below: [f32; 4]) -> [f32; 4] {
    let (a, b) = (over[3], below[3]);
    let mixed = |k: usize| over[k] * (1.0 - b) + below[k] * (1.0 - a) + over[k] * below[k];
    // Opaque with an opaque drawing, to the last bit.
    [mixed(0), mixed(1), mixed(2), a + b * (1.0 - a)]
}

/// Encodes the paint alone. In OpenEXR Cryptomatte layers of the regions accompany it.
///
/// # Errors
///
/// An [`EncodeError`] if encoding fails or two regions have the same Cryptomatte id.
pub fn paint_picture(regions: &[Region], width: usize, height: usize, format: Format) -> Result<Vec<u8>, EncodeError> {
    let shares = shares(regions, width, height);
    let picture = paint(regions, &shares);
    let Format::Exr(form) = format else { return encode::layer(&picture, format) };
    let names: Vec<&str> = regions.iter().map(|region| &region.name[..]).collect();
    let attributes = cryptomatte::attributes(names.iter().copied()).map_err(|error| EncodeError {
        width,
        height,
        reason: error.to_string(),
    })?;
    let mut channels = cryptomatte::lines(&names, &shares);
    for (channel, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        let picture = &picture;
        let line: Line = Box::new(move |y, row| {
            row.iter_mut().zip(picture.row(y)).for_each(|(own, pixel)| *own = pixel[channel]);
        });
        channels.push((name.to_owned(), line));
    }
    streamed::encode((width, height), vec![Part { name: None, channels, attributes }], form)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RED: Colour = [1.0, 0.0, 0.0];
    const GREY: Colour = [0.5, 0.5, 0.5];

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
        vec![Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)]
    }

    fn region(outline: Vec<Point>, colour: Colour) -> Region {
        Region { name: "region".into(), areas: vec![outline], holes: Vec::new(), colour, opacity: 1.0 }
    }

    fn picture(regions: &[Region], width: usize, height: usize) -> Raster<[f32; 4]> {
        paint(regions, &shares(regions, width, height))
    }

    #[test]
    fn regions_that_touch_leave_no_seam() {
        let regions = [region(rectangle(0.0, 0.0, 1.25, 1.0), RED), region(rectangle(1.25, 0.0, 3.0, 1.0), GREY)];
        let found = picture(&regions, 3, 1);
        let grey = colour::decode(0.5);
        assert_eq!(found.get(0, 0), [1.0, 0.0, 0.0, 1.0]);
        let mixed = found.get(1, 0);
        for (found, expected) in mixed.into_iter().zip([0.25 + 0.75 * grey, 0.75 * grey, 0.75 * grey, 1.0]) {
            assert!((found - expected).abs() < 1e-6, "{mixed:?}");
        }
    }

    #[test]
    fn later_regions_lie_over_earlier_ones_and_holes_show_what_is_behind() {
        let mut front = region(rectangle(0.0, 0.0, 5.0, 5.0), RED);
        front.holes = vec![rectangle(2.0, 2.0, 3.5, 3.0)];
        let found = picture(&[region(rectangle(0.0, 0.0, 3.0, 5.0), GREY), front.clone()], 5, 5);
        assert_eq!(found.get(1, 1), [1.0, 0.0, 0.0, 1.0], "the front one hides");
        let grey = colour::decode(0.5);
        assert_eq!(found.get(2, 2), [grey, grey, grey, 1.0], "the hole shows the one behind");
        assert_eq!(found.get(3, 2), [0.5, 0.0, 0.0, 0.5], "half a hole with nothing behind");
        let mut faint = front.clone();
        faint.opacity = 0.25;
        let found = picture(&[region(rectangle(0.0, 0.0, 3.0, 5.0), [0.0; 3]), faint], 5, 5);
        assert_eq!([found.get(1, 1), found.get(4, 4)], [[0.25, 0.0, 0.0, 1.0], [0.25, 0.0, 0.0, 0.25]]);
        // A hole beyond the outline takes nothing from others.
        front.holes = vec![rectangle(4.0, 0.0, 9.0, 5.0)];
        assert_eq!(picture(&[front], 6, 5).get(5, 2), [0.0; 4]);
    }

    /// A stroke of a width along a level line.
    fn stroke(from: f64, to: f64, width: f64, colour: Colour) -> Region {
        let ends = [Point::new(from, 3.0), Point::new(to, 3.0)];
        let areas = crate::stroke::areas(&ends, &[0.5 * width; 2], false);
        Region { areas, ..region(Vec::new(), colour) }
    }

    #[test]
    fn strokes_at_one_place_are_no_denser_than_one() {
        let column = |regions: &[Region]| {
            let found = picture(regions, 20, 6);
            (0..6).map(|y| found.get(9, y)[3]).collect::<Vec<_>>()
        };
        let thick = || stroke(2.0, 18.0, 3.0, RED);
        assert_eq!(column(&[thick()]), [0.0, 0.5, 1.0, 1.0, 0.5, 0.0]);
        assert_eq!(column(&[thick(), thick()]), [0.0, 0.5, 1.0, 1.0, 0.5, 0.0]);
        let thin = || stroke(2.0, 18.0, 2.4, RED);
        let found = column(&[thin(), thin(), thin()]);
        assert!(found.iter().zip([0.0, 0.2, 1.0, 1.0, 0.2, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        // Two that meet end to end are one.
        let (first, second) = (stroke(2.0, 9.3, 3.0, RED), stroke(9.3, 18.0, 3.0, RED));
        assert_eq!(column(&[first, second]), [0.0, 0.5, 1.0, 1.0, 0.5, 0.0]);
        // On paint, two lines leave what one leaves.
        let paper = || region(rectangle(0.0, 0.0, 20.0, 6.0), [1.0; 3]);
        let black = || stroke(2.0, 18.0, 3.0, [0.0; 3]);
        assert_eq!(picture(&[paper(), black(), black()], 20, 6).get(9, 1), [0.5, 0.5, 0.5, 1.0]);
        // The nearer one hides the other, and a faint one shows it.
        let front = |opacity| Region { opacity, ..stroke(2.0, 18.0, 3.0, RED) };
        let behind = || stroke(2.0, 18.0, 3.0, [0.0, 0.0, 1.0]);
        assert_eq!(picture(&[behind(), front(1.0)], 20, 6).get(9, 1), [0.5, 0.0, 0.0, 0.5]);
        assert_eq!(picture(&[behind(), front(0.25)], 20, 6).get(9, 1), [0.125, 0.0, 0.375, 0.5]);
        assert_eq!(picture(&[front(0.5), front(0.5)], 20, 6).get(9, 2), [0.75, 0.0, 0.0, 0.75]);
    }

    #[test]
    fn regions_of_any_size_and_place_are_drawn() {
        for outline in
            [vec![], vec![Point::new(1.0, 1.0)], rectangle(-9.0, -9.0, -1.0, -1.0), rectangle(9.0, 0.0, 12.0, 9.0)]
        {
            assert!(picture(&[region(outline, RED)], 4, 4).data().iter().all(|pixel| *pixel == [0.0; 4]));
        }
        let beyond = picture(&[region(rectangle(-9.0, -9.0, 99.0, 199.0), RED)], 4, 70);
        assert!(beyond.data().iter().all(|pixel| *pixel == [1.0, 0.0, 0.0, 1.0]));
        let wrong = vec![Point::new(0.0, 0.0), Point::new(f64::NAN, 0.0), Point::new(3.0, 3.0)];
        assert!(picture(&[region(wrong, RED)], 4, 4).data().iter().all(|pixel| *pixel == [0.0; 4]));
    }

    #[test]
    fn a_painting_that_is_stopped_ends() {
        let regions = vec![region(rectangle(0.0, 0.0, 30.0, 30.0), RED); 3];
        let window = Window { left: 0, top: 0, right: 30, bottom: 30 };
        for stop in [0, 1, 17, 60] {
            let mut calls = 0;
            let mut go_on = || {
                calls += 1;
                calls <= stop
            };
            assert_eq!(paint_in(&regions, window, &mut go_on), None);
            assert_eq!(calls, stop + 1, "it ends at once");
        }
    }

    #[test]
    fn moved_regions_take_their_holes_with_them() {
        let mut own = region(rectangle(0.0, 0.0, 4.0, 4.0), RED);
        own.holes = vec![rectangle(1.0, 1.0, 2.0, 3.0)];
        let moved = own.moved(|p| p * 2.0 + Point::new(1.0, 0.0));
        assert_eq!(moved.areas, [rectangle(1.0, 0.0, 9.0, 8.0)]);
        assert_eq!(moved.holes, [rectangle(3.0, 2.0, 5.0, 6.0)]);
        assert_eq!(bounds(&[moved]), Some(Window { left: 1, top: 0, right: 9, bottom: 8 }));
        assert_eq!(bounds(&[]), None);
    }

    #[test]
    fn ink_darkens_paint_and_paper_leaves_it() {
        let over = |drawing: [f32; 4], paint: [f32; 4]| {
            painted(&Raster::new(1, 1, drawing), &Raster::new(1, 1, paint)).get(0, 0)
        };
        let (white, black, none, paint) = ([1.0; 4], [0.0, 0.0, 0.0, 1.0], [0.0; 4], [0.2, 0.4, 0.6, 1.0]);
        assert_eq!(over(white, paint), paint);
        assert_eq!(over(black, paint), black);
        assert_eq!(over(none, paint), paint, "a drawing on transparent paper");
        assert_eq!(over([0.5, 0.5, 0.5, 1.0], paint), [0.1, 0.2, 0.3, 1.0]);
        assert_eq!(over(white, none), white, "nothing is painted there");
        assert_eq!(over([0.1, 0.2, 0.3, 0.5], none), [0.1, 0.2, 0.3, 0.5]);
        assert_eq!(over([0.0, 0.0, 0.0, 0.5], paint), [0.1, 0.2, 0.3, 1.0], "half of black ink");
    }

    proptest! {
        #[test]
        fn a_window_is_a_piece_of_the_whole_to_the_last_bit(
            places in prop::collection::vec((-9.0f64..50.0, -9.0f64..150.0, 0.2f64..5.0), 3..24),
            (left, top, width, height) in (-6i64..30, -6i64..100, 1i64..20, 1i64..80),
        ) {
            let strokes: Vec<Region> = places.chunks(4).zip(1..).map(|(run, n)| {
                let points: Vec<Point> = run.iter().map(|&(x, y, _)| Point::new(x, y)).collect();
                let radii: Vec<f64> = run.iter().map(|&(.., radius)| radius).collect();
                let areas = crate::stroke::areas(&points, &radii, false);
                let holes = vec![rectangle(points[0].x, points[0].y, points[0].x + 3.3, points[0].y + 2.7)];
                Region { areas, holes, opacity: 1.0 / n as f32, ..region(Vec::new(), [0.3, 0.1 * n as f32, 0.9]) }
            }).collect();
            let whole = picture(&strokes, 40, 140);
            let window = Window { left, top, right: left + width, bottom: top + height };
            let piece = paint_in(&strokes, window, &mut || true).unwrap();
            for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
                if (0..40).contains(&(left + x)) && (0..140).contains(&(top + y)) {
                    let wanted = whole.get((left + x) as usize, (top + y) as usize);
                    prop_assert_eq!(piece.get(x as usize, y as usize), wanted);
                } else if bounds(&strokes).is_none_or(|all| all.common(Window {
                    left: left + x, top: top + y, right: left + x + 1, bottom: top + y + 1,
                }).is_none()) {
                    prop_assert_eq!(piece.get(x as usize, y as usize), [0.0; 4]);
                }
            }
        }

        #[test]
        fn shares_are_what_unions_leave(corners in prop::collection::vec(prop::array::uniform6(-4.0f64..74.0), 1..7)) {
            let triangle = |c: &[f64; 6]| c.chunks(2).map(|p| Point::new(0.3 * p[0], p[1])).collect::<Vec<_>>();
            let outlines: Vec<_> = corners.iter().map(triangle).collect();
            let regions: Vec<_> = outlines.iter().map(|outline| region(outline.clone(), RED)).collect();
            let shares = shares(&regions, 20, 70);
            let unions: Vec<_> = (0..=outlines.len()).map(|n| crate::matte::coverage(&outlines[n..], 20, 70)).collect();
            for (at, pixel) in shares.pixels().enumerate() {
                for part in 0..outlines.len() {
                    let expected = unions[part].data()[at] - unions[part + 1].data()[at];
                    let found: f32 = pixel.iter().filter(|s| s.part == part).map(|s| s.coverage).sum();
                    prop_assert!((found - expected).abs() < 2e-5, "{at} {part}: {found} {expected}");
                }
            }
        }

        #[test]
        fn a_drawing_cut_into_regions_is_painted_whole(
            cuts in prop::collection::vec((0.0f64..9.0, 0.0f64..70.0), 1..5), slant in -3.0f64..3.0,
        ) {
            // Slanted strips from the left to the right, cut at a height each.
            let (mut regions, mut x) = (Vec::new(), -4.0);
            for (step, y) in cuts.into_iter().chain([(40.0, 35.0)]) {
                let strip = |x: f64| [Point::new(x - slant, 0.0), Point::new(x + slant, 70.0)];
                let ([a, d], [b, c]) = (strip(x), strip(x + step));
                let [m, n] = [(a, d), (b, c)].map(|(top, bottom)| top.lerp(bottom, y / 70.0));
                regions.extend([region(vec![a, b, n, m], RED), region(vec![m, n, c, d], GREY)]);
                x += step;
            }
            let shares = shares(&regions, 12, 70);
            for (at, pixel) in shares.pixels().enumerate().filter(|(at, _)| (3..9).contains(&(at % 12))) {
                let sum: f32 = pixel.iter().map(|share| share.coverage).sum();
                prop_assert!((sum - 1.0).abs() < 1e-4, "{at}: {sum}");
            }
        }
    }
}
