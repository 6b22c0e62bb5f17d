"""The reports of the add-on's operators, for scripts: Blender shows reports and prints them, but does not give them to Python."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

MOST = 1000
"""Number of reports that are kept. A script that calls more operators takes them in between."""


@dataclass(frozen=True)
class Report:
    """What one call of an operator said at its end."""

    operator: str
    """Name of the operator, such as ``track``."""
    kind: str
    """``INFO``, ``WARNING`` or ``ERROR``."""
    text: str
    warnings: tuple[str, ...] = ()
    """The parts of the text that need attention: layers that were left out, parts that need a key, pictures that are missing."""


_kept: deque[Report] = deque(maxlen=MOST)


def note(report: Report) -> None:
    """Keeps a report."""
    _kept.append(report)


def take() -> list[Report]:
    """The reports since the last call, the oldest first."""
    found = list(_kept)
    _kept.clear()
    return found
