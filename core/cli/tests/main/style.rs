//! Tests of `rototoon style` from the command line.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn rototoon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rototoon")).args(arguments).output().unwrap()
}

fn posture(motion: f64, lean: f64, frame: f64) -> Value {
    let point = |k: usize| {
        let height = [0.0, -0.6, -1.0, -1.2, -1.5, -0.9, -0.4, 0.1, -0.9, -0.4, 0.1, 0.05, 1.0, 1.9, 0.05, 1.0, 1.9][k];
        let side = if (8..11).contains(&k) || k > 13 { -1.0 } else { 1.0 };
        [-lean * height + 0.1 * side * motion * (0.4 * frame).sin() * height, height]
    };
    json!((0..17).map(point).collect::<Vec<_>>())
}

fn library() -> Value {
    let mut clips = Vec::new();
    for (character, lean) in [("plain", 0.0), ("old", 0.4), ("shy", 0.2)] {
        for (motion, swing) in [("walk", 1.0), ("run", 2.0), ("bow", 0.3)] {
            let points: Vec<Value> = (0..8).map(|f| posture(swing, lean, f as f64)).collect();
            clips.push(json!({"character": character, "motion": motion, "points": points}));
        }
    }
    json!({"rototoon_clips": 1, "fps": 12, "clips": clips})
}

fn translate(folder: &Path, more: &[&str]) -> Output {
    let (from, to) = (folder.join("clips.json"), folder.join("out.json"));
    let (from, to) = (from.to_str().unwrap(), to.to_str().unwrap());
    let fixed = ["style", "translate", from, "--motion", "run", "--content", "plain", "-o", to];
    rototoon(&fixed.iter().chain(more).copied().collect::<Vec<_>>())
}

#[test]
fn the_result_is_a_file_of_clips() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("clips.json"), library().to_string()).unwrap();
    let pose = folder.path().join("pose.json");
    std::fs::write(&pose, posture(2.0, 0.4, 0.0).to_string()).unwrap();
    for preset in ["rototoon", "bilinear", "liang2012"] {
        let done =
            translate(folder.path(), &["--style", "old", "--preset", preset, "--key-pose", pose.to_str().unwrap()]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let text = std::fs::read_to_string(folder.path().join("out.json")).unwrap();
        let made: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&made["rototoon_clips"], &made["fps"]), (&json!(1), &json!(12.0)));
        let clip = &made["clips"][0];
        assert_eq!((&clip["character"], &clip["motion"]), (&json!("old"), &json!("run")));
        assert_eq!(clip["points"].as_array().unwrap().len(), 8);
        assert_eq!(clip["deviation"][7].as_array().unwrap().len(), 17);
    }
}

#[test]
fn errors_are_reported_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let clips = folder.path().join("clips.json");
    let said = |text: &str, more: &[&str], status: i32| {
        std::fs::write(&clips, text).unwrap();
        let done = translate(folder.path(), more);
        assert_eq!(done.status.code(), Some(status));
        assert!(!folder.path().join("out.json").exists());
        String::from_utf8(done.stderr).unwrap()
    };
    let good = library().to_string();
    assert!(
        said(&good, &["--style", "nobody"], 2)
            .contains("clips.json: --style: found \"nobody\", expected one of old, plain, shy")
    );
    let same = said(&good, &["--style", "plain"], 2);
    assert!(same.contains("--content: found \"plain\", the style's character, expected another one"), "{same}");
    let mut without = library();
    without["clips"].as_array_mut().unwrap().retain(|clip| clip["character"] != "plain" || clip["motion"] != "run");
    let error = said(&without.to_string(), &["--style", "old"], 2);
    assert!(error.contains("--content: found no clip of \"run\" by \"plain\", expected one"), "{error}");
    let mut short = library();
    short["clips"][4]["points"][2].as_array_mut().unwrap().pop();
    let error = said(&short.to_string(), &["--style", "old"], 1);
    assert!(error.contains("clips[4] (\"old\", \"run\"), frame 2: found 16 key points, expected 17"), "{error}");
    assert!(said("{\"rototoon_clips\": 9}", &["--style", "old"], 1).contains("found version 9, expected 2 or less"));
    assert_eq!(translate(folder.path(), &[]).status.code(), Some(2));
}

