"""`Session.fill` and `Session.filled`: a square with a disc in it that moves over four frames."""

import math

import numpy
import pytest
from conftest import write_png

from rototoon import Cancelled, RototoonError, Session, fills
from rototoon.fills import Click

WIDTH, HEIGHT, LAST, STEP = 160, 120, 3, 5
PAPER, RED, BLUE, GREEN = (1.0, 1.0, 1.0), (0.9, 0.2, 0.1), (0.2, 0.3, 0.9), (0.1, 0.7, 0.2)
CLICKS = [Click(0, (5, 5), PAPER), Click(0, (30, 30), RED), Click(0, (60, 60), BLUE)]


def draw(frame: int) -> list[list[tuple[int, int, int]]]:
    """Black ink on paper, five pixels further right on each frame."""

    def pixel(x: int, y: int) -> tuple[int, int, int]:
        px, py = abs(x + 0.5 - 60 - STEP * frame), abs(y + 0.5 - 60)
        square = abs(max(px, py) - 40) < 1.5
        disc = abs(math.hypot(px, py) - 15) < 1.5
        return (20, 20, 60) if square or disc else (250, 250, 250)

    return [[pixel(x, y) for x in range(WIDTH)] for y in range(HEIGHT)]


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fills")
    for frame in range(LAST + 1):
        write_png(folder / f"line_{frame:03}.png", draw(frame))
    return folder


def opened(film, **fields):
    footage = {"pattern": "line_%03d.png", "first": 0, "last": LAST, "fps": 12, "width": WIDTH, "height": HEIGHT}
    return Session.from_document({"rototoon": 1, "footage": footage, "parts": [], **fields}, film)


def area(outline) -> float:
    x, y = numpy.asarray(outline).T
    return abs(x @ numpy.roll(y, 1) - y @ numpy.roll(x, 1)) / 2


def test_the_colours_of_a_frame_are_on_every_frame(film):
    with opened(film, note="kept") as session:
        assert len(session.filled().frames) == 0 and session.fills() == []
        filled = session.fill(CLICKS)
        assert filled.frames.tolist() == [0, 1, 2, 3]
        assert numpy.asarray(filled.tracks).reshape(4, 3).tolist() == [[0, 1, 2]] * 4
        for frame in range(4):
            paper, square, disc = filled.on(frame)
            assert (paper.colour, square.colour) == (pytest.approx(PAPER), pytest.approx(RED))
            assert disc.colour == pytest.approx(BLUE) and not disc.holes and len(square.holes) == 1
            assert area(square.outline) == pytest.approx(80**2, rel=0.02)
            # Both end below the line of the disc.
            assert math.pi * 13.5**2 < area(disc.outline) < area(square.holes[0]) < math.pi * 16.5**2
            assert numpy.asarray(disc.outline).mean(0) == pytest.approx((60 + STEP * frame, 60), abs=0.7)
            assert (square.confidence == 1.0) == (frame == 0) and not square.doubtful
        assert filled.on(99) == [] and filled.doubts() == [] and filled.missed == [] and filled.unrelated == []
        document = session.document()
        assert document["note"] == "kept" and [each["frame"] for each in document["filled"]] == [0, 1, 2, 3]
        assert document["fills"][0]["regions"][1] == {"at": [30.0, 30.0], "colour": list(RED)}
        assert session.fills() == [own._replace(colour=pytest.approx(own.colour)) for own in CLICKS]
        assert session.filled().points.tobytes() == filled.points.tobytes()


def test_a_later_click_mends_what_follows(film):
    with opened(film) as session:
        first = session.fill(CLICKS)
        second = session.fill([*CLICKS, Click(2, (70, 60), GREEN)])
    assert [first.on(frame)[2].colour for frame in range(4)] == [pytest.approx(BLUE)] * 4
    colours = [second.on(frame)[2].colour for frame in range(4)]
    assert colours == [pytest.approx(BLUE)] * 2 + [pytest.approx(GREEN)] * 2


