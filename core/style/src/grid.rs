//! The known clips as a grid of characters × motions, in one frame: pelvis at the origin, torso length 1.
//!
//! Division by the character's torso (by that of each framing, the module `framing`) and removal of the pelvis are the global half of the paper's unification (Liang et
//! al. 2012, eq. 4), limbs of the content's lengths the other (the module `build`).
//!
//! Every clip of a motion is brought to one number of frames: that of the content's clip, or that of the motion's first
//! clip if the content's character lacks the motion. Clips of that length count as aligned. Other clips are aligned by
//! time warping first.

use super::align;
use super::build::{self, Build};
use super::framing::Framings;
use super::{Request, StyleError};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Clip;
use rototoon_base::scene::clip::resample;
use rototoon_base::scene::skeleton::{COUNT, Posture, torso};

/// Numbers in a posture: x and y of each key point.
pub(super) const WIDTH: usize = 2 * COUNT;

/// A posture as numbers: x, then y, of each key point.
pub(super) type Row = [f64; WIDTH];

/// The clips that a translation learns from, without the requested one.
pub(super) struct Grid {
    /// Names in the order of their first clips.
    pub characters: Vec<String>,
    /// The requested motion and the motions that at least two characters show.
    pub motions: Vec<String>,
    /// Index of the style's character.
    pub style: usize,
    /// Index of the content's character.
    pub content: usize,
    /// Index of the requested motion.
    pub motion: usize,
    /// Torso lengths of each character in the unit of its clips.
    pub framings: Vec<Framings>,
    /// Frames of the content's clip.
    pub frames: usize,
    /// Build of each character beside the content's. The clips have the content's.
    pub builds: Vec<Build>,
    clips: Vec<Option<Vec<Posture>>>,
}

impl Grid {
    /// Checks the clips and the request, and sorts the clips into the grid.
    pub fn new(clips: &[Clip], request: &Request) -> Result<Self, StyleError> {
        check(clips, request)?;
        let mut characters: Vec<String> = Vec::new();
        for clip in clips {
            if !characters.contains(&clip.character) {
                characters.push(clip.character.clone());
            }
        }
        if !characters.iter().any(|c| c == request.style) {
            characters.push(request.style.to_owned()); // known by drawn poses alone
        }
        let mut motions: Vec<String> = Vec::new();
        for clip in clips {
            let shown = clips.iter().filter(|c| c.motion == clip.motion && !is_target(c, request)).count();
            if !motions.contains(&clip.motion) && (shown >= 2 || clip.motion == request.motion) {
                motions.push(clip.motion.clone());
            }
        }
        let index = |names: &[String], name: &str| names.iter().position(|n| n == name).unwrap_or(0);
        let (style, content) = (index(&characters, request.style), index(&characters, request.content));
        let motion = index(&motions, request.motion);
        let framings = characters.iter().map(|name| Framings::of(clips, name)).collect::<Result<_, _>>()?;
        let mut grid = Self {
            style,
            content,
            motion,
            framings,
            frames: 0,
            builds: Vec::new(),
            clips: Vec::new(),
            characters,
            motions,
        };
        grid.fill(clips, request);
        Ok(grid)
    }

    fn fill(&mut self, clips: &[Clip], request: &Request) {
        self.clips = vec![None; self.characters.len() * self.motions.len()];
        for clip in clips.iter().filter(|c| !is_target(c, request)) {
            let place = |names: &[String], name: &str| names.iter().position(|n| n == name);
            if let (Some(s), Some(m)) = (place(&self.characters, &clip.character), place(&self.motions, &clip.motion)) {
                let postures = clip.human().unwrap_or_default();
                let torso = self.framings[s].torso_of(&clip.motion);
                let postures = postures.iter().map(|p| unified(p, torso)).collect();
                self.clips[s * self.motions.len() + m] = Some(postures);
            }
        }
        self.builds = (0..self.characters.len()).map(|s| self.build(s)).collect();
        let count = self.motions.len();
        for (k, clip) in self.clips.iter_mut().enumerate() {
            let own = &self.builds[k / count];
            clip.iter_mut().flatten().for_each(|posture| *posture = build::taken(posture, own));
        }
        for m in 0..count {
            self.align(m);
        }
        self.frames = self.get(self.content, self.motion).map_or(1, <[Posture]>::len);
    }

    /// The build of a character, from the motions that it shares with the content's, else from all.
    fn build(&self, character: usize) -> Build {
        let motions = 0..self.motions.len();
        let pairs = motions.clone().filter_map(|m| self.get(character, m).zip(self.get(self.content, m)));
        let pairs: Vec<(&[Posture], &[Posture])> = pairs.collect();
        if !pairs.is_empty() {
            return build::of(&pairs);
        }
        let all =
            |s: usize| motions.clone().filter_map(|m| self.get(s, m)).flatten().copied().collect::<Vec<Posture>>();
        build::of(&[(&all(character), &all(self.content))])
    }

