//! Colours that become others on some frames.

use super::*;
use crate::pipeline::{colours, recolour};
use crate::project::fills::Hue;
use crate::project::recolours::Recolour;

const WET: Colour = [0.2, 0.0, 0.0];

fn named(click: FillClick, name: &str) -> FillClick {
    FillClick { name: Some(name.into()), ..click }
}

fn hue(name: &str, colour: Colour) -> Hue {
    Hue { name: Some(name.into()), colour }
}

/// The moving box and its disc, red and blue, as coat and lamp.
fn coat_and_lamp() -> [FillClick; 2] {
    let [_, red, blue] = own_clicks();
    [named(red, "coat"), named(blue, "lamp")]
}

fn wet(first: Option<FrameNumber>, last: Option<FrameNumber>) -> Recolour {
    Recolour { from: hue("coat", RED), to: hue("wet", WET), first, last }
}

/// Name and number of coat and lamp on each frame.
fn seen(film: &Film) -> [Vec<(String, usize)>; 2] {
    let last = film.document.scene.footage.last;
    [-35.0, 0.0].map(|away| {
        let on = |frame| film.at(frame, (60.0 + 6.0 * f64::from(frame) + away, 75.0)).unwrap();
        (0..=last).map(|frame| (on(frame).name.unwrap_or_default(), on(frame).track)).collect()
    })
}

fn of(coats: [(&str, usize); 5]) -> Vec<(String, usize)> {
    coats.map(|(name, number)| (name.to_owned(), number)).to_vec()
}

