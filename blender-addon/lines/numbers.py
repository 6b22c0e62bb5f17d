"""Numbers of strokes: the library counts from 0 in each run; a layer keeps a number for each stroke, on all frames.

A stroke's key is (layer, number). The library's strokes of the first drawing get the keys that they have there. From there the keys
go with the library's numbers, forwards and backwards. On a later drawing of the artist, a stroke that has a key already keeps it, and
takes it on to the frames after. So a decision of the artist holds from its frame on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

Key = tuple[str, int]
"""Layer, and number on that layer. A stroke of the artist without a number has 0."""


def keyed(
    tracks: Mapping[int, Sequence[int]],
    drawn: Mapping[int, Sequence[Key]],
    fresh: Callable[[str], Key],
    home: str,
) -> dict[int, list[Key]]:
    """By frame the key of each stroke.

    `tracks` are the library's numbers of the strokes by frame. `drawn` are the artist's drawings: the keys of their strokes, in the
    same order. `fresh(layer)` gives a new key on a layer. New strokes are put on the layer `home`.
    """
    frames = sorted(tracks)
    start = min(drawn, default=frames[0] if frames else 0)
    first: dict[int, Key] = {}
    found: dict[int, list[Key]] = {}
    _walk([f for f in frames if f >= start], tracks, drawn, fresh, home, first, found, start)
    backwards = dict(first)
    _walk([f for f in reversed(frames) if f < start], tracks, drawn, fresh, home, backwards, found, None)
    return found


def _walk(frames, tracks, drawn, fresh, home, known: dict[int, Key], found: dict[int, list[Key]], start: int | None) -> None:
    """Follows the keys from frame to frame. `known` ends as it was on frame `start`; other frames do not change it there."""
    now = known
    for frame in frames:
        own = drawn.get(frame)
        if own is not None:
            now.update(_of_drawn(tracks[frame], own, now, fresh))
            taken = set(own)
            for track in [t for t, key in now.items() if key in taken and t not in tracks[frame]]:
                del now[track]
        for track in tracks[frame]:
            if track not in now:
                now[track] = fresh(home)
        found[frame] = [now[track] for track in tracks[frame]]
        if frame == start:
            now = dict(known)


def _of_drawn(tracks: Sequence[int], own: Sequence[Key], now: Mapping[int, Key], fresh: Callable[[str], Key]) -> dict[int, Key]:
    """The keys of a drawing's strokes: their own, else the carried one if no other stroke has it, else a new one."""
    taken: set[Key] = set()
    result: dict[int, Key] = {}
    for track, key in zip(tracks, own, strict=True):
        # A copied stroke has its original's number; the second one counts as a new stroke.
        if key[1] and key not in taken:
            result[track] = key
            taken.add(key)
    for track, (layer, _) in zip(tracks, own, strict=True):
        if track in result:
            continue
        carried = now.get(track)
        result[track] = carried if carried is not None and carried[0] == layer and carried not in taken else fresh(layer)
        taken.add(result[track])
    return result


class Counter:
    """New keys by layer."""

    def __init__(self, next_tracks: Mapping[str, int]):
        self._next = dict(next_tracks)

    def __call__(self, layer: str) -> Key:
        """A new key on a layer."""
        number = self._next.get(layer, 1)
        self._next[layer] = number + 1
        return layer, number
