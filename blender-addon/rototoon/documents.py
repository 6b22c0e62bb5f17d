"""Helpers for project documents as ``json.load`` gives them, and for files that other programs may write too."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from .native import handles
from .native.arrays import path_text, text


def by_frame(entries: Mapping[str, Any] | None) -> dict[int, Any]:
    """The entries of a field such as ``keys`` by frame number, in time order."""
    return {int(frame): value for frame, value in sorted((entries or {}).items(), key=lambda item: int(item[0]))}


def mark(path: str | os.PathLike[str]) -> str:
    """A mark of what a file holds now, for `replace`. Take it before you read the file. It is empty if there is no file."""
    found: str = handles.take(handles.Text, "rototoon_file_mark", *path_text(path))
    return found


def replace(path: str | os.PathLike[str], content: str, read: str = "") -> str:
    """Writes a text as a file, whole or not at all. Returns the file's mark.

    `read` is the mark from before. If another program wrote the file since, it stays as it is: the text goes into a new file beside it,
    and the `RototoonError` names both. Without a mark the file is replaced, whatever it holds.
    """
    written: str = handles.take(handles.Text, "rototoon_file_replace", *path_text(path), *text(content), *text(read))
    return written
