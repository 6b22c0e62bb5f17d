//! Files of shapes and motions that were made to do harm. Every reader answers with shapes or with an error, in time and
//! memory that the file's own size bounds.

use proptest::prelude::*;
use rototoon_base::scene::Footage;
use rototoon_exchange::import::{
    ImportError, Shapes, bvh, fusion::fusion, nuke::nuke, silhouette::silhouette, svg::Still, svg::svg, svg::svg_of,
};

fn footage(last: i32) -> Footage {
    Footage { pattern: "%d".into(), first: 0, last, fps: 25.0, width: 200, height: 100, held: false }
}

fn read(content: &str) -> Result<Shapes, ImportError> {
    svg(&format!("<svg viewBox=\"0 0 200 100\">{content}</svg>"), &footage(9), 0)
}

fn said(content: &str) -> String {
    read(content).unwrap_err().to_string()
}

#[test]
fn deep_nesting_is_refused_on_a_small_stack() {
    let nested = |depth: usize| "<g>".repeat(depth) + "<path d=\"M0 0h9\"/>" + &"</g>".repeat(depth);
    assert_eq!(read(&nested(200)).unwrap().shapes.len(), 1);
    let work = move || said(&nested(20_000));
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(work).unwrap();
    assert!(thread.join().unwrap().contains("<g>: found elements nested 257 deep, expected at most 256"));
    let deep = "<Silhouette>".to_owned() + &"<Object>".repeat(9000) + &"</Object>".repeat(9000) + "</Silhouette>";
    assert!(silhouette(&deep, &footage(9)).unwrap_err().to_string().contains("nested 257 deep"));
}

#[test]
fn entities_do_not_grow_without_end() {
    let mut entities = "<!ENTITY a0 \"<g/>\">".to_owned();
    for k in 1..9 {
        entities += &format!("<!ENTITY a{k} \"{}\">", format!("&a{};", k - 1).repeat(20));
    }
    let text = format!("<!DOCTYPE svg [{entities}]><svg>&a8;</svg>");
    assert!(svg(&text, &footage(9), 0).unwrap_err().to_string().contains("not XML"));
}

#[test]
fn large_arcs_have_few_points_and_too_many_points_are_refused() {
    let found = read("<path d=\"M0 0A1e6 1e6 0 0 1 150 0\"/>").unwrap();
    assert!(found.shapes[0].keys[&0].len() < 1000);
    let arcs = "a1e6 1e6 0 1 1 9 0".repeat(20_000);
    let error = said(&format!("<path d=\"M0 0{arcs}\"/>"));
    assert!(error.contains("<path>: found more than 20000000 points up to here, expected fewer"), "{error}");
}

#[test]
fn shapes_without_names_are_numbered_in_their_order() {
    let found = read(&"<path d=\"M0 0h9\"/>".repeat(20_000)).unwrap();
    let last = found.shapes.last().map(|shape| shape.name.as_str());
    assert_eq!((found.shapes.len(), last), (20_000, Some("shape 20000")));
}

#[test]
fn many_classes_and_shapes_of_a_group_are_found_at_once() {
    let rules: String = (0..2000).map(|k| format!("g .s{k}{{fill:none}}")).collect();
    let paths: String = (0..20_000).map(|k| format!("<path class=\"s{}\" d=\"M0 0h9v9\"/>", k % 2000)).collect();
    let found = read(&format!("<style>{rules}</style><g id=\"far\"><g>{paths}</g></g>")).unwrap();
    assert!(found.shapes.len() == 20_000 && found.shapes.iter().all(|shape| !shape.closed));
}

#[test]
fn many_elements_that_are_left_out_have_their_places() {
    let found = read(&("<path d=\"M0 0h9\"/>".to_owned() + &"\n<text/>".repeat(50_000))).unwrap();
    assert_eq!(found.warnings.len(), 50_000);
    assert_eq!(found.warnings[49_999], "line 50001, column 1: <text> has no outline here and is left out");
}

#[test]
fn an_animation_does_not_ask_every_frame_of_the_footage() {
    let animate = "<path><animate attributeName=\"d\" dur=\"4s\" calcMode=\"discrete\" keyTimes=\"0;0.5\" values=\"M0 0h9;M0 0h5\"/></path>";
    let text = format!("<svg viewBox=\"0 0 200 100\">{animate}</svg>");
    let found = svg(&text, &footage(i32::MAX), 0).unwrap();
    let keys: Vec<i32> = found.shapes[0].keys.keys().copied().collect();
    assert_eq!(keys, [0, 49, 50, i32::MAX]);
}

