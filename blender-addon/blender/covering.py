"""Which fills hide what lies behind them.

A fill does if all of it is opaque: the material's fill, its own opacity and the layer's. A layer that mixes with what is behind it, or that shows only
inside of other layers, hides nothing for certain.

Limits: textures count as their material's fill colour, modifiers and effects do not count.
"""

from __future__ import annotations

import numpy as np

from . import guard, materials
from . import strokes as st

OPAQUE = 0.999
"""Opacity from which on nothing behind is seen."""


def of_fills(ob, layer, content: st.Content) -> np.ndarray:
    """The opacity of each stroke's fill. Strokes with one common fill have that of the first of them."""
    alphas = np.array([_alpha(material) for material in materials.of(ob)] or [_alpha(None)])
    index = np.clip(content.strokes("material_index"), 0, len(alphas) - 1)
    own = alphas[index] * content.strokes("fill_opacity") * layer.opacity
    fills = st.filled(ob, content)
    _, first, which = np.unique(fills, return_index=True, return_inverse=True)
    return np.where(fills != 0, own[first][which.ravel()], 0.0)


def of_lines(ob, layer, content: st.Content) -> np.ndarray:
    """For each stroke: whether its material and its layer are seen at all."""
    styles = [material.grease_pencil if material is not None else None for material in materials.of(ob)]
    seen = np.array([style is None or not style.hide for style in styles] or [True])
    return seen[np.clip(content.strokes("material_index"), 0, len(seen) - 1)] & (layer.opacity > 0)


def mixes(layer) -> bool:
    """Whether what is behind a layer may be seen through it: it is blended with that, or masked."""
    return layer.blend_mode != "REGULAR" or is_masked(layer)


def is_masked(layer) -> bool:
    """Whether a layer shows only inside of other layers, or outside of them."""
    used = all(getattr(each, "use_masks", True) for each in (layer, *guard.groups_of(layer)))
    return used and any(not mask.hide for mask in layer.mask_layers)


def _alpha(material) -> float:
    """The opacity of a material's fill. Blender fills with an opaque colour of its own where there is no material for drawings."""
    style = material.grease_pencil if material is not None else None
    if style is None:
        return 1.0
    if style.hide:
        return 0.0
    alphas = [style.fill_color[3], *([style.mix_color[3]] if style.fill_style == "GRADIENT" else [])]
    return min(alphas)
