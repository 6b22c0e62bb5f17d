"""What the add-on may change in the artist's file. All operators, handlers, Live and the Python interface ask here, and only here.

- **A locked layer is never written.** A layer is locked if it or one of its groups is. It is read, so a part whose keys are on a
  locked layer is still tracked.
- **A hidden layer is not written**, unless the caller says `hidden=True`. Operators that do so say it in their description.
- **Drawings of another file are not written.** They are linked, or a library override: Blender keeps no strokes of an override, so
  they would be gone when the file is opened again.
- **Drawings that several objects share are not written.** The contours of one object would replace those of another, which sees
  them through another camera or has other parts.
- **Drawings are not written where one of the object ends by itself**, as after *Insert Blank Keyframe* with a duration. When any frame is removed,
  Blender (4.5 to 5.2) puts the first drawing of the object in the place of such an end, and there it stays.

Each refusal names the object or layer, says why, and says what to do. An operator for one layer refuses it (`need_open`). An operator
for many layers leaves out those that are closed, and says which (`left_out`).

Limits: locked materials are not looked at. Animation of an overridden armature is written, since Blender keeps that.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from . import grease_pencil as gp
from .errors import Problem

DRAWINGS, SETTINGS, ANIMATION, NOTHING = "drawings", "settings", "animation", "nothing"
"""What an operator changes: strokes and layers, only the object's own settings, only its animation, or nothing of the object."""

_LOCAL = "make it local (Object > Relations > Make Local)"


def refusal(ob: bpy.types.Object, what: str = DRAWINGS) -> str:
    """Why `what` of an object cannot be changed; empty if it can."""
    if what == NOTHING:
        return ""
    for owner in (ob, ob.data) if what == DRAWINGS else (ob,):
        why = "" if owner is None else _of_another_file(owner, may_override=what == ANIMATION)
        if why:
            return why
    if what == ANIMATION and ob.animation_data is not None and ob.animation_data.use_tweak_mode:
        return f'An action strip of "{ob.name}" is in tweak mode, so it cannot get another action: leave it first (Tab in the Nonlinear Animation editor)'
    others = sharing(ob) if what == DRAWINGS else []
    if others:
        return (
            f'"{ob.name}" shares its drawings with "{others[0].name}": make them single-user '
            "(Object > Relations > Make Single User > Object & Data)"
        )
    return ""


def need(ob: bpy.types.Object, what: str = DRAWINGS) -> None:
    """Raises a `Problem` if `what` of an object cannot be changed. It looks at all frames, which `refusal` has no time for."""
    why = refusal(ob, what) or (_fixed_end(ob) if what == DRAWINGS else "")
    if why:
        raise Problem(why)


def _fixed_end(ob: bpy.types.Object) -> str:
    """Which drawing of an object ends by itself; empty if none does."""
    for layer in ob.data.layers if gp.is_drawing(ob) else ():
        ends = gp.ends(layer)
        if ends:
            return (
                f'On the layer "{layer.name}" a drawing ends by itself before frame {ends[0]}, and Blender would lose the end: go to frame {ends[0]}, '
                "make the layer active, and press Shift I in Draw Mode (Insert Blank Keyframe, with Duration 0)"
            )
    return ""


def need_own(block: bpy.types.ID) -> None:
    """Raises a `Problem` if a data-block belongs to another file."""
    why = _of_another_file(block, may_override=False)
    if why:
        raise Problem(why)


def _of_another_file(block: bpy.types.ID, may_override: bool) -> str:
    if block.library is not None or not block.is_editable:
        return f'"{block.name}" is linked from another file and cannot be changed: {_LOCAL}'
    if block.override_library is not None and not may_override:
        return f'"{block.name}" is a library override, and Blender would lose the change: {_LOCAL}'
    return ""


