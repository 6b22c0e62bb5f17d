//! What a result rests on, and how that is said to a person.
//!
//! A library that shows little of a style cannot be seen from the result: it is a clip like any other. So a translation
//! hands back what it had to go by, and the command line and Blender say it with the same words.

use super::episodes::{LEAST, Sure};
use super::grid::Grid;
use super::sides::Sides;
use super::stance::FEWEST_MOTIONS;
use super::{Options, Preset, Request};

/// What a result rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Grounds {
    /// The style's character.
    style: String,
    /// Motions of the style beside the requested one that another character shows too: only they tell what the style adds.
    pub shared: usize,
    /// Whether poses are drawn for the result.
    drawn: bool,
    /// The method, its strength, and whether limbs keep the style's lengths.
    how: (Preset, f64, bool),
    /// To which sides the clips look, and which were mirrored.
    pub sides: Sides,
    /// How sure it is, where the library tells.
    pub sure: Option<Sure>,
}

impl Grounds {
    pub(super) fn new(grid: &Grid, request: &Request, options: &Options, sides: Sides) -> Self {
        let known = |m: &usize| *m != grid.motion && grid.get(grid.style, *m).is_some();
        Self {
            style: request.style.to_owned(),
            shared: (0..grid.motions.len()).filter(known).count(),
            drawn: !request.keys.is_empty(),
            how: (options.preset, options.strength, options.keep_lengths),
            sides,
            sure: None,
        }
    }

    /// Whether nothing tells what the style adds.
    fn unknown(&self) -> bool {
        self.shared == 0 && !self.drawn
    }

    /// How far the result goes from the content's own motion to the predicted one, 0 to 1.
    pub(super) fn share(&self) -> f64 {
        match self.how {
            (Preset::Rototoon, ..) if self.unknown() => 0.0,
            (Preset::Rototoon, strength, _) => strength.min(1.0),
            _ => 1.0,
        }
    }

    /// What a person should know about the result, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        self.sides.notes().into_iter().chain(self.of_style()).collect()
    }

    /// What there is to say about what is known of the style.
    fn of_style(&self) -> Vec<String> {
        let (preset, strength, lengths) = self.how;
        let style = &self.style;
        let copy = if lengths {
            "the content's own motion, with limbs as long as the style's"
        } else {
            "the content's own motion"
        };
        if self.unknown() {
            let nothing =
                format!("no other character shows a motion that {style:?} shows, so nothing is known of the style");
            return vec![if preset == Preset::Rototoon { format!("{nothing}: the result is {copy}") } else { nothing }];
        }
        if preset != Preset::Rototoon {
            return Vec::new();
        }
        if strength == 0.0 {
            return vec![format!("with a strength of 0 the result is {copy}")];
        }
        match &self.sure {
            Some(sure) => vec![said(sure)],
            None => vec![format!(
                "the library is too small to rehearse on ({FEWEST_MOTIONS} motions and {LEAST} characters beside style and content are needed), so it is not \
                 known whether the result is nearer to {style:?} than a copy of the content"
            )],
        }
    }
}

/// How sure a result is, in words.
fn said(sure: &Sure) -> String {
    let mut said = format!(
        "expect {:.0} % of the error of copying, in the posture that is held ({} rehearsals on other characters)",
        100.0 * sure.of_copying,
        sure.episodes
    );
    let mut less = Vec::new();
    if sure.offset < 1.0 {
        less.push(format!("only {:.0} % of the change is made", 100.0 * sure.offset));
    }
    if sure.content > 0.0 {
        less.push(format!("{:.0} % of the posture that is held is the content's", 100.0 * sure.content));
    }
    if !less.is_empty() {
        said += &format!("; the style's clips tell little about this motion, so {}", less.join(", and "));
    }
    if sure.of_copying >= 1.0 {
        said += "; a copy of the content would be as near";
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_note_does_not_contradict_itself() {
        let sure = |of_copying, content, offset| said(&Sure { episodes: 9, of_copying, content, offset });
        let expected =
            "expect 58 % of the error of copying, in the posture that is held (9 rehearsals on other characters)";
        assert_eq!(sure(0.58, 0.0, 1.0), expected);
        let little = "; the style's clips tell little about this motion, so ";
        assert_eq!(
            sure(0.58, 0.25, 1.0),
            format!("{expected}{little}25 % of the posture that is held is the content's")
        );
        assert_eq!(sure(0.58, 0.0, 0.5), format!("{expected}{little}only 50 % of the change is made"));
        assert!(sure(1.02, 0.5, 0.5).ends_with("content's; a copy of the content would be as near"));
    }
}