#[test]
fn coordinates_of_silhouette_are_bounded() {
    let shape = |point: &str| {
        let path = format!("<Path>{}</Path>", format!("<Point>{point}</Point>").repeat(3));
        let text = format!(
            "<Silhouette><Object type=\"Shape\"><Property id=\"path\"><Key>{path}</Key></Property></Object></Silhouette>"
        );
        silhouette(&text, &footage(9)).unwrap_err().to_string()
    };
    assert!(shape("(1e300,0),(0,0),(0,0)").contains("expected at most 1e7 from 0"));
    assert!(shape("(inf,0)").contains("expected (x,y)"));
}

const SEEDS: [&str; 6] = [
    "<svg viewBox=\"0 0 200 100\"><g transform=\"rotate(30) scale(2)\"><path id=\"a\" d=\"M1 2a5 6 0 0 1 9 9q1 2 3 4t5 6c1 2 3 4 5 6s1 2 3 4z\"/></g><rect width=\"9\" height=\"5\" rx=\"2\"/><circle r=\"4\"><title>t</title></circle></svg>",
    "<svg viewBox=\"0 0 200 100\"><path d=\"M0 0h9\"><animate attributeName=\"d\" dur=\"0.4s\" calcMode=\"discrete\" keyTimes=\"0;0.5\" values=\"M0 0h9;M0 0h5\"/><animate attributeName=\"visibility\" dur=\"0.4s\" values=\"visible;hidden\"/></path></svg>",
    "<svg viewBox=\"0 0 200 100\" data-first=\"0\" data-last=\"9\"><style>@media all{g > .a[b='c'] #d{fill:none !important}} .e,f g{transform:rotate(2turn);transform-origin:1in 5%}</style><clipPath id=\"c\"><rect width=\"9%\" height=\"9\"/></clipPath><g id=\"part-0\" clip-path=\"url(#c)\" style=\"transform:scale(2);transform-box:fill-box;transform-origin:left 50%\"><path class=\"a e\" fill-rule=\"evenodd\" d=\"M1 2h9v9zM3 3h4v4z\"><animate attributeName=\"d\" dur=\"0.4s\" values=\"M1 2h9v9zM3 3h4v4z;M1 2h9v9zM3 3h4v4z\"/></path></g><ellipse id=\"_x20_a\" cx=\"50%\" rx=\"1cm\"/></svg>",
    "<Silhouette sessionStartFrame=\"0\"><Object type=\"Shape\" label=\"a\"><Property id=\"path\"><Key frame=\"0\"><Path type=\"Bspline\" closed=\"True\"><Point>(0,0)</Point><Point>(0.1,0)</Point><Point>(0.1,0.2)</Point></Path></Key></Property></Object></Silhouette>",
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zrotation\nJOINT Spine\n{\nOFFSET 0 1 0\nCHANNELS 1 Zrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.04\n0 0 0 10\n0 1 0 20\n",
    "Roto {\n curves {{{v x3f99999a}\n {n\n {layer Root {t x44b40000 x44070000}\n {curvegroup \"a b\" 512 bezier\n {{cc {f 8192}\n {p {0 0} {{{0 x41200000} {4 9}} 0} {0 0} {0 0} {50 {{4 0} {6 20}}} {0 0} {0 0} {50 90} {0 0}}}} idem}\n {t 5 7 0 0 0 0 0 0 0 1 1 1}}}}}}\n}\n",
];

/// Every reader gets the text. What it answers does not matter here; that it answers does.
fn meet_all(text: &str) {
    let _ = svg_of(text, &footage(9), Still { frame: 0, asked: false }, &["arm", "leg"]);
    let _ = fusion(text, &footage(9), 0);
    let _ = silhouette(text, &footage(9));
    let _ = nuke(text, &footage(9), 0);
    let _ = bvh::seen(text, &bvh::Options::default());
}

proptest! {
    #[test]
    fn readers_answer_to_any_text(text in "\\PC{0,200}") {
        meet_all(&text);
    }

    #[test]
    fn readers_answer_to_changed_files(
        seed in 0..SEEDS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0usize..6, "[-0-9eE.<>/\"a-zMZ ]{0,6}"), 1..6),
    ) {
        let mut text: Vec<char> = SEEDS[seed].chars().collect();
        for (place, removed, put) in changes {
            let at = place.index(text.len() + 1);
            let end = (at + removed).min(text.len());
            text.splice(at..end, put.chars());
        }
        meet_all(&text.into_iter().collect::<String>());
    }
}

#[test]
fn keys_times_points_of_nuke_are_counted_before_they_are_made() {
    let keys: String = (0..9000).map(|frame| format!("{{{frame} 1}} ")).collect();
    let points = "{0 0} ".repeat(30_000);
    let shape = format!("{{curvegroup A 512 bezier {{{{cc {{p {points}}}}} idem}} {{t 0 0 0 {{{keys}}}}}}}");
    let error = nuke(&shape, &footage(i32::MAX), 0).unwrap_err().to_string();
    assert!(error.contains("found more than 20000000 points up to here"), "{error}");
}
