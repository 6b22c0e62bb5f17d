#!/usr/bin/env python3
"""Works on a session for a long time, as an artist would: random edits, tracks, snaps, saves, cancels and reopens.

    ROTOTOON_LIBRARY=target/release/librototoon_capi.so target/venv-python/bin/python tests/python/soak.py --minutes 120

It fails where

- the memory of the process grows: after a fifth of the time it may grow by a tenth and 16 MB more,
- a call fails that should not, or a cancelled call changes the document,
- at the end, or whenever the session is opened anew, a fresh session with the same keys and corrections finds another
  result.

It prints the counts of what it did and the memory over time. The seed makes a run repeatable.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from conftest import HEIGHT, LAST, WIDTH, draw, square, write_png  # noqa: E402

from rototoon import Cancelled, RototoonError, Session  # noqa: E402

PARTS = ["red", "blau ü"]


def memory() -> int:
    """Memory of this process in bytes, without what is swapped out."""
    fields = Path("/proc/self/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGE_SIZE")


def first_document() -> dict:
    """The two squares of the tests, keyed on three frames."""
    footage = {"pattern": "frame_%03d.png", "first": 0, "last": LAST, "fps": 25, "width": WIDTH, "height": HEIGHT}
    parts = [
        {"name": name, "closed": True, "depth": 1, "keys": {str(f): square(f, part) for f in (0, 6, 12)}}
        for part, name in enumerate(PARTS)
    ]
    return {"rototoon": 1, "footage": footage, "parts": parts}


def without_results(document: dict) -> dict:
    """The document with what the artist made, and nothing else."""
    made = ("tracks", "confidence", "curves", "wants_key")
    parts = [{name: value for name, value in part.items() if name not in made} for part in document["parts"]]
    return {**document, "parts": parts}


class Artist:
    """Works on a session, and keeps count."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder = folder
        self.random = random.Random(seed)
        self.session = Session.from_document(first_document(), folder)
        self.saved = [first_document()]
        self.counts: dict[str, int] = {}

    def work(self) -> None:
        """Does one random thing."""
        names = ["pin", "unpin", "key", "drop_key", "centre", "clear_centre", "track", "snap", "cancel", "undo", "reopen"]
        name = self.random.choices(names, weights=[8, 3, 3, 3, 2, 1, 8, 2, 2, 2, 1])[0]
        try:
            getattr(self, name)()
        except RototoonError as error:
            # An edit may be impossible, such as a pin on a key. Other errors are defects.
            if isinstance(error, Cancelled) or name in ("track", "snap", "cancel", "undo", "reopen"):
                raise
            name += " (refused)"
        self.counts[name] = self.counts.get(name, 0) + 1

    def somewhere(self) -> tuple[int, str, int]:
        """A part with its index, and a frame."""
        index = self.random.randrange(len(PARTS))
        return index, PARTS[index], self.random.randint(0, LAST)

    def near(self, index: int, frame: int, point: int) -> tuple[float, float]:
        x, y = square(frame, index)[point]
        return x + self.random.uniform(-2, 2), y + self.random.uniform(-2, 2)

    def pin(self) -> None:
        index, part, frame = self.somewhere()
        point = self.random.randrange(4)
        self.session.pin(part, frame, point, self.near(index, frame, point))

    def unpin(self) -> None:
        _, part, frame = self.somewhere()
        self.session.unpin(part, frame, self.random.choice([None, 0, 1, 2, 3]))

    def key(self) -> None:
        index, part, frame = self.somewhere()
        self.session.set_key(part, frame, square(frame, index))

    def drop_key(self) -> None:
        _, part, frame = self.somewhere()
        if frame not in (0, LAST):
            self.session.remove_key(part, frame)

    def centre(self) -> None:
        index, part, frame = self.somewhere()
        points = [self.near(index, frame, k) for k in range(4)]
        self.session.set_center(part, frame, (sum(x for x, _ in points) / 4, sum(y for _, y in points) / 4))

    def clear_centre(self) -> None:
        _, part, frame = self.somewhere()
        self.session.clear_center(part, frame)

    def track(self) -> None:
        self.session.track()
        for part in PARTS:
            self.session.tracks(part), self.session.confidence(part)

    def snap(self) -> None:
        self.session.snap()

    def cancel(self) -> None:
        before, end = self.session.document(), self.random.random()
        try:
            self.session.track(progress=lambda done, _step: done < end)
        except Cancelled:
            assert self.session.document() == before, "a cancelled call changed the document"

    def undo(self) -> None:
        self.saved.append(self.session.document())
        self.session.set_document(self.saved.pop(self.random.randrange(len(self.saved))))
        del self.saved[:-5]

    def reopen(self) -> None:
        self.compare()
        path = self.folder / "saved.json"
        self.session.save(path)
        self.session.close()
        self.session = Session.open(path)

    def compare(self) -> None:
        """Requires that a fresh session with the same input has the same result."""
        self.session.track()
        here = self.session.document()
        with Session.from_document(without_results(here), self.folder) as fresh:
            fresh.track()
            there = fresh.document()
        for own, other in zip(here["parts"], there["parts"], strict=True):
            assert own.get("tracks") == other.get("tracks"), f"part {own['name']}: a fresh run finds another track"
        self.counts["compared"] = self.counts.get("compared", 0) + 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=120)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for frame in range(LAST + 1):
            write_png(Path(folder) / f"frame_{frame:03}.png", draw(frame))
        artist = Artist(Path(folder), given.seed)
        start, length = time.monotonic(), 60 * given.minutes
        warm, most, shown = 0, 0, 0.0
        while (now := time.monotonic() - start) < length:
            artist.work()
            used = memory()
            if now < length / 5:
                warm = max(warm, used)
            most = max(most, used)
            if now >= shown:
                print(f"{now / 60:6.1f} min  {used / 2**20:7.1f} MB  {sum(artist.counts.values())} calls", flush=True)
                shown += length / 20
        artist.compare()
    print(", ".join(f"{name} {count}" for name, count in sorted(artist.counts.items())))
    print(f"memory: {warm / 2**20:.1f} MB after a fifth of the time, {most / 2**20:.1f} MB at most")
    return 0 if most <= 1.1 * warm + 16 * 2**20 else 1


if __name__ == "__main__":
    sys.exit(main())
