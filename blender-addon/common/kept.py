"""Texts that files keep in properties. Scripts and other programs may write them too, so what cannot be read counts as missing."""

from __future__ import annotations

import json
from typing import Any


def fields(kept: Any) -> dict[str, Any]:
    """The fields of a JSON object, given as text or as it is."""
    value = kept if isinstance(kept, dict) else _value(kept)
    return dict(value) if isinstance(value, dict) else {}


def pairs(kept: Any, second: type) -> list[tuple[int, Any]]:
    """The pairs of a number and a value of type `second` in a JSON list, given as text or as it is."""
    value = kept if isinstance(kept, list) else _value(kept)
    rows = value if isinstance(value, list) else []
    good = (row for row in rows if isinstance(row, list) and len(row) == 2 and type(row[0]) is int and type(row[1]) is second)
    return [(row[0], row[1]) for row in good]


def rows(kept: Any, *texts: str) -> list[dict[str, Any]]:
    """The objects in a JSON list that have `texts`, each a field with a text."""
    values = kept if isinstance(kept, list) else []
    return [each for each in values if isinstance(each, dict) and all(isinstance(each.get(name), str) for name in texts)]


def _value(text: Any) -> Any:
    try:
        return json.loads(text) if text else None
    except (ValueError, TypeError, RecursionError):
        return None
