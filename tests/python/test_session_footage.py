"""Sessions and their pictures: what is known of them, pictures that were drawn again or moved, and those that are missing."""

import json
import math
import os
import subprocess
import sys

import pytest
from conftest import LAST, PACKAGE, draw, square, write_png
from rototoon import Cancelled, RototoonError, Session

FRAMES = list(range(LAST + 1))


def test_another_session_takes_what_one_has_tracked(document, folder, tmp_path, monkeypatch):
    monkeypatch.setenv("ROTOTOON_CACHE", str(tmp_path / "cache"))
    found = []
    for solved in (4, 0):
        with Session.from_document(document, folder) as session:
            summary = session.track()
            assert (summary.solved, summary.reused) == (solved, 4 - solved)
            found.append(session.document())
    assert found[0] == found[1]
    monkeypatch.setenv("ROTOTOON_CACHE", "none")
    with Session.from_document(document, folder) as session:
        assert session.track().solved == 4


def test_footage_that_is_drawn_again_under_the_same_names_is_read_again(document, folder, tmp_path, monkeypatch):
    """The square stands still at first, and then moves between its keys."""
    monkeypatch.setenv("ROTOTOON_CACHE", "none")
    parts = [document["parts"][0] | {"keys": {frame: square(0, 0) for frame in ("0", "12")}}]
    still, drawn = draw(0), [draw(min(frame, LAST - frame)) for frame in FRAMES]
    for frame in FRAMES:
        write_png(tmp_path / f"frame_{frame:03}.png", still)
    with Session.from_document(document | {"parts": parts}, tmp_path) as session:
        assert not session.track().footage_changed
        session.snap()
        before = session.tracks("red").points.tolist()
        for frame in FRAMES[1:-1]:
            write_png(tmp_path / f"frame_{frame:03}.png", drawn[frame])
        summary = session.track()
        after = session.tracks("red").points.tolist()
        assert (summary.footage_changed, summary.solved) == (True, 1)
        assert (session.track().footage_changed, session.track().solved) == (False, 0)
        snapped = []
        for pictures in (drawn, [still] * len(FRAMES)):
            for frame in FRAMES:
                write_png(tmp_path / f"frame_{frame:03}.png", pictures[frame])
            session.snap()
            snapped.append([path.tolist() for path in session.curves("red", 3)])
    assert snapped[0] != snapped[1]
    for points, truth in ((before, square(0, 0)), (after, square(3, 0))):
        assert all(math.dist(p, t) < 1.0 for p, t in zip(points[3], truth, strict=True))


def test_changed_pictures_are_told_by_the_next_track_whoever_saw_them(document, folder, tmp_path, monkeypatch):
    monkeypatch.setenv("ROTOTOON_CACHE", "none")
    for frame in FRAMES:
        write_png(tmp_path / f"frame_{frame:03}.png", draw(frame))

    def cancelled(session):
        with pytest.raises(Cancelled):
            session.track(progress=lambda done, _: False)

    with Session.from_document(document, tmp_path) as session:
        session.track()
        for seen, drawn in ((Session.snap, 5), (cancelled, 6)):
            write_png(tmp_path / "frame_003.png", draw(drawn))
            seen(session)
            assert session.track().footage_changed
            assert not session.track().footage_changed


def test_a_session_of_a_bare_name_stays_in_the_folder_where_it_was_opened(document, folder, tmp_path, monkeypatch):
    shots = [tmp_path / name for name in ("a", "b")]
    for shot, speed in zip(shots, (1, 0), strict=True):
        shot.mkdir()
        (shot / "project.json").write_text(json.dumps(document), "utf-8")
        for frame in FRAMES:
            write_png(shot / f"frame_{frame:03}.png", draw(speed * frame))
    monkeypatch.chdir(shots[0])
    with Session.open("project.json") as bare, Session.open(shots[0] / "project.json") as full, Session.from_document(document, "") as here:
        monkeypatch.chdir(shots[1])
        found = []
        for session in (bare, full, here):
            session.track()
            found.append(session.tracks("red").points.tolist())
        assert found[0] == found[1] == found[2]
        frame = shots[0] / "frame_003.png"
        before = frame.read_bytes()
        with pytest.raises(RototoonError, match="frame_003"):
            bare.save(frame)
        assert frame.read_bytes() == before


