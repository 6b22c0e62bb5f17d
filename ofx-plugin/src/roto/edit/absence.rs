//! Marks a part as hidden on frames on which the footage does not show it, and as there again.

use super::Refused;
use super::change::inside_footage;
use crate::roto::standing::{Standing, Stretch, stretches};
use rototoon::project::Document;
use rototoon::scene::FrameNumber;

/// Marks a part as hidden on a frame, or as there again if it is hidden. `whole` takes the stretch around the frame on
/// which the part is lost, or hidden. Keys and corrections stay; tracks and snapped paths of hidden frames go, and the next
/// **Track** brings them back where the part is there again.
pub fn toggle(document: &mut Document, part: usize, frame: FrameNumber, whole: bool) -> Result<(), Refused> {
    inside_footage(document, frame)?;
    let footage = document.scene.footage.clone();
    let part = document.scene.parts.get_mut(part).ok_or_else(|| Refused::new("the part is gone"))?;
    let name = &part.name;
    if part.keys.contains_key(&frame) {
        return Err(Refused::new(format!("{name:?} has a key on frame {frame}: delete the key first if it is hidden")));
    }
    if part.is_absent(frame) {
        let [first, last] = if whole { around(&part.absent, frame).unwrap_or([frame; 2]) } else { [frame; 2] };
        part.clear_absent(first, last);
        return Ok(());
    }
    let lost = || around(&stretches(part, Standing::Lost, &footage), frame);
    let stretch = if whole { lost() } else { Some([frame; 2]) };
    let [first, last] = stretch.ok_or_else(|| {
        Refused::new(format!(
            "{name:?} is neither lost nor hidden on frame {frame}: press Hidden here for this frame alone"
        ))
    })?;
    part.set_absent(first, last);
    part.forget_where_absent();
    Ok(())
}

fn around(stretches: &[Stretch], frame: FrameNumber) -> Option<Stretch> {
    stretches.iter().copied().find(|[first, last]| (*first..=*last).contains(&frame))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::scene::{Footage, Part, Scene};

    fn document() -> Document {
        let shape = vec![Point::ZERO, Point::X, Point::Y];
        let part = Part {
            name: "arm".into(),
            closed: true,
            keys: [(0, shape.clone()), (9, shape.clone())].into(),
            tracks: (0..=9).map(|frame| (frame, shape.clone())).collect(),
            confidence: (0..=9)
                .map(|frame| (frame, vec![if (3..6).contains(&frame) { 0.1 } else { 1.0 }; 3]))
                .collect(),
            pins: [(4, [(1, Point::ONE)].into())].into(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        Document::new(Scene { footage, parts: vec![part] })
    }

    #[test]
    fn a_frame_or_a_stretch_is_hidden_and_shown_again() {
        let mut document = document();
        let tracked = |document: &Document| document.scene.parts[0].tracks.keys().copied().collect::<Vec<_>>();
        toggle(&mut document, 0, 7, false).unwrap();
        toggle(&mut document, 0, 4, true).unwrap();
        assert_eq!(document.scene.parts[0].absent, [[3, 5], [7, 7]]);
        assert_eq!(tracked(&document), [0, 1, 2, 6, 8, 9]);
        assert_eq!(document.scene.parts[0].pins[&4][&1], Point::ONE, "what the user made stays");
        toggle(&mut document, 0, 4, false).unwrap();
        assert_eq!(document.scene.parts[0].absent, [[3, 3], [5, 5], [7, 7]]);
        toggle(&mut document, 0, 7, true).unwrap();
        assert_eq!(document.scene.parts[0].absent, [[3, 3], [5, 5]]);
    }

    #[test]
    fn keys_and_what_is_not_lost_are_refused() {
        let mut document = document();
        for (frame, whole, word) in
            [(0, false, "key"), (8, true, "neither lost nor hidden"), (40, false, "frame 40 is outside")]
        {
            let refused = toggle(&mut document, 0, frame, whole).unwrap_err();
            assert!(refused.0.contains(word), "{}", refused.0);
        }
    }
}
