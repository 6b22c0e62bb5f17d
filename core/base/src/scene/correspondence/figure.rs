//! Assignment of drawn contours to parts, together with a common movement of the figure.
//!
//! Parts look alike (arms, legs, eyes), so shape alone decides little. The place in the figure decides most, but the
//! figure has moved and rotated. Therefore movements are proposed: one for each pair of similar contours, and rotations
//! of the figure about its middle. Full assignments score the most promising movements.
//!
//! The score of a movement includes its refinement: with contours matched, the movement near each part is fitted to its
//! neighbours, so a limb is expected where its side of the body went.
//!
//! Limits: the figure rotates and grows within the limits of the options. Two identical parts that change places are
//! exchanged unless their neighbours, colours or labels differ.

use super::outline::{Alignment, Outline, wrap};
use super::{DrawnContour, MatchOptions};
use crate::geometry::{Point, polygon};
use crate::numeric::assignment::assign;

/// Weight of the unexplained share of the shape.
const SHAPE: f64 = 2.0;
/// Weight of the squared rotation of a part relative to the figure, in rad².
const TURN: f64 = 0.15;
/// The same weight when a matched part's points are placed, in rad². It decides for discs only.
const SLIDE: f64 = 0.03;
/// Weight of the squared logarithm of a part's growth relative to the figure's.
const SIZE: f64 = 1.0;
/// Weight of the squared logarithm of a length's growth relative to the size's.
const LENGTH: f64 = 0.5;
/// Weight of the squared distance from the expected position, in units of the figure's radius.
const POSITION: f64 = 2.0;
/// Weight of the squared colour difference.
const COLOUR: f64 = 2.0;
/// Cost of a label that differs. Of look-alikes near each other, such as two legs that cross, it decides; a part that was
/// drawn on another layer is still found by its shape and place.
const LABEL: f64 = 0.15;
/// Cost of a place in the order of drawing that is wrong by all contours. It decides where nothing else does.
const ORDER: f64 = 0.002;
/// Cost if an open part is drawn closed, or a closed part open with a wide gap.
const CLOSEDNESS: f64 = 0.4;
/// Gap, as a share of the length, from which a contour counts as fully open.
const WIDE_GAP: f64 = 0.15;
/// Cost of the figure's rotation, for each part and rad².
const STILLNESS: f64 = 0.02;

/// Step of the proposed rotations of the figure, in radians.
const TURN_STEP: f64 = std::f64::consts::PI / 12.0;
/// Largest unexplained share of the shape with which a pair proposes a movement.
const PROPOSING: f64 = 0.15;
/// Greatest number of movements proposed by pairs.
const MOST_PROPOSALS: usize = 200;
/// Number of movements that get a full assignment.
const FINALISTS: usize = 12;
/// Greatest number of refinement rounds.
const ROUNDS: usize = 6;
/// Neighbours within this distance have about the same weight, in units of the figure's radius.
const NEIGHBOURHOOD: f64 = 0.4;
/// A cost that is never accepted. It is finite because the assignment requires finite costs.
const NEVER: f64 = 1e9;

/// Data of a pair that do not depend on the figure.
struct Pair {
    alignments: Vec<Alignment>,
    growth: f64,
    /// Costs that do not depend on the figure's movement.
    fixed: f64,
}

/// A movement of the figure: p ↦ scale · rotate(p − source) + target.
#[derive(Clone, Copy, Debug)]
struct Movement {
    turn: f64,
    scale: f64,
    source: Point,
    target: Point,
}

impl Movement {
    fn apply(&self, p: Point) -> Point {
        (Point::from_angle(self.turn) * self.scale).rotate(p - self.source) + self.target
    }
}

/// The parts and the drawn contours.
pub(super) struct Figures<'a> {
    options: &'a MatchOptions,
    /// By part; `None` if it has no points.
    parts: Vec<Option<Outline>>,
    /// By drawn contour, for its centre; `None` if it has no points.
    centres: Vec<Option<Outline>>,
    /// By part, then drawn contour; `None` if either has no points.
    pairs: Vec<Vec<Option<Pair>>>,
    /// Root mean square distance of the parts from their middle, in pixels.
    radius: f64,
}

