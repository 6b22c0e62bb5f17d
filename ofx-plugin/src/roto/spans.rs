//! Which spans of parts wait for *Track*, where *First frame* and *Last frame* limit it.
//!
//! A span is a stretch of frames between neighbouring keys of a part; that of a part with one key reaches to the ends of the footage. An edit
//! changes the spans around it. They are noted until a Track has all of their frames. So the overlay says *track again* as long
//! as any of them waits, and no longer, also where a film is tracked a stretch at a time.
//!
//! Which edits were made since the tracks is known only of parts that were up to date before the first of them. The tracks of others
//! stay old until a complete Track.

use super::job::Tracked;
use super::state::{Span, State};
use rototoon::scene::{Footage, FrameNumber, Part};
use std::collections::{BTreeMap, BTreeSet};

/// What stands for the sum of a part's input where only some of its spans have ever been tracked.
const SOME_SPANS: &str = "some spans";

impl State {
    /// Before an edit: notes the spans that it changes, of parts whose tracks are new or whose changed spans are known.
    pub fn note_changed(&mut self, before: &[Part], after: &[Part], footage: &Footage) {
        for part in after {
            let Some(was) = before.iter().find(|was| was.name == part.name) else { continue };
            if self.is_old(was) && !self.changed.contains_key(&part.name) {
                continue;
            }
            let spans = changed(was, part, footage);
            if !spans.is_empty() {
                let known = self.changed.entry(part.name.clone()).or_default();
                known.extend(spans);
                known.sort_unstable();
                known.dedup();
            }
        }
    }

    /// Notes what was tracked of parts. `before` are the parts as they were before it.
    pub fn note_tracked_spans(&mut self, before: &[Part], tracked: &Tracked) {
        let scene = &tracked.document.scene;
        for &index in &tracked.parts {
            let part = &scene.parts[index];
            let never = before[index].tracks.is_empty() && !self.tracked.contains_key(&part.name);
            let waits = match self.changed.get(&part.name) {
                Some(spans) if !never => spans.clone(),
                _ if never || self.has_other_input(part) => all(part, &scene.footage),
                // Either nothing has changed, or nobody knows what.
                _ if tracked.is_limited => continue,
                _ => Vec::new(),
            };
            let waits: Vec<Span> = waits.into_iter().filter(|span| !tracked.has(span)).collect();
            if waits.is_empty() {
                self.note_tracked([part]);
            } else {
                self.changed.insert(part.name.clone(), waits);
                self.tracked.entry(part.name.clone()).or_insert_with(|| SOME_SPANS.into());
            }
        }
    }
}

/// The spans of a part.
fn all(part: &Part, footage: &Footage) -> Vec<Span> {
    let spans: BTreeSet<Span> = part.keys.keys().flat_map(|&frame| around(part, [frame; 2], footage)).collect();
    spans.into_iter().collect()
}

/// The spans of a part that differ from what it was.
fn changed(was: &Part, part: &Part, footage: &Footage) -> Vec<Span> {
    let mut places: BTreeSet<Span> = BTreeSet::new();
    places.extend(differing(&was.keys, &part.keys));
    places.extend(differing(&was.pins, &part.pins));
    places.extend(differing(&was.centers, &part.centers));
    let hidden = |part: &Part| part.absent.iter().copied().collect::<BTreeSet<Span>>();
    places.extend(hidden(was).symmetric_difference(&hidden(part)));
    places.into_iter().flat_map(|place| around(part, place, footage)).collect()
}

fn differing<T: PartialEq>(
    was: &BTreeMap<FrameNumber, T>,
    now: &BTreeMap<FrameNumber, T>,
) -> impl Iterator<Item = Span> {
    let frames: BTreeSet<FrameNumber> = was.keys().chain(now.keys()).copied().collect();
    frames.into_iter().filter(|frame| was.get(frame) != now.get(frame)).map(|frame| [frame, frame])
}