#[test]
fn a_colour_becomes_another_one_from_a_drawing_on_and_is_back_without_the_entry() {
    let mut film = Film::new(4, moving).clicked(&[(0, &coat_and_lamp())]);
    film.fill().unwrap();
    let before = film.document.to_json();
    // Painted regions change at once.
    assert_eq!(recolour(&mut film.document, &wet(Some(2), None)).unwrap(), 3);
    let dry = ("coat", 0);
    let expected = [of([dry, dry, ("wet", 2), ("wet", 2), ("wet", 2)]), of([("lamp", 1); 5])];
    assert_eq!(seen(&film), expected);
    assert_eq!(film.at(3, (43.0, 75.0)).unwrap().colour, WET);
    assert_eq!(colours(&film.document).unwrap().len(), 3);
    // It holds when Fill is run again.
    let report = film.fill().unwrap();
    assert_eq!(seen(&film), expected);
    assert!(report.lines().contains(&r#"recolours[0]: "coat" becomes "wet" from frame 2 on: 3 regions"#.to_owned()));
    film.document.remove_recolours(&[0]).unwrap();
    film.fill().unwrap();
    assert_eq!(film.document.to_json(), before);
}

#[test]
fn up_to_a_drawing_and_on_a_range() {
    for (entry, wets) in [(wet(None, Some(1)), [0, 1].as_slice()), (wet(Some(1), Some(3)), &[1, 2, 3])] {
        let mut film = Film::new(4, moving).clicked(&[(0, &coat_and_lamp())]);
        recolour(&mut film.document, &entry).unwrap();
        film.fill().unwrap();
        let [coats, lamps] = seen(&film);
        let found: Vec<FrameNumber> = (0..).zip(&coats).filter(|(_, own)| own.0 == "wet").map(|(f, _)| f).collect();
        assert_eq!(found, wets);
        assert!(coats.iter().all(|(name, number)| (name == "wet") == (*number == 2)), "{coats:?}");
        assert_eq!(lamps, of([("lamp", 1); 5]));
        // One frame once more: the numbers are those of before.
        let before = film.document.to_json();
        let options = FillOptions::default();
        fill(&mut film.document, film.folder.path(), Some(1..=1), &options, None, &Silent).unwrap();
        assert_eq!(film.document.to_json(), before);
    }
}

#[test]
fn a_click_in_the_new_colour_mends_the_old_one() {
    // The painter sees a wet disc as a lamp on frame 2, and clicks with what the coat has there.
    let mend = named(click((72.0, 75.0), WET), "wet");
    let mut film = Film::new(4, moving).clicked(&[(0, &coat_and_lamp()), (2, &[mend])]);
    recolour(&mut film.document, &wet(Some(1), Some(3))).unwrap();
    film.fill().unwrap();
    let names = seen(&film).map(|own| own.into_iter().map(|(name, _)| name).collect::<Vec<_>>());
    assert_eq!(names[0], ["coat", "wet", "wet", "wet", "coat"]);
    assert_eq!(names[1], ["lamp", "lamp", "wet", "wet", "coat"], "dry again with all of the coat");
}

#[test]
fn a_new_colour_that_something_else_has_stays_with_it() {
    // The coat becomes blue as the lamp. Both are clicked again on frame 3.
    let blue = hue("lamp", BLUE);
    let again = [named(click((43.0, 75.0), RED), "coat"), named(click((78.0, 75.0), BLUE), "lamp")];
    let mut film = Film::new(4, moving).clicked(&[(0, &coat_and_lamp()), (3, &again)]);
    recolour(&mut film.document, &Recolour { to: blue, ..wet(Some(2), Some(3)) }).unwrap();
    film.fill().unwrap();
    let names = seen(&film).map(|own| own.into_iter().map(|(name, _)| name).collect::<Vec<_>>());
    assert_eq!(names, [["coat", "coat", "lamp", "lamp", "coat"], ["lamp"; 5]]);
}

#[test]
fn a_model_drawing_in_the_new_colour_means_the_old_one() {
    let [coat, lamp] = coat_and_lamp();
    let wet_coat = FillClick { colour: Some(WET), ..named(coat, "wet") };
    let mut film = Film::new(4, moving).clicked(&[(0, &[wet_coat, lamp])]);
    recolour(&mut film.document, &wet(None, Some(1))).unwrap();
    film.fill().unwrap();
    let names: Vec<String> = seen(&film)[0].iter().map(|own| own.0.clone()).collect();
    assert_eq!(names, ["wet", "wet", "coat", "coat", "coat"]);
    assert_eq!(film.at(3, (43.0, 75.0)).unwrap().colour, RED, "the entry says how the old one looks");
    let mut problems = crate::project::Problems::default();
    crate::pipeline::recolour::problems(&film.document, &mut problems).unwrap();
    assert_eq!(problems.warnings().count(), 0, "{problems}");
}

#[test]
fn frames_that_are_painted_alone_keep_numbers_apart() {
    let mut film = Film::new(4, moving).clicked(&[(0, &coat_and_lamp())]);
    recolour(&mut film.document, &wet(Some(1), None)).unwrap();
    film.fill().unwrap();
    let options = FillOptions::default();
    fill(&mut film.document, film.folder.path(), Some(3..=3), &options, None, &Silent).unwrap();
    let mut hues: BTreeMap<usize, Hue> = BTreeMap::new();
    for region in film.document.filled().unwrap().iter().flat_map(|own| &own.regions) {
        assert!(hues.entry(region.track).or_insert_with(|| region.hue()).is_same(&region.hue()), "{region:?}");
    }
    assert_eq!(
        seen(&film)[0].iter().map(|own| own.0.as_str()).collect::<Vec<_>>(),
        ["coat", "wet", "wet", "wet", "wet"]
    );
}

#[test]
fn a_colour_that_nothing_has_is_told() {
    let mut film = Film::new(2, moving).clicked(&[(0, &coat_and_lamp())]);
    recolour(&mut film.document, &Recolour { from: hue("cape", RED), ..wet(Some(1), None) }).unwrap();
    let told = film.fill().unwrap().lines();
    let expected = r#"recolours[0]: "cape" becomes "wet" from frame 1 on: no region there has the colour "cape", so nothing changes"#;
    assert!(told.iter().any(|line| line == expected), "{told:?}");
}