/// A drawn body of one part: a strip from the pelvis to the other end of a bird's torso, with a leg below it.
fn bird() -> Value {
    let end = |part: &str, a: usize, b: usize| json!({"points": [{"part": part, "at": a}, {"part": part, "at": b}]});
    let limb = |from: &str, to: &str, part: &str| json!({"from": from, "to": to, "start": end(part, 0, 3), "end": end(part, 1, 2)});
    let part = |name: &str, points: Value| json!({"name": name, "closed": true, "keys": {"0": points}});
    json!({"rototoon": 1,
        "footage": {"pattern": "f_%d.png", "first": 0, "last": 0, "fps": 12, "width": 200, "height": 200},
        "parts": [part("body", json!([[60, 90], [120, 70], [120, 90], [60, 110]])),
            part("leg", json!([[76, 104], [76, 164], [84, 164], [84, 104]]))],
        "skeleton": "bird",
        "limbs": [limb("pelvis", "breast", "body"), limb("l_hip", "l_toes", "leg")]})
}

#[test]
fn a_human_walk_moves_a_bird_by_named_chains() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(at("bird.json"), bird().to_string()).unwrap();
    let mut walk = library();
    walk["clips"].as_array_mut().unwrap().truncate(1);
    std::fs::write(at("walk.json"), walk.to_string()).unwrap();
    let reshape = |more: &[&str]| {
        let (project, clips, out) = (at("bird.json"), at("walk.json"), at("out.json"));
        rototoon(&[&["style", "reshape", project.as_str(), clips.as_str(), "-o", out.as_str()], more].concat())
    };
    let done = reshape(&["--chain", "l_arm=l_wing", "--chain", "r_arm=r_wing"]);
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{said}");
    assert!(
        said.contains("chain \"tail\": no chain of the clip belongs to it, so it stays still")
            && !said.contains("_wing")
    );
    let made: Value = serde_json::from_str(&std::fs::read_to_string(at("out.json")).unwrap()).unwrap();
    assert_eq!(made["skeleton"], "bird");
    assert_eq!(made["parts"][1]["tracks"].as_object().unwrap().len(), 8);
    // Captured from the result, the clip is a bird's.
    let clip = ["style", "clip", &at("out.json"), "--character", "tit", "--motion", "walk", "-o", &at("clip.json")]
        .map(str::to_owned);
    assert!(rototoon(&clip.each_ref().map(String::as_str)).status.success());
    let clip: Value = serde_json::from_str(&std::fs::read_to_string(at("clip.json")).unwrap()).unwrap();
    assert_eq!((&clip["rototoon_clips"], &clip["skeleton"]), (&json!(2), &json!("bird")));
    assert_eq!(clip["clips"][0]["points"][0].as_array().unwrap().len(), 23);
    let failed = |more: &[&str]| String::from_utf8(reshape(more).stderr).unwrap();
    assert!(failed(&["--chain", "l_arm"]).contains("expected two names of chains with = between them"));
    assert!(
        failed(&["--chain", "l_arm=wing"])
            .contains("--chain: found \"wing\", expected a chain of \"bird\": one of torso")
    );
}

#[test]
fn a_library_is_filled_listed_and_learned_from() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    std::fs::write(&clips, library().to_string()).unwrap();
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    assert!(rototoon(&["style", "library", "add", to, from, "--source", "shot 3"]).status.success());
    std::fs::write(shelf.join("shy-bow.clip.json"), "{").unwrap();
    let listed = rototoon(&["style", "library", "list", to, "--character", "ol"]);
    let lines = String::from_utf8(listed.stdout).unwrap();
    assert_eq!(lines.lines().count(), 3);
    assert!(lines.contains("old\tbow\t8\t12\told-bow.clip.json\tshot 3"), "{lines}");
    let out = folder.path().join("out.json");
    let request = ["style", "translate", to, "--style", "old", "--motion", "run", "--content", "plain"];
    let made = rototoon(&[&request[..], &["-o", out.to_str().unwrap()]].concat());
    assert!(made.status.success());
    assert!(String::from_utf8_lossy(&made.stderr).contains("warning: "));
    assert!(out.exists());
}

