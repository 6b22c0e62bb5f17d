//! The poses of the twelve drawings, which an animator decides by hand.
//!
//! Lengths are in units of the character's model sheet (see [`super::rig`]). x is to the right along the ground, heights are
//! upwards from the ground. Angles are in degrees.

/// The pose of one drawing. Each drawing is held for two frames.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// The hips: x and height.
    pub hip: [f64; 2],
    /// Height of body and head, as a factor on the model sheet. A lower body is wider.
    pub squash: f64,
    /// Direction that the body faces: 1 right, 0 the viewer, -1 left.
    pub facing: f64,
    /// Lean of the body to the right.
    pub lean: f64,
    /// Tilt of the head to the right, relative to the body.
    pub tilt: f64,
    /// The foot of the near leg: x, height of the middle of the sole, clockwise turn.
    pub near_foot: [f64; 3],
    /// The foot of the far leg.
    pub far_foot: [f64; 3],
    /// The near arm: angles of upper arm and forearm from straight down, towards the right.
    pub near_arm: [f64; 2],
    /// The far arm.
    pub far_arm: [f64; 2],
    /// The scarf's tail: angles of its upper and lower half from straight down, towards the right.
    pub scarf: [f64; 2],
    /// The hat: angles of its lower and upper half from straight up, towards the right.
    pub hat: [f64; 2],
    /// Opening of the mouth, 0 to 1.
    pub mouth: f64,
    /// Opening of the eyes, 0 to 1.
    pub eyes: f64,
    /// Swing of the coat's hem to the right.
    pub sway: f64,
}

const WALK: Drawing = Drawing {
    hip: [0.0, 112.0],
    squash: 1.0,
    facing: 0.85,
    lean: 5.0,
    tilt: -3.0,
    near_foot: [0.0; 3],
    far_foot: [0.0; 3],
    near_arm: [0.0, 0.0],
    far_arm: [0.0, 0.0],
    scarf: [-58.0, -70.0],
    hat: [-14.0, -78.0],
    mouth: 0.15,
    eyes: 1.0,
    sway: 0.0,
};

