//! The mechanisms of the default tracker, each of which can be switched off to measure what it is worth.
//!
//! What a mechanism gives is not what it would give alone: others fill in for it. So each is left out of the whole, and
//! the whole is measured again (an ablation): `cargo xtask bench-tracking --ablations`. Artists have no use for that; it
//! tells developers what to keep.

/// Something that the default tracker does beside carrying each key's lattice from drawing to drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Starts from the dense flow between drawings.
    Flow,
    /// The search over the whole picture where the keys' chains disagree.
    Search,
    /// Chosen poses carried on to both neighbours.
    Sweep,
    /// The choice of all parts together; without it each part chooses alone.
    JointChoice,
    /// Nearer parts hide farther ones.
    Hiding,
    /// Parts that hang together stay together, and lead each other.
    Joints,
    /// Parts are soft where the keys bend them.
    Stiffness,
    /// Samples outside the part cost little where the ground has changed, and move it across its contour only.
    FigureAndGround,
    /// Both keys' poses are mixed where they agree.
    Blending,
    /// Contours are brought onto the drawing by their own colours.
    Refinement,
}

impl Mechanism {
    /// Every mechanism with its id on the command line of the benchmark.
    pub const ALL: [(Self, &str); 10] = [
        (Self::Flow, "flow"),
        (Self::Search, "search"),
        (Self::Sweep, "sweep"),
        (Self::JointChoice, "joint-choice"),
        (Self::Hiding, "hiding"),
        (Self::Joints, "joints"),
        (Self::Stiffness, "stiffness"),
        (Self::FigureAndGround, "figure-and-ground"),
        (Self::Blending, "blending"),
        (Self::Refinement, "refinement"),
    ];

    /// The mechanism of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(mechanism, _)| *mechanism)
    }
}

/// The mechanisms that are in use: all, or all but one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mechanisms {
    without: Option<Mechanism>,
}

impl Mechanisms {
    /// All but one.
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
