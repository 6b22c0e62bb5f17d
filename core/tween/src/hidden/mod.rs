//! Hidden lines: the parts of each line that a filled shape in front of it covers (Yang et al. 1986, §4 and Appendix
//! E).
//!
//! [`hidden_lines`] takes lines and covers, each with its [`Depth`]. For each line it gives the parameter intervals in
//! which the line is visible and hidden. It does not cut or move anything: a line keeps its shape, and the intervals
//! refer to its own parameter. [`Path::part`] gives the shape of an interval, [`Form::cut`] gives its points. Whatever
//! is made of the intervals therefore still knows where it came from.
//!
//! # What is hidden
//!
//! A point of a line is hidden if it is inside a cover with a larger depth. The [`FillRule`] decides what is inside an
//! outline that crosses itself. A line on the border of a cover is visible, because half of its drawn width is beside
//! the cover. If both sides of the line are covered (it runs between two adjoining shapes), it is hidden.
//!
//! # How
//!
//! The meetings of the pieces are computed exactly ([`rototoon_base::curve::intersect`]). Between two meetings the winding
//! number decides ([`cover`], [`against`](mod@against)). Trees of bounding boxes ([`tree`]) find the pieces and shapes that are near
//! each other, so the cost per stroke grows little with the number of strokes.
//!
//! # From frame to frame
//!
//! Each frame is computed by itself; there is no memory. The result tolerates outlines that differ by up to
//! [`Options::border`]: an outline that is drawn twice, once as a line and once as a fill, and rounded, is not torn to
//! pieces. Crossings move as continuously as the curves. Where a line begins to graze an outline, its hidden stretch
//! starts as a point and grows. Stretches shorter than [`Options::sliver`] take the state of their surroundings.
//! Nothing longer than that appears or disappears suddenly, unless the drawings jump or a line comes to lie on a border
//! all at once.
//!
//! # Limits
//!
//! Lines have no width here: a broad line whose middle is visible counts as visible in its full width. Two crossings
//! closer together than the crossing test can resolve (1e-6 of a piece) count as none.
//!
//! # Source
//!
//! M. C. K. Yang et al., "Automatic curve fitting with quadratic B-spline functions and its application to
//! computer-assisted animation", 1986, §4 and Appendix E.

mod against;
mod cover;
mod cut;
mod depth;
mod intervals;
mod path;
#[cfg(test)]
mod tests;
mod tree;

pub use cover::FillRule;
pub use cut::{Blend, Form};
pub use depth::{Depth, DepthOrder};
pub use intervals::Interval;
pub use path::{Path, PathError};

use against::{Widths, against};
use cover::Shape;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use tree::Tree;

/// A line that may be hidden.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Shape, in pixels.
    pub path: Path,
    /// Depth; covers with a larger depth hide the line.
    pub depth: Depth,
}

/// A filled shape. It hides the lines of a smaller depth, but not those of its own depth.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// Outlines, in pixels. Open ones are closed by a straight line.
    pub outlines: Vec<Path>,
    /// Decides which points the outlines enclose.
    pub rule: FillRule,
    /// Depth.
    pub depth: Depth,
}

/// Distances below which differences do not count, in pixels; finite, zero or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// A point at most this far from the outline of a cover is on its border. It should exceed the rounding of the
    /// points.
    pub border: f64,
    /// Visible and hidden stretches shorter than this take the state of their surroundings.
    pub sliver: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { border: 0.01, sliver: 0.1 }
    }
}

/// An option that is not a distance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} of {found} px, expected a number that is not negative")]
pub struct OptionsError {
    /// Name of the option.
    pub name: &'static str,
    /// The value found.
    pub found: f64,
}

/// The visible and hidden intervals of a line, in its own parameter. Together they are the complete line.
///
/// Intervals rise and do not touch each other. An interval of a closed line that runs over the seam comes last, and its
/// end is greater than [`Path::end`]. A closed line that is entirely visible or hidden has one interval, from 0 to its
/// end.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// Visible intervals.
    pub visible: Vec<Interval>,
    /// Hidden intervals.
    pub hidden: Vec<Interval>,
}

/// The visible and hidden intervals of each line, in the order of `lines`. Lines and covers are in the same coordinate
/// frame, in pixels. The result does not depend on the number of threads.
///
/// # Errors
///
/// An option that is negative or not finite.
pub fn hidden_lines(lines: &[Line], covers: &[Cover], options: &Options) -> Result<Vec<Visibility>, OptionsError> {
    for (name, found) in [("border", options.border), ("sliver", options.sliver)] {
        if !(found >= 0.0 && found.is_finite()) {
            return Err(OptionsError { name, found });
        }
    }
    let shapes: Vec<Shape> = covers.par_iter().map(|cover| Shape::new(&cover.outlines, cover.rule)).collect();
    let tree = Tree::new(shapes.iter().map(Shape::bounds).collect());
    let seen = lines.par_iter().map(|line| {
        let mut front = Vec::new();
        tree.query(line.path.bounds(), |i| {
            if covers[i].depth > line.depth {
                front.push(i);
            }
        });
        front.sort_unstable();
        let front: Vec<&Shape> = front.into_iter().map(|i| &shapes[i]).collect();
        visibility(&line.path, &front, options)
    });
    Ok(seen.collect())
}

/// The visible and hidden intervals of a line behind some shapes.
fn visibility(path: &Path, front: &[&Shape], options: &Options) -> Visibility {
    let end = path.end();
    let hidden = intervals::without_slivers(path, hidden(path, front, options), options.sliver);
    let visible = intervals::complement(&hidden, end);
    let rounded = |found: Vec<Interval>| if path.is_closed() { intervals::over_seam(found, end) } else { found };
    Visibility { visible: rounded(visible), hidden: rounded(hidden) }
}

/// The intervals of a line that some shapes cover.
fn hidden(path: &Path, front: &[&Shape], options: &Options) -> Vec<Interval> {
    let widths = Widths { border: options.border, sliver: options.sliver };
    let (mut covered, mut borders, mut cuts) = (Vec::new(), Vec::new(), Vec::new());
    for shape in front {
        let found = against(path, shape, widths);
        covered.extend(found.inside);
        borders.extend(found.border);
        cuts.extend(found.cuts);
        if covered.last() == Some(&(0.0, path.end())) {
            return vec![(0.0, path.end())];
        }
    }
    if !borders.is_empty() {
        covered.extend(covered_on_both_sides(path, front, &borders, cuts, options.border));
    }
    intervals::union(covered, 0.0)
}

/// The stretches along borders that have a cover on both sides.
fn covered_on_both_sides(
    path: &Path,
    front: &[&Shape],
    borders: &[Interval],
    mut cuts: Vec<f64>,
    width: f64,
) -> Vec<Interval> {
    let beside = 4.0 * width.max(1e-9 * path.bounds().1.abs().max_element());
    cuts.extend(borders.iter().flat_map(|&(from, to)| [from, to]));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let covers = |p| front.iter().any(|shape| shape.contains(p));
    let mut found = Vec::new();
    for (from, to) in intervals::union(borders.to_vec(), 0.0) {
        let inner = cuts.iter().copied().filter(|&t| t > from && t < to);
        let ends: Vec<f64> = std::iter::once(from).chain(inner).chain([to]).collect();
        for pair in ends.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let across = path.direction(middle).perp() * beside;
            let p = path.point(middle);
            if across.length_squared() > 0.0 && covers(p + across) && covers(p - across) {
                found.push((pair[0], pair[1]));
            }
        }
    }
    found
}
