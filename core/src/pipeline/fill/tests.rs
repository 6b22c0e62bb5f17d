mod cached;
mod leaks;
mod mending;
mod numbers;
mod opens;
mod recolours;
mod vanished;

use super::*;
use crate::geometry::{Point, polygon};
use crate::project::fills::FillClick;
use crate::render::{Format, encode};
use crate::scene::{Colour, Footage, Raster, Scene, Silent};

const PAPER: Colour = [0.9, 0.9, 1.0];
const RED: Colour = [1.0, 0.0, 0.0];
const BLUE: Colour = [0.0, 0.0, 1.0];

/// A film of drawings: `ink` gives the distance of a place from the nearest line of a frame.
struct Film {
    folder: tempfile::TempDir,
    document: Document,
}

impl Film {
    fn new(last: FrameNumber, ink: impl Fn(FrameNumber, Point) -> f64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for frame in 0..=last {
            let shade = |x: usize, y: usize| {
                let away = ink(frame, Point::new(x as f64 + 0.5, y as f64 + 0.5));
                [(away as f32 - 0.7).clamp(0.05, 1.0); 3]
            };
            let bytes = encode::colours(&Raster::from_fn(200, 150, shade), Format::Png).unwrap();
            std::fs::write(folder.path().join(format!("{frame:02}.png")), bytes).unwrap();
        }
        let footage =
            Footage { pattern: "%02d.png".into(), first: 0, last, fps: 12.0, width: 200, height: 150, held: false };
        Self { folder, document: Document::new(Scene { footage, parts: Vec::new() }) }
    }

