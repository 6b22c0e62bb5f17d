"""Documents of drawings that have no footage.

A document says what its footage is, since its coordinates are that footage's pixels. Where drawings have none, its pixels are those of the picture that
the scene's camera renders, and its pattern names files that do not exist: `export` and `render` draw the drawings without them.

Limits: what looks at pictures, such as `track`, says that the files are missing. Blender cannot read such a document again, since it shows
drawings over their footage.
"""

from __future__ import annotations

from typing import Any

import bpy

from ..blender import placement
from ..blender.errors import Problem
from ..capture.document import VERSION

PATTERN = "no_footage_%04d.png"
_DRAWN = ("drawings", "traced", "in_betweens")


def lacking(ob) -> str:
    """Why drawings without footage have no pixels; empty if they have."""
    return "" if placement.camera_of(ob) is not None else "Without footage the drawings need a camera: add one, or choose the footage in the panel Footage"


def document(ob) -> dict[str, Any]:
    """An empty document for the drawings of an object, in pixels of the rendered picture."""
    why = lacking(ob)
    if why:
        raise Problem(why)
    scene, render = bpy.context.scene, bpy.context.scene.render
    offset, share = ob.rototoon.frame_offset, render.resolution_percentage / 100
    shot = {
        "pattern": PATTERN,
        "first": scene.frame_start - offset,
        "last": scene.frame_end - offset,
        "fps": round(render.fps / render.fps_base, 6),
        "width": max(round(render.resolution_x * share), 1),
        "height": max(round(render.resolution_y * share), 1),
    }
    return {"rototoon": VERSION, "footage": shot, "parts": []}


def fit(project: dict[str, Any]) -> None:
    """Stretches the frames of the footage to all drawings."""
    shot = project["footage"]
    frames = [each["frame"] for name in _DRAWN for each in project.get(name, ())]
    shot["first"], shot["last"] = min(shot["first"], *frames), max(shot["last"], *frames)
