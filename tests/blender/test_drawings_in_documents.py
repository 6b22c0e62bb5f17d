"""What the artist drew, traced lines and in-betweens, out of Blender as a document and in again."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import attribute, handle_of, kinds, said
from test_files import close, sorted_keys

KEY, MADE = "KEYFRAME", "GENERATED"


def exported(path):
    """The document of the active object."""
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    return json.loads(path.read_text())


def imported(path, **how):
    """The object of a document."""
    assert bpy.ops.rototoon.import_document(filepath=str(path), **how) == {"FINISHED"}
    return bpy.context.object


def again(path):
    """Exports, imports and exports. Returns the document and the new object, when both documents are the same."""
    one = exported(path)
    ob = imported(path)
    close(one, exported(path.with_stem("again")), 2e-3)
    return one, ob


def document(pictures, **fields):
    """A document of the film with these fields."""
    shot = {"pattern": str(pictures.with_name("line_%03d.png")), "first": 1, "last": 6, "fps": 24.0, "width": ls.SIZE[0], "height": ls.SIZE[1]}
    return {"rototoon": 1, "footage": shot, "parts": [], **fields}


def taken(path, pictures, **fields):
    """The object of a document with these fields."""
    path.write_text(json.dumps(document(pictures, **fields)))
    return imported(path)


def line(k, frame=0, **more):
    """A line of the film as a stroke of a document."""
    points, width, colour = ls.lines(frame)[k]
    return {"points": points.tolist(), "closed": False, "widths": [width] * len(points), "colour": [c / 255 for c in colour], **more}


def moved(addon, ob, frame, by=0.05):
    """Moves the drawing of a frame, as the artist does."""
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, ob, "Lines", frame)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", points + np.float32([by, 0, 0]))


def test_a_drawing_of_the_artist_stays_one(addon, traced, fake, tmp_path):
    moved(addon, traced, 3)
    before = ls.strokes(addon, traced, "Lines", 3)
    document, ob = again(tmp_path / "own.json")
    assert [each["frame"] for each in document["drawings"]] == [3]
    assert [each["frame"] for each in document["traced"]] == [1, 2, 3, 4, 5, 6], "other programs see all frames"
    assert kinds(addon, ob, "Lines") == {**dict.fromkeys(range(1, 7), MADE), 3: KEY}
    assert bpy.ops.rototoon.trace_drawing() == {"FINISHED"}
    after = ls.strokes(addon, ob, "Lines", 3)
    assert list(after) == list(before) and all(np.allclose(after[n], before[n], atol=1e-3) for n in before)
    assert list(ls.strokes(addon, ob, "Lines", 5)) == list(before), "the strokes are the same ones on other frames"


def test_the_messages_count_what_went_out_and_came_in(addon, traced, tmp_path):
    moved(addon, traced, 3)
    exported(tmp_path / "own.json")
    assert said(addon).text == "1 drawing and traced lines of 5 frames in own.json"
    imported(tmp_path / "own.json")
    assert said(addon).text == '1 drawing and 6 traced strokes from own.json, in the new object "own"'


def test_strokes_without_a_number_and_copies_get_numbers_in_the_document(addon, traced, tmp_path):
    gp, st = addon("blender.grease_pencil"), addon("blender.strokes")
    handle = handle_of(addon, traced, "Lines", 4)
    st.add(handle, st.chosen(st.read(handle), [1]))
    ls.put(addon, traced, "Lines", 4, [(ls.lines(3)[4][0] + 5, False)])
    before = attribute(addon, traced, "Lines", 4, gp.TRACK).tolist()
    assert before == [1, 2, 3, 4, 5, 6, 2, 0]
    document, ob = again(tmp_path / "numbers.json")
    (own,) = document["drawings"]
    assert len(own["strokes"]) == 8
    assert [stroke["track"] for stroke in document["traced"][3]["strokes"]] == [0, 1, 2, 3, 4, 5, 6, 7]
    assert attribute(addon, traced, "Lines", 4, gp.TRACK).tolist() == before, "the layer is left as it is"
    assert kinds(addon, ob, "Lines")[4] == KEY and len(ls.strokes(addon, ob, "Lines", 4)) == 8


def test_drawings_of_a_document_are_the_artists(addon, film, fake, pictures, tmp_path):
    drawings = [{"frame": frame, "strokes": [line(0, frame - 1), line(4, frame - 1)]} for frame in (1, 6)]
    ob = taken(tmp_path / "drawn.json", pictures, drawings=drawings)
    assert said(addon).text == '2 drawings from drawn.json, in the new object "drawn"'
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY}
    assert not attribute(addon, ob, "Lines", 6, "rototoon_track").any(), "which stroke is which is not known yet"
    close(document(pictures, drawings=drawings)["drawings"], exported(tmp_path / "out.json")["drawings"])
    bpy.ops.rototoon.trace_drawing()
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY, **dict.fromkeys(range(2, 6), MADE)}
    assert len(ls.strokes(addon, ob, "Lines", 6)) == 2


def test_the_drawing_wins_and_has_the_numbers_of_the_traced_strokes(addon, film, pictures, tmp_path):
    strokes = [line(0), line(4)]
    traced = [{"frame": 1, "strokes": [line(4, track=7), line(0, track=3)]}, {"frame": 2, "strokes": [line(4, 1, track=7)]}]
    ob = taken(tmp_path / "both.json", pictures, drawings=[{"frame": 1, "strokes": strokes}], traced=traced)
    assert said(addon).text == '1 drawing and 1 traced stroke from both.json, in the new object "both"'
    assert list(ls.strokes(addon, ob, "Lines", 1)) == [4, 8] and list(ls.strokes(addon, ob, "Lines", 2)) == [8]


def test_colours_of_drawings_are_kept_exactly(addon, film, pictures, tmp_path):
    near = [line(0, colour=[0.1, 0.1, 0.1]), line(4, colour=[0.1, 0.12, 0.1])]
    taken(tmp_path / "inks.json", pictures, drawings=[{"frame": 1, "strokes": near}])
    found = exported(tmp_path / "out.json")["drawings"][0]["strokes"]
    assert [stroke["colour"] for stroke in found] == [pytest.approx(stroke["colour"], abs=1e-3) for stroke in near]


def test_an_empty_drawing_of_the_artist_stays_empty(addon, traced, tmp_path):
    gp = addon("blender.grease_pencil")
    gp.remove_strokes(handle_of(addon, traced, "Lines", 5), list(range(6)))
    document, ob = again(tmp_path / "empty.json")
    assert document["drawings"] == [{"frame": 5, "strokes": []}]
    assert kinds(addon, ob, "Lines")[5] == KEY and not ls.strokes(addon, ob, "Lines", 5)


def tweened(addon):
    """Two drawings with in-betweens on an object with the film."""
    ob = bpy.context.object
    for frame, which in ((1, (0, 3, 4)), (6, (0, 4))):
        ls.put(addon, ob, "Lines", frame, [(ls.lines(frame - 1)[k][0], False) for k in which])
    bpy.ops.rototoon.in_between(spacing="EASE_IN", leaving="FADE")
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY, **dict.fromkeys(range(2, 6), MADE)}
    return ob


def test_in_betweens_that_were_moved_are_no_drawings_of_the_artist(addon, film, tmp_path):
    ob = tweened(addon)
    exported(tmp_path / "tween.json")
    frames = ob.data.layers["Lines"].frames
    for frame in range(6, 0, -1):
        frames.move(frame, frame + 1)
    imported(tmp_path / "tween.json", into="ACTIVE")
    assert {frame: kind for frame, kind in kinds(addon, ob, "Lines").items() if kind == KEY} == dict.fromkeys((1, 2, 6, 7), KEY)
    assert not any("drawings of yours" in warning for warning in said(addon).warnings if "stay as they were" in warning)


def test_in_betweens_go_out_and_come_in(addon, film, tmp_path):
    ob = tweened(addon)
    before = {frame: ls.strokes(addon, ob, "Lines", frame) for frame in range(1, 7)}
    document, ob = again(tmp_path / "tween.json")
    assert document["drawings"][0]["spacing"] == "ease_in" and "traced" not in document
    assert [each["frame"] for each in document["in_betweens"]] == [2, 3, 4, 5]
    fading = [[stroke["opacity"] for stroke in each["strokes"]] for each in document["in_betweens"]]
    assert all(own[0] == own[2] == 1 for own in fading) and 1 > fading[0][1] > fading[1][1] > fading[3][1]
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY, **dict.fromkeys(range(2, 6), MADE)}
    for frame, strokes in before.items():
        now = ls.strokes(addon, ob, "Lines", frame)
        assert list(now) == list(strokes) and all(np.allclose(now[n], strokes[n], atol=1e-2) for n in now)
    bpy.ops.rototoon.update_in_betweens()
    assert said(addon).text == "Nothing had changed"


def test_a_changed_in_between_of_a_document_is_kept(addon, film, tmp_path):
    tweened(addon)
    exported(tmp_path / "tween.json")
    ob = imported(tmp_path / "tween.json")
    assert said(addon).text == '2 drawings and 4 in-betweens from tween.json, in the new object "tween"'
    moved(addon, ob, 3)
    before = ls.strokes(addon, ob, "Lines", 3)
    bpy.ops.rototoon.update_in_betweens()
    assert kinds(addon, ob, "Lines")[3] == "BREAKDOWN"
    after = ls.strokes(addon, ob, "Lines", 3)
    assert all(np.array_equal(after[number], before[number]) for number in before)


def test_an_in_between_that_the_artist_changed_goes_out_as_a_drawing(addon, film, tmp_path):
    ob = tweened(addon)
    moved(addon, ob, 3)
    before = {frame: ls.strokes(addon, ob, "Lines", frame) for frame in (3, 4)}
    document, back = again(tmp_path / "changed.json")
    assert kinds(addon, ob, "Lines")[3] == MADE, "the layer is left as it is"
    # The share of the way was the square of the time.
    assert [(each["frame"], each.get("spacing")) for each in document["drawings"]] == [(1, [0.25]), (3, [0.238095, 0.571429]), (6, None)]
    assert [each["frame"] for each in document["in_betweens"]] == [2, 4, 5]
    assert [(each["frame"], each["next"]) for each in document["matches"]] == [(1, 3), (3, 6)]
    assert kinds(addon, back, "Lines") == {**dict.fromkeys(range(1, 7), MADE), 1: KEY, 3: KEY, 6: KEY}
    for frame, strokes in before.items():
        now = ls.strokes(addon, back, "Lines", frame)
        assert list(now) == list(strokes) and all(np.allclose(now[n], strokes[n], atol=1e-2) for n in now)


@pytest.mark.parametrize("known", [True, False])
def test_a_recoloured_in_between_goes_out_as_a_drawing_of_a_renamed_layer_too(addon, film, tmp_path, known):
    gp, ob = addon("blender.grease_pencil"), tweened(addon)
    handle = handle_of(addon, ob, "Lines", 4)
    gp.put(handle, "radius", gp.value(handle, "radius", int(gp.offsets(handle)[-1])) * 2)
    if not known:
        del ob.data["rototoon_tween"]
    document = exported(tmp_path / "recoloured.json")
    assert [each["frame"] for each in document["drawings"]] == [1, 4, 6]
    assert [each["frame"] for each in document["in_betweens"]] == [2, 3, 5]


def test_colours_of_in_betweens_need_no_materials_of_their_own(addon, film, pictures, tmp_path):
    drawings = [{"frame": frame, "strokes": [line(4, colour=[red, 0, 0])]} for frame, red in ((1, 0.0), (4, 0.9))]
    between = [{"frame": frame, "strokes": [line(4, track=0, colour=[red, 0, 0], opacity=1)]} for frame, red in ((2, 0.3), (3, 0.6))]
    matches = [{"frame": 1, "next": 4, "tracks": [[0], [0]]}]
    ob = taken(tmp_path / "red.json", pictures, drawings=drawings, in_betweens=between, matches=matches)
    close(sorted_keys(between), sorted_keys(exported(tmp_path / "out.json")["in_betweens"]))
    assert len({int(attribute(addon, ob, "Lines", frame, "material_index")[0]) for frame in range(1, 5)}) == 2


def test_fills_of_in_betweens_need_no_materials_of_their_own(addon, film, pictures, tmp_path):
    both = lambda red, **more: line(4, closed=True, colour=[0, 0, 0], fill_colour=[red, 0, 0.5], **more)  # noqa: E731
    drawings = [{"frame": frame, "strokes": [both(red)]} for frame, red in ((1, 0.0), (4, 0.9))]
    between = [{"frame": frame, "strokes": [both(red, track=0, opacity=1)]} for frame, red in ((2, 0.3), (3, 0.6))]
    matches = [{"frame": 1, "next": 4, "tracks": [[0], [0]]}]
    ob = taken(tmp_path / "red.json", pictures, drawings=drawings, in_betweens=between, matches=matches)
    close(sorted_keys(between), sorted_keys(exported(tmp_path / "out.json")["in_betweens"]))
    assert len({int(attribute(addon, ob, "Lines", frame, "material_index")[0]) for frame in range(1, 5)}) == 2


def test_pieces_have_one_number_on_all_in_betweens(addon, film, pictures, tmp_path):
    drawings = [{"frame": frame, "strokes": [line(4)]} for frame in (1, 4)]
    between = [{"frame": frame, "strokes": [line(4, track=0), line(3, track=0)]} for frame in (2, 3)]
    taken(tmp_path / "pieces.json", pictures, drawings=drawings, in_betweens=between)
    found = exported(tmp_path / "out.json")["in_betweens"]
    assert [[stroke["track"] for stroke in each["strokes"]] for each in found] == [[0, found[0]["strokes"][1]["track"]]] * 2


def test_in_betweens_have_no_pegs(addon, film, pictures, tmp_path):
    pegs = [{"name": "arm", "parent": None, "pivot": [10, 10], "keys": []}]
    drawings = [{"frame": frame, "strokes": [line(4, frame - 1, peg="arm", material=2)]} for frame in (1, 5)]
    taken(tmp_path / "pegs.json", pictures, drawings=drawings, pegs=pegs)
    bpy.ops.rototoon.in_between()
    found = exported(tmp_path / "out.json")
    assert {(stroke.get("peg"), stroke["material"]) for each in found["in_betweens"] for stroke in each["strokes"]} == {(None, 2)}
    assert found["drawings"][0]["strokes"][0]["peg"] == "arm"


def test_a_saved_file_has_the_same_kinds_of_drawings(addon, traced, tmp_path):
    moved(addon, traced, 3)
    exported(tmp_path / "own.json")
    ob = imported(tmp_path / "own.json")
    before = kinds(addon, ob, "Lines")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "own.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "own.blend"))
    assert kinds(addon, bpy.context.object, "Lines") == before


@pytest.mark.parametrize("known", [True, False])
def test_in_betweens_that_may_have_been_changed_are_not_replaced(addon, film, pictures, tmp_path, known):
    ob = tweened(addon)
    moved(addon, ob, 3)
    if not known:
        # As on a layer that was renamed.
        del ob.data["rototoon_tween"]
    before = ls.strokes(addon, ob, "Lines", 3)
    path = tmp_path / "new.json"
    path.write_text(json.dumps(document(pictures, drawings=[{"frame": 3, "strokes": [line(4)]}])))
    imported(path, into="ACTIVE", keep_numbers=True)
    assert said(addon).warnings == ("drawings of yours stay as they were, on 3",)
    after = ls.strokes(addon, ob, "Lines", 3)
    assert all(np.array_equal(after[number], before[number]) for number in before)
    assert sorted(kinds(addon, ob, "Lines")) == [1, 2, 3, 4, 5, 6]


def test_a_document_that_comes_back_into_its_object_takes_nothing_away(addon, film, tmp_path):
    ob = tweened(addon)
    bpy.ops.rototoon.in_between(spacing="CHART", chart="10, 20, 60, 90")
    before = {frame: ls.strokes(addon, ob, "Lines", frame) for frame in range(1, 7)}
    record = ob.data["rototoon_tween"]
    exported(tmp_path / "back.json")
    assert imported(tmp_path / "back.json", into="ACTIVE", keep_numbers=True) == ob
    assert said(addon).warnings == ("drawings of yours stay as they were, on 1 and 6", "in-betweens of this object stay as they were, on 2 to 5")
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY, **dict.fromkeys(range(2, 6), MADE)}
    for frame, strokes in before.items():
        now = ls.strokes(addon, ob, "Lines", frame)
        assert list(now) == list(strokes) and all(np.array_equal(now[n], strokes[n]) for n in now)
    assert ob.data["rototoon_tween"] == record
    bpy.ops.rototoon.update_in_betweens()
    assert said(addon).text == "Nothing had changed"


def test_in_betweens_beside_drawings_that_stay_are_named(addon, film, tmp_path):
    ob = tweened(addon)
    document = exported(tmp_path / "back.json")
    bpy.ops.rototoon.clear_in_betweens()
    document["pairs"] = [{"frame": 1, "from": 0, "to": 1}]
    (tmp_path / "back.json").write_text(json.dumps(document))
    imported(tmp_path / "back.json", into="ACTIVE", keep_numbers=True)
    assert kinds(addon, ob, "Lines") == {1: KEY, 6: KEY}
    assert said(addon).warnings == (
        "drawings of yours stay as they were, on 1 and 6",
        "left out: 4 in-betweens beside drawings of yours that stay, on 2 to 5; press In-between there",
        "left out: 1 pair of strokes on drawings of yours that stay; pair them by Match Strokes",
    )


def test_a_drawing_that_comes_in_between_own_ones_replaces_its_own_frame_alone(addon, film, pictures, tmp_path):
    ob = tweened(addon)
    path = tmp_path / "new.json"
    path.write_text(json.dumps(document(pictures, drawings=[{"frame": 3, "strokes": [line(0), line(3), line(4)]}])))
    imported(path, into="ACTIVE", keep_numbers=True)
    assert said(addon).warnings == ()
    assert kinds(addon, ob, "Lines") == {**dict.fromkeys(range(1, 7), MADE), 1: KEY, 3: KEY, 6: KEY}
    bpy.ops.rototoon.update_in_betweens()
    assert said(addon).text.startswith("3 in-betweens in 2 spans")


def test_in_betweens_that_come_in_with_both_their_drawings_replace_those_of_the_layer(addon, film, pictures, tmp_path):
    ob = tweened(addon)
    path = tmp_path / "new.json"
    drawings = [{"frame": frame, "strokes": [line(0), line(4)]} for frame in (2, 5)]
    between = [{"frame": 4, "strokes": [line(0, track=0), line(4, track=1)]}]
    path.write_text(json.dumps(document(pictures, drawings=drawings, in_betweens=between)))
    imported(path, into="ACTIVE", keep_numbers=True)
    assert said(addon).text == "2 drawings and 1 in-between from new.json"
    assert kinds(addon, ob, "Lines") == {1: KEY, 2: KEY, 4: MADE, 5: KEY, 6: KEY}
    assert len(ls.strokes(addon, ob, "Lines", 4)) == 2


def test_in_betweens_between_no_drawings_are_told(addon, film, pictures, tmp_path):
    between = [{"frame": frame, "strokes": [line(0, track=0)]} for frame in (2, 5)]
    ob = taken(tmp_path / "some.json", pictures, drawings=[{"frame": f, "strokes": [line(0)]} for f in (1, 4)], in_betweens=between)
    assert kinds(addon, ob, "Lines") == {1: KEY, 2: MADE, 4: KEY}
    assert said(addon).warnings == ("left out: 1 in-between that lies between no two drawings of the document",)


def test_pairs_and_what_blender_has_no_place_for_stay(addon, film, pictures, tmp_path):
    pegs = [{"name": "arm", "parent": None, "pivot": [10, 10], "keys": []}]
    strokes = [line(0, note="x"), line(4, peg="arm", material=2)]
    drawings = [{"frame": 1, "corner": True, "strokes": strokes}, {"frame": 4, "spacing": [0.5], "strokes": [line(0), line(4)]}, {"frame": 6, "strokes": [line(0)]}]
    pairs = [{"frame": 1, "from": 0, "to": 1}, {"frame": 1, "from": 1, "to": None}]
    ob = taken(tmp_path / "more.json", pictures, drawings=drawings, pairs=pairs, pegs=pegs)
    found = exported(tmp_path / "out.json")
    close(drawings, found["drawings"])
    assert found["pairs"] == pairs and found["pegs"] == pegs
    addon("blender.grease_pencil").remove_strokes(handle_of(addon, ob, "Lines", 1), [0])
    found = exported(tmp_path / "out.json")
    assert [stroke.get("peg") for stroke in found["drawings"][0]["strokes"]] == ["arm"]
    assert found["pairs"] == [{"frame": 1, "from": 0, "to": None}]


def test_the_artists_own_drawings_are_not_replaced(addon, film, fake, pictures, tmp_path):
    ob = taken(tmp_path / "one.json", pictures, drawings=[{"frame": 1, "strokes": [line(0)]}])
    bpy.ops.rototoon.trace_drawing()
    path = tmp_path / "two.json"
    path.write_text(json.dumps(document(pictures, drawings=[{"frame": f, "strokes": [line(4), line(3)]} for f in (1, 5)])))
    assert imported(path, into="ACTIVE", keep_numbers=True) == ob
    assert said(addon).warnings == ("drawings of yours stay as they were, on 1",)
    assert kinds(addon, ob, "Lines") == {1: KEY, 5: KEY}
    assert len(ls.strokes(addon, ob, "Lines", 1)) == 1 and len(attribute(addon, ob, "Lines", 5, "cyclic")) == 2


def test_drawings_that_an_earlier_version_kept_beside_the_layer_stay(addon, traced, tmp_path):
    old = {"drawings": [{"frame": 2, "strokes": [line(4)]}], "pairs": [], "note": 1}
    traced.rototoon.extra = json.dumps(old)
    moved(addon, traced, 3)
    found = exported(tmp_path / "old.json")
    assert [each["frame"] for each in found["drawings"]] == [2, 3] and found["drawings"][0] == old["drawings"][0] and found["note"] == 1


def test_lines_on_another_layer_are_told(addon, film, tmp_path):
    ls.put(addon, film, "Ink", 1, [(ls.lines(0)[4][0], False)])
    with pytest.raises(RuntimeError, match='no contours on the layer "Contours", no lines on "Lines" and no paint on "Paint"'):
        exported(tmp_path / "no.json")
    ls.put(addon, film, "Lines", 1, [(ls.lines(0)[3][0], False)])
    exported(tmp_path / "lines.json")
    assert said(addon).warnings == ('left out: lines on "Ink"; those of "Lines" are written, the layer in the panel Lines',)
    film.rototoon.lines_layer = "Ink"
    assert len(exported(tmp_path / "ink.json")["drawings"]) == 1


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"drawings": 3}, "drawings: found 3, expected a list of drawings"),
        ({"drawings": [{"frame": 1, "strokes": [{"points": [[1]]}]}]}, r"drawings\[0\].strokes\[0\].points: found \[\[1\]\], expected a list of points"),
        ({"drawings": [{"frame": 2, "strokes": []}, {"frame": 1, "strokes": []}]}, r"drawings\[1\].frame: found 1, expected more than 2, that of drawings\[0\]"),
        ({"in_betweens": [{"frame": 2, "strokes": [{"points": [[1, 2]]}]}]}, r"in_betweens\[0\].strokes\[0\].track: found nothing, expected a number from 0"),
        (
            {"drawings": [{"frame": f, "strokes": [line(0)]} for f in (1, 4)], "pairs": [{"frame": 1, "from": 1, "to": 0}]},
            r"pairs\[0\].from: found 1, expected the index of one of the 1 strokes on frame 1",
        ),
    ],
)
def test_bad_drawings_are_named(addon, film, pictures, tmp_path, fields, message):
    before = len(bpy.data.objects)
    with pytest.raises(RuntimeError, match=message):
        taken(tmp_path / "bad.json", pictures, **fields)
    assert len(bpy.data.objects) == before


def test_strokes_with_a_line_and_a_fill_keep_both_colours(addon, film, tmp_path):
    gp, ob = addon("blender.grease_pencil"), bpy.context.object
    square = np.array([[20.0, 20], [60, 20], [60, 50], [20, 50]])
    ls.put(addon, ob, "Lines", 1, [(square + 40 * k, True) for k in range(3)])
    material = bpy.data.materials.new("both")
    bpy.data.materials.create_gpencil_data(material)
    style = material.grease_pencil
    style.color, style.fill_color = (1, 0, 0, 1), (0, 1, 0, 1)
    ob.data.materials.append(material)
    handle = handle_of(addon, ob, "Lines", 1)
    gp.put(handle, "material_index", np.full(3, len(ob.data.materials) - 1, np.int32))
    if gp.FILL_BY_ID:
        # A line, a line with a fill, a fill.
        gp.put(handle, "fill_id", np.array([0, 1, 2], np.int32))
        gp.put(handle, "hide_stroke", np.array([False, False, True]))
    else:
        style.show_stroke = style.show_fill = True
    document, back = again(tmp_path / "both.json")
    strokes = document["drawings"][0]["strokes"]
    both = strokes[1]
    assert both["colour"] == [1, 0, 0] and both["fill_colour"] == [0, 1, 0] and "fill" not in both and both["widths"]
    if gp.FILL_BY_ID:
        assert "fill_colour" not in strokes[0] and "fill_colour" not in strokes[2] and strokes[2]["fill"]
        assert (attribute(addon, back, "Lines", 1, "fill_id") != 0).tolist() == [False, True, True]
        assert attribute(addon, back, "Lines", 1, "hide_stroke").tolist() == [False, False, True]
    material = back.data.materials[attribute(addon, back, "Lines", 1, "material_index")[1]].grease_pencil
    assert tuple(material.color)[:3] == (1, 0, 0) and tuple(material.fill_color)[:3] == (0, 1, 0)
    assert said(addon).warnings == ()


def test_traced_strokes_of_a_document_keep_line_and_fill(addon, film, pictures, tmp_path):
    gp = addon("blender.grease_pencil")
    both = line(4, track=1, closed=True, colour=[0.2, 0, 0], fill_colour=[0, 0.6, 0])
    ob = taken(tmp_path / "traced.json", pictures, traced=[{"frame": frame, "strokes": [line(0, frame - 1, track=0), both]} for frame in (1, 2)])
    found = exported(tmp_path / "out.json")["traced"]
    for each in found:
        stroke = each["strokes"][1]
        assert stroke["colour"] == pytest.approx([0.2, 0, 0], abs=1e-3) and stroke["fill_colour"] == pytest.approx([0, 0.6, 0], abs=1e-3)
        assert "fill_colour" not in each["strokes"][0]
    if gp.FILL_BY_ID:
        assert (attribute(addon, ob, "Lines", 2, "fill_id") != 0).tolist() == [False, True]


@pytest.mark.parametrize("change", [{"fill_colour": [1, 0]}, {"fill": True, "closed": True, "fill_colour": [1, 0, 0]}])
def test_a_wrong_fill_colour_is_named(addon, film, pictures, tmp_path, change):
    with pytest.raises(RuntimeError, match=r"drawings\[0\].strokes\[0\].fill_colour: found a list of|fill_colour: found \[1, 0"):
        taken(tmp_path / "wrong.json", pictures, drawings=[{"frame": 1, "strokes": [line(0, **change)]}])


def test_a_shape_whose_line_is_hidden_goes_out_without_a_line(addon, film, tmp_path):
    gp, ob = addon("blender.grease_pencil"), bpy.context.object
    square = np.array([[20.0, 20], [60, 20], [60, 50], [20, 50]])
    ls.put(addon, ob, "Lines", 1, [(square, True)])
    handle = handle_of(addon, ob, "Lines", 1)
    if gp.FILL_BY_ID:
        gp.put(handle, "fill_id", np.array([1], np.int32))
    else:
        ob.data.materials[0].grease_pencil.show_fill = True
    gp.put(handle, "opacity", np.zeros(4, np.float32))
    (stroke,) = exported(tmp_path / "hidden.json")["drawings"][0]["strokes"]
    assert stroke["fill"] and "widths" not in stroke and "fill_colour" not in stroke
