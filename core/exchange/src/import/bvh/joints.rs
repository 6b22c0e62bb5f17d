//! Which joints of a BVH file are the template's key points.
//!
//! Names are compared without case, blanks and punctuation, without what stands before a colon (`mixamorig:Hips`) and without a
//! few customary prefixes (`joint_`, `Bip01`, `DEF-`); the side is a word or letter at either end (`LeftArm`, `l_arm`, `arm.L`,
//! `Arm_L`, `lShldr`). What is left is looked up in a list for each key point, first come first served: programs agree about words
//! but not about where they put them. A *shoulder* is the joint of the upper arm in one file and the collar bone in another; it
//! counts only where nothing is called *arm* or *upper arm*. A *foot* is the ankle in one file and the ball of the foot in another,
//! a *hand* the wrist or the knuckles; they count only where nothing is called *ankle* or *wrist*. The lists serve the names of
//! Biovision and CMU files, Mixamo, MotionBuilder, LAFAN, 3ds Max Biped, Poser and Daz, Unreal, Unity, Valve, SMPL, MakeHuman,
//! VRoid, Character Creator, Motive, Kinect, Blender's Rigify, and the Bandai Namco research data. If names do not tell all key
//! points, they are read once more without the words with which most of them begin (`Robot_Hips`).
//!
//! The pelvis is the joint on which both thighs hang, whatever it is called, or a joint before it that lies at the same place. Where
//! thighs hang on a joint far from them, such as a root on the floor, a name tells the pelvis.
//! Spines have any number of joints, so the chest is found by place: the joint between pelvis and neck that is nearest to the
//! template's share of the way, or that share itself where none is near. The top of the head is the end of the head's chain; a head
//! without a joint lies on the way from the neck to that end. Some programs write such an end at the place of its joint, and some
//! none. Then the end is made anew: it goes on from the neck over the head, and turns with the head.
//!
//! [`JointMap`] says what names do not tell.

use super::parse::{Bvh, Channel, Node};
use glam::DVec3;
use rototoon_base::scene::proportions::HUMAN;
use rototoon_base::scene::skeleton::{COUNT, NAMES};
use serde_json::Value;
use std::collections::BTreeMap;

/// What joints are called that limbs hang on: key point without its side, names of such joints.
const LIMBS: [(&str, &[&str]); 6] = [
    (
        "shoulder",
        &["arm", "upperarm", "upperarm01", "uparm", "uarm", "shldr", "shldrbend", "shoulderjoint", "shoulder"],
    ),
    ("elbow", &["forearm", "lowerarm", "lowerarm01", "lowarm", "farm", "forearmbend", "elbow", "elbowjoint"]),
    ("wrist", &["wrist", "wristjoint", "hand"]),
    ("hip", &["upleg", "upperleg", "upperleg01", "thigh", "thighbend", "hip", "hipjoint", "buttock"]),
    ("knee", &["leg", "lowerleg", "lowerleg01", "lowleg", "shin", "calf", "knee", "kneejoint"]),
    ("ankle", &["ankle", "anklejoint", "foot"]),
];
/// What joints of the middle are called.
const MIDDLE: [(&str, &[&str]); 4] = [
    ("pelvis", &["hips", "hip", "pelvis", "root", "spinebase", "spine"]),
    ("neck", &["neck", "neck1", "neck01", "necktwist01", "necklower", "lowerneck", "spine004"]),
    ("head", &["head", "head1", "skull", "spine006"]),
    ("head_top", &["headtop", "headtopend", "headend", "headnub", "topofhead"]),
];
/// What stands before names and says nothing.
const PREFIXES: [&str; 9] = ["mixamorig", "joint", "bip001", "bip01", "bip1", "def", "org", "jbip", "character1"];
/// What says that a joint is on neither side.
const CENTRE: [&str; 3] = ["c", "center", "centre"];
/// Share of the joints that begin with a word that says nothing: the name of the character, or of the program.
const COMMON: f64 = 0.75;
/// The greatest number of such words.
const MOST_COMMON: usize = 4;
/// Share of the torso within which a spine's joint is the chest.
const CHEST_REACH: f64 = 0.2;
/// Where the head begins between the neck and its top: the template's share.
const HEAD_SHARE: f64 = HUMAN[2] / (HUMAN[2] + HUMAN[3]);
/// How far the top of the head lies beyond a head without an end, in lengths of the neck.
const HEAD_TOP: f64 = HUMAN[3] / HUMAN[2];

