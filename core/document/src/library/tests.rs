use super::*;
use rototoon_base::geometry::Point;

fn clip(character: &str, motion: &str, frames: usize) -> Clip {
    Clip::new(character, motion, (0..frames).map(|f| [Point::new(f as f64, 1.0); 17]).collect())
}

/// Adds a clip, whether or not there is one of its names.
fn put(library: &mut Library, clip: &Clip, fps: f64, source: &str) -> Result<Added, AddError> {
    let clips = Clips { clips: vec![clip.clone()], fps };
    library.add(&[Addition { clips: &clips, source }], Existing::Replace)
}

/// The clips of some words at their own rates, and what is wrong.
fn read(library: &Library, character: &str, motion: &str) -> (Vec<Clip>, Vec<Trouble>) {
    let found = library.checked(|entry| entry.has(character, motion));
    let troubles = found.troubles().cloned().collect();
    (found.clips.into_iter().map(|(_, clip)| clip).collect(), troubles)
}

fn filled() -> (tempfile::TempDir, Library) {
    let folder = tempfile::tempdir().unwrap();
    let mut library = Library::open(&folder.path().join("clips"));
    put(&mut library, &clip("Ann", "walk", 3), 12.0, "shot 7").unwrap();
    put(&mut library, &clip("Ann", "run", 2), 12.0, "").unwrap();
    put(&mut library, &clip("Bo/b", "walk", 4), 24.0, "").unwrap();
    (folder, library)
}

#[test]
fn what_is_added_is_found_again() {
    let (folder, _) = filled();
    let library = Library::open(&folder.path().join("clips"));
    assert!(library.troubles().is_empty());
    assert_eq!(library.entries().len(), 3);
    assert_eq!((library.entries()[0].frames, library.entries()[0].source.as_str()), (3, "shot 7"));
    assert_eq!(library.search("", "WALK").count(), 2);
    let (clips, troubles) = read(&library, "ann", "run");
    assert_eq!((clips, troubles), (vec![clip("Ann", "run", 2)], vec![]));
}

#[test]
fn a_clip_takes_the_place_of_the_same() {
    let (folder, mut library) = filled();
    put(&mut library, &clip("Ann", "walk", 9), 12.0, "").unwrap();
    let library = Library::open(&folder.path().join("clips"));
    assert_eq!(library.entries().iter().map(|e| e.frames).collect::<Vec<_>>(), [9, 2, 4]);
}

#[test]
fn of_a_damaged_library_the_rest_is_used() {
    let (folder, library) = filled();
    let folder = folder.path().join("clips");
    fs::write(folder.join(&library.entries()[1].file), "{").unwrap();
    let reopened = Library::open(&folder);
    let (clips, troubles) = read(&reopened, "", "");
    assert_eq!((clips.len(), troubles.len()), (2, 1));
    assert!(troubles[0].to_string().contains("ann-run.clip.json: found text that is not JSON"), "{}", troubles[0]);
    let later = "{\"rototoon_clips\": 9, \"clips\": [], \"more\": {}}";
    fs::write(folder.join(&library.entries()[1].file), later).unwrap();
    let (clips, troubles) = read(&reopened, "", "");
    assert_eq!(clips.iter().map(|clip| clip.character.as_str()).collect::<Vec<_>>(), ["Ann", "Bo/b"]);
    assert!(troubles[0].to_string().contains("found version 9, expected 2 or less"), "{}", troubles[0]);
    for (index, said) in
        [("[", "not an index of clips"), ("{\"rototoon_library\": 2, \"clips\": []}", "found version 2")]
    {
        fs::write(folder.join(INDEX), index).unwrap();
        let rebuilt = Library::open(&folder);
        assert_eq!(rebuilt.entries().len(), 2);
        assert!(rebuilt.troubles().iter().any(|t| t.to_string().contains(said)));
    }
}

#[test]
fn files_put_into_the_folder_are_found_and_twins_reported() {
    let (folder, library) = filled();
    let folder = folder.path().join("clips");
    fs::copy(folder.join(&library.entries()[0].file), folder.join("copy.clip.json")).unwrap();
    Clips { clips: vec![clip("Cy", "bow", 1)], fps: 8.0 }.save(&folder.join("new.clip.json")).unwrap();
    let reopened = Library::open(&folder);
    assert_eq!(reopened.entries().last().map(|e| (e.character.as_str(), e.fps)), Some(("Cy", 8.0)));
    assert!(matches!(reopened.troubles(), [Trouble::Twice { .. }]));
}

