//! A drawing: a picture, its ink as a graph, and its strokes.

use crate::graph::Graph;
use crate::ink::{self, Ink};
use crate::outside::Outside;
use crate::pairing::{Evidence, Pairing};
use crate::solid::{Solids, met};
use crate::stroke::{Options, Stroke, Style};
use crate::strokes::Walked;
use crate::{centre, economy, finish, sketch, strokes};
use rayon::prelude::{IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator};
use rototoon_base::scene::{Colour, Raster};
use std::sync::{Arc, OnceLock};

/// A picture of which the ink is known.
pub struct Drawing {
    pub(crate) picture: Arc<Raster<Colour>>,
    pub(crate) graph: Graph,
    /// Usual width of lines in pixels.
    pub(crate) width: f64,
    /// Size of a pixel of 540 lines.
    pub(crate) unit: f64,
    /// How dark each pixel is, and the darkest ink; `None` if lines are sketched, since their widths are not measured.
    pub(crate) darkness: Option<(Raster<f32>, f32)>,
    rough: bool,
    outside: Outside,
    /// The strokes before they are fitted, once they were asked for.
    lines: OnceLock<Vec<Walked>>,
}

impl Drawing {
    /// Finds the ink of a picture.
    pub fn new(picture: Arc<Raster<Colour>>, options: &Options) -> Self {
        let ink = ink::measure(&picture, options);
        Self::of(picture, ink, options)
    }

    /// As [`Self::new`], from the ink that was measured in the picture with these options.
    pub fn of(picture: Arc<Raster<Colour>>, mut ink: Ink, options: &Options) -> Self {
        let unit = picture.height().max(1) as f64 / 540.0;
        let mut graph = Graph::new(&ink);
        // First of all, since what is filled between sketched strokes was not drawn black.
        let solids = Solids::new(&ink, &graph, unit);
        if let Some(solids) = &solids {
            ink = ink.with_mask(solids.lines.clone());
            graph = Graph::new(&ink);
        }
        let width = solids.as_ref().filter(|_| graph.branches.is_empty()).map_or(graph.width(), |solids| solids.width);
        let slivers = sketch::Slivers::new(&ink, width);
        let rough = match options.style {
            Style::Clean => false,
            Style::Rough => true,
            Style::Auto => slivers.are_many(graph.length(), width),
        };
        if rough {
            ink = slivers.filled(ink);
            graph = Graph::new(&ink);
        }
        let outside = match &solids {
            Some(solids) => Outside::new(&solids.with(&ink.mask)),
            None => Outside::new(&ink.mask),
        };
        graph.branches.par_iter_mut().for_each(|branch| centre::centred(branch, &ink.darkness));
        graph.add_solids(solids.map(|solids| solids.outlines).unwrap_or_default());
        let darkness = (!rough).then_some((ink.darkness, ink.darkest));
        Self { picture, graph, width, unit, darkness, rough, outside, lines: OnceLock::new() }
    }

    /// The strokes of the drawing.
    pub fn strokes(&self) -> Vec<Stroke> {
        self.lines().par_iter().map(|line| self.finished(line)).collect()
    }

    /// The stroke of a line on this drawing.
    pub(crate) fn finished(&self, line: &Walked) -> Stroke {
        finish::finished(line, &self.picture, self.unit, self.darkness.as_ref())
    }

    /// The strokes before they are fitted.
    pub(crate) fn lines(&self) -> &[Walked] {
        self.lines.get_or_init(|| self.walked())
    }

    fn walked(&self) -> Vec<Walked> {
        let colours: Vec<Colour> =
            self.graph.branches.par_iter().map(|branch| finish::colour(&branch.points, &self.picture)).collect();
        let stub = economy::stub(self.width, self.unit);
        let pairing = Pairing::new(&Evidence { graph: &self.graph, outside: &self.outside, colours: &colours, stub });
        let mut walked = strokes::walked(&self.graph, &pairing);
        met(&mut walked, self.width);
        let style = if self.rough { Style::Rough } else { Style::Clean };
        economy::thrifty(walked, self.width, self.unit, style)
    }
}
