"""Documents in and out, and Blender files saved, opened and moved."""

import json
import os
import shutil
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import shots


def project(folder):
    """A document with everything that a document can hold, and more."""
    shots.draw_sequence(folder / "frames", first=0)
    tracks = {str(f): (shots.square(f) + 0.25 * (f == 3)).tolist() for f in range(9)}
    tracks["0"], tracks["8"] = shots.square(0).tolist(), shots.square(8).tolist()
    return {
        "rototoon": 1,
        "studio": {"shot": "sc_010"},
        "footage": {
            "pattern": "frames/shot_%03d.png", "first": 0, "last": 8, "fps": 25, "width": 160, "height": 90, "lens": 35
        },
        "parts": [
            {
                "name": "box", "closed": True, "depth": 13, "colour": "red",
                "keys": {"0": shots.square(0).tolist(), "8": shots.square(8).tolist()},
                "pins": {"3": {"2": tracks["3"][2]}},
                "centers": {"6": np.mean(tracks["6"], 0).tolist()},
                "tracks": tracks,
                "confidence": {f: [1.0 if f in "08" else 0.5] * 4 for f in tracks},
                "curves": {
                    f: [np.linspace(p[i], p[(i + 1) % 4], 7).tolist() for i in range(4)] for f, p in tracks.items()
                },
            },
            {"name": "line", "closed": False, "depth": 2.5, "keys": {"2": [[5.0, 6.0], [40.0, 9.5], [80.0, 7.0]]}},
        ],
    }  # fmt: skip


def close(a, b, tolerance=2e-3, place=""):
    """Equal but for single precision."""
    if isinstance(a, dict):
        assert list(a) == list(b), place
        for name in a:
            close(a[name], b[name], tolerance, f"{place}.{name}")
    elif isinstance(a, list):
        assert len(a) == len(b), place
        for index, pair in enumerate(zip(a, b)):
            close(*pair, tolerance, f"{place}[{index}]")
    elif isinstance(a, float) or isinstance(b, float):
        assert abs(a - b) <= tolerance, place
    else:
        assert a == b, place


def sorted_keys(value):
    return json.loads(json.dumps(value, sort_keys=True))


def test_document_in_and_out(addon, tmp_path):
    source = project(tmp_path)
    (tmp_path / "in.json").write_text(json.dumps(source))
    bpy.context.scene.frame_start = 101
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"))
    ob = bpy.context.object
    assert ob.rototoon.frame_offset == 101
    assert [(p.name, p.depth, p.closed) for p in ob.rototoon.parts] == [("box", 13.0, True), ("line", 2.5, False)]
    kinds = {f.frame_number: f.keyframe_type for f in shots.layer_of(ob).frames}
    assert kinds == {f: "KEYFRAME" if f in (101, 103, 109) else "GENERATED" for f in range(101, 110)}
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"))
    result = json.loads((tmp_path / "out.json").read_text())
    close(sorted_keys(source), sorted_keys(result))
    assert not list(tmp_path.glob("*.unfinished"))


def test_import_into_the_active_object(addon, tmp_path):
    (tmp_path / "in.json").write_text(json.dumps(project(tmp_path)))
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"))
    count = len(bpy.data.objects)
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"), into="ACTIVE", keep_numbers=True)
    ob = bpy.context.object
    assert len(bpy.data.objects) == count and len(ob.rototoon.parts) == 2
    assert [f.frame_number for f in shots.layer_of(ob).frames] == list(range(9))