/// Greatest distance of a pelvis from the middle of the hips, in torsos. Thighs may hang on a root on the floor.
const BEARER_REACH: f64 = 0.5;
/// Share of the torso within which a named pelvis above the thighs' joint is the pelvis.
const PELVIS_REACH: f64 = 0.2;
/// Share of the torso within which two joints lie at the same place.
const SAME_PLACE: f64 = 0.02;

/// A key point's place among a file's nodes: their weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Place(pub Vec<(usize, f64)>);

impl Place {
    /// The place, for places of the nodes.
    pub fn at(&self, nodes: &[DVec3]) -> DVec3 {
        self.0.iter().map(|&(node, weight)| nodes[node] * weight).sum()
    }

    fn node(node: usize) -> Self {
        Self(vec![(node, 1.0)])
    }

    fn between(from: &Self, to: &Self, share: f64) -> Self {
        let part =
            |place: &Self, by: f64| place.0.iter().map(|(node, weight)| (*node, weight * by)).collect::<Vec<_>>();
        Self([part(from, 1.0 - share), part(to, share)].concat())
    }
}

/// Joints given for key points: of several joints, their mean.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JointMap(pub BTreeMap<usize, Vec<String>>);

/// Why key points have no joints.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MapError {
    /// The map is not as it must be.
    #[error("{place}: found {found}, expected {expected}")]
    Map {
        /// Where in the map.
        place: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A joint of the map is not in the file.
    #[error("joints, {point}: found no joint {joint:?} in the file, expected one of {known}")]
    Unknown {
        /// The key point.
        point: &'static str,
        /// The joint.
        joint: String,
        /// The file's joints.
        known: String,
    },
    /// Names do not determine the joints of some key points.
    #[error(
        "found no joint for {missing}, expected one for each key point; give them in a map of joints; the file has {known}"
    )]
    Missing {
        /// The key points.
        missing: String,
        /// The file's joints.
        known: String,
    },
}

impl JointMap {
    /// Reads a map, `{"l_wrist": "Hand.L", "chest": ["Spine1", "Spine2"]}`; the end of a joint's chain is `"Head/end"`.
    pub fn parse(text: &str) -> Result<Self, MapError> {
        let wrong = |place: &str, found: String, expected: &str| MapError::Map {
            place: place.to_owned(),
            found,
            expected: expected.to_owned(),
        };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document: Value =
            serde_json::from_str(text).map_err(|e| wrong("joints", format!("no JSON ({e})"), "JSON"))?;
        let expected = "an object with a joint, or a list of joints, for each key point";
        let entries = document.as_object().ok_or_else(|| wrong("joints", shown(&document), expected))?;
        let mut map = BTreeMap::new();
        for (point, value) in entries {
            let place = format!("joints, {point:?}");
            let known = || wrong(&place, "no such key point".into(), &format!("one of {}", NAMES.join(", ")));
            let index = NAMES.iter().position(|name| name == point).ok_or_else(known)?;
            let one = |value: &Value| value.as_str().filter(|name| !name.is_empty()).map(str::to_owned);
            let joints = match value {
                Value::Array(list) if !list.is_empty() => list.iter().map(one).collect::<Option<Vec<_>>>(),
                value => one(value).map(|joint| vec![joint]),
            };
            map.insert(index, joints.ok_or_else(|| wrong(&place, shown(value), "a joint's name, or a list of them"))?);
        }
        Ok(Self(map))
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(_) => "an object".into(),
        other => other.to_string(),
    }
}

/// The places of all key points.
#[derive(Clone, Debug)]
pub struct Places {
    /// By key point.
    pub points: [Place; COUNT],
    /// What a person should know about them, in words.
    pub notes: Vec<String>,
}

/// The places of all key points. A head without an end gets one.
pub fn places(bvh: &mut Bvh, map: &JointMap) -> Result<Places, MapError> {
    let found = Joints::new(&bvh.nodes, 0).places(map)?;
    let complete = |found: &Found| found.points.iter().all(Option::is_some);
    let found = match common_words(&bvh.nodes) {
        words if words > 0 && !complete(&found) => {
            let shorter = Joints::new(&bvh.nodes, words).places(map)?;
            if complete(&shorter) { shorter } else { found }
        }
        _ => found,
    };
    let missing: Vec<&str> = (0..COUNT).filter(|&k| found.points[k].is_none()).map(|k| NAMES[k]).collect();
    if missing.is_empty() {
        bvh.nodes.extend(found.end);
        // None is missing, so the default is never used.
        Ok(Places { points: found.points.map(|place| place.unwrap_or(Place(Vec::new()))), notes: found.notes })
    } else {
        Err(MapError::Missing { missing: missing.join(", "), known: Joints::new(&bvh.nodes, 0).known() })
    }
}

