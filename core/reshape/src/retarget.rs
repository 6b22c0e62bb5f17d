//! A clip of one body for another body, chain by chain.
//!
//! Chains of two templates belong together if they have the same name, or if a pair of names says so ("l_arm" with
//! "l_foreleg"). The torsos always belong together.
//!
//! **Turns.** Of the clip each chain gives how far its bones are turned from the typical posture of *its* template. The
//! bones of the other chain are turned as far from the typical posture of *theirs*. A human leg that swings forward by
//! 20° swings a hind leg forward by 20° from its own bent stance, and an upright torso that leans by 10° pitches a level
//! one by 10°.
//!
//! **Numbers of bones.** They may differ. A bone reaches from one share of its chain's length to another. Its turn is that of
//! the chord between the same two shares of the clip's chain.
//!
//! **The rest.** A key point that no pair moves keeps its typical place on what it hangs on, and turns with it. The root
//! goes the clip's way. [`super::still`] gives the drawing's own shape to what nothing moves. Bones have their typical lengths, in a size in which the paired legs are as long as those of the
//! clip (without legs the torsos), so the way fits the steps.
//!
//! Limits: bones do not grow or shrink, so foreshortening is lost. Contacts are not kept here: [`super::stand`] puts the
//! feet of the drawing on its ground.

use rototoon_base::geometry::Point;
use rototoon_base::scene::proportions::Proportions;
use rototoon_base::scene::template::{Chain, Role, length};
use rototoon_base::scene::{Clip, Template};
use std::sync::Arc;

/// Why a clip cannot be retargeted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RetargetError {
    /// A pair names a chain that is not there.
    #[error("chains: found {found:?}, expected a chain of {template:?}: one of {known}")]
    Chain {
        /// The name that was given.
        found: String,
        /// The template's name.
        template: String,
        /// The names of its chains.
        known: String,
    },
    /// A pair gives a chain a second source.
    #[error("chains: found {found:?} twice, expected one chain of the clip for each chain")]
    Twice {
        /// The name of the chain.
        found: String,
    },
    /// Nothing but the torsos belongs together.
    #[error(
        "chains: found no chain of {from:?} ({theirs}) that belongs to one of {to:?} ({own}), expected equal names or pairs"
    )]
    Nothing {
        /// Name of the clip's template.
        from: String,
        /// Names of its chains.
        theirs: String,
        /// Name of the wanted template.
        to: String,
        /// Names of its chains.
        own: String,
    },
    /// The clip's torso has no length.
    #[error("clip: found a torso of length 0, expected a positive length")]
    Flat,
}

/// A retargeted clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Retargeted {
    /// The clip of the wanted template.
    pub clip: Clip,
    /// Chains of the wanted template that nothing moves. They keep their typical shape.
    pub still: Vec<String>,
    /// For each key point of the wanted template whether the clip moves the bone that ends in it. The root moves.
    pub moved: Vec<bool>,
}

/// Makes a clip of another template. `pairs` are names of chains: of the clip's template, and of the wanted one.
///
/// # Errors
///
/// A [`RetargetError`].
pub fn retarget(clip: &Clip, to: &Arc<Template>, pairs: &[(String, String)]) -> Result<Retargeted, RetargetError> {
    let from = clip.template.as_ref();
    let matched = matched(from, to, pairs)?;
    let theirs = Proportions::of(from, &clip.postures);
    let own = Proportions::of(to, &[to.typical()]);
    if theirs.torso(from) <= 0.0 {
        return Err(RetargetError::Flat);
    }
    let size = size(&matched, &theirs, &own, (from, to));
    let bones = bones(&matched, from, to, &theirs);
    let postures = clip.postures.iter().map(|posture| made(posture, to, &bones, size)).collect();
    let moved = |chain: &&Chain| matched.iter().any(|(_, own)| own.name == chain.name);
    let still = to.chains().iter().filter(|chain| !moved(chain)).map(|chain| chain.name.clone()).collect();
    let clip = Clip::of(to.clone(), clip.character.as_str(), clip.motion.as_str(), postures);
    let moved = (0..to.len()).map(|k| k == 0 || bones.iter().any(|bone| bone.end == k)).collect();
    Ok(Retargeted { clip, still, moved })
}

/// The chains that belong together: of the clip's template, of the wanted one.
type Matched<'a> = Vec<(&'a Chain, &'a Chain)>;

