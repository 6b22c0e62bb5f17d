"""The bpy-free Python API against the built library."""

import array
import gc
import json
import os
import threading

import pytest
from conftest import LAST, square, write_png
from rototoon import Cancelled, Exchange, RototoonError, Session, WeakestFrame, documents, match_contours, outcomes, parameters, version

FRAMES = list(range(LAST + 1))


def test_track_fills_every_frame_and_keeps_keys(session, document):
    summary = session.track()
    assert [(job.part, job.first, job.last) for job in summary.jobs] == [
        ("red", 0, 6),
        ("red", 6, 12),
        ("blau ü", 0, 6),
        ("blau ü", 6, 12),
    ]
    assert (summary.solved, summary.reused, summary.exchanges, summary.unseen) == (4, 0, [], [])
    for index, name in enumerate(session.parts()):
        track = session.tracks(name)
        assert (track.frames.format, track.frames.tolist()) == ("i", FRAMES)
        assert (track.points.format, track.points.shape) == ("d", (13, 4, 2))
        assert session.confidence(name).shape == (13, 4)
        points = track.points.tolist()
        for frame in (0, 6, 12):
            assert points[frame] == square(frame, index)
            assert session.confidence(name).tolist()[frame] == [1.0] * 4
    written = session.document()["parts"][0]
    expected = session.tracks("red").points.tolist()[5]
    assert [list(map(float, p)) for p in written["tracks"]["5"]] == [pytest.approx(p, abs=1e-4) for p in expected]


def test_only_touched_spans_are_solved_again(session):
    session.track()
    before = {name: session.tracks(name).points.tolist() for name in session.parts()}
    assert (session.track().solved, session.track().reused) == (0, 4)

    session.pin("red", 9, 2, (41.0, 27.5))
    summary = session.track()
    assert [(job.part, job.first) for job in summary.jobs if job.solved] == [("red", 6)]
    assert summary.reused == 3
    after = session.tracks("red").points.tolist()
    assert after[9][2] == [41.0, 27.5]
    assert after[:7] == before["red"][:7]
    assert session.tracks("blau ü").points.tolist() == before["blau ü"]

    center = [sum(p[axis] for p in before["blau ü"][3]) / 4 + move for axis, move in ((0, 1.5), (1, -1.0))]
    session.set_center("blau ü", 3, tuple(center))
    assert [(job.part, job.first) for job in session.track().jobs if job.solved] == [("blau ü", 0)]
    points = session.tracks("blau ü").points.tolist()[3]
    assert [sum(p[axis] for p in points) / 4 for axis in (0, 1)] == pytest.approx(center, abs=1e-9)

    session.unpin("red", 9)
    session.clear_center("blau ü", 3)
    session.track()
    assert {name: session.tracks(name).points.tolist() for name in session.parts()} == before


def test_set_document_keeps_what_is_known(session):
    session.track()
    document = session.document()
    document["parts"][0]["pins"] = {"3": {"0": [20.0, 7.0]}}
    session.set_document(document)
    assert (session.track().solved, session.tracks("red").points[3, 0, 0]) == (1, 20.0)


def test_new_key_splits_a_span(session):
    session.track()
    session.set_key("red", 3, square(3, 0))
    jobs = session.track().jobs
    assert [(job.first, job.last) for job in jobs if job.solved] == [(0, 3), (3, 6)]
    assert session.tracks("red").points.tolist()[3] == square(3, 0)
    session.remove_key("red", 3)
    session.remove_key("red", 12)
    session.track()
    assert session.tracks("red").frames.tolist() == list(range(7))


def test_corrections_stay_where_the_only_key_is_replaced(document, folder):
    own = {"keys": {"6": square(6, 0)}, "pins": {"3": {"0": [18, 7]}}, "centers": {"9": [40, 16]}}
    with Session.from_document(document | {"parts": [document["parts"][0] | own]}, folder) as session:
        session.remove_key("red", 6)
        session.set_key("red", 7, square(7, 0))
        [part] = session.document()["parts"]
        assert (list(part["keys"]), part["pins"], part["centers"]) == (["7"], own["pins"], own["centers"])
        session.remove_key("red", 7)
        session.set_key("red", 7, square(7, 0)[1:])
        assert session.document()["parts"][0]["pins"] == own["pins"], "the pin is on a point that is there"