#[test]
fn a_list_names_damaged_and_missing_clips() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    std::fs::write(&clips, library().to_string()).unwrap();
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    assert!(rototoon(&["style", "library", "add", to, from]).status.success());
    let list = || {
        let done = rototoon(&["style", "library", "list", to]);
        assert!(done.status.success(), "the rest can be used");
        (String::from_utf8(done.stdout).unwrap(), String::from_utf8(done.stderr).unwrap())
    };
    let (all, said) = list();
    assert_eq!(said, "");
    std::fs::write(shelf.join("shy-run.clip.json"), "{").unwrap();
    std::fs::remove_file(shelf.join("old-bow.clip.json")).unwrap();
    let (rest, said) = list();
    let good: Vec<&str> = all.lines().filter(|l| !l.contains("shy-run") && !l.contains("old-bow")).collect();
    assert_eq!(rest.lines().collect::<Vec<_>>(), good);
    assert!(said.lines().count() == 2 && said.lines().all(|l| l.starts_with("warning: ")), "{said}");
    assert!(
        said.contains("shy-run.clip.json: found text that is not JSON") && said.contains("old-bow.clip.json"),
        "{said}"
    );
}

#[test]
fn a_strength_of_0_and_a_small_library_are_said() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("clips.json"), library().to_string()).unwrap();
    let said = |more: &[&str]| {
        let done = translate(folder.path(), &[&["--style", "old"], more].concat());
        assert!(done.status.success());
        String::from_utf8(done.stderr).unwrap()
    };
    let small = said(&[]);
    assert!(small.contains("note: ") && small.contains("the library is too small to rehearse on"), "{small}");
    assert!(said(&["--strength", "0"]).contains("with a strength of 0 the result is the content's own motion"));
}

#[test]
fn clips_of_a_library_may_have_other_frame_rates() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    let fill = |clips_of: Value| {
        std::fs::write(&clips, clips_of.to_string()).unwrap();
        assert!(rototoon(&["style", "library", "add", to, from, "--replace"]).status.success());
    };
    fill(library());
    // The run of one character at four times the rate, over the same time.
    let points: Vec<Value> = (0..29).map(|f| posture(2.0, 0.0, f as f64 / 4.0)).collect();
    fill(json!({"rototoon_clips": 1, "fps": 48, "clips": [{"character": "plain", "motion": "run", "points": points}]}));
    let out = folder.path().join("out.json");
    let made = |content: &str| {
        let request = ["style", "translate", to, "--style", "old", "--motion", "run", "--content", content];
        let done = rototoon(&[&request[..], &["-o", out.to_str().unwrap()]].concat());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let made: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
        (made["fps"].as_f64().unwrap(), made["clips"][0]["points"].as_array().unwrap().len())
    };
    assert_eq!(made("plain"), (48.0, 29));
    assert_eq!(made("shy"), (12.0, 8));
}

#[test]
fn processes_that_add_at_the_same_time_lose_nothing() {
    const PROCESSES: usize = 8;
    const ADDS: usize = 15;
    let folder = tempfile::tempdir().unwrap();
    let shelf = folder.path().join("shelf");
    std::fs::create_dir(&shelf).unwrap();
    let kept = json!({"rototoon_library": 1, "studio": "ours", "clips": []}).to_string();
    std::fs::write(shelf.join("library.json"), kept).unwrap();
    let added = |process: usize| {
        for number in 0..ADDS {
            let name = format!("actor {process} {number}");
            let points: Vec<Value> = (0..3).map(|f| posture(1.0, 0.1, f64::from(f))).collect();
            let clip = json!({"character": name, "motion": "walk", "points": points});
            let file = folder.path().join(format!("{process}-{number}.json"));
            std::fs::write(&file, json!({"rototoon_clips": 1, "fps": 12, "clips": [clip]}).to_string()).unwrap();
            let (to, from) = (shelf.to_str().unwrap(), file.to_str().unwrap());
            let done =
                rototoon(&["style", "library", "add", to, from, "--source", &format!("shot {process}-{number}")]);
            assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        }
    };
    std::thread::scope(|scope| {
        for process in 0..PROCESSES {
            let added = &added;
            scope.spawn(move || added(process));
        }
    });
    let index: Value = serde_json::from_str(&std::fs::read_to_string(shelf.join("library.json")).unwrap()).unwrap();
    assert_eq!(index["studio"], "ours");
    let entries = index["clips"].as_array().unwrap();
    let mut sources: Vec<&str> = entries.iter().map(|entry| entry["source"].as_str().unwrap()).collect();
    sources.sort_unstable();
    sources.dedup();
    assert_eq!((entries.len(), sources.len()), (PROCESSES * ADDS, PROCESSES * ADDS));
}

