"""Fitting and hidden lines through the Python API."""

import array
import math

import pytest
from rototoon import RototoonError, Strokes, fit_strokes, hidden_lines


def strokes(shapes, closed=()):
    """Strokes of lists of points, as flat buffers of the standard library."""
    offsets = array.array("i", [0])
    points = array.array("d")
    for shape in shapes:
        for point in shape:
            points.extend(point)
        offsets.append(len(points) // 2)
    flags = array.array("B", closed or [0] * len(shapes))
    return Strokes(offsets, points, flags)


WAVE = [(float(k), 40.0 * math.sin(k / 30.0)) for k in range(300)]
SQUARE = [(4.0, 4.0), (8.0, 4.0), (8.0, 8.0), (4.0, 8.0)]


def test_strokes_become_light_and_carry_their_values():
    values = array.array("d", [number for x, _ in WAVE for number in (x, 2.0)])
    guides = fit_strokes(strokes([WAVE, []]), 0.5, values, 2)
    offsets = guides.offsets.tolist()
    assert offsets[0] == 0 and offsets[1] == offsets[2] < 25
    assert guides.points.shape == (offsets[1], 2) and guides.values.shape == (offsets[1], 2)
    assert guides.points.tolist()[0] == pytest.approx(WAVE[0], abs=0.5)
    assert guides.nearest.tolist()[0] == 0 and guides.nearest.tolist()[-1] == 299
    assert [carried[1] for carried in guides.values.tolist()] == pytest.approx([2.0] * offsets[1])
    assert guides.errors.tolist()[0] <= 0.5 and guides.errors.tolist()[1] == 0.0


def test_hidden_parts_are_blends_of_the_given_points():
    given = strokes([[(0.0, 5.0), (16.0, 5.0)], SQUARE], [0, 1])
    depths, fills = array.array("i", [0, 0, 0, 1]), array.array("i", [0, 1])
    pieces = hidden_lines(given, array.array("B", [0, 0]), depths, fills)
    assert pieces.strokes.tolist() == [0, 0, 0, 1] and pieces.hidden.tolist() == [0, 1, 0, 0]
    assert pieces.intervals.tolist() == [[0.0, 0.25], [0.25, 0.5], [0.5, 1.0], [0.0, 4.0]]
    assert pieces.offsets.tolist() == [0, 2, 4, 6, 6]
    rows = zip(pieces.indices.tolist(), pieces.weights.tolist())
    xs = [sum(given.points[2 * k] * weight for k, weight in zip(*row)) for row in rows]
    assert xs == pytest.approx([0.0, 4.0, 4.0, 8.0, 8.0, 16.0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: fit_strokes(s, 0.0), "tolerance: found 0 px"),
        (lambda s: fit_strokes(s, math.nan), "tolerance: found NaN px"),
        (lambda s: fit_strokes(s, 1.0, [1.0], 1), "values: 1 numbers, expected 2"),
        (lambda s: fit_strokes(strokes([[(0.0, math.nan)]]), 1.0), "stroke 0: point 0"),
        (lambda s: fit_strokes(Strokes([0, 2], s.points[:2], [0]), 1.0), "points: 2 numbers"),
        (lambda s: fit_strokes(Strokes([], [], []), 1.0), "closed: 0 values"),
        (lambda s: fit_strokes(Strokes([1, 2], s.points, [0]), 1.0), "begin at 0"),
        (lambda s: fit_strokes(Strokes(array.array("d", [0, 2]), s.points, [0]), 1.0), "numbers of type i"),
        (lambda s: hidden_lines(s, [3], [0, 0], [0]), "forms: found 3"),
        (lambda s: hidden_lines(s, [0], [0], [0]), "depths: 1 values, expected 2"),
        (lambda s: hidden_lines(s, [0], [0, 0], [0], border=-1.0), "border of -1 px"),
        (lambda s: hidden_lines(strokes([[(math.inf, 0.0)]]), [0], [0, 0], [0]), "stroke 0: point 0"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(RototoonError, match=message):
        call(strokes([[(0.0, 0.0), (1.0, 0.0)]]))


def test_nothing_gives_nothing():
    assert fit_strokes(strokes([]), 1.0).offsets.tolist() == [0]
    assert hidden_lines(strokes([]), [], [], []).strokes.tolist() == []
    assert hidden_lines(strokes([[]]), [0], [0, 0], [1]).strokes.tolist() == []
