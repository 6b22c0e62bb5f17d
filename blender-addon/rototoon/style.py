"""Skeleton clips: captured from contours, kept in a library, and re-made in another character's style; drawings that follow them.

Documents and clips have the form of their JSON files::

    from rototoon import style

    made = style.capture_clip(document, "boy", "walk")
    style.add_to_library(folder, made.clips)
    walk = style.translate_clip(style.read_library(folder).clips, style="old", motion="walk", content="boy")
    reshaped = style.reshape(drawing, walk)
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
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
"""Names of the key points, in the order of clips."""
PARENTS = (0, 0, 1, 2, 3, 2, 5, 6, 2, 8, 9, 0, 11, 12, 0, 14, 15)
"""The parent of each key point by index. The pelvis is its own parent."""
BODIES = ("human", "quadruped", "bird")
"""The bodies that need no definition."""


@dataclass(frozen=True)
class Chain:
    """A run of key points with a name: a leg, a wing, a tail."""

    name: str
    points: tuple[str, ...]
    role: str
    """How it moves: ``"torso"``, ``"head"``, ``"leg"``, ``"limb"`` or ``"other"``."""


@dataclass(frozen=True)
class Skeleton:
    """A body: its key points, and how they hang together."""

    name: str
    points: tuple[str, ...]
    """Names of the key points, in the order of clips. The first is the root."""
    parents: tuple[int, ...]
    """The parent of each key point by index. The root is its own parent."""
    chains: tuple[Chain, ...]


@dataclass(frozen=True)
class Captured:
    """A clip that was made from the contours of a document."""

    clips: dict[str, Any]
    """A file of clips that contains this clip."""
    first: int
    """The frame of the first posture."""
    guessed: dict[str, int]
    """Key points that had to be filled in, with the number of frames on which no contour shows them."""
    doubts: list[str]
    """What a person should know: contours that limbs hang on and that are lost or doubtful, with their frames, and keys that were changed
    after tracking."""


@dataclass(frozen=True)
class Translated:
    """A clip that was re-made in another character's style."""

    clips: dict[str, Any]
    """A file of clips that contains this clip."""
    notes: list[str]
    """What a person should know about it: which error to expect, or what the library does not tell."""


@dataclass(frozen=True)
class Imported:
    """A clip of motion capture."""

    clips: dict[str, Any]
    """A file of clips that contains this clip."""
    yaw: float
    """The angle about the vertical axis from which it is seen, in degrees."""
    notes: list[str]
    """What a person should know about it: joints that were not taken by their names."""


@dataclass(frozen=True)
class Stance:
    """How the body of a clip stands."""

    looks: str | None
    """The side to which it looks, ``"left"`` or ``"right"``; `None` where it cannot be told."""
    air: list[bool]
    """For each frame whether it is in the air."""


@dataclass(frozen=True)
class Found:
    """Clips of a library."""

    entries: list[dict[str, Any]]
    """Entries of the index: file, character, motion, frames, fps, source."""
    troubles: list[str]
    """What cannot be used, and why. Everything else can be used."""
    clips: dict[str, Any] | None
    """A file of clips; `None` if the clips were not read."""


@dataclass(frozen=True)
class Reshaped:
    """A drawing on every frame of a clip."""

    document: dict[str, Any]
    """The document with tracks, depths and strokes on every frame."""
    given: list[dict[str, str]]
    """Parts that no limb carries: `part`, and in words what it `follows` instead."""
    rigid: list[str]
    """Parts that move without bending."""
    still: list[str]
    """Chains of the drawing's skeleton that no chain of the clip moves."""
    mirrored: bool
    """Whether the clip was mirrored, left for right."""
    looks: dict[str, str | None] | None
    """The sides to which `drawing` and `clip` look, ``"left"`` or ``"right"``, each `None` where it cannot be told. `None` if they did not
    decide whether the clip was mirrored: the option said it, or it is a motion of the drawing itself."""
    notes: list[str]
    """What a person should know beside: a clip of another frame rate, parts that go through the ground, strokes that lie on no part,
    corrections that stay, guesses of the clip, parts that change places with others."""
    points: dict[str, list[list[list[float]]]]
    """Places of the points of the option `points`, by part and frame."""


def skeleton_of(clips: Mapping[str, Any], clip: Mapping[str, Any]) -> str | dict[str, Any]:
    """The body of a clip of a file: the name of a built-in one, or a definition."""
    found: str | dict[str, Any] = clip.get("skeleton", clips.get("skeleton", "human"))
    return found


def skeleton(body: str | Mapping[str, Any]) -> Skeleton:
    """The body of a name, or of a definition. A definition that does not fit together is an error that names the field."""
    whole = json.loads(handles.take(handles.Text, "rototoon_skeleton", *text(json.dumps(body))))
    points = tuple(point["name"] for point in whole["points"])
    parents = tuple(points.index(point.get("parent", points[0])) for point in whole["points"])
    chains = tuple(Chain(chain["name"], tuple(chain["points"]), chain["role"]) for chain in whole["chains"])
    return Skeleton(whole["name"], points, parents, chains)


def stance_of(clips: Mapping[str, Any]) -> Stance:
    """How the body stands in the one clip of a file of clips."""
    return Stance(**json.loads(handles.take(handles.Text, "rototoon_clip_stance", *as_json(clips))))


