"""Scripting: what scripts need beside the operators, as plain Python functions on objects and NumPy arrays.

    from bl_ext.user_default.rototoon import scripting

    scripting.set_key(ob, 1, {"arm": polygon})        # pixels (N, 2)
    found = scripting.track(ob)                       # found.lost, found.warnings
    points = scripting.tracks(ob)["arm"].pixels       # (F, N, 2)

Frames are scene frames. Pixels are those of the footage: x right, y down, the origin at the outer top-left corner of the picture.
World points are in scene units. Every function takes an object of the current scene, and needs no active object and no window.

Where an operator would report an error, a function raises `RuntimeError` with the same text, and nothing has changed. `keys` writes
keys, `reading` reads contours, `work` tracks, `lines` traces and carries strokes, `paint` paints, `delivered` moves objects to new footage.
`take_reports` gives what operators said.

May import: `rototoon`, `blender`, `common`, `capture`, `lines`, `paint`, `conform`.
"""

from ..common.reports import Report
from ..common.reports import take as take_reports
from .delivered import Moved, conform
from .keys import set_key
from .lines import Drawn, Line, accept_lines, carry_strokes, doubtful_lines, lines, trace_drawing
from .paint import Painted, Recoloured, Region, fill_drawings, fill_region, recolour, recolours, regions, remove_recolour
from .reading import End, Exchange, Part, Track, ends, exchanges, lost_frames, parts, tracks, unseen, wanted_keys, weakest_frame
from .work import Tracked, track

__all__ = [
    "Drawn",
    "End",
    "Exchange",
    "Line",
    "Moved",
    "Painted",
    "Part",
    "Recoloured",
    "Region",
    "Report",
    "Track",
    "Tracked",
    "accept_lines",
    "carry_strokes",
    "conform",
    "doubtful_lines",
    "ends",
    "exchanges",
    "fill_drawings",
    "fill_region",
    "lines",
    "lost_frames",
    "parts",
    "recolour",
    "recolours",
    "regions",
    "remove_recolour",
    "set_key",
    "take_reports",
    "trace_drawing",
    "track",
    "tracks",
    "unseen",
    "wanted_keys",
    "weakest_frame",
]
