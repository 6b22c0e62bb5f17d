//! What an import did to a document, in words.

use super::report::runs;
use crate::import::{Change, Merged};
use crate::scene::FrameNumber;
use std::collections::BTreeSet;

/// What an import did to a document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Imported {
    /// What the shapes did to the document.
    pub merged: Merged,
    /// A line for each element that was left out or may be wrong.
    pub warnings: Vec<String>,
}

impl Imported {
    /// Adds what another file did afterwards. A part that both change is told once.
    pub fn join(&mut self, after: Self) {
        self.warnings.extend(after.warnings);
        let (own, after) = (&mut self.merged, after.merged);
        own.moved.extend(after.moved);
        own.moved.sort();
        own.moved.dedup();
        // What stays is what no file speaks of.
        for taken in &after.taken {
            let of = |kept: &[(String, Vec<FrameNumber>)]| kept.iter().position(|(name, _)| *name == taken.name);
            let frames = of(&after.kept).map_or(&[][..], |place| &after.kept[place].1);
            match of(&own.kept) {
                Some(place) => own.kept[place].1.retain(|frame| frames.contains(frame)),
                None if own.taken.iter().any(|known| known.name == taken.name) => {}
                None => own.kept.push((taken.name.clone(), frames.to_vec())),
            }
        }
        own.kept.retain(|(_, frames)| !frames.is_empty());
        for taken in after.taken {
            match own.taken.iter_mut().find(|known| known.name == taken.name) {
                Some(known) => known.change = both(&known.change, taken.change),
                None => own.taken.push(taken),
            }
        }
    }

    /// What an import did to parts that the document had, in words; nothing if all shapes are new parts.
    pub fn told(&self) -> Option<String> {
        let group =
            |what: &str, names: Vec<String>| (!names.is_empty()).then(|| format!("{what} {}", names.join(", ")));
        let mut told: Vec<String> = [
            group("changed", self.of(changed)),
            group("replaced with all keys and corrections", self.named(&Change::Replaced)),
            group("as before", self.named(&Change::Nothing)),
            group("at another depth", self.merged.moved.iter().map(|name| format!("{name:?}")).collect()),
            group("new, since one of both is open", self.of(beside)),
        ]
        .into_iter()
        .flatten()
        .collect();
        let new = if told.is_empty() { Vec::new() } else { self.named(&Change::New) };
        told.extend(group("new", new));
        told.extend(self.kept());
        (!told.is_empty()).then(|| told.join("; "))
    }

    /// What is told of the shapes of which something is told.
    fn of(&self, told: impl Fn(&str, &Change) -> Option<String>) -> Vec<String> {
        self.merged.taken.iter().filter_map(|taken| told(&taken.name, &taken.change)).collect()
    }

    /// The names of the shapes that did this.
    fn named(&self, change: &Change) -> Vec<String> {
        self.of(|name, own| (own == change).then(|| format!("{name:?}")))
    }

    /// What is told of frames of which the file does not speak.
    fn kept(&self) -> Option<String> {
        let frames: BTreeSet<FrameNumber> = self.merged.kept.iter().flat_map(|(_, frames)| frames).copied().collect();
        let parts = match &self.merged.kept[..] {
            [] => return None,
            [(name, _)] => format!("{name:?}"),
            all => format!("{} parts", all.len()),
        };
        let frames = runs(&frames.into_iter().collect::<Vec<_>>());
        Some(format!("the file says nothing of the frames {frames} of {parts}: they stay as they are"))
    }
}

/// What is told of a part that was changed.
fn changed(name: &str, change: &Change) -> Option<String> {
    match change {
        Change::Frames(frames) if frames.is_empty() => Some(format!("{name:?} in its falloff")),
        Change::Frames(frames) => Some(format!("{name:?} on {}", runs(frames))),
        _ => None,
    }
}

/// What is told of a part that is beside another one.
fn beside(name: &str, change: &Change) -> Option<String> {
    let Change::Beside(other) = change else { return None };
    Some(format!("{name:?} beside {other:?}"))
}

/// What two files did to one part.
fn both(first: &Change, second: Change) -> Change {
    match (first, second) {
        (Change::Frames(a), Change::Frames(b)) => {
            Change::Frames(a.iter().chain(&b).copied().collect::<BTreeSet<_>>().into_iter().collect())
        }
        (Change::Nothing, second) => second,
        (first, Change::Replaced) if *first != Change::New => Change::Replaced,
        (first, _) => first.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::Taken;

    fn imported(name: &str, change: Change, kept: &[FrameNumber]) -> Imported {
        let taken = vec![Taken { name: name.into(), change }];
        let kept = if kept.is_empty() { Vec::new() } else { vec![(name.into(), kept.to_vec())] };
        Imported { merged: Merged { taken, kept, ..Merged::default() }, warnings: Vec::new() }
    }

    #[test]
    fn several_files_are_told_as_one() {
        let mut all = imported("arm", Change::Nothing, &[1, 2, 3, 5]);
        all.join(imported("arm", Change::Frames(vec![3]), &[1, 2, 4, 5]));
        all.join(imported("arm", Change::Frames(vec![5]), &[1, 2, 3, 4]));
        all.join(imported("leg", Change::New, &[]));
        let told = all.told().unwrap();
        assert_eq!(
            told,
            "changed \"arm\" on 3, 5; new \"leg\"; the file says nothing of the frames 1-2 of \"arm\": they stay as they are"
        );
        all.join(imported("arm", Change::Nothing, &[3, 4, 5]));
        assert!(all.told().unwrap().ends_with("new \"leg\""));
    }

    #[test]
    fn what_a_file_does_to_a_part_of_another_file_is_that_of_the_first() {
        let frames = || Change::Frames(vec![2]);
        assert_eq!(both(&Change::New, frames()), Change::New);
        assert_eq!(both(&frames(), Change::Replaced), Change::Replaced);
        assert_eq!(both(&Change::Nothing, Change::Nothing), Change::Nothing);
    }
}
