//! What is selected: by a box, by a click inside, and when the document changes.

use super::{Editor, Outcome, Work};
use crate::roto::edit::{Selection, hit};
use rototoon::geometry::Point;
use rototoon::scene::Scene;

impl Editor {
    /// Keeps the selection to the parts that it was made on, whatever became of the document since.
    pub fn follow(&mut self, scene: &Scene) {
        self.selection.keep_existing(&self.names, scene);
        if !self.names.iter().eq(scene.parts.iter().map(|part| &part.name)) {
            self.names = scene.parts.iter().map(|part| part.name.clone()).collect();
        }
    }

    /// Selects points of a document's parts.
    pub fn select(&mut self, selection: Selection, scene: &Scene) {
        self.follow(scene);
        self.selection = selection;
    }

    /// A part has another name, and stays selected.
    pub fn rename(&mut self, old: &str, new: &str) {
        self.names.iter_mut().filter(|name| *name == old).for_each(|name| new.clone_into(name));
    }

    pub(super) fn select_box(&mut self, work: &Work, corners: [Point; 2]) -> Outcome {
        let found = Selection::of(hit::in_box(&work.document.scene, work.frame, work.parts, corners));
        if self.shift {
            self.selection.add(&found);
        } else {
            self.selection = found;
        }
        self.selected(work)
    }

    pub(super) fn select_inside(&mut self, work: &Work, pen: Point) -> Outcome {
        let found = hit::inside(&work.document.scene, work.frame, work.parts, pen);
        let found = found.map(|part| Selection::part(part, &work.document.scene)).unwrap_or_default();
        if self.shift {
            self.selection.add(&found);
        } else {
            self.selection = found;
        }
        self.selected(work)
    }
}
