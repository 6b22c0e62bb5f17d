//! An arm: one direction from a single key. It visits the drawings one after the other and builds hypotheses on each.
//!
//! 1. The chosen pose of the drawing before is carried on, together with its last motion. The best of the other
//!    hypotheses there is carried on too: two chains find more than one, at twice the cost.
//! 2. If all of these fit much worse than usual, or the part is not trusted, the key's appearance is searched in the
//!    complete picture.
//!    So it is where they are on the place of another part, and these are dropped if anything else is found.
//!    So it is behind frames on which the part is absent. There a jump costs nothing.
//! 3. If the artist corrected the drawing, every hypothesis is moved to the corrections. Turned starts are tried too, but not for a
//!    centre near the part: that says where the part is, and not how it is turned.
//! 4. The path of least cost over the last drawings is chosen again. It shows whether the part is still trusted.
//!
//! At the end, late findings are carried back: the chosen pose of each drawing goes to the drawing before, as long as
//! it gives a new and better pose. That closes the gap between the loss of a part and the place where the search found
//! it again. It also lets one pin correct its neighbours.

use super::OutwardJob;
use super::trust::{LEAST_INSIDE, PATIENCE, Sureness};
use crate::contract::error::TrackError;
use crate::contract::job::Correction;
use crate::contract::tracking::Ending;
use crate::rototoon::corrected::is_far;
use crate::rototoon::lattice::anchors::Anchors;
use crate::rototoon::lattice::texture::{Cover, in_picture};
use crate::rototoon::pool::{Hypothesis, is_new};
use crate::rototoon::propagate::{Model, Pose, Scenery};
use crate::rototoon::search::Templates;
use crate::rototoon::select::{Candidate, Smoothness, best_path};
use crate::rototoon::stage::Kit;
use crate::shared::cuts::is_cut;
use crate::shared::features::Features;
use crate::shared::held::same_drawing;
use crate::shared::sought::Sought;
use crate::shared::twins::on_one_place;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Number of drawings over which the path is chosen while the arm grows.
const WINDOW: usize = 10;
/// The search begins where the least energy exceeds the usual one times the first number plus the second.
const WORSE: (f64, f64) = (2.0, 0.004);
/// Additional cost (in √E) of a pose found by searching: a jump must be worth it.
const JUMP: f64 = 0.02;
/// A pose found by searching is accepted if its energy is below this share of the energy of the key's nearest rival.
const RIVALLED: f64 = 0.7;
/// Energy that stands for the key's drawing when the usual energy is computed.
const ORDINARY: f64 = 0.006;
/// Share of visible samples below which continuing the last motion is tried too.
const HARDLY_SEEN: f64 = 0.5;
/// Rotations tried about the corrections' centre, in degrees.
const TURNS: [f64; 8] = [-90.0, -60.0, -40.0, -20.0, 20.0, 40.0, 60.0, 90.0];
/// Number of starts that are aligned on a corrected drawing, and their least mean distance in working pixels.
const STARTS: (usize, f64) = (5, 4.0);

/// A drawing with the hypotheses about the part on it.
pub struct Seen {
    /// The frame nearest to the key that shows it.
    pub near: FrameNumber,
    /// The frame farthest from the key that shows it.
    pub far: FrameNumber,
    /// Features of its picture.
    pub features: Arc<Features>,
    /// The cover: where the part is hidden.
    pub cover: Cover,
    /// Contours on whose place the part cannot be, in working pixels.
    taken: Vec<Vec<Point>>,
    /// Whether the part was absent between the drawing before and this one.
    after_gap: bool,
    /// The artist's correction of the drawing.
    pub correction: Option<Correction>,
    /// The hypotheses; a single one on the key's drawing.
    pub pool: Vec<Hypothesis>,
    /// Additional cost of each hypothesis, in √E.
    dear: Vec<f64>,
    anchors: Anchors,
}