    /// Stray dots on the paper, others on each frame, as dust on a scanner.
    fn dusty(self) -> Self {
        for frame in 0..=self.document.scene.footage.last {
            let path = self.folder.path().join(format!("{frame:02}.png"));
            let picture = crate::pictures::decode(&path, None).unwrap();
            let shade = |x: usize, y: usize| {
                let dust = (x * 31 + y * 17 + frame as usize * 7).is_multiple_of(397);
                picture.get(x, y).map(|value| value - if dust { 0.04 } else { 0.0 })
            };
            let bytes = encode::colours(&Raster::from_fn(200, 150, shade), Format::Png).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        self
    }

    /// Clicks on frames.
    fn clicked(mut self, clicks: &[(FrameNumber, &[FillClick])]) -> Self {
        let entry = |(frame, clicks): &(FrameNumber, &[FillClick])| {
            FillClicks { frame: *frame, clicks: clicks.to_vec() }.to_json()
        };
        let fills = serde_json::Value::Array(clicks.iter().map(entry).collect());
        let text = self.document.to_json();
        let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
        value["fills"] = fills;
        self.document = Document::parse(&value.to_string(), "film.json").unwrap();
        self
    }

    fn fill(&mut self) -> Result<FillReport, PipelineError> {
        fill(&mut self.document, self.folder.path(), None, &FillOptions::default(), None, &Silent)
    }

    /// The painted region at a place.
    fn at(&self, frame: FrameNumber, place: (f64, f64)) -> Option<FilledRegion> {
        let place = Point::from(place);
        let filled = self.document.filled().unwrap();
        let drawing = filled.iter().find(|drawing| drawing.frame == frame)?;
        let within = |region: &&FilledRegion| {
            polygon::contains(&region.outline, place) && !region.holes.iter().any(|hole| polygon::contains(hole, place))
        };
        drawing.regions.iter().rev().find(within).cloned()
    }
}

fn click(at: (f64, f64), colour: Colour) -> FillClick {
    FillClick { at: Point::from(at), colour: Some(colour), name: None }
}

/// Distance from the outline of a box.
fn boxed(p: Point, middle: (f64, f64), half: (f64, f64)) -> f64 {
    let away = (p - Point::from(middle)).abs() - Point::from(half);
    let outside = away.max(Point::ZERO).length();
    (outside + away.max_element().min(0.0)).abs()
}

fn ring(p: Point, middle: (f64, f64), radius: f64) -> f64 {
    (p.distance(Point::from(middle)) - radius).abs()
}

/// A box with a disc in it that moves to the right by 6 px a frame.
fn moving(frame: FrameNumber, p: Point) -> f64 {
    let x = 60.0 + 6.0 * f64::from(frame);
    boxed(p, (x, 75.0), (45.0, 45.0)).min(ring(p, (x, 75.0), 18.0))
}

fn own_clicks() -> [FillClick; 3] {
    [click((5.0, 5.0), PAPER), click((25.0, 75.0), RED), click((60.0, 75.0), BLUE)]
}

#[test]
fn every_region_of_a_film_has_its_colour_and_its_number() {
    let mut film = Film::new(4, moving).clicked(&[(0, &own_clicks())]);
    let report = film.fill().unwrap();
    assert_eq!(report.frames.len(), 5);
    assert!(report.frames.iter().all(|frame| frame.regions == 3 && frame.doubtful == 0 && frame.related), "{report:?}");
    for frame in 0..=4 {
        let x = 60.0 + 6.0 * f64::from(frame);
        let named = [((5.0, 5.0), PAPER, 0), ((x - 35.0, 75.0), RED, 1), ((x, 75.0), BLUE, 2)];
        for (place, colour, track) in named {
            let region = film.at(frame, place).unwrap();
            assert_eq!((region.colour, region.track), (colour, track), "frame {frame}, {place:?}");
        }
    }
    assert_eq!(film.at(0, (60.0, 75.0)).unwrap().confidence, 1.0, "an artist clicked there");
}

#[test]
fn paper_that_is_not_clicked_stays_without_paint() {
    let [_, red, blue] = own_clicks();
    let mut film = Film::new(4, moving).clicked(&[(0, &[red, blue])]);
    let report = film.fill().unwrap();
    assert!(report.frames.iter().all(|frame| frame.regions == 2 && frame.doubtful == 0), "{report:?}");
    for frame in 0..=4 {
        let x = 60.0 + 6.0 * f64::from(frame);
        assert_eq!(film.at(frame, (5.0, 5.0)), None, "frame {frame}");
        let found = [film.at(frame, (x - 35.0, 75.0)).unwrap(), film.at(frame, (x, 75.0)).unwrap()];
        assert_eq!(found.map(|region| (region.colour, region.track)), [(RED, 0), (BLUE, 1)], "frame {frame}");
    }
}

#[test]
fn paper_stays_without_paint_where_few_regions_are_clicked() {
    // Nobody clicks the holes of a lace.
    let lace = |frame: FrameNumber, p: Point| {
        let x = 60.0 + 6.0 * f64::from(frame);
        let hole = |k: u32| ring(p, (x - 35.0 + 10.0 * f64::from(k), 112.0), 3.0);
        (0..8).map(hole).fold(moving(frame, p), f64::min)
    };
    let [_, red, blue] = own_clicks();
    let mut film = Film::new(4, lace).clicked(&[(0, &[red, blue])]);
    film.fill().unwrap();
    for frame in 0..=4 {
        let x = 60.0 + 6.0 * f64::from(frame);
        assert_eq!(film.at(frame, (5.0, 5.0)), None, "frame {frame}");
        let found = [film.at(frame, (x - 35.0, 75.0)).unwrap(), film.at(frame, (x, 75.0)).unwrap()];
        assert_eq!(found.map(|region| region.colour), [RED, BLUE], "frame {frame}");
    }
}

#[test]
fn a_click_without_a_colour_keeps_a_region_without_paint() {
    let [_, red, _] = own_clicks();
    let hole = FillClick { colour: None, ..click((60.0, 75.0), BLUE) };
    let mut film = Film::new(4, moving).clicked(&[(0, &[red.clone(), hole.clone()])]);
    film.fill().unwrap();
    for frame in 0..=4 {
        let x = 60.0 + 6.0 * f64::from(frame);
        assert_eq!(film.at(frame, (x - 35.0, 75.0)).unwrap().colour, RED, "frame {frame}");
        assert_eq!(film.at(frame, (x, 75.0)), None, "frame {frame}: the hole");
    }
    // A later click paints it from there on.
    let mut film = Film::new(4, moving).clicked(&[(0, &[red, hole]), (2, &[click((72.0, 75.0), BLUE)])]);
    film.fill().unwrap();
    let colours: Vec<bool> = (0..=4).map(|f| film.at(f, (60.0 + 6.0 * f64::from(f), 75.0)).is_some()).collect();
    assert_eq!(colours, [false, false, true, true, true]);
}

#[test]
fn work_begins_at_the_clicks_and_goes_both_ways() {
    let x = 60.0 + 6.0 * 2.0;
    let clicks = [click((5.0, 5.0), PAPER), click((x - 35.0, 75.0), RED), click((x, 75.0), BLUE)];
    let mut film = Film::new(4, moving).clicked(&[(2, &clicks)]);
    film.fill().unwrap();
    for frame in 0..=4 {
        assert_eq!(film.at(frame, (60.0 + 6.0 * f64::from(frame), 75.0)).unwrap().colour, BLUE, "frame {frame}");
    }
}

#[test]
fn a_region_that_falls_to_pieces_keeps_its_colour_on_all_of_them() {
    // A bar comes from above and passes the whole box.
    let crossed = |frame: FrameNumber, p: Point| {
        let bar = boxed(p, (100.0, -50.0 + 50.0 * f64::from(frame)), (8.0, 60.0));
        let inside = (p.x - 100.0).abs() < 8.0 && (p.y - (-50.0 + 50.0 * f64::from(frame))).abs() < 60.0;
        let behind = if inside { f64::INFINITY } else { boxed(p, (100.0, 80.0), (60.0, 40.0)) };
        behind.min(bar)
    };
    let clicks = [click((3.0, 140.0), PAPER), click((60.0, 80.0), RED), click((100.0, 2.0), BLUE)];
    let mut film = Film::new(3, crossed).clicked(&[(0, &clicks)]);
    film.fill().unwrap();
    let (left, right) = (film.at(3, (60.0, 80.0)).unwrap(), film.at(3, (140.0, 80.0)).unwrap());
    assert_eq!((left.colour, right.colour), (RED, RED));
    assert_ne!(left.track, right.track, "a number occurs once on a frame");
    assert_eq!(film.at(3, (100.0, 80.0)).unwrap().colour, BLUE);
}

#[test]
fn two_names_of_one_look_stay_two_colours() {
    let named = |click: FillClick, name: &str| FillClick { name: Some(name.into()), ..click };
    let [_, coat, hair] = own_clicks();
    let mut film = Film::new(3, moving)
        .clicked(&[(0, &[named(coat, "coat"), named(FillClick { colour: Some(RED), ..hair }, "hair")])]);
    film.fill().unwrap();
    for frame in 0..=3 {
        let x = 60.0 + 6.0 * f64::from(frame);
        let found = [x - 35.0, x].map(|x| film.at(frame, (x, 75.0)).unwrap());
        assert_eq!([0, 1].map(|k| found[k].colour), [RED; 2], "frame {frame}");
        assert_eq!([0, 1].map(|k| found[k].name.as_deref()), [Some("coat"), Some("hair")], "frame {frame}");
        assert_ne!(found[0].track, found[1].track);
    }
    // A night palette is one edit: nothing is painted again.
    let mut value: serde_json::Value = serde_json::from_str(&film.document.to_json()).unwrap();
    value["palette"] = serde_json::json!({"hair": [0.0, 0.0, 1.0]});
    film.document = Document::parse(&value.to_string(), "film.json").unwrap();
    assert_eq!([25.0, 60.0].map(|x| film.at(0, (x, 75.0)).unwrap().colour), [RED, BLUE]);
    let names = super::super::paint::Cels::regions(&film.document).unwrap().names();
    assert_eq!(names.into_iter().collect::<Vec<_>>(), ["coat", "hair"]);
    let svg: Vec<Option<String>> = fills_to_export(&film.document).unwrap().into_iter().map(|own| own.name).collect();
    assert_eq!(svg, [Some("coat".to_owned()), Some("hair".to_owned())]);
}

/// The moving box with its disc, and two squares on the right, of which the second one is hidden on frames 2 and 3.
fn coat(frame: FrameNumber, p: Point) -> f64 {
    let square = |y: f64| boxed(p, (178.0, y), (14.0, 14.0));
    let second = if (2..4).contains(&frame) { 99.0 } else { square(120.0) };
    moving(frame / 2, p).min(square(30.0)).min(second)
}

#[test]
fn what_was_hidden_when_a_colour_changed_comes_back_in_the_new_one() {
    let green = [0.0, 0.6, 0.2];
    let squares = [click((178.0, 30.0), BLUE), click((178.0, 120.0), BLUE)];
    let [paper, red, _] = own_clicks();
    let yellow = click((60.0, 75.0), [1.0, 1.0, 0.0]);
    let all = [vec![paper, red, yellow], squares.to_vec()].concat();
    let mut film = Film::new(6, coat).clicked(&[(0, &all), (2, &[click((178.0, 30.0), green)])]);
    film.fill().unwrap();
    let colours = |film: &Film, y: f64| (0..=6).map(|f| film.at(f, (178.0, y)).unwrap().colour).collect::<Vec<_>>();
    assert_eq!(colours(&film, 30.0), [BLUE, BLUE, green, green, green, green, green]);
    assert_eq!(colours(&film, 120.0), [BLUE, BLUE, PAPER, PAPER, green, green, green]);
    // A colour that the model drawing has mends a mistake, and says nothing of what is hidden.
    let mut film = film.clicked(&[(0, &all), (2, &[click((178.0, 30.0), RED)])]);
    film.fill().unwrap();
    assert_eq!(colours(&film, 120.0)[4..], [BLUE; 3]);
}

#[test]
fn of_frames_with_few_clicks_the_one_with_most_is_the_model() {
    // Of 3 regions one is clicked, and then another one.
    let x = |frame: FrameNumber| 60.0 + 6.0 * f64::from(frame);
    let (first, second) = ([click((x(1), 75.0), BLUE)], [click((x(3) - 35.0, 75.0), RED)]);
    let mut film = Film::new(4, moving).clicked(&[(1, &first), (3, &second)]);
    film.fill().unwrap();
    assert_eq!(film.at(0, (x(0), 75.0)).unwrap().colour, BLUE, "of two with as many, the first one");
    assert_eq!([3, 4].map(|frame| film.at(frame, (x(frame) - 35.0, 75.0)).unwrap().colour), [RED; 2]);
    assert_eq!([3, 4].map(|frame| film.at(frame, (x(frame), 75.0)).unwrap().colour), [BLUE; 2]);
}

#[test]
fn a_drawing_with_nothing_in_common_is_not_painted_and_told() {
    let cut = |frame: FrameNumber, p: Point| match frame {
        0 => moving(0, p),
        _ => (0..9)
            .map(|k| ring(p, (20.0 + 20.0 * f64::from(k), 30.0 + 12.0 * f64::from(k * k % 8)), 7.0))
            .fold(99.0, f64::min),
    };
    let mut film = Film::new(1, cut).clicked(&[(0, &own_clicks())]);
    let report = film.fill().unwrap();
    assert!(!report.frames[1].related, "{report:?}");
    assert!(film.at(1, (5.0, 5.0)).is_none());
    assert!(report.lines().iter().any(|line| line.ends_with("shows the same: frame 1")), "{:?}", report.lines());
}

#[test]
fn other_frames_and_the_document_stay() {
    let mut film = Film::new(4, moving).clicked(&[(0, &own_clicks())]);
    film.fill().unwrap();
    let before = film.document.filled().unwrap();
    fill(&mut film.document, film.folder.path(), Some(2..=2), &FillOptions::default(), None, &Silent).unwrap();
    assert_eq!(film.document.filled().unwrap(), before, "frame 2 is painted as before, and the others are kept");
}

#[test]
fn a_number_has_one_colour_on_kept_frames_too() {
    let [paper, red, _] = own_clicks();
    let clicks = |disc: Colour| [paper.clone(), red.clone(), click((60.0, 75.0), disc)];
    let mut film = Film::new(3, moving).clicked(&[(0, &clicks(BLUE))]);
    film.fill().unwrap();
    // Another colour on the first frame, but only the last one is painted again.
    let mut film = film.clicked(&[(0, &clicks(RED))]);
    fill(&mut film.document, film.folder.path(), Some(3..=3), &FillOptions::default(), None, &Silent).unwrap();
    let (kept, new) = (film.at(2, (72.0, 75.0)).unwrap(), film.at(3, (78.0, 75.0)).unwrap());
    assert_eq!((kept.colour, new.colour), (BLUE, RED));
    assert_ne!(kept.track, new.track);
    assert_eq!(film.at(2, (5.0, 5.0)).unwrap().track, film.at(3, (5.0, 5.0)).unwrap().track, "the paper is the same");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let painted = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut film = Film::new(3, moving).clicked(&[(0, &own_clicks())]);
        pool.install(|| film.fill()).unwrap();
        film.document.to_json()
    };
    assert_eq!(painted(1), painted(4));
}