#[test]
fn a_copy_under_a_strange_name_does_not_win_over_the_original() {
    let (folder, library) = filled();
    let folder = folder.path().join("clips");
    let own = library.entries()[0].file.clone();
    for copy in ["ann-walk (conflicted copy).clip.json", "ann-walk-2.clip.json", "aa.clip.json"] {
        Clips { clips: vec![clip("Ann", "walk", 9)], fps: 12.0 }.save(&folder.join(copy)).unwrap();
    }
    let used =
        |library: &Library| library.search("ann", "walk").map(|e| (e.file.clone(), e.frames)).collect::<Vec<_>>();
    assert_eq!(used(&Library::open(&folder)), [(own.clone(), 3)]);
    fs::write(folder.join(INDEX), "[").unwrap();
    let rebuilt = Library::open(&folder);
    assert_eq!(used(&rebuilt), [(own.clone(), 3)]);
    assert_eq!(
        rebuilt.troubles().iter().filter(|t| matches!(t, Trouble::Twice { first, .. } if *first == own)).count(),
        3
    );
    // Without the original the one with a number is the library's own.
    fs::remove_file(folder.join(&own)).unwrap();
    assert_eq!(used(&Library::open(&folder)), [("ann-walk-2.clip.json".to_owned(), 9)]);
}

#[test]
fn entries_without_a_usable_file_are_reported() {
    let (folder, library) = filled();
    let folder = folder.path().join("clips");
    fs::write(folder.join(&library.entries()[0].file), "{").unwrap();
    fs::remove_file(folder.join(&library.entries()[1].file)).unwrap();
    Clips { clips: vec![clip("Bo/b", "walk", 7)], fps: 12.0 }.save(&folder.join(&library.entries()[2].file)).unwrap();
    let library = Library::open(&folder);
    let found = library.checked(|_| true);
    let good: Vec<&Entry> = found.clips.iter().map(|(entry, _)| entry).collect();
    assert_eq!(good.iter().map(|e| (e.motion.as_str(), e.frames, e.fps)).collect::<Vec<_>>(), [("walk", 7, 12.0)]);
    let said: Vec<String> = found.troubles().map(ToString::to_string).collect();
    assert!(
        said.len() == 2 && said[0].contains("ann-walk.clip.json") && said[1].contains("ann-run.clip.json"),
        "{said:?}"
    );
}

#[test]
fn clips_of_several_frame_rates_are_read_at_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut library = Library::open(folder.path());
    for (motion, frames, fps) in [("walk", 5, 24.0), ("run", 9, 48.0), ("hop", 9, 48.0), ("fly", 3, 12.0)] {
        put(&mut library, &clip("Ann", motion, frames), fps, "").unwrap();
    }
    let counts = |fps: f64| {
        let found = library.checked(|_| true);
        assert!(found.unusable.is_empty());
        found.at_rate(fps).clips.iter().map(|clip| clip.postures.len()).collect::<Vec<_>>()
    };
    assert_eq!((counts(24.0), counts(48.0)), (vec![5, 5, 5, 5], vec![9, 9, 9, 9]));
    assert_eq!(read(&library, "", "").0[1].postures.len(), 9, "as it is");
    assert_eq!(Library::usual_rate(library.entries().iter()), 48.0);
    assert_eq!(Library::usual_rate(library.search("", "walk")), 24.0);
    assert_eq!(Library::usual_rate(library.search("", "swim")), 25.0);
}

