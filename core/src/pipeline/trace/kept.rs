//! Spans of traced strokes that are kept, so that after an edit only the spans that it touches are traced again.
//!
//! A *span* is work whose result depends on nothing else: from one drawing of the artist to the next one, a single [step](super::steps) from a drawing
//! outward, or the tracing of the first picture. Its key is a hash (BLAKE3) of all that it depends on:
//! the code, options, pixels, strokes. So a kept span is right by what it is made of, whatever document or folder asks for it.
//!
//! Spans are kept in memory, for programs that trace again and again, and in a [cache](crate::track::Cache) beyond the program. What comes from a cache is looked at
//! before it is used: a folder may be shared with anybody.
//!
//! **Numbers.** An edit in one span may begin more or fewer new strokes there, which shifts the numbers of those that begin
//! later. Only the order of numbers matters to a span. So a span is kept with *ranks*: first the numbers that go into it,
//! then the new ones.
//!
//! **Limits.** All pictures are read again, to be compared. A stroke is laid onto the next drawing from where it was on the one before, so a drawing that changes
//! changes all steps behind it.

use super::super::keeping::CODE;
use crate::geometry::Point;
use crate::lines::{Options, Stroke, Style, Tracked};
use crate::scene::{Colour, Raster};
use crate::track::Cache;
use blake3::{Hash, Hasher};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::Arc;

/// Most memory of kept spans, in bytes. A stroke of 100 points takes 2.5 kB.
const LIMIT: usize = 256 << 20;

/// Kept spans, the last used ones last.
#[derive(Default)]
pub struct TraceMemory {
    spans: VecDeque<(Hash, Arc<Span>)>,
    bytes: usize,
}

/// Where spans are kept. Nothing is, by default.
#[derive(Default)]
pub struct Kept<'a> {
    /// The memory of the program.
    pub memory: Option<&'a mut TraceMemory>,
    /// What is kept beyond it.
    pub cache: Option<&'a dyn Cache>,
}

/// The result of a span. The numbers of its strokes are ranks.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Span {
    /// The strokes of its drawings, in the order of work.
    pub drawings: Vec<Vec<Tracked>>,
    /// Strokes that go on behind its end: of a step all that are carried, between drawings those that began on the way.
    pub beside: Vec<Tracked>,
    /// How many numbers it has used.
    pub new: usize,
}

impl TraceMemory {
    /// Number of spans that are kept.
    pub fn spans(&self) -> usize {
        self.spans.len()
    }

    pub(super) fn recall(&mut self, key: &Hash) -> Option<Arc<Span>> {
        let place = self.spans.iter().position(|(known, _)| known == key)?;
        let span = self.spans.remove(place)?;
        let found = span.1.clone();
        self.spans.push_back(span);
        Some(found)
    }

    pub(super) fn keep(&mut self, key: Hash, span: Arc<Span>) {
        self.bytes += span.bytes();
        self.spans.push_back((key, span));
        while self.bytes > LIMIT
            && let Some((_, oldest)) = self.spans.pop_front()
        {
            self.bytes -= oldest.bytes();
        }
    }
}

impl Kept<'_> {
    /// Whether nothing is kept.
    pub(super) fn is_none(&self) -> bool {
        self.memory.is_none() && self.cache.is_none()
    }

    /// The span of a key, if it is one that fits.
    pub(super) fn recall(&mut self, key: &Hash, fits: impl Fn(&Span) -> bool) -> Option<Arc<Span>> {
        if let Some(found) = self.memory.as_mut().and_then(|memory| memory.recall(key)) {
            return Some(found);
        }
        let bytes = self.cache?.get(key.as_bytes())?;
        let found: Arc<Span> = Arc::new(postcard::from_bytes(&bytes).ok().filter(fits)?);
        if let Some(memory) = &mut self.memory {
            memory.keep(*key, found.clone());
        }
        Some(found)
    }

    pub(super) fn keep(&mut self, key: Hash, span: Span) {
        if let Some(cache) = self.cache
            && let Ok(bytes) = postcard::to_stdvec(&span)
        {
            cache.put(key.as_bytes(), &bytes);
        }
        if let Some(memory) = &mut self.memory {
            memory.keep(key, Arc::new(span));
        }
    }
}

