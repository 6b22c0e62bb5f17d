//! Limbs on the contours of a document, frames with swapped sides, and marks "in front" and "behind".
//!
//! Besides its scene a document may contain:
//!
//! ```json
//! "limbs": [{"from": "r_shoulder", "to": "r_elbow",
//!   "start": {"points": [{"part": "near arm", "at": 0}, {"part": "near arm", "at": 10}], "share": 0.5},
//!   "end": {"points": [{"part": "near arm", "drawn": {"0": [x, y], "23": [x, y]}}, {"part": "near arm", "at": 7.5}]},
//!   "carries": ["near arm", {"part": "near mitten", "turn": 0.5}], "bends": {"0": [x, y]}, "rigidity": 1}, "…"],
//! "limb_swaps": [[14, 23]],
//! "depth_marks": [{"front": "near arm", "behind": "coat", "first": 0, "last": 9}, "…"],
//! "follows": [{"part": "shadow", "what": "contact"}, {"part": "badge", "of": "coat"}, "…"]
//! ```
//!
//! - `from` and `to`: key points by name, those of the body's [`skeleton`], a human without that field. Each end is between two calibration
//!   points on contours, `share` of the way from the first to the second (default ½).
//! - `at`: a parameter of the contour; 7.5 is halfway from point 7 to point 8. `drawn`: points near the contour by
//!   frame. Each is bound to the nearest point of the contour on its frame, and slides along the contour between these
//!   frames.
//! - `carries`: the parts that follow the limb when the drawing is reshaped. The default are the parts of its
//!   calibration points. `turn` is the share of the limb's rotation, 0 to 1, that a rigid part on the limb's end takes.
//! - `bends`: control points of the limb's Bézier spline by frame, in pixels. `rigidity`: its stiffness relative to
//!   other limbs.
//! - `limb_swaps`: from a first to a last frame, both included, the contours show the other side: left and right change
//!   places.
//! - `depth_marks`: one part is in front of another. Without `first` or `last` the range of frames is open at that end.
//! - `follows`: what parts follow that no limb carries: another part (`of`), or `what` is `root` (the way of the pelvis),
//!   `contact` (the ground below the figure) or `nothing`.

use super::Document;
use super::drawings::lines;
use super::fields::{FieldError, array, described, frame, given, number, object, point, wrong};
use super::skeleton;
use rototoon_base::geometry::Point;
use rototoon_base::scene::limbs::{Binding, Calibration, Carried, DepthMark, Follow, Limb, LimbEnd, LimbSet};
use rototoon_base::scene::{FrameNumber, Template};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest rigidity. Beyond it the softest triangles would lose their digits beside the stiffest.
const MOST_RIGID: f64 = 1e4;

impl Document {
    /// The limbs, swaps and marks of the document; empty if it has none.
    ///
    /// # Errors
    ///
    /// The first invalid field.
    pub fn limbs(&self) -> Result<LimbSet, FieldError> {
        let template = self.skeleton()?;
        let limbs = self.other_list("limbs")?;
        let limbs = limbs.iter().enumerate().map(|(k, value)| limb(&template, value, &format!("limbs[{k}]")));
        let swaps = self.other_list("limb_swaps")?;
        let swaps = swaps.iter().enumerate().map(|(k, value)| swap(value, &format!("limb_swaps[{k}]")));
        let marks = self.other_list("depth_marks")?;
        let marks = marks.iter().enumerate().map(|(k, value)| self.mark(value, &format!("depth_marks[{k}]")));
        let follows = self.other_list("follows")?;
        let follows = follows.iter().enumerate().map(|(k, value)| self.follow(value, &format!("follows[{k}]")));
        Ok(LimbSet {
            limbs: limbs.collect::<Result<_, _>>()?,
            swaps: swaps.collect::<Result<_, _>>()?,
            marks: marks.collect::<Result<_, _>>()?,
            follows: follows.collect::<Result<_, _>>()?,
            template,
        })
    }

