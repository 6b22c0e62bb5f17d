"""Control points on drawn strokes."""

import numpy as np
import pytest


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("backwards", [True, False])
def test_there_and_back(addon, closed, backwards):
    c = addon("capture.correspondence")
    rng = np.random.default_rng(5)
    for size in (7, 12, 40):
        control = np.sort(rng.uniform(0, 6.99, size))
        count = 7
        if closed:
            control = np.roll(control, 3)
        else:
            control[0], control[-1] = 0, count - 1
            control = np.sort(np.clip(control, 0, count - 1))
        control = control[::-1] if backwards else control
        where = c.invert(control, count, closed)
        assert where is not None and len(where) == count
        low = np.floor(where).astype(int)
        high = (low + 1) % size if closed else np.minimum(low + 1, size - 1)
        # Each control point lies between the two drawn points whose numbers enclose it.
        for j in range(count):
            a, b = sorted((control[low[j]], control[high[j]]))
            inside = a - 1e-9 <= j <= b + 1e-9 or (closed and b - a > count / 2 and (j >= b - 1e-9 or j <= a + 1e-9))
            assert inside, (size, j, where[j])


def test_identity_is_exact(addon):
    c = addon("capture.correspondence")
    for closed in (True, False):
        assert np.array_equal(c.invert(c.identity(9), 9, closed), np.arange(9))


def test_no_order_is_none(addon):
    c = addon("capture.correspondence")
    assert c.invert(np.zeros(5), 4, True) is None
    assert c.invert(np.zeros(5), 4, False) is None
    assert c.invert(np.array([0, 3, 1, 2.0]), 4, False) is None
    assert c.invert(np.array([0, np.nan, 2.0]), 3, True) is None


def test_located_points_lie_on_the_line(addon):
    c = addon("capture.correspondence")
    line = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    where = c.locate(line, np.array([[2.5, 0], [10, 10], [0, 5]]), True)
    assert where == pytest.approx([0.25, 2.0, 3.5])
    assert c.sample(line, where, True) == pytest.approx(np.array([[2.5, 0], [10, 10], [0, 5]]))


def test_moved_alike_or_not(addon):
    compare = addon("capture.corrections").compare
    before = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    assert compare(before, before + 0.01)[1] is False and not compare(before, before + 0.01)[0].any()
    assert compare(before, before + (5, 2))[1] is True
    moved, whole = compare(before, before + [[5, 2], [0, 0], [0, 0], [0, 0]])
    assert list(moved) == [True, False, False, False] and whole is False
    turned = before @ np.array([[0.8, 0.6], [-0.6, 0.8]]) + (3, 3)
    assert compare(before, turned)[1] is False