#[test]
fn errors_name_the_field() {
    let told = |mut film: Film| film.fill().unwrap_err().to_string();
    let film = || Film::new(1, moving);
    assert!(told(film()).starts_with("fills: found no click, expected clicks of the paint bucket on a frame"));
    assert_eq!(
        told(film().clicked(&[(9, &own_clicks())])),
        "fills[0].frame: found 9, expected a frame of the footage, 0 to 1"
    );
    let mut outside = film().clicked(&[(0, &[click((5.0, 5.0), PAPER), click((900.0, 5.0), RED)])]);
    let report = outside.fill().unwrap();
    let told: Vec<_> = report.missed.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["frame 0, pixel (900.0, 5.0): the click fills[0].regions[1]"]);
    assert_eq!((report.missed[0].frame, report.missed[0].click), (0, 1));
    let range = fill(&mut outside.document, outside.folder.path(), Some(0..=7), &FillOptions::default(), None, &Silent);
    assert_eq!(range.unwrap_err().to_string(), "frames: found 0 to 7, expected frames of the footage, 0 to 1");
}

#[test]
fn regions_that_are_not_sure_enough_stay_unpainted() {
    // The disc is not clicked, so nothing is known about it.
    let mut film = Film::new(1, moving).clicked(&[(0, &own_clicks()[..2])]);
    film.fill().unwrap();
    let guessed = film.at(1, (66.0, 75.0)).unwrap();
    assert!(guessed.confidence < 0.5, "{}", guessed.confidence);
    let options = FillOptions { confidence: 0.5, ..FillOptions::default() };
    fill(&mut film.document, film.folder.path(), None, &options, None, &Silent).unwrap();
    assert_eq!(film.at(1, (66.0, 75.0)), None);
    assert_eq!(film.at(1, (31.0, 75.0)).unwrap().colour, RED);
}

