"""Rototoon in Python, without Blender.

The package needs Python 3.11 or newer and its native library, nothing else. Both are in one wheel. After ``pip install``::

    from rototoon import Session

    with Session.open("shot_010/project.json") as session:
        summary = session.track()
        session.pin("near arm", frame=5, point=3, xy=(31.0, 44.5))
        session.track()                                  # solves only the span that the pin touches
        points = numpy.asarray(session.tracks("near arm").points)   # (frames, points, 2), no copy
        session.snap()
        session.save("shot_010/tracked.json")

Coordinates are pixels. x points right, y points down, and the origin is the picture's outer top-left corner: the centre of
a pixel is at +0.5. Frames are the integers of the document. Documents are plain ``dict``s in the form of the project file.

Errors are `RototoonError`. The message names the part, the frame or the field. `Cancelled` means that the work was stopped;
nothing has changed then.

====================  ==============================================================================
`session`             `Session`: track, snap, trace, fill, conform, correct and save a project document
`lines`               traced strokes that `Session` returns
`fills`               clicks of a painter, and painted regions that `Session` returns
`results`             results that `Session` returns
`outcomes`            which tracked contours are sure, doubtful and lost
`strokes`             matching, fitting and hidden lines of strokes, without a session
`tween`               in-betweens of drawings
`style`               skeleton clips, and drawings that follow them
`documents`           helpers for documents, and for files that other programs may write too
`about`               version, path and parameters of the native library
`build`               version of this package
`native`              the native library: loading, handles, errors
====================  ==============================================================================

May import: no other package, and nothing beside Python's standard library.
"""

from . import fills, lines, style, tween
from .about import library_path, parameters, version
from .build import BUILD as __version__
from .native.errors import Cancelled, LibraryError, RototoonError
from .outcomes import outcomes
from .results import Conformed, End, Exchange, Job, Outcome, Outcomes, Summary, Track, Unseen, WeakestFrame
from .session import Session
from .strokes import Guides, Pieces, Strokes, fit_strokes, hidden_lines, match_contours

__all__ = [
    "Cancelled",
    "Conformed",
    "End",
    "Exchange",
    "Guides",
    "Job",
    "LibraryError",
    "Outcome",
    "Outcomes",
    "Pieces",
    "RototoonError",
    "Session",
    "Strokes",
    "Summary",
    "Track",
    "Unseen",
    "WeakestFrame",
    "__version__",
    "fills",
    "fit_strokes",
    "hidden_lines",
    "library_path",
    "lines",
    "match_contours",
    "outcomes",
    "parameters",
    "style",
    "tween",
    "version",
]