#[test]
fn clips_of_a_library_are_replaced_on_request_only() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    std::fs::write(&clips, library().to_string()).unwrap();
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    let add = |more: &[&str]| {
        let done = rototoon(&[&["style", "library", "add", to, from], more].concat());
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let sources = || {
        let listed = rototoon(&["style", "library", "list", to, "--character", "old", "--motion", "run"]);
        String::from_utf8(listed.stdout).unwrap()
    };
    assert_eq!(add(&["--source", "shot 3"]), (Some(0), String::new()));
    std::fs::remove_file(shelf.join("plain-run.clip.json")).unwrap();
    let (status, said) = add(&["--source", "shot 4"]);
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("already (") && said.contains("from \"shot 3\""), "{said}");
    assert!(said.ends_with("more of these clips, expected another character or motion, or --replace\n"), "{said}");
    assert!(!shelf.join("plain-run.clip.json").exists(), "all or none");
    assert!(sources().ends_with("\tshot 3\n"), "{}", sources());
    let (status, said) = add(&["--source", "shot 4", "--replace"]);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("note: replaced \"run\" by \"old\" (old-run.clip.json)\n"), "{said}");
    assert!(!said.contains("by \"plain\" (plain-run"), "its file was gone: {said}");
    assert!(sources().ends_with("\tshot 4\n"), "{}", sources());
}

#[test]
fn a_library_that_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let none = folder.path().join("shelv");
    let listed = rototoon(&["style", "library", "list", none.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&listed.stderr).into_owned();
    assert_eq!(listed.status.code(), Some(1), "{said}");
    assert_eq!(said, format!("error: {}: found no folder, expected that of a library\n", none.display()));
    assert!(!none.exists());
}

#[test]
fn a_library_of_a_later_version_is_left_alone_and_a_damaged_index_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    std::fs::write(&clips, library().to_string()).unwrap();
    std::fs::create_dir(&shelf).unwrap();
    let index = shelf.join("library.json");
    let add = || rototoon(&["style", "library", "add", shelf.to_str().unwrap(), clips.to_str().unwrap()]);

    let later = "{\"rototoon_library\": 2, \"clips\": [], \"more\": 1}";
    std::fs::write(&index, later).unwrap();
    let refused = add();
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("version 2"));
    assert_eq!(std::fs::read_to_string(&index).unwrap(), later);
    assert_eq!(
        std::fs::read_dir(&shelf).unwrap().flatten().filter(|f| f.path().to_string_lossy().contains("clip")).count(),
        0
    );

    let damaged = b"{\"rototoon_library\": 1, \"clips\": [{\"source\": \"caf\xe9\"}]}";
    std::fs::write(&index, damaged).unwrap();
    let done = add();
    assert!(done.status.success());
    assert!(String::from_utf8_lossy(&done.stderr).contains("library.damaged-1.json"));
    assert_eq!(std::fs::read(shelf.join("library.damaged-1.json")).unwrap(), damaged);
}

