//! The mechanisms of the default tracker. Each can be switched off to measure its contribution.
//!
//! The contribution of a mechanism in the complete tracker differs from its contribution alone, because others
//! compensate for it. So the measurement is an ablation: one mechanism is left out and the tracker is measured again,
//! with `cargo xtask bench-tracking --ablations`. It is a tool for developers, who decide with it what to keep. Artists
//! do not need it.

/// A mechanism that the default tracker has in addition to carrying each key's lattice from drawing to drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Line drawings and shaded drawings are compared by looks of their own instead of by colours.
    Looks,
    /// Dense flow between drawings gives starts.
    Flow,
    /// The complete picture is searched where the chains from the two keys disagree.
    Search,
    /// Chosen poses are carried to both neighbouring drawings.
    Sweep,
    /// All parts choose together. Without it each part chooses alone.
    JointChoice,
    /// Nearer parts hide farther ones.
    Hiding,
    /// Connected parts stay together at their joints, and surer parts lead others.
    Joints,
    /// Parts are softer where the keys show that they bend.
    Stiffness,
    /// Where drawings jump, motion costs less.
    Jumps,
    /// Samples outside the part cost little where the background has changed, and pull the part across its contour
    /// only.
    FigureAndGround,
    /// The poses of both keys are blended where they agree.
    Blending,
    /// Contours are refined by their own colour templates.
    Refinement,
    /// Contours are also refined from templates twice as large.
    WideTemplates,
    /// Pulls of the refinement count less where they are wrong between the keys.
    Noise,
    /// Parts that moved as one body between the keys stay together.
    Companions,
    /// Contours are steadied over time where the film wobbles.
    Steadying,
    /// A key that a part has on its own corrects its motion, and does not end its span.
    CorrectiveKeys,
    /// What the picture shows in colours that only parts have must be explained by parts.
    Figure,
    /// Limbs are tried folded at a joint, longer and shorter, where something is unexplained.
    Folds,
    /// What is behind a neck of a contour is tried turned about it.
    Branches,
    /// Frames that show one drawing of a part over a background that moves take one contour.
    Holds,
    /// Parts without corrections keep their tracks, unless corrections of other parts make them clearly surer.
    Untouched,
    /// Parts that are alike and meet twice between two keys may have changed places, and are doubted.
    Exchanges,
}

impl Mechanism {
    /// Every mechanism with its id on the command line of the benchmark.
    pub const ALL: [(Self, &str); 23] = [
        (Self::Looks, "looks"),
        (Self::Flow, "flow"),
        (Self::Search, "search"),
        (Self::Sweep, "sweep"),
        (Self::JointChoice, "joint-choice"),
        (Self::Hiding, "hiding"),
        (Self::Joints, "joints"),
        (Self::Stiffness, "stiffness"),
        (Self::Jumps, "jumps"),
        (Self::FigureAndGround, "figure-and-ground"),
        (Self::Blending, "blending"),
        (Self::Refinement, "refinement"),
        (Self::WideTemplates, "wide-templates"),
        (Self::Noise, "noise"),
        (Self::Companions, "companions"),
        (Self::Steadying, "steadying"),
        (Self::CorrectiveKeys, "corrective-keys"),
        (Self::Figure, "figure"),
        (Self::Folds, "folds"),
        (Self::Branches, "branches"),
        (Self::Holds, "holds"),
        (Self::Untouched, "untouched"),
        (Self::Exchanges, "exchanges"),
    ];

    /// The mechanism with an id. `None` if there is no such mechanism.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(mechanism, _)| *mechanism)
    }
}

/// The set of mechanisms in use: all, or all but one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mechanisms {
    without: Option<Mechanism>,
}

impl Mechanisms {
    /// All mechanisms but one.
    pub fn without(mechanism: Mechanism) -> Self {
        Self { without: Some(mechanism) }
    }

    /// Whether a mechanism is in use.
    pub fn has(self, mechanism: Mechanism) -> bool {
        self.without != Some(mechanism)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_of_one_mechanism_each() {
        for (mechanism, id) in Mechanism::ALL {
            assert_eq!(Mechanism::from_id(id), Some(mechanism));
            let rest = Mechanisms::without(mechanism);
            assert!(Mechanism::ALL.iter().all(|&(other, _)| rest.has(other) == (other != mechanism)));
        }
        assert_eq!(Mechanism::from_id("luck"), None);
        assert!(Mechanism::ALL.iter().all(|&(mechanism, _)| Mechanisms::default().has(mechanism)));
    }
}
