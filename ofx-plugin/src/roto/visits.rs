//! Goes to the frames that need the user: where a part begins to be lost, and where the next key helps most.

use super::instance;
use super::instance::NO_SHAPES;
use super::parts::selected;
use super::standing::{Standing, stretches};
use crate::ofx::{Effect, Failure};
use rototoon::scene::{FrameNumber, Part, Scene};
use rototoon::track::weakest_frame;
use std::collections::BTreeSet;

/// Presses one of the buttons `previousLost`, `nextLost` and `weakest`. `time` is that of the viewer.
pub fn go(effect: &Effect, name: &str, time: f64) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let document = instance.document(&parameters)?;
    let document = document.ok_or_else(|| Failure::Told(NO_SHAPES.into()))?;
    let offset = parameters.int(c"frameOffset", time)?;
    let shown = selected(&document.scene.parts, &parameters.text(c"parts")?).0;
    let parts: Vec<Part> = shown.into_iter().map(|part| document.scene.parts[part].clone()).collect();
    let scene = Scene { parts, footage: document.scene.footage.clone() };
    let found = match name {
        "weakest" => weakest_frame(&scene.parts).map(|weakest| weakest.frame),
        _ => lost(&scene, time - f64::from(offset), name == "nextLost"),
    };
    let Some(frame) = found else {
        return Err(Failure::Told(match name {
            "weakest" => "nothing is tracked yet: press Track first".into(),
            "nextLost" => format!("no part begins to be lost after frame {time}"),
            _ => format!("no part begins to be lost before frame {time}"),
        }));
    };
    let there = i64::from(frame) + i64::from(offset);
    if effect.go_to(there as f64) {
        return Ok(());
    }
    Err(Failure::Told(format!("the frame is {there}: this host does not let a node go there by itself")))
}

/// The nearest frame after or before a time on which a part begins to be lost.
fn lost(scene: &Scene, time: f64, later: bool) -> Option<FrameNumber> {
    let of = |part: &Part| stretches(part, Standing::Lost, &scene.footage).into_iter().map(|[first, _]| first);
    let frames: BTreeSet<FrameNumber> = scene.parts.iter().flat_map(of).collect();
    if later {
        frames.into_iter().find(|frame| f64::from(*frame) > time)
    } else {
        frames.into_iter().rfind(|frame| f64::from(*frame) < time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;
    use rototoon::scene::Footage;

    #[test]
    fn the_beginnings_of_lost_stretches_are_visited_in_order() {
        let part = |low: &[FrameNumber]| Part {
            keys: [(0, vec![Point::ZERO]), (9, vec![Point::ZERO])].into(),
            confidence: low.iter().map(|frame| (*frame, vec![0.2])).collect(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        let scene = Scene { footage, parts: vec![part(&[2, 3, 6]), part(&[3, 4])] };
        let forward = [-1.0, 2.0, 2.5, 3.0, 6.0].map(|time| lost(&scene, time, true));
        assert_eq!(forward, [Some(2), Some(3), Some(3), Some(6), None]);
        assert_eq!([99.0, 6.0, 2.0].map(|time| lost(&scene, time, false)), [Some(6), Some(3), None]);
    }
}
