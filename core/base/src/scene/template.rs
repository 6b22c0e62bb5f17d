//! Skeleton templates: the key points of a body, how they hang together, and its chains.
//!
//! A template says which key points a posture has. Each hangs on a parent; the first, the *root*, hangs on none. *Mirror
//! pairs* are the same point on the left and on the right side. *Chains* are runs of key points that are named for what
//! they are: a leg, a wing, a tail. Their roles say how they move:
//!
//! | role | how it moves |
//! | --- | --- |
//! | torso | gives the body's direction and its unit of length; every template has one, from the root |
//! | head | keeps its shape |
//! | leg | hangs on the body, and its last point stands on the ground |
//! | limb | hangs on the body: an arm, a wing, a fin |
//! | other | follows what it hangs on: a tail, an ear |
//!
//! Three templates are built in: [`Template::human`], the 17 key points of Liang et al. 2012, section 3, and two of our
//! own, [`Template::quadruped`] and [`Template::bird`]. The joints of these follow the anatomy of the animals: a
//! quadruped walks on its toes, and its hock, which bends backwards, is its heel; so is the "knee" of a bird.
//!
//! `at` is where a key point is in a typical posture, x right, y down, in any unit. The built-in animals look right.

mod built_in;

pub use built_in::BUILT_IN;

use crate::geometry::Point;

/// Most key points of a template.
pub const MOST_POINTS: usize = 256;

/// How a chain moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The body's direction and unit of length.
    Torso,
    /// Keeps its shape.
    Head,
    /// Hangs on the body and stands on the ground.
    Leg,
    /// Hangs on the body.
    Limb,
    /// Follows what it hangs on.
    Other,
}

impl Role {
    /// All roles by their names in documents.
    pub const ALL: [(&'static str, Self); 5] = [
        ("torso", Self::Torso),
        ("head", Self::Head),
        ("leg", Self::Leg),
        ("limb", Self::Limb),
        ("other", Self::Other),
    ];

    /// The role of a name.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(name, _)| *name == id).map(|(_, role)| *role)
    }

    /// Its name.
    pub fn id(self) -> &'static str {
        Self::ALL.iter().find(|(_, role)| *role == self).map_or("other", |(name, _)| name)
    }
}

/// A key point of a template.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyPoint {
    /// Its name.
    pub name: String,
    /// Index of its parent; that of the root is its own.
    pub parent: usize,
    /// Index of the point on the other side; that of a point in the middle is its own.
    pub mirror: usize,
    /// Where it is in a typical posture, in the template's unit.
    pub at: Point,
}

/// A chain of a template.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Its name.
    pub name: String,
    /// Its key points, at least two, each the parent of the next.
    pub points: Vec<usize>,
    /// How it moves.
    pub role: Role,
}

/// A template whose parts fit together.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    name: String,
    points: Vec<KeyPoint>,
    chains: Vec<Chain>,
}

/// A key point as it is given: its name, the name of its parent, its place.
pub type GivenPoint = (String, Option<String>, Point);
/// A chain as it is given: its name, the names of its key points, its role.
pub type GivenChain = (String, Vec<String>, Role);

