//! Tests of what `rototoon style` says of key points that nobody captured.

use super::style_reshape::{figure, read, rototoon, said, write};
use serde_json::json;

#[test]
fn guessed_key_points_are_kept_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(folder, "shot.json", &figure(5));
    let clip = ["style", "clip", "shot.json", "--character", "a", "--motion", "b", "-o", "clips.json"];
    assert!(rototoon(folder, &clip).status.success());
    let clips = read(folder, "clips.json");
    let guessed = &clips["clips"][0]["guessed"];
    assert_eq!(guessed["r_elbow"], json!([[0, 4]]), "{guessed}");
    assert!(guessed.get("r_wrist").is_none() && guessed.get("pelvis").is_none(), "{guessed}");
    assert!(rototoon(folder, &["style", "library", "add", "shelf", "clips.json"]).status.success());
    let listed = rototoon(folder, &["style", "library", "list", "shelf"]);
    let told = said(&listed);
    assert!(told.contains("a-b.clip.json: guessed, not captured: ") && told.contains("r_elbow"), "{told}");
    assert!(told.contains("on 5 of 5 frames"), "{told}");
    assert_eq!(String::from_utf8_lossy(&listed.stdout), "a\tb\t5\t12\ta-b.clip.json\t\n");
    // A drawing whose limbs have no use for the guesses, and one whose limbs follow them.
    let reshape = ["style", "reshape", "doll.json", "shelf", "-o", "out.json"];
    write(folder, "doll.json", &figure(1));
    let told = said(&rototoon(folder, &reshape));
    assert!(!told.contains("guessed"), "{told}");
    let mut doll = figure(1);
    doll["limbs"][1]["to"] = json!("r_elbow");
    write(folder, "doll.json", &doll);
    let told = said(&rototoon(folder, &reshape));
    let wanted = "warning: doll.json: guessed in the clip, since nothing was captured there: r_elbow on 5 of 5 frames; what follows is \"arm\"";
    assert!(told.contains(wanted), "{told}");
}