def test_import_keeps_the_frames_of_an_object_with_the_same_footage(addon, tmp_path, capfd):
    scene, path = bpy.context.scene, str(tmp_path / "in.json")
    (tmp_path / "in.json").write_text(json.dumps(project(tmp_path)))
    scene.frame_start = 101
    bpy.ops.rototoon.import_document(filepath=path)
    ob = bpy.context.object
    before = [f.frame_number for f in shots.layer_of(ob).frames]
    # Handles before the footage.
    scene.frame_start, ob.rototoon.movie = 93, str(tmp_path / "shot.mov")
    capfd.readouterr()
    bpy.ops.rototoon.import_document(filepath=path, into="ACTIVE")
    assert ob.rototoon.frame_offset == 101 and [f.frame_number for f in shots.layer_of(ob).frames] == before
    assert ob.rototoon.movie == str(tmp_path / "shot.mov") and "other footage" not in capfd.readouterr().out
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "in.json").write_text(json.dumps(project(tmp_path / "other")))
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "other" / "in.json"), into="ACTIVE")
    assert ob.rototoon.frame_offset == 93 and not ob.rototoon.movie
    assert f'"{ob.name}" has other footage now: shot_%03d.png, with picture 0 on frame 93' in capfd.readouterr().out


@pytest.mark.parametrize("lacking", ["camera", "size", "view"])
def test_an_import_that_has_no_place_leaves_the_object(addon, tmp_path, lacking):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.match_contours()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "in.json").write_text(json.dumps(project(tmp_path / "other")))
    if lacking == "camera":
        bpy.data.objects.remove(ob.rototoon.camera or bpy.context.scene.camera)
    elif lacking == "size":
        ob.scale = 0, 0, 0
    else:
        ob.rototoon.camera.data.type = "PANO"
    bpy.context.view_layer.update()

    gp = addon("blender.grease_pencil")

    def state():
        settings = ob.rototoon
        frames = {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(shots.layer_of(ob)).items()}
        return frames, [part.name for part in settings.parts], settings.pattern, settings.frame_offset, settings.fps

    before = state()
    with pytest.raises(RuntimeError, match={"camera": "no camera", "size": "a scale of 0", "view": "is of type PANO"}[lacking]):
        bpy.ops.rototoon.import_document(filepath=str(tmp_path / "other" / "in.json"), into="ACTIVE", keep_numbers=True)
    assert state() == before and before[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.update(rototoon=2), "rototoon: found 2, expected the version 1"),
        (lambda d: d.pop("rototoon"), "rototoon: found nothing, .*not a project document"),
        (lambda d: d["footage"].pop("width"), "footage.width: found nothing, expected a whole number"),
        (lambda d: d["parts"][1]["keys"].update({"5": [[1, 2]]}), r"parts\[1\].keys\[5\]: found 1 point, expected \d+ as in parts\[1\].keys\[2\]"),
        (lambda d: d["parts"][1]["keys"].update({"x": [[1, 2]]}), 'found "x", expected a frame number'),
        (lambda d: d["parts"][1].update(name="box"), 'name: found "box", expected another name'),
        (lambda d: d["parts"][1]["keys"]["2"].append(["a", None]), r"parts\[1\].keys\[2\]"),
        (lambda d: d["footage"].update(pattern="gone/f_%d.png"), "footage is missing"),
    ],
)
def test_bad_documents_are_named(addon, tmp_path, change, message):
    document = project(tmp_path)
    change(document)
    (tmp_path / "bad.json").write_text(json.dumps(document))
    before = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.rototoon.import_document(filepath=str(tmp_path / "bad.json"))
    assert len(bpy.data.objects) == before


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["parts"][0].update(closed="no"), 'closed: found the text "no", expected true or false'),
        (lambda d: d["parts"][0].update(depth="x"), 'depth: found the text "x", expected a finite number'),
        (lambda d: d["parts"][0]["pins"]["3"].update({"9": [1, 2]}), "found point 9, expected one of 0 to 3"),
        (lambda d: d["parts"][0]["centers"].update({"6": "x"}), 'centers."6": found the text "x", expected a point'),
        (lambda d: d["parts"][0].update(absent="x"), "absent: found the text"),
        (lambda d: d["footage"].update(fps="x"), "footage.fps: found the text"),
        (lambda d: d["footage"].update(first=5, last=2), "footage.last: found 2, expected at least the first frame, 5"),
        (lambda d: d["footage"].update(width=10**12), "footage.width: found 1000000000000, expected 1 to 65535"),
        (lambda d: d["footage"].update(pattern="x.png"), "has no frame number: expected one %d"),
        (lambda d: d["parts"][0].update(depth="x", falloff="x", color="x", absent="x"), "; and 1 more"),
    ],
)
def test_the_library_knows_what_else_is_wrong(addon, library, tmp_path, change, message):
    document = project(tmp_path)
    change(document)
    (tmp_path / "bad.json").write_text(json.dumps(document))
    before = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match=message) as caught:
        bpy.ops.rototoon.import_document(filepath=str(tmp_path / "bad.json"))
    assert "Traceback" not in str(caught.value) and len(bpy.data.objects) == before