def test_what_names_a_part_goes_with_it(session, document):
    given = {
        "follows": [{"part": "red", "of": "blau ü"}, {"part": "blau ü", "what": "root"}],
        "depth_marks": [{"front": "red", "behind": "blau ü"}],
    }
    session.set_document(document | given)
    session.remove_part("red")
    left = session.document()
    assert (left["follows"], left.get("depth_marks", [])) == (given["follows"][1:], [])


def test_result_does_not_depend_on_threads(document, folder):
    def tracked(threads):
        with Session.from_document(document, folder) as session:
            session.track(threads=threads)
            return session.tracks("red").points.tobytes()

    assert tracked(1) == tracked(2) == tracked(0)


@pytest.mark.parametrize("work", ["track", "snap"])
def test_progress_rises_on_the_calling_thread(session, work):
    seen = []
    getattr(session, work)(progress=lambda fraction, step: seen.append((fraction, step, threading.get_ident())))
    fractions = [fraction for fraction, _, _ in seen]
    assert fractions == sorted(fractions)
    assert (fractions[0], fractions[-1]) == (0.0, 1.0)
    assert all(isinstance(step, str) and step for _, step, _ in seen)
    assert {thread for _, _, thread in seen} == {threading.get_ident()}


@pytest.mark.parametrize("work", ["track", "snap"])
@pytest.mark.parametrize("limit", [0.0, 1.0], ids=["at the start", "at the end"])
def test_cancel_changes_nothing(session, work, limit):
    before = session.document()
    with pytest.raises(Cancelled):
        getattr(session, work)(progress=lambda fraction, _: fraction < limit)
    assert session.document() == before


@pytest.mark.parametrize("answer", [False, 0, 0.0, ""])
def test_every_false_answer_of_progress_cancels(session, answer):
    with pytest.raises(Cancelled):
        session.track(progress=lambda _fraction, _step: answer)
    assert session.track(progress=lambda _fraction, _step: None).solved == 4


def test_exception_in_progress_cancels_and_comes_out(session):
    before = session.document()

    class Mine(Exception):
        pass

    def progress(_fraction, _step):
        raise Mine("stop")

    with pytest.raises(Mine, match="stop"):
        session.track(progress=progress)
    assert session.document() == before
    assert session.track().solved == 4


def test_second_call_at_once_is_refused(session):
    messages = []

    def progress(_fraction, _step):
        with pytest.raises(RototoonError) as caught:
            session.document()
        messages.append(str(caught.value))

    session.track(progress=progress)
    assert messages and all("in use by another call" in message for message in messages)


def test_session_closed_during_a_call_is_freed_after_it(document, folder):
    session = Session.from_document(document, folder)
    summary = session.track(progress=lambda _fraction, _step: session.close())
    assert summary.solved == 4
    assert session._handle._pointer is None
    with pytest.raises(RototoonError, match="the session is closed"):
        session.document()


def test_snap_follows_segments_and_is_dropped_where_the_track_changes(session):
    session.track()
    session.snap()
    for frame in FRAMES:
        paths = session.curves("red", frame)
        assert len(paths) == 4
        assert all(path.format == "d" and path.shape[1] == 2 and path.shape[0] >= 2 for path in paths)
    session.pin("red", 9, 0, (35.0, 9.0))
    session.track()
    assert session.curves("red", 9) == []
    assert len(session.curves("red", 3)) == 4
    assert len(session.curves("blau ü", 9)) == 4
    with pytest.raises(RototoonError, match='follow: found "mouse", expected one of'):
        session.snap(follow="mouse")


def test_rounding_of_a_saved_document_does_not_drop_curves(session, folder):
    session.track()
    session.snap()
    session.set_document(session.document())
    session.track()
    assert len(session.curves("red", 9)) == 4


def test_arrays_outlive_the_session(document, folder):
    session = Session.from_document(document, folder)
    session.track()
    track = session.tracks("red")
    expected = track.points.tolist()
    session.close()
    del session
    gc.collect()
    assert track.points.tolist() == expected
    assert track.points.readonly


def test_numpy_takes_arrays_without_copying(session):
    numpy = pytest.importorskip("numpy")
    session.track()
    track = session.tracks("red")
    points = numpy.asarray(track.points)
    assert (points.dtype, points.shape) == (numpy.float64, (13, 4, 2))
    assert numpy.shares_memory(points, numpy.frombuffer(track.points, dtype=numpy.float64))
    assert numpy.asarray(track.frames).dtype == numpy.int32
    session.set_key("red", 3, points[3] + 1)
    assert session.document()["parts"][0]["keys"]["3"] == (points[3] + 1).tolist()