/// A part's counterpart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chosen {
    pub drawn: usize,
    pub cost: f64,
    /// Rotation of the figure, in radians.
    pub turn: f64,
}

impl<'a> Figures<'a> {
    pub fn new(parts: &[DrawnContour], drawn: &[DrawnContour], options: &'a MatchOptions) -> Self {
        let outlines: Vec<_> = parts.iter().map(|part| Outline::new(part, part.closed)).collect();
        let centres: Vec<_> = drawn.iter().map(|contour| Outline::new(contour, contour.closed)).collect();
        // A drawn contour counts as closed beside a closed part, and as open beside an open part.
        let forms: Vec<_> = drawn.iter().map(|c| [Outline::new(c, false), Outline::new(c, true)]).collect();
        let pair = |i: usize, j: usize| {
            let (a, b) = (outlines[i].as_ref()?, forms[j][usize::from(parts[i].closed)].as_ref()?);
            let mut pair = Pair::new(a, b, &parts[i], &drawn[j]);
            pair.fixed += order(i, parts.len(), j, drawn.len());
            Some(pair)
        };
        let pairs = (0..parts.len()).map(|i| (0..drawn.len()).map(|j| pair(i, j)).collect()).collect();
        let radius = spread(&outlines);
        Self { options, parts: outlines, centres, pairs, radius }
    }

    /// Chooses the counterpart of each part.
    pub fn choose(&self) -> Vec<Option<Chosen>> {
        let mut proposals: Vec<(f64, Movement)> =
            self.proposals().into_iter().map(|movement| (self.bound(&movement), movement)).collect();
        proposals.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<(f64, Vec<Option<Chosen>>)> = None;
        for (_, movement) in proposals.iter().take(FINALISTS) {
            let stillness = STILLNESS * self.parts.len() as f64 * movement.turn * movement.turn;
            let (total, chosen) = self.refine(movement);
            if best.as_ref().is_none_or(|(least, _)| total + stillness < *least) {
                best = Some((total + stillness, chosen));
            }
        }
        best.map_or_else(|| vec![None; self.parts.len()], |(_, chosen)| chosen)
    }

    /// Movements to try.
    fn proposals(&self) -> Vec<Movement> {
        let mut result = Vec::new();
        let (source, target) = (middle(&self.parts), middle(&self.centres));
        let scale = (spread(&self.centres) / self.radius).clamp(1.0 / self.options.max_scale, self.options.max_scale);
        let steps = (self.options.max_turn / TURN_STEP).floor() as i32;
        for k in -steps..=steps {
            result.push(Movement { turn: f64::from(k) * TURN_STEP, scale, source, target });
        }
        let mut by_pairs = Vec::new();
        for (part, row) in self.parts.iter().zip(&self.pairs) {
            for (drawn, pair) in self.centres.iter().zip(row) {
                let (Some(part), Some(drawn), Some(pair)) = (part, drawn, pair) else { continue };
                let scale = pair.growth.exp();
                if scale.max(1.0 / scale) > self.options.max_scale {
                    continue;
                }
                let Some(best) = pair.best(0.0, self.options.max_turn) else { continue };
                if best.residual < PROPOSING {
                    let movement = Movement { turn: best.turn, scale, source: part.centre, target: drawn.centre };
                    by_pairs.push((best.residual + pair.fixed, movement));
                }
            }
        }
        by_pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        result.extend(by_pairs.into_iter().take(MOST_PROPOSALS).map(|(_, movement)| movement));
        result
    }

    /// Lower bound of the cost of a movement: every part takes its best counterpart, even if several take the same.
    fn bound(&self, movement: &Movement) -> f64 {
        let of_part = |i: usize| {
            let Some(part) = &self.parts[i] else { return 0.0 };
            let expected = movement.apply(part.centre);
            let costs = (0..self.centres.len()).map(|j| self.cost(i, j, movement, expected));
            costs.fold(self.options.max_cost, f64::min)
        };
        let stillness = STILLNESS * self.parts.len() as f64 * movement.turn * movement.turn;
        (0..self.parts.len()).map(of_part).sum::<f64>() + stillness
    }