#[test]
fn a_held_drawing_has_the_regions_of_the_frame_before() {
    let mut film = Film::new(5, |frame, p| moving(frame / 2, p)).dusty().clicked(&[(0, &own_clicks())]);
    let report = film.fill().unwrap();
    assert!(report.frames.len() == 6 && report.frames.iter().all(|frame| frame.regions == 3), "{report:?}");
    let filled = film.document.filled().unwrap();
    for k in [0, 2, 4] {
        assert_eq!(filled[k].regions, filled[k + 1].regions, "frame {}", k + 1);
    }
    assert_ne!(filled[1].regions, filled[2].regions);
}

#[test]
fn clicks_without_a_line_between_them_and_frames_without_lines_are_told() {
    // From frame 2 on nothing is drawn. On frame 0 two clicks of other colours follow each other to the same places.
    let ink = |frame, p| if frame < 2 { moving(frame, p) } else { 99.0 };
    let twice = [
        click((5.0, 5.0), RED),
        click((25.0, 75.0), BLUE),
        click((60.0, 75.0), PAPER),
        click((5.0, 5.0), PAPER),
        click((25.0, 75.0), RED),
        click((60.0, 75.0), BLUE),
    ];
    let mut film = Film::new(3, ink).clicked(&[(0, &twice)]);
    let report = film.fill().unwrap();
    assert_eq!(report.overruled.iter().map(|own| (own.frame, own.click)).collect::<Vec<_>>(), [(0, 0), (0, 1), (0, 2)]);
    assert_eq!(
        report.frames.iter().map(|own| (own.frame, own.bare)).collect::<Vec<_>>(),
        [(0, false), (1, false), (2, true), (3, true)]
    );
    let lines = report.lines();
    let vain = "frame 0: 3 of 6 clicks paint nothing, since a later click fills the same region: the line between them was not found, \
                or is open";
    assert!(lines.iter().any(|line| line == vain), "{lines:?}");
    let bare = "frames 2-3: hardly any region, but 6 clicks on one frame: a higher --sensitivity finds fainter lines";
    assert!(lines.iter().any(|line| line == bare), "{lines:?}");
    let sound = Film::new(1, moving).clicked(&[(0, &own_clicks())]).fill().unwrap();
    assert!(sound.overruled.is_empty() && sound.lines().len() == 1, "{:?}", sound.lines());
}

#[test]
fn the_share_that_is_done_never_falls() {
    struct Shares(std::sync::Mutex<Vec<f64>>);
    impl Progress for Shares {
        fn report(&self, _: &str, done: f64) -> Result<(), crate::scene::Cancelled> {
            self.0.lock().unwrap().push(done);
            Ok(())
        }
    }
    let mut film = Film::new(4, moving).clicked(&[(0, &own_clicks())]);
    let rises = |work: &mut dyn FnMut(&Shares)| {
        let shares = Shares(std::sync::Mutex::default());
        work(&shares);
        let shares = shares.0.into_inner().unwrap();
        assert!(shares.len() > 5 && shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
    };
    rises(&mut |shares| {
        fill(&mut film.document, film.folder.path(), None, &FillOptions::default(), None, shares).unwrap();
    });
    rises(&mut |shares| {
        super::super::trace(
            &mut film.document,
            film.folder.path(),
            None,
            &super::super::TraceOptions::default(),
            super::super::Kept::default(),
            shares,
        )
        .unwrap();
    });
}