/// The data that both arms of a part share.
pub(super) struct Ground<'a> {
    pub kit: Kit<'a>,
    pub job: &'a OutwardJob,
    pub model: &'a Model,
    /// Control points of the key, in working pixels.
    pub key: &'a [Point],
    pub scale: f64,
    pub width: f64,
    /// The key's appearance, prepared for the search.
    pub templates: Option<&'a Templates>,
    /// See [`rival`].
    pub rival: f64,
}

/// Energy of the key's nearest rival: the least energy of the key's model at any other place in the key's own picture.
/// It shows how well a wrong place can fit. Infinite if no other place was found.
pub(super) fn rival(model: &Model, templates: Option<&Templates>, key: &[Point], picture: &Features) -> f64 {
    let Some(templates) = templates else { return f64::INFINITY };
    let (anchors, mesh) = (Anchors::default(), &model.texture.mesh);
    let scenery = Scenery { features: picture, cover: &model.cover, weighed: true, anchors: &anchors };
    // A round part rotated about itself is not another place.
    let center = polygon::center(key);
    let apart = |nodes: &[Point]| polygon::center(&mesh.control_points(nodes)).distance(center);
    let sought = Sought::new(picture.level(templates.level()));
    let found = templates.find(picture, &sought, model, key).into_iter().map(|start| model.polished(&scenery, &start));
    let others = found.filter(|pose| apart(&pose.nodes) > 0.4 * mesh.size);
    others.map(|pose| pose.energy).fold(f64::INFINITY, f64::min)
}

/// A finished arm.
pub(super) struct Arm {
    pub drawings: Vec<Seen>,
    /// The chosen hypothesis of each drawing.
    pub path: Vec<usize>,
    /// Confidence of the chosen pose of each drawing.
    pub sure: Vec<Sureness>,
    /// The first frame beyond the drawings, and why the arm ends there. None if it reaches the end of the footage.
    pub beyond: Option<(FrameNumber, Ending)>,
    pub steps: usize,
}

struct Growing<'a> {
    ground: &'a Ground<'a>,
    step: FrameNumber,
    drawings: Vec<Seen>,
    path: Vec<usize>,
    sure: Vec<Sureness>,
    pending: Option<(FrameNumber, Arc<Features>)>,
    steps: usize,
}

impl Arm {
    /// Follows the part from the key. `step` is 1 forwards and −1 backwards.
    pub fn grow(ground: &Ground, step: FrameNumber) -> Result<Self, TrackError> {
        let mut growing =
            Growing { ground, step, drawings: Vec::new(), path: Vec::new(), sure: Vec::new(), pending: None, steps: 0 };
        growing.pending = growing.read(ground.job.frame)?;
        let mut beyond = None;
        let mut doubtful = 0;
        while let Some(mut seen) = growing.next_drawing()? {
            let must = growing.corrected_from(seen.near);
            if let Some(before) = growing.drawings.last()
                && !must
                && is_cut(&*ground.kit.colours(before.near)?, &*ground.kit.colours(seen.near)?)
            {
                beyond = Some((seen.near, Ending::Cut));
                break;
            }
            (seen.pool, seen.dear) = growing.proposed(&seen, doubtful > 0)?.into_iter().unzip();
            growing.drawings.push(seen);
            let now = growing.judge();
            if let Some(last) = (!must && now.trusted()).then(|| growing.left_after()).flatten() {
                beyond = Some((growing.drawings[last + 1].near, Ending::Left));
                growing.forget_beyond(last);
                break;
            }
            let left = now.inside < LEAST_INSIDE && doubtful == 0 && growing.was_leaving();
            doubtful = if now.trusted() { 0 } else { doubtful + 1 };
            if !must && (left || doubtful >= PATIENCE) {
                let near = growing.drawings.last().map_or(ground.job.frame, |seen| seen.near);
                beyond = Some((near, if left { Ending::Left } else { Ending::Lost }));
                break;
            }
        }
        growing.carry_back()?;
        growing.path = growing.best(0);
        growing.sure = (0..growing.drawings.len()).map(|d| growing.sureness(d)).collect();
        let Growing { drawings, path, sure, steps, .. } = growing;
        Ok(Self { drawings, path, sure, beyond, steps })
    }
}

