#!/usr/bin/env python3
"""Compares curve fitting with other libraries: pieces, true largest error and time on six outlines (bench_fit_outlines.py).

    cargo xtask bench-fit

builds the program and the environments and runs this script. To run it by hand, with NumPy, SciPy and cu2qu, and Node.js
with fit-curve and paper:

    python3 tests/bench_fit.py --own target/release/bench-fit [--node FOLDER] [--tolerance 1] [--svg FILE] [--sweep [--outline NAME]]

--node is the folder whose node_modules contains fit-curve and paper. Without it these are left out, and so is cu2qu, whose
input are the cubics of fit-curve.

Each method is measured with the fewest pieces with which its true error keeps the tolerance:
- Rototoon is called with the tolerance. Nothing is tuned.
- SciPy's FITPACK (splprep, k = 2, periodic for closed outlines): bisection finds the largest smoothing whose error keeps the
  tolerance. The time is that of all bisection steps, because the smoothing is not known in advance. "One call" is the time of
  the chosen call.
- paper.js Path.simplify and fit-curve (Schneider 1990): of 90 values of their tolerance parameter the one with the fewest
  pieces is used. The time is that of the one call with it. Their pieces are cubic.
- cu2qu (quadratics from cubics) works on fit-curve's cubics. Each of the two gets half of the tolerance parameter.

- kurbo (simplify_bezpath, by subdivision; its optimisation takes minutes for each outline) works on the polyline. Of 90 values of its accuracy near the tolerance, and of three angles below
  which a join is smooth, the fewest cubics are used.

--sweep prints one table instead: the pieces of each method on other outlines (swept in bench_fit_outlines.py) at tolerances
from 0.25 to 5 px, and in brackets the pieces as drawn: neighbours on one straight line count as one. The two counts are each
method's fewest, so they may come from two settings. On points rounded to pixels, Rototoon takes a tolerance below 1 px for the line before rounding. Its bound
is then the tolerance plus half a pixel, at most 1 px. The others get the same bound.

The true error is measured in the same way for all. Each curve is sampled every hundredth of a pixel. The error is the
largest distance from a given point to the polyline of the samples, or from a sample to the polyline of the points.
"""
import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import json
import pathlib
import subprocess
import sys
import time

import numpy as np
from scipy.interpolate import splev, splprep
from scipy.spatial import cKDTree

from bench_fit_outlines import outlines, swept

SPACING = 0.01
BISECTIONS = 24
SWEPT = (0.25, 0.5, 1.0, 2.0, 3.0, 5.0)
STRAIGHT = 1e-3


def quadratics_of(guides, closed):
    """Bézier control points of the pieces of a uniform quadratic B-spline."""
    g = np.asarray(guides, float)
    if closed:
        before, after = np.roll(g, 1, axis=0), np.roll(g, -1, axis=0)
        return np.stack([(before + g) / 2, g, (g + after) / 2], axis=1)
    if len(g) < 3:
        return np.stack([g[:1], (g[:1] + g[-1:]) / 2, g[-1:]], axis=1)
    joints = np.vstack([g[:1], (g[1:-2] + g[2:-1]) / 2, g[-1:]])
    return np.stack([joints[:-1], g[1:-1], joints[1:]], axis=1)


def straight(control):
    """Whether control points run along their chord in its direction, at most STRAIGHT pixels beside it."""
    chord = control[-1] - control[0]
    length = np.hypot(*chord)
    if length < STRAIGHT:
        return False
    along = (control - control[0]) @ chord / length
    beside = (control - control[0]) @ np.array([-chord[1], chord[0]]) / length
    return np.abs(beside).max() <= STRAIGHT and np.diff(along).min() >= -STRAIGHT


def drawn(beziers, closed):
    """The number of pieces as drawn: neighbouring pieces on one straight line count as one.

    It is the same rule for pieces of any degree. A run of pieces is one line if all their control points are on its chord.
    """
    pieces = [np.asarray(control, float) for control in beziers]
    runs = pieces[:1]
    for control in pieces[1:]:
        joined = np.vstack([runs[-1], control])
        if straight(joined):
            runs[-1] = joined
        else:
            runs.append(control)
    # The last run of a closed curve may go on in the first one.
    around = closed and len(runs) > 1 and straight(np.vstack([runs[-1], runs[0]]))
    return len(runs) - around


