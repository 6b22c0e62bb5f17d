//! What a result rests on, and how that is said to a person.
//!
//! A library that shows little of a style cannot be seen from the result: it is a clip like any other. So a translation
//! hands back what it had to go by, and the command line and Blender say it with the same words.

use super::align::PaceRatio;
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
    /// What is said of clips from shots of another framing.
    framings: Vec<String>,
    /// How much slower the style is, if its timing was taken.
    pub(super) pace: Option<PaceRatio>,
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
            framings: grid.characters.iter().zip(&grid.framings).flat_map(|(name, own)| own.notes(name)).collect(),
            pace: None,
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
        let first = self.sides.notes().into_iter().chain(self.framings.iter().cloned());
        first.chain(self.of_style()).chain(self.pace.map(|pace| self.of_pace(pace))).collect()
    }

    fn of_pace(&self, pace: PaceRatio) -> String {
        let style = &self.style;
        match pace.motions {
            0 => format!(
                "the timing is the content's: {style:?} and the content have no other motion of several frames both"
            ),
            count => format!(
                "the timing is the style's: motions of {style:?} take {:.0} % of the content's frames (median of {count})",
                100.0 * pace.ratio
            ),
        }
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

/// What the posture that is held is made of, where it is not the plain prediction.
fn made(sure: &Sure) -> String {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let base = match sure.content {
        content if content >= 1.0 => "the content's".to_owned(),
        content if content > 0.0 => {
            format!("one that goes {} of the way from the mean of all characters to the content's", percent(content))
        }
        _ => "the mean of all characters".to_owned(),
    };
    match sure.offset {
        offset if offset <= 0.0 => format!("this posture is {base}, without the predicted change"),
        offset if offset < 1.0 => format!("{} of the predicted change is made, beginning at {base}", percent(offset)),
        _ => format!("the predicted change is made, beginning at {base}, not at the mean of all characters"),
    }
}

/// How sure a result is, in words.
fn said(sure: &Sure) -> String {
    let mut said = format!(
        "expect {:.0} % of the error of copying, in the posture that is held ({} rehearsals on other characters)",
        100.0 * sure.of_copying,
        sure.episodes
    );
    if sure.offset < 1.0 || sure.content > 0.0 {
        said += &format!("; in the rehearsals this was nearer to the truth: {}", made(sure));
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
        let so = "; in the rehearsals this was nearer to the truth: ";
        let between = "one that goes 25 % of the way from the mean of all characters to the content's";
        let begins = "the predicted change is made, beginning at";
        let not = ", not at the mean of all characters";
        assert_eq!(sure(0.58, 0.25, 1.0), format!("{expected}{so}{begins} {between}{not}"));
        assert_eq!(sure(0.58, 1.0, 1.0), format!("{expected}{so}{begins} the content's{not}"));
        assert_eq!(sure(0.58, 0.0, 0.5), format!("{expected}{so}50 % of {begins} the mean of all characters"));
        assert_eq!(sure(0.58, 1.0, 0.5), format!("{expected}{so}50 % of {begins} the content's"));
        let without = "the content's, without the predicted change";
        assert_eq!(sure(0.58, 1.0, 0.0), format!("{expected}{so}this posture is {without}"));
        assert!(sure(1.02, 0.5, 0.5).ends_with("to the content's; a copy of the content would be as near"));
    }
}