#[test]
fn entries_that_cannot_be_used_are_named_and_the_rest_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let entry = |file: &str, more: &str| {
        format!(r#"{{"file": {file}, "character": "a", "motion": {file}, "frames": 1, "fps": 1{more}}}"#)
    };
    let cases = [
        (
            entry(r#""../x.clip.json""#, ""),
            "clips[0].file: found \"../x.clip.json\", expected a name within the folder",
        ),
        (entry(r#""c:x.clip.json""#, ""), "clips[0].file: found"),
        (entry(r#""library.json""#, ""), "that ends in .clip.json"),
        (entry("7", ""), "clips[0].file: found 7, expected a text"),
        (entry(r#""a.clip.json""#, r#", "fps": "x""#), "clips[0].fps: found \"x\", expected a positive number"),
        (entry(r#""a.clip.json""#, r#", "frames": -1"#), "clips[0].frames: found -1, expected a whole number"),
        ("[]".into(), "clips[0]: found [], expected an object"),
        (entry(r#""B.clip.json""#, "") + "," + &entry(r#""b.clip.json""#, ""), "clips[1].file: found \"b.clip.json\""),
    ];
    for (clips, said) in cases {
        let good = entry(r#""good.clip.json""#, "");
        fs::write(folder.path().join(INDEX), format!(r#"{{"rototoon_library": 1, "clips": [{clips}, {good}]}}"#))
            .unwrap();
        let library = Library::open(folder.path());
        assert_eq!(library.entries().last().unwrap().file, "good.clip.json", "{clips}");
        let [trouble] = library.troubles() else { panic!("{:?}", library.troubles()) };
        assert!(trouble.to_string().contains(said), "{trouble}");
    }
}

#[test]
fn fields_of_others_and_their_order_stay() {
    let (folder, _) = filled();
    let index = folder.path().join("clips").join(INDEX);
    let text = fs::read_to_string(&index).unwrap();
    let more = text.replacen("\"clips\"", "\"studio\": {\n    \"b\": 1,\n    \"a\": 2\n  },\n  \"clips\"", 1);
    let more = more.replacen("\"source\": \"shot 7\"", "\"source\": \"shot 7\",\n      \"rating\": 5", 1);
    fs::write(&index, &more).unwrap();
    let mut library = Library::open(index.parent().unwrap());
    put(&mut library, &clip("Ann", "run", 2), 12.0, "").unwrap();
    assert_eq!(fs::read_to_string(&index).unwrap(), more, "nothing else changes");
    put(&mut library, &clip("Ann", "walk", 9), 12.0, "new").unwrap();
    let new = more.replacen("\"frames\": 3", "\"frames\": 9", 1).replacen("shot 7", "new", 1);
    assert_eq!(fs::read_to_string(&index).unwrap(), new);
}

#[test]
fn an_index_that_is_not_understood_is_never_changed() {
    let (folder, mut library) = filled();
    let index = folder.path().join("clips").join(INDEX);
    let later = r#"{"rototoon_library": 2, "clips": [], "more": 1}"#;
    fs::write(&index, later).unwrap();
    let error = put(&mut library, &clip("Cy", "bow", 1), 8.0, "").unwrap_err();
    assert!(error.to_string().contains("found an index of version 2, expected 1 or less"), "{error}");
    assert_eq!(fs::read_to_string(&index).unwrap(), later);
    fs::remove_file(&index).unwrap();
    fs::create_dir(&index).unwrap();
    let reopened = Library::open(index.parent().unwrap());
    assert!(reopened.troubles()[0].to_string().contains("cannot read the index: it is a folder"));
    assert_eq!(reopened.entries().len(), 3, "the files are read instead");
    assert!(matches!(put(&mut library, &clip("Cy", "bow", 1), 8.0, "").unwrap_err(), AddError::Unreadable { .. }));
    assert!(index.is_dir());
    assert_eq!(fs::read_dir(index.parent().unwrap()).unwrap().count(), 5, "three clips, the folder and the lock");
}

#[test]
fn damaged_indexes_are_set_aside() {
    let (folder, _) = filled();
    let folder = folder.path().join("clips");
    let text = fs::read(folder.join(INDEX)).unwrap();
    let at = text.windows(6).position(|w| w == b"shot 7").unwrap();
    let mut latin = text.clone();
    latin[at] = 0xFC;
    for (number, damaged, sources) in [(1, &latin[..], 1), (2, &text[..at], 0)] {
        fs::write(folder.join(INDEX), damaged).unwrap();
        let mut library = Library::open(&folder);
        assert_eq!(library.troubles().len(), 1, "{:?}", library.troubles());
        let aside = put(&mut library, &clip("Cy", "bow", 1), 8.0, "").unwrap().aside.unwrap();
        assert!(aside.ends_with(format!("library.damaged-{number}.json")));
        assert_eq!(fs::read(aside).unwrap(), damaged);
        let reopened = Library::open(&folder);
        assert!(reopened.troubles().is_empty());
        assert_eq!(reopened.entries().len(), 4);
        assert_eq!(reopened.entries().iter().filter(|e| !e.source.is_empty()).count(), sources);
    }
}

#[test]
fn only_the_file_of_the_same_clip_is_replaced() {
    let (folder, mut library) = filled();
    let folder = folder.path().join("clips");
    let other = folder.join("other.clip.json");
    let kept = [b"{ not finished".to_vec(), fs::read(folder.join("ann-run.clip.json")).unwrap()];
    for content in kept {
        fs::write(&other, &content).unwrap();
        let text = fs::read_to_string(folder.join(INDEX)).unwrap();
        let file = Library::open(&folder).entries()[0].file.clone();
        fs::write(folder.join(INDEX), text.replace(&file, "other.clip.json")).unwrap();
        put(&mut library, &clip("Ann", "walk", 7), 12.0, "").unwrap();
        assert_eq!(fs::read(&other).unwrap(), content);
        let reopened = Library::open(&folder);
        let (clips, _) = read(&reopened, "ann", "walk");
        assert_eq!(clips, [clip("Ann", "walk", 7)]);
    }
}

#[test]
fn labels_of_any_length_have_a_file() {
    let (folder, mut library) = filled();
    let long = "ü".repeat(300);
    put(&mut library, &clip(&long, &long, 1), 8.0, "").unwrap();
    put(&mut library, &clip(&format!("{long}2"), &long, 1), 8.0, "").unwrap();
    assert_eq!(Library::open(&folder.path().join("clips")).entries().len(), 5);
}

#[test]
fn nothing_is_lost_if_many_add_at_once() {
    let folder = tempfile::tempdir().unwrap();
    std::thread::scope(|scope| {
        for who in 0..8 {
            let folder = folder.path();
            scope.spawn(move || {
                let mut library = Library::open(folder);
                for what in 0..15 {
                    let (who, what) = (format!("c{who}"), format!("m{what}"));
                    put(&mut library, &clip(&who, &what, 1), 12.0, &format!("shot {who} {what}")).unwrap();
                }
            });
        }
    });
    let library = Library::open(folder.path());
    assert!(library.troubles().is_empty());
    assert_eq!(
        library.entries().iter().filter(|e| e.source == format!("shot {} {}", e.character, e.motion)).count(),
        120
    );
}

#[test]
fn a_clip_that_is_there_is_only_replaced_on_request() {
    let (folder, mut library) = filled();
    let folder = folder.path().join("clips");
    let before = contents(&folder);
    let clips = Clips { clips: vec![clip("Cy", "bow", 1), clip("Ann", "walk", 9), clip("Ann", "run", 9)], fps: 12.0 };
    let added = [Addition { clips: &clips, source: "shot 8" }];
    let said = library.add(&added, Existing::Refuse).unwrap_err().to_string();
    let expected = format!(
        "{}: found \"walk\" by \"Ann\" already (ann-walk.clip.json, 3 frames, from \"shot 7\"), and 1 more of these clips, \
         expected another character or motion, or \"replace\"",
        folder.display()
    );
    assert_eq!((said, contents(&folder)), (expected, before), "nothing is added");
    let done = library.add(&added, Existing::Replace).unwrap();
    assert_eq!(
        done.replaced.iter().map(|e| (e.motion.as_str(), e.frames)).collect::<Vec<_>>(),
        [("walk", 3), ("run", 2)]
    );
    assert_eq!(library.entries().iter().map(|e| e.frames).collect::<Vec<_>>(), [9, 9, 4, 1]);
}

#[test]
fn an_entry_without_a_file_is_filled_and_one_with_a_damaged_file_is_refused() {
    let (folder, mut library) = filled();
    let folder = folder.path().join("clips");
    let again = Clips { clips: vec![clip("Ann", "walk", 9)], fps: 12.0 };
    let added = [Addition { clips: &again, source: "" }];
    fs::write(folder.join("ann-walk.clip.json"), "{").unwrap();
    assert!(matches!(library.add(&added, Existing::Refuse), Err(AddError::Taken(_))));
    fs::remove_file(folder.join("ann-walk.clip.json")).unwrap();
    assert_eq!(library.add(&added, Existing::Refuse).unwrap(), Added::default());
    assert_eq!(library.entries()[0].frames, 9);
}

#[test]
fn a_file_put_into_the_folder_is_not_replaced_either() {
    let (folder, mut library) = filled();
    let clips = Clips { clips: vec![clip("Cy", "bow", 1)], fps: 8.0 };
    clips.save(&folder.path().join("clips").join("new.clip.json")).unwrap();
    let error = library.add(&[Addition { clips: &clips, source: "" }], Existing::Refuse).unwrap_err();
    assert!(error.to_string().contains("\"bow\" by \"Cy\" already (new.clip.json, 1 frame),"), "{error}");
}

#[test]
fn two_added_clips_of_one_name_are_refused() {
    let (folder, mut library) = filled();
    let before = contents(&folder.path().join("clips"));
    let clips = Clips { clips: vec![clip("Cy", "bow", 1)], fps: 8.0 };
    let error = library.add(&[Addition { clips: &clips, source: "" }; 2], Existing::Replace).unwrap_err();
    assert!(error.to_string().starts_with("found two clips \"bow\" by \"Cy\" to add"), "{error}");
    assert_eq!(contents(&folder.path().join("clips")), before);
}

#[test]
fn of_many_that_add_the_same_clip_at_once_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let start = std::sync::Barrier::new(8);
    let add = |frames: usize| {
        // All look at the empty library before any of them adds.
        let mut library = Library::open(folder.path());
        start.wait();
        let clips = Clips { clips: vec![clip("Ann", "walk", frames)], fps: 12.0 };
        let added = library.add(&[Addition { clips: &clips, source: "" }], Existing::Refuse);
        added.map(|_| frames).map_err(|error| assert!(matches!(error, AddError::Taken(_)), "{error}"))
    };
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (1..=8).map(|frames| scope.spawn(move || add(frames))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let added: Vec<usize> = outcomes.into_iter().flatten().collect();
    let library = Library::open(folder.path());
    assert_eq!(read(&library, "", "").0, [clip("Ann", "walk", added[0])]);
    assert_eq!(added.len(), 1);
}

/// The files of a folder and what is in them.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found: Vec<_> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    found.sort();
    found.into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect()
}

/// Files of `filled`: of Ann's walk and run and of Bo's walk, with an entry for each.
fn mixed_up(change: impl FnOnce(&Path)) -> (tempfile::TempDir, Library) {
    let (folder, _) = filled();
    let path = folder.path().join("clips");
    change(&path);
    let library = Library::open(&path);
    (folder, library)
}

fn names(found: &Checked) -> Vec<(&str, &str, &str)> {
    found.clips.iter().map(|(e, _)| (e.character.as_str(), e.motion.as_str(), e.file.as_str())).collect()
}

#[test]
fn a_file_copied_over_another_is_named_and_the_rest_is_used() {
    let (folder, mut library) = mixed_up(|path| {
        fs::copy(path.join("ann-walk.clip.json"), path.join("ann-run.clip.json")).unwrap();
    });
    let path = folder.path().join("clips");
    let found = library.checked(|_| true);
    assert_eq!(names(&found), [("Ann", "walk", "ann-walk.clip.json"), ("Bo/b", "walk", "bo_b-walk.clip.json")]);
    let said: Vec<String> = found.troubles().map(ToString::to_string).collect();
    let twin = path.join("ann-run.clip.json").display().to_string();
    assert_eq!(
        said,
        [format!(
            "{twin}: found a second clip of character \"Ann\" and motion \"walk\"; the clip in ann-walk.clip.json is used"
        )]
    );
    assert_eq!(names(&library.named("Ann", "walk")), [("Ann", "walk", "ann-walk.clip.json")]);
    assert!(library.named("Ann", "run").clips.is_empty());
    // The run is not there, so it may be added, and the file that was copied stays.
    let again = Clips { clips: vec![clip("Ann", "run", 5)], fps: 12.0 };
    assert_eq!(library.add(&[Addition { clips: &again, source: "" }], Existing::Refuse).unwrap(), Added::default());
    let found = Library::open(&path).checked(|entry| entry.has("ann", ""));
    assert_eq!(names(&found), [("Ann", "walk", "ann-walk.clip.json"), ("Ann", "run", "ann-run-2.clip.json")]);
    assert!(path.join("ann-run.clip.json").is_file());
}

#[test]
fn a_character_renamed_in_a_file_is_found_by_its_new_name_and_not_added_twice() {
    let (folder, mut library) = mixed_up(|path| {
        Clips { clips: vec![clip("Charles", "walk", 6)], fps: 24.0 }.save(&path.join("ann-walk.clip.json")).unwrap();
    });
    let expected = [("Charles", "walk", "ann-walk.clip.json")];
    assert_eq!(names(&library.named("Charles", "walk")), expected);
    assert_eq!(names(&library.checked(|entry| entry.has("charles", ""))), expected);
    assert!(library.named("Ann", "walk").clips.is_empty());
    let again = Clips { clips: vec![clip("Charles", "walk", 9)], fps: 12.0 };
    let add = |library: &mut Library, existing| library.add(&[Addition { clips: &again, source: "new" }], existing);
    assert!(matches!(add(&mut library, Existing::Refuse), Err(AddError::Taken(_))));
    let done = add(&mut library, Existing::Replace).unwrap();
    assert_eq!(
        done.replaced.iter().map(|e| (e.frames, e.fps, e.source.as_str())).collect::<Vec<_>>(),
        [(6, 24.0, "shot 7")]
    );
    let library = Library::open(&folder.path().join("clips"));
    assert_eq!(library.entries().len(), 3);
    assert_eq!((library.entries()[0].character.as_str(), library.entries()[0].frames), ("Charles", 9));
}

#[test]
fn of_two_files_with_one_clip_that_of_the_index_is_used_however_they_are_read() {
    let (folder, mut library) = mixed_up(|path| {
        let text = fs::read_to_string(path.join(INDEX)).unwrap();
        fs::rename(path.join("ann-run.clip.json"), path.join("mine.clip.json")).unwrap();
        fs::write(path.join(INDEX), text.replace("ann-run.clip.json", "mine.clip.json").replace("ann-walk", "ann-run"))
            .unwrap();
        Clips { clips: vec![clip("Ann", "run", 8)], fps: 12.0 }.save(&path.join("ann-run.clip.json")).unwrap();
        fs::remove_file(path.join("ann-walk.clip.json")).unwrap();
    });
    let expected = [("Ann", "run", "mine.clip.json")];
    assert_eq!(names(&library.named("Ann", "run")), expected);
    assert_eq!(names(&library.checked(|entry| entry.has("ann", "run"))), expected);
    assert_eq!(names(&library.named("", "run")), expected);
    put(&mut library, &clip("Ann", "run", 1), 12.0, "").unwrap();
    assert_eq!(read(&Library::open(&folder.path().join("clips")), "ann", "run").0, [clip("Ann", "run", 1)]);
}

#[test]
fn files_that_other_systems_hide_are_no_clips() {
    let (_folder, library) = mixed_up(|path| fs::write(path.join("._ann-walk.clip.json"), b"\0\x05\x16\x07").unwrap());
    assert_eq!((library.troubles(), library.entries().len()), (&[][..], 3));
}

#[cfg(unix)]
#[test]
fn everybody_who_may_write_into_the_folder_may_add() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, mut library) = filled();
    let lock = folder.path().join("clips").join("library.lock");
    assert_eq!(fs::metadata(&lock).unwrap().permissions().mode() & 0o777, 0o666, "whatever the mask is");
    // Another user made the file, with an older version.
    fs::set_permissions(&lock, fs::Permissions::from_mode(0o444)).unwrap();
    put(&mut library, &clip("Cy", "bow", 1), 8.0, "").unwrap();
}

#[test]
fn an_index_may_begin_with_a_mark() {
    let (folder, library) = filled();
    let folder = folder.path().join("clips");
    let text = fs::read_to_string(folder.join(INDEX)).unwrap();
    fs::write(folder.join(INDEX), format!("\u{feff}{text}")).unwrap();
    let marked = Library::open(&folder);
    assert_eq!((marked.entries(), marked.troubles().len()), (library.entries(), 0));
}

#[cfg(unix)]
#[test]
fn a_pipe_in_place_of_the_lock_holds_nobody_up() {
    let (folder, mut library) = filled();
    let path = folder.path().join("clips").join("library.lock");
    let _ = fs::remove_file(&path);
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    assert!(put(&mut library, &clip("Cy", "jump", 2), 12.0, "").is_ok());
}
