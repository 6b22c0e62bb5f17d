//! What a painted drawing says about the regions of another one.

use crate::meet::Table;
use crate::page::Paint;
use crate::relax::Relaxed;

/// What a source says.
pub(crate) struct Said<'a> {
    /// The source's colours.
    pub paint: &'a Paint,
    /// Who is who.
    pub relaxed: Relaxed,
    /// For each region and colour, the sum of u' over the source's regions of this colour.
    pub colours: Table,
    /// For each region, the share of regions without paint among those that it may be.
    pub unpainted: Vec<f32>,
    /// For each region how far the source says nothing about it, 0 to 1, since a correction of the artist overrules it.
    pub silent: Vec<f32>,
}

impl Said<'_> {
    /// Whether what the source says about a region counts: no correction overrules it.
    pub fn hears(&self, region: usize) -> bool {
        self.silent[region] <= 0.5
    }
}
