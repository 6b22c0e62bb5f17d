use super::*;
use rototoon_base::scene::skeleton::COUNT;

fn file(points: &str) -> String {
    format!(
        r#"{{"rototoon_clips": 1, "fps": 12, "clips": [{{"character": "a", "motion": "walk", "points": {points}}}]}}"#
    )
}

fn posture() -> String {
    format!("[{}]", vec!["[1.5, -2]"; COUNT].join(","))
}

fn error(text: &str) -> String {
    Clips::parse(text, "f.json").unwrap_err().to_string()
}

#[test]
fn the_largest_numbers_are_read_again() {
    let text = posture().replacen("1.5", "-1.5e305", 1).replacen("-2", "1e12", 1);
    let clips = Clips::parse(&file(&format!("[{text}]")), "f").unwrap();
    assert_eq!(Clips::parse(&clips.text(), "f").unwrap(), clips);
}

#[test]
fn what_is_written_is_read_again() {
    let clips = Clips::parse(&file(&format!("[{}]", posture())), "f").unwrap();
    assert_eq!(clips.fps, 12.0);
    assert_eq!(clips.clips[0].postures, vec![vec![Point::new(1.5, -2.0); COUNT]]);
    assert_eq!(Clips::parse(&clips.text(), "f").unwrap(), clips);
}

