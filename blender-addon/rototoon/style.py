"""Skeleton clips without Blender: captured from contours, kept in a library, re-made in another character's manner, and drawings
that follow them.

This module imports nothing of Blender. Documents and clips are what their JSON files hold::

    from rototoon import style

    made = style.capture_clip(document, "boy", "walk")
    style.add_to_library(folder, made.clips)
    walk = style.translate_clip(style.read_library(folder).clips, style="old", motion="walk", content="boy")
    reshaped = style.reshape(drawing, walk)
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .native import handles
from .native.arrays import as_json, text
from .types import Progress

KEY_POINTS = (
    "pelvis", "chest", "neck", "head", "head_top",
    "l_shoulder", "l_elbow", "l_wrist", "r_shoulder", "r_elbow", "r_wrist",
    "l_hip", "l_knee", "l_ankle", "r_hip", "r_knee", "r_ankle",
)  # fmt: skip
"""Names of the key points, in the order in which clips hold them."""
PARENTS = (0, 0, 1, 2, 3, 2, 5, 6, 2, 8, 9, 0, 11, 12, 0, 14, 15)
"""Where each key point hangs; the pelvis on itself."""


@dataclass(frozen=True)
class Captured:
    """A clip of a document's contours."""

    clips: dict[str, Any]
    """A file of clips with this one."""
    first: int
    """The frame of the first posture."""
    guessed: dict[str, int]
    """Key points that no contour tells on some frames, with the number of these."""


@dataclass(frozen=True)
class Found:
    """Clips of a library."""

    entries: list[dict[str, Any]]
    """What the index says of each: file, character, motion, frames, fps, source."""
    troubles: list[str]
    """What cannot be used; the rest can."""
    clips: dict[str, Any] | None
    """A file of the clips, where they were read."""


@dataclass(frozen=True)
class Reshaped:
    """A drawing on every frame of a clip."""

    document: dict[str, Any]
    """The document with tracks, depths and strokes on every frame."""
    given: list[dict[str, str]]
    """Parts that no limb carries, with the limb (from, to) that each was given: the nearest."""
    rigid: list[str]
    """Parts that move without bending."""
    points: dict[str, list[list[list[float]]]]
    """By part and frame where the points of the option `points` are."""


def capture_clip(
    document: Mapping[str, Any], character: str, motion: str, first: int | None = None, last: int | None = None
) -> Captured:
    """Makes a skeleton clip of tracked contours, by the document's limbs."""
    options = {"character": character, "motion": motion}
    options |= {name: frame for name, frame in (("first", first), ("last", last)) if frame is not None}
    answer = handles.take(handles.Text, "rototoon_capture_clip", *as_json(document), *as_json(options))
    return Captured(**json.loads(answer))


def import_motion(motion: str, character: str, name: str, **options: Any) -> tuple[dict[str, Any], float]:
    """Makes a skeleton clip called `name` of motion capture, the text of a BVH file; a file of clips with it, and the degrees about
    the vertical that it is seen from.

    Options: `view` (``"auto"``, ``"front"``, ``"side"``, ``"three-quarter"`` or degrees, 0 front and 90 side), `up` (``"auto"``, ``"y"``
    or ``"z"``), `joints` (by key point the joint or joints that tell it), `way` (whether the pelvis goes its way), `first` and `last`
    frame from 0, `fps`.
    """
    given = {"character": character, "motion": name, **options}
    made = json.loads(handles.take(handles.Text, "rototoon_import_motion", *text(motion), *as_json(given)))
    return made["clips"], made["yaw"]


def translate_clip(
    clips: Mapping[str, Any], *, style: str, motion: str, content: str, progress: Progress | None = None, **options: Any
) -> dict[str, Any]:
    """Re-makes the `motion` of the character `content` in the manner of the character `style`; a file of clips with it.

    Options: `preset`, `timing` (``"content"`` or ``"style"``), `strength` (0 to 3), `limb_lengths`, `contacts`, `keys` (drawn poses:
    ``[{"frame": 0, "points": [[x, y], ...]}]``), `threads`.
    """
    given = {"style": style, "motion": motion, "content": content, **options}
    with handles.progress_callback(progress) as callback:
        arguments = (*as_json(clips), *as_json(given), callback, None)
        return json.loads(handles.take(handles.Text, "rototoon_translate_clip", *arguments))


def reshape(
    document: Mapping[str, Any], clips: Mapping[str, Any], progress: Progress | None = None, **options: Any
) -> Reshaped:
    """Makes a drawing follow a clip.

    Options: `character` and `motion` choose the clip where there are several; `rest`, the frame of the drawing; `sub_keys`, points of
    each limb between its key points that hold its shape; `points`, by closed part further points that follow it; `threads`.
    """
    with handles.progress_callback(progress) as callback:
        arguments = (*as_json(document), *as_json(clips), *as_json(options), callback, None)
        return Reshaped(**json.loads(handles.take(handles.Text, "rototoon_reshape", *arguments)))


def add_to_library(folder: str, clips: Mapping[str, Any], source: str = "") -> None:
    """Adds clips to the library of a folder, in place of those of the same character and motion."""
    handles.call("rototoon_library_add", *text(folder), *as_json(clips), *text(source))


def read_library(folder: str, character: str = "", motion: str = "", read: bool = True) -> Found:
    """The clips of a library whose character and motion hold these words; with `read` false only what the index says."""
    wanted = {"character": character, "motion": motion, "read": read}
    return Found(**json.loads(handles.take(handles.Text, "rototoon_library_find", *text(folder), *as_json(wanted))))
