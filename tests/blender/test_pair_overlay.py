"""What Match Strokes shows: lines of every curve type, numbers that do not cover each other."""

import numpy as np
import pytest


def stroke(addon, kind, points, closed=False, **attributes):
    module = addon("blender.strokes")
    content = module.Content(np.array([len(points)]), np.array([kind], np.int8))
    content.point["position"] = np.c_[points, np.zeros(len(points))]
    content.set_strokes("cyclic", np.array([closed]))
    for name, value in attributes.items():
        content.set_strokes(name, np.array([value]))
    return module, content


def drawn(addon, kind, points, closed=False, **attributes):
    _, content = stroke(addon, kind, points, closed, **attributes)
    (line,) = addon("blender.stroke_lines").lines(content)
    assert not line[:, 2].any()
    return line[:, :2]


SQUARE = np.array([(0.0, 0.0), (4, 0), (4, 4), (0, 4)])


def test_polylines_are_their_points(addon):
    assert np.array_equal(drawn(addon, 1, SQUARE), SQUARE)
    assert np.array_equal(drawn(addon, 1, SQUARE, closed=True), np.vstack([SQUARE, SQUARE[:1]]))
    assert len(drawn(addon, 1, SQUARE[:1], closed=True)) == 1
    assert len(drawn(addon, 3, np.zeros((0, 2)))) == 0


def test_quadratic_splines_pass_the_middles_of_their_legs(addon):
    closed = drawn(addon, 3, SQUARE, True, nurbs_order=3)
    for middle in ((2, 0), (4, 2), (2, 4), (0, 2)):
        assert np.abs(closed - middle).sum(1).min() < 1e-12
    assert np.allclose(closed[0], closed[-1])
    # A quarter of the way round a joint: ¾ of the guide and an eighth of both neighbouring middles' legs.
    assert np.abs(closed - (3.5, 0.5)).sum(1).min() < 1e-12
    ends = drawn(addon, 3, SQUARE, nurbs_order=3, knots_mode=1)
    assert np.array_equal(ends[[0, -1]], SQUARE[[0, 3]])
    assert np.abs(ends - (4, 2)).sum(1).min() < 1e-12
    free = drawn(addon, 3, SQUARE, nurbs_order=3, knots_mode=0)
    assert np.allclose(free[[0, -1]], [(2, 0), (2, 4)])


def test_chains_of_pieces_pass_their_joints(addon):
    points = [(0, 0), (1, 2), (2, 0), (3, -2), (4, 0)]
    chain = drawn(addon, 3, points, nurbs_order=3, knots_mode=3)
    for place in ((0, 0), (1, 1), (2, 0), (3, -1), (4, 0)):
        assert np.abs(chain - place).sum(1).min() < 1e-12


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("mode", [0, 1, 2, 3])
@pytest.mark.parametrize("count", [3, 4, 7])
@pytest.mark.parametrize("closed", [False, True])
def test_every_nurbs_stays_among_its_guides(addon, order, mode, count, closed):
    guides = np.random.default_rng(count).uniform(-3, 3, (count, 2))
    line = drawn(addon, 3, guides, closed, nurbs_order=order, knots_mode=mode)
    assert np.isfinite(line).all() and len(line) > 1
    assert (line >= guides.min(0) - 1e-9).all() and (line <= guides.max(0) + 1e-9).all()


def test_catmull_rom_and_bezier_pass_their_points(addon):
    for closed in (False, True):
        line = drawn(addon, 0, SQUARE, closed)
        assert all(np.abs(line - corner).sum(1).min() < 1e-12 for corner in SQUARE)
    _, content = stroke(addon, 2, [(0, 0), (4, 0)])
    content.point["handle_left"] = np.array([(-1.0, 0, 0), (4, 2, 0)])
    content.point["handle_right"] = np.array([(0.0, 2, 0), (5, 0, 0)])
    (line,) = addon("blender.stroke_lines").lines(content)
    assert np.abs(line - (2, 1.5, 0)).sum(1).min() < 1e-12


def arranged(addon, lines, extents, size=(400, 300), obstacles=()):
    module = addon("tween.label_places")
    around = module.anchors(lines)[..., :2]
    covered = module.Covered(module.drawn([*lines, *obstacles])[:, :2], size)
    return module.arrange(around, np.array(extents, float), covered, size, 1.0)


def test_numbers_stand_apart_inside_the_view(addon):
    rng = np.random.default_rng(5)
    lines = [np.c_[np.cumsum(rng.normal(0, 6, (9, 2)), 0) + rng.uniform(50, 250, 2), np.zeros(9)] for _ in range(40)]
    extents = np.tile((10, 8), (40, 1))
    found = arranged(addon, lines, extents)
    placed = [(np.array(at[0]), extent) for at, extent in zip(found, extents) if at is not None]
    assert len(placed) > 20
    for k, (middle, extent) in enumerate(placed):
        assert (middle >= extent).all() and (middle <= np.array((400, 300)) - extent).all()
        assert all((np.abs(middle - other) >= extent + more).any() for other, more in placed[:k])


def test_numbers_keep_clear_of_lines(addon):
    line = np.array([(100.0, 100, 0), (200, 100, 0)])
    over = np.array([(90.0, 112, 0), (210, 112, 0)])
    ((middle, on_line),) = arranged(addon, [line], [(10, 8)], obstacles=[over])
    assert middle[1] < 100 - 8 and on_line[1] == 100


def test_a_number_without_room_is_left_out(addon):
    dots = [np.array([(12.0, 30, 0)])] * 3
    found = arranged(addon, dots, [(10, 8)] * 3, size=(24, 60))
    assert found[0] is not None and found[-1] is None
    assert arranged(addon, [np.array([(900.0, 900, 0)])], [(10, 8)]) == [None]


def test_colours_of_neighbours_differ(addon):
    colour = addon("tween.pairing").colour_of
    colours = np.array([colour(k) for k in range(1, 30)])
    for apart in (1, 2, 3):
        assert np.linalg.norm(colours[apart:] - colours[:-apart], axis=1).min() > 0.3
