"""A stand-in for the native session: blends keys linearly, keeps pins and centres, counts what it solves."""

import copy
from dataclasses import dataclass, field

import numpy as np


class Cancelled(Exception):
    """Never raised here; the add-on knows its own."""


@dataclass
class Summary:
    solved: int
    reused: int
    ends: list = field(default_factory=list)
    exchanges: list = field(default_factory=list)
    unseen: list = field(default_factory=list)
    footage_changed: bool = False


@dataclass
class Exchange:
    parts: tuple
    frames: list


@dataclass
class Unseen:
    part: str
    frames: list


@dataclass
class End:
    part: str
    frame: int
    reason: str


@dataclass
class Track:
    frames: np.ndarray
    points: np.ndarray


@dataclass
class Traced:
    """As the add-on's `lines.Traced`."""

    frames: np.ndarray
    stroke_offsets: np.ndarray
    tracks: np.ndarray
    closed: np.ndarray
    colours: np.ndarray
    point_offsets: np.ndarray
    points: np.ndarray
    widths: np.ndarray
    confidence: np.ndarray
    fills: np.ndarray
    fill_colours: np.ndarray


LINES = [[[20.0, 20.0], [40.0, 20.0], [60.0, 22.0]], [[30.0, 40.0], [50.0, 50.0], [70.0, 40.0], [50.0, 30.0]]]
"""What the tracer finds where nothing is drawn: two lines."""


@dataclass
class Tracer:
    """As `Session`, for lines: every line moves by a pixel from picture to picture."""

    state: dict

    @classmethod
    def from_document(cls, document, folder):
        return cls(copy.deepcopy(document))

    def trace(self, style="auto", sensitivity=1.0, frames=None, progress=None, *, leave_out=(), keep_first=False, threads=0):
        if progress is not None and progress(0.5, "tracing") is False:
            raise Cancelled
        drawn = {each["frame"]: [stroke["points"] for stroke in each["strokes"]] for each in self.state["drawings"]}
        numbers = np.arange(frames[0], frames[1] + 1)
        start = min(drawn, default=int(numbers[0]))
        first = drawn.get(start, LINES)
        lines = [drawn.get(int(n)) or [np.asarray(p, float) + [n - start, 0] for p in first] for n in numbers]
        flat = [np.asarray(line, float) for own in lines for line in own]
        counts = np.array([len(own) for own in lines])
        sizes = np.array([len(line) for line in flat])
        return Traced(
            numbers,
            np.concatenate([[0], np.cumsum(counts)]),
            np.concatenate([np.arange(count) for count in counts]),
            np.zeros(len(flat), int),
            np.full((len(flat), 3), 0.1),
            np.concatenate([[0], np.cumsum(sizes)]),
            np.concatenate(flat),
            np.full(int(sizes.sum()), 2.0),
            np.ones(len(flat)),
            np.zeros(len(flat), int),
            np.full((len(flat), 3), np.nan),
        )

    def close(self):
        pass


@dataclass
class Region:
    """As `rototoon.fills.Region`."""

    track: int
    outline: np.ndarray
    holes: list
    colour: tuple
    confidence: float
    doubtful: bool
    name: str | None = None


@dataclass
class Painted:
    """As `rototoon.fills.Filled`, as far as the add-on uses it: a square around each click, which moves by a pixel from picture to picture."""

    frames: np.ndarray
    clicks: list
    start: int
    missed: list = field(default_factory=list)
    unrelated: list = field(default_factory=list)
    overruled: list = field(default_factory=list)
    bare: list = field(default_factory=list)
    leaking: list = field(default_factory=list)

    def on(self, frame):
        """The regions of a frame."""
        square = np.array([[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]])
        return [
            Region(k, square + click["at"] + [frame - self.start, 0], [], tuple(click["colour"]), 0.9, False)
            for k, click in enumerate(self.clicks)
        ]


@dataclass
class Painter:
    """As `Session`, for paint."""

    state: dict

    @classmethod
    def from_document(cls, document, folder):
        return cls(copy.deepcopy(document))

    def fill(self, clicks=None, sensitivity=1.0, frames=None, progress=None, *, confidence=0.0, leave_out=(), threads=0):
        if progress is not None and progress(0.5, "painting") is False:
            raise Cancelled
        first = self.state["fills"][0]
        return Painted(np.arange(frames[0], frames[1] + 1), first["regions"], first["frame"])

    def close(self):
        pass


