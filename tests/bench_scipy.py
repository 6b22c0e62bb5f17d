#!/usr/bin/env python3
"""Compares SciPy's sparse solver with Rototoon's on the normal equations of the tracker's energy.

    ROTOTOON_DUMP=$PWD/target cargo bench -p rototoon-track --bench solver
    python3 tests/bench_scipy.py target/12x20.mtx target/25x100.mtx

The script reads the MatrixMarket files that the benchmark has written and solves each with scipy.sparse.linalg.spsolve
(SuperLU) with three orderings. It prints the median times, and the median of the benchmark's "factor and solve", which
criterion has written to target/criterion. Both use one thread. The script needs NumPy and SciPy.
"""
import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import json
import pathlib
import statistics
import sys
import time

import numpy as np
import scipy.io
import scipy.sparse.linalg

ORDERINGS = ("MMD_AT_PLUS_A", "COLAMD", "NATURAL")
ROUNDS = 7


def right_hand_side(path):
    with open(path) as lines:
        for line in lines:
            if line.startswith("%rhs "):
                return np.array(line.split()[1:], float)
    raise SystemExit(f"{path}: found no line that starts with '%rhs '")


def median_time(solve):
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        solve()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def own_time(criterion, size):
    found = sorted(criterion.glob(f"solver/factor and solve/{size}/new/estimates.json"))
    return json.loads(found[0].read_text())["median"]["point_estimate"] * 1e-9 if found else None


def main(paths):
    for path in map(pathlib.Path, paths):
        matrix = scipy.io.mmread(path).tocsc()
        rhs = right_hand_side(path)
        times = {
            ordering: median_time(lambda: scipy.sparse.linalg.spsolve(matrix, rhs, permc_spec=ordering, use_umfpack=False))
            for ordering in ORDERINGS
        }
        best = min(times, key=times.get)
        residual = np.linalg.norm(matrix @ scipy.sparse.linalg.spsolve(matrix, rhs) - rhs) / np.linalg.norm(rhs)
        own = own_time(path.parent / "criterion", path.stem)
        print(f"{path.stem}: {matrix.shape[0]} variables, {matrix.nnz} non-zeros")
        print("  SciPy spsolve   " + ", ".join(f"{o} {1e3 * t:.2f} ms" for o, t in times.items()) + f"; residual {residual:.1e}")
        if own is not None:
            speed = f"{times[best] / own:.1f} times as fast as SciPy with its best ordering"
            print(f"  Rototoon        {1e3 * own:.2f} ms: {speed}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    main(sys.argv[1:])