def test_another_session_takes_what_one_has_found(film, tmp_path, monkeypatch):
    cache = tmp_path / "cache"

    def found(kept):
        monkeypatch.setenv("ROTOTOON_CACHE", str(kept))
        with opened(film) as session:
            session.trace()
            session.fill(CLICKS)
            return session.document(), sorted(path.name for path in cache.rglob("*") if len(path.name) == 64)

    document, entries = found(cache)
    # Strokes and regions of each drawing; of neighbours whether they are one drawing, and where their lines are; the latter also of the
    # clicked drawing and farther ones.
    assert len(entries) == 2 * (LAST + 1) + 2 * LAST + (LAST - 1)
    assert found(cache) == (document, entries), "nothing is found anew"
    assert found("none") == (document, entries)


def test_doubts_and_what_was_not_painted_are_told(film):
    with opened(film) as session:
        # Nothing is known about the disc.
        filled = session.fill([*CLICKS[:2], Click(0, (900, 5), RED)])
        assert filled.missed == [(0, 2)]
        (doubt,) = filled.doubts()
        assert doubt == fills.Doubt(doubt.track, [1, 2, 3])
        assert [region.doubtful for region in filled.on(1)].count(True) == 1
        assert session.fill(confidence=0.5).doubts() == [], "clicks of the document serve, and doubts stay unpainted"
        assert filled.overruled == [] and filled.bare == []
        twice = session.fill([Click(0, CLICKS[0].at, RED), *CLICKS])
        assert twice.overruled == [(0, 0)], "the click that came first"


def test_the_constant_is_that_of_the_library(film):
    region = {"outline": [[0, 0], [9, 0], [0, 9]], "colour": [0, 0, 0]}
    unsure = (0, fills.DOUBT - 1e-3, fills.DOUBT, 1)
    regions = [{**region, "track": k, "confidence": sure} for k, sure in enumerate(unsure)]
    with opened(film, filled=[{"frame": 0, "regions": regions}]) as session:
        assert [each.doubtful for each in session.filled().on(0)] == [sure < fills.DOUBT for sure in unsure]


def test_a_click_without_a_colour_keeps_a_region_without_paint(film):
    clicks = [Click(0, (30, 30), RED), Click(0, (60, 60), None)]
    with opened(film) as session:
        filled = session.fill(clicks)
        assert [click.colour for click in session.fills()] == [pytest.approx(RED), None]
        assert session.document()["fills"][0]["regions"][1]["colour"] is None
        for frame in range(4):
            # The paper around the square was not clicked, and has no paint either.
            (square,) = filled.on(frame)
            assert square.colour == pytest.approx(RED) and len(square.holes) == 1


def test_a_range_leaves_the_other_frames(film):
    with opened(film) as session:
        session.fill(CLICKS, frames=(0, 1))
        filled = session.fill(frames=(3, 3))
    assert filled.frames.tolist() == [0, 1, 3]


def test_what_is_wrong_is_named_and_changes_nothing(film):
    with opened(film) as session:
        session.set_fills(CLICKS)
        before = session.document()
        for clicks, options, said in [
            ([], {}, "fills: found no click"),
            ([Click(9, (1, 1), RED)], {}, r"fills\[0\].frame: found 9, expected a frame of the footage, 0 to 3"),
            ([Click(0, (1, 1), (2, 0, 0))], {}, r"click 0 \(frame 0\): colour: found 2"),
            ([Click(0, (math.nan, 1), RED)], {}, r"click 0 \(frame 0\): place: found \(NaN, 1\)"),
            ([(0, 1, 2)], {}, r"clicks\[0\]: found \(0, 1, 2\), expected a frame, a place"),
            ([(2**40, (1, 1), RED)], {}, r"clicks\[0\]: found \(1099511627776"),
            (CLICKS[:1], {"sensitivity": 0}, "sensitivity: found 0"),
            (CLICKS[:1], {"confidence": 2}, "confidence: found 2"),
            (CLICKS[:1], {"frames": (2, 9)}, "frames: found 2 to 9, expected frames of the footage, 0 to 3"),
            (CLICKS[:1], {"threads": -1}, "invalid value: integer `-1`"),
        ]:
            with pytest.raises(RototoonError, match=said):
                session.fill(clicks, **options)
            assert session.document() == before, said