def test_documents_of_other_programs(addon, tmp_path):
    """A mark before the text, a newer minor version, no `closed`, and results that do not fit their part."""
    document = project(tmp_path)
    document["rototoon"] = 1.2
    part = document["parts"][0]
    del part["closed"]
    part["confidence"]["4"] = [1.0]
    part["curves"]["4"][2] = []
    part["curves"]["5"].pop()
    (tmp_path / "other.json").write_text(json.dumps(document), encoding="utf-8-sig")
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "other.json")) == {"FINISHED"}
    ob = bpy.context.object
    assert [part.closed for part in ob.rototoon.parts] == [True, False]
    assert bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json")) == {"FINISHED"}
    found = json.loads((tmp_path / "out.json").read_text())["parts"][0]
    assert found["closed"] and found["confidence"]["4"] == [1.0] * 4
    assert set(found["curves"]) == set(found["tracks"]) - {"4", "5"}


def test_cut_short_document(addon, tmp_path):
    (tmp_path / "short.json").write_text(json.dumps(project(tmp_path))[:300])
    with pytest.raises(RuntimeError, match="not a project document"):
        bpy.ops.rototoon.import_document(filepath=str(tmp_path / "short.json"))


def test_export_to_a_folder_that_is_not_there(addon, fake, tmp_path):
    shots.two_keys(addon, tmp_path)
    with pytest.raises(RuntimeError, match="cannot write"):
        bpy.ops.rototoon.export_document(filepath=str(tmp_path / "no/such/out.json"))


def changed(path):
    """Another program renames the first part of a document. Returns what the file holds now."""
    document = json.loads(path.read_text())
    document["parts"][0]["name"] += " of somebody else"
    path.write_text(json.dumps(document))
    return path.read_bytes()


def names(path):
    return [part["name"] for part in json.loads(path.read_text())["parts"]]


def test_export_without_the_ending_leaves_another_file(addon, library, tmp_path):
    """Blender asks about the name that was typed, and not about the one with the ending."""
    ob = shots.two_keys(addon, tmp_path)
    other = tmp_path / "shot.json"
    other.write_text("somebody else's document")
    with pytest.raises(RuntimeError, match=r"a file shot\.json already, which is not this object's"):
        bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot"))
    assert other.read_text() == "somebody else's document"
    bpy.ops.rototoon.export_document(filepath=str(other))
    # The object knows the file now.
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot"))
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "fresh"))
    assert (tmp_path / "fresh.json").exists() and ob.rototoon.known_files.count("json") == 2


@pytest.mark.parametrize(("typed", "becomes"), [("shot", "shot.json"), ("shot.json", "shot.json"), ("shot.JSON", "shot.JSON"), ("", "")])
def test_the_file_browser_gets_the_ending(addon, tmp_path, typed, becomes):
    operator = SimpleNamespace(filepath=os.path.join(tmp_path, typed))
    changed = addon("exchange.operators.export_document").ROTOTOON_OT_export_document.check(operator, None)
    assert operator.filepath == os.path.join(tmp_path, becomes) and changed == (typed != becomes)