def test_key_from_a_buffer(session):
    values = [value + 0.25 for point in square(2, 0) for value in point]
    session.set_key("red", 2, memoryview(array.array("d", values)).cast("B").cast("d", (4, 2)))
    assert session.document()["parts"][0]["keys"]["2"][0] == values[:2]
    with pytest.raises(RototoonError, match=r"expected float64 of shape \(N, 2\), found f"):
        session.set_key("red", 2, memoryview(array.array("f", values)))


def test_untracked_part_is_empty(session):
    track = session.tracks("red")
    assert (len(track.frames), len(track.points), len(session.confidence("red"))) == (0, 0, 0)
    assert session.curves("red", 0) == []
    assert session.weakest_frame() is None


def test_a_document_that_was_tracked_elsewhere_says_what_is_hidden(tmp_path):
    def box(left, side):
        return [[left, 10.0], [left + side, 10.0], [left + side, 10.0 + side], [left, 10.0 + side]]

    def part(name, depth, lefts, side, sure):
        contours = {str(frame): box(left, side) for frame, left in enumerate(lefts)}
        confidence = {str(frame): [one] * 4 for frame, one in enumerate(sure)}
        keys = {frame: contours[frame] for frame in ("0", "3")}
        return {"name": name, "closed": True, "depth": depth, "keys": keys, "tracks": contours, "confidence": confidence}

    small = part("small", 0.0, [0.0, 22.0, 24.0, 56.0], 6.0, [1.0, 0.1, 0.1, 1.0])
    large = part("large", 1.0, [16.0] * 4, 34.0, [1.0] * 4)
    footage = {"pattern": "f_%d.png", "first": 0, "last": 3, "fps": 12, "width": 64, "height": 48}
    with Session.from_document({"rototoon": 1, "footage": footage, "parts": [small, large]}, tmp_path) as opened:
        assert [(found.part, found.frames) for found in opened.unseen()] == [("small", [1, 2])]


def test_weakest_frame_is_in_the_doubtful_stretch(session, document):
    tracked = {str(frame): square(frame, 0) for frame in FRAMES}
    doubt = {str(frame): [0.1 if frame in (8, 9, 10) else 1.0] * 4 for frame in FRAMES}
    document["parts"][0].update(tracks=tracked, confidence=doubt)
    session.set_document(document)
    weakest = session.weakest_frame()
    assert isinstance(weakest, WeakestFrame)
    assert weakest.frame == 9
    # A contour is sure from 0.8, and the middle of the stretch has 14/16 of the kernel.
    assert weakest.score == pytest.approx((1 - 0.1 / 0.8) * 14 / 16)


def test_a_hidden_part_has_no_track_there(session):
    session.track()
    session.set_absent("red", 3, 5)
    assert not {3, 4, 5} & set(session.tracks("red").frames)
    session.clear_absent("red", 4)
    assert session.document()["parts"][0]["absent"] == [[3, 3], [5, 5]]
    session.track()
    frames = list(session.tracks("red").frames)
    assert 4 in frames and not {3, 5} & set(frames)
    with pytest.raises(RototoonError, match="found frames 5 to 4"):
        session.set_absent("red", 5, 4)
    with pytest.raises(RototoonError, match="outside the footage"):
        session.set_absent("red", 3, 10_000)


def test_outcomes_are_those_of_the_core():
    sure = {frame: 0.1 if frame in (8, 9, 10) else 0.99 for frame in range(20)}
    found = outcomes([{"keys": [0, 19], "confidence": sure}, {"keys": [3], "confidence": {}, "wants_key": [12]}])
    assert found.parts[0].lost == [8, 9, 10] and found.parts[1].lost == [12]
    assert found.parts[0].sure == [frame for frame in range(1, 19) if frame not in (8, 9, 10)]
    assert found.weakest.frame == 12
    assert outcomes([]).weakest is None


