"""The scene's current frame."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from .animated import Unkeyed


@contextmanager
def kept(scene: bpy.types.Scene) -> Iterator[None]:
    """At the end, sets the scene back to the frame that it had, and brings back what the artist has changed there and not keyed yet."""
    before, unkeyed = (scene.frame_current, scene.frame_subframe), Unkeyed(scene)
    try:
        yield
    finally:
        if (scene.frame_current, scene.frame_subframe) != before:
            # Before frame 0 Blender counts a part of a frame backwards, but takes it forwards only.
            whole = math.floor(sum(before))
            scene.frame_set(whole, subframe=sum(before) - whole)
        unkeyed.bring_back()
