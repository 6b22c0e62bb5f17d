//! The benchmark of fills: colours carried from one painted line drawing to all others, beside the same film in colour.
//!
//! - [`set`]: films with their colours, from folders
//! - [`shapes`]: drawings made of shapes
//! - [`own`]: a film that this package draws
//! - [`figures`], [`films`]: films of figures that chance makes, for the fit of the confidence
//! - [`parts`]: films of tracked characters
//! - [`ink`]: the lines of a drawing, found without the code under test
//! - [`truth`]: the true regions of a drawing, and the clicks that paint it
//! - [`paint`]: the painted regions of a document as pixels
//! - [`score`]: which regions have the right colour
//! - [`run`]: paints and scores a film
//! - [`evidence`]: tables from which the confidence is fitted
//! - [`table`]: the results as Markdown
//! - [`sheet`]: the drawings with most wrong regions
//!
//! A **set** is a folder with the line drawings `frames/*.png` and, under the same names, the drawings in colour
//! `colour/*.png`. The command (`cargo xtask bench-fill`) measures each set in an optimised process of its own, so that peak memory
//! is that of one set.

pub mod evidence;
pub mod figures;
pub mod films;
pub mod ink;
pub mod own;
pub mod paint;
pub mod parts;
pub mod run;
pub mod score;
pub mod set;
pub mod shapes;
pub mod sheet;
pub mod table;
pub mod truth;
