"""Fits the confidence of fills, and checks it on films that were left out.

    cargo build --release -p rototoon-tests --bin bench-fill
    target/release/bench-fill draw FILMS CHARACTER...
    target/release/bench-fill evidence TABLES FILMS/* DIR...
    python3 tests/fill_confidence.py TABLES [--without NAME...]

CHARACTERs are folders with project.json and truth.json, DIRs films with their colours, frames/*.png and colour/*.png. TABLES holds one
table for each film and way of painting it. All tables whose names begin alike up to the first dot show the same figures: they have the same
weight together, and are left out together.

`now` is the confidence that the program gave, `left out` that of a fit to all other films. A region is right if most of its pixels have their
true colour. Needs numpy.
"""

import argparse
import pathlib

import logistic
import numpy as np

BANDS = (0.9, 0.7, 0.5, 0.0)


class Table:
    """The regions of one table."""

    def __init__(self, path):
        self.name, self.film = path.stem, path.stem.split(".")[0]
        with open(path, encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            values = np.loadtxt(file, delimiter=",", ndmin=2).reshape(-1, len(names))
        self.given, self.right = values[:, 2], values[:, 3] > 0
        self.evidence, self.x = names[4:], values[:, 4:]


def weights(tables):
    """The weight of a region of each table: every film counts the same, and so do the tables of a film."""
    alike = [sum(other.film == table.film for other in tables) for table in tables]
    share = [1 / count / len(table.right) for count, table in zip(alike, tables, strict=True)]
    mean = sum(w * len(t.right) for w, t in zip(share, tables, strict=True)) / sum(len(t.right) for t in tables)
    return {table.name: w / mean for w, table in zip(share, tables, strict=True)}


def joined(tables, weight, column):
    """A column of all tables, and the weights of its rows."""
    return np.concatenate([column(t) for t in tables]), np.concatenate([np.full(len(t.right), weight[t.name]) for t in tables])


def fit(tables, weight):
    """Intercept and slopes."""
    x, w = joined(tables, weight, lambda t: t.x)
    y = np.concatenate([t.right for t in tables]).astype(float)
    return logistic.fit(x, y, w)


def predict(table, model):
    """The confidence of every region of a table."""
    return logistic.predict(table.x, *model)


def figures(p, y, w):
    """Right regions by bands of confidence, wrong and right ones in doubt, Brier score and log-loss, as cells of a row."""
    share = lambda mask: f"{np.average(y[mask], weights=w[mask]):.0%} of {mask.sum()}" if mask.any() else "–"  # noqa: E731
    doubted = lambda mask: f"{np.average(p[mask] < 0.5, weights=w[mask]):.0%}" if mask.any() else "–"  # noqa: E731
    highs = (1.1, *BANDS[:-1])
    cells = [share((p >= low) & (p < high)) for low, high in zip(BANDS, highs, strict=True)]
    q = np.clip(p, 1e-4, 1 - 1e-4)
    loss = -np.average(np.where(y, np.log(q), np.log(1 - q)), weights=w)
    return [*cells, doubted(~y), doubted(y), f"{np.average((p - y) ** 2, weights=w):.3f}", f"{loss:.3f}"]


def report(tables, weight, left_out, given):
    """Prints a row for each film, and one for all."""
    head = ["film", "regions right", "0.9 or more", "0.7 to 0.9", "0.5 to 0.7", "below", "wrong below 0.5", "right below 0.5", "Brier", "log-loss"]
    print(f"| {' | '.join(head)} |\n| --- |{' ---: |' * (len(head) - 1)}")
    films = sorted({table.film for table in tables})
    for name, own in [*((film, [t for t in tables if t.film == film]) for film in films), ("all", tables)]:
        y, w = joined(own, weight, lambda t: t.right)
        p, _ = joined(own, weight, lambda t: t.given if given else left_out[t.name])
        print(f"| {' | '.join([name, f'{np.average(y, weights=w):.0%}', *figures(p, y, w)])} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", type=pathlib.Path)
    parser.add_argument("--without", nargs="*", default=[], help="evidence that is not used")
    arguments = parser.parse_args()
    tables = [Table(path) for path in sorted(arguments.tables.glob("*.csv"))]
    tables = [table for table in tables if len(table.right)]
    names = [name for name in tables[0].evidence if name not in arguments.without]
    for table in tables:
        table.x = table.x[:, [table.evidence.index(name) for name in names]]
    weight = weights(tables)
    models = {film: fit([t for t in tables if t.film != film], weight) for film in {t.film for t in tables}}
    left_out = {table.name: predict(table, models[table.film]) for table in tables}
    for given in (True, False):
        print("now" if given else "left out", end="\n\n")
        report(tables, weight, left_out, given)
        print()
    intercept, slopes = fit(tables, weight)
    print("intercept", round(intercept, 3), dict(zip(names, slopes.round(3).tolist(), strict=True)))


if __name__ == "__main__":
    main()
