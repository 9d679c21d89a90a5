#!/usr/bin/env python3
"""Twenty storeys on a shaking ground, three of which harden.

Writes K.csv, C.csv, train.csv, long.csv and truth.json.
"""

import argparse
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

COUNT = 20
MASS = 1000.0  # kg
STIFFNESS = 2e6  # N/m
DAMPER = 4e3  # N s/m
CUBIC = {4: 1e9, 11: 1.5e9, 17: 3e9}  # N/m^3, by storey from the ground up
RATE = 50.0  # Hz
TRAIN, LONG = 10.0, 100.0  # s
NOISE_PERCENT = 1.0  # of each channel's standard deviation, training only
SEED = 5


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    parser.add_argument("--seed", type=int, default=SEED, help="of the noise")
    arguments = parser.parse_args()
    folder = arguments.output
    reference.prepare_output(HERE, folder)
    random = np.random.default_rng(arguments.seed)
    stiffness = reference.chain([STIFFNESS] * COUNT)
    damping = reference.chain([DAMPER] * COUNT)
    reference.write_matrix(os.path.join(folder, "K.csv"), stiffness)
    reference.write_matrix(os.path.join(folder, "C.csv"), damping)
    cubic = np.array([CUBIC.get(j + 1, 0.0) for j in range(COUNT)])

    for name, seed, duration in (("train", 3, TRAIN), ("long", 4, LONG)):
        times, ground = reference.kanai_tajimi(
            seed, duration, RATE, ground_hz=2.5, ground_damping=0.6,
            rise=1.0, strong_until=0.8 * duration)
        ground = 3.0 * ground
        at = reference.linear_between(times, ground)

        def rate(i, t, h):
            x, v = h[:COUNT], h[COUNT:]
            storey = cubic * np.diff(x, prepend=0.0)**3
            force = stiffness @ x + damping @ v + storey
            force[:-1] -= storey[1:]
            return np.concatenate([v, -force / MASS - at(i, t)])

        states = reference.trajectory(rate, np.zeros(2 * COUNT), times)
        drift = np.max(np.abs(np.diff(states[:, :COUNT], prepend=0.0)), axis=0)
        share = cubic * drift**2 / STIFFNESS
        print(name, "largest cubic share of a storey's force:",
              {j + 1: round(float(share[j]), 3) for j in np.nonzero(cubic)[0]})
        if name == "train":
            sigma = NOISE_PERCENT / 100 * states.std(axis=0)
            states = states + sigma * random.standard_normal(states.shape)
            columns = range(2 * COUNT)
        else:
            columns = [4, 9, 14, 19]
        names = ([f"x{j + 1}" for j in range(COUNT)] +
                 [f"v{j + 1}" for j in range(COUNT)])
        reference.write_csv(
            os.path.join(folder, name + ".csv"),
            ["t", "ag"] + [names[j] for j in columns],
            [times, ground, *states[:, columns].T],
            ["%.6g", "%.12g"] + ["%.9g"] * len(columns))

    reference.write_json(os.path.join(folder, "truth.json"), {
        "cubic": {str(storey): value for storey, value in CUBIC.items()},
    })


if __name__ == "__main__":
    main()
