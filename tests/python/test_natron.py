"""What goes to Natron: the script, run with a stand-in that takes only the calls, and the kinds of arguments, that Natron takes; and
the project, read with Boost as Natron reads it.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import program

HEIGHT = 48


class Parameter:
    def __init__(self):
        self.value, self.keys = None, {}

    def setValue(self, value, dimension):
        assert isinstance(dimension, int)
        self.value = value

    def setValueAtTime(self, value, time):
        assert isinstance(value, bool) and isinstance(time, int)
        self.keys[time] = value


class Choice:
    """The life time of a curve. Only with the last choice the keys of its activity count."""

    OPTIONS = ["All", "Single", "From start", "To end", "Custom"]

    def __init__(self):
        self.value = 0

    def getNumOptions(self):
        return len(self.OPTIONS)

    def set(self, value):
        assert isinstance(value, int)
        self.value = value


class Curve:
    """A Bézier curve. Natron makes a key where a point is set."""

    def __init__(self, x, y, time):
        assert isinstance(time, int)
        self.points, self.feather = [{time: (x, y)}], [{time: (x, y)}]
        # The handles before and after each point, and those of the feather.
        self.handles, self.feather_handles = [{}], [{}]
        self.label, self.closed = None, False
        self.feather_distance, self.falloff = Parameter(), Parameter()
        self.activated, self.life, self.colour = Parameter(), Choice(), None

    def setLabel(self, label):
        assert isinstance(label, str)
        self.label = label

    def addControlPoint(self, x, y):
        for each in (self.points, self.feather, self.handles, self.feather_handles):
            each.append({})

    def setPointAtIndex(self, index, time, x, y, left_x, left_y, right_x, right_y):
        self.points[index][time] = (x, y)
        self.handles[index][time] = (left_x, left_y), (right_x, right_y)

    def setFeatherPointAtIndex(self, index, time, x, y, left_x, left_y, right_x, right_y):
        self.feather[index][time] = (x, y)
        self.feather_handles[index][time] = (left_x, left_y), (right_x, right_y)

    def setCurveFinished(self, finished):
        self.closed = finished

    def getFeatherDistanceParam(self):
        return self.feather_distance

    def getFeatherFallOffParam(self):
        return self.falloff

    def setOverlayColor(self, red, green, blue):
        self.colour = (red, green, blue)

    def getActivatedParam(self):
        return self.activated

    def getParam(self, name):
        return {"lifeTime": self.life}.get(name)


class Natron:
    """The application, its one node, the node's roto context and its base layer."""

    def __init__(self):
        self.plugin, self.label, self.items = None, None, []

    def createNode(self, plugin):
        assert self.plugin is None
        self.plugin = plugin
        return self

    def setLabel(self, label):
        self.label = label

    def getRotoContext(self):
        return self

    def getBaseLayer(self):
        return self

    def createBezier(self, x, y, time):
        return Curve(x, y, time)

    def addItem(self, curve):
        self.items.append(curve)


def points(frame):
    return [[4.25 + frame, 3.5], [20.0, 5.0 + frame], [11.5, 17.75]]


@pytest.fixture(scope="module")
def document(tmp_path_factory) -> Path:
    """Two parts: the near one is there on the first and the last frame, the far one on frames 2 to 6, but hidden on frame 4."""
    keys = {str(frame): points(frame) for frame in (2, 3, 5, 6)}
    still = {"0": [[1.0, 40.0], [30.5, 44.0]], "8": [[3.0, 41.0], [33.5, 40.0]]}
    parts = [
        {"name": 'near "line"', "closed": False, "depth": 2, "keys": still},
        {"name": "Größe 🦊", "closed": True, "depth": 1, "keys": keys, "falloff": 3.5, "color": [0.25, 1, 0.5], "absent": [[4, 4]]},
    ]
    footage = {"pattern": "f_%d.png", "first": 0, "last": 8, "fps": 12.5, "width": 64, "height": HEIGHT}
    document = tmp_path_factory.mktemp("natron") / "a.json"
    document.write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": parts}))
    return document


def export(document: Path, ending: str, *options: str) -> Path:
    out = document.with_suffix(ending)
    subprocess.run([program(), "export", document, "-o", out, *options], check=True, timeout=60)
    return out


@pytest.mark.parametrize("name", ["app", "app1"])
def test_the_script_makes_the_parts(document: Path, name: str):
    script = export(document, ".py")

    app = Natron()
    exec(compile(script.read_text(encoding="ascii"), "a.py", "exec"), {name: app})  # noqa: S102: the script is ours
    assert (app.plugin, app.label) == ("fr.inria.built-in.Roto", "Rototoon")
    far, near = app.items
    assert (far.label, far.closed, near.label, near.closed) == ("Größe 🦊", True, 'near "line"', False)
    for curve in app.items:
        assert curve.points == curve.feather and curve.feather_distance.value == 0
        assert curve.handles == curve.feather_handles
        assert curve.handles == [{f: (p, p) for f, p in keyed.items()} for keyed in curve.points]
    assert (far.falloff.value, near.falloff.value) == (3.5, 1)
    assert far.colour == (0.25, 1, 0.5) and len(near.colour) == 3 and near.colour != far.colour
    for k, keyed in enumerate(far.points):
        assert keyed == {f: (points(f)[k][0], HEIGHT - points(f)[k][1]) for f in (2, 3, 5, 6)}
    assert far.activated.keys == {0: False, 2: True, 4: False, 5: True, 7: False}
    assert [Choice.OPTIONS[curve.life.value] for curve in app.items] == ["Custom", "All"]
    assert near.activated.keys == {} and set(near.points[0]) == {0, 8}


