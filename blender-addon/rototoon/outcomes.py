"""What became of tracked parts: the one formula of the core, for callers that hold the tracks themselves."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from .native import handles
from .native.arrays import as_json
from .results import Exchange, Outcome, Outcomes, WeakestFrame


def outcomes(parts: Iterable[Mapping[str, Any]], exchanges: Iterable[Exchange] = ()) -> Outcomes:
    """Which contours of some parts are sure, doubtful and lost, and where the next key helps most.

    A part is ``{"keys": [frame, ...], "confidence": {frame: mean, ...}, "wants_key": [frame, ...]}``. The means are those of
    the confidence of its points. `wants_key` are the frames beyond its track on which it was lost; it may be left out.
    `exchanges` are parts that may have changed places; the answer has words for them.
    """
    asked = [
        {
            "keys": [int(frame) for frame in part["keys"]],
            "confidence": {str(int(frame)): float(mean) for frame, mean in part["confidence"].items()},
            "wants_key": [int(frame) for frame in part.get("wants_key", ())],
        }
        for part in parts
    ]
    pairs = [{"parts": list(pair.parts), "frames": [int(frame) for frame in pair.frames]} for pair in exchanges]
    found = json.loads(handles.take(handles.Text, "rototoon_outcomes", *as_json({"parts": asked, "exchanges": pairs})))
    weakest = found["weakest"] and WeakestFrame(found["weakest"]["frame"], found["weakest"]["score"])
    return Outcomes([Outcome(**part) for part in found["parts"]], weakest, found["exchanges"])
