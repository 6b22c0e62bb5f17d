//! The field `skeleton`: which body a document's limbs or a file's clips are of.
//!
//! Without it the body is a human. It is the name of a built-in template, or a definition:
//!
//! ```json
//! "skeleton": "quadruped"
//! "skeleton": {"name": "snail",
//!   "points": [{"name": "foot", "at": [0, 0]}, {"name": "neck", "parent": "foot", "at": [1, 0]},
//!              {"name": "l_eye", "parent": "neck", "at": [1.3, -0.5]}, {"name": "r_eye", "parent": "neck", "at": [1.2, -0.5]}],
//!   "mirror": [["l_eye", "r_eye"]],
//!   "chains": [{"name": "torso", "points": ["foot", "neck"], "role": "torso"}]}
//! ```
//!
//! [`rototoon_base::scene::template`] says what the parts of a template mean and how they must fit.

use super::fields::{FieldError, array, described, object, point, wrong};
use rototoon_base::scene::Template;
use rototoon_base::scene::template::{BUILT_IN, Chain, GivenChain, GivenPoint, KeyPoint, Role, TemplateError};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// Name of the field.
pub const FIELD: &str = "skeleton";

/// The template that a field holds; the human one if there is no field.
///
/// # Errors
///
/// The first part that is wrong.
pub fn read(value: Option<&Value>) -> Result<Arc<Template>, FieldError> {
    match value {
        None => Ok(Template::human()),
        Some(Value::String(name)) => Template::built_in(name).ok_or_else(|| expected(&format!("{name:?}"))),
        Some(value @ Value::Object(_)) => defined(value),
        other => Err(expected(&described(other))),
    }
}

fn expected(found: &str) -> FieldError {
    wrong(FIELD, found, &format!("one of {}, or an object with name, points, mirror and chains", BUILT_IN.join(", ")))
}

fn defined(value: &Value) -> Result<Arc<Template>, FieldError> {
    let fields = object(value, FIELD)?;
    let name = text(fields, FIELD, "name")?;
    let list = array(fields.get("points"), &format!("{FIELD}.points"))?;
    let points = list.iter().enumerate().map(|(k, value)| key_point(value, &format!("{FIELD}.points[{k}]")));
    let points = points.collect::<Result<Vec<_>, _>>()?;
    let pairs = optional(fields, "mirror")?;
    let pairs = pairs.iter().enumerate().map(|(k, value)| pair(value, &format!("{FIELD}.mirror[{k}]")));
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    let chains = optional(fields, "chains")?;
    let chains = chains.iter().enumerate().map(|(k, value)| chain(value, &format!("{FIELD}.chains[{k}]")));
    let chains = chains.collect::<Result<Vec<_>, _>>()?;
    let built = |TemplateError { place, found, expected }| wrong(&format!("{FIELD}.{place}"), &found, &expected);
    Template::new(&name, &points, &pairs, &chains).map(Arc::new).map_err(built)
}

fn optional<'a>(fields: &'a Map<String, Value>, name: &str) -> Result<&'a [Value], FieldError> {
    match fields.get(name) {
        None => Ok(&[]),
        given => array(given, &format!("{FIELD}.{name}")).map(Vec::as_slice),
    }
}

fn text(fields: &Map<String, Value>, place: &str, name: &str) -> Result<String, FieldError> {
    let found = fields.get(name);
    let text = found.and_then(Value::as_str).filter(|text| !text.is_empty()).map(str::to_owned);
    text.ok_or_else(|| wrong(&format!("{place}.{name}"), &described(found), "a name"))
}

fn name_in(value: &Value, place: &str) -> Result<String, FieldError> {
    let name = value.as_str().map(str::to_owned);
    name.ok_or_else(|| wrong(place, &described(Some(value)), "the name of a key point"))
}

fn key_point(value: &Value, place: &str) -> Result<GivenPoint, FieldError> {
    let fields = object(value, place)?;
    let parent = fields.get("parent").map(|parent| name_in(parent, &format!("{place}.parent"))).transpose()?;
    Ok((text(fields, place, "name")?, parent, point(fields.get("at"), &format!("{place}.at"))?))
}

fn pair(value: &Value, place: &str) -> Result<(String, String), FieldError> {
    match array(Some(value), place)?.as_slice() {
        [a, b] => Ok((name_in(a, place)?, name_in(b, place)?)),
        list => Err(wrong(place, &format!("a list of {}", list.len()), "the names of two key points")),
    }
}

