//! Fields of a document that name parts, when a part goes.
//!
//! Limbs, marks of what is in front, and what parts follow know a part by its name. A document with a name that no part has is of no use.

use serde_json::Value;

/// Takes out of a document's JSON what names a part: limbs with an end on it, its place among what a limb carries, its marks and what follows it, and
/// the keys that reshaping gave it.
pub fn without_part(document: &mut Value, name: &str) {
    let names = |value: Option<&Value>| value.and_then(Value::as_str) == Some(name);
    if let Some(limbs) = document.get_mut("limbs").and_then(Value::as_array_mut) {
        let is_on = |limb: &Value| {
            let points = ["start", "end"].iter().filter_map(|end| limb.get(end)?.get("points")?.as_array()).flatten();
            points.into_iter().any(|point| names(point.get("part")))
        };
        limbs.retain(|limb| !is_on(limb));
        for carried in limbs.iter_mut().filter_map(|limb| limb.get_mut("carries")?.as_array_mut()) {
            carried.retain(|part| !names(Some(part)) && !names(part.get("part")));
        }
    }
    for (field, ends) in [("depth_marks", ["front", "behind"]), ("follows", ["part", "of"])] {
        if let Some(rows) = document.get_mut(field).and_then(Value::as_array_mut) {
            rows.retain(|row| !ends.iter().any(|end| names(row.get(end))));
        }
    }
    if let Some(keys) = document.get_mut("reshaped").and_then(Value::as_object_mut) {
        keys.remove(name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nothing_names_a_part_that_is_gone() {
        let limb = |part: &str, carries: Value| json!({"from": "a", "to": "b", "start": {"points": [{"part": part, "at": 0}, {"part": "coat", "at": 1}]}, "end": {"points": []}, "carries": carries});
        let mut document = json!({
            "limbs": [limb("arm", json!(["arm"])), limb("leg", json!(["leg", "arm", {"part": "arm", "turn": 0.5}, {"part": "boot"}]))],
            "depth_marks": [{"front": "arm", "behind": "coat"}, {"front": "leg", "behind": "arm"}, {"front": "leg", "behind": "coat"}],
            "follows": [{"part": "arm", "what": "root"}, {"part": "badge", "of": "arm"}, {"part": "badge", "of": "coat"}],
            "reshaped": {"arm": {}, "leg": {}},
            "note": "arm",
        });
        without_part(&mut document, "arm");
        let left = json!({
            "limbs": [limb("leg", json!(["leg", {"part": "boot"}]))],
            "depth_marks": [{"front": "leg", "behind": "coat"}],
            "follows": [{"part": "badge", "of": "coat"}],
            "reshaped": {"leg": {}},
            "note": "arm",
        });
        assert_eq!(document, left);
        without_part(&mut document, "nobody");
        assert_eq!(document, left);
        without_part(&mut json!({"limbs": 5, "follows": [1, "arm"], "reshaped": []}), "arm");
    }
}
