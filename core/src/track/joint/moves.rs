//! Moves that lower the joint energy: the whole path of one part, or of two parts at once.

use super::Contender;
use super::shadow::Shadows;
use super::tie::Tie;
use crate::track::select::{Candidate, Smoothness, best_path};

/// Hypotheses of each part that a move of two weighs on a drawing.
const STATES: usize = 6;

/// What is decided about.
pub struct Scene<'a> {
    /// The parts with their hypotheses.
    pub contenders: &'a [Contender<'a>],
    /// Who hides whom.
    pub shadows: &'a Shadows,
    /// Who hangs on whom.
    pub ties: &'a [Tie],
}

impl Scene<'_> {
    /// √U of hypothesis `h` of contender `c` on drawing `d`, given the choices of the others; `other` replaces a choice.
    fn look(&self, c: usize, d: usize, h: usize, paths: &[Vec<usize>], other: &[(usize, usize)]) -> f64 {
        let frame = self.contenders[c].frame_of(d);
        let mut hidden = vec![0u64; self.shadows.words(c, d, h)];
        for n in 0..self.contenders.len() {
            if n == c {
                continue;
            }
            let replaced = other.iter().find(|(who, _)| *who == n).map(|(_, choice)| *choice);
            let Some(choice) =
                replaced.or_else(|| self.contenders[n].drawing_at(frame).map(|near| paths[n][near]))
            else {
                continue;
            };
            if let Some(mask) = self.shadows.mask((c, n), d, h, choice) {
                hidden.iter_mut().zip(mask).for_each(|(all, one)| *all |= one);
            }
        }
        self.shadows.cost(c, d, h, &hidden)
    }

    /// What the joints of contender `c` cost on its drawing `d` if it follows `h`, those with `but` left out.
    fn joints(&self, c: usize, d: usize, h: usize, paths: &[Vec<usize>], but: usize) -> f64 {
        let cost = |tie: &Tie| {
            let (other, _) = tie.other(c).filter(|(other, _)| *other != but)?;
            let near = self.contenders[other].drawing_at(self.contenders[c].frame_of(d))?;
            Some(self.joint(tie, c, (d, h), (near, paths[other][near])))
        };
        self.ties.iter().filter_map(cost).sum()
    }

    /// What one joint of contender `c` costs; drawing and hypothesis of either part.
    fn joint(&self, tie: &Tie, c: usize, own: (usize, usize), others: (usize, usize)) -> f64 {
        let Some((other, end)) = tie.other(c) else { return 0.0 };
        let place = |c: usize, end: usize, (d, h): (usize, usize)| {
            let hypothesis = &self.contenders[c].pools[d][h];
            tie.place(end, hypothesis.model, &hypothesis.pose.nodes)
        };
        Tie::cost(place(c, end, own), place(other, 1 - end, others))
    }

    /// The contenders that `near` may hide.
    fn behind(&self, near: usize) -> impl Iterator<Item = usize> {
        self.shadows.pairs().into_iter().filter(move |&(_, n)| n == near).map(|(far, _)| far)
    }

    /// What the parts behind `c` cost on its drawing `d` if it follows `h`; those in `but` are left out.
    fn look_behind(&self, c: usize, d: usize, h: usize, paths: &[Vec<usize>], but: usize) -> f64 {
        let mut sum = 0.0;
        for far in self.behind(c).filter(|&far| far != but) {
            for (e, _) in self.contenders[far].drawings.iter().enumerate() {
                if self.contenders[c].drawing_at(self.contenders[far].frame_of(e)) == Some(d) {
                    sum += self.look(far, e, paths[far][e], paths, &[(c, h)]);
                }
            }
        }
        sum
    }

    fn smoothness(&self, c: usize) -> Smoothness {
        Smoothness::new(self.contenders[c].models[0].texture.mesh.size)
    }

    fn candidates(&self, c: usize, costs: &[Vec<f64>]) -> Vec<Vec<Candidate<'_>>> {
        self.contenders[c]
            .pools
            .iter()
            .zip(costs)
            .map(|(pool, costs)| {
                pool.iter().zip(costs).map(|(h, &cost)| Candidate { cost, points: &h.points }).collect()
            })
            .collect()
    }

    /// The energy of the terms that the choices of the contenders in `who` touch.
    fn energy(&self, who: &[usize], paths: &[Vec<usize>]) -> f64 {
        let mut touched: Vec<usize> = who.to_vec();
        who.iter().for_each(|&c| touched.extend(self.behind(c)));
        touched.sort_unstable();
        touched.dedup();
        let looks = |&c: &usize| (0..paths[c].len()).map(|d| self.look(c, d, paths[c][d], paths, &[])).sum::<f64>();
        let smooth = |&c: &usize| {
            let points: Vec<&[crate::geometry::Point]> =
                paths[c].iter().zip(self.contenders[c].pools).map(|(&h, pool)| &pool[h].points[..]).collect();
            self.smoothness(c).of_path(&points)
        };
        let torn = |(i, &c): (usize, &usize)| {
            // A joint between two of those asked for counts once.
            let cost = |tie: &Tie| {
                let (other, _) = tie.other(c).filter(|(other, _)| !who[..i].contains(other))?;
                let on = |d: usize| {
                    let near = self.contenders[other].drawing_at(self.contenders[c].frame_of(d))?;
                    Some(self.joint(tie, c, (d, paths[c][d]), (near, paths[other][near])))
                };
                Some((0..paths[c].len()).filter_map(on).sum::<f64>())
            };
            self.ties.iter().filter_map(cost).sum::<f64>()
        };
        touched.iter().map(looks).sum::<f64>()
            + who.iter().map(smooth).sum::<f64>()
            + who.iter().enumerate().map(torn).sum::<f64>()
    }

    /// The best path of one contender, the others held. Whether it changed.
    pub fn single(&self, c: usize, paths: &mut [Vec<usize>]) -> bool {
        let costs: Vec<Vec<f64>> = (self.contenders[c].pools.iter().enumerate())
            .map(|(d, pool)| {
                let cost =
                    |h: usize| self.look(c, d, h, paths, &[]) + self.look_behind(c, d, h, paths, usize::MAX)
                        + self.joints(c, d, h, paths, usize::MAX);
                (0..pool.len()).map(cost).collect()
            })
            .collect();
        let path = best_path(&self.candidates(c, &costs), self.smoothness(c));
        self.take(&[(c, path)], paths)
    }

    /// The best paths of a far and a near contender of the same drawings, the others held. Whether they changed.
    pub fn pair(&self, far: usize, near: usize, paths: &mut [Vec<usize>]) -> bool {
        let drawings = self.contenders[far].pools.len();
        let states = |c: usize| -> Vec<Vec<usize>> { (0..drawings).map(|d| self.states(c, d, paths)).collect() };
        let (of_far, of_near) = (states(far), states(near));
        let look = |d: usize, f: usize, n: usize| self.look(far, d, f, paths, &[(near, n)]);
        let own = |c: usize, d: usize, h: usize, but: usize| {
            let own = if c == near { self.look(c, d, h, paths, &[]) } else { 0.0 };
            own + self.look_behind(c, d, h, paths, but) + self.joints(c, d, h, paths, but)
        };
        let costs: Vec<Vec<f64>> = (0..drawings)
            .map(|d| {
                let far_own: Vec<f64> = of_far[d].iter().map(|&f| own(far, d, f, near)).collect();
                let near_own: Vec<f64> = of_near[d].iter().map(|&n| own(near, d, n, far)).collect();
                let mut table = Vec::new();
                for (i, &f) in of_far[d].iter().enumerate() {
                    for (j, &n) in of_near[d].iter().enumerate() {
                        let tie = self.ties.iter().find(|t| t.other(far).is_some_and(|(o, _)| o == near));
                        let torn = tie.map_or(0.0, |t| self.joint(t, far, (d, f), (d, n)));
                        table.push(look(d, f, n) + far_own[i] + near_own[j] + torn);
                    }
                }
                table
            })
            .collect();
        let best = self.best_pair((far, &of_far), (near, &of_near), &costs);
        let split = |of: &[Vec<usize>], which: fn(usize, usize) -> usize| -> Vec<usize> {
            best.iter().enumerate().map(|(d, &s)| of[d][which(s, of_near[d].len())]).collect()
        };
        let far_path = split(&of_far, |s, n| s / n);
        let near_path = split(&of_near, |s, n| s % n);
        self.take(&[(far, far_path), (near, near_path)], paths)
    }

    /// The hypotheses of a drawing that a move of two weighs: the present one and those of least energy.
    fn states(&self, c: usize, d: usize, paths: &[Vec<usize>]) -> Vec<usize> {
        let pool = &self.contenders[c].pools[d];
        let mut order: Vec<usize> = (0..pool.len()).collect();
        order.sort_by(|&a, &b| pool[a].pose.energy.total_cmp(&pool[b].pose.energy));
        order.retain(|&h| h != paths[c][d]);
        order.truncate(STATES - 1);
        order.push(paths[c][d]);
        order
    }

    /// Second-order dynamic programming over pairs of states; the index of the pair on each drawing.
    fn best_pair(
        &self,
        (far, of_far): (usize, &[Vec<usize>]),
        (near, of_near): (usize, &[Vec<usize>]),
        costs: &[Vec<f64>],
    ) -> Vec<usize> {
        let smooth = [self.smoothness(far), self.smoothness(near)];
        let points = |which: usize, d: usize, i: usize| {
            let (c, of) = if which == 0 { (far, of_far) } else { (near, of_near) };
            &self.contenders[c].pools[d][of[d][i]].points[..]
        };
        let count = |which: usize, d: usize| if which == 0 { of_far[d].len() } else { of_near[d].len() };
        let speed = |which: usize, d: usize| -> Vec<f64> {
            let mut table = Vec::new();
            for g in 0..count(which, d - 1) {
                for h in 0..count(which, d) {
                    table.push(smooth[which].speed(points(which, d - 1, g), points(which, d, h)));
                }
            }
            table
        };
        let bend = |which: usize, d: usize| -> Vec<f64> {
            let mut table = Vec::new();
            for f in 0..count(which, d - 2) {
                for g in 0..count(which, d - 1) {
                    for h in 0..count(which, d) {
                        let at = [points(which, d - 2, f), points(which, d - 1, g), points(which, d, h)];
                        table.push(smooth[which].acceleration(at[0], at[1], at[2]));
                    }
                }
            }
            table
        };
        let drawings = costs.len();
        let step = |d: usize, speeds: &[Vec<f64>; 2], g: usize, h: usize| {
            let (n, m) = (count(1, d - 1), count(1, d));
            costs[d][h] + speeds[0][(g / n) * count(0, d) + h / m] + speeds[1][(g % n) * m + h % m]
        };
        let speeds = [speed(0, 1), speed(1, 1)];
        let mut least: Vec<Vec<f64>> = (0..costs[0].len())
            .map(|g| (0..costs[1].len()).map(|h| costs[0][g] + step(1, &speeds, g, h)).collect())
            .collect();
        let mut origins: Vec<Vec<Vec<usize>>> = Vec::new();
        for d in 2..drawings {
            let (bends, speeds) = ([bend(0, d), bend(1, d)], [speed(0, d), speed(1, d)]);
            let (e, n, m) = (count(1, d - 2), count(1, d - 1), count(1, d));
            let (far_g, far_h) = (count(0, d - 1), count(0, d));
            let mut next = vec![vec![f64::INFINITY; costs[d].len()]; costs[d - 1].len()];
            let mut from = vec![vec![0; costs[d].len()]; costs[d - 1].len()];
            for g in 0..costs[d - 1].len() {
                for h in 0..costs[d].len() {
                    let own = step(d, &speeds, g, h);
                    for f in 0..costs[d - 2].len() {
                        let far_bend = bends[0][((f / e) * far_g + g / n) * far_h + h / m];
                        let near_bend = bends[1][((f % e) * n + g % n) * m + h % m];
                        let cost = least[f][g] + far_bend + near_bend + own;
                        if cost < next[g][h] {
                            (next[g][h], from[g][h]) = (cost, f);
                        }
                    }
                }
            }
            least = next;
            origins.push(from);
        }
        crate::track::select::trace_back(&least, &origins)
    }

    /// Takes new paths if the energy falls.
    fn take(&self, new: &[(usize, Vec<usize>)], paths: &mut [Vec<usize>]) -> bool {
        if new.iter().all(|(c, path)| paths[*c] == *path) {
            return false;
        }
        let who: Vec<usize> = new.iter().map(|(c, _)| *c).collect();
        let before = self.energy(&who, paths);
        let old: Vec<Vec<usize>> = new.iter().map(|(c, path)| std::mem::replace(&mut paths[*c], path.clone())).collect();
        if self.energy(&who, paths) < before - 1e-9 {
            return true;
        }
        new.iter().zip(old).for_each(|((c, _), path)| paths[*c] = path);
        false
    }
}