fn chain(value: &Value, place: &str) -> Result<GivenChain, FieldError> {
    let fields = object(value, place)?;
    let name = text(fields, place, "name")?;
    let points = array(fields.get("points"), &format!("{place}.points"))?;
    let points = points.iter().map(|value| name_in(value, &format!("{place}.points"))).collect::<Result<_, _>>()?;
    let found = fields.get("role");
    let role = found.and_then(Value::as_str).and_then(Role::from_id).ok_or_else(|| {
        let roles = Role::ALL.map(|(name, _)| name).join(", ");
        wrong(&format!("{place}.role"), &described(found), &format!("one of {roles}"))
    })?;
    Ok((name, points, role))
}

/// What the field holds for a template; none for the human one.
pub fn written(template: &Template) -> Option<Value> {
    if template.is_human() {
        return None;
    }
    if Template::built_in(template.name()).is_some_and(|known| *known == *template) {
        return Some(template.name().into());
    }
    Some(whole(template))
}

/// The definition of a template, built in or not.
pub fn whole(template: &Template) -> Value {
    let name = |k: &usize| template.point_name(*k);
    let point = |(k, point): (usize, &KeyPoint)| {
        let mut fields = Map::from_iter([("name".to_owned(), json!(point.name))]);
        if k > 0 {
            fields.insert("parent".into(), name(&point.parent).into());
        }
        fields.insert("at".into(), json!([point.at.x, point.at.y]));
        Value::Object(fields)
    };
    let pairs =
        (0..template.len()).filter(|&k| template.mirror(k) > k).map(|k| json!([name(&k), name(&template.mirror(k))]));
    let chain = |chain: &Chain| json!({"name": chain.name, "points": chain.points.iter().map(name).collect::<Vec<_>>(), "role": chain.role.id()});
    json!({
        "name": template.name(),
        "points": template.points().iter().enumerate().map(point).collect::<Vec<_>>(),
        "mirror": pairs.collect::<Vec<_>>(),
        "chains": template.chains().iter().map(chain).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snail() -> Value {
        json!({"name": "snail",
            "points": [{"name": "foot", "at": [0, 0]}, {"name": "neck", "parent": "foot", "at": [1, 0]},
                {"name": "l_eye", "parent": "neck", "at": [1.25, -0.5]},
                {"name": "r_eye", "parent": "neck", "at": [1.5, -0.5]}],
            "mirror": [["l_eye", "r_eye"]],
            "chains": [{"name": "torso", "points": ["foot", "neck"], "role": "torso"}]})
    }

    #[test]
    fn what_is_written_is_read_again() {
        assert_eq!(written(&read(None).unwrap()), None);
        assert_eq!(read(Some(&json!("human"))).unwrap(), Template::human());
        for name in ["quadruped", "bird"] {
            assert_eq!(written(&read(Some(&json!(name))).unwrap()), Some(json!(name)));
        }
        for name in BUILT_IN {
            let template = Template::built_in(name).unwrap();
            assert_eq!(read(Some(&whole(&template))).unwrap(), template);
        }
        let template = read(Some(&snail())).unwrap();
        assert_eq!((template.len(), template.mirror(2), template.name()), (4, 3, "snail"));
        assert_eq!(read(written(&template).as_ref()).unwrap(), template);
        // A template with a built-in one's name is written whole.
        let mut dog = snail();
        dog["name"] = json!("quadruped");
        assert!(written(&read(Some(&dog)).unwrap()).unwrap().is_object());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let said = |value: Value| read(Some(&value)).unwrap_err().to_string();
        let changed = |path: &str, value: Value| {
            let mut snail = snail();
            *snail.pointer_mut(path).unwrap() = value;
            said(snail)
        };
        assert_eq!(
            said(json!("fish")),
            "skeleton: found \"fish\", expected one of human, quadruped, bird, or an object with name, points, mirror and chains"
        );
        assert!(said(json!(3)).starts_with("skeleton: found 3, expected one of"));
        assert_eq!(
            changed("/points/1/at", json!([1])),
            "skeleton.points[1].at: found [1], expected a point [x, y] of numbers between -1e6 and 1e6"
        );
        assert!(
            changed("/points/1/parent", json!("tail"))
                .starts_with("skeleton.points[1] (\"neck\").parent: found \"tail\"")
        );
        assert_eq!(
            changed("/chains/0/role", json!("fin")),
            "skeleton.chains[0].role: found \"fin\", expected one of torso, head, leg, limb, other"
        );
        assert_eq!(
            changed("/mirror/0", json!(["a"])),
            "skeleton.mirror[0]: found a list of 1, expected the names of two key points"
        );
        assert!(
            changed("/mirror/0/0", json!("ear")).starts_with("skeleton.mirror[0]: found \"ear\", expected a key point")
        );
        assert_eq!(changed("/name", json!("")), "skeleton.name: found \"\", expected a name");
    }
}