/// The places that are known.
struct Found {
    points: [Option<Place>; COUNT],
    /// The end that the head's chain lacks: the node after all others.
    end: Option<Node>,
    notes: Vec<String>,
}

/// The number of words with which most joints begin, at most [`MOST_COMMON`].
fn common_words(nodes: &[Node]) -> usize {
    let names: Vec<Vec<String>> = nodes.iter().filter(|node| !node.end).map(|node| words(plain(&node.name))).collect();
    let mut beginnings: BTreeMap<&[String], usize> = BTreeMap::new();
    for name in &names {
        for count in 1..name.len().min(MOST_COMMON + 1) {
            *beginnings.entry(&name[..count]).or_default() += 1;
        }
    }
    let enough = COMMON * names.len() as f64;
    beginnings
        .into_iter()
        .filter(|(_, joints)| *joints as f64 >= enough)
        .map(|(words, _)| words.len())
        .max()
        .unwrap_or(0)
}

fn index(point: &str) -> usize {
    NAMES.iter().position(|name| *name == point).unwrap_or_default()
}

/// The nodes of a file with what their names say.
struct Joints<'a> {
    nodes: &'a [Node],
    /// Side and name, simplified.
    words: Vec<(Option<char>, String)>,
    /// Places at rest.
    rest: Vec<DVec3>,
}

impl<'a> Joints<'a> {
    /// `skip` is the number of words that are left out at the front of names.
    fn new(nodes: &'a [Node], skip: usize) -> Self {
        let mut rest: Vec<DVec3> = Vec::with_capacity(nodes.len());
        for node in nodes {
            rest.push(node.offset + node.parent.map_or(DVec3::ZERO, |parent| rest[parent]));
        }
        Self { nodes, words: nodes.iter().map(|node| simplified(&node.name, skip)).collect(), rest }
    }

    /// The places of the key points that are known.
    fn places(&self, map: &JointMap) -> Result<Found, MapError> {
        let mut found: [Option<Place>; COUNT] = std::array::from_fn(|_| None);
        for (&point, names) in map.0.iter().filter(|(point, _)| **point < COUNT) {
            found[point] = Some(self.given(NAMES[point], names)?);
        }
        for (point, place) in found.iter_mut().enumerate().filter(|(_, place)| place.is_none()) {
            *place = self.named(NAMES[point]).map(Place::node);
        }
        let notes = if map.0.contains_key(&0) { None } else { self.check_pelvis(&mut found) };
        let end = self.fill_head(&mut found, !map.0.contains_key(&index("head_top")));
        let chest = index("chest");
        if found[chest].is_none() {
            found[chest] = found[0].as_ref().zip(found[index("neck")].as_ref()).map(|(p, n)| self.chest(p, n));
        }
        Ok(Found { points: found, end, notes: notes.into_iter().collect() })
    }

    /// Lets the pelvis be the joint on which both thighs hang, unless the named one is at its place. Returns what is to be said.
    fn check_pelvis(&self, found: &mut [Option<Place>; COUNT]) -> Option<String> {
        let neck = found[index("neck")].as_ref()?.at(&self.rest);
        let hips = [found[index("l_hip")].as_ref()?, found[index("r_hip")].as_ref()?];
        let bearer = self.bearer(hips.iter().flat_map(|hip| hip.0.iter().map(|(node, _)| *node)))?;
        let names = MIDDLE.iter().find(|(point, _)| *point == NAMES[0]).map(|(_, names)| *names)?;
        let mut named = names.iter().filter_map(|name| self.called(None, name));
        let middle = (hips[0].at(&self.rest) + hips[1].at(&self.rest)) * 0.5;
        let is_at_hips = |node: usize| self.rest[node].distance(middle) <= BEARER_REACH * middle.distance(neck);
        if !is_at_hips(bearer) {
            found[0] = Some(Place::node(named.find(|&node| is_at_hips(node))?));
            return None;
        }
        let torso = self.rest[bearer].distance(neck);
        let near = |node: usize| {
            let before = self.up(bearer).any(|k| k == node);
            // What lies between them may move by itself.
            let fixed = self.up(bearer).take_while(|k| *k != node).all(|k| self.is_fixed(k));
            let reach = if before && fixed { PELVIS_REACH } else { SAME_PLACE };
            self.rest[node].distance(self.rest[bearer]) <= reach * torso
        };
        if let Some(node) = named.clone().find(|&node| near(node)) {
            found[0] = Some(Place::node(node));
            return None;
        }
        found[0] = Some(Place::node(bearer));
        let (own, other) = (&self.nodes[bearer].name, named.next());
        let other = other.map(|node| format!(", not {:?}", self.nodes[node].name)).unwrap_or_default();
        Some(format!("the pelvis is {own:?}, on which both thighs hang{other}"))
    }

