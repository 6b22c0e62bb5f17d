//! Keys beyond the footage.
//!
//! Artists draw shapes with handles: keys before the first and after the last frame of a cut. What lies within the footage is
//! kept. Where a file has keys beyond an end of the footage, the shape gets a key on that end, whose form follows from the keys
//! around it. A shape whose keys all lie on one side has its held form there. The other keys are left out, and told.

use rototoon_base::scene::{Footage, FrameNumber};
use std::collections::BTreeSet;

/// The frames on which a shape gets keys, and what is beyond them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    /// Frames of the footage. Some may have no key in the file.
    pub frames: BTreeSet<FrameNumber>,
    /// Whether the file says anything of the footage: it has a key there or on both sides of it, or none at all.
    pub within: bool,
    /// Frames of keys that are left out.
    beyond: BTreeSet<i64>,
}

impl Kept {
    /// The frames for the times of a file's keys, which are rounded to whole frames.
    pub(super) fn of(times: impl IntoIterator<Item = f64>, footage: &Footage) -> Self {
        let (first, last) = (i64::from(footage.first), i64::from(footage.last));
        let all: BTreeSet<i64> = times.into_iter().map(|time| time.round() as i64).collect();
        let (inside, beyond): (BTreeSet<i64>, BTreeSet<i64>) =
            all.iter().partition(|time| (first..=last).contains(*time));
        let before = all.first().is_some_and(|time| *time < first).then_some(footage.first);
        let after = all.last().is_some_and(|time| *time > last).then_some(footage.last);
        Self {
            within: !inside.is_empty() || before.is_some() && after.is_some() || all.is_empty(),
            frames: inside.into_iter().map(|time| time as FrameNumber).chain(before).chain(after).collect(),
            beyond,
        }
    }

    /// The frames of the left out keys in words; `None` if there are none.
    fn listed(&self) -> Option<String> {
        let (first, last) = (self.beyond.first()?, self.beyond.last()?);
        Some(match self.beyond.len() {
            1 => format!("a key on frame {first}"),
            count => format!("{count} keys on frames {first} to {last}"),
        })
    }

    /// Says which keys of a shape are left out; `None` if all are kept.
    pub(super) fn told(&self, name: &str, footage: &Footage) -> Option<String> {
        let listed = self.listed()?;
        let taken = if self.beyond.len() == 1 { "it is" } else { "they are" };
        let (first, last) = (footage.first, footage.last);
        Some(format!(
            "the shape {name:?} has {listed}, beyond the footage's frames {first} to {last}: {taken} left out, and the keys around an end of the footage give the form there"
        ))
    }

    /// The message for a file of which nothing lies within the footage.
    pub(super) fn refused(&self, footage: &Footage) -> String {
        let listed = self.listed().unwrap_or_else(|| "no key".to_owned());
        format!("found {listed}, expected a frame of the footage, {} to {}", footage.first, footage.last)
    }
}

/// Whether any shape of a file lies within the footage, and the error if none does.
#[derive(Debug)]
pub(super) struct Reach<E> {
    within: bool,
    error: Option<E>,
}

impl<E> Reach<E> {
    pub(super) fn new() -> Self {
        Self { within: false, error: None }
    }

    /// Adds a shape, and the error that it would be for a file of its own.
    pub(super) fn add(&mut self, kept: &Kept, error: impl FnOnce() -> E) {
        self.within |= kept.within;
        if !kept.within && self.error.is_none() {
            self.error = Some(error());
        }
    }

    /// Refuses a file whose shapes all lie beyond the footage.
    pub(super) fn check(self) -> Result<(), E> {
        self.error.filter(|_| !self.within).map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_has_a_key_where_the_file_has_one_beyond_it() {
        let footage = Footage { pattern: "%d".into(), first: 3, last: 9, fps: 1.0, width: 9, height: 9, held: false };
        for (times, frames, within, beyond) in [
            (&[3.0, 9.4][..], &[3, 9][..], true, None),
            (&[], &[], true, None),
            (&[1.0, 2.0, 5.0], &[3, 5], true, Some("2 keys on frames 1 to 2")),
            (&[-4.0, 12.0], &[3, 9], true, Some("2 keys on frames -4 to 12")),
            (&[10.0, 4.0, 4.2], &[4, 9], true, Some("a key on frame 10")),
            (&[20.0], &[9], false, Some("a key on frame 20")),
            (&[20.0, 21.0], &[9], false, Some("2 keys on frames 20 to 21")),
            (&[-1e300, 1e300], &[3, 9], true, Some("2 keys on frames -9223372036854775808 to 9223372036854775807")),
        ] {
            let kept = Kept::of(times.iter().copied(), &footage);
            assert_eq!(kept.frames.iter().copied().collect::<Vec<_>>(), frames, "{times:?}");
            assert_eq!((kept.within, kept.listed().as_deref()), (within, beyond), "{times:?}");
            let mut reach = Reach::new();
            reach.add(&kept, || "beyond");
            assert_eq!(reach.check(), if within { Ok(()) } else { Err("beyond") });
        }
    }
}
