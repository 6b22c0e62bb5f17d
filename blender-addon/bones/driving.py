"""Drive Bones: the direction of each limb in the picture becomes the direction of its bones in the view's plane.

A bone first swings into the plane, once, the shortest way. Then it turns about the view's axis by the angle of the clip's limb. So a
bone keeps its roll and turns evenly. If a limb has several bones, all make the same turn. Bones without a limb keep their pose and
move with their parents. The pelvis moves in the plane, at the armature's size.

A rig that looks to the other side than the clip follows the mirrored clip, as drawings do. A rig looks to where its feet point in the
plane, else to where its knees bend. Where the clip's figure is on the ground, the lower ankle has the height that the lower one has at
rest: legs of other proportions, and postures that are tilted into the plane, would make the rig float or sink. In the air the shift
is that of the frames around, so a jump keeps its height.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from mathutils import Euler, Matrix, Quaternion, Vector
from rototoon.style import KEY_POINTS

from ..blender import armatures
from ..blender.errors import Problem
from . import key_points
from . import names as bone_names

LIMBS = (
    ("pelvis", "chest"), ("chest", "neck"), ("neck", "head"), ("head", "head_top"),
    ("l_shoulder", "l_elbow"), ("l_elbow", "l_wrist"), ("r_shoulder", "r_elbow"), ("r_elbow", "r_wrist"),
    ("l_hip", "l_knee"), ("l_knee", "l_ankle"), ("r_hip", "r_knee"), ("r_knee", "r_ankle"),
)  # fmt: skip
"""Limbs whose bones turn. Collar bones and hips keep their pose."""
ANKLES = ("l_ankle", "r_ankle")
KNEE = 0.005
"""A knee is bent at rest if it is this share of the leg beside the line from hip to ankle."""
FLAT = 0.2
"""If a smaller share of a limb's rest length is in the plane, its rest direction there is not used."""
_PATHS = {"QUATERNION": ("rotation_quaternion", 4), "AXIS_ANGLE": ("rotation_axis_angle", 4)}


@dataclass
class Turn:
    """A limb's bones and their turn."""

    bones: list[str]
    swing: Quaternion
    """The rotation from rest into the plane."""
    angles: np.ndarray
    """Angle about the view's axis for each posture."""


@dataclass
class Plane:
    """The view's plane in armature space."""

    right: Vector
    up: Vector
    out: Vector

    @classmethod
    def of(cls, ob, scene, which: str) -> Plane:
        """The plane of a view on the current frame."""
        axes = Matrix(armatures.view_of(scene, which).to_view[:3, :3].tolist())
        turned = axes @ ob.matrix_world.to_3x3().normalized()
        return cls(*(Vector(turned[k]).normalized() for k in range(3)))

    def on(self, angle: float) -> Vector:
        """The direction at an angle in the plane."""
        return self.right * float(np.cos(angle)) + self.up * float(np.sin(angle))


def looks(ob, plane: Plane) -> str | None:
    """The side to which a rig looks in the plane, "left" or "right"; `None` where it does not tell."""
    bones, table = armatures.bones_of(ob), key_points.table_of(ob)
    toes, size = 0.0, 0.0
    for ankle in ANKLES:
        place, shin = Vector(_place(table[ankle], bones)), table[ankle]
        own = [name for name, bone in bones.items() if bone.parent == shin[0]] if shin[1] > 0 else [shin[0]]
        for bone in (bones[name] for name in own):
            foot = Vector(bone.tail - bone.head)
            if (Vector(bone.head) - place).length <= 0.5 * foot.length:
                toes, size = toes + foot.dot(plane.right), size + foot.length
    if size and abs(toes) >= FLAT * size:
        return "right" if toes > 0 else "left"
    bent, size = 0.0, 0.0
    for points in (("l_hip", "l_knee", "l_ankle"), ("r_hip", "r_knee", "r_ankle")):
        hip, knee, ankle = (Vector(_place(table[point], bones)) for point in points)
        leg = ankle - hip
        bent += (knee - hip - leg * ((knee - hip).dot(leg) / max(leg.length_squared, 1e-12))).dot(plane.right)
        size += leg.length
    return None if abs(bent) < KNEE * size else "right" if bent > 0 else "left"


