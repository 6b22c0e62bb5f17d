"""An object moved to its new footage: all changes, in one go.

Whatever may be refused is looked at before. So the first change comes when nothing can fail any more, and there is no state between the old footage
and the new one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import guard, marks, stage, world
from ..blender import strokes as st
from ..capture import generated, sessions
from . import comparing, layers, looks, notes, plan
from .placing import Placing
from .times import Times

Changes = dict[tuple[str, int, int], dict[str, np.ndarray]]
"""By layer, old frame and new frame the attributes of a drawing that get other values."""


@dataclass
class Ready:
    """Everything that is to be written."""

    plan: plan.Plan
    changes: Changes
    still: bool
    """Whether neither the camera nor the object moves."""


def preparing(ob, compared: comparing.Compared, times: Times, size: tuple[int, int]) -> Iterator[float]:
    """Looks at everything, in steps. Changes nothing. Returns what is to be written."""
    made = yield from plan.making(ob, times)
    asides = {layers.left_over(layer.name) for layer in made.layers for drawing in layer.drawings if drawing.aside is not None}
    guard.need_named(ob, sorted(asides), hidden=True)
    names = [layer.name for layer in made.layers]
    points = {k: layer.points() for k, layer in enumerate(made.layers)}
    every = [drawing for layer in made.layers for drawing in layer.drawings]
    frames = {drawing.frame for drawing in every}
    new = {frame for drawing in every for frame in drawing.places}
    placing = Placing(ob, names, {k: each for k, each in points.items() if len(each)}, frames, new, compared.found, size)
    ready, slots = Ready(made, {}, placing.still), marks.Slots(ob.data)
    for layer in made.layers:
        for drawing in layer.drawings:
            for frame in drawing.places:
                changed = placing.changed(layer.name, drawing.content, drawing.frame, frame)
                if "radius" in changed:
                    changed[gp.LOOK] = looks.followed(drawing.content, changed, slots)
                ready.changes[layer.name, drawing.frame, frame] = changed
            yield 0.0
    return ready


def writing(ob, ready: Ready, compared: comparing.Compared, times: Times, shot: stage.Shot) -> Iterator[float]:
    """Writes everything, in steps."""
    stage.show_instead(ob, shot)
    stage.assign(ob, shot)
    comparing.put(ob, compared, times)
    sessions.drop(ob)
    for k, made in enumerate(ready.plan.layers):
        _write(ob, made, ready.changes)
        yield k / len(ready.plan.layers)
    # The hidden layers of earlier runs have moved too by now, so their frames are those of the new footage.
    for made in ready.plan.layers:
        _keep_left_over(ob, made, ready.changes)
    notes.follow(ob, ready.plan, ready.changes)
    ob.data.update_tag()


def _keep_left_over(ob, made: plan.Layer, changes: Changes) -> None:
    """Draws on the hidden layer what is left over. The plan has its strokes."""
    kept = [drawing for drawing in made.drawings if drawing.aside is not None]
    if not kept:
        return
    matrix = _to_object(ob, gp.find_layer(ob, made.name))
    is_new = gp.find_layer(ob, layers.left_over(made.name)) is None
    layer = gp.layer(ob, layers.left_over(made.name))
    gp.make_frames(layer, [drawing.aside for drawing in kept], gp.KEYFRAME)
    handles = {frame: handle for frame, (handle, _) in gp.drawings(layer).items()}
    for drawing in kept:
        content = looks.with_values(drawing.content, changes[made.name, drawing.frame, drawing.aside])
        content.point["position"] = (content.point["position"] @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
        st.add(handles[drawing.aside], st.chosen(content, [stroke for stroke in drawing.own() if stroke not in drawing.joining]))
    if is_new:
        layer.hide = True


def _to_object(ob, layer) -> np.ndarray:
    """A layer's points to those of a layer without a parent and a place of its own."""
    return np.linalg.inv(np.array(world.matrix_of(ob), np.float64)) @ cameras.layer_to_world(ob, layer)


def _write(ob, made: plan.Layer, changes: Changes) -> None:
    layer = gp.find_layer(ob, made.name)
    gp.put_frames(layer, {drawing.frame: drawing.targets for drawing in made.drawings})
    gp.make_frames(layer, made.ends, gp.GENERATED)
    by_target = {new: drawing for drawing in made.drawings for new in drawing.targets}
    met = {drawing.joined for drawing in made.drawings if drawing.joined is not None}
    changed = {new for new, drawing in by_target.items() if changes[made.name, drawing.frame, new] or drawing.drop or drawing.keys.get(new)}
    gp.make_own(layer, changed | met)
    kinds = {frame: kind for frame, (_, kind) in gp.drawings(layer).items()}
    handles = {frame: handle for frame, (handle, _) in gp.drawings(layer).items()}
    for new in sorted(changed):
        drawing = by_target[new]
        values = changes[made.name, drawing.frame, new]
        for name, each in values.items():
            gp.put(handles[new], name, each)
        if drawing.keys.get(new):
            generated.settle(handles[new], kinds[new])
        for stroke in drawing.keys.get(new, ()):
            _make_key(handles[new], stroke)
        if drawing.drop and drawing.results:
            gp.remove_strokes(handles[new], drawing.results)
        gp.points_changed(handles[new])
    for drawing in made.drawings:
        if drawing.joined is not None:
            _join(handles[drawing.joined], drawing, changes[made.name, drawing.frame, drawing.joined])
    keyed = {new: gp.KEYFRAME for new, drawing in by_target.items() if drawing.keys.get(new)}
    gp.set_keyframe_type(layer, keyed)
    marks.note(ob.data, made.name, {new for new in changed if by_target[new].marked})


def _join(handle, drawing: plan.Drawing, values: dict[str, np.ndarray]) -> None:
    """Adds contours of a drawing to another one, in the place of generated ones of their parts."""
    joining = st.chosen(looks.with_values(drawing.content, values), drawing.joining)
    parts = gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1)
    gone = np.flatnonzero(np.isin(parts, joining.strokes(gp.PART)))
    if len(gone):
        gp.remove_strokes(handle, gone.tolist())
    st.add(handle, joining)


def _make_key(handle, stroke: int) -> None:
    """Makes a generated contour the artist's."""
    made = gp.value(handle, gp.MADE, len(gp.offsets(handle)) - 1)
    made[stroke] = False
    gp.put(handle, gp.MADE, made)


