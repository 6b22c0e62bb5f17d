//! The built-in templates: a human, a quadruped, a bird.
//!
//! The human one has the 17 key points of [`super::super::skeleton`]. Animals are written as tables, in which a name with `?` stands for the
//! same point on either side. All left points come before all right ones.

use super::{Chain, GivenChain, GivenPoint, KeyPoint, Role, Template};
use crate::geometry::Point;
use crate::scene::skeleton::{COUNT, MIRROR, NAMES, PARENTS};
use std::sync::{Arc, LazyLock};

/// Names of the built-in templates.
pub const BUILT_IN: [&str; 3] = ["human", "quadruped", "bird"];

impl Template {
    /// The human template: 17 key points.
    pub fn human() -> Arc<Self> {
        HUMAN.clone()
    }

    /// A four-legged animal that walks on its toes: dog, cat, horse.
    pub fn quadruped() -> Arc<Self> {
        QUADRUPED.clone()
    }

    /// A bird that walks and flies.
    pub fn bird() -> Arc<Self> {
        BIRD.clone()
    }

    /// The built-in template of a name.
    pub fn built_in(name: &str) -> Option<Arc<Self>> {
        [&HUMAN, &QUADRUPED, &BIRD]
            .into_iter()
            .find(|template| template.name == name)
            .map(|template| Arc::clone(template))
    }
}

/// The human template. Its typical posture stands upright with hanging arms, in torso lengths.
static HUMAN: LazyLock<Arc<Template>> = LazyLock::new(|| {
    const AT: [f64; COUNT] =
        [0.0, -0.55, -1.0, -1.2, -1.5, -0.956, -0.456, -0.006, -0.956, -0.456, -0.006, 0.0, 0.8, 1.55, 0.0, 0.8, 1.55];
    let parents = |k: usize| if k == 0 { k } else { PARENTS[k] };
    let point = |k: usize| KeyPoint {
        name: NAMES[k].into(),
        parent: parents(k),
        mirror: MIRROR[k],
        at: Point::new(0.0, AT[k]),
    };
    let chain = |name: &str, points: &[usize], role| Chain { name: name.into(), points: points.to_vec(), role };
    let chains = vec![
        chain("torso", &[0, 1, 2], Role::Torso),
        chain("head", &[2, 3, 4], Role::Head),
        chain("l_arm", &[5, 6, 7], Role::Limb),
        chain("r_arm", &[8, 9, 10], Role::Limb),
        chain("l_leg", &[11, 12, 13], Role::Leg),
        chain("r_leg", &[14, 15, 16], Role::Leg),
    ];
    Arc::new(Template { name: "human".into(), points: (0..COUNT).map(point).collect(), chains })
});

/// A row of the tables below: name, parent, place. A name with `?` stands for two points, `l_` and `r_`.
type Row = (&'static str, &'static str, f64, f64);
/// A chain of the tables: name, key points, role. A name with `?` stands for two.
type RowChain = (&'static str, &'static [&'static str], Role);

/// Makes a template of tables. They are constant, and a test makes all of them.
fn of_tables(name: &str, rows: &[Row], chains: &[RowChain]) -> Arc<Template> {
    let sided = |name: &str| -> Vec<String> {
        match name.strip_prefix('?') {
            Some(stem) => ["l", "r"].map(|side| format!("{side}_{stem}")).to_vec(),
            None => vec![name.to_owned()],
        }
    };
    let mut points: Vec<GivenPoint> = Vec::new();
    let mut pairs: Vec<(String, String)> = Vec::new();
    for side in 0..2 {
        for (name, parent, x, y) in rows {
            let (names, parents) = (sided(name), sided(parent));
            let Some(own) = names.get(side) else { continue };
            let parent = parents.get(side).or(parents.first()).filter(|parent| !parent.is_empty()).cloned();
            points.push((own.clone(), parent, Point::new(*x, *y)));
            if let (0, [left, right]) = (side, &names[..]) {
                pairs.push((left.clone(), right.clone()));
            }
        }
    }
    let mut made: Vec<GivenChain> = Vec::new();
    for (name, of, role) in chains {
        for (side, own) in sided(name).into_iter().enumerate() {
            let point = |point: &&str| sided(point).into_iter().nth(side).unwrap_or_else(|| sided(point).remove(0));
            made.push((own, of.iter().map(point).collect(), *role));
        }
    }
    Arc::new(Template::new(name, &points, &pairs, &made).unwrap_or_default())
}

static QUADRUPED: LazyLock<Arc<Template>> = LazyLock::new(|| {
    of_tables(
        "quadruped",
        &[
            ("pelvis", "", 0.0, 0.0),
            ("back", "pelvis", 0.5, -0.03),
            ("withers", "back", 1.0, -0.05),
            ("neck", "withers", 1.25, -0.3),
            ("head", "neck", 1.4, -0.5),
            ("muzzle", "head", 1.75, -0.4),
            ("tail_base", "pelvis", -0.15, -0.05),
            ("tail_middle", "tail_base", -0.4, 0.1),
            ("tail_tip", "tail_middle", -0.6, 0.35),
            ("?shoulder", "withers", 1.05, 0.2),
            ("?elbow", "?shoulder", 0.95, 0.5),
            ("?wrist", "?elbow", 1.0, 0.85),
            ("?forepaw", "?wrist", 1.05, 1.05),
            ("?hip", "pelvis", 0.0, 0.1),
            ("?knee", "?hip", 0.15, 0.5),
            ("?hock", "?knee", -0.1, 0.8),
            ("?hindpaw", "?hock", -0.05, 1.05),
        ],
        &[
            ("torso", &["pelvis", "back", "withers"], Role::Torso),
            ("neck", &["withers", "neck", "head"], Role::Other),
            ("head", &["head", "muzzle"], Role::Head),
            ("tail", &["tail_base", "tail_middle", "tail_tip"], Role::Other),
            ("?foreleg", &["?shoulder", "?elbow", "?wrist", "?forepaw"], Role::Leg),
            ("?leg", &["?hip", "?knee", "?hock", "?hindpaw"], Role::Leg),
        ],
    )
});

static BIRD: LazyLock<Arc<Template>> = LazyLock::new(|| {
    of_tables(
        "bird",
        &[
            ("pelvis", "", 0.0, 0.0),
            ("breast", "pelvis", 1.0, -0.35),
            ("neck", "breast", 1.2, -0.75),
            ("head", "neck", 1.3, -1.05),
            ("beak", "head", 1.65, -1.0),
            ("tail_base", "pelvis", -0.3, 0.0),
            ("tail_tip", "tail_base", -0.9, 0.15),
            ("?shoulder", "breast", 0.8, -0.35),
            ("?elbow", "?shoulder", 0.45, -0.1),
            ("?wrist", "?elbow", 0.75, 0.0),
            ("?wing_tip", "?wrist", -0.3, 0.05),
            ("?hip", "pelvis", 0.25, 0.1),
            ("?knee", "?hip", 0.5, 0.4),
            ("?heel", "?knee", 0.25, 0.75),
            ("?toes", "?heel", 0.4, 1.2),
        ],
        &[
            ("torso", &["pelvis", "breast"], Role::Torso),
            ("neck", &["breast", "neck", "head"], Role::Other),
            ("head", &["head", "beak"], Role::Head),
            ("tail", &["tail_base", "tail_tip"], Role::Other),
            ("?wing", &["?shoulder", "?elbow", "?wrist", "?wing_tip"], Role::Limb),
            ("?leg", &["?hip", "?knee", "?heel", "?toes"], Role::Leg),
        ],
    )
});
