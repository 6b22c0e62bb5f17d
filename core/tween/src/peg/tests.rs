use super::*;
use proptest::prelude::*;
use rototoon_base::curve::Spline;

fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

fn moving(name: &str, parent: Option<usize>, pivot: Point, shift: Point, turn: f64, scale: f64) -> Peg {
    let keys = vec![PegKey::rest(0), PegKey { shift, turn, scale, ..PegKey::rest(10) }];
    Peg { name: name.into(), parent, pivot, keys }
}

#[test]
fn a_child_moves_as_equation_11_says() {
    let car = moving("car", None, p(100.0, 50.0), p(40.0, 0.0), 0.0, 0.5);
    let dog = moving("dog", Some(0), p(120.0, 30.0), p(0.0, -8.0), 0.8, 0.7);
    let tree = PegTree::new(vec![car, dog]).unwrap();
    for t in [0.0, 2.5, 10.0] {
        let u = t / 10.0;
        let (alpha0, alpha, local) = (1.0 - 0.5 * u, 1.0 - 0.3 * u, p(6.0, 2.0));
        let maps = tree.at(t);
        let expected = alpha0 * (alpha * Point::from_angle(0.8 * u).rotate(local) + p(0.0, -8.0 * u));
        let centre = maps[0].apply(p(120.0, 30.0));
        assert!(maps[1].apply(p(126.0, 32.0)).distance(centre + expected) < 1e-12);
    }
}

proptest! {
    /// Theorem 1, for chains in which only the last peg scales.
    #[test]
    fn scaling_and_even_shifts_move_points_evenly_along_lines(
        shifts in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 1..5),
        pivots in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 5),
        scale in 0.1f64..3.0,
        point in (-50.0f64..50.0, -50.0f64..50.0),
        t in 0.0f64..10.0,
    ) {
        let last = shifts.len() - 1;
        let pegs = shifts.iter().enumerate().map(|(k, &shift)| {
            let scale = if k == last { scale } else { 1.0 };
            moving("peg", k.checked_sub(1), Point::from(pivots[k]), Point::from(shift), 0.0, scale)
        });
        let tree = PegTree::new(pegs.collect()).unwrap();
        let at = |t: f64| tree.at(t)[last].apply(Point::from(point));
        prop_assert!(at(t).distance(at(0.0).lerp(at(10.0), t / 10.0)) < 1e-10);
    }

    /// Theorem 2.
    #[test]
    fn moving_the_guides_moves_the_curve(
        guides in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 3..9),
        closed in any::<bool>(),
        turn in -4.0f64..4.0,
        scale in 0.1f64..3.0,
        t in 0.0f64..10.0,
        share in 0.0f64..1.0,
    ) {
        let parent = moving("a", None, p(3.0, 4.0), p(5.0, -9.0), -0.5 * turn, 1.5);
        let tree = PegTree::new(vec![parent, moving("b", Some(0), p(-8.0, 1.0), p(1.0, 2.0), turn, scale)]).unwrap();
        let map = tree.at(t)[1];
        let guides: Vec<Point> = guides.into_iter().map(Point::from).collect();
        let moved = Spline::new(guides.iter().map(|&g| map.apply(g)).collect(), closed).unwrap();
        let curve = Spline::new(guides, closed).unwrap();
        let place = share * curve.piece_count() as f64;
        prop_assert!(moved.point(place).distance(map.apply(curve.point(place))) < 1e-10);
    }

    #[test]
    fn children_may_come_before_their_parents(turn in -3.0f64..3.0, t in 0.0f64..10.0) {
        let (parent, child) = (moving("p", None, p(1.0, 2.0), p(9.0, 9.0), turn, 1.2), |on| moving("c", Some(on), p(5.0, 5.0), p(0.0, 1.0), 1.0, 0.9));
        let a = PegTree::new(vec![parent.clone(), child(0)]).unwrap().at(t);
        let b = PegTree::new(vec![child(1), parent]).unwrap().at(t);
        prop_assert_eq!((a[0], a[1]), (b[1], b[0]));
    }
}

#[test]
fn before_and_after_its_keys_a_peg_rests() {
    let peg = moving("a", None, p(0.0, 0.0), p(10.0, 0.0), 0.0, 1.0);
    assert_eq!(peg.local(-5.0).apply(Point::ZERO), Point::ZERO);
    assert_eq!(peg.local(5.0).apply(Point::ZERO), p(5.0, 0.0));
    assert_eq!(peg.local(99.0).apply(Point::ZERO), p(10.0, 0.0));
    assert_eq!(Peg { keys: vec![], ..peg }.local(3.0).apply(p(2.0, 2.0)), p(2.0, 2.0));
}

#[test]
fn pegs_that_form_no_tree_are_refused() {
    let peg = |name: &str, parent| moving(name, parent, Point::ZERO, Point::ZERO, 0.0, 1.0);
    let said = |pegs: Vec<Peg>| PegTree::new(pegs).unwrap_err().to_string();
    let wrong = said(vec![peg("a", Some(1)), peg("b", Some(2)), peg("c", Some(1))]);
    assert_eq!(wrong, "peg \"b\" is its own ancestor, expected parents without a loop");
    assert!(said(vec![peg("a", Some(0))]).contains("is its own ancestor"));
    assert_eq!(said(vec![peg("a", Some(7))]), "peg \"a\": found parent 7, expected a number below 1");
    let far = Peg { pivot: p(f64::INFINITY, 0.0), ..peg("a", None) };
    assert_eq!(said(vec![far]), "peg \"a\": the pivot is (inf, 0), expected numbers between -1e9 and 1e9");
    let zero = moving("a", None, Point::ZERO, Point::ZERO, 0.0, 0.0);
    assert_eq!(said(vec![zero]), "peg \"a\", frame 10: scale is 0, expected a number from 1e-6 to 1e9");
    let twice = Peg { keys: vec![PegKey::rest(4), PegKey::rest(4)], ..peg("a", None) };
    assert_eq!(said(vec![twice]), "peg \"a\": found a key on frame 4 after one on frame 4, expected a later frame");
    let nan = moving("a", None, Point::ZERO, p(0.0, f64::NAN), 0.0, 1.0);
    assert!(said(vec![nan]).starts_with("peg \"a\", frame 10: shift is NaN"));
    let curve = PegKey { timing: Timing::Custom(vec![(2.0, 0.0)]), ..PegKey::rest(1) };
    assert!(said(vec![Peg { keys: vec![curve], ..peg("a", None) }]).starts_with("peg \"a\", frame 1: place 0"));
    assert!(PegTree::new(vec![]).unwrap().at(0.0).is_empty());
}