impl Growing<'_> {
    /// The frame, or the next one on which the part is not absent, with its features. None beyond the footage.
    fn read(&self, frame: FrameNumber) -> Result<Option<(FrameNumber, Arc<Features>)>, TrackError> {
        let job = self.ground.job;
        let (footage, absent) = (job.footage[0]..=job.footage[1], |frame| {
            frame != job.frame && job.absent.iter().any(|&[first, last]| (first..=last).contains(&frame))
        });
        let mut frame = frame;
        while footage.contains(&frame) && absent(frame) {
            frame += self.step;
        }
        if !footage.contains(&frame) {
            return Ok(None);
        }
        let kit = self.ground.kit;
        kit.progress.report("Tracking", 0.0)?;
        Ok(Some((frame, kit.store.features(kit.frames, frame)?)))
    }

    /// Whether the artist corrected `frame` or a frame beyond it.
    fn corrected_from(&self, frame: FrameNumber) -> bool {
        self.ground.job.corrections.keys().any(|&f| (f - frame) * self.step >= 0)
    }

    /// The next drawing with all frames held from it, still without hypotheses.
    fn next_drawing(&mut self) -> Result<Option<Seen>, TrackError> {
        let Some((near, features)) = self.pending.take() else { return Ok(None) };
        let job = self.ground.job;
        let is_key = near == job.frame;
        let mut correction = job.corrections.get(&near);
        let mut far = near;
        loop {
            self.pending = self.read(far + self.step)?;
            let Some((frame, _)) = &self.pending else { break };
            let own = job.corrections.get(frame);
            let contradicts = own.is_some() && (is_key || correction.is_some_and(|known| Some(known) != own));
            if *frame != far + self.step || contradicts || !self.is_held(near, far, *frame)? {
                break;
            }
            correction = correction.or(own);
            far = *frame;
        }
        let working = |of: &BTreeMap<FrameNumber, Vec<Vec<Point>>>| -> Vec<Vec<Point>> {
            let contours = of.get(&near).map_or(&[][..], Vec::as_slice);
            contours.iter().map(|c| c.iter().map(|&p| p / self.ground.scale).collect()).collect()
        };
        let mesh = &self.ground.model.texture.mesh;
        let anchors = correction.map_or_else(Anchors::default, |c| Anchors::new(mesh, c, self.ground.scale));
        let cover = Cover::new(&working(&job.occluders), self.ground.width);
        Ok(Some(Seen {
            near,
            far,
            features,
            cover,
            taken: if correction.is_none() && !is_key { working(&job.taken) } else { Vec::new() },
            after_gap: self.drawings.last().is_some_and(|before| before.far + self.step != near),
            correction: correction.cloned(),
            pool: Vec::new(),
            dear: Vec::new(),
            anchors,
        }))
    }

    /// Whether a frame shows the drawing of the frames from `near` to `far`.
    fn is_held(&self, near: FrameNumber, far: FrameNumber, frame: FrameNumber) -> Result<bool, TrackError> {
        let kit = self.ground.kit;
        let same = |a: FrameNumber| Ok::<_, TrackError>(same_drawing(&*kit.colours(a)?, &*kit.colours(frame)?));
        Ok(same(far)? && (far == near || same(near)?))
    }

    fn hypothesis(&self, seen: &Seen, pose: Pose) -> Hypothesis {
        let model = self.ground.model;
        let points = model.texture.mesh.control_points(&pose.nodes);
        let differences = model.differences(&seen.scenery(), &pose.nodes);
        Hypothesis::new(0, pose, points, differences)
    }

    /// The hypotheses of the next drawing, each with its additional cost.
    fn proposed(&mut self, seen: &Seen, doubtful: bool) -> Result<Vec<(Hypothesis, f64)>, TrackError> {
        let model = self.ground.model;
        if self.drawings.is_empty() {
            let pose = model.measured(&seen.scenery(), model.texture.mesh.rest.clone());
            return Ok(vec![(self.hypothesis(seen, pose), 0.0)]);
        }
        let mut pool = self.carried(seen)?;
        let carried = pool.len();
        let least = pool.iter().map(|h| h.pose.energy).fold(f64::INFINITY, f64::min);
        let taken = pool.iter().any(|h| seen.is_taken(h));
        if taken || doubtful || seen.after_gap || least > WORSE.0 * self.usual_energy() + WORSE.1 {
            for start in self.searched(seen)? {
                let pose = model.polished(&seen.scenery(), &start);
                let new = self.hypothesis(seen, pose);
                if new.pose.energy < RIVALLED * self.ground.rival && is_new(&pool, &new) {
                    pool.push(new);
                }
            }
        }
        if seen.correction.is_some() {
            return Ok(self.constrained(seen, &pool).into_iter().map(|h| (h, 0.0)).collect());
        }
        let price = |i: usize| if i < carried || seen.after_gap { 0.0 } else { JUMP };
        let priced: Vec<(Hypothesis, f64)> = pool.into_iter().enumerate().map(|(i, h)| (h, price(i))).collect();
        let (there, free): (Vec<_>, Vec<_>) = priced.into_iter().partition(|(h, _)| seen.is_taken(h));
        Ok(if free.is_empty() { there } else { free })
    }

    /// Hypotheses carried from the drawing before.
    fn carried(&mut self, seen: &Seen) -> Result<Vec<Hypothesis>, TrackError> {
        let last = self.drawings.len() - 1;
        let before = &self.drawings[last];
        let chosen = &before.pool[self.path[last]];
        let moved: Option<Vec<Point>> = (last > 0).then(|| {
            let earlier = &self.drawings[last - 1].pool[self.path[last - 1]];
            chosen.pose.nodes.iter().zip(&earlier.pose.nodes).map(|(a, b)| *a - *b).collect()
        });
        let other = (before.pool.iter().enumerate().filter(|(h, _)| *h != self.path[last]))
            .min_by(|(_, a), (_, b)| a.pose.energy.total_cmp(&b.pose.energy));
        let mut pool = vec![self.hypothesis(seen, self.carry(chosen, moved.as_deref(), before, seen)?)];
        self.steps += 1;
        if let Some((_, other)) = other {
            let new = self.hypothesis(seen, self.carry(other, None, before, seen)?);
            self.steps += 1;
            if is_new(&pool, &new) {
                pool.push(new);
            }
        }
        if self.sure[last].seen < HARDLY_SEEN
            && let Some(moved) = moved
        {
            let on = chosen.pose.nodes.iter().zip(&moved).map(|(a, b)| *a + *b).collect();
            let new = self.hypothesis(seen, self.ground.model.measured(&seen.scenery(), on));
            if is_new(&pool, &new) {
                pool.push(new);
            }
        }
        Ok(pool)
    }

    fn carry(&self, from: &Hypothesis, moved: Option<&[Point]>, at: &Seen, to: &Seen) -> Result<Pose, TrackError> {
        let kit = self.ground.kit;
        let flow = kit.store.flow(kit.frames, at.near, to.near)?;
        Ok(self.ground.model.carry(&from.pose.nodes, Some(&flow), moved, &to.scenery()))
    }

    /// Median energy of the chosen hypotheses of the last five drawings.
    fn usual_energy(&self) -> f64 {
        let mut known: Vec<f64> = (self.drawings.iter().zip(&self.path).rev().take(5))
            .map(|(seen, &h)| if seen.near == self.ground.job.frame { ORDINARY } else { seen.pool[h].pose.energy })
            .collect();
        known.sort_by(f64::total_cmp);
        known.get(known.len() / 2).copied().unwrap_or(0.0)
    }

    fn searched(&self, seen: &Seen) -> Result<Vec<Vec<Point>>, TrackError> {
        let Ground { kit, model, key, templates, .. } = *self.ground;
        kit.progress.report("Searching", 0.0)?;
        let Some(templates) = templates else { return Ok(Vec::new()) };
        let sought = kit.store.sought(kit.frames, seen.near, templates.level())?;
        Ok(templates.find(&seen.features, &sought, model, key))
    }

    /// The hypotheses of a corrected drawing, moved to the corrections.
    fn constrained(&self, seen: &Seen, pool: &[Hypothesis]) -> Vec<Hypothesis> {
        let (model, scenery) = (self.ground.model, seen.scenery());
        let settler = model.settler(&scenery);
        let settled = |nodes: &[Point]| model.measured(&scenery, settler.settle(nodes));
        let turns: &[f64] = if self.is_exact_place(seen, &pool[0]) { &[] } else { &TURNS };
        let mut starts: Vec<Pose> = Vec::new();
        for h in pool {
            starts.push(model.drawn(&scenery, &h.pose.nodes, &h.differences));
            starts.push(settled(&h.pose.nodes));
            let turned = turns.iter().map(|degrees| seen.anchors.turned(&h.pose.nodes, degrees.to_radians()));
            starts.extend(turned.map(|nodes| settled(&nodes)));
        }
        starts.sort_by(|a, b| a.energy.total_cmp(&b.energy));
        let mut kept: Vec<Hypothesis> = Vec::new();
        for start in starts {
            let start = self.hypothesis(seen, start);
            if kept.len() < STARTS.0 && kept.iter().all(|h| h.distance(&start) > STARTS.1) {
                kept.push(start);
            }
        }
        let mut found: Vec<Hypothesis> = Vec::new();
        for start in kept {
            let new = self.hypothesis(seen, model.realigned(&scenery, &start.pose.nodes));
            if is_new(&found, &new) {
                found.push(new);
            }
        }
        found
    }

    /// Whether the correction of a drawing is only a centre near the part, which was carried there. It says where the part is,
    /// and nothing of its rotation.
    fn is_exact_place(&self, seen: &Seen, carried: &Hypothesis) -> bool {
        let (size, scale) = (self.ground.model.texture.mesh.size, self.ground.scale);
        let center = seen.correction.as_ref().filter(|correction| correction.pins.is_empty()).and_then(|c| c.center);
        center.is_some_and(|center| !is_far(&carried.points, center / scale, size))
    }

    /// Chooses the path over the last drawings, and returns the confidence on the last one.
    fn judge(&mut self) -> Sureness {
        let from = self.drawings.len().saturating_sub(WINDOW);
        let path = self.best(from);
        self.path.truncate(from);
        self.path.extend(path);
        let last = self.sureness(self.drawings.len() - 1);
        self.sure.push(last.clone());
        last
    }

    /// Whether the part reached beyond the picture's edge on the drawing before the last, or would have after one more
    /// step of its motion. If not, it was not about to leave, and a pose outside only hides that the part is lost.
    fn was_leaving(&self) -> bool {
        let Some(before) = self.drawings.len().checked_sub(2) else { return false };
        let points = |d: usize| &self.drawings[d].pool[self.path[d]].points;
        let earlier = points(before.saturating_sub(1));
        let moved = points(before).iter().zip(earlier).map(|(p, q)| *p * 2.0 - *q);
        points(before).iter().copied().chain(moved).any(|p| !in_picture(p, self.ground.width))
    }

    /// The last drawing before the part left the picture, though the path goes on elsewhere: from there its motion would have taken it out by
    /// half or more, and on the next trusted drawing it is more than its size away. What was found is something else.
    fn left_after(&self) -> Option<usize> {
        // Behind a correction the artist says where the part is.
        let corrected = self.drawings.iter().rposition(|seen| seen.correction.is_some()).unwrap_or(0);
        let drawings = self.drawings.len().saturating_sub(WINDOW).max(corrected)..self.drawings.len();
        let size = self.ground.model.texture.mesh.size;
        let points = |d: usize| &self.drawings[d].pool[self.path[d]].points;
        let far = |d: usize, there: &[Point]| polygon::center(points(d)).distance(polygon::center(there)) > size;
        if !drawings.clone().skip(1).any(|d| far(d, points(d - 1))) {
            return None;
        }
        let trusted: Vec<usize> = drawings.filter(|&d| self.sureness(d).trusted()).collect();
        let leaves = |&&[last, next]: &&[usize; 2]| {
            let expected = |(p, q): (&Point, &Point)| *p + (*p - *q) * (next - last) as f64;
            let expected: Vec<Point> = points(last).iter().zip(points(last.saturating_sub(1))).map(expected).collect();
            let inside = expected.iter().filter(|&&p| in_picture(p, self.ground.width)).count();
            // From the key alone, and behind a gap, the motion is not known.
            let gap = last == 0 || self.drawings[last..=next].iter().any(|seen| seen.after_gap);
            2 * inside < expected.len() && far(next, points(last)) && far(next, &expected) && !gap
        };
        trusted.array_windows().find(leaves).map(|&[last, _]| last)
    }

    /// Forgets the drawings beyond one.
    fn forget_beyond(&mut self, last: usize) {
        self.drawings.truncate(last + 1);
        self.path.truncate(last + 1);
        self.sure.truncate(last + 1);
    }

    fn best(&self, from: usize) -> Vec<usize> {
        let candidates: Vec<Vec<Candidate>> = self.drawings[from..].iter().map(Seen::candidates).collect();
        let gaps: Vec<usize> = (1..candidates.len()).filter(|d| self.drawings[from + d].after_gap).collect();
        best_path(&candidates, Smoothness::new(self.ground.model.texture.mesh.size), &gaps)
    }

    fn sureness(&self, d: usize) -> Sureness {
        let seen = &self.drawings[d];
        let chosen = &seen.pool[self.path[d]];
        let sure = Sureness::of(self.ground.model, self.ground.rival, &seen.scenery(), chosen);
        if seen.is_taken(chosen) { sure.untrusted() } else { sure }
    }

    /// Carries late findings back towards the key.
    fn carry_back(&mut self) -> Result<(), TrackError> {
        self.path = self.best(0);
        let mut fresh: Option<Hypothesis> = None;
        for d in (2..self.drawings.len()).rev() {
            let (to, from) = (&self.drawings[d - 1], &self.drawings[d]);
            let source = fresh.take().unwrap_or_else(|| from.pool[self.path[d]].clone());
            let known = &to.pool[self.path[d - 1]];
            // Where the path is smooth and fits on both sides, nothing needs correction.
            let smooth = known.distance(&source) < 0.5 * self.ground.model.texture.mesh.size
                && known.pose.energy < WORSE.0 * source.pose.energy + WORSE.1;
            if to.correction.is_some() || from.after_gap || (smooth && from.correction.is_none()) {
                continue;
            }
            let new = self.hypothesis(to, self.carry(&source, None, from, to)?);
            self.steps += 1;
            if is_new(&to.pool, &new) && !to.is_taken(&new) {
                fresh = (new.pose.energy < known.pose.energy).then(|| new.clone());
                self.drawings[d - 1].pool.push(new);
                self.drawings[d - 1].dear.push(0.0);
            }
        }
        Ok(())
    }
}

impl Seen {
    fn candidates(&self) -> Vec<Candidate<'_>> {
        let priced = self.pool.iter().zip(&self.dear);
        priced.map(|(h, dear)| Candidate { cost: h.pose.energy.max(0.0).sqrt() + dear, points: &h.points }).collect()
    }

    /// Whether a hypothesis is on the place of another part.
    fn is_taken(&self, hypothesis: &Hypothesis) -> bool {
        self.taken.iter().any(|contour| on_one_place(contour, &hypothesis.points))
    }

    /// The drawing as input for the key's model.
    pub fn scenery(&self) -> Scenery<'_> {
        Scenery { features: &self.features, cover: &self.cover, weighed: true, anchors: &self.anchors }
    }
}
