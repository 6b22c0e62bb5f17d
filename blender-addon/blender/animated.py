"""Animation of data-blocks: their curves, and values that the artist has changed and not keyed yet.

Blender sets every animated value anew whenever the scene goes to another frame. So a pose that is not keyed yet is lost there. `Unkeyed` brings
it back for work that only looks at other frames.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from typing import Any

import bpy

_LAST = re.compile(r"(?:(?P<owner>.+)\.)?(?P<name>[A-Za-z_]\w*)")
_ITEM = re.compile(r'(?P<owner>.*)\["(?P<name>(?:[^"\\]|\\.)*)"\]')


def curves(owner: bpy.types.ID) -> Iterator[bpy.types.FCurve]:
    """The animation curves of a data-block: those of its action, and those of its strips."""
    data = owner.animation_data
    if data is None:
        return
    uses = [(data.action, data.action_slot), *((strip.action, strip.action_slot) for track in data.nla_tracks for strip in track.strips)]
    for action, slot in uses:
        if action is None or slot is None:
            continue
        for strip in (strip for layer in action.layers for strip in layer.strips):
            bag = strip.channelbag(slot)
            if bag is not None:
                yield from bag.fcurves


class Unkeyed:
    """The animated values of a scene as they are now."""

    def __init__(self, scene: bpy.types.Scene):
        self._values = [(owner, path, _value(owner, path)) for owner in _owners(scene) for path in {curve.data_path: None for curve in curves(owner)}]

    def bring_back(self) -> None:
        """Sets what has another value by now."""
        for owner, path, value in self._values:
            # What is gone meanwhile, or cannot be written, stays.
            with contextlib.suppress(AttributeError, KeyError, ReferenceError, TypeError, ValueError):
                if value is not None and _value(owner, path) != value:
                    _set(owner, path, value)


def _owners(scene: bpy.types.Scene) -> list[bpy.types.ID]:
    """The data-blocks of a scene that may be animated and changed. Each is there once."""
    found: dict[bpy.types.ID, None] = {scene: None}
    for ob in scene.objects:
        materials = [slot.material for slot in ob.material_slots]
        blocks = [ob, ob.data, getattr(ob.data, "shape_keys", None), *materials, *(getattr(each, "node_tree", None) for each in materials)]
        found.update(dict.fromkeys(blocks))
    # An empty may show an image, which has no animation.
    return [each for each in found if getattr(each, "animation_data", None) is not None and each.library is None]


def _value(owner: bpy.types.ID, path: str) -> Any:
    """A value that does not change with the owner; `None` if there is none."""
    try:
        value = owner.path_resolve(path)
    except ValueError:
        return None
    return value if isinstance(value, (bool, int, float, str)) else tuple(value) if hasattr(value, "__len__") else None


def _set(owner: bpy.types.ID, path: str, value: Any) -> None:
    if found := _ITEM.fullmatch(path):
        holder = owner.path_resolve(found["owner"]) if found["owner"] else owner
        holder[bpy.utils.unescape_identifier(found["name"])] = value
        # A value of one's own tells nobody that it has changed.
        owner.update_tag()
    elif found := _LAST.fullmatch(path):
        setattr(owner.path_resolve(found["owner"]) if found["owner"] else owner, found["name"], value)