    /// The body of the limbs.
    ///
    /// # Errors
    ///
    /// What is wrong with the field [`skeleton`].
    pub fn skeleton(&self) -> Result<Arc<Template>, FieldError> {
        let value = self.other_field(skeleton::FIELD).map(serde_json::from_str::<Value>).transpose();
        skeleton::read(value.map_err(|e| wrong(skeleton::FIELD, &e.to_string(), "JSON"))?.as_ref())
    }

    /// Puts limbs, swaps and marks into the document, in place of earlier ones.
    pub fn set_limbs(&mut self, set: &LimbSet) {
        if let Some(skeleton) = skeleton::written(&set.template) {
            self.set_other_field(skeleton::FIELD, skeleton.to_string());
        } else {
            self.remove_other_field(skeleton::FIELD);
        }
        self.set_other_field("limbs", lines(set.limbs.iter().map(|limb| written(&set.template, limb))));
        self.set_other_field("limb_swaps", lines(set.swaps.iter().map(|(first, last)| json!([first, last]))));
        let mark = |m: &DepthMark| {
            let mut fields = Map::from_iter([("front".into(), json!(m.front)), ("behind".into(), json!(m.behind))]);
            let ends = [("first", m.first, FrameNumber::MIN), ("last", m.last, FrameNumber::MAX)];
            let given = ends.into_iter().filter(|(_, frame, open)| frame != open);
            fields.extend(given.map(|(name, frame, _)| (name.to_owned(), json!(frame))));
            Value::Object(fields)
        };
        self.set_other_field("depth_marks", lines(set.marks.iter().map(mark)));
        let follow = |(part, follow): &(String, Follow)| match follow {
            Follow::Part(of) => json!({"part": part, "of": of}),
            Follow::Root => json!({"part": part, "what": "root"}),
            Follow::Contact => json!({"part": part, "what": "contact"}),
            Follow::Nothing => json!({"part": part, "what": "nothing"}),
        };
        self.set_other_field("follows", lines(set.follows.iter().map(follow)));
    }

    /// The name of a part in a field.
    fn part_in(&self, fields: &Map<String, Value>, place: &str, name: &str) -> Result<String, FieldError> {
        let found = fields.get(name);
        let known = found.and_then(Value::as_str).filter(|n| self.scene.parts.iter().any(|part| part.name == *n));
        known
            .map(str::to_owned)
            .ok_or_else(|| wrong(&format!("{place}.{name}"), &described(found), "the name of a part"))
    }

    fn follow(&self, value: &Value, place: &str) -> Result<(String, Follow), FieldError> {
        let fields = object(value, place)?;
        let part = self.part_in(fields, place, "part")?;
        let follow = match (fields.get("what").map(|v| v.as_str()), fields.contains_key("of")) {
            (None, true) => Follow::Part(self.part_in(fields, place, "of")?),
            (Some(Some("root")), false) => Follow::Root,
            (Some(Some("contact")), false) => Follow::Contact,
            (Some(Some("nothing")), false) => Follow::Nothing,
            (Some(_), true) => {
                let found = format!("{} beside \"of\"", described(fields.get("what")));
                return Err(wrong(&format!("{place}.what"), &found, "one of the two fields"));
            }
            _ => {
                let expected =
                    "one of root, contact, nothing, or in place of this field \"of\" with the name of a part";
                return Err(wrong(&format!("{place}.what"), &described(fields.get("what")), expected));
            }
        };
        Ok((part, follow))
    }

    fn mark(&self, value: &Value, place: &str) -> Result<DepthMark, FieldError> {
        let fields = object(value, place)?;
        let part = |name: &str| self.part_in(fields, place, name);
        let mark = DepthMark {
            front: part("front")?,
            behind: part("behind")?,
            first: given(fields, place, "first", frame)?.unwrap_or(FrameNumber::MIN),
            last: given(fields, place, "last", frame)?.unwrap_or(FrameNumber::MAX),
        };
        if mark.front == mark.behind {
            return Err(wrong(&format!("{place}.behind"), &format!("{:?}", mark.behind), "another part than `front`"));
        }
        if mark.first > mark.last {
            let expected = format!("a frame not before `first`, {}", mark.first);
            return Err(wrong(&format!("{place}.last"), &mark.last.to_string(), &expected));
        }
        Ok(mark)
    }
}

