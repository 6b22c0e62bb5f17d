//! Elements and numbers of a Natron project.

use super::super::channel::{Channel, Key, Way};
use super::super::limits::FARTHEST;
use super::super::problem::{ImportError, quoted};
use roxmltree::Node;

/// The value of `InterpolationMethod` for a number that holds until the next key (`eKeyframeTypeConstant`).
const HELD: &str = "0";
/// The one for a number that goes evenly (`eKeyframeTypeLinear`). Others go in curves.
const LINEAR: &str = "1";

/// Whether a node is an element with this name.
pub(super) fn named(node: Node, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

/// The first child element with this name.
pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| named(*child, name))
}

/// The text of an element without the white space around it.
pub(super) fn text_of<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

/// The number in an element.
pub(super) fn number(node: Node) -> Result<f64, ImportError> {
    let text = text_of(node);
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite() && value.abs() <= FARTHEST);
    value.ok_or_else(|| {
        ImportError::at(node, format!("found {}, expected a number of at most {FARTHEST:e}", quoted(Some(text))))
    })
}

/// The number in the child `name` of a control point, with the animation in the child `name`_animation.
pub(super) fn curve(point: Node, name: &str) -> Result<Channel, ImportError> {
    let animation = child(point, &format!("{name}_animation"));
    if let Some(channel) = animation.map(keys).transpose()?.flatten() {
        return Ok(channel);
    }
    let still = child(point, name).ok_or_else(|| ImportError::at(point, format!("found no <{name}>, expected one")))?;
    Ok(Channel::constant(number(still)?))
}

/// The keys in an animation; `None` without keys.
pub(super) fn keys(animation: Node) -> Result<Option<Channel>, ImportError> {
    // Early versions wrote a pointer around the set.
    let Some(set) = animation.descendants().find(|node| named(*node, "KeyFrameSet")) else { return Ok(None) };
    let key = |key: Node| {
        let part =
            |name| child(key, name).ok_or_else(|| ImportError::at(key, format!("found no <{name}>, expected one")));
        let way = child(key, "InterpolationMethod").map_or(LINEAR, text_of);
        let way = match way {
            HELD => Way::Held,
            LINEAR => Way::Linear,
            _ => Way::Other,
        };
        Ok(Key { frame: number(part("Time")?)?, value: number(part("Value")?)?, way })
    };
    let items = set.children().filter(|node| named(*node, "item"));
    Ok(Channel::of_keys(items.map(key).collect::<Result<Vec<_>, ImportError>>()?))
}
