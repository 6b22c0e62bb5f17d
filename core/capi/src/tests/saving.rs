//! Tests of saving: no frame of the footage is written over, and nothing that another program wrote meanwhile.

use super::{Fine, Owned, RototoonSession, outcome, take};
use crate::files_abi::{rototoon_file_mark, rototoon_file_replace};
use crate::session_abi::{rototoon_session_open, rototoon_session_save};
use crate::status::RototoonStatus::{self, Error};
use std::fs;
use std::path::Path;
use std::ptr::null_mut;

fn save(session: *const RototoonSession, path: &Path) -> (RototoonStatus, String) {
    let path = path.to_str().unwrap();
    // SAFETY: a living session, a text with its length.
    outcome(|error| unsafe { rototoon_session_save(session, path.as_ptr(), path.len(), error) })
}

/// A session of a project file.
fn opened(path: &Path) -> Owned {
    let (place, mut session) = (path.to_str().unwrap(), null_mut());
    // SAFETY: a text with its length, and a local.
    let found = outcome(|error| unsafe { rototoon_session_open(place.as_ptr(), place.len(), &mut session, error) });
    assert_eq!(found, (Fine, String::new()));
    Owned(session)
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
    let session = opened(&project);
    let mut frames = vec!["frames/f_001.png", "frames/../frames/f_000.png"];
    if cfg!(unix) {
        fs::hard_link(at("frames/f_001.png"), at("hard.json")).unwrap();
        frames.push("hard.json");
    }
    for frame in frames {
        let (status, said) = save(session.0, &at(frame));
        assert!(status == Error && said.contains(frame) && said.contains("reads"), "{frame}: {said}");
    }
    assert_eq!(fs::read_to_string(at("frames/f_000.png")).unwrap(), "frames/f_000.png");
    assert_eq!(fs::read_to_string(at("frames/f_001.png")).unwrap(), "frames/f_001.png");
    // The project itself is what is saved, and a name that is free is free.
    assert_eq!(save(session.0, &project), (Fine, String::new()));
    assert_eq!(save(session.0, &at("frames/new.json")), (Fine, String::new()));
}

#[test]
fn what_another_program_wrote_meanwhile_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (project, theirs) = (at("shot.json"), super::DOCUMENT.replace("near arm", "far arm"));
    fs::write(&project, super::DOCUMENT).unwrap();
    let session = opened(&project);
    assert_eq!(save(session.0, &project), (Fine, String::new()), "nobody wrote");
    assert_eq!(save(session.0, &project), (Fine, String::new()), "what the session saved is its own");
    fs::write(&project, &theirs).unwrap();
    let (status, said) = save(session.0, &project);
    let named = [&project, &at("shot (2).json")].iter().all(|path| said.contains(path.to_str().unwrap()));
    assert!(status == Error && named, "{said}");
    assert_eq!(fs::read_to_string(&project).unwrap(), theirs);
    assert!(fs::read_to_string(at("shot (2).json")).unwrap().contains("near arm"));
    // Of a file that the session did not read the user chose the name.
    fs::write(at("other.json"), &theirs).unwrap();
    assert_eq!(save(session.0, &at("other.json")), (Fine, String::new()));
    assert!(fs::read_to_string(at("other.json")).unwrap().contains("near arm"));
}

fn mark(path: &Path) -> String {
    let (place, mut mark) = (path.to_str().unwrap(), null_mut());
    // SAFETY: a text with its length, and a local.
    let found = outcome(|error| unsafe { rototoon_file_mark(place.as_ptr(), place.len(), &mut mark, error) });
    assert_eq!(found, (Fine, String::new()));
    take(mark)
}

fn replace(path: &Path, content: &str, read: &str) -> Result<String, String> {
    let (place, mut mark) = (path.to_str().unwrap(), null_mut());
    // SAFETY: texts with their lengths, and a local.
    let (status, said) = outcome(|error| unsafe {
        let texts = [place, content, read].map(|text| (text.as_ptr(), text.len()));
        let [(path, path_length), (content, content_length), (read, read_length)] = texts;
        rototoon_file_replace(path, path_length, content, content_length, read, read_length, &mut mark, error)
    });
    let mark = take(mark);
    if status == Fine { Ok(mark) } else { Err(said) }
}

#[test]
fn a_caller_with_a_document_of_its_own_keeps_the_mark() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shot.json");
    assert_eq!(mark(&path), "");
    let own = replace(&path, "one", "").unwrap();
    assert_eq!(own, mark(&path));
    assert_eq!(fs::read_to_string(&path).unwrap(), "one");
    let own = replace(&path, "two", &own).unwrap();
    fs::write(&path, "theirs").unwrap();
    let said = replace(&path, "three", &own).unwrap_err();
    assert!(said.contains("shot (2).json"), "{said}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "theirs");
    assert_eq!(fs::read_to_string(folder.path().join("shot (2).json")).unwrap(), "three");
    let said = replace(&path, "three", "no mark").unwrap_err();
    assert!(said.starts_with("read: found \"no mark\", expected a mark"), "{said}");
}
