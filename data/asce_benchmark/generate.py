#!/usr/bin/env python3
"""The IASC-ASCE benchmark structure, phase I, with braces removed.

Twelve DOFs (x, y and rotation of four rigid floors) with the storey stiffnesses
and floor masses of E. A. Johnson, H. F. Lam, L. S. Katafygiotis and J. L. Beck,
"Phase I IASC-ASCE structural health monitoring benchmark problem using simulated
data", J. Eng. Mech. 130 (2004) 3-15.  A floor has braces in four faces, two in
each direction, 1.25 m from its centre; they hold x (or y) and the rotation.

Loads: independent band-limited noise at every floor in x and in y, measured.
Sensors: 16 accelerometers, on each floor two in x and two in y, on opposite
faces; noise of 10 % of each channel's RMS, at least 0.1 % of the largest.  Patterns of damage: 1, all braces of
the first storey removed; 2, those of the first and the third.

Writes M.csv, K.csv, brace_<direction><storey>.csv, healthy.csv, again.csv,
pattern1.csv, pattern2.csv, y_only.csv, truth.json and exact.csv, what the
sensors of the first two of these records would have shown without noise.
"""

import argparse
import os
import sys

import numpy as np
from scipy.linalg import eigh, expm
from scipy.signal import butter, sosfiltfilt

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

FLOORS = 4
# Per storey: N/m, N/m, N m.
STIFFNESS = (106600651.6, 67904355.27, 232015925.0)
# One direction's braces in one storey, N/m, and their distance, m.
BRACES = 48230281.2
ARM = 1.25
MASSES = (3452.445047, 2652.445047, 2652.445047, 1809.877523)  # kg
INERTIAS = (3819.219396, 2985.886063, 2985.886063, 2056.812)  # kg m^2
DAMPING = 0.01  # of critical, every mode
RATE, DURATION = 200.0, 8.0  # Hz, s
FORCE = 3000.0  # N, standard deviation per floor and direction
BAND = 60.0  # Hz, of the forces
NOISE_PERCENT = 10.0
PUBLISHED_HZ = {"healthy": (9.411, 11.791, 16.383),
                "pattern1": (6.241, 9.909, 11.731),
                "pattern2": (5.824, 9.507, 11.014)}


def storey_matrix(storey, x, y, rotation):
    """Stiffness matrix of one storey (1 is the lowest)."""
    matrix = np.zeros((3 * FLOORS, 3 * FLOORS))
    for k, value in enumerate((x, y, rotation)):
        upper, lower = 3 * (storey - 1) + k, 3 * (storey - 2) + k
        matrix[upper, upper] += value
        if storey > 1:
            matrix[lower, lower] += value
            matrix[upper, lower] -= value
            matrix[lower, upper] -= value
    return matrix


def brace_matrix(direction, storey):
    x, y = (BRACES, 0.0) if direction == "x" else (0.0, BRACES)
    return storey_matrix(storey, x, y, BRACES * ARM**2)


def modal_damping(mass, stiffness):
    squares, shapes = eigh(stiffness, mass)
    return mass @ shapes @ np.diag(2 * DAMPING * np.sqrt(squares)) @ shapes.T @ mass