/// A BVH file of a figure that stands and then lifts an arm. `hand` is the name of its left hand.
fn captured(hand: &str) -> String {
    let limb = |names: [&str; 3], offsets: [[i32; 3]; 3]| -> String {
        let open: String = names
            .iter()
            .zip(offsets)
            .map(|(name, [x, y, z])| format!("JOINT {name}\n{{\nOFFSET {x} {y} {z}\nCHANNELS 1 Zrotation\n"))
            .collect();
        open + "End Site\n{\nOFFSET 0 0 1\n}\n" + &"}\n".repeat(3)
    };
    let up = [[0, 2, 0], [0, 2, 0], [0, 1, 0]];
    let spine = limb(["Spine", "Neck", "Head"], up);
    let leg = |side: &str, x: i32| {
        let names = ["UpLeg", "Leg", "Foot"].map(|part| format!("{side}{part}"));
        limb(names.each_ref().map(String::as_str), [[x, 0, 0], [0, -4, 0], [0, -4, 0]])
    };
    let left = limb(["LeftArm", "LeftForeArm", hand], [[1, 4, 0], [2, 0, 0], [2, 0, 0]]);
    let right = limb(["RightArm", "RightForeArm", "RightHand"], [[-1, 4, 0], [-2, 0, 0], [-2, 0, 0]]);
    let frame = |turn: i32| format!("0 8 0 0 0 0 {turn}{}\n", " 0".repeat(11));
    format!(
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n{spine}{left}{right}{}{}}}\nMOTION\n\
         Frames: 3\nFrame Time: 0.04\n{}{}{}",
        leg("Left", 1),
        leg("Right", -1),
        frame(0),
        frame(45),
        frame(90)
    )
}

