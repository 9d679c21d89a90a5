#!/usr/bin/env python3
"""Duffing oscillator, M y'' + c y' + k y + k_nl y^3 = u (CasADi's sysid).

Writes duffing.csv (u, y) and truth.json.  The case says that generator and
model both use ten classical Runge-Kutta steps a sample, so the record holds
that discrete response; truth.json says how far it is from DOP853's.
"""

import argparse
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

TRUTH = {"M": 5.625e-6, "c": 2.3e-4, "k": 1.0, "k_nl": 4.69}
START = {"M": 5e-6, "c": 2e-4, "k": 1.0, "k_nl": 5.0}
RATE = 610.1  # Hz
SAMPLES = 2000
STEPS_PER_SAMPLE = 10
LARGEST_FORCE = 0.1
SEED = 1


def rate_of_change(h, u):
    y, v = h
    force = u - TRUTH["c"] * v - TRUTH["k"] * y - TRUTH["k_nl"] * y**3
    return np.array([v, force / TRUTH["M"]])


def runge_kutta_4(force):
    """States at the samples, from rest; force is held over each sample."""
    step = 1.0 / (RATE * STEPS_PER_SAMPLE)
    states = np.zeros((len(force), 2))
    for i, u in enumerate(force[:-1]):
        h = states[i]
        for _ in range(STEPS_PER_SAMPLE):
            k1 = rate_of_change(h, u)
            k2 = rate_of_change(h + step / 2 * k1, u)
            k3 = rate_of_change(h + step / 2 * k2, u)
            k4 = rate_of_change(h + step * k3, u)
            h = h + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states[i + 1] = h
    return states


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    output = parser.parse_args().output
    reference.prepare_output(HERE, output)

    # Rounded before use: the file holds exactly the force that acted.
    force = np.round(np.random.default_rng(SEED).uniform(
        0.0, LARGEST_FORCE, SAMPLES), 8)
    y = runge_kutta_4(force)[:, 0]
    reference.write_csv(os.path.join(output, "duffing.csv"), ["u", "y"],
                        [force, y], ["%.8f", "%.15g"])

    exact = reference.trajectory(
        lambda i, t, h: rate_of_change(h, force[i]), np.zeros(2),
        np.arange(SAMPLES) / RATE)[:, 0]
    difference = reference.nrmse(exact, y)
    # The cubic force must show: at the peak, a part in a hundred or more.
    share = TRUTH["k_nl"] * np.max(np.abs(y))**2 / TRUTH["k"]
    assert share > 0.01, share
    assert difference < 1e-3, difference
    reference.write_json(os.path.join(output, "truth.json"), {
        "physical": TRUTH,
        "start": START,
        # value = start (1 + alpha)
        "groups": {name: TRUTH[name] / START[name] - 1.0 for name in "Mck"},
        "elements": {"spring": {"k3": TRUTH["k_nl"]}},
        "peak_displacement": float(np.max(np.abs(y))),
        "peak_cubic_share_of_linear_force": float(share),
        "rk4_against_dop853_nrmse": float(difference),
    })


if __name__ == "__main__":
    main()