impl Span {
    /// Whether it is what this program would have kept: of so many drawings, with strokes that went into it and those that it began.
    pub fn fits(&self, drawings: usize, numbers: &Numbers, next: usize) -> bool {
        let known = numbers.known.len() + numbers.ends(next);
        let ranks = known.checked_add(self.new).filter(|_| u32::try_from(self.new).is_ok());
        let is_sure = |own: &Tracked| (0.0..=1.0).contains(&own.confidence);
        let mut strokes = self.drawings.iter().flatten().chain(&self.beside);
        self.drawings.len() == drawings
            && ranks.is_some_and(|ranks| strokes.all(|own| own.track < ranks && is_sure(own) && is_stroke(&own.stroke)))
    }

    fn bytes(&self) -> usize {
        let of = |t: &Tracked| {
            size_of::<Tracked>() + t.stroke.points.len() * size_of::<Point>() + t.stroke.widths.len() * size_of::<f64>()
        };
        self.drawings.iter().flatten().chain(&self.beside).map(of).sum()
    }
}

/// Whether a stroke is one that can be written.
pub(super) fn is_stroke(Stroke { points, widths, colour, fill_colour, .. }: &Stroke) -> bool {
    let is_colour = |colour: &Colour| colour.iter().all(|value| value.is_finite());
    (widths.is_empty() || widths.len() == points.len())
        && points.iter().all(|point| point.is_finite())
        && widths.iter().all(|width| width.is_finite())
        && is_colour(colour)
        && fill_colour.iter().all(is_colour)
}

/// The numbers that go into a span, and the first new one.
pub(super) struct Numbers {
    known: Vec<usize>,
    next: usize,
}

impl Numbers {
    /// Of strokes that go into a span. All of their numbers are below `next`.
    pub fn new<'a>(strokes: impl IntoIterator<Item = &'a Tracked>, next: usize) -> Self {
        let mut known: Vec<usize> = strokes.into_iter().map(|stroke| stroke.track).collect();
        known.sort_unstable();
        known.dedup();
        Self { known, next }
    }

    /// How many new numbers there are before the number `next`.
    pub fn ends(&self, next: usize) -> usize {
        next - self.next
    }

    /// Strokes with ranks in place of numbers.
    pub fn ranked(&self, strokes: &[Tracked]) -> Vec<Tracked> {
        let rank =
            |track: usize| self.known.binary_search(&track).unwrap_or_else(|_| self.known.len() + track - self.next);
        renumbered(strokes, rank)
    }

    /// Strokes with numbers in place of ranks.
    pub fn numbered(&self, strokes: &[Tracked]) -> Vec<Tracked> {
        let number = |rank: usize| self.known.get(rank).copied().unwrap_or_else(|| self.next + rank - self.known.len());
        renumbered(strokes, number)
    }
}

fn renumbered(strokes: &[Tracked], to: impl Fn(usize) -> usize) -> Vec<Tracked> {
    strokes.iter().map(|stroke| Tracked { track: to(stroke.track), ..stroke.clone() }).collect()
}

/// The key of a span, as it is put together.
pub(super) struct Key(Hasher);

impl Key {
    /// A span of this kind, traced with these options.
    pub fn new(kind: &str, options: &Options) -> Self {
        let style = match options.style {
            Style::Clean => 0,
            Style::Rough => 1,
            Style::Auto => 2,
        };
        let mut key = Self(Hasher::new());
        key.0.update(CODE.as_bytes());
        key.count(kind.len()).0.update(kind.as_bytes());
        key.count(style).number(options.sensitivity).count(options.leave_out.len());
        options.leave_out.iter().flatten().for_each(|&value| {
            key.number(f64::from(value));
        });
        key
    }

    /// A key that goes on from another one.
    pub fn after(key: &Hash) -> Self {
        let mut own = Self(Hasher::new());
        own.hashed(key);
        own
    }

    /// Adds something by its hash, such as a picture.
    pub fn hashed(&mut self, hash: &Hash) -> &mut Self {
        self.0.update(hash.as_bytes());
        self
    }

    /// Adds strokes with their numbers, or ranks, and confidence.
    pub fn tracked(&mut self, strokes: &[Tracked]) -> &mut Self {
        self.count(strokes.len());
        for Tracked { track, stroke, confidence } in strokes {
            self.count(*track).number(*confidence).stroke(stroke);
        }
        self
    }

    /// Adds strokes.
    pub fn strokes(&mut self, strokes: &[Stroke]) -> &mut Self {
        self.count(strokes.len());
        strokes.iter().for_each(|stroke| {
            self.stroke(stroke);
        });
        self
    }

