"""Key points of armatures: their bones, and their places from a side as clips of the library.

The names of bones show which bone has which key point (`names`). The artist may choose others, and the object keeps the choice.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np
from rototoon.style import KEY_POINTS

from ..blender import armatures
from ..blender import camera as cameras
from ..blender.errors import Problem
from ..blender.frames import kept
from . import names as bone_names


def guess(ob) -> bone_names.Table:
    """Fills an armature's table from the names of its bones. The artist's choices stay if their bones exist."""
    found = bone_names.guess(armatures.bones_of(ob))
    kept = chosen(ob)
    ob.rototoon.bones.clear()
    for point in KEY_POINTS:
        item = ob.rototoon.bones.add()
        item.name = point
        item.bone, item.along = kept.get(point) or found.get(point) or ("", 0.0)
    return chosen(ob)


def chosen(ob) -> bone_names.Table:
    """The stored table of an armature, without bones that do not exist."""
    names = ob.data.bones
    return {item.name: (item.bone, item.along) for item in ob.rototoon.bones if item.bone in names}


def table_of(ob, needed: tuple[str, ...] = KEY_POINTS) -> bone_names.Table:
    """The table of an armature: stored choices, otherwise guesses. Raises a `Problem` if a needed key point is missing."""
    table = {**bone_names.guess(armatures.bones_of(ob)), **chosen(ob)}
    missing = [point for point in needed if point not in table]
    if missing:
        names = ", ".join(missing)
        raise Problem(f'"{ob.name}": no bone is known for {names}: use Guess Bones, then choose them in the panel Bones')
    return table


def key_points(ob, table: bone_names.Table) -> np.ndarray:
    """Places (17, 3) of the key points in the world, on the current frame."""
    bones = ob.pose.bones
    local = [bones[name].head.lerp(bones[name].tail, along) for name, along in (table[point] for point in KEY_POINTS)]
    return np.array([ob.matrix_world @ point for point in local], np.float64)


def sample(ob, frames: range, which: str, into: list[np.ndarray]) -> Iterator[float]:
    """Adds a posture (17, 2) for each frame to a list, one frame per step. At the end the scene is on its frame again."""
    scene = bpy.context.scene
    table = table_of(ob)
    with kept(scene):
        for number, frame in enumerate(frames):
            scene.frame_set(frame)
            posed = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
            view = armatures.view_of(scene, which)
            into.append(cameras.Mapping(view, np.eye(4)).to_pixels(key_points(posed, table)))
            yield (number + 1) / len(frames)


def clips(character: str, motion: str, fps: float, postures: list[np.ndarray]) -> dict[str, Any]:
    """A file of clips with one clip."""
    points = np.round(np.stack(postures), 4)
    if float(np.ptp(points, axis=1).max()) < 1e-3:
        raise Problem("All bones are seen on one spot: choose another view")
    entry = {"character": character, "motion": motion, "points": points.tolist()}
    return {"rototoon_clips": 1, "fps": fps, "keypoints": list(KEY_POINTS), "clips": [entry]}
