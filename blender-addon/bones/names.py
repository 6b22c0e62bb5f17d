"""Which bones of an armature tell the key points of the skeleton, by their names. Plain Python.

Bones are called after the limb that they move (upper arm, thigh) or the joint at their head (elbow, knee), with a side before or
behind, by the habits of Rigify, Mixamo, motion capture files, game engines and others. A key point lies on a bone: 0 at its head, 1
at its tail.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from ..blender.armatures import Bone

Table = dict[str, tuple[str, float]]
"""By key point a bone's name, and how far along the bone the point lies."""

SIDES = {"l": "l", "left": "l", "r": "r", "right": "r"}
LIMBS = {
    "shoulder": ("upperarm", "uparm", "arm", "humerus", "shoulder"),
    "elbow": ("forearm", "lowerarm", "lowarm", "elbow", "radius"),
    "wrist": ("hand", "wrist"),
    "hip": ("thigh", "upleg", "upperleg", "femur", "hip"),
    "knee": ("shin", "calf", "lowerleg", "lowleg", "leg", "knee", "tibia"),
    "ankle": ("foot", "ankle"),
}
"""By key point names of the bone whose head it is, the surest first."""
MIDDLE = {
    "pelvis": ("hips", "pelvis", "hip", "spine", "spine00", "spine1"),
    "neck": ("neck", "neck1", "neck01", "neck001", "spine004"),
    "head": ("head", "spine006", "spine005"),
}
BEFORE = {"wrist": "elbow", "ankle": "knee"}
"""Where no bone begins at a key point, the bone before it ends there."""
LOW_HEAD = 0.3
"""How far up the head its key point lies where the neck is its root."""


def plain(name: str) -> tuple[str, str]:
    """Side ("l", "r" or "") and name without side, prefixes and separators: ("l", "upperarm") for "DEF-upper_arm.L"."""
    name = name.rsplit(":", 1)[-1]
    name = re.sub(r"^(DEF|ORG)[-_.]", "", name)
    name = re.sub(r"^(mixamorig\d*|bip\d*|b|jt)[-_. ]+", "", name, flags=re.IGNORECASE)
    words = [word for word in re.split(r"[-_. ]+|(?<=[a-z])(?=[A-Z])", name) if word]
    words = [word.lower() for word in words]
    if len(words) == 1:
        # "leftarm": a side that nothing sets apart.
        found = re.match(r"(left|right)(.+)", words[0])
        words = list(found.groups()) if found else words
    side = next((SIDES[word] for word in words if word in SIDES), "")
    return side, "".join(word for word in words if word not in SIDES)


def guess(bones: Mapping[str, Bone]) -> Table:
    """The key points that the names of some bones tell."""
    known: dict[tuple[str, str], str] = {}
    for name in sorted(bones, key=_rank):
        if not re.match(r"(MCH|VIS|WGT)[-_.]", name):
            known.setdefault(plain(name), name)
    table: Table = {}
    for point, names in MIDDLE.items():
        found = next((known["", name] for name in names if ("", name) in known), None)
        if found is not None and found not in [bone for bone, _ in table.values()]:
            table[point] = (found, 0.0)
    for side in ("l", "r"):
        for point, names in LIMBS.items():
            found = next((known[side, name] for name in names if (side, name) in known), None)
            before = table.get(f"{side}_{BEFORE.get(point)}")
            if found is not None:
                table[f"{side}_{point}"] = (found, 0.0)
            elif before is not None:
                table[f"{side}_{point}"] = (before[0], 1.0)
    _finish(table, bones)
    return table


def _rank(name: str) -> tuple[int, str]:
    """Plain names before those of deforming bones, and these before those of originals."""
    return (name.startswith("DEF") + 2 * name.startswith("ORG"), name)


def _finish(table: Table, bones: Mapping[str, Bone]) -> None:
    """What follows from other key points: the top of the head, a neck that has no bone, the chest between neck and pelvis."""
    if "head" in table:
        head = table["head"][0]
        table["head_top"] = (head, 1.0)
        if "neck" not in table:
            table["neck"], table["head"] = (head, 0.0), (head, LOW_HEAD)
    if "neck" in table and "pelvis" in table:
        chest = _chest(table["pelvis"][0], table["neck"][0], bones)
        if chest is not None:
            table["chest"] = chest


def _chest(pelvis: str, neck: str, bones: Mapping[str, Bone]) -> tuple[str, float] | None:
    """The joint of the spine that is nearest to its middle."""
    spine = path(pelvis, bones[neck].parent, bones)
    if not spine:
        return None
    if len(spine) == 1:
        return spine[0], 0.5
    middle = (bones[pelvis].head + bones[neck].head) / 2
    return min(spine[1:], key=lambda name: float(np.linalg.norm(bones[name].head - middle))), 0.0


def path(first: str, last: str, bones: Mapping[str, Bone]) -> list[str]:
    """The bones from one to another that hangs on it, both included; none where it does not hang on it."""
    found = []
    while last in bones:
        found.append(last)
        if last == first:
            return found[::-1]
        last = bones[last].parent
    return []