def test_export_onto_a_document_that_another_program_changed(addon, library, tmp_path):
    path, beside = tmp_path / "in.json", tmp_path / "in (2).json"
    path.write_text(json.dumps(project(tmp_path)))
    bpy.ops.rototoon.import_document(filepath=str(path))
    theirs = changed(path)
    with pytest.raises(RuntimeError, match="another program wrote the file meanwhile") as caught:
        bpy.ops.rototoon.export_document(filepath=str(path))
    assert str(path) in str(caught.value) and str(beside) in str(caught.value)
    assert path.read_bytes() == theirs and names(beside) == ["box", "line"]
    # Of a file that was not read here the artist chose the name.
    other = tmp_path / "other.json"
    other.write_text("theirs")
    assert bpy.ops.rototoon.export_document(filepath=str(other)) == {"FINISHED"}
    changed(other)
    with pytest.raises(RuntimeError, match=r"other \(2\)"):
        bpy.ops.rototoon.export_document(filepath=str(other))


def test_the_file_remembers_what_was_imported(addon, library, tmp_path):
    path = tmp_path / "in.json"
    path.write_text(json.dumps(project(tmp_path)))
    bpy.ops.rototoon.import_document(filepath=str(path))
    name = bpy.context.object.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    theirs = changed(path)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.context.view_layer.objects.active = bpy.data.objects[name]
    with pytest.raises(RuntimeError, match="another program wrote the file meanwhile"):
        bpy.ops.rototoon.export_document(filepath=str(path))
    assert path.read_bytes() == theirs


def test_what_this_blender_wrote_is_not_another_programs(addon, library, tmp_path):
    """Undo takes back what the object knows of a file, and leaves the file."""
    path = tmp_path / "in.json"
    path.write_text(json.dumps(project(tmp_path)))
    bpy.ops.rototoon.import_document(filepath=str(path))
    ob = bpy.context.object
    before = ob.rototoon.known_files
    ob.rototoon.parts[0].name = "case"
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    assert ob.rototoon.known_files != before
    ob.rototoon.known_files = before
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"} and names(path) == ["case", "line"]
    ob.rototoon.known_files = before
    changed(path)
    with pytest.raises(RuntimeError, match="another program wrote"):
        bpy.ops.rototoon.export_document(filepath=str(path))


def test_save_move_and_open(addon, fake, tmp_path):
    home = tmp_path / "home"
    ob = shots.two_keys(addon, home)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 6, 1, (9.0, 4.0))
    bpy.ops.wm.save_as_mainfile(filepath=str(home / "shot.blend"))
    assert ob.rototoon.pattern == "//frames/shot_%03d.png"
    before = shots.snapshot(ob)
    shutil.move(home, tmp_path / "elsewhere")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "elsewhere/shot.blend"))
    ob = bpy.context.object
    assert shots.snapshot(ob) == before
    assert addon("capture.sessions").known(ob) is None
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state
    assert state["footage"]["pattern"] == str(tmp_path / "elsewhere/frames/shot_%03d.png")
    assert list(state["parts"][1]["pins"]) == ["4"]
    assert list(state["parts"][0]["pins"]) == ["6"]


def test_footage_that_is_gone(addon, fake, tmp_path):
    shots.two_keys(addon, tmp_path)
    shutil.rmtree(tmp_path / "frames")
    with pytest.raises(RuntimeError, match="footage was moved or renamed"):
        bpy.ops.rototoon.track()


def test_saved_copy_leaves_the_open_file_right(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    (tmp_path / "deep/copies").mkdir(parents=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "deep/copies/copy.blend"), copy=True)
    assert ob.rototoon.pattern == "//frames/shot_%03d.png"
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "deep/copies/copy.blend"))
    assert bpy.context.object.rototoon.pattern == "//../../frames/shot_%03d.png"
    bpy.ops.rototoon.track()


