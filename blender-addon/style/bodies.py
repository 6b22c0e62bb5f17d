"""Bodies: the key points of an object's limbs and of clips.

An object's body is the field `skeleton` of its document: the name of a built-in body, or a definition. Without it the body is a human.
"""

from __future__ import annotations

import functools
import json
import os
from typing import Any

from rototoon import RototoonError
from rototoon.style import BODIES, Skeleton, skeleton

from ..blender.errors import Problem
from ..common import kept

HUMAN = BODIES[0]
MOST_BYTES = 10_000_000
"""A larger file is no body."""
_HANGING = ("leg", "limb", "other")
"""Roles of chains that hang on the body."""


@functools.lru_cache(maxsize=64)
def _read(text: str) -> Skeleton:
    return skeleton(json.loads(text))


def named(body: str | dict[str, Any]) -> Skeleton:
    """The body of a name, or of a definition."""
    return _read(json.dumps(body, sort_keys=True))


def of_document(document: dict[str, Any]) -> Skeleton:
    """The body of a document's limbs."""
    return named(document.get("skeleton", HUMAN))


def of(ob) -> Skeleton:
    """The body of an object's limbs."""
    return of_document(kept.fields(ob.rototoon.extra))


def joints(body: Skeleton) -> set[str]:
    """Key points at the end of limbs that carry only the torso: arms, legs and tails hang on these limbs and do not bend with them."""
    torso = {point for chain in body.chains if chain.role == "torso" for point in chain.points}
    return {chain.points[0] for chain in body.chains if chain.role in _HANGING} - torso


def hanging(body: Skeleton) -> set[str]:
    """Key points of arms, legs and tails."""
    return {point for chain in body.chains if chain.role in _HANGING for point in chain.points}


def label(point: str) -> str:
    """A key point's name in menus."""
    sides = {"l_": "Left ", "r_": "Right "}
    side = sides.get(point[:2], "")
    rest = point[2:] if side else point
    words = rest.replace("_", " ")
    return side + (words.title() if words.islower() else words)


def from_file(path: str) -> dict[str, Any] | str:
    """The body that a JSON file holds: a definition, or a document or file of clips with the field `skeleton`."""
    name = os.path.basename(path)
    try:
        with open(path, "rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise Problem(f"{path}: {error.strerror}") from error
    if len(data) > MOST_BYTES:
        raise Problem(f"{name}: found more than {MOST_BYTES} bytes, expected the definition of a body")
    try:
        value = json.loads(data)
    except ValueError as error:
        raise Problem(f"{name}: found no JSON ({error}), expected the definition of a body") from error
    if isinstance(value, dict) and "points" not in value:
        if "skeleton" not in value:
            raise Problem(f"{name}: found neither points nor the field skeleton, expected the definition of a body")
        value = value["skeleton"]
    try:
        named(value)
    except RototoonError as error:
        raise Problem(f"{name}: {error}") from error
    return value