def sampled(beziers):
    """Samples of Bézier pieces of any degree as one polyline. Neighbouring samples are at most SPACING apart."""
    parts = []
    for control in np.asarray(beziers, float):
        hull = np.hypot(*np.diff(control, axis=0).T)
        steps = max(2, int(np.ceil((len(control) - 1) * hull.max() / SPACING)))
        u = np.linspace(0, 1, steps + 1)[:, None]
        level = [np.repeat(c[None], steps + 1, axis=0) for c in control]
        while len(level) > 1:
            level = [a + (b - a) * u for a, b in zip(level, level[1:])]
        parts.append(level[0])
    return np.vstack(parts)


def to_polyline(points, line, closed):
    """Distances of points to a polyline, by the segments at the nearest vertices of a densely sampled copy."""
    ends = np.vstack([line, line[:1]]) if closed else line
    steps = np.maximum(1, np.ceil(np.hypot(*np.diff(ends, axis=0).T) / 0.25).astype(int))
    owner = np.repeat(np.arange(len(steps)), steps)
    share = np.concatenate([np.arange(n) / n for n in steps])[:, None]
    dense = ends[owner] + share * (ends[owner + 1] - ends[owner])
    owner = np.append(owner, len(steps) - 1)
    dense = np.vstack([dense, ends[-1:]])
    _, near = cKDTree(dense).query(points, k=min(6, len(dense)))
    best = np.full(len(points), np.inf)
    for column in np.atleast_2d(near.T if near.ndim > 1 else near[:, None].T):
        for segment in (owner[column], np.maximum(owner[column] - 1, 0)):
            a, d = ends[segment], ends[segment + 1] - ends[segment]
            squared = np.maximum((d * d).sum(1), 1e-300)
            u = np.clip(((points - a) * d).sum(1) / squared, 0, 1)[:, None]
            best = np.minimum(best, np.hypot(*(points - a - u * d).T))
    return best


def true_error(beziers, points, closed):
    samples = sampled(beziers)
    return max(to_polyline(points, samples, False).max(), to_polyline(samples, points, closed).max())


def asked(program, outline, *arguments):
    """What the program bench-fit says about one outline."""
    job = {"curves": [{"closed": outline["closed"], "points": outline["points"].tolist()}]}
    said = subprocess.run([program, *arguments], input=json.dumps(job), capture_output=True, text=True, check=True)
    return json.loads(said.stdout)


def own(program, outline, tolerance, rounds=40):
    result = asked(program, outline, str(tolerance), "--rounds", str(rounds))[0]
    return quadratics_of(result["guides"], outline["closed"]), result["ms"], result["max_error"]


def spline_beziers(tck):
    """Bézier pieces of a quadratic spline. Values at both ends and in the middle of a piece give its control points."""
    knots = np.unique(tck[0])
    knots = knots[(knots >= 0) & (knots <= 1)]
    middle = 0.5 * (knots[:-1] + knots[1:])
    p0, pm, p2 = (np.column_stack(splev(t, tck)) for t in (knots[:-1], middle, knots[1:]))
    return np.stack([p0, 2 * pm - 0.5 * (p0 + p2), p2], axis=1)


def fitpack(outline, tolerance):
    """The fewest pieces, the times of the search and of one call, and the fewest pieces as drawn."""
    points, closed = outline["points"], outline["closed"]
    data = np.vstack([points, points[:1]]) if closed else points
    # FITPACK refuses repeated points.
    data = data[np.concatenate([[True], np.any(np.diff(data, axis=0) != 0, axis=1)])]

    def fit(smoothing):
        tck, _ = splprep(data.T, s=smoothing, k=2, per=closed, quiet=2)
        return spline_beziers(tck)

    start = time.perf_counter()
    low, high, best, lines = 0.0, len(points) * tolerance**2, None, np.inf
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        before = time.perf_counter()
        pieces = fit(middle)
        one = time.perf_counter() - before
        if true_error_quick(pieces, points, closed) <= tolerance:
            low = middle
            lines = min(lines, drawn(pieces, closed))
            if best is None or len(pieces) <= len(best[0]):
                best = (pieces, one)
        else:
            high = middle
    whole = time.perf_counter() - start
    pieces, one = best
    return pieces, 1e3 * whole, 1e3 * one, lines


def true_error_quick(pieces, points, closed):
    """The same error with coarser samples, for searches."""
    global SPACING
    SPACING, fine = 0.1, SPACING
    try:
        return true_error(pieces, points, closed)
    finally:
        SPACING = fine