def mirrored(postures: np.ndarray) -> np.ndarray:
    """Postures (F, 17, 2) mirrored left for right about the first pelvis."""
    made = postures.copy()
    made[..., 0] = 2 * postures[0, 0, 0] - postures[..., 0]
    return made


def turns(ob, postures: np.ndarray, plane: Plane) -> list[Turn]:
    """The turns of an armature's bones for the postures (F, 17, 2) of a clip."""
    bones = armatures.bones_of(ob)
    table = key_points.table_of(ob)
    carrying = _carrying_legs(table, bones)
    found = []
    for start, end in LIMBS:
        chain = _chain(table[start], table[end], bones)
        if len(chain) > 1:
            # The legs hang on the pelvis, so it does not lean with the body.
            chain = [name for name in chain if name not in carrying] or chain
        rest = Vector(_place(table[end], bones) - _place(table[start], bones))
        if not chain or rest.length < 1e-9:
            continue
        along = postures[:, KEY_POINTS.index(end)] - postures[:, KEY_POINTS.index(start)]
        angles = np.unwrap(np.arctan2(-along[:, 1], along[:, 0]))
        flat = np.array([rest.dot(plane.right), rest.dot(plane.up)])
        if np.linalg.norm(flat) >= FLAT * rest.length:
            own = float(np.arctan2(flat[1], flat[0]))
        else:
            own = float(np.arctan2(np.sin(angles).mean(), np.cos(angles).mean()))
        found.append(Turn(chain, rest.rotation_difference(plane.on(own)), angles - own))
    if not found:
        raise Problem(f'"{ob.name}": no bone lies between two key points: choose others in the panel Bones')
    return found


def _place(where: tuple[str, float], bones) -> np.ndarray:
    bone = bones[where[0]]
    return bone.head + (bone.tail - bone.head) * where[1]


def _chain(start: tuple[str, float], end: tuple[str, float], bones) -> list[str]:
    """The bones between two key points."""
    last = end[0] if end[1] > 0 else bones[end[0]].parent
    if start[1] >= 1 and start[0] != last:
        # The start is at a bone's tail, where the next bone begins.
        after = bone_names.path(start[0], last, bones)
        return after[1:]
    return bone_names.path(start[0], last, bones)


def _carrying_legs(table: bone_names.Table, bones) -> set[str]:
    """The ancestors of the thigh bones."""
    found = set()
    for point in ("l_hip", "r_hip"):
        name = bones[table[point][0]].parent
        while name:
            found.add(name)
            name = bones[name].parent
    return found


def poses(ob, postures: np.ndarray, plane: Plane, move: bool, air: Sequence[bool]) -> list[dict[str, Matrix]]:
    """For each posture the basis matrices of the driven bones, relative to parent and rest, as their channels have them.

    With `move` the pelvis moves as in the clip, and feet stand on the ground on the frames that are not in the `air`.
    """
    pelvis = key_points.table_of(ob)["pelvis"][0]
    if not move or ob.data.bones[pelvis].use_connect:
        return [made for made, _ in _posed(ob, postures, plane, None)]
    shifts = _shifts(ob, postures, plane)
    low = [lowest for _, lowest in _posed(ob, postures, plane, shifts)]
    shifts = [shift + plane.up * up for shift, up in zip(shifts, _lifts(ob, plane, low, air))]
    return [made for made, _ in _posed(ob, postures, plane, shifts)]


def pose(ob, matrices: dict[str, Matrix]) -> None:
    """Gives bones the basis matrices that they have not yet."""
    for bone in ob.pose.bones:
        if bone.matrix_basis != matrices[bone.name]:
            bone.matrix_basis = matrices[bone.name]


def _lifts(ob, plane: Plane, low: list[float], air: Sequence[bool]) -> np.ndarray:
    """How far each posture is to be lifted so that its lower ankle is as high as at rest. `low` are the heights of the lower ankles."""
    bones, table = armatures.bones_of(ob), key_points.table_of(ob)
    pelvis = table["pelvis"][0]
    if any(not bone_names.path(pelvis, table[ankle][0], bones) for ankle in ANKLES):
        return np.zeros(len(low))  # the legs do not hang on the pelvis
    rest = min(Vector(_place(table[ankle], bones)).dot(plane.up) for ankle in ANKLES)
    wanted = rest - np.array(low)
    frames = np.arange(len(low))
    ground = frames[~np.array(air, bool)]
    if not len(ground):
        return np.zeros(len(low))
    return np.maximum(np.interp(frames, ground, wanted[ground]), wanted)


