"""Send to Farm and Collect Results: what is written, what is taken in, and what stays because the artist changed it."""

import json
import os
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
import shots
import studio

DAY = "shot"


@pytest.fixture
def sent(addon, fake, tmp_path):
    """A tracked object that was sent; its results are 2 pixels to the right of what is in the file."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.match_contours()
    bpy.ops.rototoon.track()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{DAY}.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))
    studio.come_back(addon, ob, tmp_path / "farm", 2.0, f"{DAY}_{ob.name}")
    return ob


def collect(tmp_path):
    return bpy.ops.rototoon.collect_results(directory=str(tmp_path / "farm"))


def manifest(tmp_path):
    return json.loads((tmp_path / "farm/manifest.json").read_text())


def places(addon, ob, frame):
    return {number: points for number, points in shots.pixels(addon, ob, frame)}


def last_report(addon):
    return addon("scripting").take_reports()[-1]


def test_a_scene_becomes_a_batch(addon, sent, tmp_path):
    made = manifest(tmp_path)
    (shot,) = made["shots"]
    assert made["steps"] == [{"do": "check"}, {"do": "track"}]
    assert shot == {"name": f"{DAY}_{sent.name}", "project": f"shots/{DAY}_{sent.name}.json", "blend": "../shot.blend"}
    document = json.loads((tmp_path / "farm" / shot["project"]).read_text())
    assert document["footage"]["pattern"] == "../../frames/shot_%03d.png"
    assert (tmp_path / "farm/shots" / document["footage"]["pattern"].replace("%03d", "001")).resolve().is_file()
    assert [sorted(part["keys"]) for part in document["parts"]] == [["1", "9"]] * 2
    assert "compileJob" in (tmp_path / "farm/rototoon-batch.js").read_text()
    job = json.loads((tmp_path / "farm/template.json").read_text())
    assert job["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]["range"] == "1-1"


def test_what_is_sent_can_be_chosen(addon, fake, tmp_path):
    one = shots.two_keys(addon, tmp_path)
    one.rototoon.preset = "zhou2011"
    other = one.copy()
    other.data = one.data.copy()
    bpy.context.scene.collection.objects.link(other)
    other.select_set(True)
    one.select_set(False)
    (tmp_path / "farm").mkdir()
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), use_snap=True, use_mattes=True, engine="NONE")
    assert [shot["name"] for shot in manifest(tmp_path)["shots"]] == [one.name, other.name]
    steps = manifest(tmp_path)["shots"][0]["steps"]
    assert [step["do"] for step in steps] == ["check", "track", "snap", "render"] and steps[1]["preset"] == "zhou2011"
    assert not (tmp_path / "farm/template.json").exists()
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), which="SELECTED")
    assert [shot["name"] for shot in manifest(tmp_path)["shots"]] == [other.name]


def test_nothing_of_others_is_replaced(addon, sent, tmp_path):
    folder = tmp_path / "farm"
    bpy.ops.rototoon.send_to_farm(directory=str(folder), use_snap=True)
    assert {"do": "snap"} in manifest(tmp_path)["steps"], "what was sent before may be sent again"
    (folder / "manifest.json").write_text("mine")
    with pytest.raises(RuntimeError, match="was changed since it was sent"):
        bpy.ops.rototoon.send_to_farm(directory=str(folder))
    assert (folder / "manifest.json").read_text() == "mine"
    other = tmp_path / "other"
    other.mkdir()
    (other / "template.json").write_text("mine")
    with pytest.raises(RuntimeError, match="was not written by Send to Farm"):
        bpy.ops.rototoon.send_to_farm(directory=str(other))
    assert sorted(os.listdir(other)) == ["template.json"]
    (other / "sent.json").write_text("[]")
    with pytest.raises(RuntimeError, match="not a list that Send to Farm wrote"):
        bpy.ops.rototoon.send_to_farm(directory=str(other), engine="NONE")


def test_another_file_does_not_take_the_folder_of_one(addon, sent, tmp_path):
    before = (tmp_path / "farm/manifest.json").read_text()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "second.blend"))
    with pytest.raises(RuntimeError, match=r"This folder has the batch of \.\./shot\.blend: choose another folder"):
        bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))
    assert (tmp_path / "farm/manifest.json").read_text() == before
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))


def test_names_can_be_those_of_folders(addon):
    names = addon("farm.batch").shot_names
    shot = lambda blend, name: {"blend": blend, "object": name}  # noqa: E731 - short
    assert names([shot("/a/sh010.blend", "GP"), shot("/b/SH010.blend", "gp"), shot("", 'a/b:"c"'), shot("", "..")]) == [
        "sh010_GP", "SH010_gp-2", "a_b__c_", "shot",
    ]  # fmt: skip
    long = names([shot("", "ß" * 200)] * 2)
    assert all(len(name.encode()) <= 120 for name in long) and len(set(long)) == 2


def test_objects_that_cannot_be_tracked_are_named(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    with pytest.raises(RuntimeError, match=f'Nothing to send; "{ob.name}": Draw contours'):
        bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))
    with pytest.raises(RuntimeError, match="Choose a folder"):
        bpy.ops.rototoon.send_to_farm()
    with pytest.raises(RuntimeError, match="Save this file, or choose"):
        bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), which="FOLDER")
    with pytest.raises(RuntimeError, match="No .blend file"):
        bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), which="FOLDER", source=str(tmp_path / "frames"))
    assert not (tmp_path / "farm").exists()


def test_all_files_of_a_folder(addon, sent, tmp_path):
    """Each is opened in a Blender of its own. One that is damaged does not stop the others."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "b.blend"), copy=True)
    (tmp_path / "c.blend").write_text("no file")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "open.blend"))
    os.remove(tmp_path / "open.blend")
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "all"), which="FOLDER")
    made = json.loads((tmp_path / "all/manifest.json").read_text())
    assert [shot["blend"] for shot in made["shots"]] == ["../b.blend", "../shot.blend"]
    assert "left out: c.blend" in last_report(addon).text
    one, other = (json.loads((tmp_path / "all" / shot["project"]).read_text()) for shot in made["shots"])
    assert one == other == json.loads((tmp_path / f"farm/shots/{DAY}_{sent.name}.json").read_text())


