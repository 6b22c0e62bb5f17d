"""Weights of vertex groups on generated strokes.

Blender lets scripts set the weights of Grease Pencil points, but not read them. A copy of a drawing keeps them. So where an object
has vertex groups, a new generated drawing begins as a copy of the nearest key that has the same contours, and only what Rototoon
knows of its strokes is written over it.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import stroke_rows
from ..blender import strokes as st

Contours = tuple[tuple[int, int], ...]
"""The part's number and the number of points of each stroke of a drawing."""


class Keys:
    """The keys of a layer by their contours. Without vertex groups there are none."""

    def __init__(self, layer: bpy.types.bpy_struct):
        data, name = layer.id_data, layer.name
        self._frames: dict[Contours, list[int]] = {}
        if not any(ob.vertex_groups for ob in bpy.data.objects if ob.data == data):
            return
        with gp.copied(data) as copy:
            for frame, (handle, kind) in gp.drawings(copy.layers[name]).items():
                if kind != gp.GENERATED:
                    starts = gp.offsets(handle)
                    numbers = gp.value(handle, gp.PART, len(starts) - 1)
                    self._frames.setdefault(_contours(numbers, np.diff(starts)), []).append(frame)

    def begin(self, layer: bpy.types.bpy_struct, frame: int, rows: stroke_rows.Rows) -> None:
        """Replaces a new drawing by a copy of the nearest key with the contours of `rows`, if there is one."""
        found = self._frames.get(_contours(rows.values[gp.PART], rows.sizes))
        if not found:
            return
        gp.remove_frames(layer, [frame])
        gp.copy_frame(layer, min(found, key=lambda key: abs(key - frame)), frame)
        gp.set_keyframe_type(layer, {frame: gp.GENERATED})
        handle = gp.drawings(layer)[frame][0]
        # Handles and knots of the key would not fit the points that are tracked.
        st.set_types(handle, np.full(len(rows.sizes), st.POLY, np.int8))
        gp.put(handle, gp.MADE, np.ones(len(rows.sizes), bool))


def _contours(numbers: np.ndarray, sizes: np.ndarray) -> Contours:
    return tuple(zip(numbers.tolist(), sizes.tolist(), strict=True))