/// Six drawings of a walk to the right, a crouch, a jump that turns the character round, a landing, a step to the left.
pub const DRAWINGS: [Drawing; 12] = [
    Drawing {
        hip: [96.0, 111.0],
        near_foot: [162.0, 4.0, -16.0],
        far_foot: [30.0, 12.0, 34.0],
        near_arm: [-52.0, -22.0],
        far_arm: [44.0, 84.0],
        sway: -5.0,
        ..WALK
    },
    Drawing {
        hip: [142.0, 103.0],
        squash: 0.95,
        lean: 7.0,
        near_foot: [162.0, 0.0, 0.0],
        far_foot: [84.0, 34.0, 58.0],
        near_arm: [-30.0, 4.0],
        far_arm: [18.0, 62.0],
        scarf: [-50.0, -84.0],
        hat: [-18.0, -96.0],
        sway: 1.0,
        ..WALK
    },
    Drawing {
        hip: [188.0, 121.0],
        squash: 1.05,
        lean: 4.0,
        near_foot: [164.0, 4.0, 14.0],
        far_foot: [214.0, 32.0, 12.0],
        near_arm: [14.0, 56.0],
        far_arm: [-24.0, 6.0],
        scarf: [-66.0, -52.0],
        hat: [-8.0, -58.0],
        mouth: 0.3,
        sway: 4.0,
        ..WALK
    },
    Drawing {
        hip: [234.0, 111.0],
        near_foot: [168.0, 12.0, 34.0],
        far_foot: [300.0, 4.0, -16.0],
        near_arm: [46.0, 88.0],
        far_arm: [-50.0, -20.0],
        scarf: [-60.0, -74.0],
        hat: [-14.0, -76.0],
        mouth: 0.25,
        sway: 5.0,
        ..WALK
    },
    Drawing {
        hip: [280.0, 103.0],
        squash: 0.95,
        lean: 7.0,
        near_foot: [222.0, 34.0, 58.0],
        far_foot: [300.0, 0.0, 0.0],
        near_arm: [20.0, 64.0],
        far_arm: [-28.0, 4.0],
        scarf: [-48.0, -82.0],
        hat: [-18.0, -98.0],
        eyes: 0.12,
        sway: 0.0,
        ..WALK
    },
    Drawing {
        hip: [326.0, 121.0],
        squash: 1.05,
        lean: 2.0,
        facing: 0.75,
        near_foot: [354.0, 32.0, 12.0],
        far_foot: [302.0, 4.0, 14.0],
        near_arm: [-24.0, 8.0],
        far_arm: [14.0, 58.0],
        scarf: [-70.0, -48.0],
        hat: [-6.0, -50.0],
        mouth: 0.45,
        sway: -4.0,
        ..WALK
    },
    Drawing {
        hip: [356.0, 66.0],
        squash: 0.76,
        lean: 13.0,
        tilt: 5.0,
        facing: 0.6,
        near_foot: [392.0, 0.0, 0.0],
        far_foot: [314.0, 0.0, 0.0],
        near_arm: [-74.0, -44.0],
        far_arm: [62.0, 112.0],
        scarf: [-16.0, -4.0],
        hat: [24.0, 92.0],
        mouth: 0.0,
        eyes: 0.1,
        sway: -2.0,
    },
    Drawing {
        hip: [368.0, 172.0],
        squash: 1.17,
        lean: -4.0,
        tilt: 0.0,
        facing: 0.15,
        near_foot: [376.0, 52.0, 48.0],
        far_foot: [344.0, 44.0, 40.0],
        near_arm: [-142.0, -158.0],
        far_arm: [132.0, 160.0],
        scarf: [26.0, 8.0],
        hat: [-26.0, -100.0],
        mouth: 0.8,
        eyes: 1.0,
        sway: 3.0,
    },
    Drawing {
        hip: [386.0, 198.0],
        squash: 1.02,
        lean: -10.0,
        tilt: -6.0,
        facing: -0.45,
        near_foot: [424.0, 116.0, 24.0],
        far_foot: [322.0, 102.0, -30.0],
        near_arm: [-112.0, -86.0],
        far_arm: [100.0, 128.0],
        scarf: [64.0, 96.0],
        hat: [14.0, 76.0],
        mouth: 1.0,
        eyes: 1.0,
        sway: 6.0,
    },
    Drawing {
        hip: [392.0, 64.0],
        squash: 0.74,
        lean: -8.0,
        tilt: 3.0,
        facing: -0.8,
        near_foot: [436.0, 0.0, 0.0],
        far_foot: [346.0, 0.0, 0.0],
        near_arm: [-66.0, -104.0],
        far_arm: [70.0, 106.0],
        scarf: [112.0, 148.0],
        hat: [8.0, 24.0],
        mouth: 0.0,
        eyes: 0.5,
        sway: 0.0,
    },
    Drawing {
        hip: [382.0, 119.0],
        squash: 1.06,
        lean: -3.0,
        tilt: 4.0,
        facing: -0.85,
        near_foot: [428.0, 5.0, -16.0],
        far_foot: [340.0, 32.0, -12.0],
        near_arm: [12.0, -28.0],
        far_arm: [-26.0, -70.0],
        scarf: [70.0, 46.0],
        hat: [6.0, 66.0],
        mouth: 0.4,
        eyes: 1.0,
        sway: 4.0,
    },
    Drawing {
        hip: [342.0, 110.0],
        squash: 1.0,
        lean: -5.0,
        tilt: 3.0,
        facing: -0.85,
        near_foot: [408.0, 12.0, -34.0],
        far_foot: [276.0, 4.0, 16.0],
        near_arm: [-46.0, -88.0],
        far_arm: [50.0, 22.0],
        scarf: [58.0, 72.0],
        hat: [14.0, 80.0],
        mouth: 0.3,
        eyes: 1.0,
        sway: 5.0,
    },
];
