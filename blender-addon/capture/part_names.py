"""Names of parts in fields of an object's document that are only kept: limbs, marks of what is in front, what parts follow, reshaped keys.

These fields know parts by their names. So they change with the name of a part, and what names a part that is not there is left out: the
document would be of no use with it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable
from functools import partial
from typing import Any

from ..common import kept

_PAIRS = {"depth_marks": ("front", "behind"), "follows": ("part", "of")}
NAMED = 4
"""Largest number of things that a message names."""


def renamed(part) -> None:
    """Gives a part's new name to the fields of its object's document. Called when the name has changed."""
    before, part.known_as = part.known_as, part.name
    settings = part.id_data.rototoon
    if not before or before == part.name or not settings.extra:
        return
    fields = kept.fields(settings.extra)
    changed, _ = _mapped(fields, lambda name: part.name if name == before else name)
    if changed != fields:
        settings.extra = json.dumps(changed)


def remember(ob) -> None:
    """Notes the names of parts of a file that an older version wrote."""
    for part in ob.rototoon.parts:
        if not part.known_as:
            part.known_as = part.name


def among(fields: dict[str, Any], names: Collection[str]) -> tuple[dict[str, Any], list[str]]:
    """A document's fields without what names a part that is not among `names`, and that in words."""
    return _mapped(fields, lambda name: name if name in names else None)


def drop(ob, gone: Collection[str]) -> str:
    """Takes out of an object's document what names parts that are gone. Returns it in words; empty if there is none."""
    fields = kept.fields(ob.rototoon.extra)
    left, lost = _mapped(fields, lambda name: None if name in gone else name)
    if left != fields:
        ob.rototoon.extra = json.dumps(left)
    return listed(lost)


def listed(lost: Iterable[str]) -> str:
    """What was left out, as text."""
    said = list(lost)
    if len(said) > NAMED:
        said[NAMED:] = [f"{len(said) - NAMED} more"]
    return ", ".join(said)


def _mapped(fields: dict[str, Any], name_of: Callable[[str], str | None]) -> tuple[dict[str, Any], list[str]]:
    """Fields with other names of parts. What names a part whose new name is `None` is left out; returns that in words."""
    made, lost = dict(fields), []
    ways = {"limbs": _limb, **{field: partial(_named, ends=ends) for field, ends in _PAIRS.items()}}
    for field, way in ways.items():
        if isinstance(fields.get(field), list):
            # What is no object stays, for those who read it to say so.
            rows = [(row, way(row, name_of=name_of) if isinstance(row, dict) else row) for row in fields[field]]
            made[field] = [new for row, new in rows if new is not None or row is None]
            lost += [_told(row) for row, new in rows if new is None and row is not None]
    if isinstance(fields.get("reshaped"), dict):
        made["reshaped"] = {name_of(name): keys for name, keys in fields["reshaped"].items() if name_of(name) is not None}
    return made, lost


def _named(row: Any, ends: Iterable[str], name_of: Callable[[str], str | None]) -> Any:
    """A field's entry with other names; `None` if it is left out."""
    if not isinstance(row, dict):
        return row
    new = {end: name_of(row[end]) for end in ends if isinstance(row.get(end), str)}
    return None if None in new.values() else {**row, **new}


def _limb(limb: Any, name_of: Callable[[str], str | None]) -> Any:
    """A limb with other names; `None` if a point of it is left out. It no longer carries parts that are."""
    made = dict(limb)
    for end in ("start", "end"):
        points = limb[end].get("points") if isinstance(limb.get(end), dict) else None
        if isinstance(points, list):
            new = [_named(point, ("part",), name_of) for point in points]
            if None in new:
                return None
            made[end] = {**limb[end], "points": new}
    if isinstance(limb.get("carries"), list):
        parts = [name_of(each) if isinstance(each, str) else _named(each, ("part",), name_of) for each in limb["carries"]]
        made["carries"] = [part for part in parts if part is not None]
    return made


def _told(row: dict[str, Any]) -> str:
    if "from" in row:
        return f"limb {row['from']} to {row.get('to')}"
    if "front" in row:
        return f'"{row["front"]}" in front of "{row.get("behind")}"'
    return f'"{row.get("part")}" follows "{row["of"]}"' if "of" in row else f'what "{row.get("part")}" follows'