def test_the_script_sets_the_handles_of_bezier_curves(tmp_path: Path):
    """A snapped path that is a drawn cubic from (10, 10) to (40, 10)."""
    ends, shares = [[10.0, 10.0], [40.0, 10.0], [25.0, 40.0]], [k / 60 for k in range(61)]
    bow = [[10 + 30 * t, 10 - 24 * t * (1 - t)] for t in shares]
    curves = {"0": [bow, [ends[1], ends[2]], [ends[2], ends[0]]]}
    part = {"name": "a", "closed": True, "keys": {"0": ends}, "tracks": {"0": ends}, "curves": curves}
    footage = {"pattern": "f_%d.png", "first": 0, "last": 0, "fps": 12.5, "width": 64, "height": HEIGHT}
    document = tmp_path / "a.json"
    document.write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": [part]}))
    script = export(document, ".py", "--bezier", "0.25")

    app = Natron()
    exec(compile(script.read_text(encoding="ascii"), "a.py", "exec"), {"app": app})  # noqa: S102: the script is ours
    [curve] = app.items
    places = [keyed[0] for keyed in curve.points]
    assert places == [(x, HEIGHT - y) for x, y in ends] and curve.handles == curve.feather_handles
    first, second, third = (keyed[0] for keyed in curve.handles)
    assert first[0] == places[0] and second[1] == places[1] and third == (places[2], places[2])
    # Those of the drawn cubic are a third of the way across, and 8 pixels up.
    assert first[1] == pytest.approx((20, HEIGHT - 2), abs=1.5)
    assert second[0] == pytest.approx((30, HEIGHT - 2), abs=1.5)


@pytest.fixture(scope="module")
def reader(tmp_path_factory) -> Path:
    """The program that reads a project with Boost."""
    compiler = shutil.which("c++")
    header = ["-x", "c++", "-fsyntax-only", "-include", "boost/archive/xml_iarchive.hpp", os.devnull]
    if not compiler or subprocess.run([compiler, *header], capture_output=True, check=False, timeout=60).returncode:
        pytest.skip("no Boost.Serialization; install it: apt-get install g++ libboost-serialization-dev")
    built = tmp_path_factory.mktemp("reader") / "read"
    source = Path(__file__).with_name("natron_project.cpp")
    subprocess.run([compiler, "-std=c++14", source, "-o", built, "-lboost_serialization"], check=True, timeout=120)
    return built


def told(reader: Path, project: Path) -> list[str]:
    run = subprocess.run([reader, project], capture_output=True, text=True, encoding="utf-8", check=False, timeout=60)
    assert run.returncode == 0, run.stderr
    return run.stdout.splitlines()


def test_boost_reads_the_project(document: Path, reader: Path):
    lines = told(reader, export(document, ".ntp"))
    assert lines[:6] == [
        "background 1 now 0",
        "setting outputFormat 64x48 20",
        "setting frameRange  0 8",
        "setting frameRate  12.500000",
        "format 64x48 1",
        "node fr.inria.built-in.Roto Layer1 Roto1",
    ]
    near = lines.index('curve 0 Bezier2 near "line"')
    assert lines[6:11] == [
        "curve 1 Bezier1 Größe 🦊",
        "parameter feather  0.000000",
        "parameter featherFallOff  3.500000",
        "parameter lifeTime Custom 4",
        "parameter activated  0 @0=0/0 @2=1/0 @4=0/0 @5=1/0 @7=0/0",
    ]
    assert lines[near + 1] == "parameter feather  0.000000" and lines[near + 2].startswith("point")
    for at, kind in ((11, "point"), (14, "feather")):
        for k in range(3):
            x, y = ([f"{f}={value}" for f in (2, 3, 5, 6) for value in [number(f, k)]] for number in (across, up))
            keys = " ".join(x), " ".join(y)
            assert lines[at + k] == kind + "".join(f" | {keys[axis]}" for axis in (0, 1) * 3)


def across(frame: int, k: int) -> str:
    return f"{points(frame)[k][0]:g}"


def up(frame: int, k: int) -> str:
    return f"{HEIGHT - points(frame)[k][1]:g}"


def test_boost_refuses_a_project_with_an_element_out_of_order(document: Path, reader: Path):
    project = export(document, ".ntp")
    text = project.read_text(encoding="utf-8")
    for old, new in (("Closed>", "Open>"), ('version="15"', 'version="16"'), ("<count>5</count>", "<count>4</count>")):
        assert old in text
        project.write_text(text.replace(old, new), encoding="utf-8")
        assert subprocess.run([reader, project], capture_output=True, check=False, timeout=60).returncode == 1, old
