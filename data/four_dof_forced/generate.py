#!/usr/bin/env python3
"""The chain of four_dof_free, forced on DOF 1; Lai et al. (2021), 3.1.2.

Writes wn025.csv wn05.csv wn1.csv wn2.csv (white noise, training),
wn_holdout.csv (another white noise), quake_holdout.csv (a Kanai-Tajimi
record as the history of the force) and truth.json.
"""

import argparse
import os
import sys

import numpy as np
from scipy.optimize import brentq

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

MASS = 1.0  # of each of the four masses, kg
STIFFNESS = reference.chain([10.0] * 4)  # N/m
DAMPING = np.diag([0.5] * 4)  # N s/m, to the ground from each mass
CUBIC = 2.0  # spring between DOF 1 and ground, N/m^3
WHITE_NOISE_RATE = 100.0  # Hz
WHITE_NOISE_DURATION = 4.0  # s
TRAINING = {"wn025": 0.25, "wn05": 0.5, "wn1": 1.0, "wn2": 2.0}  # peak |x1|, m
QUAKE_RATE = 50.0  # Hz
QUAKE_DURATION = 25.0  # s
# Hold-outs use this part of the trained range of x1, on the side that they
# fill more.
SHARE_OF_RANGE = 0.9
# The realisations differ from record to record.  The seed is one with which
# the largest training record swings far to both sides, and with which v1 of the
# hold-outs stays inside its trained range too.
SEED = 5
HEADER = (["t", "F"] + [f"x{i}" for i in range(1, 5)] +
          [f"v{i}" for i in range(1, 5)] + ["a1"])


def acceleration(h, force):
    x, v = h[:4], h[4:]
    total = -(STIFFNESS @ x + DAMPING @ v)
    total[0] += force - CUBIC * x[0]**3
    return total / MASS


def response(times, force, tolerance=1e-12):
    """States and a1 at `times`, from rest; force is linear between them."""
    u = reference.linear_between(times, force)
    states = reference.trajectory(
        lambda i, t, h: np.concatenate([h[4:], acceleration(h, u(i, t))]),
        np.zeros(8), times, relative=tolerance)
    a1 = np.array([acceleration(h, f)[0] for h, f in zip(states, force)])
    return states, a1


def white_noise(number):
    """Times and standard Gaussian samples of realisation `number`."""
    count = int(round(WHITE_NOISE_DURATION * WHITE_NOISE_RATE)) + 1
    noise = np.random.default_rng([SEED, number]).standard_normal(count)
    return np.arange(count) / WHITE_NOISE_RATE, noise


def scaled(times, shape, excess):
    """`shape` times the factor at which excess(x1) changes sign.

    excess is negative for a small response and positive for a large one.
    """

    def residual(log_factor):
        states, _ = response(times, np.exp(log_factor) * shape, 1e-6)
        return excess(states[:, 0])

    factor = np.exp(brentq(residual, np.log(1e-3), np.log(1e3), xtol=1e-4))
    return np.round(factor * shape, 6)


def scaled_into_range(times, shape, trained):
    """`shape` scaled so that x1 fills SHARE_OF_RANGE of trained = (min, max).

    The two sides are looked at separately: the record is as large as the first
    of them allows.
    """
    return scaled(times, shape, lambda x1: max(
        x1.max() / trained[1], x1.min() / trained[0]) - SHARE_OF_RANGE)


def write_record(path, times, force):
    """Integrates, writes the record; returns its states."""
    states, a1 = response(times, force)
    reference.write_csv(path, HEADER, [times, force, *states.T, a1],
                        ["%.6g", "%.6f"] + ["%.12g"] * 9)
    return states


def ranges_of(states):
    """(min, max) of x1 and of v1."""
    return {name: (float(column.min()), float(column.max()))
            for name, column in (("x1", states[:, 0]), ("v1", states[:, 4]))}


def trained_ranges(folder):
    """(min, max) of x1 and of v1 over the training records in `folder`."""
    first = HEADER.index("x1")
    return ranges_of(np.concatenate([
        np.loadtxt(os.path.join(folder, name + ".csv"), delimiter=",",
                   skiprows=1, usecols=range(first, first + 8))
        for name in TRAINING
    ]))


def check_inside(name, ranges, trained):
    """Asserts that a hold-out stays inside the trained ranges, each side."""
    for quantity, (low, high) in ranges.items():
        assert trained[quantity][0] < low, (name, quantity, low)
        assert high < trained[quantity][1], (name, quantity, high)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    output = parser.parse_args().output
    reference.prepare_output(HERE, output)

    ranges = {}
    for number, (name, peak) in enumerate(TRAINING.items()):
        times, noise = white_noise(number)
        force = scaled(times, noise, lambda x1: np.max(np.abs(x1)) / peak - 1)
        states = write_record(os.path.join(output, name + ".csv"), times, force)
        ranges[name] = ranges_of(states)
        assert abs(np.max(np.abs(states[:, 0])) / peak - 1) < 1e-3, name

    trained = trained_ranges(output)
    assert trained["x1"][0] < -1.5 and trained["x1"][1] > 1.5, trained
    quake = reference.kanai_tajimi([SEED, 100], QUAKE_DURATION, QUAKE_RATE,
                                   ground_hz=1.5, ground_damping=0.6)
    for name, (times, shape) in {
            "wn_holdout": white_noise(len(TRAINING)),
            "quake_holdout": quake,
    }.items():
        force = scaled_into_range(times, shape, trained["x1"])
        states = write_record(os.path.join(output, name + ".csv"), times, force)
        ranges[name] = ranges_of(states)
        check_inside(name, ranges[name], trained)

    reference.write_json(os.path.join(output, "truth.json"), {
        "model": {
            "mass": [MASS] * 4,
            "spring_stiffness": [10.0] * 4,
            "ground_damper": [0.5] * 4,
            "cubic_k3": {"between": ["ground", "x1"], "value": CUBIC},
        },
        "trained_range": trained,
        "range": ranges,
    })


if __name__ == "__main__":
    main()