def test_tracks_have_the_marks_of_their_pictures(document, folder, tmp_path, monkeypatch):
    """As those of the command line: so a picture that is drawn again later is named."""
    monkeypatch.setenv("ROTOTOON_CACHE", "none")
    for frame in FRAMES:
        write_png(tmp_path / f"frame_{frame:03}.png", draw(frame))
    with Session.from_document(document, tmp_path) as session:
        with pytest.raises(Cancelled):
            session.track(progress=lambda done, _: done < 0.5)
        session.track()
        seen = session.document()["seen"]["tracks"]
        tracked = {frame for part in session.document()["parts"] for frame in part["tracks"]}
        assert set(seen) == tracked
        # A pin solves one span again, and the marks of the others stay.
        changed = session.document()
        changed["parts"][0]["pins"] = {"3": {"0": [20.0, 7.0]}}
        session.set_document(changed)
        session.track()
        assert session.document()["seen"]["tracks"] == seen
        write_png(tmp_path / "frame_003.png", draw(5))
        session.track()
        again = session.document()["seen"]["tracks"]
    assert {frame for frame in seen if again[frame] != seen[frame]} == {"3"}


def test_missing_frame_is_named(document, tmp_path):
    with Session.from_document(document, tmp_path) as session:
        with pytest.raises(RototoonError, match=r"frame_0\d\d\.png"):
            session.track()
        assert "tracks" not in session.document()["parts"][0] or not session.document()["parts"][0]["tracks"]


def test_a_document_moves_to_footage_that_is_delivered_again(session, folder, tmp_path):
    session.track()
    before = session.document()
    # From frame 101 on, without the drawing of frame 5, and with another one in the place of that of frame 9.
    order = [frame for frame in FRAMES if frame != 5]
    for new, old in enumerate(order, 101):
        (tmp_path / f"new_{new}.png").write_bytes((folder / f"frame_{old:03}.png").read_bytes())
    pattern = str(tmp_path / "new_%d.png")
    with pytest.raises(Cancelled):
        session.conform(pattern, progress=lambda _share, _step: False)
    with pytest.raises(RototoonError, match="found no file of this name"):
        session.conform(str(tmp_path / "none_%d.png"))
    with pytest.raises(RototoonError, match=r"shift: found \[1\], expected two numbers"):
        session.conform(pattern, shift=[1])
    assert session.document() == before
    conformed = session.conform(pattern, fps=25)
    assert (conformed.scale, conformed.shift, conformed.gone, conformed.new) == (1.0, (0.0, 0.0), [5], [])
    assert conformed.same == dict(enumerate(order, 101)) and conformed.redrawn == {}
    assert conformed.went == {old: new for new, old in enumerate(order, 101)}
    moved = session.document()
    assert (moved["footage"]["pattern"], moved["footage"]["first"], moved["footage"]["fps"]) == (pattern, 101, 25)
    keys = [part["keys"] for part in moved["parts"]]
    assert [sorted(each) for each in keys] == [["101", "106", "112"]] * 2
    assert keys[0]["106"] == before["parts"][0]["keys"]["6"]
    assert moved["parts"][0]["tracks"]["105"] == before["parts"][0]["tracks"]["4"]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere names of files are UTF-8 in every locale")
@pytest.mark.parametrize("utf8", ["0", "1"])
def test_paths_are_utf8_in_every_locale(tmp_path, utf8):
    """In an ASCII locale Python knows the signs of a path only as bytes. A name that is no UTF-8 is refused with a reason."""
    folder = tmp_path / "Übung 動画"
    folder.mkdir()
    footage = {"pattern": "f_%d.png", "first": 0, "last": 1, "fps": 12, "width": 8, "height": 8}
    (folder / "project.json").write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": []}))
    code = (
        "import os, sys; from rototoon import RototoonError, Session\n"
        "with Session.open(sys.argv[1]) as session: session.save(os.fsencode(sys.argv[1]))\n"
        "with Session.open('\\u00dcbung \\u52d5\\u753b/project.json') as session: session.save(sys.argv[1])\n"
        "try: Session.open(b'/sh\\xffot/project.json')\n"
        "except RototoonError as error: print(ascii(str(error)))"
    )
    own = os.environ | {"LC_ALL": "C", "PYTHONUTF8": utf8, "PYTHONCOERCECLOCALE": "0", "PYTHONPATH": str(PACKAGE.parent)}
    words = [sys.executable, "-c", code, str(folder / "project.json")]
    run = subprocess.run(words, cwd=tmp_path, env=own, capture_output=True, text=True, check=False)
    assert run.returncode == 0 and "not UTF-8" in run.stdout, run.stdout + run.stderr