def test_results_are_taken(addon, sent, tmp_path):
    before = places(addon, sent, 5)
    addon("capture.exchanged").put(sent, [(1, 2, [4])])
    assert collect(tmp_path) == {"FINISHED"}
    assert not sent.rototoon.exchanges, "what the last Track found was in other contours"
    assert "14 contours taken into 1 object" in last_report(addon).text
    for number, points in places(addon, sent, 5).items():
        assert np.allclose(points, before[number] + (2.0, 0.0), atol=0.01)
    again = shots.snapshot(sent)
    collect(tmp_path)
    assert shots.snapshot(sent) == again, "a second time changes nothing"


def test_snapped_lines_that_were_changed_meanwhile_stay(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.match_contours()
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{DAY}.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), use_snap=True)
    studio.come_back(addon, ob, tmp_path / "farm", 2.0, f"{DAY}_{ob.name}")
    gp, layer = addon("blender.grease_pencil"), ob.data.layers["Snapped"]
    handle = gp.drawings(layer)[5][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1])) + np.float32(0.1)
    gp.put(handle, "position", points)
    collect(tmp_path)
    assert f'"{ob.name}": the snapped drawing that you had changed on frame 5 stays, as a key' in last_report(addon).text
    assert {f: kind for f, (_, kind) in gp.drawings(layer).items() if kind != "GENERATED"} == {5: "KEYFRAME"}
    assert np.array_equal(gp.positions(gp.drawings(layer)[5][0], len(points)), points)


def test_what_was_changed_meanwhile_stays(addon, sent, tmp_path):
    shots.move(addon, sent, 9, 1, (5.0, 0.0))  # a key of the diamond
    before = {frame: places(addon, sent, frame) for frame in range(1, 10)}
    raw = studio.digests(addon, sent)
    collect(tmp_path)
    report = last_report(addon)
    assert report.kind == "WARNING" and "7 contours taken" in report.text
    assert '"Part 1" on 2 to 8' in report.text and "press Track" in report.text
    assert studio.digests(addon, sent) != raw
    for frame in range(1, 10):
        after = places(addon, sent, frame)
        assert np.array_equal(after[1], before[frame][1]), "bit for bit"
        assert np.allclose(after[2], before[frame][2] + (2.0 if 1 < frame < 9 else 0.0, 0.0), atol=0.01)