def capture_clip(
    document: Mapping[str, Any], character: str, motion: str, first: int | None = None, last: int | None = None
) -> Captured:
    """Makes a skeleton clip from tracked contours and the document's limbs."""
    options: dict[str, Any] = {"character": character, "motion": motion}
    options |= {name: frame for name, frame in (("first", first), ("last", last)) if frame is not None}
    answer = handles.take(handles.Text, "rototoon_capture_clip", *as_json(document), *as_json(options))
    return Captured(**json.loads(answer))


def import_motion(motion: str, character: str, name: str, **options: Any) -> tuple[dict[str, Any], float]:
    """Makes a skeleton clip called `name` from motion capture. `motion` is the text of a BVH file.

    Returns a file of clips that contains the clip, and the angle about the vertical axis from which it is seen, in degrees.

    Options: `view` (``"auto"``, ``"front"``, ``"side"``, ``"three-quarter"`` or degrees; 0 is the front, 90 the side), `up`
    (``"auto"``, ``"y"`` or ``"z"``), `joints` (for each key point its joint or joints), `way` (whether the pelvis travels), `first`
    and `last` frame, counted from 0, `fps`.
    """
    made = import_and_note(motion, character, name, **options)
    return made.clips, made.yaw


def import_and_note(motion: str, character: str, name: str, **options: Any) -> Imported:
    """Does the same as `import_motion`, with the same options, and returns notes as well."""
    given = {"character": character, "motion": name, **options}
    return Imported(**json.loads(handles.take(handles.Text, "rototoon_import_motion", *text(motion), *as_json(given))))


def translate_clip(
    clips: Mapping[str, Any], *, style: str, motion: str, content: str, progress: Progress | None = None, **options: Any
) -> dict[str, Any]:
    """Re-makes the `motion` of the character `content` in the style of the character `style`. Returns a file of clips.

    Options are those of `translate_and_judge`.
    """
    return translate_and_judge(clips, style=style, motion=motion, content=content, progress=progress, **options).clips


def translate_and_judge(
    clips: Mapping[str, Any], *, style: str, motion: str, content: str, progress: Progress | None = None, **options: Any
) -> Translated:
    """Re-makes the `motion` of the character `content` in the style of the character `style`, and says what the result rests on.

    Options: `preset`, `timing` (``"content"`` or ``"style"``), `strength` (0, the content's own motion, to 3), `limb_lengths`, `contacts`, `keys` (drawn poses:
    ``[{"frame": 0, "points": [[x, y], ...]}]``), `threads`.
    """
    given = {"style": style, "motion": motion, "content": content, "notes": True, **options}
    with handles.progress_callback(progress) as callback:
        arguments = (*as_json(clips), *as_json(given), callback, None)
        return Translated(**json.loads(handles.take(handles.Text, "rototoon_translate_clip", *arguments)))


def reshape(
    document: Mapping[str, Any], clips: Mapping[str, Any], progress: Progress | None = None, **options: Any
) -> Reshaped:
    """Makes a drawing follow a clip.

    Options: `character` and `motion` choose one of several clips. `rest` is the frame of the drawing. `sub_keys` is the number of
    points between the key points of each limb that keep its shape. `chains` are pairs of names: a chain of the clip's skeleton that
    moves a chain of the drawing's, where the skeletons differ (``[["l_arm", "l_foreleg"]]``). `mirror` says whether the clip is
    mirrored: ``"auto"`` (if drawing and clip look to different sides), ``"on"`` or ``"off"``. `points` are more points that
    follow closed parts, by part.
    `threads`.
    """
    with handles.progress_callback(progress) as callback:
        arguments = (*as_json(document), *as_json(clips), *as_json(options), callback, None)
        return Reshaped(**json.loads(handles.take(handles.Text, "rototoon_reshape", *arguments)))


def add_to_library(folder: str, clips: Mapping[str, Any], source: str = "", replace: bool = False) -> list[dict[str, Any]]:
    """Adds clips to the library in a folder, all or none. Returns the entries of clips that they replaced.

    Without `replace`, a clip of the same character and motion is a `RototoonError`, and nothing is added.
    """
    return add_files_to_library(folder, [(clips, source)], replace)


def add_files_to_library(
    folder: str, files: Iterable[tuple[Mapping[str, Any], str]], replace: bool = False
) -> list[dict[str, Any]]:
    """Adds files of clips, each with its source, as `add_to_library` does: the clips of all files, or none."""
    given = [{"clips": clips, "source": source} for clips, source in files]
    arguments = (*text(folder), *as_json(given), *as_json({"replace": replace}))
    replaced: list[dict[str, Any]] = json.loads(handles.take(handles.Text, "rototoon_library_add_files", *arguments))["replaced"]
    return replaced


def read_library(
    folder: str,
    character: str = "",
    motion: str = "",
    read: bool = True,
    exact: bool = False,
    rate_of: tuple[str, str] | None = None,
) -> Found:
    """The clips of a library whose character and motion contain these texts, at one frame rate: that of the clip `rate_of`, a
    character and a motion, else that which most of the clips have.

    With `exact` the texts are the names themselves; an empty one is any name. With `read` false, no clips are returned.
    """
    wanted = {"character": character, "motion": motion, "read": read, "exact": exact, "rate_of": rate_of}
    return Found(**json.loads(handles.take(handles.Text, "rototoon_library_find", *text(folder), *as_json(wanted))))