def sharing(ob: bpy.types.Object) -> list[bpy.types.Object]:
    """The other objects with the same data, by name."""
    data = ob.data
    # Panels ask at each redraw. Counting users costs nothing; looking at all objects does.
    if data is None or data.users - data.use_fake_user < 2:
        return []
    return sorted((other for other in bpy.data.objects if other.data == data and other != ob), key=lambda other: other.name)


def is_locked(layer: bpy.types.bpy_struct) -> bool:
    """Whether a layer or one of its groups is locked."""
    return layer.lock or any(group.lock for group in groups_of(layer))


def is_hidden(layer: bpy.types.bpy_struct) -> bool:
    """Whether a layer or one of its groups is hidden."""
    return layer.hide or any(group.hide for group in groups_of(layer))


def groups_of(layer: bpy.types.bpy_struct) -> Iterable[bpy.types.bpy_struct]:
    """The groups that a layer is in, the innermost first."""
    group = layer.parent_group
    while group is not None:
        yield group
        group = group.parent_group


def closed(layer: bpy.types.bpy_struct, hidden: bool = False) -> str:
    """Why a layer is not written: "locked" or "hidden"; empty if it may be. With `hidden`, hidden layers are written."""
    if is_locked(layer):
        return "locked"
    return "" if hidden or not is_hidden(layer) else "hidden"


def open_layers(layers: Iterable[bpy.types.bpy_struct], hidden: bool = False) -> list[bpy.types.bpy_struct]:
    """The layers that may be written."""
    return [layer for layer in layers if not closed(layer, hidden)]


def need_open(layers: Iterable[bpy.types.bpy_struct | None], hidden: bool = False) -> None:
    """Raises a `Problem` that names the layers that may not be written. Layers that do not exist yet are `None`."""
    said = _listed([layer for layer in layers if layer is not None], hidden)
    if said:
        raise Problem(f"{said}: {'unlock' if 'locked' in said else 'show'} it first")


def need_named(ob: bpy.types.Object, names: Iterable[str], hidden: bool = False) -> None:
    """As `need_open`, for layers by name. One that does not exist yet must not have the name of a group: Blender would call it otherwise,
    and it would not be found again."""
    found = {name: ob.data.layers.get(name) for name in names}
    need_open(found.values(), hidden)
    for name, layer in found.items():
        if layer is None and ob.data.layer_groups.get(name) is not None:
            raise Problem(f'A layer group of "{ob.name}" is called "{name}", so no layer can be: give the group another name')


def need_apart(ob: bpy.types.Object, names: Iterable[str], hidden: bool = False) -> None:
    """As `need_named`, for layers with results. One that counts as contours cannot be such a layer: what is drawn there would be parts."""
    names = list(names)
    need_named(ob, names, hidden)
    for why in filter(None, (as_contours(ob, name) for name in names)):
        raise Problem(why)


def as_contours(ob: bpy.types.Object, name: str) -> str:
    """Why a layer of this name cannot have results; empty if it can."""
    contours = ob.rototoon.contours_layer
    if not gp.is_named(name, contours):
        return ""
    begins = "is" if name == contours else "begins with"
    return f'The layer "{name}" counts as contours, since its name {begins} "{contours}": choose a layer with another name for what is drawn'


def need_some(layers: Iterable[bpy.types.bpy_struct], hidden: bool = False) -> None:
    """As `need_open`, if none of the layers may be written."""
    layers = list(layers)
    if not open_layers(layers, hidden):
        need_open(layers, hidden)


def left_out(layers: Iterable[bpy.types.bpy_struct], hidden: bool = False) -> str:
    """A warning: which of the layers stay as they are, and why. Empty if all may be written."""
    said = _listed(list(layers), hidden)
    return f"left as it was: {said}" if said else ""


def _listed(layers: list[bpy.types.bpy_struct], hidden: bool) -> str:
    found = [(layer.name, closed(layer, hidden)) for layer in layers]
    return ", ".join(f'the layer "{name}" is {why}' for name, why in found if why)