def test_a_copy_of_a_file_without_a_place_leaves_the_footage(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    before = ob.rototoon.pattern
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    assert (bpy.data.filepath, ob.rototoon.pattern) == ("", before)
    bpy.ops.rototoon.track()


@pytest.mark.parametrize("saved", [False, True])
def test_a_file_that_cannot_be_saved_keeps_its_footage(addon, fake, tmp_path, saved):
    ob = shots.two_keys(addon, tmp_path)
    if saved:
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    before = ob.rototoon.pattern
    with pytest.raises(RuntimeError, match="Cannot open file"):
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "no/such/shot.blend"))
    assert ob.rototoon.pattern == before
    bpy.ops.rototoon.track()


def test_import_works_in_every_mode(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot.json"))
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "shot.json")) == {"FINISHED"}
    assert bpy.context.object != ob and bpy.context.mode == "OBJECT"
    assert len(bpy.context.object.rototoon.parts) == len(ob.rototoon.parts) == 2


@pytest.fixture
def shot_in_use(tmp_path):
    """The scene of somebody else's shot with a camera that moves."""
    shots.draw_sequence(tmp_path)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    scene.frame_start, scene.frame_end = 101, 240
    scene.frame_set(200)
    scene.camera = bpy.data.objects.new("Shot Cam", bpy.data.cameras.new("Shot Cam"))
    scene.collection.objects.link(scene.camera)
    scene.camera.keyframe_insert("location", frame=101)
    return scene


def settings_of(scene):
    return scene.render.resolution_x, scene.render.resolution_y, scene.frame_start, scene.frame_end, scene.frame_current, scene.camera.name


def test_import_leaves_the_scene_of_another_shot(addon, shot_in_use, tmp_path):
    (tmp_path / "in.json").write_text(json.dumps(project(tmp_path)))
    before = settings_of(shot_in_use)
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json")) == {"FINISHED"}
    assert settings_of(shot_in_use) == before
    ob = bpy.context.object
    text = addon("scripting").take_reports()[-1].text
    assert ob.rototoon.camera.name == "in Camera" and 'it is seen through a camera of its own, "in Camera"' in text and "pixels now" not in text
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"))
    assert np.allclose(json.loads((tmp_path / "out.json").read_text())["parts"][0]["keys"]["0"], shots.square(0), atol=2e-3)


def test_import_says_what_is_other_in_the_scene(addon, shot_in_use, tmp_path):
    (tmp_path / "in.json").write_text(json.dumps(project(tmp_path)))
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"), match_scene=True) == {"FINISHED"}
    assert settings_of(shot_in_use) == (160, 90, 101, 109, 101, "in Camera")
    text = addon("scripting").take_reports()[-1].text
    for said in ('through a new camera, "in Camera"', "the scene has 160x90 pixels now, before 1920x1080", "the frames 101 to 109 now, before 101 to 240"):
        assert said in text, text


def test_a_file_that_may_not_be_written_stays(addon, tmp_path):
    """A file of a colleague in a shared folder; renaming another one to its name would replace it."""
    files, path = addon("exchange.files"), tmp_path / "batch.json"
    files.put(str(path), "one")
    files.put(str(path), "two")
    path.chmod(0o444)
    with pytest.raises(addon("blender.errors").Problem, match="batch.json: it is read-only for this user"):
        files.put(str(path), "three")
    assert path.read_text() == "two" and [entry.name for entry in tmp_path.iterdir()] == ["batch.json"]


@pytest.mark.skipif(os.name == "nt", reason="Windows keeps rights in another way")
def test_a_file_that_is_written_again_keeps_its_link_and_its_rights(addon, tmp_path):
    """In a shared folder the others of the group write it too, and a link leads to the disk that has the room."""
    files, path, link = addon("exchange.files"), tmp_path / "there.json", tmp_path / "batch.json"
    files.put(str(path), "one")
    path.chmod(0o664)
    link.symlink_to(path)
    files.put(str(link), "two")
    assert link.is_symlink() and path.read_text() == "two"
    assert path.stat().st_mode & 0o777 == 0o664
