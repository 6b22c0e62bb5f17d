//! What a part or a line follows that no limb carries.
//!
//! The document may say it (`follows`): another part, the way of the pelvis, the contact with the ground, or nothing.
//! Otherwise it is found in the drawing, and told. The first of these rules that fits counts:
//!
//! 1. A part that lies at least half on another one that is not in front of it follows that part: a button, a patch, an eye. Of several
//!    the nearest to the viewer counts.
//! 2. A part larger than the figure is background: it stays. So a ground that goes through the picture is no shadow, and a sofa
//!    that touches the figure does not go with it.
//! 3. A flat part under the feet, at the height of the ground, is a cast shadow. It goes with the contact: along the
//!    ground with the pelvis, never up or down.
//! 4. A part that touches another one, or nearly does, follows that part, unless it belongs to an arm or a leg: a hat
//!    above a head goes with it, but a ball beside a shin does not swing with the shin.
//! 5. A part that lies at least half on one in front of it follows that, as in rule 1. It comes this late because a far hand that passes
//!    behind a thigh goes with its arm.
//! 6. A part away from the figure is background, too: it stays.
//! 7. Anything else goes with the pelvis.
//!
//! **Hosts.** A part may lie on one that itself is carried by no limb: an eye on a head without limbs. It then moves with
//! whatever moves that part. Larger parts are decided before smaller ones, so nothing follows itself. What stays where it is
//! drawn bears nothing: a hat before a painted sky does not stay with the sky.
//!
//! **Lines** (strokes, open contours) have no inside. Places at equal ways along a line count in place of its points, for a straight line has
//! two points only. A place is on a part if it is inside or hardly outside: the line may be the part's own outline. Unlike
//! a part, a line that touches an arm or a leg goes with it: folds and fringes stick out.

use super::motion::Motion;
use crate::geometry::{Point, polygon, polyline};
use crate::scene::limbs::{Follow, LimbSet};

/// A shadow is at least this many times as wide as high.
const FLAT: f64 = 4.0;
/// Parts touch if the way between them is at most this share of the torso.
const NEAR: f64 = 0.1;
/// A part is away from the figure beyond this share of the torso.
const AWAY: f64 = 1.0;
/// A part is larger than the figure if its longer side is this many times the figure's, or its area is larger: a lance in a hand may
/// be longer than a figure is high.
const LONGER: f64 = 1.25;
/// A place of a line is on a part if it is no more than this share of the torso outside.
const ON: f64 = 0.02;
/// Places along a line.
const PLACES: usize = 48;

/// What a part follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Given {
    /// Another part, by name.
    Part(String),
    /// The way of the pelvis.
    Root,
    /// The contact with the ground.
    Contact,
    /// Nothing: it stays where it is drawn.
    Nothing,
}

impl Given {
    /// How far it moves when the pelvis has moved by a way. (What follows a part moves with that part's limbs.)
    pub(super) fn shift(&self, way: Point) -> Point {
        match self {
            Self::Part(_) | Self::Root => way,
            Self::Contact => Point::new(way.x, 0.0),
            Self::Nothing => Point::ZERO,
        }
    }
}

impl std::fmt::Display for Given {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Part(name) => write!(f, "it follows the part {name:?}"),
            Self::Root => f.write_str("it goes with the pelvis"),
            Self::Contact => f.write_str("it is taken for a shadow and stays on the ground below the figure"),
            Self::Nothing => f.write_str("it stays where it is drawn"),
        }
    }
}

/// A part on which others may lie, at rest.
pub(super) struct Host {
    /// Its name.
    pub name: String,
    /// Its outline.
    pub outline: Vec<Point>,
    /// Its depth.
    pub depth: f64,
    /// Whether a limb of an arm or a leg carries it.
    pub limb: bool,
    /// Whether no limb carries it.
    pub loose: bool,
    /// What moves it if neither limbs nor a part with limbs do.
    pub given: Option<Given>,
}

/// What a drawing offers to hold on to.
pub(super) struct Scenery<'a> {
    pub hosts: Vec<Host>,
    /// The bounds of all parts that limbs carry.
    pub figure: Option<(Point, Point)>,
    pub motion: &'a Motion,
}

/// What a document says that a part follows.
pub(super) fn asked(set: &LimbSet, name: &str) -> Option<Given> {
    set.follows.iter().find(|(part, _)| part == name).map(|(_, follow)| match follow {
        Follow::Part(other) => Given::Part(other.clone()),
        Follow::Root => Given::Root,
        Follow::Contact => Given::Contact,
        Follow::Nothing => Given::Nothing,
    })
}