    /// A node and those on which it hangs, up to the root.
    fn up(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(node), |k| self.nodes[*k].parent)
    }

    /// The joint on which all these nodes hang; none if they have none in common.
    fn bearer(&self, mut nodes: impl Iterator<Item = usize>) -> Option<usize> {
        let parent = |node: usize| self.nodes[node].parent;
        let mut common: Vec<usize> = self.up(parent(nodes.next()?)?).collect();
        for node in nodes {
            let own: Vec<usize> = self.up(parent(node)?).collect();
            common.retain(|k| own.contains(k));
        }
        common.first().copied()
    }

    /// Whether a node stays where it is beside its parent.
    fn is_fixed(&self, node: usize) -> bool {
        !self.nodes[node].channels.iter().any(|channel| matches!(channel, Channel::Position(_)))
    }

    fn known(&self) -> String {
        let names: Vec<&str> = self.nodes.iter().filter(|node| !node.end).map(|node| node.name.as_str()).collect();
        names.join(", ")
    }

    /// Joints of a map.
    fn given(&self, point: &'static str, names: &[String]) -> Result<Place, MapError> {
        let weight = 1.0 / names.len() as f64;
        let one = |name: &String| {
            let is = |node: &Node, end: bool, name: &str| node.end == end && node.name.eq_ignore_ascii_case(name);
            let joint = self.nodes.iter().position(|node| is(node, false, name));
            let end = || {
                let name = name.strip_suffix("/end")?;
                self.nodes.iter().position(|node| is(node, true, name))
            };
            let unknown = || MapError::Unknown { point, joint: name.clone(), known: self.known() };
            joint.or_else(end).map(|node| (node, weight)).ok_or_else(unknown)
        };
        names.iter().map(one).collect::<Result<_, _>>().map(Place)
    }

    /// The joint that a key point's name means.
    fn named(&self, point: &str) -> Option<usize> {
        let (side, plain) = match point.split_once('_') {
            Some((side @ ("l" | "r"), plain)) => (side.chars().next(), plain),
            _ => (None, point),
        };
        let list = if side.is_some() { LIMBS.as_slice() } else { MIDDLE.as_slice() };
        let (_, names) = list.iter().find(|(name, _)| *name == plain)?;
        names.iter().find_map(|name| self.called(side, name))
    }

    /// The first joint of a side and a simplified name.
    fn called(&self, side: Option<char>, name: &str) -> Option<usize> {
        let is = |k: &usize| !self.nodes[*k].end && self.words[*k].0 == side && self.words[*k].1 == name;
        (0..self.nodes.len()).find(is)
    }

    /// The end of the chain that hangs on a node, by the longest way up from it.
    fn end_of(&self, node: usize) -> Option<usize> {
        let hangs = |k: &usize| self.nodes[*k].end && self.nodes[*k].parent == Some(node);
        let away = |k: &usize| self.rest[*k].distance_squared(self.rest[node]);
        (0..self.nodes.len()).filter(hangs).max_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// Head and top of the head where names do not tell them. A top at the place of its joint counts as missing, if it `may_move`.
    /// Returns the end that the file lacks.
    fn fill_head(&self, found: &mut [Option<Place>; COUNT], may_move: bool) -> Option<Node> {
        let [neck, head, top] = ["neck", "head", "head_top"].map(index);
        let only = |place: &Option<Place>| match place.as_ref()?.0.as_slice() {
            [(node, _)] => Some(*node),
            _ => None,
        };
        let neck_place = found[neck].clone()?;
        let chain = only(&found[head]).or_else(|| only(&found[neck]).filter(|_| found[head].is_none()));
        let torso = found[0].as_ref().map_or(0.0, |pelvis| pelvis.at(&self.rest).distance(neck_place.at(&self.rest)));
        let apart = |a: DVec3, b: DVec3| a.distance(b) > SAME_PLACE * torso;
        let is_top = |place: &Place| chain.is_none_or(|node| apart(place.at(&self.rest), self.rest[node]));
        if may_move {
            let named = found[top].take().filter(is_top);
            let end = || chain.and_then(|node| self.end_of(node)).map(Place::node).filter(is_top);
            found[top] = named.or_else(end);
        }
        let mut made = None;
        if let (None, Some(node)) = (&found[top], chain) {
            let (from, to) = (neck_place.at(&self.rest), self.rest[node]);
            let up = found[0].as_ref().map_or(DVec3::ZERO, |pelvis| from - pelvis.at(&self.rest));
            let offset = match &found[head] {
                Some(_) if apart(from, to) => (to - from) * HEAD_TOP,
                Some(_) => up * HUMAN[3],
                None => up * (HUMAN[2] + HUMAN[3]),
            };
            found[top] = Some(Place::node(self.nodes.len()));
            made = Some(Node { name: String::new(), parent: Some(node), offset, channels: Vec::new(), end: true });
        }
        match (&found[head], &found[top]) {
            (None, Some(end)) => found[head] = Some(Place::between(&neck_place, end, HEAD_SHARE)),
            (Some(joint), None) => found[top] = Some(Place::between(&neck_place, joint, 1.0 + HEAD_TOP)),
            _ => {}
        }
        made
    }

    /// The chest: the joint between pelvis and neck nearest to the template's share of the way, or that share of it.
    fn chest(&self, pelvis: &Place, neck: &Place) -> Place {
        let share = HUMAN[0];
        let (from, to) = (pelvis.at(&self.rest), neck.at(&self.rest));
        let wanted = from.lerp(to, share);
        let away = |k: &usize| self.rest[*k].distance(wanted);
        let first = neck.0.first().map(|(node, _)| *node);
        let chain = std::iter::successors(first.and_then(|node| self.nodes[node].parent), |k| self.nodes[*k].parent);
        let nearest = chain.min_by(|a, b| away(a).total_cmp(&away(b)));
        match nearest.filter(|k| away(k) <= CHEST_REACH * from.distance(to)) {
            Some(node) => Place::node(node),
            None => Place::between(pelvis, neck, share),
        }
    }
}

