"""Frames on which a part is hidden: it has no contour there. The part keeps them with the fields of its document."""

from __future__ import annotations

import json
from collections.abc import Iterable

from ..common import kept

FIELD = "absent"
"""Its field in documents: a list of the first and the last picture of each time."""


def of(part) -> list[list[int]]:
    """First and last picture number of each time in which a part of an object's list is hidden."""
    return [[first, last] for first, last in kept.pairs(kept.fields(part.extra).get(FIELD, []), int)]


def is_hidden(part, picture: int) -> bool:
    """Whether the part is marked as hidden on a picture. On its keys it is there all the same."""
    return any(first <= picture <= last for first, last in of(part))


def hide(part, pictures: Iterable[int]) -> None:
    """Marks the part as hidden on some pictures. Times that touch become one."""
    joined: list[list[int]] = []
    for first, last in sorted(of(part) + [[picture, picture] for picture in pictures]):
        if joined and first <= joined[-1][1] + 1:
            joined[-1][1] = max(joined[-1][1], last)
        else:
            joined.append([first, last])
    _put(part, joined)


def show(part, first: int, last: int) -> None:
    """Marks the part as there again from picture `first` to `last`."""
    rest = []
    for start, end in of(part):
        if last < start or first > end:
            rest.append([start, end])
            continue
        rest += [[start, first - 1]] if start < first else []
        rest += [[last + 1, end]] if end > last else []
    _put(part, rest)


def time_of(part, picture: int) -> tuple[int, int] | None:
    """First and last picture of the time around `picture` in which the part is hidden."""
    return next(((first, last) for first, last in of(part) if first <= picture <= last), None)


def _put(part, times: list[list[int]]) -> None:
    extra = kept.fields(part.extra)
    extra.pop(FIELD, None)
    if times:
        extra[FIELD] = times
    part.extra = json.dumps(extra) if extra else ""