    /// Cost of drawn contour `j` as the counterpart of part `i`, whose centre is expected at `expected`.
    fn cost(&self, i: usize, j: usize, movement: &Movement, expected: Point) -> f64 {
        let (Some(drawn), Some(pair)) = (&self.centres[j], &self.pairs[i][j]) else { return NEVER };
        let away = expected.distance(drawn.centre) / (self.radius * movement.scale);
        let size = pair.growth - movement.scale.ln();
        let shape = pair.alignments.iter().map(|a| a.cost(movement.turn)).fold(f64::INFINITY, f64::min);
        (pair.fixed + shape + SIZE * size * size + POSITION * away * away).min(NEVER)
    }

    /// Alternates assignment and a fit of the movement around each part to its neighbours, until nothing changes.
    fn refine(&self, movement: &Movement) -> (f64, Vec<Option<Chosen>>) {
        let mut movements = vec![*movement; self.parts.len()];
        let mut best = self.assign(&movements);
        for _ in 0..ROUNDS {
            for (i, local) in movements.iter_mut().enumerate() {
                *local = self.around(i, &best.1, movement);
            }
            let next = self.assign(&movements);
            let drawn = |chosen: &[Option<Chosen>]| -> Vec<_> { chosen.iter().map(|c| c.map(|c| c.drawn)).collect() };
            let settled = drawn(&next.1) == drawn(&best.1);
            best = next;
            if settled {
                break;
            }
        }
        // A neighbour that swings rotates the movement fitted around it. For placing points the figure's rotation is
        // more reliable.
        let turn = self.fit(&best.1, movement, |_, _| 1.0).turn;
        best.1.iter_mut().flatten().for_each(|choice| choice.turn = turn);
        best
    }

    /// Total cost and counterparts, given the expected movement of each part.
    fn assign(&self, movements: &[Movement]) -> (f64, Vec<Option<Chosen>>) {
        let (rows, columns) = (self.parts.len(), self.centres.len());
        let limit = self.options.max_cost;
        // An additional column for each part lets it stay without counterpart.
        let mut costs = vec![limit; rows * (columns + rows)];
        for (i, part) in self.parts.iter().enumerate() {
            for j in 0..columns {
                let cost = part.as_ref().map(|part| self.cost(i, j, &movements[i], movements[i].apply(part.centre)));
                costs[i * (columns + rows) + j] = cost.unwrap_or(NEVER);
            }
        }
        let found = assign(&costs, rows, columns + rows).unwrap_or_else(|_| vec![None; rows]);
        let mut total = 0.0;
        let chosen = found.into_iter().enumerate().map(|(i, column)| {
            let cost = column.map_or(limit, |c| costs[i * (columns + rows) + c]);
            total += cost;
            column.filter(|&c| c < columns && cost < limit).map(|drawn| Chosen { drawn, cost, turn: movements[i].turn })
        });
        let chosen = chosen.collect();
        (total, chosen)
    }

    /// The movement fitted to the matched neighbours of part `i`. If there are few, the figure's movement dominates.
    fn around(&self, i: usize, chosen: &[Option<Chosen>], whole: &Movement) -> Movement {
        let Some(part) = &self.parts[i] else { return *whole };
        let near = (NEIGHBOURHOOD * self.radius).powi(2);
        self.fit(
            chosen,
            whole,
            |k, other| {
                if k == i { 0.0 } else { near / (part.centre.distance_squared(other.centre) + near) }
            },
        )
    }

    /// The movement fitted to the matched parts, weighted by index and outline and regularised by another movement.
    fn fit(&self, chosen: &[Option<Chosen>], held: &Movement, weight: impl Fn(usize, &Outline) -> f64) -> Movement {
        let mut known = Vec::new();
        for (k, choice) in chosen.iter().enumerate() {
            if let (Some(part), Some(choice)) = (&self.parts[k], choice)
                && let Some(drawn) = &self.centres[choice.drawn]
            {
                known.push((weight(k, part), part.centre, drawn.centre));
            }
        }
        let total: f64 = known.iter().map(|k| k.0).sum();
        if known.iter().filter(|k| k.0 > 0.0).count() < 2 {
            return *held;
        }
        let source = known.iter().map(|k| k.0 * k.1).sum::<Point>() / total;
        let target = known.iter().map(|k| k.0 * k.2).sum::<Point>() / total;
        // The other movement counts as one more pair at the figure's radius.
        let mut denominator = self.radius * self.radius;
        let mut numerator = Point::from_angle(held.turn) * (held.scale * denominator);
        for (weight, p, q) in known {
            let (p, q) = (p - source, q - target);
            numerator += weight * Point::new(p.dot(q), p.perp_dot(q));
            denominator += weight * p.length_squared();
        }
        let factor = numerator / denominator;
        let limit = self.options.max_scale * 1.2;
        Movement { turn: factor.to_angle(), scale: factor.length().clamp(1.0 / limit, limit), source, target }
    }

