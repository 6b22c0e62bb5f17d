//! Kinds of SVG elements.

/// Elements whose content is not drawn in place.
pub(super) const NOT_DRAWN: [&str; 9] =
    ["defs", "clipPath", "mask", "pattern", "symbol", "marker", "linearGradient", "radialGradient", "filter"];

/// Elements that contain others.
pub(super) const GROUPS: [&str; 4] = ["g", "a", "svg", "switch"];

/// Elements that have an outline.
pub(super) const SHAPES: [&str; 7] = ["path", "polygon", "polyline", "line", "circle", "ellipse", "rect"];

/// Elements that are drawn but have no outline here.
pub(super) const WITHOUT_OUTLINE: [&str; 4] = ["text", "image", "use", "foreignObject"];
