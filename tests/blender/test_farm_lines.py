"""Send to Farm and Collect Results with line drawings, on the small line film, by the command line program.

What Collect Results writes is compared with what Trace Drawing and Carry Strokes write into the same file.
"""

import json
import shutil

import bpy
import line_shots as ls
import looks
import numpy as np
import pytest
import shots
import studio
import test_farm_paint
from line_stage import film, pictures  # noqa: F401 - fixtures
from line_stage import handle_of, kinds, said
from test_farm_paint import collect, work
from test_paint import GREEN, click, places

ARM, BODY, MOUTH = 4, 0, 3


def send(tmp_path, **options):
    """Sends the open file. Returns the shots of the manifest and their documents."""
    test_farm_paint.send_all(tmp_path, **options)
    made = json.loads((tmp_path / "farm/manifest.json").read_text())
    steps = [shot.get("steps", made["steps"]) for shot in made["shots"]]
    return steps, [json.loads((tmp_path / "farm" / shot["project"]).read_text()) for shot in made["shots"]]


def opened(tmp_path):
    """The object of the file as it was sent."""
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "film.blend"))
    return bpy.context.object


def drawn(addon, ob):
    """By layer and frame the kind of a drawing, and its content; material numbers are names."""
    gp, strokes, found = addon("blender.grease_pencil"), addon("blender.strokes"), {}
    names = np.array([material.name if material else "" for material in ob.data.materials] or [""])
    for layer in ob.data.layers:
        for frame, (handle, kind) in gp.drawings(layer).items():
            content = strokes.read(handle)
            found[layer.name, frame] = kind, content, names[content.strokes("material_index")].tolist()
    return found


def equal(one, other):
    """Two objects have the same drawings, bit for bit."""
    assert one.keys() == other.keys()
    for place, (kind, content, materials) in one.items():
        assert (kind, materials) == (other[place][0], other[place][2]), place
        for mine, its in ((content.point, other[place][1].point), (content.curve, other[place][1].curve)):
            assert mine.keys() == its.keys(), place
            for name in mine.keys() - {"material_index"}:
                assert np.array_equal(mine[name], its[name]), (place, name)


def one_line(addon, ob, layer, frames, which=ARM):
    for frame in frames:
        ls.put(addon, ob, layer, frame, [(ls.lines(frame - 1)[which][0], False)])


def move(addon, ob, layer, frame):
    """The artist moves the points of a drawing."""
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, ob, layer, frame)
    points = gp.positions(handle, int(gp.offsets(handle)[-1])) + np.float32([0.2, 0, 0])
    gp.put(handle, "position", points)
    handle.tag_positions_changed()


