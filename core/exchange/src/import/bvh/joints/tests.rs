use super::*;

#[test]
fn names_are_simplified() {
    let (l, r, no) = (Some('l'), Some('r'), None);
    for (name, side, plain) in [
        ("Hips", no, "hips"),
        ("mixamorig:LeftUpLeg", l, "upleg"),
        ("mixamorig_RightForeArm", r, "forearm"),
        ("LHipJoint", l, "hipjoint"),
        ("joint_Root", no, "root"),
        ("UpperArm_L", l, "upperarm"),
        ("upper_arm.R", r, "upperarm"),
        ("lShldr", l, "shldr"),
        ("Bip01 R UpperArm", r, "upperarm"),
        ("Bip01", no, "bip01"),
        ("LEFT_WRIST", l, "wrist"),
        ("DEF-thigh.L", l, "thigh"),
        ("ORG-spine.004", no, "spine004"),
        ("J_Bip_C_Hips", no, "hips"),
        ("HipCenter", no, "hip"),
        ("C", no, "c"),
        ("LUArm", l, "uarm"),
        ("ShoulderLeft", l, "shoulder"),
        ("L", no, "l"),
        ("leftarm", l, "arm"),
        ("rhand", r, "hand"),
        ("leg", no, "leg"),
        ("LeftLeg", l, "leg"),
        ("neck_01", no, "neck01"),
        ("Leg", no, "leg"),
        ("", no, ""),
    ] {
        assert_eq!(simplified(name, 0), (side, plain.to_owned()), "{name}");
    }
    assert_eq!(simplified("CC_Base_L_Thigh", 2), (l, "thigh".to_owned()));
    assert_eq!(simplified("Robot", 1), (no, "robot".to_owned()), "a name is never empty");
}

#[test]
fn maps_say_what_is_wrong() {
    let map = JointMap::parse(r#"{"l_wrist": "Hand", "chest": ["A", "B"]}"#).unwrap();
    assert_eq!(map.0[&1], ["A", "B"]);
    assert_eq!(JointMap::parse("\u{feff}{\"l_wrist\": \"Hand\", \"chest\": [\"A\", \"B\"]}").unwrap().0, map.0);
    let error = |text: &str| JointMap::parse(text).unwrap_err().to_string();
    assert!(error("{").starts_with("joints: found no JSON"));
    assert!(error("[1]").starts_with("joints: found a list of 1, expected an object"));
    assert!(
        error(r#"{"tail": "x"}"#).starts_with(r#"joints, "tail": found no such key point, expected one of pelvis"#)
    );
    assert!(error(r#"{"head": []}"#).contains("found a list of 0, expected a joint's name"));
    assert!(error(r#"{"head": 3}"#).contains("found 3, expected a joint's name"));
}
