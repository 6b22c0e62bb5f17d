"""Which part of an object each part of a result is. Between Send to Farm and Collect Results parts may get other names.

What was sent lists the number of each part, which stays with a part as long as the object has it. Numbers and names are held against the keys: a part
whose keys are as they were sent is the one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..exchange.fields import wrong

Entry = Mapping[str, Any]


@dataclass
class Matched:
    """A result for the parts of an object."""

    entries: dict[str, Entry]
    """By the name that a part of the object has now, its part of the result."""
    names: dict[str, str]
    """By the name in the result, the name that the part has now."""
    left: list[str]
    """Parts of the result with contours that no part of the object is."""
    without: list[str]
    """Parts of the object of which the result has nothing."""


def match(
    sent: Sequence[Entry], numbers: Mapping[str, int], now: Mapping[str, Entry], known: Mapping[str, int], same: Callable[[Entry, Entry], Any]
) -> Matched:
    """Finds the parts of a result among the parts `now`. `numbers` are those that its parts had by name, and `known` those that the parts have now. `same`
    says whether keys are as they were sent."""
    of_number = {number: name for name, number in numbers.items()}
    left = {entry["name"]: entry for entry in sent}
    found: dict[str, str] = {}
    likely = [(name, old) for name in now for old in (of_number.get(known.get(name)), name) if old in left]
    every = [(name, old) for name in now for old in left]
    for pairs, proven in ((likely, True), (every, True), (likely, False)):
        for name, old in pairs:
            if name not in found and old not in found.values() and (not proven or same(left[old], now[name])):
                found[name] = old
    return Matched(
        {name: left[old] for name, old in found.items()},
        {old: name for name, old in found.items()},
        [old for old, entry in left.items() if old not in found.values() and entry.get("tracks")],
        [name for name in now if name not in found],
    )


def numbers_of(entry: Mapping[str, Any], place: str) -> dict[str, int]:
    """The numbers of parts in the list of what was sent. Lists of older versions have none."""
    numbers = entry.get("parts", {})
    if not isinstance(numbers, dict) or not all(type(number) is int for number in numbers.values()):
        raise wrong(f"{place}.parts", numbers, "the numbers of parts by their names")
    return numbers
