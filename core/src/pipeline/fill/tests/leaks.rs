//! Lines with gaps, and clicks that leak through them.

use super::*;

#[test]
fn a_click_that_leaks_into_the_paper_does_not_flood_it() {
    // A box with a disc in it. From frame 2 on a cuff hangs below it whose outline is open on one side.
    let ink = |frame: FrameNumber, p: Point| {
        let cuff = boxed(p, (60.0 + 6.0 * f64::from(frame), 133.0), (11.0, 11.0));
        let open = p.x > 66.0 + 6.0 * f64::from(frame) && (p.y - 133.0).abs() < 2.5;
        if frame < 2 || open { moving(frame, p) } else { moving(frame, p).min(cuff) }
    };
    let clicks = [click((25.0, 75.0), RED), click((60.0, 75.0), BLUE)];
    let green = [0.0, 1.0, 0.0];
    let mut film = Film::new(5, ink).clicked(&[(0, &clicks), (2, &[click((72.0, 133.0), green)])]);
    film.fill().unwrap();
    for frame in 2..=5 {
        let x = 60.0 + 6.0 * f64::from(frame);
        assert_eq!(film.at(frame, (x, 133.0)).map(|own| own.colour), Some(green), "frame {frame}");
        assert_eq!(film.at(frame, (190.0, 10.0)), None, "frame {frame}: the paper stays without paint");
        assert_eq!(film.at(frame, (x - 30.0, 75.0)).map(|own| own.colour), Some(RED), "frame {frame}");
    }
}

/// The moving box with a gap of a width in its right side, on frame 0 alone or on all.
fn open_box(width: f64, always: bool) -> impl Fn(FrameNumber, Point) -> f64 {
    move |frame, p| {
        let x = 60.0 + 6.0 * f64::from(frame);
        let open = p.x > x + 40.0 && (p.y - 95.0).abs() < 0.5 * width && (always || frame == 0);
        if open { ring(p, (x, 75.0), 18.0) } else { moving(frame, p) }
    }
}

#[test]
fn a_gap_on_the_model_drawing_does_not_flood_the_paper() {
    for always in [false, true] {
        let [_, red, blue] = own_clicks();
        let mut film = Film::new(4, open_box(3.0, always)).clicked(&[(0, &[red, blue])]);
        let report = film.fill().unwrap();
        for frame in 0..=4 {
            let x = 60.0 + 6.0 * f64::from(frame);
            assert_eq!(film.at(frame, (190.0, 10.0)), None, "frame {frame}: the paper stays without paint");
            let found = film.at(frame, (x - 35.0, 75.0)).unwrap();
            assert!(found.colour == RED && found.confidence > 0.5, "frame {frame}: {found:?}");
        }
        let [leak] = report.leaking.as_slice() else { panic!("{report:?}") };
        assert!(leak.gap.closes && leak.place.click == 0, "{leak:?}");
        let told = "frame 0: the click at (25, 75) was parted from what is around at a gap of about";
        assert!(report.lines().iter().any(|line| line.starts_with(told)), "{:?}", report.lines());
    }
}

#[test]
fn a_click_that_leaks_through_a_wide_gap_is_named_and_in_doubt() {
    // Four pixels of this film are more than ten of 540 lines.
    let [_, red, blue] = own_clicks();
    let mut film = Film::new(1, open_box(9.0, true)).clicked(&[(0, &[red, blue])]);
    let report = film.fill().unwrap();
    let told = "frame 0: the click at (25, 75) paints 200 × 150 px up to the picture's edge, through a gap of about";
    assert!(report.lines().iter().any(|line| line.starts_with(told)), "{:?}", report.lines());
    for frame in 0..=1 {
        let all = film.at(frame, (190.0, 10.0)).unwrap();
        assert!(all.colour == RED && all.confidence < DOUBT, "frame {frame}: {all:?}");
    }
    assert!(report.frames.iter().all(|frame| frame.doubtful > 0), "{report:?}");
    // Whoever paints the paper, too, means it.
    let all = own_clicks();
    let mut film = Film::new(1, open_box(9.0, true)).clicked(&[(0, &all)]);
    assert!(film.fill().unwrap().leaking.is_empty());
}
