"""Logistic regression, for the scripts that fit confidences. Needs numpy."""

import numpy as np

RIDGE = 3.0


def fit(x, y, w):
    """Intercept and slopes by maximum likelihood, with a ridge on standardised columns (Newton's method). `x` has a row for each case, `y` is 0 or
    1, and `w` the weights of the cases."""
    mean, spread = x.mean(0), x.std(0) + 1e-9
    z = np.c_[(x - mean) / spread, np.ones(len(x))]
    b, ridge = np.zeros(z.shape[1]), np.diag([RIDGE] * x.shape[1] + [1e-9])
    for _ in range(50):
        p = 1 / (1 + np.exp(-np.clip(z @ b, -30, 30)))
        step = np.linalg.solve((z * (w * p * (1 - p))[:, None]).T @ z + ridge, z.T @ (w * (y - p)) - ridge @ b)
        b += step
        if np.abs(step).max() < 1e-9:
            break
    slopes = b[:-1] / spread
    return b[-1] - slopes @ mean, slopes


def predict(x, intercept, slopes):
    """The probability of each case."""
    return 1 / (1 + np.exp(-np.clip(intercept + x @ slopes, -30, 30)))
