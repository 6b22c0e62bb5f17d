"""Numbers of strokes that stay the same on all keys of a layer, and when a span is drawn again.

A stroke passes its number to its counterpart on the next key. If a span was not matched again, equal numbers are its pairs.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

Pairs = Iterable[tuple[int, int]]


def numbered(known: list[np.ndarray], matched: dict[int, Pairs], fresh: int) -> tuple[list[np.ndarray], int]:
    """The numbers of the strokes of all keys, and the next free number.

    `known` are the current numbers, 0 for none. `matched` are the matched pairs of strokes by span. `fresh` is a number that was
    never used.
    """
    fresh = max([fresh, *(int(each.max()) + 1 for each in known if len(each))])
    result: list[np.ndarray] = []
    for key, own in enumerate(known):
        numbers = np.zeros_like(own)
        if key:
            for i, j in _pairs(known[key - 1], own, matched.get(key - 1)):
                numbers[j] = result[key - 1][i]
        taken = set(numbers.tolist()) | (set(result[key - 1].tolist()) if key else set())
        for j in np.flatnonzero(numbers == 0):
            number = int(own[j])
            if number <= 0 or number in taken:
                number, fresh = fresh, fresh + 1
            numbers[j] = number
            taken.add(number)
        result.append(numbers)
    return result, fresh


def _pairs(before: np.ndarray, own: np.ndarray, matched: Pairs | None) -> Pairs:
    if matched is not None:
        return matched
    places = {int(number): i for i, number in reversed(list(enumerate(before))) if number > 0}
    seen: set[int] = set()
    found = []
    for j, number in enumerate(own.tolist()):
        if number in places and number not in seen:
            seen.add(number)
            found.append((places[number], j))
    return found
