//! The figure: what the picture shows in colours that only parts have, and what of it the chosen places leave unexplained.
//!
//! **Why.** The cost of a hypothesis asks whether the part's colours are where it puts the part. It does not ask what else has
//! them. A leg fits well on top of the other leg, and a long arm fits well into the half of itself that is nearest. What
//! gives both away is a leg or half an arm that nobody explains.
//!
//! **How.** At the keys the parts' places are known, so a colour of which at least three quarters lie inside contours is one
//! that parts alone have ([`canvas`]). Blocks in such colours are the figure. What a choice explains of a drawing's figure
//! are the blocks inside its contours. At the keys some of it stays unexplained too: details that nobody has drawn
//! contours around. So the cost of a drawing is
//!
//! 0.15 · min(max(0, u − u₀) / a, 1)
//!
//! with u the unexplained blocks, u₀ the larger number of the span's two keys, and a the area of the part that moves (the
//! smaller one of two). So a leg's length counts the same for a small leg as for a large one. Further hypotheses are
//! looked for where something is left ([`claims`]).
//!
//! **Limits.** It is for flat colours. Lines have paper inside, and light moves colours from step to step. Contours with
//! corrective keys are not chosen anew by it. As the area is that of the part, the cost is no energy of the scene, and a
//! round of moves may undo another one; the number of rounds is bounded.

pub mod blocks;
pub mod canvas;
pub mod claims;
pub mod covered;
#[cfg(test)]
mod tests;

use super::contender::{Contender, Paths, State};
use super::shadow::Memory;
use blocks::{BLOCK, Blocks};
use canvas::Canvas;
use claims::Claims;
use covered::Covered;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Cost of a drawing on which as much is unexplained as the part is large.
const WEIGHT: f64 = 0.15;
/// The least area of a part that counts, in square working pixels.
const LEAST_AREA: f64 = 64.0;

/// What each hypothesis of each contender explains.
pub struct Figure {
    canvas: Arc<Canvas>,
    /// By contender; none if it hides nothing.
    covered: Vec<Option<Arc<Covered>>>,
    /// By contender: its area in blocks, and the unexplained blocks at its keys.
    areas: Vec<f64>,
    usual: Vec<usize>,
}

/// What the others leave of the figure on a drawing of one or two contenders.
pub struct Rest {
    left: Blocks,
    total: usize,
    usual: usize,
    area: f64,
}

impl Figure {
    /// The figure of a canvas, for a choice of these contenders.
    pub fn new(canvas: &Arc<Canvas>, contenders: &[Contender], memory: &mut Memory) -> Self {
        let covered = memory.covered(contenders, canvas.size);
        let area = |c: &Contender| {
            let sizes = c.models.each_ref().map(|model| (model.texture.mesh.size - 1.0).powi(2));
            (0.5 * (sizes[0] + sizes[1])).max(LEAST_AREA) / (BLOCK * BLOCK)
        };
        let areas = contenders.iter().map(area).collect();
        let mut figure = Self { canvas: canvas.clone(), covered, areas, usual: Vec::new() };
        figure.usual = contenders.iter().map(|c| figure.usual_of(c, contenders)).collect();
        figure
    }

    /// What is left for the contenders in `who` on the drawing `d` of the first of them. The others are where the paths say.
    pub fn rest(&self, contenders: &[Contender], (who, d): (&[usize], usize), paths: &Paths) -> Rest {
        let frame = contenders[who[0]].frame_of(d);
        let states = (0..contenders.len()).filter(|k| !who.contains(k)).filter_map(|k| {
            let e = contenders[k].drawing_at(frame)?;
            Some((k, (e, paths[k][e])))
        });
        let left = self.left(frame, states);
        let area = who.iter().map(|&c| self.areas[c]).fold(f64::INFINITY, f64::min);
        Rest { total: left.count(), left, usual: self.usual[who[0]], area }
    }

    /// Cost of what stays unexplained of a rest with these states.
    pub fn cost(&self, rest: &Rest, states: &[(usize, State)]) -> f64 {
        let explained = match *states {
            [one] => self.blocks(one).map_or(0, |blocks| rest.left.shared(blocks)),
            _ => {
                let mut left = rest.left.clone();
                states.iter().filter_map(|&state| self.blocks(state)).for_each(|blocks| left.remove(blocks));
                rest.total - left.count()
            }
        };
        let unexplained = (rest.total - explained).saturating_sub(rest.usual) as f64;
        WEIGHT * (unexplained / rest.area).min(1.0)
    }

    /// Cost of what the paths leave of the figure on a frame, where the contenders in `who` are those that move.
    pub fn on_frame(&self, contenders: &[Contender], (who, frame): (&[usize], FrameNumber), paths: &Paths) -> f64 {
        let states = (0..contenders.len()).filter_map(|k| {
            let d = contenders[k].drawing_at(frame)?;
            Some((k, (d, paths[k][d])))
        });
        let left = self.left(frame, states).count();
        let here = || who.iter().copied().filter(|&c| contenders[c].drawing_at(frame).is_some());
        let area = here().map(|c| self.areas[c]).fold(f64::INFINITY, f64::min);
        let usual = here().map(|c| self.usual[c]).max().unwrap_or(0);
        WEIGHT * (left.saturating_sub(usual) as f64 / area).min(1.0)
    }

    /// Which blocks each part covers on these paths.
    pub fn claims(&self, contenders: &[Contender], names: &[&str], paths: &Paths) -> Claims {
        let mut parts: BTreeMap<String, BTreeMap<FrameNumber, Blocks>> = BTreeMap::new();
        for frame in self.canvas.frames() {
            for (c, name) in names.iter().enumerate() {
                let Some(d) = contenders[c].drawing_at(frame) else { continue };
                let Some(blocks) = self.blocks((c, (d, paths[c][d]))) else { continue };
                parts.entry((*name).to_owned()).or_default().insert(frame, blocks.clone());
            }
        }
        Claims { canvas: self.canvas.clone(), parts }
    }

    /// The unexplained blocks at the keys of a contender, where the other parts have keys too: the larger number.
    fn usual_of(&self, own: &Contender, contenders: &[Contender]) -> usize {
        let at = |d: usize| {
            let frame = own.frame_of(d);
            let keyed = contenders.iter().enumerate().filter_map(|(k, other)| {
                let e = other.drawing_at(frame)?;
                (e == 0 || e + 1 == other.pools.len()).then_some((k, (e, 0)))
            });
            self.left(frame, keyed).count()
        };
        at(0).max(at(own.pools.len() - 1))
    }

    /// The figure on the drawing that begins at a frame, without what the states cover.
    fn left(&self, frame: FrameNumber, states: impl Iterator<Item = (usize, State)>) -> Blocks {
        let mut left = self.canvas.at(frame).cloned().unwrap_or_default();
        states.filter_map(|state| self.blocks(state)).for_each(|blocks| left.remove(blocks));
        left
    }

    fn blocks(&self, (c, (d, h)): (usize, State)) -> Option<&Blocks> {
        Some(&self.covered[c].as_ref()?[d][h])
    }
}
