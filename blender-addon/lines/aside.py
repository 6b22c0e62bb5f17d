"""Hidden lines of traced drawings, which Remove Hidden Lines has moved to a layer of their own.

When a traced drawing is drawn anew, its lines are whole again, and what was moved aside would be there twice. So it goes, unless the artist has
changed it since. The drawings on that layer bear marks as other generated ones (see `blender.marks`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from ..blender import grease_pencil as gp
from ..blender import guard, hierarchy, marks
from ..blender import strokes as st
from . import moved


def layer_of(ob, name: str):
    """The layer with the hidden lines of a layer; `None` if there is none."""
    found = gp.find_layer(ob, name + hierarchy.ASIDE)
    return found if found is not None and any(gp.has(handle, gp.INTERVAL) for handle in gp.handles(found)) else None


def is_aside(ob, layer) -> bool:
    """Whether a layer has the hidden lines of another one."""
    name = layer.name.removesuffix(hierarchy.ASIDE)
    return name != layer.name and gp.find_layer(ob, name) is not None and layer_of(ob, name) is not None


@contextmanager
def noted(ob, names: Iterable[str]) -> Iterator[None]:
    """Marks the hidden lines of layers that are moved aside meanwhile as generated."""
    names = list(names)
    before = {name: _sums(ob, name) for name in names}
    own = {name: set(marks.changed_frames(ob.data, layer_of(ob, name).name)) for name in names if layer_of(ob, name) is not None}
    yield
    for name in names:
        layer = layer_of(ob, name)
        if layer is not None:
            frames = {frame for frame, total in _sums(ob, name).items() if before[name].get(frame) != total}
            marks.note(ob.data, layer.name, frames - own.get(name, set()))


def _sums(ob, name: str) -> dict[int, int]:
    layer = layer_of(ob, name)
    return {} if layer is None else moved.sums_of({frame: handle for frame, (handle, _) in gp.drawings(layer).items()})


def clear(ob, name: str, frames: Iterable[int]) -> None:
    """Removes the hidden lines of drawings of a layer that were drawn anew on some frames. Locked and hidden layers stay, and so do drawings of the artist."""
    layer = layer_of(ob, name)
    if layer is None or guard.closed(layer):
        return
    lines, wanted = gp.find_layer(ob, name), set(frames)
    kept = set(marks.changed_frames(ob.data, layer.name)) | {frame for frame, (_, kind) in gp.drawings(layer).items() if kind != gp.GENERATED}
    own = {frame for frame, (_, kind) in gp.drawings(lines).items() if kind != gp.GENERATED}
    gp.remove_frames(layer, [frame for frame in gp.frame_numbers(layer) if frame in wanted - kept and st.shown_frame(lines, frame) not in own])
