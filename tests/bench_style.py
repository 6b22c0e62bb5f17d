#!/usr/bin/env python3
"""Compares numeric kernels with other libraries: factorisation with scikit-learn, reshaping with libigl.

    cargo xtask bench-style [--clips FILE]

builds the program and the environment and runs this script. To run it by hand, with NumPy, scikit-learn and libigl:

    python3 tests/bench_style.py --own target/release/bench-style [--clips FILE]

- Factorisation of 2455 postures of 34 numbers (or of the postures of a file of clips), with 200 rounds without early end and
  ranks 34 and 10. The other library is scikit-learn's multiplicative NMF from random starts, in double precision. The table
  gives the relative error of the product and the median time.
- Reshaping of a bar of 800 vertices, bent by handles at both ends. "Prepare" is the work for a new set of handles, "frame"
  the work for new positions of the handles. libigl's ARAP iterates (20 times per frame). Rototoon solves two linear systems.
  The script checks that a rigid move of the handles moves the mesh rigidly, and that the reused solver agrees with the
  one-shot function.

Both libraries choose their number of threads. The script fails if a check fails. It only prints times.
"""
import argparse
import importlib.metadata
import json
import subprocess
import time
import warnings

import igl
import numpy as np
from sklearn.decomposition import NMF

ROUNDS = 200
REPETITIONS = 9
BAR = (50, 16)
ITERATIONS = 20


def own(program, **job):
    """Runs the program with a job and returns its result."""
    job["repetitions"] = REPETITIONS
    said = subprocess.run([program], input=json.dumps(job), capture_output=True, text=True, check=False)
    if said.returncode:
        raise SystemExit(f"{program}: {said.stderr.strip()}")
    return json.loads(said.stdout)


def median_time(work):
    """The median time of a function in seconds, and its last result."""
    times = []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return float(np.median(times)), result


def synthetic_postures(rows=2455, points=17):
    """Smooth gaits of synthetic characters. Each coordinate swings with its own amplitudes, phases and overtones."""
    random = np.random.default_rng(7)
    clips, left = [], rows
    while left > 0:
        count = min(left, 35)
        phase = np.linspace(0, 2 * np.pi, count, endpoint=False)[:, None]
        waves = sum(random.normal(0, 0.3 / k, 2 * points) * np.sin(k * phase + random.uniform(0, 6, 2 * points)) for k in (1, 2, 3))
        clips.append(random.normal(0, 1, 2 * points) + waves + random.normal(0, 0.02, (count, 2 * points)))
        left -= count
    return np.vstack(clips)


def postures(path):
    """The postures as rows, shifted so that no number is negative."""
    if path is None:
        rows = synthetic_postures()
    else:
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
        rows = np.vstack([np.asarray(clip["points"], float).reshape(len(clip["points"]), -1) for clip in document["clips"]])
    return rows - rows.min()


def factorisation(program, path):
    """Prints the table of the factorisation."""
    x = postures(path)
    print(f"\nFactorisation of {x.shape[0]} postures of {x.shape[1]} numbers, {ROUNDS} rounds\n")
    print("| rank | Rototoon | scikit-learn " + importlib.metadata.version("scikit-learn") + " |\n| ---: | --- | --- |")
    for rank in (34, 10):
        ours = own(program, factor={"rows": x.tolist(), "rank": rank, "rounds": ROUNDS})

        def peer(rank=rank):
            model = NMF(rank, init="random", solver="mu", max_iter=ROUNDS, tol=0, random_state=0)
            codes = model.fit_transform(x)
            return np.linalg.norm(x - codes @ model.components_) / np.linalg.norm(x)

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            seconds, error = median_time(peer)
        print(f"| {rank} | {ours['error']:.4f}, {np.median(ours['seconds']):.3f} s | {error:.4f}, {seconds:.3f} s |")


def bar():
    """A bar of 800 vertices in pixels, its triangles, and the vertices at both ends."""
    across, down = BAR
    x, y = np.meshgrid(np.arange(across) * 8.0, np.arange(down) * 8.0)
    vertices = np.stack([x.ravel(), y.ravel()], axis=1)
    corner = (np.arange(down - 1)[:, None] * across + np.arange(across - 1)).ravel()
    triangles = np.vstack([
        np.stack([corner, corner + 1, corner + across], axis=1),
        np.stack([corner + 1, corner + across + 1, corner + across], axis=1),
    ])
    ends = np.flatnonzero((vertices[:, 0] == 0) | (vertices[:, 0] == vertices[:, 0].max()))
    return vertices, triangles, ends


def turned(points, degrees, about):
    """Points turned about a point."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (points - about) @ np.array([[c, s], [-s, c]]) + about


def reshaping(program):
    """Prints the table of reshaping, and checks the results."""
    vertices, triangles, ends = bar()
    job = {"vertices": vertices.tolist(), "triangles": triangles.tolist(), "handles": ends.tolist()}
    rigid = turned(vertices, 37, [10, 20]) + [5, -3]
    moved = own(program, reshape={**job, "places": rigid[ends].tolist()})
    off = np.abs(np.asarray(moved["vertices"]) - rigid).max()
    right = vertices[ends][:, 0] > 0
    places = vertices[ends].copy()
    places[right] = turned(places[right], 60, places[right].mean(0)) - [60, 40]
    ours = own(program, reshape={**job, "places": places.tolist()})

    flat = np.ascontiguousarray(vertices)
    faces = np.ascontiguousarray(triangles, dtype=np.int64)

    def prepare():
        data = igl.ARAPData()
        data.max_iter = ITERATIONS
        igl.arap_precomputation(flat, faces, 2, ends.astype(np.int32), data)
        return data

    once, data = median_time(prepare)
    each, _ = median_time(lambda: igl.arap_solve(np.ascontiguousarray(places), data, flat))
    print(f"\nReshaping a mesh of {len(vertices)} vertices, {len(ends)} of them handles\n")
    print("| | Rototoon | libigl " + importlib.metadata.version("libigl") + f", {ITERATIONS} iterations |\n| --- | ---: | ---: |")
    print(f"| prepare | {1e3 * np.median(ours['prepare']):.2f} ms | {1e3 * once:.2f} ms |")
    print(f"| frame | {1e3 * np.median(ours['frame']):.2f} ms | {1e3 * each:.2f} ms |")
    print(f"\nA rigid move of the handles moves the mesh rigidly to {off:.1e} px; "
          f"the reused solver and the one-shot function differ by {max(ours['apart'], moved['apart']):.1e} px.")
    if off > 1e-9 or max(ours["apart"], moved["apart"]) > 1e-9:
        raise SystemExit("expected both below 1e-9 px")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--own", required=True, help="the program bench-style")
    parser.add_argument("--clips", help="a file of clips whose postures are factored")
    arguments = parser.parse_args()
    factorisation(arguments.own, arguments.clips)
    reshaping(arguments.own)


if __name__ == "__main__":
    main()
