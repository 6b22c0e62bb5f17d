"""What is wrong with a field of a document, in the words of the command line: what was found, and what was expected."""

from __future__ import annotations

import json
from typing import Any

from ..blender.errors import Problem

MOST = 40
"""Most characters of a value that a message shows."""


def wrong(field: str, found: Any, expected: str) -> Problem:
    """A `Problem` with a field's value. `None` stands for a field that is missing."""
    return Problem(f"{field}: found {_described(found)}, expected {expected}")


def _described(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list) and len(value) > 3:
        return f"a list of {len(value)}"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= MOST else text[:MOST] + "…"