    fn stroke(&mut self, stroke: &Stroke) -> &mut Self {
        let Stroke { points, closed, widths, colour, fill, fill_colour } = stroke;
        self.count(points.len()).count(widths.len()).count(usize::from(*closed)).count(usize::from(*fill));
        points.iter().flat_map(|p| [p.x, p.y]).chain(widths.iter().copied()).for_each(|value| {
            self.number(value);
        });
        self.count(usize::from(fill_colour.is_some()));
        colour.iter().chain(fill_colour.iter().flatten()).for_each(|&value| {
            self.number(f64::from(value));
        });
        self
    }

    /// Adds a number.
    pub fn count(&mut self, value: usize) -> &mut Self {
        self.0.update(&(value as u64).to_le_bytes());
        self
    }

    fn number(&mut self, value: f64) -> &mut Self {
        self.0.update(&value.to_le_bytes());
        self
    }

    /// The key.
    pub fn hash(&self) -> Hash {
        self.0.finalize()
    }
}

/// The hash of a picture.
pub(in super::super) fn of_picture(picture: &Raster<Colour>) -> Hash {
    crate::pictures::sequence::mark(picture).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tracked(track: usize) -> Tracked {
        Tracked::sure(track, Stroke::default())
    }

    fn tracks(strokes: &[Tracked]) -> Vec<usize> {
        strokes.iter().map(|stroke| stroke.track).collect()
    }

    #[test]
    fn ranks_keep_the_order_and_new_numbers_follow() {
        let strokes = [7, 3, 20, 21].map(tracked);
        let numbers = Numbers::new(&strokes[..2], 20);
        let ranked = numbers.ranked(&strokes);
        assert_eq!(tracks(&ranked), [1, 0, 2, 3]);
        assert_eq!(tracks(&numbers.numbered(&ranked)), [7, 3, 20, 21]);
        let others = Numbers::new(&[tracked(5), tracked(9)], 11);
        assert_eq!(tracks(&others.numbered(&ranked)), [9, 5, 11, 12]);
    }

    #[test]
    fn what_a_span_depends_on_is_in_its_key() {
        let key = |build: &dyn Fn(&mut Key)| {
            let mut key = Key::new("span", &Options::default());
            build(&mut key);
            key.hash()
        };
        let stroke = Stroke { points: vec![Point::new(1.0, 2.0)], ..Stroke::default() };
        let keys = [
            key(&|_| {}),
            Key::new("other", &Options::default()).hash(),
            Key::new("span", &Options { sensitivity: 2.0, ..Options::default() }).hash(),
            Key::new("span", &Options { style: Style::Rough, ..Options::default() }).hash(),
            Key::new("span", &Options { leave_out: vec![[0.6, 0.8, 1.0]], ..Options::default() }).hash(),
            key(&|key| {
                key.strokes(std::slice::from_ref(&stroke));
            }),
            key(&|key| {
                key.strokes(&[Stroke { fill: true, ..stroke.clone() }]);
            }),
            key(&|key| {
                key.strokes(&[Stroke { fill_colour: Some([0.0; 3]), ..stroke.clone() }]);
            }),
            key(&|key| {
                key.tracked(&[Tracked::sure(1, stroke.clone())]);
            }),
            key(&|key| {
                key.tracked(&[Tracked { confidence: 0.5, ..Tracked::sure(1, stroke.clone()) }]);
            }),
            key(&|key| {
                key.hashed(&of_picture(&Raster::new(2, 3, [0.5; 3])));
            }),
            key(&|key| {
                key.hashed(&of_picture(&Raster::new(3, 2, [0.5; 3])));
            }),
        ];
        for (k, one) in keys.iter().enumerate() {
            assert!(keys[..k].iter().all(|other| other != one), "key {k}");
        }
    }

    #[test]
    fn the_oldest_spans_are_dropped_first() {
        let long = || {
            let stroke = Stroke { points: vec![Point::ZERO; LIMIT / 40], ..Stroke::default() };
            Arc::new(Span { drawings: vec![vec![Tracked::sure(0, stroke)]], ..Span::default() })
        };
        let name = |k: u8| Hash::from([k; 32]);
        let mut memory = TraceMemory::default();
        memory.keep(name(1), long());
        memory.keep(name(2), long());
        assert!(memory.recall(&name(1)).is_some());
        memory.keep(name(3), long());
        assert_eq!(memory.spans(), 2);
        assert!(memory.recall(&name(2)).is_none() && memory.recall(&name(1)).is_some());
    }
}