def test_a_part_that_is_hidden_meanwhile_stays_hidden(addon, sent, tmp_path):
    part = sent.rototoon.parts[0]
    sent.rototoon.active_part = 0
    for frame in (4, 5, 6):
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.hide_part()
    collect(tmp_path)
    assert [frame for frame in range(1, 10) if part.number in places(addon, sent, frame)] == [1, 2, 3, 7, 8, 9]
    report = last_report(addon)
    assert f'has parts that are hidden since it was sent, and stay so: "{part.name}" on 4 to 6' in report.text, report.text
    assert "press Track" not in report.text


def test_corrections_and_new_keys_stay(addon, sent, tmp_path):
    shots.move(addon, sent, 4, 2, (0.0, 6.0), which=[1])  # a point of the square
    before = places(addon, sent, 4)
    collect(tmp_path)
    after = places(addon, sent, 4)
    assert np.array_equal(after[2], before[2]) and not np.allclose(after[1], before[1], atol=1)
    bpy.context.scene.frame_set(6)
    bpy.ops.rototoon.new_key()
    keyed = shots.snapshot(sent)
    collect(tmp_path)
    assert shots.snapshot(sent) == keyed
    assert '"Part 1" on 2 to 5 and 7 and 8' in last_report(addon).text


def test_one_span_of_a_part_is_taken_where_the_other_changed(addon, sent, tmp_path):
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key()
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"))
    studio.come_back(addon, sent, tmp_path / "farm", 2.0, f"{DAY}_{sent.name}")
    shots.move(addon, sent, 1, 2, (3.0, 3.0))
    before = {frame: places(addon, sent, frame)[2] for frame in (3, 7)}
    collect(tmp_path)
    assert np.array_equal(places(addon, sent, 3)[2], before[3])
    assert np.allclose(places(addon, sent, 7)[2], before[7] + (2.0, 0.0), atol=0.01)


def test_locked_layers_and_other_footage_are_left(addon, sent, tmp_path):
    before = shots.snapshot(sent)
    shots.layer_of(sent).lock = True
    with pytest.raises(RuntimeError, match='the layer "Contours" is locked'):
        collect(tmp_path)
    shots.layer_of(sent).lock = False
    sent.rototoon.width += 1
    with pytest.raises(RuntimeError, match="other footage"):
        collect(tmp_path)
    sent.rototoon.width -= 1
    assert shots.snapshot(sent) == before


def test_shots_without_a_result_are_named(addon, sent, tmp_path):
    results = tmp_path / "farm/results" / f"{DAY}_{sent.name}"
    record = json.loads((results / "batch.json").read_text())
    for change, said in ((lambda: record.update(failure="track: no ink"), "track: no ink"), (record.clear, "damaged")):
        change()
        (results / "batch.json").write_text(json.dumps(record))
        with pytest.raises(RuntimeError, match=said):
            collect(tmp_path)
    os.remove(results / "batch.json")
    with pytest.raises(RuntimeError, match="no result yet"):
        collect(tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "another.blend"))
    with pytest.raises(RuntimeError, match="The batch has no shot of"):
        collect(tmp_path)
    with pytest.raises(RuntimeError, match="Choose the folder"):
        bpy.ops.rototoon.collect_results()
    with pytest.raises(RuntimeError, match="choose the folder that Send to Farm wrote to"):
        bpy.ops.rototoon.collect_results(directory=str(tmp_path / "frames"))


def program():
    """The command line program."""
    named = os.environ.get("ROTOTOON_CLI")
    found = Path(named) if named else Path(__file__).resolve().parents[2] / "target/debug/rototoon"
    if not found.is_file():
        pytest.skip(f"no program {found}: build it, or set ROTOTOON_CLI")
    return found


