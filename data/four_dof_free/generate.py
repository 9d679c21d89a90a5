#!/usr/bin/env python3
"""Free vibration of the four-DOF chain of Lai et al. (2021), section 3.1.1.

Writes h1.csv h2.csv (0-6 s), h1_late.csv h2_late.csv (6-12 s), h3.csv (0-12 s)
and truth.json.
"""

import argparse
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

MASS = 1.0  # of each of the four masses, kg
STIFFNESS = 10.0  # of each of the four springs, N/m
DAMPING = 0.5  # of the damper between each mass and the ground, N s/m
CUBIC = 2.0  # spring between DOF 1 and ground, N/m^3
STEP = 0.05  # s
STARTS = {  # h = [x; v]
    "h1": [2, 0, 0, 0, 0, -2, 0, 0],
    "h2": [-2, 0, 0, 3, -2, 0, 0, 0],
    "h3": [0, 4, 0, 0, 0, 0, 0, 0],
}
HEADER = ["t"] + [f"x{i}" for i in range(1, 5)] + [f"v{i}" for i in range(1, 5)]


def rate_of_change(h, stiffness, damping):
    x, v = h[:4], h[4:]
    force = stiffness @ x + damping @ v
    force[0] += CUBIC * x[0]**3
    return np.concatenate([v, -force / MASS])


def check_late_starts(folder, late):
    """The case files carry the state at 6 s; they must carry this one."""
    for name in sorted(os.listdir(folder)):
        if not name.endswith(".toml"):
            continue
        records = reference.read_case(os.path.join(folder, name))["record"]
        for record in records:
            if record["role"] != "holdout":
                continue
            given = record["start"]["x"] + record["start"]["v"]
            expected = late.get(record["name"], STARTS.get(record["name"]))
            error = np.max(np.abs(np.array(given) - expected))
            assert error < 1e-11, (name, record["name"], error)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    output = parser.parse_args().output
    reference.prepare_output(HERE, output)

    stiffness = reference.chain([STIFFNESS] * 4)
    damping = DAMPING * np.eye(4)
    times = np.arange(241) * STEP
    late = {}
    for name, start in STARTS.items():
        states = reference.trajectory(
            lambda i, t, h: rate_of_change(h, stiffness, damping), start, times)
        parts = {name: slice(0, 241)}
        if name != "h3":
            parts = {name: slice(0, 121), name + "_late": slice(120, 241)}
            late[name + "_late"] = states[120]
        for part, rows in parts.items():
            reference.write_csv(
                os.path.join(output, part + ".csv"), HEADER,
                [times[rows], *states[rows].T], ["%.6g"] + ["%.12g"] * 8)
    check_late_starts(output, late)

    eigenvalues = np.linalg.eigvalsh(stiffness / MASS)
    reference.write_json(os.path.join(output, "truth.json"), {
        "model": {
            "mass": [MASS] * 4,
            "spring_stiffness": [STIFFNESS] * 4,
            "ground_damper": [DAMPING] * 4,
            "cubic_k3": {"between": ["ground", "x1"], "value": CUBIC},
        },
        "linear_hz": [float(f)
                      for f in np.sqrt(eigenvalues) / (2 * np.pi)],
        "initial_states": {name: start for name, start in STARTS.items()},
        # scheme2_groups.toml starts from 0.7 K and 0.7 C, and alpha = 1 adds
        # one whole spring or damper.
        "groups": {"scheme2_groups": {
            **{f"k{i}": 0.3 for i in range(1, 5)},
            **{f"c{i}": 0.3 for i in range(1, 5)},
        }},
    })


if __name__ == "__main__":
    main()