#[test]
fn guesses_are_read_again_and_wrong_ones_are_named() {
    let with = |guessed: &str| {
        file(&format!("[{}, {}]", posture(), posture()))
            .replace("\"points\"", &format!("\"guessed\": {guessed}, \"points\""))
    };
    let clips = Clips::parse(&with(r#"{"l_wrist": [[0, 0], [1, 1]], "chest": [[0, 1]]}"#), "f").unwrap();
    assert_eq!(clips.clips[0].guessed, Guessed::from([(1, vec![[0, 1]]), (7, vec![[0, 0], [1, 1]])]));
    assert_eq!(Clips::parse(&clips.text(), "f").unwrap(), clips);
    let place = r#"f.json: clips[0] ("a", "walk").guessed"#;
    assert!(
        error(&with(r#"{"wing": []}"#)).starts_with(&format!("{place}: found \"wing\", expected one of pelvis, chest"))
    );
    let times = "expected times [first, last] that rise, of frames 0 to 1";
    for wrong in ["[[0, 2]]", "[[1, 0]]", "[[0, 1], [1, 1]]", "7"] {
        let told = error(&with(&format!(r#"{{"head": {wrong}}}"#)));
        assert!(told.starts_with(&format!("{place}.head: found ")) && told.ends_with(times), "{told}");
    }
    assert_eq!(error(&with("7")), format!("{place}: found 7, expected an object with times by key point"));
}

#[test]
fn deviations_are_read_again_and_wrong_ones_are_named() {
    let with = |deviation: &str| {
        file(&format!("[{}]", posture())).replace("\"points\"", &format!("\"deviation\": {deviation}, \"points\""))
    };
    let row = format!("[{}]", vec!["0.25"; COUNT].join(","));
    let clips = Clips::parse(&with(&format!("[{row}]")), "f").unwrap();
    assert_eq!(clips.clips[0].deviation, [[0.25; COUNT]]);
    assert_eq!(Clips::parse(&clips.text(), "f").unwrap(), clips);
    assert_eq!(Clips::parse_by_value(&clips.text(), "f").unwrap(), clips);
    assert!(Clips::parse(&with("[]"), "f").unwrap().clips[0].deviation.is_empty());
    for wrong in ["7", "[[0.25]]", &format!("[{row}, {row}]"), &format!("[{}]", row.replacen("0.25", "-1", 1))] {
        let told = error(&with(wrong));
        assert!(told.starts_with(r#"f.json: clips[0] ("a", "walk").deviation: found "#), "{told}");
        assert!(told.ends_with("expected 17 numbers from 0 for each of 1 frames"), "{told}");
    }
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let place = r#"f.json: clips[0] ("a", "walk")"#;
    assert_eq!(error(&file("[]")), format!("{place}.points: found no frames, expected at least one"));
    assert_eq!(error(&file("[[[1, 2]]]")), format!("{place}, frame 0: found 1 key points, expected 17"));
    let bad = posture().replacen("[1.5, -2]", "[1.5, \"x\"]", 3);
    assert_eq!(
        error(&file(&format!("[{}, {bad}]", posture()))),
        format!("{place}, frame 1, pelvis: found [1.5,\"x\"], expected two numbers")
    );
    assert!(
        error(&file("[[[NaN, 1]]]"))
            .starts_with("f.json: found text that is not JSON (JSON has no NaN and no Infinity)")
    );
    assert!(error(r#"{"rototoon_clips": 3}"#).contains("found version 3, expected 2 or less"));
    assert!(error(r#"{"rototoon_clips": 1}"#).contains("clips: found nothing, expected a list of clips"));
    assert!(error(r#"{"rototoon_clips": 1, "keypoints": ["pelvis"]}"#).contains("found 1 names, expected 17"));
}

#[test]
fn both_ways_of_reading_agree() {
    let good = file(&format!("[{}, {}]", posture(), posture().replace("1.5", "1e-3")));
    let frame = format!("[{}]", posture());
    for text in [
        good.clone(),
        good.replace("\"fps\": 12, ", ""),
        good.replace("12", "23.976"),
        good.replace("\"a\"", "\"\\u00e4\\n\""),
        good.replacen('{', "{\"more\": [1, {\"x\": null}], ", 1),
        good.replacen('{', "{\"clips\": 3, ", 1),
        good.replacen('{', "{\"keypoints\": null, ", 1),
        good.replace("12", "null"),
        good.replace("12", "0"),
        good.replace("walk", ""),
        good.replace("[1.5, -2]", "[1.5, -2, 0]"),
        good.replace("[1.5, -2]", "[1.5]"),
        good.replace("1.5", "1e999"),
        good.replace("1.5", "true"),
        file(&frame.replacen("[1.5, -2],", "", 1)),
        file(&frame.replacen("[[1.5", "[[1.5, -2], [1.5", 1)),
        file("[]"),
        good.clone() + "x",
        good.replace("rototoon_clips\": 1", "rototoon_clips\": 1.0"),
        good.replace("rototoon_clips\": 1", "rototoon_clips\": 0"),
    ] {
        if let Some(quick) = plain::read(&text) {
            let quick = Clips { clips: quick.0, fps: quick.1 };
            assert_eq!(Ok(quick), Clips::parse_by_value(&text, "f"), "{text}");
        }
    }
    assert!(plain::read(&good).is_some() && plain::read(&good.replacen('{', "{\"more\": 0, ", 1)).is_some());
}

#[test]
fn other_bodies_are_kept() {
    let bird = Template::bird();
    let clip = |template: &Arc<Template>| Clip::of(template.clone(), template.name(), "walk", vec![template.typical()]);
    let alone = Clips { clips: vec![clip(&bird)], fps: 25.0 };
    assert!(
        alone.text().starts_with(r#"{"rototoon_clips":2,"fps":25.0,"skeleton":"bird","keypoints":["pelvis","breast""#)
    );
    let mixed = Clips { clips: vec![clip(&bird), clip(&Template::human()), clip(&Template::quadruped())], fps: 25.0 };
    let humans_first = Clips { clips: vec![clip(&Template::human()), clip(&bird)], fps: 25.0 };
    for clips in [alone, mixed, humans_first] {
        assert_eq!(Clips::parse(&clips.text(), "f").unwrap(), clips);
    }
    let text = file(&format!("[{}]", posture())).replace("\"motion\"", "\"skeleton\": \"bird\", \"motion\"");
    assert_eq!(error(&text), r#"f.json: clips[0] ("a", "walk"), frame 0: found 17 key points, expected 23"#);
    let unknown = text.replace("bird", "fish");
    assert!(error(&unknown).starts_with(r#"f.json: clips[0] ("a", "walk").skeleton: found "fish", expected one of"#));
}

#[test]
fn a_motion_stands_once_a_character() {
    let clip = format!(r#"{{"character": "a", "motion": "walk", "points": [{}]}}"#, posture());
    let text = format!(r#"{{"rototoon_clips": 1, "clips": [{clip}, {clip}]}}"#);
    assert!(error(&text).contains(r#"clips[1] ("a", "walk"): found the character and motion of clips[0] again"#));
}

#[test]
fn key_poses_come_in_three_forms() {
    let plain = parse_key_poses(&posture(), "k").unwrap();
    assert_eq!((plain.len(), plain[0].frame), (1, 0));
    let one = format!(r#"{{"frame": 7, "points": {}}}"#, posture());
    assert_eq!(parse_key_poses(&one, "k").unwrap()[0].frame, 7);
    assert_eq!(parse_key_poses(&format!("[{one}, {one}]"), "k").unwrap().len(), 2);
    let wrong = parse_key_poses(r#"[{"frame": -1}]"#, "k").unwrap_err().to_string();
    assert_eq!(wrong, "k: key pose [0].frame: found -1, expected a frame number from 0");
}

#[test]
fn a_mark_at_the_begin_of_a_file_is_passed_over() {
    let text = file(&format!("[{}]", posture()));
    assert_eq!(Clips::parse(&format!("\u{feff}{text}"), "f").unwrap(), Clips::parse(&text, "f").unwrap());
}
