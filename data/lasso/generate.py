#!/usr/bin/env python3
"""LASSO problems and their solutions by scikit-learn's coordinate descent.

Writes, for each problem, <name>.csv (y and the columns of Theta, one row a
sample) and <name>_solutions.csv, one row a lambda: the coefficients xi of

    min 1/2 |y - Theta xi|^2 + lambda sum_j w_j |xi_j|

with w_j = 1 (scaled = 0) or w_j = |Theta_j| (scaled = 1), the objective and
the duality gap.  scikit-learn minimises 1/(2 n) |y - X b|^2 + alpha |b|_1, so
lambda = n alpha, and columns of length one stand for the second kind.

    wide         more columns than samples, correlated
    ill_scaled   columns from 1e-6 to 1e6
    duffing      monomials of displacement and velocity of a Duffing
                 oscillator to degree 5: ill-scaled and nearly dependent

Python 3.11, NumPy, scikit-learn 1.2.  Nothing here uses pinode.
pinode/discover/lasso_reference_test.cc reads the files.
"""

import argparse
import os
import warnings

import numpy as np
from scipy.integrate import solve_ivp
from sklearn.exceptions import ConvergenceWarning
from sklearn.linear_model import Lasso

HERE = os.path.dirname(os.path.abspath(__file__))
# Of the largest lambda with a coefficient; plain and scaled penalty.
FRACTIONS = {
    "wide": ([0.5, 0.1, 0.02, 0.004], [0.5, 0.1, 0.02, 0.004]),
    "ill_scaled": ([0.5, 1e-2, 1e-4, 1e-6], [0.5, 0.1, 0.02, 0.004]),
    "duffing": ([0.5, 1e-3, 3e-5, 1e-6], [0.5, 0.05, 4e-3, 1e-3]),
}


def wide(random):
    samples, columns = 40, 60
    theta = random.standard_normal((samples, columns))
    for j in range(1, columns):
        theta[:, j] = 0.6 * theta[:, j - 1] + 0.8 * theta[:, j]
    truth = np.zeros(columns)
    truth[[3, 17, 18, 41, 59]] = [2.0, -1.5, 1.0, 0.7, -3.0]
    return theta, theta @ truth + 0.1 * random.standard_normal(samples)


def ill_scaled(random):
    samples, columns = 100, 20
    theta = random.standard_normal((samples, columns))
    theta += 0.5 * random.standard_normal((samples, 1))
    truth = np.zeros(columns)
    truth[::4] = [1.0, -0.8, 0.6, -0.4, 0.2]
    y = theta @ truth + 0.05 * random.standard_normal(samples)
    return theta * 10.0 ** np.linspace(-6.0, 6.0, columns), y


def duffing(random):
    samples = 150

    def rate(t, h):
        force = 0.8 * np.sin(2.3 * t) + 0.5 * np.sin(5.1 * t + 1.0)
        return [h[1], force - 0.3 * h[1] - 4.0 * h[0] - 6.0 * h[0] ** 3]

    times = np.linspace(0.0, 30.0, samples)
    x, v = solve_ivp(rate, (0.0, 30.0), [0.6, 0.0], method="DOP853",
                     t_eval=times, rtol=1e-11, atol=1e-12).y
    # In millimetres and metres per second: what units do to a library.
    x_mm = 1e3 * x
    theta = np.column_stack([x_mm ** (degree - i) * v ** i
                             for degree in range(1, 6)
                             for i in range(degree + 1)])
    y = -0.3 * v - 4.0 * x - 6.0 * x ** 3
    return theta, y + 0.01 * y.std() * random.standard_normal(samples)


def solve(theta, y, penalty):
    """Coordinate descent until nothing moves.

    In rounds, each from the coefficients of the one before: within a fit the
    residual is updated, and its rounding errors add up.
    """
    model = Lasso(alpha=penalty / len(y), fit_intercept=False, tol=1e-18,
                  max_iter=20000, warm_start=True)
    before = np.zeros(theta.shape[1])
    for _ in range(500):
        with warnings.catch_warnings():
            # Such a tolerance lies below rounding; the gap is checked below.
            warnings.simplefilter("ignore", ConvergenceWarning)
            model.fit(theta, y)
        size = np.linalg.norm(theta * model.coef_, axis=0)
        change = np.linalg.norm(theta * (model.coef_ - before), axis=0)
        if change.max() <= 1e-12 * size.max():
            return model.coef_
        before = model.coef_.copy()
    raise RuntimeError(f"not converged: {change.max() / size.max():.1e}")


def write(path, header, rows):
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(",".join(header) + "\n")
        for row in rows:
            file.write(",".join(repr(float(value)) for value in row) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", default=HERE)
    folder = parser.parse_args().output
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(1)
    for problem in (wide, ill_scaled, duffing):
        name = problem.__name__
        theta, y = problem(random)
        # Ten digits are the problem itself: it is solved as it is written.
        theta = np.array([[float("%.10g" % v) for v in row] for row in theta])
        y = np.array([float("%.10g" % v) for v in y])
        columns = theta.shape[1]
        norms = np.linalg.norm(theta, axis=0)
        rows = []
        for scaled in (0, 1):
            weights = norms if scaled else np.ones(columns)
            largest = np.max(np.abs(theta.T @ y) / weights)
            for fraction in FRACTIONS[name][scaled]:
                penalty = float("%.10g" % (fraction * largest))
                # Columns divided by w make the penalty that of scikit-learn.
                xi = solve(np.asfortranarray(theta / weights), y,
                           penalty) / weights
                residual = y - theta @ xi
                pull = np.abs(theta.T @ residual) / weights
                shrink = min(1.0, penalty / pull.max())
                objective = (0.5 * residual @ residual +
                             penalty * np.sum(weights * np.abs(xi)))
                gap = objective - (shrink * residual @ y -
                                   0.5 * shrink**2 * residual @ residual)
                print(f"{name} scaled {scaled} lambda {penalty:.4g}: "
                      f"{np.count_nonzero(xi)} of {columns}, relative gap "
                      f"{gap / objective:.1e}")
                assert gap < 1e-10 * objective
                rows.append([scaled, penalty, objective, gap, *xi])
        names = ["c%d" % (j + 1) for j in range(columns)]
        write(os.path.join(folder, name + ".csv"), ["y", *names],
              np.column_stack([y, theta]))
        write(os.path.join(folder, name + "_solutions.csv"),
              ["scaled", "lambda", "objective", "duality_gap", *names], rows)


if __name__ == "__main__":
    main()
