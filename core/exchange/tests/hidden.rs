//! Frames on which a part is hidden go to other programs and come back.

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene};
use rototoon_exchange::export::{SvgOptions, natron_project, nuke, silhouette, svg};
use rototoon_exchange::import;

const FIRST: FrameNumber = 1001;

fn scene(tracked: &[FrameNumber], keys: &[FrameNumber], absent: &[[FrameNumber; 2]]) -> Scene {
    let square = |frame: &FrameNumber| {
        let x = f64::from(frame - FIRST);
        let corners = [(x, 2.0), (x + 8.0, 2.0), (x + 8.0, 10.0), (x, 10.0)];
        (*frame, corners.map(Point::from).to_vec())
    };
    let part = Part {
        name: "arm".into(),
        closed: true,
        keys: keys.iter().map(square).collect(),
        tracks: tracked.iter().map(square).collect(),
        absent: absent.to_vec(),
        ..Part::default()
    };
    let footage =
        Footage { pattern: "%d".into(), first: FIRST, last: FIRST + 9, fps: 12.5, width: 40, height: 30, held: false };
    Scene { footage, parts: vec![part] }
}

/// The parts after export to and import from each format that can do both.
fn back(scene: &Scene) -> Vec<(&'static str, Part)> {
    let footage = &scene.footage;
    let found = [
        ("nk", import::nuke::nuke(&nuke(scene, 1.0), footage, FIRST).unwrap()),
        ("ntp", import::natron::natron(&natron_project(scene, 1.0), footage, FIRST).unwrap()),
        ("fxs", import::silhouette::silhouette(&silhouette(scene, 1.0), footage).unwrap()),
        ("svg", import::svg::svg(&svg(scene, &SvgOptions::default()), footage, FIRST).unwrap()),
    ];
    let part = |(format, found): (_, import::Shapes)| {
        assert_eq!(found.warnings, [""; 0], "{format}");
        let mut scene = Scene { parts: Vec::new(), footage: footage.clone() };
        import::into_scene(&mut scene, found.shapes).unwrap();
        (format, scene.parts.remove(0))
    };
    found.map(part).into()
}

#[test]
fn hidden_frames_come_back_as_absence() {
    for (tracked, keys, absent) in [
        (vec![1001, 1002, 1004, 1005], vec![1001, 1005], vec![[1003, 1003]]),
        (vec![1002, 1003, 1006, 1010], vec![1002, 1010], vec![[1004, 1005], [1007, 1009]]),
        (vec![1004, 1005, 1006], vec![1004, 1006], vec![]),
    ] {
        for (format, part) in back(&scene(&tracked, &keys, &absent)) {
            assert_eq!(part.keys.keys().copied().collect::<Vec<_>>(), tracked, "{format}");
            assert_eq!(part.absent, absent, "{format}");
        }
    }
}

#[test]
fn hidden_frames_between_bare_keys_come_back() {
    for (format, part) in back(&scene(&[], &[1001, 1009], &[[1004, 1005]])) {
        let keys: Vec<_> = part.keys.keys().copied().collect();
        assert_eq!((keys, part.absent), (vec![1001, 1009], vec![[1004, 1005]]), "{format}");
    }
}

#[test]
fn a_single_key_is_followed_outward_again() {
    for (format, part) in back(&scene(&[], &[1004], &[])) {
        assert_eq!((part.keys.len(), part.absent), (1, vec![]), "{format}");
    }
}