    /// Brings all clips of a motion to the frames of one of them, the content's if it exists.
    fn align(&mut self, m: usize) {
        let count = self.motions.len();
        let of = |s: usize| s * count + m;
        let order = std::iter::once(self.content).chain(0..self.characters.len());
        let Some(lead) = order.into_iter().find(|&s| self.clips[of(s)].is_some()) else { return };
        let Some(leading) = self.clips[of(lead)].clone() else { return };
        for s in 0..self.characters.len() {
            if let Some(clip) = self.clips[of(s)].as_mut().filter(|clip| clip.len() != leading.len()) {
                *clip = align::warped(clip, &leading);
            }
        }
    }

    /// A clip in torso lengths, aligned; `None` if the grid has none.
    pub fn get(&self, character: usize, motion: usize) -> Option<&[Posture]> {
        self.clips[character * self.motions.len() + motion].as_deref()
    }

    /// A clip as numbers, resampled to `frames` frames.
    pub fn rows(&self, character: usize, motion: usize, frames: usize) -> Option<Vec<Row>> {
        self.get(character, motion).map(|clip| resample(clip, frames).iter().map(row).collect())
    }

    /// Mean of the clips of a motion over all characters except one; `None` if no clip remains.
    pub fn mean_without(&self, character: usize, motion: usize, frames: usize) -> Option<Vec<Row>> {
        mean((0..self.characters.len()).filter(|&s| s != character).filter_map(|s| self.rows(s, motion, frames)))
    }
}

/// Mean of clips of equal length.
pub(super) fn mean(clips: impl Iterator<Item = Vec<Row>>) -> Option<Vec<Row>> {
    let mut count = 0.0;
    let sum = clips.inspect(|_| count += 1.0).reduce(|mut sum, clip| {
        for (a, b) in sum.iter_mut().flatten().zip(clip.iter().flatten()) {
            *a += b;
        }
        sum
    });
    sum.map(|mut sum| {
        sum.iter_mut().flatten().for_each(|v| *v /= count);
        sum
    })
}

/// A posture with the pelvis at the origin, in torso lengths.
pub(super) fn unified(posture: &Posture, torso: f64) -> Posture {
    std::array::from_fn(|k| (posture[k] - posture[0]) / torso)
}

/// A posture as numbers.
pub(super) fn row(posture: &Posture) -> Row {
    std::array::from_fn(|k| posture[k / 2][k % 2])
}

/// Numbers as a posture.
pub(super) fn posture(row: &Row) -> Posture {
    std::array::from_fn(|k| Point::new(row[2 * k], row[2 * k + 1]))
}

fn is_target(clip: &Clip, request: &Request) -> bool {
    clip.character == request.style && clip.motion == request.motion
}

fn check(clips: &[Clip], request: &Request) -> Result<(), StyleError> {
    for clip in clips {
        let broken = clip.postures.iter().position(|posture| posture.iter().any(|p| !p.is_finite()));
        if let Some(frame) = broken.or(clip.postures.is_empty().then_some(0)) {
            return Err(StyleError::Broken { character: clip.character.clone(), motion: clip.motion.clone(), frame });
        }
    }
    let content = check_names(clips, request)?;
    check_keys(request, content.postures.len())
}

/// Checks that the clips have the characters and the motion of the request. Returns the clip of its content.
fn check_names<'a>(clips: &'a [Clip], request: &Request) -> Result<&'a Clip, StyleError> {
    let names = |of: &dyn Fn(&Clip) -> String| {
        let mut names: Vec<String> = clips.iter().map(of).collect();
        names.sort();
        names.dedup();
        names.join(", ")
    };
    let has = |character: &str| clips.iter().any(|c| c.character == character);
    if request.style == request.content {
        return Err(StyleError::SameCharacter { character: request.style.to_owned() });
    }
    for (role, character) in [("style", request.style), ("content", request.content)] {
        let by_keys = character == request.style && !request.keys.is_empty();
        if !has(character) && !by_keys {
            let known = names(&|c| c.character.clone());
            return Err(StyleError::Name { role, found: character.to_owned(), known });
        }
    }
    if !clips.iter().any(|c| c.motion == request.motion) {
        let known = names(&|c| c.motion.clone());
        return Err(StyleError::Name { role: "motion", found: request.motion.to_owned(), known });
    }
    let content = clips.iter().find(|c| c.character == request.content && c.motion == request.motion);
    let Some(content) = content else {
        return Err(StyleError::Content { character: request.content.to_owned(), motion: request.motion.to_owned() });
    };
    let shared = clips.iter().any(|c| c.character == request.style && c.motion != request.motion);
    if !shared && request.keys.is_empty() {
        return Err(StyleError::NothingKnown {
            character: request.style.to_owned(),
            motion: request.motion.to_owned(),
        });
    }
    Ok(content)
}

/// Checks that the key poses of the request are on frames of the content and have a torso.
fn check_keys(request: &Request, frames: usize) -> Result<(), StyleError> {
    for key in request.keys {
        if key.frame >= frames {
            return Err(StyleError::KeyFrame { found: key.frame, frames });
        }
        let length = torso(&key.posture);
        if !(length > 0.0 && length.is_finite()) {
            return Err(StyleError::KeyPose { frame: key.frame, found: length });
        }
    }
    Ok(())
}
