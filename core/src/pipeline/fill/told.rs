//! What painting tells: how many regions, which are in doubt, and what was in vain.

use super::super::keeping::Earlier;
use super::super::report::runs;
use crate::fill::Gap;
use crate::geometry::Point;
use crate::project::fills::Hue;
use crate::scene::FrameNumber;
use std::collections::BTreeMap;
use std::fmt;

/// Least number of clicks on one frame from which frames with few regions are said.
const MANY: usize = 4;
/// How many times as many clicks there are as a bare frame has regions, at least.
const BARE: usize = 4;

/// What became of a frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FilledFrame {
    /// The frame.
    pub frame: FrameNumber,
    /// The number of painted regions.
    pub regions: usize,
    /// The number of regions whose colour is probably wrong: their confidence is below 0.5.
    pub doubtful: usize,
    /// Whether the drawing shows the same as a painted one. If not, nothing is painted.
    pub related: bool,
    /// The number of regions that the drawing has.
    pub found: usize,
    /// Whether these are hardly any, for what was clicked: its lines were probably not found.
    pub bare: bool,
}

/// A click that paints nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissedClick {
    /// The frame.
    pub frame: FrameNumber,
    /// Where it is, in pixels.
    pub at: Point,
    /// Index of the frame's entry in the document's field `fills`.
    pub entry: usize,
    /// Index of the click among those of the frame.
    pub click: usize,
}

/// Its place in the footage and in the document.
impl fmt::Display for MissedClick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, at, entry, click } = self;
        write!(f, "frame {frame}, pixel ({:.1}, {:.1}): the click fills[{entry}].regions[{click}]", at.x, at.y)
    }
}

/// A click that leaks to the edge of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeakingClick {
    /// The click.
    pub place: MissedClick,
    /// The gap. If it closes, the click paints what is on its own side.
    pub gap: Gap,
    /// Width and height in pixels of what the click paints.
    pub size: [usize; 2],
}

impl fmt::Display for LeakingClick {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place: MissedClick { frame, at, .. }, gap, size: [width, height] } = self;
        write!(f, "frame {frame}: the click at ({:.0}, {:.0}) ", at.x, at.y)?;
        let hole = format!("a gap of about {:.0} px at ({:.0}, {:.0})", gap.width.max(1.0), gap.at.x, gap.at.y);
        match gap.closes {
            true => write!(f, "was parted from what is around at {hole}: it paints {width} × {height} px"),
            false => write!(
                f,
                "paints {width} × {height} px up to the picture's edge, through {hole}: close the line, click into what is around, \
                 or leave it if you mean all of it"
            ),
        }
    }
}

/// What became of an entry of the document's field `recolours`.
#[derive(Clone, Debug, PartialEq)]
pub struct Recoloured {
    /// Its index in the field.
    pub entry: usize,
    /// What it says, in words.
    pub what: String,
    /// Its old colour.
    pub from: Hue,
    /// The number of regions that it has changed, on all painted frames together.
    pub regions: usize,
}

impl fmt::Display for Recoloured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { entry, what, from, regions } = self;
        write!(f, "recolours[{entry}]: {what}: ")?;
        match regions {
            0 => write!(f, "no region there has the colour {from}, so nothing changes"),
            1 => write!(f, "1 region"),
            more => write!(f, "{more} regions"),
        }
    }
}

/// A colour that no region of a drawing has, though the drawing that was painted before it has it.
#[derive(Clone, Debug, PartialEq)]
pub struct VanishedColour {
    /// The first frame without it, counted from the model drawing.
    pub frame: FrameNumber,
    /// The colour.
    pub hue: Hue,
}

/// What became of all frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillReport {
    /// The frames, in order.
    pub frames: Vec<FilledFrame>,
    /// Clicks that lie on a line or outside of the picture.
    pub missed: Vec<MissedClick>,
    /// Clicks in a region that a later click has given another colour.
    pub overruled: Vec<MissedClick>,
    /// Clicks that leak to the edge of the picture.
    pub leaking: Vec<LeakingClick>,
    /// The colours that become others on the painted frames.
    pub recoloured: Vec<Recoloured>,
    /// Colours that vanish from one drawing to the next.
    pub vanished: Vec<VanishedColour>,
    /// By frame the number of its clicks.
    pub clicks: BTreeMap<FrameNumber, usize>,
    /// How many drawings and registrations of drawings an earlier run has looked at.
    pub earlier: Earlier,
}

