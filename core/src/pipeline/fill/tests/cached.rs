//! What depends on pictures alone comes from the cache, and the paint is the same.

use super::*;
use crate::pipeline::keeping::Earlier;
use crate::pipeline::keeping::tests::Store;

/// A box with a wall, and a disc in each half; all moves to the right.
fn moving(frame: FrameNumber, place: Point) -> f64 {
    let at = place - Point::new(100.0 + 3.0 * f64::from(frame), 75.0);
    let edge = (at.abs() - Point::new(70.0, 50.0)).max_element().abs();
    let wall = if at.y.abs() < 50.0 { at.x.abs() } else { 99.0 };
    let discs = [-35.0, 35.0].map(|x| ((at - Point::new(x, 0.0)).length() - 15.0).abs());
    edge.min(wall).min(discs[0]).min(discs[1])
}

fn film(last: FrameNumber) -> Film {
    Film::new(last, moving).clicked(&[(0, &clicks(RED))])
}

fn clicks(colour: Colour) -> Vec<FillClick> {
    let click = |x: f64, colour: Option<Colour>| FillClick { at: Point::new(x, 75.0), colour, name: None };
    vec![click(5.0, None), click(40.0, Some(colour)), click(65.0, Some(BLUE)), click(135.0, Some(RED))]
}

/// Fills with and without a cache, which must be the same. Returns how much was known.
fn known(film: &Film, options: &FillOptions, store: &Store) -> Earlier {
    let run = |cache: Option<&dyn Cache>| {
        let mut document = film.document.clone();
        let report = fill(&mut document, film.folder.path(), None, options, cache, &Silent).unwrap();
        (document.to_json(), report.lines(), report.earlier)
    };
    let (with, without) = (run(Some(store)), run(None));
    assert_eq!((with.0, with.1), (without.0, without.1));
    with.2
}

#[test]
fn other_clicks_on_the_same_pictures_look_at_no_line() {
    let (film, options, store) = (film(3), FillOptions::default(), Store::default());
    let Earlier { known: none, all } = known(&film, &options, &store);
    assert_eq!((none, all), (0, 4 + 3 + 2), "four drawings, each beside the model drawing and the last one");
    assert_eq!(known(&film, &options, &store), Earlier { known: all, all });
    let other = film.clicked(&[(0, &clicks(BLUE))]);
    assert_eq!(known(&other, &options, &store), Earlier { known: all, all });
    // A correction: what it was carried from is known, too.
    let click = FillClick { at: Point::new(144.0, 75.0), colour: Some(BLUE), name: None };
    let mended = other.clicked(&[(0, &clicks(BLUE)), (3, &[click])]);
    let Earlier { known, all } = known(&mended, &options, &store);
    assert_eq!(known, all);
    assert!(store.0.lock().unwrap().len() <= all + 2 * 4, "and which frames show the same drawing");
}

#[test]
fn a_picture_that_was_drawn_again_is_looked_at_with_its_neighbours() {
    let (film, options, store) = (film(5), FillOptions::default(), Store::default());
    let Earlier { all, .. } = known(&film, &options, &store);
    std::fs::copy(film.folder.path().join("05.png"), film.folder.path().join("03.png")).unwrap();
    let after = known(&film, &options, &store);
    // Known are the picture, which frame 5 has too, and its way from the model drawing; not the ways from frame 2 and to frame 4.
    assert_eq!(after, Earlier { known: all - 2, all });
}

#[test]
fn other_options_find_nothing_in_the_cache() {
    let (film, store) = (film(1), Store::default());
    known(&film, &FillOptions::default(), &store);
    let lines = [
        Options { sensitivity: 1.01, ..Options::default() },
        Options { leave_out: vec![[0.6, 0.8, 1.0]], ..Options::default() },
    ];
    for lines in lines {
        assert_eq!(known(&film, &FillOptions { lines, ..FillOptions::default() }, &store).known, 0);
    }
    // How sure a colour must be changes nothing that is kept.
    let bold = FillOptions { confidence: 0.9, ..FillOptions::default() };
    let Earlier { known, all } = known(&film, &bold, &store);
    assert_eq!(known, all);
}

#[test]
fn entries_that_do_not_fit_count_as_missing() {
    let (film, options, store) = (film(1), FillOptions::default(), Store::default());
    known(&film, &options, &store);
    let sound = store.0.lock().unwrap().clone();
    let damages: [fn(&mut Vec<u8>); 4] = [
        |bytes| bytes.clear(),
        |bytes| bytes.truncate(bytes.len() / 2),
        // The first region or the first place is another one.
        |bytes| bytes.iter_mut().for_each(|byte| *byte = 0x7f),
        |bytes| bytes.iter_mut().for_each(|byte| *byte = 0xff),
    ];
    for damage in damages {
        let mut damaged = sound.clone();
        damaged.values_mut().filter(|bytes| bytes.len() > 1).for_each(damage);
        *store.0.lock().unwrap() = damaged;
        assert_eq!(known(&film, &options, &store).known, 0);
    }
}