fn limb(template: &Template, value: &Value, place: &str) -> Result<Limb, FieldError> {
    let fields = object(value, place)?;
    let (from, to) = (key_point(template, fields, place, "from")?, key_point(template, fields, place, "to")?);
    if from == to {
        return Err(wrong(
            &format!("{place}.to"),
            &format!("{:?} again", template.point_name(to)),
            "another key point than from",
        ));
    }
    // From here on the place also names the limb's key points.
    let place = format!("{place} ({} to {})", template.point_name(from), template.point_name(to));
    let (start, end) = (end(fields, &place, "start")?, end(fields, &place, "end")?);
    let carries = match fields.get("carries") {
        None => carried_by_default(&start, &end),
        given => {
            let list = array(given, &format!("{place}.carries"))?;
            list.iter()
                .enumerate()
                .map(|(k, v)| carried(v, &format!("{place}.carries[{k}]")))
                .collect::<Result<_, _>>()?
        }
    };
    let rigidity = given(fields, &place, "rigidity", number)?.unwrap_or(1.0);
    if !(1.0 / MOST_RIGID..=MOST_RIGID).contains(&rigidity) {
        return Err(wrong(&format!("{place}.rigidity"), &rigidity.to_string(), "a number from 0.0001 to 10000"));
    }
    let bends = given(fields, &place, "bends", points_by_frame)?.unwrap_or_default();
    Ok(Limb { from, to, start, end, carries, bends, rigidity })
}

fn key_point(template: &Template, fields: &Map<String, Value>, place: &str, name: &str) -> Result<usize, FieldError> {
    let found = fields.get(name);
    let index = found.and_then(Value::as_str).and_then(|text| template.index(text));
    index.ok_or_else(|| {
        let names = template.names().join(", ");
        wrong(&format!("{place}.{name}"), &described(found), &format!("a key point: one of {names}"))
    })
}

fn end(fields: &Map<String, Value>, place: &str, name: &str) -> Result<LimbEnd, FieldError> {
    let place = format!("{place}.{name}");
    let fields = object(fields.get(name).unwrap_or(&Value::Null), &place)?;
    let list = array(fields.get("points"), &format!("{place}.points"))?;
    let [first, second] = list.as_slice() else {
        return Err(wrong(&format!("{place}.points"), &format!("a list of {}", list.len()), "two calibration points"));
    };
    let points =
        [calibration(first, &format!("{place}.points[0]"))?, calibration(second, &format!("{place}.points[1]"))?];
    let share = given(fields, &place, "share", number)?.unwrap_or(0.5);
    if (-1.0..=2.0).contains(&share) {
        Ok(LimbEnd { points, share })
    } else {
        Err(wrong(&format!("{place}.share"), &share.to_string(), "a number from -1 to 2"))
    }
}

fn calibration(value: &Value, place: &str) -> Result<Calibration, FieldError> {
    let fields = object(value, place)?;
    let part = name_of(fields.get("part"), &format!("{place}.part"))?;
    let at = given(fields, place, "at", number)?;
    let drawn = given(fields, place, "drawn", points_by_frame)?;
    let binding = match (at, drawn) {
        (Some(at), None) => Binding::Place(at),
        (None, Some(points)) => Binding::Drawn(points),
        _ => return Err(wrong(place, &described(Some(value)), "either at or drawn")),
    };
    Ok(Calibration { part, binding })
}

fn name_of(value: Option<&Value>, place: &str) -> Result<String, FieldError> {
    let name = value.and_then(Value::as_str).map(str::to_owned);
    name.ok_or_else(|| wrong(place, &described(value), "the name of a part"))
}