/// What is wrong with a template: the place, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: found {found}, expected {expected}")]
pub struct TemplateError {
    /// The field, such as `points[3].parent`.
    pub place: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

fn wrong(place: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> TemplateError {
    TemplateError { place: place.into(), found: found.into(), expected: expected.into() }
}

impl Template {
    /// A template from its parts: key points, mirror pairs, chains.
    ///
    /// # Errors
    ///
    /// The first thing that does not fit.
    pub fn new(
        name: &str,
        points: &[GivenPoint],
        mirror: &[(String, String)],
        chains: &[GivenChain],
    ) -> Result<Self, TemplateError> {
        if name.is_empty() {
            return Err(wrong("name", "no name", "one"));
        }
        if !(2..=MOST_POINTS).contains(&points.len()) {
            return Err(wrong("points", points.len().to_string(), format!("2 to {MOST_POINTS} key points")));
        }
        let mut made = Self { name: name.to_owned(), points: key_points(points)?, chains: Vec::new() };
        for (k, pair) in mirror.iter().enumerate() {
            made.add_pair(k, pair)?;
        }
        made.check_sides()?;
        for (k, chain) in chains.iter().enumerate() {
            made.add_chain(k, chain)?;
        }
        made.check_chains()?;
        Ok(made)
    }

    fn add_pair(&mut self, k: usize, pair: &(String, String)) -> Result<(), TemplateError> {
        let place = format!("mirror[{k}]");
        let (a, b) = (self.named(&pair.0, &place)?, self.named(&pair.1, &place)?);
        if a == b || self.points[a].mirror != a || self.points[b].mirror != b {
            let found = format!("{:?} and {:?}", pair.0, pair.1);
            return Err(wrong(place, found, "two key points, each in one pair only"));
        }
        (self.points[a].mirror, self.points[b].mirror) = (b, a);
        Ok(())
    }

    /// The parents of a pair are a pair, or one point.
    fn check_sides(&self) -> Result<(), TemplateError> {
        for point in &self.points {
            let other = &self.points[point.mirror];
            if self.points[point.parent].mirror != other.parent {
                let parents = [point.parent, other.parent].map(|k| &self.points[k].name);
                let found = format!("{:?} on {:?} and {:?} on {:?}", point.name, parents[0], other.name, parents[1]);
                return Err(wrong("mirror", found, "parents that are one point or a pair"));
            }
        }
        Ok(())
    }

    fn add_chain(&mut self, k: usize, (name, points, role): &GivenChain) -> Result<(), TemplateError> {
        let place = format!("chains[{k}]");
        if name.is_empty() || self.chains.iter().any(|chain| chain.name == *name) {
            return Err(wrong(format!("{place}.name"), format!("{name:?}"), "a name that no other chain has"));
        }
        let place = format!("{place} ({name:?}).points");
        let indices = points.iter().map(|point| self.named(point, &place)).collect::<Result<Vec<_>, _>>()?;
        if indices.len() < 2 {
            return Err(wrong(place, format!("{} key points", indices.len()), "at least two"));
        }
        if let Some(pair) = indices.windows(2).find(|pair| self.points[pair[1]].parent != pair[0] || pair[1] == pair[0])
        {
            let found = format!("{:?} after {:?}", self.points[pair[1]].name, self.points[pair[0]].name);
            return Err(wrong(place, found, "key points each of which is the parent of the next"));
        }
        let hangs = matches!(role, Role::Leg | Role::Limb);
        let twice = self.chains.iter().filter(|c| matches!(c.role, Role::Leg | Role::Limb)).flat_map(|c| &c.points);
        if hangs && (indices[0] == 0 || twice.clone().any(|point| indices.contains(point))) {
            let expected = "a leg or limb that does not begin at the root and has its key points for itself";
            return Err(wrong(place, format!("{:?}", points[0]), expected));
        }
        self.chains.push(Chain { name: name.clone(), points: indices, role: *role });
        Ok(())
    }

    fn check_chains(&self) -> Result<(), TemplateError> {
        let torsos: Vec<&Chain> = self.chains.iter().filter(|chain| chain.role == Role::Torso).collect();
        let [torso] = torsos[..] else {
            return Err(wrong("chains", format!("{} with the role torso", torsos.len()), "one"));
        };
        if torso.points[0] != 0 {
            let expected = format!("a torso that begins at {:?}, the first key point", self.points[0].name);
            return Err(wrong("chains", format!("{:?}", self.points[torso.points[0]].name), expected));
        }
        let length = length(&self.typical(), &torso.points);
        if !(length > 0.0 && length.is_finite()) {
            return Err(wrong("points", format!("a torso of length {length} in at"), "a positive length"));
        }
        Ok(())
    }

    fn named(&self, name: &str, place: &str) -> Result<usize, TemplateError> {
        self.index(name).ok_or_else(|| {
            wrong(place, format!("{name:?}"), format!("a key point: one of {}", self.names().join(", ")))
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of key points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Always false; a template has at least two key points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The key points, each after its parent.
    pub fn points(&self) -> &[KeyPoint] {
        &self.points
    }

    /// The chains.
    pub fn chains(&self) -> &[Chain] {
        &self.chains
    }

    /// The names of the key points.
    pub fn names(&self) -> Vec<&str> {
        self.points.iter().map(|point| point.name.as_str()).collect()
    }

    /// The key point of a name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.points.iter().position(|point| point.name == name)
    }

    /// The name of a key point.
    pub fn point_name(&self, point: usize) -> &str {
        &self.points[point].name
    }

    /// The parent of a key point; the root's is itself.
    pub fn parent(&self, point: usize) -> usize {
        self.points[point].parent
    }

    /// The point on the other side.
    pub fn mirror(&self, point: usize) -> usize {
        self.points[point].mirror
    }

    /// The chain of the torso.
    pub fn torso(&self) -> &[usize] {
        self.chains.iter().find(|chain| chain.role == Role::Torso).map_or(&[], |chain| &chain.points)
    }

    /// The key points of the legs.
    pub fn legs(&self) -> Vec<&[usize]> {
        self.chains.iter().filter(|chain| chain.role == Role::Leg).map(|chain| &chain.points[..]).collect()
    }

    /// The key points of legs and limbs.
    pub fn hanging(&self) -> Vec<&[usize]> {
        let hangs = |chain: &&Chain| matches!(chain.role, Role::Leg | Role::Limb);
        self.chains.iter().filter(hangs).map(|chain| &chain.points[..]).collect()
    }

    /// Whether a key point ends a bone of a leg or a limb, beyond the joint on which that hangs.
    pub fn on_limb(&self, point: usize) -> bool {
        self.hanging().iter().any(|chain| chain[1..].contains(&point))
    }

    /// Whether a key point ends a bone of a head.
    pub fn on_head(&self, point: usize) -> bool {
        self.chains.iter().any(|chain| chain.role == Role::Head && chain.points[1..].contains(&point))
    }

    /// Whether `point` is `above` or hangs on it, directly or by others.
    pub fn hangs_on(&self, mut point: usize, above: usize) -> bool {
        while point != above && point != 0 {
            point = self.points[point].parent;
        }
        point == above
    }

    /// The direction of the body at a key point of the torso: the two torso points between which it is taken. It leads to
    /// the next point of the torso, at the end of the torso from the one before.
    pub fn body_at(&self, point: usize) -> (usize, usize) {
        let torso = self.torso();
        let at = torso.iter().position(|k| *k == point).unwrap_or(0).min(torso.len() - 2);
        (torso[at], torso[at + 1])
    }

    /// The typical posture, in the template's unit.
    pub fn typical(&self) -> Vec<Point> {
        self.points.iter().map(|point| point.at).collect()
    }

    /// Length of the torso in a posture.
    pub fn torso_length(&self, posture: &[Point]) -> f64 {
        length(posture, self.torso())
    }

    /// Whether two templates have the same key points, hung together in the same way.
    pub fn same_points(&self, other: &Self) -> bool {
        let points = |of: &Self| of.points.iter().map(|p| (p.name.clone(), p.parent)).collect::<Vec<_>>();
        points(self) == points(other)
    }

    /// Whether it is the human one.
    pub fn is_human(&self) -> bool {
        *self == *Self::human()
    }
}

impl Default for Template {
    /// The human one.
    fn default() -> Self {
        Self::human().as_ref().clone()
    }
}

/// Length of a polyline through key points.
pub fn length(posture: &[Point], points: &[usize]) -> f64 {
    points.windows(2).map(|pair| posture[pair[0]].distance(posture[pair[1]])).sum()
}

fn key_points(given: &[GivenPoint]) -> Result<Vec<KeyPoint>, TemplateError> {
    let mut made: Vec<KeyPoint> = Vec::new();
    for (k, (name, parent, at)) in given.iter().enumerate() {
        if name.is_empty() || made.iter().any(|point| point.name == *name) {
            return Err(wrong(format!("points[{k}].name"), format!("{name:?}"), "a name that no other key point has"));
        }
        let parent = match (k, parent) {
            (0, None) => Some(0),
            (0, Some(_)) | (_, None) => None,
            (_, Some(parent)) => made.iter().position(|point| point.name == *parent),
        };
        let parent = parent.ok_or_else(|| {
            let found = given[k].1.as_ref().map_or("nothing".to_owned(), |parent| format!("{parent:?}"));
            let expected = if k == 0 { "none for the first key point" } else { "the name of an earlier key point" };
            wrong(format!("points[{k}] ({name:?}).parent"), found, expected)
        })?;
        if !at.is_finite() {
            return Err(wrong(format!("points[{k}] ({name:?}).at"), "a place that is not finite", "a finite one"));
        }
        made.push(KeyPoint { name: name.clone(), parent, mirror: k, at: *at });
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(name: &str, parent: Option<&str>, x: f64, y: f64) -> GivenPoint {
        (name.into(), parent.map(Into::into), Point::new(x, y))
    }

    fn chain(name: &str, points: &[&str], role: Role) -> GivenChain {
        (name.into(), points.iter().map(|p| (*p).into()).collect(), role)
    }

    #[test]
    fn the_built_in_templates_are_what_they_are_called() {
        for (name, count, legs) in [("human", 17, 2), ("quadruped", 25, 4), ("bird", 23, 2)] {
            let template = Template::built_in(name).unwrap();
            assert_eq!((template.name(), template.len(), template.legs().len()), (name, count, legs));
            assert!((1..template.len()).all(|k| template.parent(k) < k));
            assert!((template.torso_length(&template.typical()) - 1.0).abs() < 0.1);
        }
        assert!(BUILT_IN.iter().all(|name| Template::built_in(name).is_some()));
        assert!(Template::default().is_human() && !Template::bird().is_human());
        assert_eq!(Template::built_in("fish"), None);
    }

    #[test]
    fn the_human_one_is_made_as_documents_make_theirs() {
        let human = Template::human();
        let points: Vec<GivenPoint> = human
            .points()
            .iter()
            .enumerate()
            .map(|(k, p)| (p.name.clone(), (k > 0).then(|| human.point_name(p.parent).to_owned()), p.at))
            .collect();
        let pairs: Vec<(String, String)> = (0..human.len())
            .filter(|&k| human.mirror(k) > k)
            .map(|k| (human.point_name(k).to_owned(), human.point_name(human.mirror(k)).to_owned()))
            .collect();
        let name = |k: &usize| human.point_name(*k).to_owned();
        let chains: Vec<GivenChain> =
            human.chains().iter().map(|c| (c.name.clone(), c.points.iter().map(name).collect(), c.role)).collect();
        assert_eq!(Template::new("human", &points, &pairs, &chains).unwrap(), *human);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let points = [
            point("root", None, 0.0, 0.0),
            point("top", Some("root"), 0.0, -1.0),
            point("a", Some("top"), -1.0, 0.0),
            point("b", Some("top"), 1.0, 0.0),
            point("c", Some("b"), 1.0, 1.0),
        ];
        let torso = chain("torso", &["root", "top"], Role::Torso);
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        let said = |points: &[GivenPoint], pairs: &[(String, String)], chains: &[GivenChain]| {
            Template::new("x", points, pairs, chains).unwrap_err().to_string()
        };
        assert!(Template::new("x", &points[..4], &[pair("a", "b")], std::slice::from_ref(&torso)).is_ok());
        assert_eq!(said(&points[..1], &[], &[]), "points: found 1, expected 2 to 256 key points");
        let late = [points[0].clone(), point("a", Some("b"), 0.0, 0.0), points[3].clone()];
        assert_eq!(
            said(&late, &[], &[]),
            r#"points[1] ("a").parent: found "b", expected the name of an earlier key point"#
        );
        assert!(said(&points, &[pair("a", "d")], &[]).starts_with(r#"mirror[0]: found "d", expected a key point"#));
        assert!(said(&points, &[pair("a", "c")], &[]).starts_with(r#"mirror: found "a" on "top" and "c" on "b""#));
        assert_eq!(said(&points, &[], &[]), "chains: found 0 with the role torso, expected one");
        let jump = chain("leg", &["root", "c"], Role::Leg);
        assert!(said(&points, &[], &[torso.clone(), jump]).contains(r#"found "c" after "root""#));
        let flat = [points[0].clone(), point("top", Some("root"), 0.0, 0.0)];
        assert!(said(&flat, &[], std::slice::from_ref(&torso)).contains("a torso of length 0"));
        let legs = [torso, chain("leg", &["b", "c"], Role::Leg), chain("arm", &["b", "c"], Role::Limb)];
        assert!(said(&points, &[], &legs).contains("has its key points for itself"));
    }

    #[test]
    fn chains_say_what_a_point_is() {
        let cat = Template::quadruped();
        let at = |name: &str| cat.index(name).unwrap();
        assert!(cat.on_limb(at("l_hock")) && !cat.on_limb(at("l_hip")) && !cat.on_limb(at("tail_tip")));
        assert!(cat.on_head(at("muzzle")) && !cat.on_head(at("head")));
        assert!(cat.hangs_on(at("r_forepaw"), at("withers")) && !cat.hangs_on(at("withers"), at("r_forepaw")));
        assert_eq!(cat.body_at(at("withers")), (at("back"), at("withers")));
        assert_eq!(cat.body_at(at("pelvis")), (at("pelvis"), at("back")));
        let human = Template::human();
        assert_eq!((human.body_at(0), human.body_at(2)), ((0, 1), (1, 2)));
    }
}
