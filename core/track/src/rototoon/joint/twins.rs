//! Contenders that look alike: parts that could be mistaken for each other.

use super::contender::Contender;
use super::cost::Scene;
use crate::rototoon::alike::{Look, median_colour};

impl Scene<'_> {
    /// Whether two contenders are [alike](crate::rototoon::alike) at their keys.
    pub(super) fn are_twins(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|c| look(&self.contenders[c]));
        a.zip(b).is_some_and(|(a, b)| a.is_like(&b))
    }
}

/// The look of a closed part. `None` if its model has no samples inside.
fn look(contender: &Contender) -> Option<Look> {
    let inside = contender.models.iter().flat_map(|model| &model.texture.texels[0]).filter(|texel| texel.weight == 1.0);
    let colours = inside.map(|texel| texel.key.colour);
    (contender.hides && colours.clone().next().is_some())
        .then(|| Look::new(contender.keys().into_iter(), median_colour(colours)))
}
