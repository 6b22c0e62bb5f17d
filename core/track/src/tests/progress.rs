//! The progress that the default solver reports.

use super::scene::limb_and_ball;
use crate::{TrackOptions, Tracker};
use rototoon_base::scene::{Cancelled, Progress};
use std::sync::Mutex;

/// The steps and shares that were reported.
#[derive(Default)]
struct Told(Mutex<Vec<(String, f64)>>);

impl Progress for Told {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        self.0.lock().unwrap().push((step.into(), done));
        Ok(())
    }
}

#[test]
fn it_moves_while_pictures_are_read_and_compared() {
    let drawn = limb_and_ball();
    let scene = drawn.scene(vec![drawn.0[0].part("limb", 0.0), drawn.0[1].part("ball", 1.0)]);
    let mut tracker = Tracker::new(TrackOptions::default());
    let mut run = || {
        let told = Told::default();
        tracker.track(&scene, &drawn, &told).unwrap();
        told.0.into_inner().unwrap()
    };
    let told = run();
    assert!(told.windows(2).all(|pair| pair[0].1 <= pair[1].1), "{told:?}");
    for step in ["Reading frames", "Comparing drawings"] {
        let mut shares: Vec<f64> = told.iter().filter(|(name, _)| name == step).map(|&(_, share)| share).collect();
        shares.dedup();
        assert!(shares.len() > 2, "{step}: {shares:?}");
    }
    // A second run has read everything.
    assert!(run().iter().all(|(name, _)| name != "Comparing drawings"));
}