def _posed(ob, postures: np.ndarray, plane: Plane, shifts: list[Vector] | None) -> Iterator[tuple[dict[str, Matrix], float]]:
    """For each posture the basis matrices of the driven bones, and the height of the lower ankle in the plane."""
    table = key_points.table_of(ob)
    driven = {name: turn for turn in turns(ob, postures, plane) for name in turn.bones}
    pelvis = table["pelvis"][0]
    for k in range(len(postures)):
        posed: dict[str, Matrix] = {}
        result: dict[str, Matrix] = {}
        for bone in ob.data.bones:
            parent = bone.parent
            above = {"parent_matrix": posed[parent.name], "parent_matrix_local": parent.matrix_local} if parent else {}
            own = ob.pose.bones[bone.name].matrix_basis
            matrix = bone.convert_local_to_pose(own, bone.matrix_local, **above)
            turn, shift = driven.get(bone.name), bone.name == pelvis and shifts is not None
            if turn is not None or shift:
                turned = matrix.to_quaternion()
                if turn is not None:
                    turned = Quaternion(plane.out, float(turn.angles[k])) @ turn.swing @ bone.matrix_local.to_quaternion()
                place = matrix.translation + (shifts[k] if shift else Vector())
                matrix = Matrix.LocRotScale(place, turned, matrix.to_scale())
                result[bone.name] = bone.convert_local_to_pose(matrix, bone.matrix_local, invert=True, **above)
            posed[bone.name] = matrix
        along = lambda name, share: posed[name] @ Vector((0, ob.data.bones[name].length * share, 0))  # noqa: E731
        yield result, min(along(*table[ankle]).dot(plane.up) for ankle in ANKLES)


def _shifts(ob, postures: np.ndarray, plane: Plane) -> list[Vector]:
    """Shifts of the pelvis since the first posture, at the armature's size."""
    bones, table = armatures.bones_of(ob), key_points.table_of(ob)
    places = [_place(table[point], bones) for point in ("pelvis", "chest", "neck")]
    own = sum(float(np.linalg.norm(b - a)) for a, b in zip(places, places[1:]))
    ways = np.linalg.norm(np.diff(postures[:, :3], axis=1), axis=2).sum(1)
    scale = own / max(float(np.median(ways)), 1e-9)
    moved = (postures[:, 0] - postures[0, 0]) * scale
    return [plane.right * float(x) - plane.up * float(y) for x, y in moved]


def channels(ob, found: list[dict[str, Matrix]], move: bool) -> dict[tuple[str, int], np.ndarray]:
    """Values of the driven bones' channels by data path and index."""
    curves: dict[tuple[str, int], np.ndarray] = {}
    for name in found[0]:
        bone = ob.pose.bones[name]
        mode = bone.rotation_mode
        path, width = _PATHS.get(mode, ("rotation_euler", 3))
        rows, before = [], None
        for matrices in found:
            turned = matrices[name].to_quaternion()
            if before is not None:
                turned.make_compatible(before)
            before = turned
            rows.append(_written(turned, mode, rows))
        base = bone.path_from_id()
        values = np.array(rows)
        for index in range(width):
            curves[f"{base}.{path}", index] = values[:, index]
        if move and name == key_points.table_of(ob)["pelvis"][0] and not bone.bone.use_connect:
            places = np.array([matrices[name].translation for matrices in found])
            for index in range(3):
                curves[f"{base}.location", index] = places[:, index]
    return curves


def _written(turned: Quaternion, mode: str, before: list):
    if mode == "QUATERNION":
        return tuple(turned)
    if mode == "AXIS_ANGLE":
        axis, angle = turned.to_axis_angle()
        return (angle, *axis)
    return tuple(turned.to_euler(mode, Euler(before[-1], mode)) if before else turned.to_euler(mode))