def test_parts_that_may_have_changed_places_are_named(tmp_path):
    """Two boxes of one look meet on the way there and on the way back, and only the ends are keyed."""
    last, size = 12, (160, 90)
    places = {"near leg": [(12 + 20 * min(f, last - f), 24) for f in range(last + 1)], "far leg": [(56 + 2 * f, 34) for f in range(last + 1)]}
    for frame in range(last + 1):
        pixels = [[(255, 255, 255)] * size[0] for _ in range(size[1])]
        for left, top in (places["far leg"][frame], places["near leg"][frame]):
            for y in range(top, top + 31):
                for x in range(left, left + 23):
                    pixels[y][x] = (200, 60, 60) if 0 < x - left < 22 and 0 < y - top < 30 else (0, 0, 0)
        write_png(tmp_path / f"f_{frame}.png", pixels)

    def box(x, y):
        return [[x, y], [x + 22, y], [x + 22, y + 30], [x, y + 30]]

    parts = [
        {"name": name, "closed": True, "depth": -depth, "keys": {str(frame): box(*at[frame]) for frame in (0, last)}}
        for depth, (name, at) in enumerate(places.items())
    ]
    footage = {"pattern": "f_%d.png", "first": 0, "last": last, "fps": 24, "width": size[0], "height": size[1]}
    with Session.from_document({"rototoon": 1, "footage": footage, "parts": parts}, tmp_path) as session:
        (found,) = session.track().exchanges
    assert found.parts == ("near leg", "far leg") and set(range(3, 9)) <= set(found.frames)


def test_parts_that_may_have_changed_places_are_told_as_on_the_command_line():
    found = outcomes([], [Exchange(("near leg", "far leg"), [7, 3, 2, 4])]).exchanges
    assert found == ['parts "near leg" and "far leg" look alike and may have changed places on 2-4, 7: a key or a pin there says which is which']


def test_files_and_folders(session, document, folder, tmp_path):
    beside, elsewhere = folder / "shot.json", tmp_path / "moved é.json"
    session.save(beside)
    assert json.loads(beside.read_text("utf-8"))["footage"]["pattern"] == "frame_%03d.png"
    session.save(elsewhere)
    with Session.open(os.fsencode(elsewhere)) as moved:
        assert moved.parts() == ["red", "blau ü"]
        moved.snap()
        assert len(moved.curves("red", 6)) == 4
    with pytest.raises(RototoonError, match="nowhere"):
        session.save(tmp_path / "nowhere" / "shot.json")
    with pytest.raises(RototoonError, match="nothing.json"):
        Session.open(tmp_path / "nothing.json")
    beside.unlink()


def test_what_another_program_wrote_meanwhile_is_not_written_over(session, tmp_path):
    path, beside = tmp_path / "shot.json", tmp_path / "shot (2).json"
    session.save(path)
    with Session.open(path) as own, Session.open(path) as other:
        other.remove_part("red")
        other.save(path)
        theirs = path.read_bytes()
        own.add_part({"name": "dot", "closed": False, "depth": 0, "keys": {"0": [[1, 1]], "2": [[2, 2]]}})
        with pytest.raises(RototoonError, match="another program wrote the file meanwhile") as caught:
            own.save(path)
        assert str(path) in str(caught.value) and str(beside) in str(caught.value)
        assert path.read_bytes() == theirs
        with Session.open(beside) as saved:
            assert saved.parts() == ["red", "blau ü", "dot"]
        # What a session saved is known to it, and what another one saved is not.
        other.save(path)
        own.save(tmp_path / "new.json")
        own.save(tmp_path / "new.json")
        other.remove_part("blau ü")
        other.save(tmp_path / "new.json")
        with pytest.raises(RototoonError, match=r"new \(2\).json"):
            own.save(tmp_path / "new.json")


def test_callers_with_a_document_of_their_own_keep_marks(tmp_path):
    path = tmp_path / "é.json"
    assert documents.mark(path) == ""
    mark = documents.replace(path, "one")
    assert mark == documents.mark(os.fsencode(path)) != ""
    mark = documents.replace(path, "two", mark)
    path.write_text("theirs")
    with pytest.raises(RototoonError, match=r"é \(2\).json"):
        documents.replace(path, "three", mark)
    assert path.read_text() == "theirs" and (tmp_path / "é (2).json").read_text() == "three"