fn points_by_frame(value: Option<&Value>, place: &str) -> Result<BTreeMap<FrameNumber, Point>, FieldError> {
    let fields = object(value.unwrap_or(&Value::Null), place)?;
    let entry = |(key, value): (&String, &Value)| {
        let frame = key.parse::<FrameNumber>().ok().filter(|frame| frame.to_string() == *key);
        let frame = frame.ok_or_else(|| wrong(place, &format!("the key {key:?}"), "a frame number such as \"11\""))?;
        Ok((frame, point(Some(value), &format!("{place}.{key:?}"))?))
    };
    fields.iter().map(entry).collect()
}

fn carried(value: &Value, place: &str) -> Result<Carried, FieldError> {
    let Some(fields) = value.as_object() else {
        return Ok(Carried { part: name_of(Some(value), place)?, turn: 1.0 });
    };
    let turn = given(fields, place, "turn", number)?.unwrap_or(1.0);
    if (0.0..=1.0).contains(&turn) {
        Ok(Carried { part: name_of(fields.get("part"), &format!("{place}.part"))?, turn })
    } else {
        Err(wrong(&format!("{place}.turn"), &turn.to_string(), "a number from 0 to 1"))
    }
}

/// The parts of the calibration points of both ends, each once.
pub fn carried_by_default(start: &LimbEnd, end: &LimbEnd) -> Vec<Carried> {
    let mut found: Vec<Carried> = Vec::new();
    for point in start.points.iter().chain(&end.points) {
        if found.iter().all(|known| known.part != point.part) {
            found.push(Carried { part: point.part.clone(), turn: 1.0 });
        }
    }
    found
}

fn swap(value: &Value, place: &str) -> Result<(FrameNumber, FrameNumber), FieldError> {
    let expected = "two frames, the first and the last";
    let list = array(Some(value), place)?;
    let [first, last] = list.as_slice() else { return Err(wrong(place, &described(Some(value)), expected)) };
    let (first, last) = (frame(Some(first), place)?, frame(Some(last), place)?);
    if first <= last { Ok((first, last)) } else { Err(wrong(place, &format!("{first} and {last}"), expected)) }
}

