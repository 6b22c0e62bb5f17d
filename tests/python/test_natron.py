"""The script for Natron, run with a stand-in for Natron that takes only the calls, and the kinds of arguments, that Natron takes."""

import json
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


class Curve:
    """A Bézier curve. Natron makes a key where a point is set."""

    def __init__(self, x, y, time):
        assert isinstance(time, int)
        self.points, self.feather = [{time: (x, y)}], [{time: (x, y)}]
        self.label, self.closed = None, False
        self.feather_distance, self.activated = Parameter(), Parameter()

    def setLabel(self, label):
        assert isinstance(label, str)
        self.label = label

    def addControlPoint(self, x, y):
        self.points.append({})
        self.feather.append({})

    def setPointAtIndex(self, index, time, x, y, left_x, left_y, right_x, right_y):
        assert (x, y) == (left_x, left_y) == (right_x, right_y)
        self.points[index][time] = (x, y)

    def setFeatherPointAtIndex(self, index, time, x, y, left_x, left_y, right_x, right_y):
        assert (x, y) == (left_x, left_y) == (right_x, right_y)
        self.feather[index][time] = (x, y)

    def setCurveFinished(self, finished):
        self.closed = finished

    def getFeatherDistanceParam(self):
        return self.feather_distance

    def getActivatedParam(self):
        return self.activated


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


@pytest.mark.parametrize("name", ["app", "app1"])
def test_the_script_makes_the_parts(tmp_path: Path, name: str):
    keys = {str(frame): points(frame) for frame in range(2, 7)}
    still = {"0": [[1.0, 40.0], [30.5, 44.0]], "8": [[3.0, 41.0], [33.5, 40.0]]}
    parts = [
        {"name": 'near "line"', "closed": False, "depth": 2, "keys": still},
        {"name": "Größe 🦊", "closed": True, "depth": 1, "keys": keys},
    ]
    footage = {"pattern": "f_%d.png", "first": 0, "last": 8, "fps": 12.5, "width": 64, "height": HEIGHT}
    document = tmp_path / "a.json"
    document.write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": parts}))
    script = tmp_path / "a.py"
    subprocess.run([program(), "export", document, "-o", script], check=True, timeout=60)

    app = Natron()
    exec(compile(script.read_text(encoding="ascii"), "a.py", "exec"), {name: app})  # noqa: S102: the script is ours
    assert (app.plugin, app.label) == ("fr.inria.built-in.Roto", "Rototoon")
    far, near = app.items
    assert (far.label, far.closed, near.label, near.closed) == ("Größe 🦊", True, 'near "line"', False)
    for curve in app.items:
        assert curve.points == curve.feather and curve.feather_distance.value == 0
    for k, keyed in enumerate(far.points):
        assert keyed == {f: (points(f)[k][0], HEIGHT - points(f)[k][1]) for f in range(2, 7)}
    assert far.activated.keys == {0: False, 2: True, 7: False}
    assert near.activated.keys == {} and set(near.points[0]) == {0, 8}
