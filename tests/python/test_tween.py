"""Matching and in-betweens through the Python API."""

import array
import dataclasses
import math
import random

import pytest
from rototoon import Cancelled, RototoonError, Strokes, tween


def line(x, count, reverse=False):
    points = [(x + 3 * math.sin(k / count * 3), 60.0 * k / (count - 1)) for k in range(count)]
    return points[::-1] if reverse else points


def drawings(sheets, **more):
    """Drawings of lists of strokes on frames 1, 9, 17, ..."""
    offsets, points, bounds = array.array("i", [0]), array.array("d"), [0]
    for strokes in sheets:
        for stroke in strokes:
            for point in stroke:
                points.extend(point)
            offsets.append(len(points) // 2)
        bounds.append(bounds[-1] + len(strokes))
    flags = array.array("B", [0] * bounds[-1])
    frames = [1 + 8 * k for k in range(len(sheets))]
    return tween.Drawings(Strokes(offsets, points, flags), bounds, frames, **more)


SHEETS = [
    [line(0, 10), line(40, 20), line(90, 8)],
    [line(95, 30, reverse=True), line(5, 10), line(45, 12)],
    [line(10, 10), line(50, 12), line(100, 8), [(0, 90), (40, 95), (90, 92)]],
]


def test_strokes_find_each_other_in_any_order_and_direction():
    found = tween.match_strokes(drawings(SHEETS))
    assert found.offsets.tolist() == [0, 3, 7]
    rows = found.rows.tolist()
    assert [row[:3] for row in rows[:3]] == [[tween.PAIR, 0, 4], [tween.PAIR, 1, 5], [tween.PAIR, 2, 3]]
    assert [bool(row[3] & tween.REVERSED) for row in rows[:3]] == [False, False, True]
    assert rows[6][:3] == [tween.APPEARED, -1, 9]
    assert all(0 <= confidence <= 1 for _, confidence in found.values.tolist())


def test_pairs_made_by_hand_are_kept():
    found = tween.match_strokes(drawings(SHEETS[:2], by_hand=[0, 3, 1, -1, -1, 5]))
    rows = found.rows.tolist()
    assert rows[0][:3] == [tween.PAIR, 0, 3] and rows[0][3] & tween.BY_HAND
    assert [tween.VANISHED, 1, -1, 0] in rows and [tween.APPEARED, -1, 5, 0] in rows


def scribble(seed):
    """Twelve strokes at random places."""
    chance = random.Random(seed)
    strokes = []
    for _ in range(12):
        x, y, angle = chance.uniform(0, 300), chance.uniform(0, 300), chance.uniform(0, 6)
        strokes.append([(x + 5 * k * math.cos(angle + 0.1 * k), y + 5 * k * math.sin(angle + 0.1 * k)) for k in range(12)])
    return strokes


def test_spans_say_whether_they_are_held():
    given = drawings([scribble(1), scribble(2), scribble(2), scribble(3)])
    drawn, _ = tween.draw_in_betweens(given, [(0, [5]), (1, [13]), (2, [21])])
    assert drawn.held.tolist() == [1, 0, 1]
    first = [value for stroke in scribble(1) for point in stroke for value in point]
    shown = [value for point in drawn.points.tolist() for value in point]
    assert shown[: len(first)] == pytest.approx(first, abs=1e-9)
    assert tween.draw_in_betweens(drawings(SHEETS), [])[0].held.tolist() == []


def test_all_frames_in_one_call():
    given = drawings(SHEETS)
    spans = [(0, range(2, 9)), (1, [13])]
    drawn, matches = tween.draw_in_betweens(given, spans, spacing=["linear", "ease_in"], arcs=0.0)
    assert drawn.frame_offsets.tolist() == [0, 7, 8]
    assert drawn.shares.tolist() == [k / 8 for k in range(1, 8)] + [0.25]
    assert drawn.strokes.tolist()[:3] == [[0, 4, 0], [1, 5, 0], [2, 3, 0]]
    assert drawn.point_offsets.tolist()[:4] == [0, 10, 30, 38]
    points = drawn.points.tolist()
    assert len(points) == 7 * 38 + sum(len(s) for s in (SHEETS[1])) + 3
    # On frame 5 the middle of the way; the third stroke was drawn from the other end.
    middle = points[3 * 38 : 4 * 38]
    assert middle[0] == pytest.approx((2.5, 0.0), abs=0.01) and middle[30] == pytest.approx((92.5, 0.0), abs=0.05)
    first = drawn.indices.tolist()[30]
    assert first[:2] == [30, 30] and max(first[2:]) == 67 and matches.offsets.tolist() == [0, 3, 7]
    # A span alone is the same as among others.
    alone, _ = tween.draw_in_betweens(given, spans[:1], spacing=["linear", "ease_in"], arcs=0.0)
    assert alone.points.tolist() == points[: 7 * 38]


def test_what_only_one_drawing_has():
    sheets = [SHEETS[0], SHEETS[0][:2]]
    drawn, matches = tween.draw_in_betweens(drawings(sheets), [(0, [5])], spacing=["linear"], leaving="fade")
    assert matches.rows.tolist()[2] == [tween.VANISHED, 2, -1, 0]
    assert drawn.strokes.tolist()[2] == [2, -1, 0] and drawn.opacities.tolist() == [1.0, 1.0, 0.5]
    row = drawn.indices.tolist()[30]
    assert row == [30, 30, 30, 30]


def test_pegs_may_be_given():
    pegs = [{"name": "arm", "pivot": [0, 0], "keys": [{"frame": 1}, {"frame": 9, "turn": 360}]}]
    drawn, _ = tween.draw_in_betweens(drawings([SHEETS[0]] * 2), [(0, [5])], pegs=pegs, hung=["arm"] * 3 + [None] * 3)
    x, y = SHEETS[0][0][5]
    assert drawn.points.tolist()[5] == pytest.approx((-x, -y), abs=1e-6)


def test_what_was_captured_is_followed():
    sheets = [SHEETS[0], [line(4, 10), line(40, 20), line(90, 8)]]
    swing = [0, 20, 35, 45, 50, 40, 25, 12, 4]
    captured = [{"closed": False, "first": 1, "contours": [line(x, 10) for x in swing]}]
    drawn, _ = tween.draw_in_betweens(drawings(sheets), [(0, range(2, 9))], spacing=["linear"], captured=captured)
    points = drawn.points.tolist()
    for k, x in enumerate(swing[1:-1]):
        assert points[38 * k][0] == pytest.approx(x, abs=1e-6)
        assert points[38 * k + 10][0] == pytest.approx(40, abs=1e-6), "what lies elsewhere stays"
    plain, _ = tween.draw_in_betweens(drawings(sheets), [(0, [5])], spacing=["linear"])
    assert plain.points.tolist()[0][0] == pytest.approx(2, abs=0.1)


def test_progress_is_told_and_may_stop():
    told = []
    tween.draw_in_betweens(drawings(SHEETS), [(0, [5])], lambda share, step: told.append(share))
    assert told == sorted(told) and told[0] == 0 and told[-1] == 1
    with pytest.raises(Cancelled):
        tween.match_strokes(drawings(SHEETS), lambda share, step: False)


def captured(*contours, first=1):
    """Drawings between that follow some contours."""
    following = [{"closed": False, "first": first, "contours": contours}]
    return tween.draw_in_betweens(drawings(SHEETS), [(0, [5])], captured=following)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: tween.match_strokes(drawings(SHEETS), colour=1), "unknown field `colour`"),
        (lambda: tween.match_strokes(drawings(SHEETS, by_hand=[0, 1])), r"pair 0 is \(0, 1\)"),
        (lambda: tween.match_strokes(drawings(SHEETS, by_hand=[0])), "by_hand: 1 numbers"),
        (lambda: tween.match_strokes(drawings([[[(0.0, math.nan)]], []])), "first drawing: stroke 0: point 0"),
        (lambda: tween.match_strokes(drawings(SHEETS, labels=[1])), "labels: 1 values, expected 20"),
        (lambda: tween.draw_in_betweens(drawings(SHEETS), [(2, [20])]), "found span 2, expected a number below 2"),
        (lambda: tween.draw_in_betweens(drawings(SHEETS), [(0, [9])]), "found frame 9, expected one between 1 and 9"),
        (lambda: tween.draw_in_betweens(drawings(SHEETS), [(0, [2])], arcs=2.0), "arcs: found 2"),
        (lambda: tween.draw_in_betweens(drawings(SHEETS), [], spacing=["fast"]), "spacing"),
        (lambda: captured([[0, 0]], [[0, 1e300]]), r"captured\[0\].contours\[1\] \(frame 2\): found \(0, 1000"),
        (lambda: captured([[0, 0]], [[0, 0]], first=2**31 - 1), r"captured\[0\].first: found 2147483647"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(RototoonError, match=message):
        call()


def moving(places):
    """A bar on frames 1, 2, …, at these places."""
    sheets = [[[(x, 10.0 * i) for i in range(6)]] for x in places]
    return dataclasses.replace(drawings(sheets), frames=list(range(1, len(places) + 1)))


def test_a_breakdown_is_suggested():
    found = tween.suggest_breakdown(moving([0, 1, 2, 3, 9, 15, 21]), [1, 4, 7])
    assert (found.frame, found.first, found.last, found.by) == (5, 4, 7, "movement")
    assert found.distance == pytest.approx(18, abs=0.5)
    assert found.keys is None and found.foreign is None and found.looked == []
    assert found.text.startswith("frame 5, between the keys 4 and 7:")
    assert tween.suggest_breakdown(moving([0, 1]), [1, 2]) is None
    nowhere = {"pattern": "none_%03d.png", "first": 1, "last": 7, "fps": 24, "width": 64, "height": 64}
    assert tween.suggest_breakdown(moving([0, 1, 2, 3, 9, 15, 21]), [1, 4, 7], nowhere) == found
    with pytest.raises(RototoonError, match="options: keys: found 8"):
        tween.suggest_breakdown(moving([0, 1, 2]), [1, 8])
    with pytest.raises(Cancelled):
        tween.suggest_breakdown(moving([0, 1, 2]), [1, 3], progress=lambda share, step: False)


def test_nothing_gives_nothing():
    assert tween.match_strokes(drawings([])).offsets.tolist() == [0]
    assert tween.match_strokes(drawings([[], []])).rows.tolist() == []
    drawn, _ = tween.draw_in_betweens(drawings([[], [[]]]), [(0, [3])])
    assert drawn.points.tolist() == []