    /// The alignments of part `i` with drawn contour `j`, most likely first, each with the cost of its rotation
    /// relative to the expected one. Also the size of the drawn contour relative to the part's, and its radius in
    /// pixels.
    pub fn ways(&self, i: usize, j: usize, turn: f64) -> (Vec<(Alignment, f64)>, (f64, f64)) {
        let (Some(pair), Some(part)) = (&self.pairs[i][j], &self.parts[i]) else { return (Vec::new(), (1.0, 1.0)) };
        let doubt = |a: &Alignment| SLIDE * wrap(a.turn - turn).powi(2);
        let mut ways: Vec<_> = pair.alignments.iter().map(|a| (*a, doubt(a))).collect();
        ways.sort_by(|(a, p), (b, q)| (a.residual + p).total_cmp(&(b.residual + q)));
        let scale = pair.growth.exp();
        (ways, (scale, part.radius * scale))
    }
}

impl Alignment {
    /// Cost of the shape and of the rotation, for a figure rotated by `figure` radians.
    fn cost(&self, figure: f64) -> f64 {
        let turn = wrap(self.turn - figure);
        SHAPE * self.residual + TURN * turn * turn
    }
}

impl Pair {
    fn new(a: &Outline, b: &Outline, part: &DrawnContour, drawn: &DrawnContour) -> Self {
        let growth = (b.radius / a.radius).ln();
        let length = (b.length.max(1.0) / a.length.max(1.0)).ln() - growth;
        let mut fixed = LENGTH * length * length;
        if let (Some(a), Some(b)) = (part.colour, drawn.colour) {
            fixed += COLOUR * (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
        }
        fixed += LABEL * part.labels.iter().zip(&drawn.labels).filter(|(a, b)| a != b).count() as f64;
        if part.closed && !drawn.closed {
            let gap = drawn.points[0].distance(drawn.points[drawn.points.len() - 1]);
            fixed += CLOSEDNESS * (gap / (WIDE_GAP * b.length.max(1.0))).min(1.0);
        } else if part.closed != drawn.closed {
            fixed += CLOSEDNESS;
        }
        Self { alignments: a.alignments(b), growth, fixed }
    }

    /// The alignment of least cost for a figure's rotation, among those that rotate by at most `limit`.
    fn best(&self, turn: f64, limit: f64) -> Option<&Alignment> {
        let allowed = self.alignments.iter().filter(|a| wrap(a.turn).abs() <= limit);
        allowed.min_by(|a, b| a.cost(turn).total_cmp(&b.cost(turn)))
    }
}

/// Cost of the order of drawing if part `i` of `parts` is drawn contour `j` of `drawn`.
pub(super) fn order(i: usize, parts: usize, j: usize, drawn: usize) -> f64 {
    // 0 for the first contour, 1 for the last.
    let place = |index: usize, count: usize| index as f64 / (count.max(2) - 1) as f64;
    ORDER * (place(i, parts) - place(j, drawn)).abs()
}

/// Mean of the centres.
fn middle(outlines: &[Option<Outline>]) -> Point {
    polygon::center(&outlines.iter().flatten().map(|o| o.centre).collect::<Vec<_>>())
}

/// Root mean square distance of the outlines' samples from the middle; at least 1.
fn spread(outlines: &[Option<Outline>]) -> f64 {
    let middle = middle(outlines);
    let squares: Vec<f64> =
        outlines.iter().flatten().map(|o| o.centre.distance_squared(middle) + o.radius * o.radius).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt().max(1.0)
}