def test_a_film_is_traced_there_as_here(addon, film, tmp_path):  # noqa: F811
    film.rototoon.line_style, film.rototoon.line_sensitivity = "CLEAN", 1.25
    film.rototoon.line_leave_out = film.rototoon.line_paint_only = True
    film.rototoon.line_border = (0.2, 0.8, 0.2)
    before = shots.snapshot(film)
    steps, (document,) = send(tmp_path, lines="TRACE")
    assert steps == [[{"do": "check"}, {"do": "trace", "style": "clean", "sensitivity": 1.25, "leave_out": "#a4dded,#33cc33"}]]
    assert document["parts"] == [] and document["drawings"] == [] and "traced" not in document
    assert shots.snapshot(film) == before, "sending changes nothing"
    assert said(addon).warnings == (), "contours are not missed"
    work(tmp_path)
    collect(tmp_path)
    assert said(addon).text == "6 traced strokes taken into 1 object"
    assert kinds(addon, film, "Lines") == dict.fromkeys(range(1, 7), "GENERATED")
    taken, raw, records = drawn(addon, film), studio.digests(addon, film), film.data["rototoon_lines"]
    collect(tmp_path)
    assert studio.digests(addon, film) == raw, "a second time changes nothing"
    ob = opened(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    equal(taken, drawn(addon, ob))
    assert ob.data["rototoon_lines"] == records


def test_strokes_of_several_layers_are_carried(addon, film, tmp_path):  # noqa: F811
    """Layers with drawings on the same frames go into one document, others into one of their own. A locked layer is left."""
    material = bpy.data.materials.new("mine")
    bpy.data.materials.create_gpencil_data(material)
    film.data.materials.append(material)
    one_line(addon, film, "Ink", (1, 6))
    ls.put(addon, film, "Shade", 1, [(ls.lines(0)[5][0], False)], material=len(film.data.materials) - 1)
    ls.put(addon, film, "Shade", 6, [(ls.lines(5)[5][0], False)], material=len(film.data.materials) - 1)
    one_line(addon, film, "Face", (3,), MOUTH)
    one_line(addon, film, "Notes", (1,), BODY)
    film.data.layers["Notes"].lock = True
    film.data.layers.active = film.data.layers["Shade"]
    steps, documents = send(tmp_path, lines="CARRY", new_lines=True)
    assert [[step["do"] for step in each] for each in steps] == [["check", "trace"]] * 2
    assert [[(d["frame"], len(d["strokes"])) for d in each["drawings"]] for each in documents] == [[(1, 2), (6, 2)], [(3, 1)]]
    assert 'its lines: left as it was: the layer "Notes" is locked' in said(addon).text
    work(tmp_path)
    collect(tmp_path)
    taken = drawn(addon, film)
    assert list(kinds(addon, film, "Notes")) == [1] and taken["Shade", 4][2][0] == "mine"
    ob = opened(tmp_path)
    bpy.ops.rototoon.carry_strokes(layers="ALL", new_lines=True)
    equal(taken, drawn(addon, ob))
    assert len(ls.strokes(addon, ob, "Shade", 3)) > 1, "new lines are on the active layer"


def test_only_the_artists_strokes_are_carried_if_no_new_lines_are_wanted(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Ink", (2,))
    send(tmp_path, lines="CARRY")
    work(tmp_path)
    collect(tmp_path)
    assert said(addon).text == "1 traced stroke taken into 1 object"
    taken = drawn(addon, film)
    ob = opened(tmp_path)
    bpy.ops.rototoon.carry_strokes()
    equal(taken, drawn(addon, ob))


def test_lines_are_sent_where_the_artist_drew(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Ink", (1,))
    with pytest.raises(RuntimeError, match="Nothing to send"):
        send(tmp_path)
    one_line(addon, film, "Lines", (1,))
    with pytest.raises(RuntimeError, match="Nothing to send"):
        send(tmp_path, lines="NONE")
    _, (document,) = send(tmp_path)
    assert [len(each["strokes"]) for each in document["drawings"]] == [1]
    film.data.layers["Lines"].lock = True
    with pytest.raises(RuntimeError, match='its lines: the layer "Lines" is locked'):
        send(tmp_path)
    film.data.layers["Lines"].lock = False
    film.data.layers.active = film.data.layers["Ink"]
    send(tmp_path, lines="CARRY")
    (listed,) = json.loads((tmp_path / "farm/sent.json").read_text())["shots"]
    assert listed["lines"] == {"layers": ["Ink", "Lines"], "home": "Lines", "new": True, "hold": True}, "as Carry Strokes"


def test_objects_without_strokes_are_sent_without_lines(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Ink", (1,))
    gp = addon("blender.grease_pencil")
    gp.remove_frames(film.data.layers["Ink"], [1])
    film.data.layers["Ink"].frames.new(2)
    shots.draw(addon, film, 1, [ls.lines(0)[BODY][0][:-1:8]])
    for options in ({"lines": "CARRY"}, {"lines": "CARRY", "new_lines": True}, {}):
        ((steps,), _) = send(tmp_path, **options)
        assert [step["do"] for step in steps] == ["check", "track"] and said(addon).warnings == ()
    film.rototoon.lines_layer = "Contours"
    send(tmp_path, lines="TRACE")
    assert 'The layer "Contours" has contours, snapped lines or paint' in said(addon).text


def test_lines_that_could_not_be_taken_in_are_not_sent(addon, film, tmp_path):  # noqa: F811
    bpy.context.scene.collection.objects.link(film.copy())
    with pytest.raises(RuntimeError, match='"line": .*its lines: "line" shares its drawings with "line.001"'):
        send(tmp_path, lines="TRACE")


def test_held_pictures_become_held_drawings(addon, film, pictures, tmp_path):  # noqa: F811
    for number, source in enumerate((1, 1, 2, 3, 3, 3), 1):
        shutil.copy(pictures.with_name(f"line_{source:03}.png"), tmp_path / f"line_{number:03}.png")
    film.rototoon.pattern, film.rototoon.frame_offset = str(tmp_path / "line_%03d.png"), 10
    send(tmp_path, lines="TRACE")
    work(tmp_path)
    collect(tmp_path)
    assert list(kinds(addon, film, "Lines")) == [11, 13, 14]
    taken = drawn(addon, film)
    ob = opened(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    equal(taken, drawn(addon, ob))
    send(tmp_path, lines="TRACE", hold=False)
    collect(tmp_path)
    assert list(kinds(addon, ob, "Lines")) == list(range(11, 17))


def test_a_traced_drawing_that_was_changed_before_is_followed(addon, film, tmp_path):  # noqa: F811
    bpy.ops.rototoon.trace_drawing()
    move(addon, film, "Lines", 3)
    _, (document,) = send(tmp_path)
    assert [each["frame"] for each in document["drawings"]] == [3]
    assert kinds(addon, film, "Lines")[3] == "GENERATED"
    work(tmp_path)
    collect(tmp_path)
    assert "taken into 1 object, 1 drawing that you had changed is a key now" in said(addon).text
    taken = drawn(addon, film)
    ob = opened(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    assert kinds(addon, ob, "Lines")[3] == "KEYFRAME"
    equal(taken, drawn(addon, ob))


def test_lines_that_were_changed_meanwhile_stay(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Lines", (1, 6))
    send(tmp_path)
    work(tmp_path)
    collect(tmp_path)
    assert "traced strokes taken into 1 object" in said(addon).text
    move(addon, film, "Lines", 4)
    assert_stays(addon, film, tmp_path, "Nothing was taken.*its drawings on the layer \"Lines\" were changed since they were sent.*press Trace Drawing")
    assert kinds(addon, film, "Lines")[4] == "GENERATED", "only the operators make it a key"
    film = opened(tmp_path)  # noqa: F811
    collect(tmp_path)
    looks.CHANGES["opacity"](addon, handle_of(addon, film, "Lines", 4))
    assert_stays(addon, film, tmp_path, "were changed since they were sent")
    film = opened(tmp_path)
    move(addon, film, "Lines", 6)
    assert_stays(addon, film, tmp_path, "were changed since they were sent")
    film, gp = opened(tmp_path), addon("blender.grease_pencil")
    gp.put(handle_of(addon, film, "Lines", 6), "cyclic", np.array([True]))
    assert_stays(addon, film, tmp_path, "were changed since they were sent")
    film = opened(tmp_path)
    film.data.materials[0].grease_pencil.color = (1, 0, 0, 1)
    assert_stays(addon, film, tmp_path, "were changed since they were sent")
    film = opened(tmp_path)
    gp.remove_frames(gp.find_layer(film, "Lines"), [1, 6])
    assert_stays(addon, film, tmp_path, "were changed since they were sent")


def assert_stays(addon, ob, tmp_path, why):
    before, records = studio.digests(addon, ob), ob.data.get("rototoon_lines")
    with pytest.raises(RuntimeError, match=why):
        collect(tmp_path)
    assert studio.digests(addon, ob) == before and ob.data.get("rototoon_lines") == records


def test_closed_layers_and_blank_drawings_stay(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Ink", (1,))
    send(tmp_path, lines="CARRY")
    work(tmp_path)
    layer = film.data.layers["Ink"]
    for name in ("lock", "hide"):
        setattr(layer, name, True)
        assert_stays(addon, film, tmp_path, 'the layer "Ink" is (locked|hidden)')
        setattr(layer, name, False)
    film.rototoon.last = 5
    assert_stays(addon, film, tmp_path, r"other footage than what was sent \(last 5, not 6\)")
    film.rototoon.last, film.rototoon.contours_layer = 6, "Ink"
    assert_stays(addon, film, tmp_path, 'The layer "Ink" has contours')
    film.rototoon.contours_layer = "Contours"
    layer.frames.new(3)
    collect(tmp_path)
    assert kinds(addon, film, "Ink")[3] == "KEYFRAME" and not ls.strokes(addon, film, "Ink", 3)
    assert ls.strokes(addon, film, "Ink", 4)


def test_contours_lines_and_paint_go_together(addon, film, tmp_path):  # noqa: F811
    for place, colour in places(1):
        click(film, place, colour)
    for frame in (1, 6):
        shots.draw(addon, film, frame, [ls.lines(frame - 1)[BODY][0][:-1:8]])
    film.data.update_tag()
    bpy.context.scene.frame_set(6)
    bpy.ops.rototoon.match_contours()
    one_line(addon, film, "Lines", (1,))
    (steps,), (document,) = send(tmp_path)
    assert [step["do"] for step in steps] == ["check", "track", "trace", "fill"]
    assert len(document["parts"]) == len(document["fills"]) == len(document["drawings"]) == 1
    work(tmp_path)
    collect(tmp_path)
    assert "4 contours, 6 traced strokes and 24 painted regions taken into 1 object" in said(addon).text
    taken = drawn(addon, film)
    ob = opened(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    lines = {place: each for place, each in drawn(addon, ob).items() if place[0] == "Lines"}
    equal({place: each for place, each in taken.items() if place[0] == "Lines"}, lines)
    # What was changed of one stays; the others are taken.
    ob = opened(tmp_path)
    move(addon, ob, "Lines", 1)
    bpy.context.scene.frame_set(6)
    click(ob, places(6)[2][0], GREEN)
    collect(tmp_path)
    report = said(addon).text
    assert report.startswith("4 contours taken into 1 object") and "its shapes were changed" in report and "its drawings on the layer" in report


def test_results_that_do_not_fit_are_named(addon, film, tmp_path):  # noqa: F811
    one_line(addon, film, "Lines", (1, 6))
    send(tmp_path)
    listed, sent = tmp_path / "farm/sent.json", json.loads((tmp_path / "farm/sent.json").read_text())
    work(tmp_path)
    found = tmp_path / "farm/results" / sent["shots"][0]["shot"] / "traced.json"
    document = json.loads(found.read_text())
    for change, why in (
        (lambda d: d["traced"].pop(), "traced.json: traced: found no drawing on picture 6, expected the 1 stroke of the drawing that was sent"),
        (lambda d: d.pop("traced"), "its lines have no result yet: start the batch again"),
        (lambda d: d["traced"][5].update(strokes=d["traced"][5]["strokes"] * 0), "found 0 strokes on picture 6"),
        (lambda d: d["traced"][2]["strokes"][0].update(widths=[1]), r"traced.json: traced\[2\] .*strokes\[0\].widths: found a list of 1"),
    ):
        broken = json.loads(json.dumps(document))
        change(broken)
        found.write_text(json.dumps(broken))
        assert_stays(addon, film, tmp_path, why)
    for lines, why in (
        (3, "found 3, expected an object with layers, home, new and hold"),
        ({"layers": "Lines"}, r'layers: found "Lines", expected names of layers'),
        ({"layers": ["Lines"], "home": "Ink"}, 'home: found "Ink", expected one of the layers'),
        ({"layers": ["Lines"], "home": "Lines", "new": 1}, "new: found 1, expected true or false"),
    ):
        sent["shots"][0]["lines"] = lines
        listed.write_text(json.dumps(sent))
        assert_stays(addon, film, tmp_path, rf"sent.json: shots\[0\]\.lines.*{why}")


def test_lines_of_the_files_of_a_folder(addon, film, tmp_path):  # noqa: F811
    """Each file is opened in a Blender of its own, which is told which lines are sent."""
    one_line(addon, film, "Ink", (1,))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "film.blend"))
    bpy.ops.rototoon.send_to_farm(directory=str(tmp_path / "farm"), which="FOLDER", lines="CARRY", new_lines=True)
    (listed,) = json.loads((tmp_path / "farm/sent.json").read_text())["shots"]
    assert listed["lines"] == {"layers": ["Ink"], "home": "Ink", "new": True, "hold": True}