impl Scenery<'_> {
    /// What a closed part follows by the drawing.
    pub fn of_part(&self, outline: &[Point], depth: f64) -> Given {
        let inside = |host: &Host| outline.iter().filter(|p| polygon::contains(&host.outline, **p)).count();
        let lies = |host: &&Host| 2 * inside(host) >= outline.len();
        let front = |a: &&Host, b: &&Host| a.depth.total_cmp(&b.depth);
        if let Some(host) = self.bearers().filter(|host| host.depth <= depth && lies(host)).max_by(front) {
            return Given::Part(host.name.clone());
        }
        if let Some(background) = self.by_size(outline) {
            return background;
        }
        let touched = self.bearers().filter(|host| !host.limb && host.given != Some(Given::Contact));
        let near = touched.map(|host| (apart(outline, &host.outline), host));
        let near = near.filter(|(distance, _)| *distance <= NEAR * self.motion.size);
        // What a limb carries is a firmer hold.
        if let Some((_, host)) = near.min_by(|a, b| a.1.loose.cmp(&b.1.loose).then(a.0.total_cmp(&b.0))) {
            return Given::Part(host.name.clone());
        }
        if let Some(host) = self.bearers().filter(lies).max_by(front) {
            return Given::Part(host.name.clone());
        }
        self.beside(|host| apart(outline, host))
    }

    /// What a line follows by the drawing.
    pub fn of_line(&self, line: &[Point], closed: bool) -> Given {
        let places = polyline::resample(line, closed, PLACES);
        let outside = |p: &Point, host: &[Point]| match polygon::contains(host, *p) {
            true => 0.0,
            false => polyline::distance(*p, host, true),
        };
        let on = |host: &&Host| places.iter().filter(|p| outside(p, &host.outline) <= ON * self.motion.size).count();
        let front = |a: &(usize, &Host), b: &(usize, &Host)| a.0.cmp(&b.0).then(a.1.depth.total_cmp(&b.1.depth));
        let most = self.bearers().map(|host| (on(&host), host)).max_by(front).filter(|(count, _)| *count > 0);
        if let Some((_, host)) = most.filter(|(count, _)| 2 * count >= places.len()) {
            return Given::Part(host.name.clone());
        }
        if let Some(background) = self.by_size(line) {
            return background;
        }
        let away = |host: &[Point]| places.iter().map(|p| outside(p, host)).fold(f64::INFINITY, f64::min);
        let nearest = || {
            let all = self.bearers().map(|host| (away(&host.outline), host));
            let nearest = all.min_by(|a, b| a.0.total_cmp(&b.0));
            nearest.filter(|(distance, _)| *distance <= NEAR * self.motion.size).map(|(_, host)| host)
        };
        if let Some(host) = most.map(|(_, host)| host).or_else(nearest) {
            return Given::Part(host.name.clone());
        }
        self.beside(away)
    }

    /// The hosts that bear what lies on them.
    fn bearers(&self) -> impl Iterator<Item = &Host> {
        self.hosts.iter().filter(|host| host.given != Some(Given::Nothing))
    }

    /// Rules 2 and 3.
    fn by_size(&self, points: &[Point]) -> Option<Given> {
        let ((low, high), figure) = (polygon::bounds(points)?, self.figure?);
        let (size, all) = (high - low, figure.1 - figure.0);
        if size.x * size.y > all.x * all.y || size.max_element() > LONGER * all.max_element() {
            return Some(Given::Nothing);
        }
        is_shadow((low, high), self.motion).then_some(Given::Contact)
    }

    /// Rules 6 and 7. Only what limbs carry is the figure.
    fn beside(&self, apart: impl Fn(&[Point]) -> f64) -> Given {
        let mut figure = self.hosts.iter().filter(|host| !host.loose);
        match self.figure.is_none() || figure.any(|host| apart(&host.outline) <= AWAY * self.motion.size) {
            true => Given::Root,
            false => Given::Nothing,
        }
    }
}

/// The way between two outlines.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let from =
        |a: &[Point], b: &[Point]| a.iter().map(|p| polyline::distance(*p, b, true)).fold(f64::INFINITY, f64::min);
    from(a, b).min(from(b, a))
}

/// Whether a part with these bounds lies flat on the ground below the figure.
fn is_shadow((low, high): (Point, Point), motion: &Motion) -> bool {
    let (size, middle) = (high - low, low.midpoint(high));
    let below = (middle.x - motion.root.x).abs() < size.x;
    let level = (middle.y - motion.ground).abs() < (0.5 * size.y).max(NEAR * motion.size);
    !motion.feet.is_empty() && size.x >= FLAT * size.y && below && level
}

/// Whether a limb of an arm or a leg carries a part.
pub(super) fn is_limb(set: &LimbSet, name: &str) -> bool {
    let limb = |to: usize| set.template.on_limb(to);
    set.limbs.iter().any(|l| limb(l.to) && l.carries.iter().any(|carried| carried.part == name))
}
