"""Frames that hold the generated drawing before them, because the footage shows one drawing there.

What: one JSON text on the Grease Pencil data names these frames by layer. Whoever leaves a generated drawing out because the one before it holds
notes it here.

Why so: Blender shows a drawing until the next one, so a layer does not tell a held drawing from a frame that nobody has drawn yet. A document has what
each frame shows, and so *Export Document* must know.

Limits: the frames are those of the footage. They stay where drawings are moved in time or edited: what the layer shows there counts.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

PROPERTY = "rototoon_holds"


def read(data, layer: str) -> set[int]:
    """The frames of a layer that hold the drawing before them."""
    return set(_known(data).get(layer, ()))


def note(data, layer: str, held: Iterable[int], drawn: Iterable[int]) -> None:
    """Notes frames that hold the drawing before them, and others that have a drawing of their own."""
    known = _known(data)
    frames = known.get(layer, set()) - set(drawn) | set(held)
    if frames != known.get(layer, set()):
        _write(data, {**known, layer: frames})


def forget(data, layer: str) -> None:
    """Forgets the frames of a layer."""
    known = _known(data)
    if known.pop(layer, None) is not None:
        _write(data, known)


def _known(data) -> dict[str, set[int]]:
    try:
        kept = json.loads(data.get(PROPERTY, "{}"))
        return {str(name): {int(frame) for frame in frames} for name, frames in kept.items()}
    except (ValueError, TypeError, AttributeError):
        return {}


def _write(data, known: dict[str, set[int]]) -> None:
    kept = {name: sorted(frames) for name, frames in known.items() if frames}
    if kept:
        data[PROPERTY] = json.dumps(kept, separators=(",", ":"))
    elif PROPERTY in data:
        del data[PROPERTY]