fn written(template: &Template, limb: &Limb) -> Value {
    let by_frame = |points: &BTreeMap<FrameNumber, Point>| -> Value {
        points.iter().map(|(frame, p)| (frame.to_string(), json!([p.x, p.y]))).collect::<Map<_, _>>().into()
    };
    let calibration = |point: &Calibration| match &point.binding {
        Binding::Place(at) => json!({"part": point.part, "at": at}),
        Binding::Drawn(points) => json!({"part": point.part, "drawn": by_frame(points)}),
    };
    let end = |end: &LimbEnd| json!({"points": end.points.each_ref().map(calibration), "share": end.share});
    let carries = |c: &Carried| if c.turn == 1.0 { json!(c.part) } else { json!({"part": c.part, "turn": c.turn}) };
    let mut fields = Map::new();
    fields.insert("from".into(), template.point_name(limb.from).into());
    fields.insert("to".into(), template.point_name(limb.to).into());
    fields.insert("start".into(), end(&limb.start));
    fields.insert("end".into(), end(&limb.end));
    fields.insert("carries".into(), limb.carries.iter().map(carries).collect());
    if !limb.bends.is_empty() {
        fields.insert("bends".into(), by_frame(&limb.bends));
    }
    if limb.rigidity != 1.0 {
        fields.insert("rigidity".into(), json!(limb.rigidity));
    }
    Value::Object(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(fields: &str) -> Document {
        let text = format!(
            r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 64,
            "height": 48}}, "parts": [{{"name": "arm", "keys": {{}}}}, {{"name": "body", "keys": {{}}}}], {fields}}}"#
        );
        Document::parse(&text, "a.json").unwrap()
    }

    const END: &str = r#"{"points": [{"part": "arm", "at": 1}, {"part": "arm", "drawn": {"0": [1, 2]}}]}"#;

    fn limb_text(more: &str) -> String {
        format!(r#""limbs": [{{"from": "r_elbow", "to": "r_wrist", "start": {END}, "end": {END}{more}}}]"#)
    }

    #[test]
    fn what_is_written_is_read_again() {
        let more = r#", "carries": ["arm", {"part": "hand", "turn": 0.5}], "bends": {"3": [4, 5]}, "rigidity": 2"#;
        let fields = format!(
            r#"{}, "limb_swaps": [[3, 9]], "depth_marks": [{{"front": "arm", "behind": "body", "first": 2}}],
            "follows": [{{"part": "arm", "of": "body"}}, {{"part": "body", "what": "contact"}}]"#,
            limb_text(more)
        );
        let set = document(&fields).limbs().unwrap();
        let follows = [("arm", Follow::Part("body".into())), ("body", Follow::Contact)];
        assert_eq!(set.follows, follows.map(|(part, follow)| (part.to_owned(), follow)));
        assert_eq!((set.limbs[0].from, set.limbs[0].to, set.limbs[0].rigidity), (9, 10, 2.0));
        assert_eq!(set.limbs[0].carries[1], Carried { part: "hand".into(), turn: 0.5 });
        assert_eq!(set.swaps, [(3, 9)]);
        assert_eq!((set.marks[0].first, set.marks[0].last), (2, FrameNumber::MAX));
        let mut other = document(r#""note": 1"#);
        assert_eq!(other.limbs().unwrap(), LimbSet::default());
        other.set_limbs(&set);
        let again = Document::parse(&other.to_json(), "b.json").unwrap();
        assert_eq!(again.limbs().unwrap(), set);
        assert!(other.to_json().contains(r#""note": 1"#));
    }

    #[test]
    fn a_limb_carries_what_it_is_drawn_on() {
        let set = document(&limb_text("")).limbs().unwrap();
        assert_eq!(set.limbs[0].carries, [Carried { part: "arm".into(), turn: 1.0 }]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |fields: &str| document(fields).limbs().unwrap_err().to_string();
        assert!(
            said(r#""limbs": [{"from": "knee"}]"#).starts_with("limbs[0].from: found \"knee\", expected a key point")
        );
        assert!(said(r#""limbs": [{"from": "neck", "to": "neck"}]"#).contains("found \"neck\" again"));
        let one = r#""limbs": [{"from": "neck", "to": "head", "start": {"points": [{"part": "arm"}]}}]"#;
        assert!(
            said(one).starts_with("limbs[0] (neck to head).start.points: found a list of 1, expected two"),
            "{}",
            said(one)
        );
        assert!(said(&limb_text(r#", "rigidity": 0"#)).contains(".rigidity: found 0, expected"));
        assert!(
            said(&limb_text(r#", "bends": {"x": [1, 2]}"#)).contains("found the key \"x\", expected a frame number")
        );
        assert_eq!(
            said(r#""limb_swaps": [[5, 2]]"#),
            "limb_swaps[0]: found 5 and 2, expected two frames, the first and the last"
        );
        assert_eq!(
            said(r#""depth_marks": [{"front": "arm", "behind": "arm"}]"#),
            "depth_marks[0].behind: found \"arm\", expected another part than `front`"
        );
        assert_eq!(
            said(r#""depth_marks": [{"front": "arm", "behind": "body", "first": 9, "last": 0}]"#),
            "depth_marks[0].last: found 0, expected a frame not before `first`, 9"
        );
        assert_eq!(
            said(r#""follows": [{"part": "arm", "of": "body", "what": "root"}]"#),
            "follows[0].what: found \"root\" beside \"of\", expected one of the two fields"
        );
        assert_eq!(
            said(r#""depth_marks": [{"front": "arm", "behind": "leg"}]"#),
            "depth_marks[0].behind: found \"leg\", expected the name of a part"
        );
        assert!(said(r#""follows": [{"part": "arm", "what": "shin"}]"#).starts_with("follows[0].what: found \"shin\""));
        assert!(said(r#""follows": [{"part": "arm", "of": "leg"}]"#).starts_with("follows[0].of: found \"leg\""));
    }
}
