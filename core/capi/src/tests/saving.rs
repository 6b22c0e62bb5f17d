//! Tests of saving: no frame of the footage is written over.

use super::{Fine, RototoonSession, outcome};
use crate::session_abi::{rototoon_session_free, rototoon_session_open, rototoon_session_save};
use crate::status::RototoonStatus::{self, Error};
use std::fs;
use std::path::Path;
use std::ptr::null_mut;

fn save(session: *const RototoonSession, path: &Path) -> (RototoonStatus, String) {
    let path = path.to_str().unwrap();
    // SAFETY: a living session, a text with its length.
    outcome(|error| unsafe { rototoon_session_save(session, path.as_ptr(), path.len(), error) })
}

#[test]
fn a_frame_of_the_footage_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("frames")).unwrap();
    for frame in ["frames/f_000.png", "frames/f_001.png"] {
        fs::write(at(frame), frame).unwrap();
    }
    let project = at("shot.json");
    let text = super::DOCUMENT.replace("no_such_%03d.png", "frames/f_%03d.png");
    fs::write(&project, text).unwrap();
    let (place, mut session) = (project.to_str().unwrap(), null_mut());
    // SAFETY: a text with its length, and a local.
    let found = outcome(|error| unsafe { rototoon_session_open(place.as_ptr(), place.len(), &mut session, error) });
    assert_eq!(found, (Fine, String::new()));
    let mut frames = vec!["frames/f_001.png", "frames/../frames/f_000.png"];
    if cfg!(unix) {
        fs::hard_link(at("frames/f_001.png"), at("hard.json")).unwrap();
        frames.push("hard.json");
    }
    for frame in frames {
        let (status, said) = save(session, &at(frame));
        assert!(status == Error && said.contains(frame) && said.contains("reads"), "{frame}: {said}");
    }
    assert_eq!(fs::read_to_string(at("frames/f_000.png")).unwrap(), "frames/f_000.png");
    assert_eq!(fs::read_to_string(at("frames/f_001.png")).unwrap(), "frames/f_001.png");
    // The project itself is what is saved, and a name that is free is free.
    assert_eq!(save(session, &project), (Fine, String::new()));
    assert_eq!(save(session, &at("frames/new.json")), (Fine, String::new()));
    // SAFETY: made by the library, freed once.
    unsafe { rototoon_session_free(session) }
}