def test_progress_can_cancel(film):
    shares = []
    with opened(film) as session:
        before = session.document()
        with pytest.raises(Cancelled):
            session.fill(CLICKS, progress=lambda share, step: shares.append((share, step)) or False)
        assert session.document() == before
        session.fill(CLICKS, progress=lambda share, step: shares.append((share, step)))
    assert shares[-1][0] == 1.0 and all(a <= b for (a, _), (b, _) in zip(shares[1:], shares[2:]))


@pytest.mark.parametrize("options", [{"progress": lambda *_: False}, {"sensitivity": 99}])
def test_clicks_of_other_programs_stay_as_they_were(film, options):
    region = {"at": [30, 30], "colour": list(RED), "layer": "skin"}
    asked = [{"frame": 0, "note": "by Anna", "regions": [region]}, {"frame": 3, "regions": []}]
    with opened(film, fills=asked) as session:
        before = session.document()
        with pytest.raises((Cancelled, RototoonError)):
            session.fill(CLICKS, **options)
        assert session.document() == before and before["fills"] == asked


def test_the_same_regions_on_any_number_of_threads(film):
    found = []
    for threads in (1, 3):
        with opened(film) as session:
            found.append(session.fill(CLICKS, threads=threads).points.tobytes())
    assert found[0] == found[1]


def test_colours_have_names(film):
    clicks = [Click(0, (30, 30), RED, "coat"), Click(0, (60, 60), RED, "hair")]
    with opened(film) as session:
        filled = session.fill(clicks)
        assert session.fills() == [own._replace(colour=pytest.approx(own.colour)) for own in clicks]
        for frame in range(4):
            assert [region.name for region in filled.on(frame)] == ["coat", "hair"]
        # An error of painting brings the clicks back, with their names.
        with pytest.raises(RototoonError):
            session.fill([Click(9, (1, 1), RED)])
        assert [click.name for click in session.fills()] == ["coat", "hair"]


def test_plain_tuples_are_clicks_with_or_without_a_name(film):
    coat = Click(0, (30.0, 30.0), RED, "coat")
    with opened(film) as session:
        for clicks in ([tuple(coat), (0, (60, 60), BLUE)], [coat, (numpy.int64(0), numpy.array([60, 60]), numpy.float32(BLUE))]):
            session.set_fills(clicks)
            assert session.fills() == [coat._replace(colour=pytest.approx(RED)), Click(0, (60.0, 60.0), pytest.approx(BLUE))]
        for wrong in ((0, 1, 2, "coat"), (0, (1, 1), RED, "coat", "hair")):
            with pytest.raises(RototoonError, match=r"clicks\[1\]: found \(0, .*expected a frame, a place"):
                session.set_fills([coat, wrong])


def test_a_colour_becomes_another_one(film):
    wet = fills.Recolour(fills.Hue(RED), fills.Hue(GREEN, "wet"), first=2)
    with opened(film) as session:
        assert session.recolours() == []
        session.set_recolours([wet, fills.Recolour(fills.Hue(GREEN, "wet"), fills.Hue(BLUE), last=0)])
        ((old, new, first, last), other) = session.recolours()
        assert (old.colour, old.name, new.name, first, last) == (pytest.approx(RED), None, "wet", 2, None)
        assert (other.first, other.last) == (None, 0)
        filled = session.fill(CLICKS)
        found = [(filled.on(frame)[1].name, filled.on(frame)[1].track) for frame in range(4)]
        assert found[:2] == [(None, 1)] * 2 and found[2] == found[3] and found[2][0] == "wet"
        assert found[2][1] not in numpy.asarray(filled.tracks)[:6], "a number has one colour"
        with pytest.raises(RototoonError, match=r"recolours\[0\].to: found #e6331a, expected another colour"):
            session.set_recolours([fills.Recolour(fills.Hue(RED), fills.Hue(RED))])
        assert len(session.recolours()) == 2
        session.set_recolours([])
        assert {filled.name for filled in session.fill().on(3)} == {None}
