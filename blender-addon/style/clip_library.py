"""A library of skeleton clips: its folder, its clips, its damaged files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from rototoon.style import KEY_POINTS, Found, Skeleton, add_files_to_library, read_library, skeleton_of

from ..blender.errors import Problem
from ..blender.preferences import preferences
from ..common.wording import counted
from . import bodies

ENDING = ".clip.json"
"""Ending of the names of clip files."""


@dataclass
class Row:
    """A clip of a library, or a damaged file."""

    character: str
    motion: str
    frames: int = 0
    fps: float = 25.0
    source: str = ""
    file: str = ""
    trouble: str = ""
    """Why the clip cannot be used; empty if it can."""
    postures: np.ndarray = field(default_factory=lambda: np.zeros((0, 17, 2)))
    """Key points (frames, key points of the body, 2), at the rate of the library."""
    rate: float = 25.0
    """Frames per second of the postures; `fps` is that of the file."""
    body: Skeleton | None = None
    """The body of the clip; `None` if the clip cannot be used."""

    @property
    def human(self) -> bool:
        """Whether the clip is of a human, from whom styles are learned and whom bones follow."""
        return self.body is not None and self.body.points == KEY_POINTS


@dataclass
class Shelf:
    """A library that was read."""

    folder: str
    rows: list[Row]
    troubles: list[str]
    """Other damage, such as a damaged index."""

    def find(self, character: str, motion: str) -> Row | None:
        """The clip with a character and a motion."""
        good = (row for row in self.rows if not row.trouble)
        return next((row for row in good if (row.character, row.motion) == (character, motion)), None)

    def motions(self, character: str = "", human: bool = False) -> list[str]:
        """The motions, or those of one character; with `human` those of humans only."""
        return sorted({row.motion for row in self._usable(human) if character in ("", row.character)})

    def characters(self, motion: str = "", human: bool = False) -> list[str]:
        """The characters, or those with one motion; with `human` humans only."""
        return sorted({row.character for row in self._usable(human) if motion in ("", row.motion)})

    def _usable(self, human: bool) -> list[Row]:
        return [row for row in self.rows if not row.trouble and (row.human or not human)]


def folder_of(ob, chosen: str = "") -> str:
    """The library's folder: `chosen` if it is given, otherwise the object's, otherwise that of the preferences."""
    folder = chosen or (ob.rototoon.clips_folder if ob is not None else "") or preferences().clips_folder
    if not folder:
        raise Problem("No library chosen: choose its folder in the panel Style")
    if folder.startswith("//") and not bpy.data.filepath:
        raise Problem(f"The library {folder} is relative to a file that is not saved: choose it again")
    return os.path.normpath(os.path.expanduser(bpy.path.abspath(folder)))


def read(folder: str) -> Shelf:
    """Reads a library. Damaged files do not affect other files."""
    found = read_library(folder)
    file = found.clips or {}
    clips = {(clip["character"], clip["motion"]): clip | {"skeleton": skeleton_of(file, clip)} for clip in file.get("clips", [])}
    troubles = list(found.troubles)
    rows = [_row(folder, entry, clips, troubles) for entry in found.entries]
    for row in rows:
        row.rate = (found.clips or {}).get("fps", row.rate)
    known = {row.file for row in rows}
    for trouble in list(troubles):
        file = _file_of(folder, trouble)
        if file and file not in known:
            known.add(file)
            troubles.remove(trouble)
            rows.append(Row(file.removesuffix(ENDING), "", file=file, trouble=trouble))
    rows.sort(key=lambda row: (bool(row.trouble), row.character.lower(), row.motion.lower()))
    return Shelf(folder, rows, troubles)


def add(folder: str, files: Sequence[tuple[dict[str, Any], str]], replace: bool) -> int:
    """Adds files of clips, each with its source, to a library. Returns how many clips of the same character and motion they replaced.

    Without `replace`, such a clip is an error, and nothing is added: it may be another shot's, or a colleague's. The core looks for it
    under the library's lock, so that of two who save the same clip at once one gets the error.
    """
    return len(add_files_to_library(folder, files, replace))


def replaced(count: int) -> str:
    """The end of a message about clips that were replaced; empty if there are none."""
    return f"; replaced {counted(count, 'clip')} of the same character and motion" if count else ""


def _row(folder: str, entry: dict[str, Any], clips: dict[tuple[str, str], Any], troubles: list[str]) -> Row:
    row = Row(**{name: entry[name] for name in ("character", "motion", "frames", "fps", "source", "file")})
    clip = clips.get((row.character, row.motion))
    if clip is not None:
        row.postures, row.body = np.array(clip["points"], np.float64), bodies.named(clip["skeleton"])
        return row
    mine = [trouble for trouble in troubles if _file_of(folder, trouble) == row.file]
    row.trouble = mine[0] if mine else f"{row.file}: cannot be read"
    for trouble in mine:
        troubles.remove(trouble)
    return row


def _file_of(folder: str, trouble: str) -> str:
    """The clip file in the folder that a message is about; "" if it is about none."""
    start = os.path.join(folder, "")
    name, found, _ = trouble.removeprefix(start).partition(f"{ENDING}:")
    return name + ENDING if found and trouble.startswith(start) and not any(c in name for c in "/\\:") else ""


def clip_of(folder: str, character: str, motion: str) -> tuple[dict[str, Any], dict[str, str]]:
    """A clip of a library at its own frame rate, and the options that choose it. Raises a `Problem` that names what is missing."""
    found = read_library(folder, character, motion, exact=True)
    if found.clips["clips"]:
        return found.clips, {"character": character, "motion": motion}
    refuse_damaged(folder, found)
    names = [(clip["character"], clip["motion"]) for clip in clips_of(folder)["clips"]]
    mine = sorted({own for who, own in names if who == character})
    others = sorted({who for who, own in names if own == motion})
    has = f'"{character}" has {_quoted(mine)}' if mine else f'{_quoted(others)} {"has" if len(others) == 1 else "have"} it' if others else ""
    has = f"; {has}" if has else ""
    raise Problem(f'The library {folder} has no clip "{motion}" by "{character}"{has}: choose one of its {counted(len(names), "clip")}')


def refuse_damaged(folder: str, found: Found) -> None:
    """Raises a `Problem` that says what is wrong with a file that was asked for, if one cannot be used."""
    files = [entry["file"] for entry in found.entries]
    for trouble in found.troubles:
        if _file_of(folder, trouble) in files:
            raise Problem(trouble)


def _quoted(names: list[str], most: int = 4) -> str:
    said = [f'"{name}"' for name in names[:most]]
    return ", ".join(said + ([f"{len(names) - most} more"] if len(names) > most else []))


def clips_of(folder: str, rate_of: tuple[str, str] | None = None) -> dict[str, Any]:
    """All clips of a library as a file of clips, at the frame rate of one of them (`rate_of`). Raises a `Problem` if there are none."""
    found = read_library(folder, rate_of=rate_of)
    if not found.entries:
        raise Problem(f"The library {folder} has no clips: save one first")
    return found.clips