/// The spans of a part that touch these frames.
fn around(part: &Part, [first, last]: Span, footage: &Footage) -> Vec<Span> {
    // Only a part with one key is followed beyond its keys.
    let ends = if part.keys.len() == 1 { [footage.first, footage.last] } else { [first, last] };
    let before = part.keys.range(..first).next_back().map_or(ends[0], |(frame, _)| *frame);
    let after = part.keys.range(last.saturating_add(1)..).next().map_or(ends[1], |(frame, _)| *frame);
    if first == last && part.keys.contains_key(&first) {
        return vec![[before, first], [first, after]];
    }
    vec![[before.min(first), after.max(last)]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::project::Document;
    use rototoon::scene::Scene;

    fn footage() -> Footage {
        Footage { pattern: "%d.png".into(), first: 0, last: 20, fps: 24.0, width: 8, height: 8, held: false }
    }

    fn points(x: f64) -> Vec<Point> {
        vec![Point::new(x, 2.0), Point::new(3.0, 4.0), Point::new(5.0, 1.0)]
    }

    fn part(keys: &[FrameNumber]) -> Part {
        let keys = keys.iter().map(|&frame| (frame, points(1.0))).collect();
        Part { name: "a".into(), closed: true, keys, ..Part::default() }
    }

    /// Notes that these frames were tracked, which gives the part tracks.
    fn track(state: &mut State, part: &mut Part, [first, last]: Span) {
        let before = [part.clone()];
        part.tracks.extend((first..=last).map(|frame| (frame, points(1.0))));
        let document = Document::new(Scene { footage: footage(), parts: vec![part.clone()] });
        let tracked = Tracked { document, parts: vec![0], range: first..=last, is_limited: [first, last] != [0, 20] };
        state.note_tracked_spans(&before, &tracked);
    }

    fn edit(state: &mut State, part: &mut Part, change: impl FnOnce(&mut Part)) {
        let was = part.clone();
        change(part);
        state.note_known(std::slice::from_ref(&was));
        state.note_changed(std::slice::from_ref(&was), std::slice::from_ref(part), &footage());
    }

    #[test]
    fn a_film_is_tracked_a_stretch_at_a_time() {
        let (mut state, mut part) = (State::default(), part(&[0, 5, 10]));
        track(&mut state, &mut part, [0, 5]);
        assert!(state.is_old(&part), "frames 6 to 9 were never tracked");
        track(&mut state, &mut part, [5, 20]);
        assert!(!state.is_old(&part) && state.changed.is_empty());
        edit(&mut state, &mut part, |part| part.keys.get_mut(&10).unwrap()[0].x = 9.0);
        track(&mut state, &mut part, [0, 5]);
        assert!(state.is_old(&part), "the key that was moved lies elsewhere");
        edit(&mut state, &mut part, |part| part.set_absent(2, 3));
        track(&mut state, &mut part, [5, 10]);
        assert!(state.is_old(&part), "the first span waits too");
        track(&mut state, &mut part, [0, 5]);
        assert!(!state.is_old(&part));
        edit(&mut state, &mut part, |part| drop(part.keys.remove(&5)));
        track(&mut state, &mut part, [4, 10]);
        assert!(state.is_old(&part), "one span from 0 to 10");
        track(&mut state, &mut part, [0, 20]);
        assert!(!state.is_old(&part) && state.changed.is_empty());
    }

    #[test]
    fn the_only_key_has_the_whole_footage() {
        let (mut state, mut part) = (State::default(), part(&[7]));
        track(&mut state, &mut part, [5, 9]);
        assert_eq!(state.changed["a"], [[0, 7], [7, 20]]);
        assert!(state.is_old(&part));
        track(&mut state, &mut part, [0, 20]);
        assert!(!state.is_old(&part));
    }

    #[test]
    fn tracks_of_an_unknown_state_stay_old_until_a_complete_track() {
        let (mut state, mut part) = (State::default(), part(&[0, 5, 10]));
        track(&mut state, &mut part, [0, 20]);
        state.tracked.insert("a".into(), "of an earlier version".into());
        edit(&mut state, &mut part, |part| part.keys.get_mut(&0).unwrap()[0].x = 9.0);
        track(&mut state, &mut part, [0, 10]);
        assert!(state.is_old(&part));
        track(&mut state, &mut part, [0, 20]);
        state.note_stale([&part]);
        track(&mut state, &mut part, [0, 5]);
        assert!(state.is_old(&part), "the source of the other span has changed too");
        track(&mut state, &mut part, [5, 10]);
        assert!(!state.is_old(&part));
    }
}
