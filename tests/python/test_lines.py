"""`Session.trace` and `Session.traced`: a cross and a ring that move over four frames."""

import math
import threading

import numpy
import pytest
from conftest import write_png

from rototoon import Cancelled, RototoonError, Session, lines

WIDTH, HEIGHT, LAST, STEP = 160, 120, 3, 4


def draw(frame: int, solid: bool = False) -> list[list[tuple[int, int, int]]]:
    """Black ink on paper, four pixels further right on each frame. A solid disc can be added."""

    def pixel(x: int, y: int) -> tuple[int, int, int]:
        px, py = x + 0.5 - STEP * frame, y + 0.5
        bar = abs(py - 60) < 1.5 and 20 <= px < 90
        post = abs(px - 50) < 1.5 and 20 <= py < 100
        ring = abs(math.hypot(px - 110, py - 40) - 15) < 1.5
        disc = solid and math.hypot(px - 90, py - 90) < 14
        return (20, 20, 60) if bar or post or ring or disc else (250, 250, 250)

    return [[pixel(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lines")
    for frame in range(LAST + 1):
        write_png(folder / f"line_{frame:03}.png", draw(frame))
    return folder


def opened(film, **fields):
    footage = {"pattern": "line_%03d.png", "first": 0, "last": LAST, "fps": 12, "width": WIDTH, "height": HEIGHT}
    return Session.from_document({"rototoon": 1, "footage": footage, "parts": [], **fields}, film)


def test_three_lines_are_the_same_strokes_on_every_frame(film):
    with opened(film, note="kept") as session:
        assert len(session.traced().frames) == 0
        traced = session.trace()
        assert traced.frames.tolist() == [0, 1, 2, 3]
        assert numpy.asarray(traced.tracks).reshape(4, 3).tolist() == [[0, 1, 2]] * 4
        means = [[numpy.asarray(s.points).mean(0) for s in traced.on(frame)] for frame in range(4)]
        assert numpy.allclose(numpy.diff(means, axis=0), [STEP, 0], atol=0.6)
        (ring,) = [stroke for stroke in traced.on(2) if stroke.closed]
        assert numpy.asarray(ring.points).shape == (len(ring.widths), 2)
        assert numpy.median(numpy.asarray(ring.widths)) == pytest.approx(3, abs=0.7)
        assert ring.colour == pytest.approx((20 / 255, 20 / 255, 60 / 255), abs=0.05)
        assert traced.on(99) == []
        document = session.document()
        assert document["note"] == "kept" and [each["frame"] for each in document["traced"]] == [0, 1, 2, 3]
        assert session.traced().points.tobytes() == traced.points.tobytes()


def test_a_solid_shape_is_a_filled_outline(tmp_path):
    for frame in range(LAST + 1):
        write_png(tmp_path / f"line_{frame:03}.png", draw(frame, solid=True))
    with opened(tmp_path) as session:
        traced = session.trace()
        document = session.document()
    assert sorted(traced.fills) == [0] * 12 + [1] * 4
    for frame in range(4):
        disc, *others = traced.on(frame)
        assert disc.fill and disc.closed and len(disc.widths) == len(disc.points), "it is behind the lines"
        assert numpy.isnan(disc.widths).all() and disc.colour == pytest.approx((20 / 255, 20 / 255, 60 / 255), abs=0.03)
        away = numpy.linalg.norm(numpy.asarray(disc.points) - (90 + STEP * frame, 90), axis=1)
        assert away == pytest.approx(14, abs=0.7)
        assert disc.track == traced.on(0)[0].track and not any(stroke.fill for stroke in others)
    written = [[stroke.get("fill", False) for stroke in each["strokes"]] for each in document["traced"]]
    assert written == [[True, False, False, False]] * 4


def test_the_outline_of_a_drawn_shape_stays_filled(tmp_path):
    for frame in range(LAST + 1):
        write_png(tmp_path / f"line_{frame:03}.png", draw(frame, solid=True))
    turns = [2 * math.pi * k / 24 for k in range(24)]
    disc = {"points": [[90 + 14 * math.cos(t), 90 + 14 * math.sin(t)] for t in turns], "closed": True, "fill": True}
    with opened(tmp_path, drawings=[{"frame": 0, "strokes": [disc]}]) as session:
        traced = session.trace()
    for frame in range(4):
        (own,) = [stroke for stroke in traced.on(frame) if stroke.track == 0]
        assert own.fill and numpy.asarray(own.points).mean(0) == pytest.approx((90 + STEP * frame, 90), abs=0.7)
        assert own.fill_colour is None, "the colour of a shape without a line is that of the stroke"


def test_the_colour_below_a_drawn_line_is_carried(film):
    turns = [2 * math.pi * k / 24 for k in range(24)]
    ring = {"points": [[110 + 15 * math.cos(t), 40 + 15 * math.sin(t)] for t in turns], "closed": True, "widths": [3] * 24}
    ring["fill_colour"] = [1, 0.5, 0]
    with opened(film, drawings=[{"frame": 0, "strokes": [ring]}]) as session:
        traced = session.trace()
    for frame in range(4):
        (own,) = [stroke for stroke in traced.on(frame) if stroke.track == 0]
        assert own.closed and not own.fill and own.fill_colour == (1, 0.5, 0)
        assert all(other.fill_colour is None for other in traced.on(frame) if other.track != 0)


def test_strokes_of_a_drawing_are_carried_and_kept(film):
    line = {"points": [[28, 60], [50, 60], [92, 60]], "closed": False}
    with opened(film, drawings=[{"frame": 2, "strokes": [line]}]) as session:
        traced = session.trace()
    (own,) = traced.on(2)
    assert own.track == 0 and numpy.asarray(own.points).tolist() == line["points"]
    carried = [next(stroke for stroke in traced.on(frame) if stroke.track == 0) for frame in (0, 1, 3)]
    assert all(abs(numpy.asarray(stroke.points)[:, 1].mean() - 60) < 1 for stroke in carried)


def test_doubtful_strokes_are_read_from_a_document(film):
    line = {"points": [[28, 60], [50, 60]], "closed": False}
    unsure = {4: (None, 0.9), 5: (0.75, 0.2)}
    drawings = [
        {"frame": frame - 3, "strokes": [{"track": k, **line} | ({} if sure is None else {"confidence": sure}) for k, sure in enumerate(own)]}
        for frame, own in unsure.items()
    ]
    with opened(film, traced=drawings) as session:
        traced = session.traced()
    assert traced.confidence.tolist() == [1.0, 0.9, 0.75, 0.2]
    assert [stroke.confidence for stroke in traced.on(2)] == [0.75, 0.2]
    assert traced.doubts() == [lines.Doubt(0, [2], []), lines.Doubt(1, [], [2])]


def test_carried_strokes_have_a_confidence(film):
    with opened(film) as session:
        traced = session.trace()
        document = session.document()
    first, *others = (traced.on(frame) for frame in traced.frames)
    assert [stroke.confidence for stroke in first] == [1.0] * 3, "they begin there"
    assert all(0.8 < stroke.confidence < 1 for strokes in others for stroke in strokes) and traced.doubts() == []
    kept = [stroke.get("confidence", 1.0) for each in document["traced"] for stroke in each["strokes"]]
    assert kept == pytest.approx(traced.confidence.tolist(), abs=1e-3)


def test_a_range_leaves_the_other_frames_and_has_their_numbers(film):
    with opened(film) as session:
        session.trace(frames=(0, 1))
        traced = session.trace(frames=(3, 3))
        assert traced.frames.tolist() == [0, 1, 3]
        assert sorted(s.track for s in traced.on(3)) == sorted(s.track for s in traced.on(1))


def test_wrong_options_are_named_and_change_nothing(film):
    with opened(film) as session:
        before = session.document()
        for options, said in [
            ({"style": "neat"}, "unknown variant `neat`"),
            ({"sensitivity": 0}, "sensitivity: found 0"),
            ({"frames": (2, 9)}, "frames: found 2 to 9, expected frames of the footage, 0 to 3"),
            ({"threads": -1}, "invalid value: integer `-1`"),
        ]:
            with pytest.raises(RototoonError, match=said):
                session.trace(**options)
        assert session.document() == before


def test_progress_can_cancel(film):
    shares = []
    with opened(film) as session:
        before = session.document()
        with pytest.raises(Cancelled):
            session.trace(progress=lambda share, step: shares.append((share, step)) or False)
        assert session.document() == before
        session.trace(progress=lambda share, step: shares.append((share, step)))
    assert shares[-1][0] == 1.0 and all(a <= b for (a, _), (b, _) in zip(shares[1:], shares[2:]))


def test_the_same_strokes_on_any_number_of_threads(film):
    found = []
    for threads in (1, 3):
        with opened(film) as session:
            found.append(session.trace(threads=threads).points.tobytes())
    assert found[0] == found[1]


def test_a_session_refuses_a_second_call(film):
    with opened(film) as session:
        said = []

        def intrude(_share, _step):
            def call():
                try:
                    session.traced()
                except RototoonError as error:
                    said.append(str(error))

            other = threading.Thread(target=call)
            other.start()
            other.join()

        session.trace(progress=intrude)
    assert "in use by another call" in said[0]