def test_parts_and_footage_can_be_changed(session, document, folder):
    session.add_part({"name": "dot", "closed": False, "depth": 0, "keys": {"0": [[1, 1]], "2": [[2, 2]]}})
    assert session.parts() == ["red", "blau ü", "dot"]
    session.remove_part("red")
    assert session.parts() == ["blau ü", "dot"]
    session.set_footage(document["footage"] | {"last": 40})
    assert session.document()["footage"]["last"] == 40
    with pytest.raises(RototoonError, match="width"):
        session.set_footage(document["footage"] | {"width": 0})
    assert session.document()["footage"]["width"] == 80


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.tracks("green"), 'no part "green"; the document has "red", "blau ü"'),
        (lambda s: s.pin("red", 0, 0, (1, 1)), "frame 0 is a key"),
        (lambda s: s.pin("red", 3, 4, (1, 1)), "no point 4; it has 4"),
        (lambda s: s.pin("red", 3, 0, (float("nan"), 1)), "found (NaN, 1)"),
        (lambda s: s.set_key("red", 3, [(1, 1)]), "found 1 point, expected 4 as on frame 0"),
        (lambda s: s.set_key("red", 99, square(0, 0)), "frame 99 is outside the footage"),
        (lambda s: s.remove_key("red", 3), "no key on frame 3"),
        (lambda s: s.track("best"), 'preset: found "best", expected one of'),
        (lambda s: s.track(threads=10**6), "expected a whole number from 0 to 1024"),
        (lambda s: s.pin("red", 2**32 + 5, 0, (1, 1)), "frame: found 4294967301, expected a whole number from -2147483648"),
        (lambda s: s.pin("red", 3, 2**32, (1, 1)), "point: found 4294967296, expected a whole number from"),
        (lambda s: s.unpin("red", 2**32 + 5), "frame: found 4294967301"),
        (lambda s: s.unpin("red", 3, -1), "point: found -1, expected 0 or more"),
        (lambda s: s.unpin("red", 3, 2**32 - 1), "point: found 4294967295"),
        (lambda s: s.set_key("red", -(2**31) - 1, square(3, 0)), "frame: found -2147483649"),
        (lambda s: s.remove_key("red", 2**32), "frame: found 4294967296"),
        (lambda s: s.set_center("red", 2**32 + 5, (1, 1)), "frame: found 4294967301"),
        (lambda s: s.clear_center("red", 2**32 + 5), "frame: found 4294967301"),
        (lambda s: s.curves("red", 2**40), "frame: found 1099511627776"),
        (lambda s: s.pin("red", 3.5, 0, (1, 1)), "frame: found 3.5, expected a whole number"),
        (lambda s: s.track(threads=2**64), "expected a whole number from 0 to 1024"),
        (lambda s: s.set_document({"rototoon": 1}), "footage"),
        (lambda s: s.set_document({"rototoon": 99, "footage": {}, "parts": []}), "99"),
        (lambda s: s.set_document({"rototoon": float("nan")}), "not a JSON document"),
        (lambda s: s.set_key("red", 3, "xy"), "points[0]: found 'x', expected two numbers, x and y"),
        (lambda s: s.set_key("red", 3, [(1, 1), (2, 2, 2)]), "points[1]: found (2, 2, 2), expected two numbers"),
        (lambda s: s.pin("red", 3, 0, 5.0), "xy: found 5.0, expected two numbers"),
        (lambda s: s.set_center("red", 3, ("left", 1)), "xy: found ('left', 1), expected two numbers"),
        (lambda s: s.remove_part(7), "found 7, expected text"),
    ],
)
def test_errors_say_what_is_wrong_and_change_nothing(session, call, message):
    before = session.document()
    with pytest.raises(RototoonError) as caught:
        call(session)
    assert message in str(caught.value)
    assert session.document() == before


def test_closed_session_refuses(document, folder):
    session = Session.from_document(document, folder)
    session.close()
    session.close()
    assert session.closed
    with pytest.raises(RototoonError, match="the session is closed"):
        session.parts()


def test_functions_without_a_session():
    assert version().count(".") == 2
    ids = [parameter["id"] for parameter in parameters()]
    assert ids and len(set(ids)) == len(ids)


def test_contours_are_matched_whatever_their_start_and_direction():
    target = square(0, 0)
    turned = [[x + 1, y + 1] for x, y in reversed(target[1:] + target[:1])]
    far = [[x + 40, y + 30] for x, y in target]
    request = {
        "references": [{"closed": True, "points": target}, {"closed": True, "points": far}],
        "drawn": [{"closed": True, "points": far}, {"closed": True, "points": turned}],
    }
    matches = match_contours(request)["matches"]
    assert [(match["reference"], match["drawn"]) for match in matches] == [(0, 1), (1, 0)]
    for match, source in zip(matches, (target, far), strict=True):
        assert all(max(abs(a - b) for a, b in zip(p, q)) < 1.5 for p, q in zip(match["points"], source, strict=True))