/// A name without what stands before a colon.
fn plain(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Side and name without what differs from program to program, and without its first `skip` words.
fn simplified(name: &str, skip: usize) -> (Option<char>, String) {
    let mut marked = words(plain(name));
    if skip < marked.len() {
        marked.drain(..skip);
    }
    let joined: String = marked.concat();
    let without = PREFIXES.iter().find_map(|prefix| joined.strip_prefix(prefix).filter(|rest| !rest.is_empty()));
    let mut words = marked;
    if let Some(rest) = without {
        let mut drop = joined.len() - rest.len();
        for word in &mut words {
            let cut = drop.min(word.len());
            word.drain(..cut);
            drop -= cut;
        }
        words.retain(|word| !word.is_empty());
    }
    for at in [0, words.len().saturating_sub(1)] {
        if words.len() > 1 && CENTRE.contains(&words[at].as_str()) {
            words.remove(at);
            break;
        }
    }
    let side = |word: &str| match word {
        "l" | "left" => Some('l'),
        "r" | "right" => Some('r'),
        _ => None,
    };
    let found = [words.first(), words.last()].into_iter().flatten().find_map(|word| side(word));
    if found.is_some() && words.len() > 1 {
        let at = if words.first().is_some_and(|word| side(word).is_some()) { 0 } else { words.len() - 1 };
        words.remove(at);
        return (found, words.concat());
    }
    run_together(words.concat())
}

/// A side written at the front of a word, `leftarm` or `lhand`; one letter only before what is called so.
fn run_together(word: String) -> (Option<char>, String) {
    let limb = |rest: &str| LIMBS.iter().any(|(_, names)| names.contains(&rest));
    for (side, long, short) in [('l', "left", "l"), ('r', "right", "r")] {
        let rest = word.strip_prefix(long).or_else(|| word.strip_prefix(short)).filter(|rest| limb(rest));
        if let Some(rest) = rest {
            return (Some(side), rest.to_owned());
        }
    }
    (None, word)
}

/// The words of a name in lower case: `LeftUpLeg`, `left_up_leg` and `lUpLeg` are told apart at capitals, punctuation and digits'
/// ends. Numbers stay with the word before them.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut fresh = true;
    let mut before = ' ';
    for c in name.chars() {
        if !c.is_ascii_alphanumeric() {
            fresh = true;
        } else {
            let capital = c.is_ascii_uppercase() && !before.is_ascii_uppercase();
            let lone =
                c.is_ascii_lowercase() && before.is_ascii_uppercase() && words.last().is_some_and(|w| w.len() > 1);
            if lone {
                // `LHip`: the last capital begins the word.
                let taken = words.last_mut().and_then(String::pop);
                words.push(taken.into_iter().collect());
            } else if fresh || capital || words.is_empty() {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.push(c.to_ascii_lowercase());
            }
            fresh = false;
        }
        before = c;
    }
    words
}

#[cfg(test)]
mod tests;