def response(mass, damping, stiffness, forces):
    """Accelerations at rest first, forces linear between samples: exact."""
    size = len(mass)
    inverse = np.linalg.inv(mass)
    system = np.block([[np.zeros((size, size)), np.eye(size)],
                       [-inverse @ stiffness, -inverse @ damping]])
    inputs = np.vstack([np.zeros((size, size)), inverse])
    # d/dt (h, u, du) over one step, du the change of u over the step.
    step = 1.0 / RATE
    whole = np.zeros((4 * size, 4 * size))
    whole[:2 * size, :2 * size] = system * step
    whole[:2 * size, 2 * size:3 * size] = inputs * step
    whole[2 * size:3 * size, 3 * size:] = np.eye(size)
    transition = expm(whole)[:2 * size]
    states = np.zeros((len(forces), 2 * size))
    for i in range(len(forces) - 1):
        states[i + 1] = transition @ np.concatenate(
            [states[i], forces[i], forces[i + 1] - forces[i]])
    return (forces - states[:, :size] @ stiffness - states[:, size:] @ damping
            ) @ inverse


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", default=HERE, help="folder to write into")
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    arguments = parser.parse_args()
    folder = arguments.output
    reference.prepare_output(HERE, folder)

    mass = np.diag(np.ravel(np.column_stack([MASSES, MASSES, INERTIAS])))
    healthy = sum(storey_matrix(s, *STIFFNESS) for s in range(1, FLOORS + 1))
    reference.write_matrix(os.path.join(folder, "M.csv"), mass)
    reference.write_matrix(os.path.join(folder, "K.csv"), healthy)
    braces = {}
    for storey in range(1, FLOORS + 1):
        for direction in "xy":
            name = f"{direction}{storey}"
            braces[name] = brace_matrix(direction, storey)
            reference.write_matrix(os.path.join(folder, f"brace_{name}.csv"),
                                   braces[name])
    removed = {"healthy": [], "again": [], "pattern1": ["x1", "y1"],
               "pattern2": ["x1", "y1", "x3", "y3"], "y_only": []}

    # Rows: sensors, "ax1_south" and so on: x - y_s rotation, y + x_s rotation.
    sensors, names = [], []
    for floor in range(1, FLOORS + 1):
        for direction, side, lever in (("x", "south", ARM), ("x", "north", -ARM),
                                       ("y", "west", -ARM), ("y", "east", ARM)):
            row = np.zeros(3 * FLOORS)
            row[3 * (floor - 1) + "xy".index(direction)] = 1.0
            row[3 * (floor - 1) + 2] = lever
            sensors.append(row)
            names.append(f"a{direction}{floor}_{side}")
    sensors = np.array(sensors)

    times = np.arange(int(DURATION * RATE) + 1) / RATE
    low_pass = butter(4, BAND, fs=RATE, output="sos")
    frequencies, exact = {}, {}
    for number, (state, gone) in enumerate(removed.items()):
        random = np.random.default_rng([arguments.seed, number])
        stiffness = healthy - sum((braces[name] for name in gone),
                                  np.zeros_like(healthy))
        hz = np.sqrt(eigh(stiffness, mass, eigvals_only=True)) / (2 * np.pi)
        frequencies[state] = hz
        if state in PUBLISHED_HZ:
            np.testing.assert_allclose(hz[:3], PUBLISHED_HZ[state], rtol=1e-3)
        forces = np.zeros((len(times), 3 * FLOORS))
        drawn = sosfiltfilt(low_pass, random.standard_normal(
            (len(times), 2 * FLOORS)), axis=0)
        drawn *= FORCE / drawn.std(axis=0)
        drawn[0] = 0.0
        for floor in range(FLOORS):
            for k in range(2):
                if state != "y_only" or k == 1:
                    forces[:, 3 * floor + k] = drawn[:, 2 * floor + k]
        measured = response(mass, modal_damping(mass, stiffness), stiffness,
                            forces) @ sensors.T
        if state in ("healthy", "again"):
            exact.update({f"{state}_{name}": column for name, column in
                          zip(names, measured.T.copy())})
        rms = np.sqrt((measured**2).mean(axis=0))
        sigma = NOISE_PERCENT / 100 * np.maximum(rms, 0.01 * rms.max())
        measured += sigma * random.standard_normal(measured.shape)
        loaded = [f for f in range(3 * FLOORS) if f % 3 < 2]
        reference.write_csv(
            os.path.join(folder, state + ".csv"),
            ["t"] + [f"F{'xy'[f % 3]}{f // 3 + 1}" for f in loaded] + names,
            [times, *forces[:, loaded].T, *measured.T],
            ["%.6g"] + ["%.7g"] * len(loaded) + ["%.5g"] * len(names))

    reference.write_csv(os.path.join(folder, "exact.csv"), list(exact),
                        list(exact.values()), ["%.5g"] * len(exact))

    reference.write_json(os.path.join(folder, "truth.json"), {
        "removed": removed,
        "frequencies_hz": {state: list(hz) for state, hz in
                           frequencies.items()},
    })


if __name__ == "__main__":
    main()
