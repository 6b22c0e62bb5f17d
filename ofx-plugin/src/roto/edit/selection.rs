//! The selected points.

use rototoon::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeSet;

/// A control point: the index of its part, and its own index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// Index of the part.
    pub part: usize,
    /// Index of the point.
    pub point: usize,
}

/// The selected points. They stay selected on all frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection(BTreeSet<Place>);

impl Selection {
    /// These points.
    pub fn of(places: impl IntoIterator<Item = Place>) -> Self {
        Self(places.into_iter().collect())
    }

    /// All points of a part.
    pub fn part(part: usize, scene: &Scene) -> Self {
        let count = scene.parts.get(part).map_or(0, Part::point_count);
        Self::of((0..count).map(|point| Place { part, point }))
    }

    /// Whether nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether a point is selected.
    pub fn contains(&self, place: Place) -> bool {
        self.0.contains(&place)
    }

    /// The points in order.
    pub fn iter(&self) -> impl Iterator<Item = Place> + '_ {
        self.0.iter().copied()
    }

    /// The parts with selected points.
    pub fn parts(&self) -> BTreeSet<usize> {
        self.iter().map(|place| place.part).collect()
    }

    /// The selected points of a part.
    pub fn of_part(&self, part: usize) -> BTreeSet<usize> {
        self.iter().filter(|place| place.part == part).map(|place| place.point).collect()
    }

    /// Selects a point, or no longer selects it.
    pub fn toggle(&mut self, place: Place) {
        if !self.0.remove(&place) {
            self.0.insert(place);
        }
    }

    /// Selects more points.
    pub fn add(&mut self, other: &Self) {
        self.0.extend(other.iter());
    }

    /// Drops points that a document no longer has, as after an undo. `names` are those of the parts when the points were
    /// selected: parts may have come and gone since, so that others have their indices.
    pub fn keep_existing(&mut self, names: &[String], scene: &Scene) {
        let index = |part: usize| {
            let name = names.get(part)?;
            // Mostly nothing has changed.
            let same = scene.parts.get(part).is_some_and(|part| part.name == *name);
            if same { Some(part) } else { scene.parts.iter().position(|part| part.name == *name) }
        };
        let now = self.iter().filter_map(|place| Some(Place { part: index(place.part)?, ..place }));
        self.0 = now.filter(|place| place.point < scene.parts[place.part].point_count()).collect();
    }

    /// The points that exist on a frame.
    pub fn on_frame<'a>(&'a self, scene: &'a Scene, frame: FrameNumber) -> impl Iterator<Item = Place> + 'a {
        self.iter().filter(move |place| {
            let points = scene.parts.get(place.part).and_then(|part| part.points_at(frame));
            points.is_some_and(|points| place.point < points.len())
        })
    }
}