@dataclass
class Session:
    """As the add-on's `session.Session`, as far as the add-on uses it."""

    state: dict
    folder: str
    cache: dict = field(default_factory=dict)
    solved: list = field(default_factory=list)
    made = []

    @classmethod
    def from_document(cls, document, folder):
        session = cls(copy.deepcopy(document), folder)
        cls.made.append(session)
        return session

    def set_document(self, document):
        self.state = copy.deepcopy(document)

    def document(self):
        return copy.deepcopy(self.state)

    def track(self, preset="rototoon", progress=None, *, threads=0):
        self.solved, reused = [], 0
        steps = [(part, span) for part in self.state["parts"] for span in spans(part)]
        results = {}
        for number, (part, (first, last)) in enumerate(steps):
            if progress is not None and progress(number / len(steps), "tracking") is False:
                raise stop()
            job = repr((preset, part["keys"][str(first)], part["keys"][str(last)], corrections(part, first, last)))
            place = (part["name"], first, last)
            if self.cache.get(place, ("", None))[0] != job:
                self.cache[place] = (job, solve(part, first, last))
                self.solved.append(place)
            else:
                reused += 1
            results.setdefault(part["name"], {}).update(self.cache[place][1])
        ends = []
        for part in self.state["parts"]:
            if len(part["keys"]) == 1 and preset == "rototoon":
                results[part["name"]] = outward(part, self.state["footage"], ends)
                self.solved.append((part["name"], min(results[part["name"]]), max(results[part["name"]])))
            found = results.get(part["name"], {})
            part["tracks"] = {str(f): p.tolist() for f, p in sorted(found.items())}
            part["confidence"] = {f: [0.5] * len(p) for f, p in part["tracks"].items()}
            part.pop("curves", None)
        return Summary(len(self.solved), reused, ends)

    def snap(self, progress=None, *, threads=0):
        for part in self.state["parts"]:
            part["curves"] = {f: segments(np.array(p), part["closed"]) for f, p in part.get("tracks", {}).items()}

    def part(self, name):
        return next(part for part in self.state["parts"] if part["name"] == name)

    def tracks(self, name):
        found = self.part(name).get("tracks", {})
        frames = sorted(int(f) for f in found)
        return Track(np.array(frames, np.int32), np.array([found[str(f)] for f in frames], np.float64))

    def confidence(self, name):
        found = self.part(name).get("confidence", {})
        return np.array([found[f] for f in sorted(found, key=int)], np.float64)

    def curves(self, name, frame):
        return [np.array(path) for path in self.part(name).get("curves", {}).get(str(frame), [])]

    def unseen(self):
        return []

    def __enter__(self):
        return self

    def __exit__(self, *raised):
        pass


def stop():
    """The add-on's own `Cancelled`."""
    from conftest import module

    return module("rototoon").Cancelled("stopped")


def spans(part):
    frames = sorted(int(f) for f in part["keys"])
    return list(zip(frames, frames[1:]))


def outward(part, footage, ends):
    """A single key held for `REACH` frames either way, or as far as the part is corrected; pins moved."""
    ((key, points),) = ((int(f), np.array(p)) for f, p in part["keys"].items())
    fixed = [int(f) for kind in ("pins", "centers") for f in part.get(kind, {})]
    first = max(footage["first"], min([key - REACH, *fixed]))
    last = min(footage["last"], max([key + REACH, *fixed]))
    found = {frame: points.copy() for frame in range(first, last + 1)}
    for frame, pins in part.get("pins", {}).items():
        for index, place in pins.items():
            found[int(frame)][int(index)] = place
    if first > footage["first"]:
        ends.append(End(part["name"], first - 1, "lost"))
    if last < footage["last"]:
        ends.append(End(part["name"], last + 1, "lost"))
    return found


REACH = 2


def corrections(part, first, last):
    return {
        kind: {f: v for f, v in part.get(kind, {}).items() if first < int(f) < last} for kind in ("pins", "centers")
    }


def solve(part, first, last):
    """Keys blended; a pin moves its point, a centre the others."""
    a, b = np.array(part["keys"][str(first)]), np.array(part["keys"][str(last)])
    found = {}
    for frame in range(first, last + 1):
        share = (frame - first) / (last - first)
        points = a * (1 - share) + b * share
        pins = part.get("pins", {}).get(str(frame), {})
        for index, place in pins.items():
            points[int(index)] = place
        center = part.get("centers", {}).get(str(frame))
        free = [i for i in range(len(points)) if str(i) not in pins]
        if center is not None and free:
            points[free] += (np.array(center) - points.mean(0)) * len(points) / len(free)
        found[frame] = points
    return found


def segments(points, closed):
    """A straight path of five points for each segment."""
    ends = np.roll(points, -1, 0) if closed else points[1:]
    starts = points if closed else points[:-1]
    return [np.linspace(a, b, 5).tolist() for a, b in zip(starts, ends)]


def match_contours(request):
    """Best pairs first: shapes alike after the best shift and direction, and not far from each other."""
    options = []
    for number, reference in enumerate(request["references"]):
        goal = np.array(reference["points"])
        centre = goal.mean(0)
        for who, contour in enumerate(request["drawn"]):
            drawn = np.array(contour["points"])
            far = np.linalg.norm(drawn.mean(0) - centre)
            cost, points = best(goal - centre, drawn, reference["closed"])
            if far < 80:
                options.append((cost + 0.1 * far, number, who, points))
    matches, references, contours = [], set(), set()
    for _, number, who, points in sorted(options, key=lambda option: option[:3]):
        if number not in references and who not in contours:
            references.add(number)
            contours.add(who)
            matches.append({"reference": number, "drawn": who, "points": points.tolist()})
    return {"matches": matches}


def best(goal, drawn, closed):
    options = []
    for line in (drawn, drawn[::-1]):
        starts = range(len(line)) if closed else [0]
        for start in starts:
            points = resample(np.roll(line, -start, 0), goal, closed)
            options.append((np.linalg.norm(points - points.mean(0) - goal), len(options), points))
    cost, _, points = min(options, key=lambda option: option[:2])
    return cost, points


def resample(line, goal, closed):
    """Points on `line` at the arc length shares of `goal`'s points."""

    def shares(points):
        ring = np.concatenate([points, points[:1]]) if closed else points
        steps = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
        return ring, steps / steps[-1]

    ring, at = shares(line)
    _, wanted = shares(goal)
    wanted = wanted[: len(goal)]
    return np.stack([np.interp(wanted, at, ring[:, k]) for k in (0, 1)], 1)
