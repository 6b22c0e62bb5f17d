//! Hidden lines: of each line, what a filled shape in front of it covers (Yang et al. 1986, §4 and Appendix E).
//!
//! [`hidden_lines`] takes lines and covers, each with its [`Depth`], and gives for each line the parameters between
//! which it is visible and hidden. Nothing is cut or moved here: a line stays the line that it is, with intervals of
//! its own parameter ([`Path::part`] gives their shape, [`Form::cut`] their points), so that whatever is made of them
//! still knows where it came from.
//!
//! # What is hidden
//!
//! A point of a line is hidden if a cover with a larger depth holds it; what an outline that crosses itself holds says
//! the [`FillRule`]. A line on the border of a cover is visible, as it is drawn half beside it. If both of its sides
//! are covered (it runs between two shapes that adjoin) it is hidden.
//!
//! # How
//!
//! Meetings of the pieces are exact ([`rototoon_base::curve::intersect`]); between two of them the winding number decides
//! (`cover`, `against`). Trees of boxes (`tree`) find the pieces and shapes that are near each other, so that
//! many strokes cost little more each than few.
//!
//! # Between frames
//!
//! Frames are told apart from each other by nothing: there is no memory that could flicker. What is found is right for
//! covers that differ by no more than [`Options::border`] from those given, hence an outline that is drawn twice, once
//! as a line and once as a fill, and rounded, is not torn to pieces. Crossings move as continuously as the curves do:
//! where a line grazes an outline its hidden stretch begins as a point and grows. Stretches shorter than
//! [`Options::sliver`] take after their surroundings; nothing appears or goes that is longer than that, unless the
//! drawings jump or a line lies down on a border at once.
//!
//! # Limits
//!
//! Lines have no width here: a broad line whose middle is visible is visible in its full width. Two crossings that are
//! closer together than the crossing test can tell (1e-6 of a piece) count as none.

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
use rayon::prelude::*;
use tree::Tree;

/// A line that may be hidden.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its shape.
    pub path: Path,
    /// Its depth.
    pub depth: Depth,
}

/// A filled shape, which hides the lines of a lesser depth; those of its own depth it does not.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// Its outlines; open ones are closed by a straight line.
    pub outlines: Vec<Path>,
    /// What they enclose.
    pub rule: FillRule,
    /// Its depth.
    pub depth: Depth,
}

/// Distances below which lines are not told apart, in pixels; zero or more, finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What is no farther from the outline of a cover lies on it. It should be above the rounding of the points.
    pub border: f64,
    /// Visible and hidden stretches shorter than this take after their surroundings.
    pub sliver: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { border: 0.01, sliver: 0.1 }
    }
}

/// Options that are no distances.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} of {found} px, expected a number that is not negative")]
pub struct OptionsError {
    /// Which option.
    pub name: &'static str,
    /// What was found.
    pub found: f64,
}

/// What is seen of a line, in its own parameter; both together are the whole line.
///
/// Intervals rise and are apart from each other. That of a closed line which runs over its seam comes last, and its end
/// is greater than [`Path::end`]. A closed line that is all visible or hidden has one interval, from 0 to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    /// What is seen.
    pub visible: Vec<Interval>,
    /// What is covered.
    pub hidden: Vec<Interval>,
}

/// What is seen of each line. The same on any number of threads.
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

/// What is seen of a line behind some shapes.
fn visibility(path: &Path, front: &[&Shape], options: &Options) -> Visibility {
    let end = path.end();
    let hidden = intervals::without_slivers(path, hidden(path, front, options), options.sliver);
    let visible = intervals::complement(&hidden, end);
    let rounded = |found: Vec<Interval>| if path.is_closed() { intervals::over_seam(found, end) } else { found };
    Visibility { visible: rounded(visible), hidden: rounded(hidden) }
}

/// The stretches of a line that some shapes cover.
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

/// Of stretches along borders, those with a cover on either side.
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
