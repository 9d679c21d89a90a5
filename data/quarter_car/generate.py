#!/usr/bin/env python3
"""A quarter car on a measured road.

Writes drive.csv, holdout.csv and truth.json.
"""

import argparse
import os
import sys

import numpy as np
from scipy.signal import butter, lfilter

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

SPRUNG, UNSPRUNG = 290.0, 40.0  # kg
SPRING, TYRE = 23.5e3, 190e3  # N/m
DAMPER = 1500.0  # N s/m
RATE = 200.0  # Hz
DURATION = 6.0  # s
NOISE_PERCENT = 1.0  # of each channel's standard deviation
SEED = 11


def road(seed):
    """Height in m: noise between 0.2 and 15 Hz, 2 cm at the peak."""
    count = int(round(DURATION * RATE)) + 1
    noise = np.random.default_rng(seed).standard_normal(count)
    low, high = butter(2, 15.0, fs=RATE), butter(2, 0.2, "high", fs=RATE)
    height = lfilter(*high, lfilter(*low, noise))
    times = np.arange(count) / RATE
    height *= np.minimum(1.0, times / 0.5)
    return times, 0.02 * height / np.max(np.abs(height))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    parser.add_argument("--seed", type=int, default=SEED, help="of the noise")
    arguments = parser.parse_args()
    reference.prepare_output(HERE, arguments.output)
    random = np.random.default_rng(arguments.seed)

    for name, seed in (("drive", 1), ("holdout", 2)):
        times, height = road(seed)
        at = reference.linear_between(times, height)

        def rate(i, t, h):
            strut = SPRING * (h[0] - h[1]) + DAMPER * (h[2] - h[3])
            return np.array([h[2], h[3], -strut / SPRUNG,
                             (strut - TYRE * (h[1] - at(i, t))) / UNSPRUNG])

        states = reference.trajectory(rate, np.zeros(4), times)
        sigma = NOISE_PERCENT / 100 * states.std(axis=0)
        noisy = states + sigma * random.standard_normal(states.shape)
        reference.write_csv(
            os.path.join(arguments.output, name + ".csv"),
            ["t", "road", "xs", "xu", "vs", "vu"],
            [times, height, *noisy.T], ["%.6g"] + ["%.12g"] + ["%.9g"] * 4)

    reference.write_json(os.path.join(arguments.output, "truth.json"), {
        "sprung": {
            "x[s]": -SPRING / SPRUNG, "x[u]": SPRING / SPRUNG,
            "v[s]": -DAMPER / SPRUNG, "v[u]": DAMPER / SPRUNG,
        },
        "unsprung": {
            "x[s]": SPRING / UNSPRUNG, "x[u]": -(SPRING + TYRE) / UNSPRUNG,
            "v[s]": DAMPER / UNSPRUNG, "v[u]": -DAMPER / UNSPRUNG,
            "input[road]": TYRE / UNSPRUNG,
        },
    })


if __name__ == "__main__":
    main()
