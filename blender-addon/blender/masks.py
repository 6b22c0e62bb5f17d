"""Contours as a Blender mask: a layer for each part, a shape key for each frame.

Mask coordinates go from 0 to 1 along the longer side of the picture, with y up and the shorter side in the middle. Python
cannot make shape keys of masks. The operator `mask.shape_key_insert` can: it needs an editor in mask mode, and keys layers that
have a selected point. It keys the current points. So the mask must not be evaluated between setting the points and keying them.
Setting points as complete arrays does not tag the mask for evaluation.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from .errors import Problem
from .frames import kept

MADE = "rototoon_layers"
"""Property of masks that were made here: the names of their layers, one a line."""


@dataclass(frozen=True)
class Outline:
    """A part's contour on its frames, with the same number of points on each."""

    name: str
    closed: bool
    frames: dict[int, np.ndarray]
    """Pixels (N, 2) by scene frame, in time order."""
    hidden: frozenset[int] = frozenset()
    """Scene frames on which the part is hidden: Blender would blend the contours around them."""


def to_mask(pixels: np.ndarray, width: int, height: int) -> np.ndarray:
    """Mask coordinates of pixels of a picture."""
    return (pixels - (width / 2, height / 2)) * (1, -1) / max(width, height) + 0.5


def need_made(name: str) -> None:
    """Raises a `Problem` if there is a mask of this name that was not made here, or that has layers that were not."""
    mask = bpy.data.masks.get(name)
    if mask is None or not len(mask.layers):
        return
    made = mask.get(MADE)
    own = [layer.name for layer in mask.layers] if made is None else [each.name for each in mask.layers if each.name not in str(made).split("\n")]
    if own:
        layers = ", ".join(f'"{layer}"' for layer in own[:3]) + (f" and {len(own) - 3} more" if len(own) > 3 else "")
        raise Problem(
            f'The mask "{name}" has layers that Contours to Mask did not make ({layers}): rename that mask, or choose another name in Mask'
        )


def write(context, name: str, parts: list[Outline], width: int, height: int) -> bpy.types.Mask:
    """Makes the mask `name`. A mask of this name is replaced: see `need_made`."""
    mask = bpy.data.masks.get(name) or bpy.data.masks.new(name)
    mask.layers.clear()
    mask.animation_data_clear()
    for part in parts:
        _layer(mask, part)
    mask[MADE] = "\n".join(layer.name for layer in mask.layers)
    every = sorted({frame for part in parts for frame in part.frames})
    mask.frame_start, mask.frame_end = every[0], every[-1]
    with kept(context.scene), _mask_editor(context, mask):
        for frame in every:
            _key(context.scene, mask, parts, frame, (width, height))
    for layer, part in zip(mask.layers, parts, strict=True):
        _lifetime(layer, part, every[0], every[-1])
    return mask


def _layer(mask: bpy.types.Mask, part: Outline) -> None:
    layer = mask.layers.new(name=part.name)
    spline = layer.splines.new()
    # A new spline has one point.
    count = len(next(iter(part.frames.values())))
    if count > 1:
        spline.points.add(count - 1)
    spline.use_cyclic = part.closed
    spline.use_fill = part.closed
    for point in spline.points:
        point.handle_left_type = point.handle_right_type = "VECTOR"


def _key(scene, mask, parts: list[Outline], frame: int, size: tuple[int, int]) -> None:
    scene.frame_set(frame)
    for layer, part in zip(mask.layers, parts, strict=True):
        points, pixels = layer.splines[0].points, part.frames.get(frame)
        points.foreach_set("select", np.full(len(points), pixels is not None))
        if pixels is not None:
            values = to_mask(pixels, *size).ravel()
            for name in ("co", "handle_left", "handle_right"):
                points.foreach_set(name, values)
    if "FINISHED" not in bpy.ops.mask.shape_key_insert():
        raise Problem(f"Blender did not key the mask on frame {frame}")


def _lifetime(layer, part: Outline, begin: int, end: int) -> None:
    """Shows a layer from the first to the last frame of its part only, and not where it is hidden; `begin` and `end` are the mask's frames."""
    first, last = min(part.frames), max(part.frames)
    shown = {frame: float(frame not in part.hidden) for frame in range(first, last + 1)}
    if all(shown.values()) and (first, last) == (begin, end):
        return
    shown |= {first - 1: 0.0, last + 1: 0.0}
    # Keys on both sides of each change: what lies between them is even.
    for frame, alpha in sorted(shown.items()):
        if any(shown.get(beside, alpha) != alpha for beside in (frame - 1, frame + 1)):
            layer.alpha = alpha
            layer.keyframe_insert("alpha", frame=frame)


@contextmanager
def _mask_editor(context, mask) -> Iterator[None]:
    """Makes an image editor in mask mode the context. If there is none, another editor becomes one meanwhile."""
    windows = [context.window] if context.window else list(context.window_manager.windows)
    areas = [(window, area) for window in windows for area in window.screen.areas]
    if not areas:
        raise Problem("Blender has no window, but keying a mask needs an editor")
    # The editor with the button is the last choice.
    window, area = min(areas, key=lambda each: (each[1].type != "IMAGE_EDITOR", each[1] == context.area))
    kind = area.ui_type
    area.type = "IMAGE_EDITOR"
    space = area.spaces.active
    before = (space.ui_mode, space.mask)
    space.ui_mode, space.mask = "MASK", mask
    region = next(region for region in area.regions if region.type == "WINDOW")
    try:
        with context.temp_override(window=window, area=area, region=region, space_data=space):
            yield
    finally:
        space.mask = before[1]
        space.ui_mode = before[0]
        area.ui_type = kind
