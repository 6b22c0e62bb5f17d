"""Fits the model of confidence, checks it by cross-validation, and draws its reliability curve.

    cargo build --release -p rototoon-tests --bin bench-tracking
    target/release/bench-tracking evidence TABLES SET_DIR...
    python3 tests/confidence.py TABLES [--curve docs/src/pictures/reliability.svg]

TABLES holds one table for each set and kind of keys. All tables whose names begin alike up to the first dot show one character:
they have the same weight together, and are left out together. `far_keys` shows the sample's character.

A point is good within 2 px of the contour and 10 px of its own place, at 540 lines. A part is lost on a frame if its points are
more than a quarter of its size away in the mean. Its confidence is the mean of its points. Only scored points count. Needs numpy.
"""

import argparse
import pathlib

import logistic
import numpy as np

EVIDENCE = ("rival", "look", "cost", "apart", "slide", "edge", "margin")
CAUTION = 0.8
HELD = 0.995
BOUNDS = (0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.001)


class Table:
    """The points of one table."""

    def __init__(self, path):
        self.name = path.stem
        self.character = {"far_keys": "sample"}.get(self.name.split(".")[0], self.name.split(".")[0])
        with open(path, encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            values = np.loadtxt(file, delimiter=",", ndmin=2)
        column = dict(zip(names, values.T, strict=True))
        self.x = np.c_[tuple(column[name] for name in EVIDENCE)]
        self.good = (column["contour"] <= 2) & (column["point"] <= 10)
        self.scored, self.between = column["scored"] > 0, column["between"] > 0
        self.fitted = self.scored & self.between
        self.at, self.true = np.c_[column["x"], column["y"]], np.c_[column["true_x"], column["true_y"]]
        _, self.contour = np.unique(np.c_[column["part"], column["frame"]], axis=0, return_inverse=True)
        self.contour = self.contour.ravel()

    def contours(self, confidence):
        """Of each judged contour: whether it is lost, and its mean confidence."""
        found = []
        for k in range(self.contour.max() + 1):
            own = self.contour == k
            if not (self.scored & self.between)[own].any():
                continue
            size = np.ptp(self.true[own], axis=0).max()
            away = np.linalg.norm(self.at[own] - self.true[own], axis=1).mean()
            found.append((away > size / 4, confidence[own].mean()))
        return np.array(found).reshape(-1, 2)


def weights(tables):
    """The weight of a point of each table: every character counts the same, and so do the tables of a character."""
    alike = [sum(other.character == table.character for other in tables) for table in tables]
    share = [1 / count / max(table.fitted.sum(), 1) for count, table in zip(alike, tables, strict=True)]
    mean = sum(w * t.fitted.sum() for w, t in zip(share, tables, strict=True)) / sum(t.fitted.sum() for t in tables)
    return [w / mean for w in share]


def fit(tables, weight):
    """Intercept and slopes."""
    x = np.vstack([t.x[t.fitted] for t in tables])
    y = np.concatenate([t.good[t.fitted] for t in tables]).astype(float)
    w = np.concatenate([np.full(t.fitted.sum(), weight[t.name]) for t in tables])
    return logistic.fit(x, y, w)


def predict(table, model):
    """The confidence of every point of a table."""
    intercept, slopes = model
    p = logistic.predict(table.x, intercept - CAUTION, slopes)
    return np.where(table.between, p, HELD)


def report(tables, found):
    """Prints the figures of each table and of all."""
    sums = np.zeros(8)
    for table, p in zip(tables, found, strict=True):
        high = table.scored & (p >= 0.9)
        lost, sure = (table.contours(p)[table.contours(p)[:, 0] == k][:, 1] for k in (1, 0))
        row = np.array([table.scored.sum(), high.sum(), table.good[high].sum(), 0, len(lost), (lost < 0.5).sum(), len(sure), (sure < 0.5).sum()])
        sums += row
        print(f"{table.name:38s} {line(row)}")
    print(f"{'all':38s} {line(sums)}")


def line(row):
    """The figures of some points and contours as a text."""
    share = lambda a, b: f"{a / b:6.1%}" if b else "     –"  # noqa: E731
    return (
        f"0.9 or more {share(row[1], row[0])} of points, of them good {share(row[2], row[1])}   "
        f"lost {int(row[4]):4d}, of them below 0.5 {share(row[5], row[4])}   others below 0.5 {share(row[7], row[6])}"
    )


def reliability(tables, found, weight):
    """Mean confidence, share of good points and number of points between the bounds, every character with the same weight."""
    p = np.concatenate([q[t.fitted] for t, q in zip(tables, found, strict=True)])
    y = np.concatenate([t.good[t.fitted] for t in tables])
    w = np.concatenate([np.full(t.fitted.sum(), weight[t.name]) for t in tables])
    rows = []
    for low, high in zip(BOUNDS[:-1], BOUNDS[1:], strict=True):
        own = (p >= low) & (p < high)
        if own.any():
            rows.append((np.average(p[own], weights=w[own]), np.average(y[own], weights=w[own]), int(own.sum())))
    return rows


def curve(rows):
    """The reliability curve as SVG: confidence to the right, the share of good points upwards."""
    place = lambda x, y: (50 + 300 * x, 330 - 300 * y)  # noqa: E731
    ticks = "".join(
        f'<text x="{place(v, 0)[0]:.0f}" y="348" text-anchor="middle">{v:g}</text>'
        f'<text x="42" y="{place(0, v)[1] + 4:.0f}" text-anchor="end">{v:g}</text>'
        for v in (0, 0.25, 0.5, 0.75, 1)
    )
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(p, g) for p, g, _ in rows))
    dots = "".join(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4"/>' for x, y in (place(p, g) for p, g, _ in rows))
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 380 380" font-family="sans-serif" font-size="12">'
        '<rect width="380" height="380" fill="#fff"/><rect x="50" y="30" width="300" height="300" fill="none" stroke="#888"/>'
        f'<path d="M50 330L350 30" stroke="#888" stroke-dasharray="4 4"/>{ticks}'
        '<text x="200" y="368" text-anchor="middle">confidence</text>'
        '<text x="14" y="180" text-anchor="middle" transform="rotate(-90 14 180)">share of good points</text>'
        f'<polyline points="{path}" fill="none" stroke="#06c" stroke-width="2"/><g fill="#06c">{dots}</g></svg>\n'
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", type=pathlib.Path)
    parser.add_argument("--curve", type=pathlib.Path, help="the SVG to write")
    given = parser.parse_args()
    tables = [Table(path) for path in sorted(given.tables.glob("*.csv"))]
    weight = {table.name: w for table, w in zip(tables, weights(tables), strict=True)}
    intercept, slopes = fit(tables, weight)
    print("intercept", round(intercept, 3), dict(zip(EVIDENCE, slopes.round(3).tolist(), strict=True)))
    characters = sorted({table.character for table in tables})
    left_out = {c: fit([t for t in tables if t.character != c], weight) for c in characters}
    found = [predict(table, left_out[table.character]) for table in tables]
    report(tables, found)
    rows = reliability(tables, found, weight)
    print("\n".join(f"confidence {p:.3f}   good {g:.3f}   {n} points" for p, g, n in rows))
    if given.curve:
        given.curve.write_text(curve(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