@pytest.mark.usefixtures("library")
def test_there_and_back_by_the_command(addon, tmp_path):
    """What was sent is what `rototoon batch` reads; what it writes is taken in, and is what Track finds here."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{DAY}.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), use_snap=True)
    words = [program(), "batch", "manifest.json", "-o", "results", "--fine", "keys", "--jobs", "1"]
    done = subprocess.run([str(word) for word in words], cwd=tmp_path / "farm", capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    collect(tmp_path)
    assert last_report(addon).text == "14 contours taken into 1 object"
    assert len(ob.data.layers["Snapped"].frames) == 9
    found = {frame: places(addon, ob, frame) for frame in range(2, 9)}
    bpy.ops.rototoon.track()
    for frame, parts in found.items():
        for number, points in places(addon, ob, frame).items():
            assert np.abs(points - parts[number]).max() < 0.02
    truth = shots.square(4)
    assert np.linalg.norm(found[5][2] - truth, axis=1).max() < 1.5


def test_the_job_files_are_those_of_the_command(addon, sent, tmp_path):
    for engine, name in (("openjd", "template.json"), ("flamenco", "rototoon-batch.js"), ("opencue", "send_to_opencue.py")):
        words = [program(), "job", "manifest.json", "--for", engine, "-o", f"of-{name}"]
        subprocess.run([str(word) for word in words], cwd=tmp_path / "farm", check=True, stderr=subprocess.DEVNULL)
        mine, its = ((tmp_path / "farm" / each).read_text() for each in (name, f"of-{name}"))
        if engine == "openjd":
            mine, its = json.loads(mine), json.loads(its)
            assert (mine.pop("name"), its.pop("name")) == ("Rototoon farm", "Rototoon manifest")
        if engine == "opencue":
            mine = mine.replace('NAME = "rototoon_farm"', 'NAME = "rototoon_manifest"')
        assert mine == its


def test_a_later_version_of_the_file_is_told_which_file_was_sent_and_can_take_its_results(addon, sent, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{DAY}_v002.blend"))
    before = shots.snapshot(sent)
    told = r'no shot of "shot_v002.blend"; "shot.blend" was sent. Open that file, or, .* later version of it, give its name in Sent From: "shot.blend"'
    with pytest.raises(RuntimeError, match=told):
        collect(tmp_path)
    assert shots.snapshot(sent) == before
    bpy.ops.rototoon.collect_results(directory=str(tmp_path / "farm"), sent_from="shot.blend")
    assert "14 contours taken into 1 object" in last_report(addon).text


def test_a_collection_that_took_nothing_says_so_and_why(addon, sent, tmp_path):
    for part in (1, 2):
        shots.move(addon, sent, 9, part, (5.0, 0.0))
    collect(tmp_path)
    report = last_report(addon)
    assert report.kind == "WARNING" and report.text.startswith(f'Nothing was taken into "{sent.name}"')
    assert "was changed since it was sent" in report.text and "0 contours" not in report.text


def test_a_result_without_tracks_is_named(addon, sent, tmp_path):
    path = tmp_path / f"farm/results/{DAY}_{sent.name}/tracked.json"
    document = json.loads(path.read_text())
    for part in document["parts"]:
        part.pop("tracks")
    path.write_text(json.dumps(document))
    collect(tmp_path)
    assert "the results have no contour beside your keys" in last_report(addon).text


def moved(addon, ob, before):
    """How far the contours of all parts have moved to the right on a frame between the keys, by number."""
    now = places(addon, ob, 5)
    return {number: float(np.mean(now[number] - before[number], axis=0)[0]) for number in before}


@pytest.mark.parametrize("listed", [True, False])
def test_parts_with_other_names_get_their_results(addon, sent, tmp_path, listed):
    first, second = sent.rototoon.parts
    if not listed:
        # An older version did not list numbers.
        file = tmp_path / "farm/sent.json"
        known = json.loads(file.read_text())
        del known["shots"][0]["parts"]
        file.write_text(json.dumps(known))
    before, old = places(addon, sent, 5), first.name
    first.name, second.name = "boot", old
    assert collect(tmp_path) == {"FINISHED"}
    assert last_report(addon).kind == "INFO"
    assert moved(addon, sent, before) == pytest.approx(dict.fromkeys(before, 2.0), abs=1e-3)


def test_a_part_with_another_name_and_key_is_named(addon, sent, tmp_path):
    part = sent.rototoon.parts[0]
    shots.move(addon, sent, 1, part.number, (5.0, 0.0))
    part.name = "boot"
    collect(tmp_path)
    report = last_report(addon)
    assert report.kind == "WARNING" and 'stays as it is: "boot" on 2 to 8' in report.text


def test_parts_that_are_gone_or_new_are_named(addon, sent, tmp_path):
    gone, number = sent.rototoon.parts[1].name, sent.rototoon.parts[1].number
    gp = addon("blender.grease_pencil")
    for handle, _ in gp.drawings(shots.layer_of(sent)).values():
        numbers = gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1)
        handle.remove_strokes(indices=np.flatnonzero(numbers == number).tolist())
    shots.draw(addon, sent, 1, [np.array([[100.0, 20], [130, 22], [128, 60], [104, 55]])])
    collect(tmp_path)
    text = last_report(addon).text
    assert f'has no such parts any more, so their results were left out: "{gone}"' in text
    assert 'has parts that are not in the results: "Part 3"; press Track' in text