impl FillReport {
    /// What a person is told, a line each.
    pub fn lines(&self) -> Vec<String> {
        let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let named = |frames: Vec<FrameNumber>| frames.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let regions = self.frames.iter().map(|frame| frame.regions).sum();
        let doubtful: usize = self.frames.iter().map(|frame| frame.doubtful).sum();
        let frames = counted(self.frames.len(), "frame");
        let mut lines = vec![format!("{} painted on {frames}, {doubtful} in doubt", counted(regions, "region"))];
        let mut worst: Vec<&FilledFrame> = self.frames.iter().filter(|frame| frame.doubtful > 0).collect();
        worst.sort_by_key(|frame| (std::cmp::Reverse(frame.doubtful), frame.frame));
        if let Some(worst) = worst.first() {
            lines.push(format!("most doubts on frame {}: {}", worst.frame, counted(worst.doubtful, "region")));
        }
        let other: Vec<FrameNumber> = self.frames.iter().filter(|f| !f.related).map(|f| f.frame).collect();
        if !other.is_empty() {
            lines.push(format!("not painted, since no painted drawing shows the same: frame {}", named(other)));
        }
        lines.extend(self.recoloured.iter().map(ToString::to_string));
        lines.extend(self.leaking.iter().map(ToString::to_string));
        lines.extend(self.overruled_lines());
        lines.extend(self.vanished_lines());
        let bare: Vec<FrameNumber> = self.frames.iter().filter(|f| f.bare).map(|f| f.frame).collect();
        if !bare.is_empty() {
            let most = self.clicks.values().max().copied().unwrap_or(0);
            let told = format!(
                "hardly any region, but {most} clicks on one frame: a higher --sensitivity finds fainter lines"
            );
            let them = if bare.len() == 1 { "frame" } else { "frames" };
            lines.push(format!("{them} {}: {told}", runs(&bare)));
        }
        lines.extend(
            self.missed
                .iter()
                .map(|place| format!("{place} lies on a line or outside of the picture, so it paints nothing")),
        );
        lines
    }

    /// A line for each frame with clicks whose region another click fills.
    fn overruled_lines(&self) -> Vec<String> {
        let mut counts: BTreeMap<FrameNumber, usize> = BTreeMap::new();
        self.overruled.iter().for_each(|own| *counts.entry(own.frame).or_default() += 1);
        let line = |(frame, count): (FrameNumber, usize)| {
            let all = self.clicks.get(&frame).copied().unwrap_or(count);
            let paint = if count == 1 { "paints" } else { "paint" };
            format!(
                "frame {frame}: {count} of {all} clicks {paint} nothing, since a later click fills the same region: the line between \
                 them was not found, or is open"
            )
        };
        counts.into_iter().map(line).collect()
    }

    /// A line for each colour that vanishes.
    fn vanished_lines(&self) -> Vec<String> {
        let mut frames: Vec<(&Hue, Vec<FrameNumber>)> = Vec::new();
        for VanishedColour { frame, hue } in &self.vanished {
            match frames.iter_mut().find(|own| own.0.is_same(hue)) {
                Some(own) => own.1.push(*frame),
                None => frames.push((hue, vec![*frame])),
            }
        }
        let line = |(hue, frames): (&Hue, Vec<FrameNumber>)| {
            let them = if frames.len() == 1 { "frame" } else { "frames" };
            let told =
                "no region has it, though the drawing painted before has: it is hidden, or a region has a wrong colour";
            format!("the colour {hue} vanishes on {them} {}: {told}", runs(&frames))
        };
        frames.into_iter().map(line).collect()
    }

    /// Marks the frames that have hardly any region.
    pub(super) fn mark_bare(&mut self) {
        let most = self.clicks.values().max().copied().unwrap_or(0);
        for own in &mut self.frames {
            own.bare = most >= MANY && own.found * BARE <= most;
        }
    }
}
