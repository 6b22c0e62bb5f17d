"""Project documents as files: reading and checking, writing, and fields that the add-on does not know."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from rototoon import LibraryError, RototoonError, Session

from ..blender.errors import Problem
from ..blender.footage import HELD
from ..capture.document import VERSION
from ..common.wording import counted
from .fields import wrong

_FOOTAGE = {"pattern", "first", "last", "fps", "width", "height", "gaps"}
_PART = {"name", "closed", "depth", "keys", "pins", "centers", "tracks", "confidence", "curves", "wants_key"}
_TOP = {"rototoon", "footage", "parts", "drawings", "pairs", "traced", "in_betweens", "matches", "palette", "fills", "filled", "recolours"}


def load(path: str) -> dict[str, Any]:
    """Reads a document from a file, and checks all fields from which strokes are made."""
    try:
        # Editors on Windows put a mark before the text.
        with open(path, encoding="utf-8-sig") as file:
            document = json.load(file)
    except OSError as error:
        raise Problem(f"Cannot read {path}: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise Problem(f"{path} is not a project document: {error}") from error
    try:
        check(document)
    except Problem as problem:
        raise Problem(f"{path}: {problem}") from None
    _check_all(path)
    for part in document.get("parts", []):
        part.setdefault("closed", True)
    return document


MOST_TOLD = 3
"""Most problems of a file that a message lists."""


def _check_all(path: str) -> None:
    """Raises a `Problem` with what the library, which knows every rule, finds wrong in a file.

    Without a library, `check` must do.
    """
    try:
        Session.open(path).close()
    except LibraryError:
        return
    except RototoonError as error:
        found = [line.removeprefix(f"{path}: ") for line in str(error).splitlines()]
        told = "; ".join(found[:MOST_TOLD])
        more = f"; and {len(found) - MOST_TOLD} more" if len(found) > MOST_TOLD else ""
        raise Problem(f"{path}: {told}{more}") from None


def check(document: Any) -> None:
    """Raises a `Problem` that names the field if `document` does not have the form of a project document."""
    version = document.get("rototoon") if isinstance(document, dict) else None
    if not isinstance(version, (int, float)):
        raise wrong("rototoon", version, f"the version {VERSION}: this is not a project document")
    # A newer minor version has more fields, which are kept.
    if not VERSION <= version < VERSION + 1:
        raise wrong("rototoon", version, f"the version {VERSION}: a newer Rototoon wrote it, so update the extension")
    shot = document.get("footage")
    if not isinstance(shot, dict):
        raise wrong("footage", shot, "an object with pattern, first, last, fps, width and height")
    if not isinstance(shot.get("pattern"), str):
        raise wrong("footage.pattern", shot.get("pattern"), "a file name pattern")
    for name in ("first", "last", "width", "height"):
        if not isinstance(shot.get(name), int):
            raise wrong(f"footage.{name}", shot.get(name), "a whole number")
    if shot.get("gaps", HELD) != HELD:
        raise wrong("footage.gaps", shot["gaps"], f'"{HELD}", or no such field')
    if not isinstance(document.get("parts", []), list):
        raise wrong("parts", document["parts"], "a list of parts")
    _check_palette(document.get("palette", {}))
    names = set()
    for index, part in enumerate(document.get("parts", [])):
        _check_part(f"parts[{index}]", part, names)


def _check_palette(palette: Any) -> None:
    if not isinstance(palette, dict):
        raise wrong("palette", palette, "an object with a colour for each name")
    for name, colour in palette.items():
        shares = isinstance(colour, list) and len(colour) == 3 and all(isinstance(share, (int, float)) and 0 <= share <= 1 for share in colour)
        if not shares:
            raise wrong(f"palette.{name}", colour, "a colour: three numbers from 0 to 1")


def _check_part(place: str, part: Any, names: set[str]) -> None:
    if not isinstance(part, dict):
        raise wrong(place, part, "a part: an object with name and keys")
    if not isinstance(part.get("name"), str):
        raise wrong(f"{place}.name", part.get("name"), "a name")
    if part["name"] in names:
        raise wrong(f"{place}.name", part["name"], "another name: an earlier part has this one")
    names.add(part["name"])
    first = None
    for field in ("keys", "tracks"):
        for frame, points in _frames(place, field, part.get(field)):
            on = f"{place}.{field}[{frame}]"
            array = _points(on, points)
            first = first or (on, len(array))
            if len(array) != first[1]:
                raise Problem(f"{on}: found {counted(len(array), 'point')}, expected {first[1]} as in {first[0]}")
    for field in ("pins", "centers", "confidence", "curves"):
        list(_frames(place, field, part.get(field)))


def _frames(place: str, field: str, entries: Any):
    if entries is None:
        return
    if not isinstance(entries, dict):
        raise wrong(f"{place}.{field}", entries, "an object with frame numbers as keys")
    for frame, value in entries.items():
        try:
            yield int(frame), value
        except ValueError:
            raise wrong(f"{place}.{field}", frame, 'a frame number such as "11"') from None


def _points(place: str, points: Any) -> np.ndarray:
    try:
        array = np.asarray(points, np.float64)
    except (TypeError, ValueError):
        array = None
    if array is None or array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise wrong(place, points, "a list of points [x, y] of finite numbers")
    return array


def unknown(entry: Mapping[str, Any], known: set[str]) -> str:
    """The fields that are not in `known`, as JSON; empty if there are none."""
    rest = {name: value for name, value in entry.items() if name not in known}
    return json.dumps(rest) if rest else ""


def unknown_of_document(document: Mapping[str, Any]) -> str:
    """The unknown fields of the document and of its footage."""
    rest = {name: value for name, value in document.items() if name not in _TOP}
    shot = {name: value for name, value in document["footage"].items() if name not in _FOOTAGE}
    if shot:
        rest["footage"] = shot
    return json.dumps(rest) if rest else ""


def unknown_of_part(entry: Mapping[str, Any]) -> str:
    """The unknown fields of a part."""
    return unknown(entry, _PART)


MOST_UP = 3
"""Greatest number of folders up in a relative path."""


def _near(pattern: str, folder: str) -> str:
    """A pattern relative to a folder, or the absolute one if it is far away."""
    try:
        near = os.path.relpath(pattern, os.path.abspath(folder))
    except ValueError:
        # Two drives of Windows.
        return pattern
    return near.replace(os.sep, "/") if near.count("..") <= MOST_UP else pattern


def text(folder: str, document: Mapping[str, Any]) -> str:
    """The text of a document that will be in a folder. If the footage is at most three folders up from there, its path is relative."""
    shot = dict(document["footage"])
    # A relative pattern starts in the document's folder already.
    if os.path.isabs(shot["pattern"]):
        shot["pattern"] = _near(shot["pattern"], folder)
    return json.dumps({**document, "footage": shot}, allow_nan=False, separators=(",", ":")) + "\n"


def put(path: str, content: str) -> None:
    """Writes a file of text. It is complete, or it does not appear. A link stays one, and a file that is replaced keeps its rights, as with the library."""
    target = os.path.realpath(path)
    # Renaming asks only who may write into the folder.
    if os.path.isfile(target) and not (os.access(target, os.W_OK) and os.stat(target).st_mode & 0o222):
        raise Problem(f"Cannot write {path}: it is read-only for this user")
    unfinished = f"{target}.{os.getpid()}.unfinished"
    try:
        with open(unfinished, "w", encoding="utf-8", newline="\n") as file:
            file.write(content)
        if os.path.isfile(target):
            _keep_rights(target, unfinished)
        os.replace(unfinished, target)
    except OSError as error:
        raise Problem(f"Cannot write {path}: {error.strerror}") from error
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)


def _keep_rights(old: str, new: str) -> None:
    """Gives a file the owner, the group and the mode of another one, as far as this user may: in a shared folder others go on to write it."""
    known = os.stat(old)
    if hasattr(os, "chown"):
        try:
            os.chown(new, known.st_uid, known.st_gid)
        except OSError:
            with suppress(OSError):
                os.chown(new, -1, known.st_gid)
    os.chmod(new, stat.S_IMODE(known.st_mode))