#[test]
fn motion_capture_becomes_clips() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::create_dir(folder.path().join("anna")).unwrap();
    std::fs::write(folder.path().join("anna/lift.bvh"), captured("LeftHand")).unwrap();
    std::fs::write(folder.path().join("anna/odd.bvh"), captured("paw")).unwrap();
    std::fs::write(folder.path().join("anna/short.bvh"), captured("LeftHand").trim_end().trim_end_matches('0'))
        .unwrap();
    std::fs::write(folder.path().join("map.json"), r#"{"l_wrist": "paw"}"#).unwrap();
    let import = |more: &[&str]| {
        let out = path("clips.json");
        let done = rototoon(&[&["style", "import", "-o", &out, "--view", "front"], more].concat());
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (lift, odd, map) = (path("anna/lift.bvh"), path("anna/odd.bvh"), path("map.json"));
    assert_eq!(import(&[&lift, &odd, "--joints", &map]).0, Some(1), "the map does not fit the first");
    // A name in the encoding of an old program's country.
    let old = captured("LeftHand").replace("ROOT Hips", "ROOT Hips of Hr. M?ller").into_bytes();
    let old: Vec<u8> = old.into_iter().map(|byte| if byte == b'?' { 0xFC } else { byte }).collect();
    std::fs::write(folder.path().join("anna/old.bvh"), old).unwrap();
    let pelvis = folder.path().join("pelvis.json");
    std::fs::write(&pelvis, r#"{"pelvis": "Hips of Hr. M\ufffdller"}"#).unwrap();
    assert_eq!(import(&[&path("anna/old.bvh"), "--joints", pelvis.to_str().unwrap()]), (Some(0), String::new()));
    // The folder of a path that goes up has a name too.
    std::fs::create_dir(folder.path().join("anna/sub")).unwrap();
    assert_eq!(import(&[&path("anna/sub/../lift.bvh")]), (Some(0), String::new()));
    assert!(std::fs::read_to_string(path("clips.json")).unwrap().contains("\"anna\""));
    let fast = captured("LeftHand");
    let time = fast.lines().find(|line| line.starts_with("Frame Time")).unwrap();
    std::fs::write(folder.path().join("anna/fast.bvh"), fast.replace(time, "Frame Time: 1e-300")).unwrap();
    let (status, said) = import(&[&path("anna/fast.bvh")]);
    assert!(status == Some(2) && said.contains("fast.bvh: Frame Time, as frames a second: found 9.99"), "{said}");
    assert_eq!(import(&[&lift]), (Some(0), String::new()));
    let clips: Value = serde_json::from_str(&std::fs::read_to_string(path("clips.json")).unwrap()).unwrap();
    assert_eq!((&clips["clips"][0]["character"], &clips["clips"][0]["motion"]), (&json!("anna"), &json!("lift")));
    assert_eq!((&clips["fps"], clips["clips"][0]["points"].as_array().unwrap().len()), (&json!(25.0), 3));
    assert_eq!(clips["clips"][0]["points"][0][7], json!([1.25, -1.0]), "the wrist is out at the side");
    assert_eq!(clips["clips"][0]["points"][2][7], json!([0.25, -2.0]), "and goes up");
    assert_eq!(import(&[&odd, "--joints", &map, "--character", "bo", "--motion", "wave", "--fps", "50"]).0, Some(0));
    let (status, said) = import(&[&odd]);
    assert!(
        status == Some(1) && said.contains("odd.bvh: found no joint for l_wrist") && said.contains("paw"),
        "{said}"
    );
    let (status, said) = import(&[&path("anna/short.bvh")]);
    assert!(
        status == Some(1) && said.contains("short.bvh: line ") && said.contains("found 17 numbers, expected 18"),
        "{said}"
    );
    assert!(import(&[&lift, &lift]).1.contains("found \"lift\" by \"anna\", expected each motion of a character once"));
    assert_eq!(import(&[&lift, "--view", "above"]).0, Some(2));
    let (status, said) = import(&[&lift, "--frames", "1-40"]);
    assert!(
        status == Some(2) && said.contains("lift.bvh: --frames: found 1 to 40, expected frames of the file, 0 to 2"),
        "{said}"
    );
    let (status, said) = import(&[&lift, "--fps", "0"]);
    assert!(status == Some(2) && said.contains("--fps"), "{said}");
    assert_eq!(import(&[&path("none.bvh")]).0, Some(1));
}

#[test]
fn a_clip_file_copied_over_another_is_named_and_the_others_are_used() {
    let folder = tempfile::tempdir().unwrap();
    let (clips, shelf) = (folder.path().join("clips.json"), folder.path().join("shelf"));
    let (from, to) = (clips.to_str().unwrap(), shelf.to_str().unwrap());
    std::fs::write(&clips, library().to_string()).unwrap();
    assert!(rototoon(&["style", "library", "add", to, from]).status.success());
    let out = folder.path().join("out.json");
    let translated = || {
        let request = ["style", "translate", to, "--style", "old", "--motion", "run", "--content", "plain"];
        let done = rototoon(&[&request[..], &["-o", out.to_str().unwrap()]].concat());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        (std::fs::read_to_string(&out).unwrap(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    std::fs::remove_file(shelf.join("shy-bow.clip.json")).unwrap();
    let (without, _) = translated();
    std::fs::copy(shelf.join("shy-walk.clip.json"), shelf.join("shy-bow.clip.json")).unwrap();
    let said = "shy-bow.clip.json: found a second clip of character \"shy\" and motion \"walk\"; the clip in shy-walk.clip.json is used";
    let (with, warned) = translated();
    assert!(with == without && warned.contains("warning: ") && warned.contains(said), "{warned}");
    let listed = rototoon(&["style", "library", "list", to, "--character", "shy"]);
    let list = String::from_utf8_lossy(&listed.stdout);
    assert_eq!(list.lines().map(|line| line.split('\t').nth(1).unwrap()).collect::<Vec<_>>(), ["walk", "run"]);
    assert!(String::from_utf8_lossy(&listed.stderr).contains(said));
    // A translated clip stays one in a library.
    assert!(rototoon(&["style", "library", "add", to, out.to_str().unwrap(), "--replace"]).status.success());
    let kept = std::fs::read_to_string(shelf.join("old-run.clip.json")).unwrap();
    assert!(kept.contains("\"deviation\""));
    let listed = rototoon(&["style", "library", "list", to, "--character", "old"]);
    let said = String::from_utf8_lossy(&listed.stderr);
    assert!(
        said.contains("old-run.clip.json: made by translation, not captured") && said.lines().count() == 2,
        "{said}"
    );
}
