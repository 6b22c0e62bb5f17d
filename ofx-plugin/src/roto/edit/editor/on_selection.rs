//! What buttons and keys of the keyboard do with the selected points.

use super::{Edit, Editor, Outcome, Work};
use crate::roto::edit::{Place, Refused, Selection, change, feather, points};
use std::collections::{BTreeMap, BTreeSet};

impl Editor {
    /// The parts with selected points that may be changed.
    fn changeable(&mut self, work: &Work) -> Result<BTreeSet<usize>, Refused> {
        self.follow(&work.document.scene);
        let mut parts = self.selection.parts();
        let first = parts.first().copied();
        parts.retain(|part| work.parts.contains(part));
        match first {
            Some(part) if parts.is_empty() => Err(Refused::protected(&work.document.scene.parts[part].name)),
            _ => Ok(parts),
        }
    }

    /// Deletes the selected points. A part of which all points are selected is deleted.
    pub fn delete_selected(&mut self, work: &Work) -> Outcome {
        let parts = match self.changeable(work) {
            Ok(parts) => parts,
            Err(refused) => return Outcome::Refused(refused),
        };
        let mut document = work.draft();
        // From the last part to the first, so that indices stay valid.
        for part in parts.into_iter().rev() {
            let chosen = self.selection.of_part(part);
            let all = chosen.len() == document.scene.parts[part].point_count();
            let done = if all {
                change::delete_part(&mut document, part)
            } else {
                points::delete(&mut document, part, &chosen)
            };
            if let Err(refused) = done {
                return Outcome::Refused(refused);
            }
        }
        self.selection = Selection::default();
        Outcome::Edited(Edit { label: "Delete points", document })
    }

    /// Inserts a point in the middle between neighbouring selected points.
    pub fn insert_between(&mut self, work: &Work) -> Outcome {
        let parts = match self.changeable(work) {
            Ok(parts) => parts,
            Err(refused) => return Outcome::Refused(refused),
        };
        let mut document = work.draft();
        let mut new = Vec::new();
        for part in parts {
            let chosen = self.selection.of_part(part);
            let (count, segments) =
                (document.scene.parts[part].point_count(), document.scene.parts[part].segment_count());
            let both = |k: &usize| chosen.contains(k) && chosen.contains(&((k + 1) % count));
            let places: BTreeMap<usize, f64> = (0..segments).filter(both).map(|segment| (segment, 0.5)).collect();
            match points::insert(&mut document, part, &places) {
                Ok(inserted) => new.extend(inserted.into_iter().map(|point| Place { part, point })),
                Err(refused) => return Outcome::Refused(refused),
            }
        }
        if new.is_empty() {
            return Outcome::Refused(Refused::new("select two neighbouring points first"));
        }
        self.selection = Selection::of(new);
        Outcome::Edited(Edit { label: "Insert points", document })
    }

    /// Smooths the selected points on the frame.
    pub fn smooth_selected(&mut self, work: &Work) -> Outcome {
        let parts = match self.changeable(work) {
            Ok(parts) => parts,
            Err(refused) => return Outcome::Refused(refused),
        };
        let scene = &work.document.scene;
        let mut moved = BTreeMap::new();
        for part in parts {
            let smoothed = change::smoothed(&scene.parts[part], work.frame, &self.selection.of_part(part));
            moved.extend(smoothed.into_iter().map(|(point, to)| (Place { part, point }, to)));
        }
        let mut document = work.draft();
        match change::move_points(&mut document, work.frame, &moved, &BTreeSet::new()) {
            Ok(true) => Outcome::Edited(Edit { label: "Smooth points", document }),
            Ok(false) => Outcome::Refused(Refused::new("select points of a shape on this frame first")),
            Err(refused) => Outcome::Refused(refused),
        }
    }

    /// Gives the selected points a feather.
    pub fn feather_selected(&mut self, work: &Work, width: f64) -> Outcome {
        let parts = match self.changeable(work) {
            Ok(parts) => parts,
            Err(refused) => return Outcome::Refused(refused),
        };
        let places: Vec<Place> = self.selection.iter().filter(|place| parts.contains(&place.part)).collect();
        if places.is_empty() {
            return Outcome::Refused(Refused::new("select points first"));
        }
        let mut document = work.draft();
        match feather::set(&mut document, &places, width) {
            Ok(true) => Outcome::Edited(Edit { label: "Feather points", document }),
            Ok(false) => Outcome::Shown,
            Err(refused) => Outcome::Refused(refused),
        }
    }
}
