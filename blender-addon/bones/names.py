"""Guesses the bones of the skeleton's key points from the names of bones.

Bones are named after the limb that they move (upper arm, thigh) or after the joint at their head (elbow, knee), with the side before
or after. The names of Rigify, Mixamo, motion capture files, game engines and others are known. A key point is at a place along a
bone: 0 is the head, 1 the tail.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from ..blender.armatures import Bone

Table = dict[str, tuple[str, float]]
"""By key point the name of a bone, and the place along it."""

SIDES = {"l": "l", "left": "l", "r": "r", "right": "r"}
LIMBS = {
    "shoulder": ("upperarm", "uparm", "arm", "humerus", "shoulder"),
    "elbow": ("forearm", "lowerarm", "lowarm", "elbow", "radius"),
    "wrist": ("hand", "wrist"),
    "hip": ("thigh", "upleg", "upperleg", "femur", "hip"),
    "knee": ("shin", "calf", "lowerleg", "lowleg", "leg", "knee", "tibia"),
    "ankle": ("foot", "ankle"),
}
"""By key point the names of the bone whose head it is, the most certain first."""
MIDDLE = {
    "pelvis": ("hips", "pelvis", "hip", "spine", "spine00", "spine1"),
    "neck": ("neck", "neck1", "neck01", "neck001", "spine004"),
    "head": ("head", "spine006", "spine005"),
}
BEFORE = {"wrist": "elbow", "ankle": "knee"}
"""If no bone begins at a key point, it is the tail of the bone of this key point."""
LOW_HEAD = 0.3
"""Place of the head's key point along the head bone, if that bone begins at the neck."""


def plain(name: str) -> tuple[str, str]:
    """The side ("l", "r" or "") and the name without side, prefixes and separators: ("l", "upperarm") for "DEF-upper_arm.L"."""
    name = name.rsplit(":", 1)[-1]
    name = re.sub(r"^(DEF|ORG)[-_.]", "", name)
    name = re.sub(r"^(mixamorig\d*|bip\d*|b|jt)[-_. ]+", "", name, flags=re.IGNORECASE)
    words = [word for word in re.split(r"[-_. ]+|(?<=[a-z])(?=[A-Z])", name) if word]
    words = [word.lower() for word in words]
    if len(words) == 1:
        # "leftarm": a side without a separator.
        found = re.match(r"(left|right)(.+)", words[0])
        words = list(found.groups()) if found else words
    side = next((SIDES[word] for word in words if word in SIDES), "")
    return side, "".join(word for word in words if word not in SIDES)


def guess(bones: Mapping[str, Bone]) -> Table:
    """The key points that can be guessed from the names of bones."""
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
    """Sort key: plain names, then deforming bones, then original bones."""
    return (name.startswith("DEF") + 2 * name.startswith("ORG"), name)


def _finish(table: Table, bones: Mapping[str, Bone]) -> None:
    """Adds key points that follow from others: the top of the head, a neck without a bone, the chest between neck and pelvis."""
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
    """The joint of the spine that is nearest to the middle between pelvis and neck."""
    spine = path(pelvis, bones[neck].parent, bones)
    if not spine:
        return None
    if len(spine) == 1:
        return spine[0], 0.5
    middle = (bones[pelvis].head + bones[neck].head) / 2
    return min(spine[1:], key=lambda name: float(np.linalg.norm(bones[name].head - middle))), 0.0


def path(first: str, last: str, bones: Mapping[str, Bone]) -> list[str]:
    """The chain of bones from `first` to its descendant `last`, with both; empty if `last` is no descendant."""
    found = []
    while last in bones:
        found.append(last)
        if last == first:
            return found[::-1]
        last = bones[last].parent
    return []
