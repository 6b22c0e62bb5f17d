"""The plane on which lines and paint are drawn: that of what the layer has, and on an empty layer that of the contours.

An artist may draw in front of the object's own plane, such as at the 3D cursor. What lies on the plane behind would be seen from the roto camera alone
in its place.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import placement

ENOUGH = 20_000
"""Number of points that show a plane."""
_FLAT = 1e-3
"""Points lie on a plane if they are at most this share of their extent away from one."""


def points(ob, name: str) -> np.ndarray:
    """Points (N, 3) in a layer's space that show its plane; none if it is the object's own. Contours that lie on no plane show none, and neither do
    those that move against the layer."""
    layer = gp.find_layer(ob, name)
    own = _gathered(gp.handles(layer)) if layer is not None else _gathered(())
    if len(own):
        return own
    for contours in gp.layers(ob, ob.rototoon.contours_layer):
        drawn = _gathered(handle for handle, kind in gp.drawings(contours).values() if kind != gp.GENERATED)
        if len(drawn):
            return _from(ob, contours, layer, drawn) if _is_flat(drawn) and not placement.may_part(ob, contours, layer) else drawn[:0]
    return own


def _from(ob, contours, layer, drawn: np.ndarray) -> np.ndarray:
    """Points of a layer of contours as those of another layer, which may be `None`: a new one."""
    ways = [cameras.need_size(ob, cameras.layer_to_world(ob, each)) for each in (contours, layer)]
    if np.array_equal(*ways):
        return drawn
    matrix = np.linalg.inv(ways[1]) @ ways[0]
    return drawn @ matrix[:3, :3].T + matrix[:3, 3]


def _gathered(handles: Iterable) -> np.ndarray:
    found, count = [np.zeros((0, 3), np.float32)], 0
    for handle in handles:
        own = gp.positions(handle, int(gp.offsets(handle)[-1]))
        found.append(own[np.isfinite(own).all(1)])
        count += len(found[-1])
        if count > ENOUGH:
            break
    return np.concatenate(found)


def _is_flat(drawn: np.ndarray) -> bool:
    spread = drawn.astype(np.float64) - drawn.mean(0, np.float64)
    sizes = np.linalg.svd(spread, compute_uv=False)
    return bool(sizes[-1] <= _FLAT * sizes[0])
