#!/usr/bin/env python3
"""Storeys by maximum likelihood of the innovations, in NumPy and SciPy.

    innovations.py make FOLDER SEED    records and cases of the realisation
    innovations.py fit FOLDER          fits them, innovations.json
    innovations.py score FOLDER        of all folders in FOLDER

The frame of three_storey_ambient under white independent forces on the floors,
whose *displacements* are measured for ten minutes at 100 Hz with 2 % noise: of
those the state equation driven by white noise is exact in discrete time (Van Loan
1978), and next to nothing lies above half the sampling rate, so that forces
which end there and forces which do not are the same.  Accelerations show the
force itself, which a filter in time sees between samples as well.  The filter is
the stationary one of Kalman, the unknowns five groups and the logarithms of three
densities and three noise variances; slopes and information by differences, BFGS
from the model as it is.
"""

import glob
import json
import os
import sys

import numpy as np
from scipy import linalg, optimize, signal

sys.dont_write_bytecode = True
from case_generator import CASE, NAMES  # noqa: E402

FRAME, CHAIN = CASE.FRAME, CASE.reference.chain
WAYS = ["independent", "three_storey_ambient"]
MICRO = 1e6  # displacements in the filter are micrometres
SKIPPED = 500  # samples in which the filter settles


def make(folder, seed):
    rng = np.random.default_rng(seed)
    samples = int(round(CASE.DURATION * CASE.RATE))
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1 / CASE.RATE)[1:-1]
    normal = rng.standard_normal((len(frequency), 3, 2)) @ [1, 1j]
    force = 0.5 * np.sqrt(period * CASE.RATE) * np.einsum(
        "kij,kj->ki", CASE.force_root(frequency, True), normal)
    w = 2 * np.pi * frequency[:, None, None]
    dynamic = (CHAIN(FRAME.STOREY) - w**2 * np.diag(FRAME.MASS) +
               1j * w * FRAME.damping_matrix())
    lines = np.zeros((period // 2 + 1, 3), dtype=complex)
    lines[1:-1] = np.linalg.solve(dynamic, force[:, :, None])[:, :, 0]
    values = np.fft.irfft(lines, period, axis=0)[:samples]
    values += CASE.NOISE * values.std(axis=0) * rng.standard_normal(
        values.shape)
    CASE.write_record(os.path.join(folder, "wind.csv.gz"), values)
    with open(os.path.join(folder, "three_storey_ambient.toml"),
              encoding="utf-8") as file:
        case = file.read()
    case = case.replace('"absolute_acceleration"', '"displacement"').replace(
        '"m/s^2"', '"m"')
    independent = case.replace(
        'excitation = "ambient"\n', 'excitation = "ambient"\n'
        '[record.ambient]\nknots = 1\ncorrelated = false\n')
    for name, text in zip(WAYS, [independent, case]):
        with open(os.path.join(folder, name + ".toml"), "w",
                  encoding="utf-8") as file:
            file.write(text)


def discrete(x):
    """Transition and covariance of the states' noise over a sample."""
    a0, a1 = FRAME.rayleigh_coefficients()
    part = FRAME.PRIOR_DAMPING_FACTOR
    damping = (part * a0 * (1 + x[3]) * np.diag(FRAME.MASS) +
               part * a1 * (1 + x[4]) * CHAIN(FRAME.PRIOR_STOREY))
    stiffness = CHAIN(FRAME.PRIOR_STOREY * (1 + x[:3]))
    a = np.zeros((6, 6))
    a[:3, 3:] = np.eye(3)
    a[3:, :3] = -stiffness / FRAME.MASS[:, None]
    a[3:, 3:] = -damping / FRAME.MASS[:, None]
    density = np.zeros((6, 6))
    # Two-sided, in micrometres.
    density[3:, 3:] = np.diag(
        np.exp(x[5:8]) / 2 * (MICRO / FRAME.MASS)**2)
    block = np.zeros((12, 12))
    block[:6, :6], block[:6, 6:], block[6:, 6:] = -a, density, a.T
    power = linalg.expm(block / CASE.RATE)
    transition = power[6:, 6:].T
    noise = transition @ power[:6, 6:]
    return transition, 0.5 * (noise + noise.T)


def cost(x, y):
    """-log likelihood of the innovations, constants apart."""
    transition, noise = discrete(x)
    sees = np.eye(3, 6)
    p = linalg.solve_discrete_are(transition.T, sees.T, noise,
                                  np.diag(np.exp(x[8:])))
    s = sees @ p @ sees.T + np.diag(np.exp(x[8:]))
    gain = np.linalg.solve(s, sees @ p @ transition.T).T
    poles, shapes = np.linalg.eig(transition - gain @ sees)
    drive = y @ np.linalg.solve(shapes, gain.astype(complex)).T
    state = np.stack([signal.lfilter([0, 1], [1, -pole], column)
                      for pole, column in zip(poles, drive.T)], axis=1)
    e = (y - (state @ shapes[:3].T).real)[SKIPPED:]
    return 0.5 * (len(e) * np.linalg.slogdet(s)[1] +
                  np.sum(e * np.linalg.solve(s, e.T).T))


def slope(x, y, step=1e-4):
    result = np.zeros(len(x))
    for i in range(len(x)):
        d = np.zeros(len(x))
        d[i] = step
        result[i] = (cost(x + d, y) - cost(x - d, y)) / (2 * step)
    return result


def fit(folder):
    y = MICRO * np.loadtxt(os.path.join(folder, "wind.csv.gz"), delimiter=",",
                           skiprows=1)
    x = np.concatenate([np.zeros(5), np.full(3, np.log(1e3)),
                        np.log((0.05 * y.std(axis=0))**2)])
    found = optimize.minimize(cost, x, args=(y,), jac=slope, method="BFGS",
                              options={"gtol": 0.5, "maxiter": 200})
    information = np.stack([
        (slope(found.x + d, y) - slope(found.x - d, y)) / 2e-3
        for d in 1e-3 * np.eye(len(x))])
    sigma = np.sqrt(np.diag(np.linalg.inv(
        0.5 * (information + information.T))))
    CASE.reference.write_json(os.path.join(folder, "innovations.json"), {
        "value": list(found.x[:5]), "sigma": list(sigma[:5]),
        "slope": float(np.abs(found.jac[:5] * sigma[:5]).max())})


def score(folder):
    with open(os.path.join(glob.glob(os.path.join(folder, "*"))[0],
                           "truth.json"), encoding="utf-8") as file:
        groups = json.load(file)["groups"]
    truth = np.array([groups[n] for n in NAMES])
    values = {way: [] for way in WAYS + ["innovations"]}
    sigmas = {way: [] for way in values}
    usable = {way: 0 for way in WAYS}
    worst = 0.0
    for one in sorted(glob.glob(os.path.join(folder, "*"))):
        with open(os.path.join(one, "innovations.json"),
                  encoding="utf-8") as file:
            result = json.load(file)
        values["innovations"].append(result["value"])
        sigmas["innovations"].append(result["sigma"])
        worst = max(worst, result["slope"])
        for way in WAYS:
            with open(os.path.join(one, way, "result.json"),
                      encoding="utf-8") as file:
                result = json.load(file)
            found = {p["name"]: p for p in result["parameters"]}
            values[way].append([found[n]["value"] for n in NAMES])
            sigmas[way].append([(found[n]["upper95"] - found[n]["lower95"]) /
                                3.92 for n in NAMES])
            usable[way] += result["usable"]
    values = {way: np.array(v) for way, v in values.items()}
    sigmas = {way: np.array(v) for way, v in sigmas.items()}
    other, its_sigma = values["innovations"], sigmas["innovations"]
    print("%d records; the innovations' fits end %.1g deviations from their "
          "optimum at most" % (len(other), worst))
    for way in ["innovations"] + WAYS:
        inside = np.abs(values[way] - truth) <= 1.96 * sigmas[way]
        rmse = np.sqrt(np.mean((values[way] - truth)**2, axis=0))
        print(way + (": %d usable" % usable[way] if way in usable else ""))
        for i, name in enumerate(NAMES):
            print("  %-12s inside %5.1f %%, rmse %.5f, deviation %.5f" %
                  (name, 100 * inside[:, i].mean(), rmse[i],
                   np.median(sigmas[way][:, i])) +
                  ("" if way == "innovations" else
                   "; beside the innovations: deviation %.3f, difference "
                   "%.2f deviations (rms)" % (
                       np.median(sigmas[way][:, i] / its_sigma[:, i]),
                       np.sqrt(np.mean(((values[way][:, i] - other[:, i]) /
                                        its_sigma[:, i])**2)))))


if __name__ == "__main__":
    if sys.argv[1] == "make":
        make(sys.argv[2], int(sys.argv[3]))
    elif sys.argv[1] == "fit":
        fit(sys.argv[2])
    else:
        score(sys.argv[2])
