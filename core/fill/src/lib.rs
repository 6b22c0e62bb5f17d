//! Ink and paint: the regions of line drawings, and their colours, carried from painted drawings to all others.
//!
//! An artist paints a drawing with the bucket: a click for each region. [`carry()`] paints the next drawing the same way. It finds
//! what each region there is, though regions move, change their shape, fall to pieces, join, appear and vanish.
//!
//! # How
//!
//! Files, in reading order:
//!
//! - [`regions`]: what the ink of a drawing encloses; a region that leaks is split between clicks
//! - [`layout`]: places, sizes and borders of regions
//! - [`shifts`]: where each place of a drawing is on another one, from the registration of both drawings' lines
//!   ([`rototoon_lines::displaced`])
//! - [`leaks`]: gaps in lines, which the painted drawing shows
//! - [`outside`]: clicks that leak to the edge of the picture
//! - [`piece`]: what a gap parts from a region, and whether it has leaked
//! - [`meet`]: how well each region of one drawing meets each of another one
//! - [`opens`]: paper that opens between limbs
//! - [`relax`]: who is who, by neighbours
//! - [`page`]: a drawing, and clicks that paint it
//! - [`carry`](mod@carry): colours and numbers on the next drawing
//! - [`change`]: a colour that becomes another one from a drawing on
//! - [`confidence`]: how probable it is that a colour is right, by the [`evidence`]
//! - [`lost`]: a colour in whose place another one is lost is in doubt
//! - [`outlines`]: painted regions as outlines with holes
//! - [`thin`]: outlines with fewer points, the same for both sides of a border
//!
//! Regions are matched as in Sato et al. (*Reference-based manga colorization by graph correspondence using quadratic
//! programming*, 2014): by themselves and by their neighbours. But a region need not have one counterpart: colours are what is asked
//! for, so the parts of a region that fell to pieces may all be the same region of the source. And lines are registered
//! first, so that places say more than shapes.
//!
//! # Limits
//!
//! A gap in a line is closed only where clicks or a painted drawing show that there are two areas. What no source
//! has painted gets the colour of what is most alike, with little confidence. Paint that has no line around it, such as a blush, is unknown.
//!
//! # Example
//!
//! A square with a disc in it is painted. On the next drawing it is 8 px further to the right.
//!
//! ```
//! use rototoon_base::{geometry::Point, scene::Raster};
//! use rototoon_fill::{Click, Page, Source, Ways, carry, fills};
//! use std::sync::Arc;
//!
//! let page = |shift: f64| {
//!     let ink = |p: Point| {
//!         let away = (p - Point::new(60.0 + shift, 60.0)).abs();
//!         (away.max_element() - 40.0).abs() < 1.5 || (away.length() - 15.0).abs() < 1.5
//!     };
//!     let shade = |p: Point| if ink(p) { [0.1; 3] } else { [1.0; 3] };
//!     let picture = Raster::from_fn(160, 120, |x, y| shade(Point::new(x as f64 + 0.5, y as f64 + 0.5)));
//!     Page::new(Arc::new(picture), &rototoon_lines::Options::default())
//! };
//! // Paper, square and disc.
//! let clicks = [(5.0, 5.0), (30.0, 30.0), (60.0, 60.0)];
//! let clicks: Vec<Click> =
//!     clicks.iter().enumerate().map(|(colour, &(x, y))| Click { at: Point::new(x, y), colour: Some(colour) }).collect();
//!
//! let (mut first, mut second, mut next) = (page(0.0), page(8.0), 0);
//! let (paint, missed) = first.painted(&clicks, 3, &mut next);
//! assert!(missed.is_empty());
//! let ways = Ways::new(&first, &second);
//! let carried = carry(&[Source { page: &first, paint: &paint, own: true, ways: &ways }], &mut second, &mut next).unwrap();
//! let colours: Vec<usize> = fills(&second, &carried).iter().map(|fill| fill.colour).collect();
//! assert_eq!(colours, [0, 1, 2], "the largest first");
//! ```

#![forbid(unsafe_code)]

pub mod carry;
pub mod change;
pub mod confidence;
pub mod evidence;
pub mod layout;
pub mod leaks;
mod levels;
pub mod lost;
pub mod meet;
pub mod opens;
pub mod outlines;
pub mod outside;
pub mod page;
pub mod piece;
pub mod regions;
pub mod relax;
mod said;
pub mod shifts;
pub mod thin;

pub use carry::{Source, Ways, carry};
pub use change::{Change, changes};
pub use outlines::{Fill, fills};
pub use outside::Gap;
pub use page::{Click, Page, Paint};
pub use regions::Regions;