fn matched<'a>(from: &'a Template, to: &'a Template, pairs: &[(String, String)]) -> Result<Matched<'a>, RetargetError> {
    let names = |of: &Template| of.chains().iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
    let chain = |of: &'a Template, name: &str| {
        of.chains().iter().find(|chain| chain.name == name).ok_or_else(|| RetargetError::Chain {
            found: name.to_owned(),
            template: of.name().to_owned(),
            known: names(of),
        })
    };
    let mut found: Matched = Vec::new();
    for (theirs, own) in pairs {
        let pair = (chain(from, theirs)?, chain(to, own)?);
        if found.iter().any(|(_, known)| known.name == *own) {
            return Err(RetargetError::Twice { found: own.clone() });
        }
        found.push(pair);
    }
    for own in to.chains() {
        let torsos = |chain: &&Chain| chain.role == Role::Torso && own.role == Role::Torso;
        let same = |chain: &&Chain| chain.name == own.name || torsos(chain);
        if let Some(theirs) = from.chains().iter().find(same).filter(|_| found.iter().all(|(_, k)| k.name != own.name))
        {
            found.push((theirs, own));
        }
    }
    if found.iter().all(|(_, own)| own.role == Role::Torso) {
        let [theirs, own] = [from, to].map(names);
        return Err(RetargetError::Nothing { from: from.name().into(), theirs, to: to.name().into(), own });
    }
    Ok(found)
}

/// Units of the clip for a unit of the wanted template.
fn size(matched: &Matched, theirs: &Proportions, own: &Proportions, (from, to): (&Template, &Template)) -> f64 {
    let legs = matched.iter().filter(|(_, own)| own.role == Role::Leg);
    let (a, b) = legs.fold((0.0, 0.0), |(a, b), (t, o)| (a + theirs.along(&t.points), b + own.along(&o.points)));
    if a > 0.0 && b > 0.0 { a / b } else { theirs.torso(from) / own.torso(to) }
}

/// Where the turn of a bone comes from: the chord of a chain between two shares of its length.
struct Bone {
    /// Index of the key point that ends it.
    end: usize,
    chain: Vec<usize>,
    /// For each joint of the chain its share of the length.
    shares: Vec<f64>,
    /// The shares between which the bone lies.
    range: (f64, f64),
    /// The chord in the typical posture of the clip's template.
    typical: Point,
}

fn shares(lengths: &dyn Fn(&[usize]) -> f64, chain: &[usize]) -> Vec<f64> {
    let whole = lengths(chain);
    (0..chain.len())
        .map(|k| if whole > 0.0 { lengths(&chain[..=k]) / whole } else { k as f64 / (chain.len() - 1) as f64 })
        .collect()
}

/// The place on a chain at a share of its length.
fn on(posture: &[Point], chain: &[usize], shares: &[f64], share: f64) -> Point {
    let after = shares.partition_point(|s| *s < share).clamp(1, chain.len() - 1);
    let (a, b) = (shares[after - 1], shares[after]);
    let part = if b > a { ((share - a) / (b - a)).clamp(0.0, 1.0) } else { 1.0 };
    posture[chain[after - 1]].lerp(posture[chain[after]], part)
}

fn bones(matched: &Matched, from: &Template, to: &Template, theirs: &Proportions) -> Vec<Bone> {
    let (typical, own) = (from.typical(), to.typical());
    let mut made: Vec<Bone> = Vec::new();
    for (source, target) in matched {
        let of_typical = shares(&|points| length(&typical, points), &source.points);
        let of_clip = shares(&|points| theirs.along(points), &source.points);
        let of_own = shares(&|points| length(&own, points), &target.points);
        for k in 1..target.points.len() {
            let (end, range) = (target.points[k], (of_own[k - 1], of_own[k]));
            if made.iter().any(|bone| bone.end == end) {
                continue; // of two chains with this bone the first counts
            }
            let at = |share: f64| on(&typical, &source.points, &of_typical, share);
            let chord = at(range.1) - at(range.0);
            made.push(Bone { end, chain: source.points.clone(), shares: of_clip.clone(), range, typical: chord });
        }
    }
    made
}

