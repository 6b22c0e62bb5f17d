"""Six different outlines, for the comparison of curve fitting. The seed is fixed, so the points are always the same.

Each outline is a dict with `name`, `closed` and `points` (in pixels). All but the noisy stroke are sampled about every pixel
and rounded to pixel centres, like the output of a bitmap tracer. So neighbouring points may be equal.
"""
import numpy as np

SEED = 1986


def _by_length(points, step):
    """Points of a dense polyline at even steps of its arc length."""
    lengths = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = int(round(lengths[-1] / step))
    at = np.linspace(0, lengths[-1], count + 1)
    return np.column_stack([np.interp(at, lengths, points[:, k]) for k in (0, 1)])


def _rounded(points, count=None):
    """Samples of a dense polyline, rounded to pixel centres: `count` of them, or about one per pixel of its length."""
    length = np.hypot(*np.diff(points, axis=0).T).sum()
    return np.floor(_by_length(points, length / (count or round(length)))) + 0.5


def _harmonics(angle, terms):
    return sum(a * np.cos(k * angle + phase) for k, a, phase in terms)


def cartoon():
    """A smooth closed outline with two corners, about 1200 px long."""
    t = np.linspace(0, 1, 20001)
    # Two smooth sides between two corners, each with bends of its own.
    corners = np.array([[150.0, 60.0], [420.0, 330.0]])
    sides = []
    for (a, b), waves in (((0, 1), ((1, 135.0), (2, 38.0), (3, -22.0), (5, 9.0))), ((1, 0), ((1, 150.0), (2, -46.0), (4, 13.0)))):
        s = t[:-1]
        chord = corners[b] - corners[a]
        normal = np.array([chord[1], -chord[0]]) / np.hypot(*chord)
        bulge = sum(size * np.sin(np.pi * k * s) for k, size in waves)
        sides.append(corners[a] + s[:, None] * chord + bulge[:, None] * normal)
    return np.vstack(sides + [corners[:1]])


def star():
    """A star with nine points and slightly bent sides, which has eighteen corners."""
    angles = np.arange(18) * np.pi / 9 + 0.13
    radii = np.where(np.arange(18) % 2 == 0, 190.0, 95.0)
    tips = 220 + radii[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    s = np.linspace(0, 1, 2000, endpoint=False)[:, None]
    sides = []
    for k in range(18):
        a, b = tips[k], tips[(k + 1) % 18]
        normal = np.array([b[1] - a[1], a[0] - b[0]]) / np.hypot(*(b - a))
        sides.append(a + s * (b - a) + 4.0 * np.sin(np.pi * s) * normal)
    return np.vstack(sides + [tips[:1]])


def limb():
    """A long thin limb with round ends, bent twice."""
    s = np.linspace(0, 1, 8000)
    middle = np.column_stack([40 + 470 * s, 160 + 70 * np.sin(2.2 * np.pi * s) * (0.5 + s)])
    tangent = np.gradient(middle, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    half = (13 - 5 * s)[:, None]
    turn = np.linspace(0, np.pi, 2000)[:, None]
    end = middle[-1] + half[-1] * (np.cos(turn) * normal[-1] + np.sin(turn) * tangent[-1])
    start = middle[0] - half[0] * (np.cos(turn) * normal[0] + np.sin(turn) * tangent[0])
    outline = np.vstack([middle + half * normal, end, (middle - half * normal)[::-1], start])
    return np.vstack([outline, outline[:1]])


def stroke(random):
    """A stroke like one drawn by hand on a tablet, with uneven spacing and jitter of a quarter pixel."""
    t = np.linspace(0, 1, 4000)
    x = 60 + 520 * t + 55 * np.sin(9.5 * t)
    y = 200 + 90 * np.sin(7.0 * t + 0.4) * (1 - 0.5 * t) + 24 * np.sin(23 * t)
    speed = 1.0 + 0.6 * np.sin(13 * t + 1.0)
    at = np.cumsum(1 / speed)
    at = (at - at[0]) / (at[-1] - at[0])
    pick = np.linspace(0, 1, 430)
    points = np.column_stack([np.interp(pick, at, x), np.interp(pick, at, y)])
    return points + random.normal(0, 0.25, points.shape)


def spiral():
    """Four turns of an Archimedean spiral, open."""
    angle = np.linspace(0.6, 8 * np.pi, 20000)
    radius = 6 + 7.2 * angle
    return np.column_stack([220 + radius * np.cos(angle), 220 + radius * np.sin(angle)])


def blob():
    """A closed outline close to a circle."""
    angle = np.linspace(0, 2 * np.pi, 20001)
    radius = 130 + _harmonics(angle, ((2, 9.0, 0.3), (3, 5.0, 1.9), (5, 2.0, 4.0)))
    return np.column_stack([180 + radius * np.cos(angle), 180 + radius * np.sin(angle)])


def outlines():
    random = np.random.default_rng(SEED)
    return [
        {"name": "cartoon outline", "closed": True, "points": _rounded(cartoon(), 1216)},
        {"name": "star", "closed": True, "points": _rounded(star())},
        {"name": "thin limb", "closed": True, "points": _rounded(limb())},
        {"name": "noisy stroke", "closed": False, "points": stroke(random)},
        {"name": "spiral", "closed": False, "points": _rounded(spiral())},
        {"name": "blob", "closed": True, "points": _rounded(blob())},
    ]


if __name__ == "__main__":
    import json
    import sys

    curves = [{**o, "points": o["points"].tolist()} for o in outlines()]
    json.dump({"curves": curves}, sys.stdout)