def node(folder, method, outline, tolerances, repeats=5):
    job = {"method": method, "repeats": repeats, "closed": outline["closed"]}
    job |= {"points": outline["points"].tolist(), "tolerances": list(tolerances)}
    script = pathlib.Path(__file__).resolve().parent / "bench_fit_peers.cjs"
    environment = {**os.environ, "NODE_PATH": str(pathlib.Path(folder).resolve() / "node_modules")}
    said = subprocess.run(["node", script], input=json.dumps(job), capture_output=True, text=True, check=True, env=environment)
    return json.loads(said.stdout)


def searched(outline, tolerance, run, values=90):
    """Finds the fewest pieces over many values of a method's own tolerance, then measures the time of the best one.

    Returns the pieces, the time, and the fewest pieces as drawn.
    """
    ladder = tolerance * np.geomspace(*getattr(run, "range", (0.05, 6.0)), values)
    best, lines = None, np.inf
    for parameter, pieces in zip(ladder, run(ladder, 1)):
        if len(pieces[0]) and true_error_quick(pieces[0], outline["points"], outline["closed"]) <= tolerance:
            lines = min(lines, drawn(pieces[0], outline["closed"]))
            if best is None or len(pieces[0]) < len(best[1]):
                best = (parameter, pieces[0])
    if best is None:
        return None
    pieces, ms = run([best[0]], 5)[0]
    return pieces, ms, lines


def cubic_method(folder, method):
    def run(outline):
        return lambda ladder, repeats: [(r["cubics"], r["ms"]) for r in node(folder, method, outline, ladder, repeats)]

    return run


def kurbo(program):
    def run(outline):
        def at(ladder, repeats):
            results = asked(program, outline, "--rounds", str(repeats), "--kurbo", ",".join(str(t) for t in ladder))
            return [(r["cubics"], r["ms"]) for r in results]

        # kurbo's accuracy bounds the distance, so much smaller and much larger values are of no use.
        at.range = (0.4, 2.0)
        return at

    return run


def through_cu2qu(folder):
    from cu2qu import curve_to_quadratic

    def convert(cubics, tolerance):
        start = time.perf_counter()
        splines = [curve_to_quadratic([tuple(p) for p in c], float(tolerance)) for c in cubics]
        ms = 1e3 * (time.perf_counter() - start)
        pieces = []
        for control in splines:
            c = np.asarray(control, float)
            joints = np.vstack([c[:1], (c[1:-2] + c[2:-1]) / 2, c[-1:]])
            pieces.extend(np.stack([joints[:-1], c[1:-1], joints[1:]], axis=1))
        return pieces, ms

    def run(outline):
        def both(ladder, repeats):
            fitted = node(folder, "fit-curve", outline, np.asarray(ladder) / 2, repeats)
            made = [convert(f["cubics"], t / 2) for f, t in zip(fitted, ladder)]
            return [(pieces, f["ms"] + ms) for (pieces, ms), f in zip(made, fitted)]

        return both

    return run


def sweep(given):
    """Prints the pieces of each method at each tolerance, and then where a quadratic peer needs fewer.

    In brackets are the pieces as drawn.
    """
    peers = {"kurbo, cubic": kurbo(given.own)}
    if given.node:
        peers |= {"paper.js, cubic": cubic_method(given.node, "paper"), "fit-curve, cubic": cubic_method(given.node, "fit-curve")}
        peers["cu2qu"] = through_cu2qu(given.node)
    names = ["Rototoon", "corners", "FITPACK", *peers]
    print(f"| outline | px | {' | '.join(names)} |\n| --- | ---: |{' ---: |' * len(names)}")
    beaten = []
    for outline in swept():
        if given.outline and outline["name"] not in given.outline:
            continue
        rounded = np.all(np.abs(outline["points"] - np.floor(outline["points"]) - 0.5) < 1e-9)
        for tolerance in SWEPT:
            bound = max(tolerance, min(tolerance + 0.5, 1.0)) if rounded else tolerance
            pieces, _, said = own(given.own, outline, tolerance, 1)
            error = true_error_quick(pieces, outline["points"], outline["closed"])
            if error > said + 1e-3 or said > bound + 1e-9:
                sys.exit(f"{outline['name']}, {tolerance} px: found the error {error}, said {said}, expected at most {bound}")
            corners = len(asked(given.own, outline, str(tolerance), "--rounds", "1")[0]["corners"])
            row = {"Rototoon": (len(pieces), drawn(pieces, outline["closed"])), "corners": corners}
            found = fitpack(outline, bound)
            row["FITPACK"] = len(found[0]), found[3]
            for name, method in peers.items():
                found = searched(outline, bound, method(outline), 8 if name.startswith("kurbo") else 24)
                row[name] = (len(found[0]), found[2]) if found else "–"
            quadratic = [row[name] for name in ("FITPACK", "cu2qu") if isinstance(row.get(name), tuple)]
            for count, what in ((0, "pieces"), (1, "pieces as drawn")):
                fewest = min((peer[count] for peer in quadratic), default=np.inf)
                if fewest < row["Rototoon"][count]:
                    place = f"{outline['name']} at {tolerance} px"
                    beaten.append(f"{place}: {row['Rototoon'][count]} {what}, a quadratic peer {fewest}")
            cells = ("{} ({})".format(*row[name]) if isinstance(row[name], tuple) else str(row[name]) for name in names)
            print(f"| {outline['name']} | {tolerance:g} | {' | '.join(cells)} |", flush=True)
    for line in beaten:
        print(f"fewer pieces elsewhere: {line}")


