"""Outlines for the comparison of curve fitting: six different ones (outlines), and those of the sweep of tolerances (swept).
The seed is fixed, so the points are always the same.

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


def zigzag():
    """Twelve tips of 24 px between straight legs, open."""
    k = np.arange(14)
    return _by_length(np.column_stack([20.3 + 14.0 * k, 50.4 + 24.0 * (k % 2)]), 0.05)


def gear():
    """Eighteen teeth of 24 px, which have 72 corners."""
    tips = [((k + share) * np.pi / 9, radius) for k in range(18) for share, radius in ((0, 150), (0.32, 150), (0.42, 126), (0.9, 126))]
    tips = np.array([[170 + r * np.cos(a), 170 + r * np.sin(a)] for a, r in tips])
    return _by_length(np.vstack([tips, tips[:1]]), 0.05)


def eight():
    """A figure eight, smooth and closed."""
    t = np.linspace(0, 2 * np.pi, 20001)
    return 140 + np.column_stack([120 * np.sin(t), 72 * np.sin(2 * t)])


def s_curve():
    """Two and a half waves, smooth and open."""
    t = np.linspace(0, 1, 20001)
    return np.column_stack([20 + 900 * t, 150 + 90 * np.sin(5 * np.pi * t)])


def glyph(start, parts):
    """A contour of straight lines (one point) and cubics (three points), twice as large, with 20 px of room."""
    t = np.linspace(0, 1, 2000, endpoint=False)[:, None]
    at, lines = np.array(start, float), []
    for part in parts:
        c = np.array(part, float)
        if c.ndim == 1:
            lines.append(at + t * (c - at))
            at = c
        else:
            lines.append((1 - t) ** 3 * at + 3 * (1 - t) ** 2 * t * c[0] + 3 * (1 - t) * t * t * c[1] + t**3 * c[2])
            at = c[2]
    outline = 20 + 2 * np.vstack(lines)
    return np.vstack([outline, outline[:1]])


def glyph_d():
    """A D with serifs: stems, a bowl, brackets."""
    return glyph((0, 0), [(40, 0), ((85, 0), (100, 25), (100, 50)), ((100, 75), (85, 100), (40, 100)), (0, 100), (0, 94),
                          ((7, 94), (11, 93), (11, 86)), (11, 14), ((11, 7), (7, 6), (0, 6)), (0, 0)])


def glyph_s():
    """An S with four corners."""
    return glyph((70, 25), [((70, 12), (55, 8), (42, 8)), ((28, 8), (16, 14), (16, 26)), ((16, 48), (82, 38), (82, 72)),
                            ((82, 90), (62, 100), (40, 100)), ((18, 100), (2, 90), (2, 70)), (14, 70),
                            ((14, 84), (26, 91), (42, 91)), ((58, 91), (69, 84), (69, 74)), ((69, 52), (4, 62), (4, 28)),
                            ((4, 10), (22, 0), (42, 0)), ((66, 0), (82, 10), (82, 25)), (70, 25)])


def swept():
    """The outlines of the sweep. Each is rounded to pixels, and zigzag, figure eight and S-curve are there unrounded too."""
    random = np.random.default_rng(SEED + 1)
    shapes = [("zigzag", False, zigzag()), ("gear", True, gear()), ("figure eight", True, eight()), ("S-curve", False, s_curve()),
              ("glyph D", True, glyph_d()), ("glyph S", True, glyph_s())]
    found = [{"name": f"{name}, pixels", "closed": closed, "points": _rounded(shape)} for name, closed, shape in shapes]
    for name, closed, shape in (shapes[0], shapes[2], shapes[3]):
        points = _by_length(shape, 1.0)
        points = points[:-1] if closed else points
        found.append({"name": name, "closed": closed, "points": points})
    points = _by_length(s_curve(), 1.0)
    jitter = points + random.normal(0, 0.2, points.shape)
    return found + [{"name": "S-curve, hand jitter", "closed": False, "points": jitter}]


if __name__ == "__main__":
    import json
    import sys

    curves = [{**o, "points": o["points"].tolist()} for o in outlines()]
    json.dump({"curves": curves}, sys.stdout)
