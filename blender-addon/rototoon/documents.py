"""Helpers for project documents as ``json.load`` gives them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def by_frame(entries: Mapping[str, Any] | None) -> dict[int, Any]:
    """The entries of a field such as ``keys`` by frame number, in time order."""
    return {int(frame): value for frame, value in sorted((entries or {}).items(), key=lambda item: int(item[0]))}