def picture(path, shown):
    """Draws each outline's points with Rototoon's curve and the joints of its pieces, as SVG."""
    parts, top = [], 0.0
    for outline, pieces in shown:
        points = outline["points"]
        low, high = points.min(0) - 12, points.max(0) + 12
        shift = np.array([-low[0], top - low[1]])
        line = " ".join(f"{x:.2f},{y:.2f}" for x, y in points + shift)
        curve = [f"M{pieces[0][0][0] + shift[0]:.3f},{pieces[0][0][1] + shift[1]:.3f}"]
        curve += ["Q{:.3f},{:.3f} {:.3f},{:.3f}".format(*(p[1] + shift), *(p[2] + shift)) for p in pieces]
        dots = "".join(f'<circle cx="{p[0][0] + shift[0]:.2f}" cy="{p[0][1] + shift[1]:.2f}" r="1.6" fill="#d22"/>' for p in pieces)
        parts.append(f'<polyline points="{line}" fill="none" stroke="#bbb" stroke-width="0.5"/>')
        parts.append(f'<path d="{" ".join(curve)}" fill="none" stroke="#06c" stroke-width="0.8"/>{dots}')
        top += high[1] - low[1]
    pathlib.Path(path).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="640" height="{top:.0f}"><rect width="100%" height="100%" fill="#fff"/>'
        + "".join(parts) + "</svg>\n"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--own", required=True, help="the program bench-fit")
    parser.add_argument("--node", help="folder whose node_modules contains fit-curve and paper")
    parser.add_argument("--tolerance", type=float, default=1.0, help="largest distance between line and curve, in pixels")
    parser.add_argument("--svg", help="SVG file for a picture of Rototoon's curves")
    parser.add_argument("--sweep", action="store_true", help="tolerances from 0.25 to 5 px on other outlines instead")
    parser.add_argument("--outline", action="append", help="only this outline of the sweep; may be given several times")
    given = parser.parse_args()
    if given.sweep:
        return sweep(given)
    print(f"| outline | method | pieces | true error, px | ms |\n| --- | --- | ---: | ---: | ---: |")
    shown = []
    for outline in outlines():
        points, closed = outline["points"], outline["closed"]
        rows = []
        pieces, ms, said = own(given.own, outline, given.tolerance)
        shown.append((outline, pieces))
        error = true_error(pieces, points, closed)
        if error > said + 1e-6:
            sys.exit(f"{outline['name']}: found the true error {error}, expected at most the reported {said}")
        rows.append(("Rototoon", pieces, f"{ms:.1f}"))
        pieces, whole, one, _ = fitpack(outline, given.tolerance)
        rows.append(("SciPy FITPACK", pieces, f"{whole:.0f} (one call {one:.1f})"))
        peers = [("kurbo simplify, cubic", kurbo(given.own))]
        if given.node:
            peers += [("paper.js simplify, cubic", cubic_method(given.node, "paper"))]
            peers += [("fit-curve, cubic", cubic_method(given.node, "fit-curve")), ("fit-curve + cu2qu", through_cu2qu(given.node))]
        for name, method in peers:
            found = searched(outline, given.tolerance, method(outline))
            rows.append((name, *((found[0], f"{found[1]:.1f}") if found else (None, "–"))))
        for name, pieces, ms in rows:
            what = f"{outline['name']}, {len(points)} points"
            figures = (len(pieces), f"{true_error(pieces, points, closed):.3f}") if pieces is not None else ("–", "–")
            print(f"| {what} | {name} | {figures[0]} | {figures[1]} | {ms} |", flush=True)
    if given.svg:
        picture(given.svg, shown)


if __name__ == "__main__":
    main()