/// The wanted template's posture for one of the clip.
fn made(posture: &[Point], to: &Template, bones: &[Bone], size: f64) -> Vec<Point> {
    let typical = to.typical();
    let mut turns: Vec<Option<f64>> = vec![None; to.len()];
    for bone in bones {
        let at = |share: f64| on(posture, &bone.chain, &bone.shares, share);
        let chord = at(bone.range.1) - at(bone.range.0);
        let known = chord.length_squared() > 0.0 && bone.typical.length_squared() > 0.0;
        turns[bone.end] = Some(if known { bone.typical.perp_dot(chord).atan2(bone.typical.dot(chord)) } else { 0.0 });
    }
    let mut made = vec![posture[0]; to.len()];
    for k in 1..to.len() {
        let parent = to.parent(k);
        // What hangs on the torso turns with the body there, anything else with its parent.
        let body = if to.torso().contains(&parent) { to.body_at(parent).1 } else { parent };
        let turn = turns[k].or(turns[body]).unwrap_or(0.0);
        turns[k] = Some(turn);
        made[k] = made[parent] + Point::from_angle(turn).rotate(typical[k] - typical[parent]) * size;
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(of: &[(&str, &str)]) -> Vec<(String, String)> {
        of.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
    }

    /// A posture of a template with a chain turned about its first joint.
    fn turned(template: &Template, chain: &str, turn: f64) -> Vec<Point> {
        let mut p = template.typical();
        let chain = &template.chains().iter().find(|c| c.name == chain).unwrap().points;
        let about = p[chain[0]];
        for k in 0..p.len() {
            if chain[1..].iter().any(|joint| template.hangs_on(k, *joint)) {
                p[k] = about + Point::from_angle(turn).rotate(p[k] - about);
            }
        }
        p
    }

    fn direction(template: &Template, posture: &[Point], chain: &str) -> f64 {
        let chain = &template.chains().iter().find(|c| c.name == chain).unwrap().points;
        (posture[chain[chain.len() - 1]] - posture[chain[0]]).to_angle()
    }

    #[test]
    fn a_template_for_itself_changes_only_the_size() {
        for template in [Template::human(), Template::quadruped(), Template::bird()] {
            let postures = [0.0, 0.3].map(|t| turned(&template, "l_leg", t).iter().map(|p| *p * 7.0).collect());
            let clip = Clip::of(template.clone(), "a", "walk", postures.to_vec());
            let made = retarget(&clip, &template, &[]).unwrap();
            assert_eq!(made.still, Vec::<String>::new());
            for (a, b) in made.clip.postures.iter().flatten().zip(clip.postures.iter().flatten()) {
                assert!(a.distance(*b) < 1e-9, "{}: {a} {b}", template.name());
            }
        }
    }

    #[test]
    fn a_human_walk_moves_the_legs_of_an_animal_as_far() {
        let (human, cat) = (Template::human(), Template::quadruped());
        let postures = vec![human.typical(), turned(&human, "l_leg", 0.35), turned(&human, "r_arm", -0.5)];
        let clip = Clip::of(human, "a", "walk", postures);
        let chains = pairs(&[("l_arm", "l_foreleg"), ("r_arm", "r_foreleg")]);
        let made = retarget(&clip, &cat, &chains).unwrap();
        assert_eq!(made.still, ["neck", "tail"]);
        for (k, moved) in made.moved.iter().enumerate() {
            let name = cat.point_name(k);
            let rests = ["neck", "head", "tail", "shoulder", "hip"].iter().any(|word| name.contains(word));
            assert_eq!(*moved, !rests, "{name}");
        }
        let of = |frame: usize, chain: &str| direction(&cat, &made.clip.postures[frame], chain);
        assert!((of(1, "l_leg") - of(0, "l_leg") - 0.35).abs() < 1e-9);
        assert!((of(2, "r_foreleg") - of(0, "r_foreleg") + 0.5).abs() < 1e-9);
        assert!((of(1, "r_leg") - of(0, "r_leg")).abs() < 1e-9);
        let own = cat.typical();
        let size = made.clip.postures[0][cat.index("withers").unwrap()].x / own[cat.index("withers").unwrap()].x;
        assert!(
            made.clip.postures[0].iter().zip(&own).all(|(a, b)| a.distance(*b * size) < 1e-9),
            "it stands as a cat"
        );
    }

    #[test]
    fn what_hangs_on_the_body_turns_with_it() {
        let cat = Template::quadruped();
        let lean = Point::from_angle(0.3);
        let posture = cat.typical().iter().map(|p| lean.rotate(*p)).collect();
        let clip = Clip::of(cat, "a", "rear", vec![posture]);
        let bird = Template::bird();
        let made = retarget(&clip, &bird, &[]).unwrap();
        assert_eq!(made.still, ["l_wing", "r_wing"]);
        for wing in ["l_wing", "r_wing"] {
            let turn = direction(&bird, &made.clip.postures[0], wing) - direction(&bird, &bird.typical(), wing);
            assert!((turn - 0.3).abs() < 1e-9, "{turn}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        let clip = Clip::of(Template::human(), "a", "walk", vec![Template::human().typical()]);
        let said = |to: &Arc<Template>, of: &[(&str, &str)]| retarget(&clip, to, &pairs(of)).unwrap_err().to_string();
        assert!(
            said(&Template::bird(), &[("l_arm", "wing")]).starts_with("chains: found \"wing\", expected a chain of")
        );
        let twice = said(&Template::bird(), &[("l_arm", "l_wing"), ("r_arm", "l_wing")]);
        assert_eq!(twice, "chains: found \"l_wing\" twice, expected one chain of the clip for each chain");
        let point =
            |name: &str, parent: Option<&str>, y: f64| (name.into(), parent.map(Into::into), Point::new(0.0, y));
        let worm = [point("a", None, 0.0), point("b", Some("a"), 1.0), point("c", Some("b"), 2.0)];
        let spine = [("spine".to_owned(), ["a", "b", "c"].map(str::to_owned).to_vec(), Role::Torso)];
        let worm = Arc::new(Template::new("worm", &worm, &[], &spine).unwrap());
        assert!(
            said(&worm, &[]).starts_with("chains: found no chain of \"human\" (torso, head,"),
            "{}",
            said(&worm, &[])
        );
        let flat = Clip::of(Template::human(), "a", "walk", vec![vec![Point::ZERO; 17]]);
        assert_eq!(retarget(&flat, &Template::bird(), &[]).unwrap_err(), RetargetError::Flat);
    }
}
