"""Harmonic sweep of a building of 100 storeys with three cubic springs.

    sweep.py PINODE_SIMULATE [--storeys=100] [--points=200]

Times `pinode_simulate --sweep` with 200 frequencies around the first three resonances, and
compares some of its responses with periodic solutions of SciPy's DOP853, found by shooting.
Needs NumPy and SciPy.
"""

import argparse
import csv
import pathlib
import resource
import subprocess
import tempfile
import time

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

MASS, STIFFNESS, CUBIC, LOAD = 2e5, 4e8, 4e11, 3e5
SPRINGS = (0.0, 0.5, 0.99)  # places of the cubic springs, over the height


def matrices(storeys):
    """Mass (a number), damping and stiffness of a shear building with Rayleigh damping of 2 % in
    modes 1 and 5."""
    difference = np.eye(storeys) - np.eye(storeys, k=-1)
    stiffness = STIFFNESS * difference.T @ difference
    omega = np.sqrt(np.linalg.eigvalsh(stiffness) / MASS)
    a, b = np.linalg.solve([[1 / omega[0], omega[0]], [1 / omega[4], omega[4]]], [0.04, 0.04])
    return a * MASS * np.eye(storeys) + b * stiffness, stiffness, omega


def springs(storeys):
    """Storeys with a cubic spring, counted from 0."""
    return [int(place * storeys) for place in SPRINGS]


def write_case(folder, storeys, damping, stiffness):
    """Writes the case; returns its path."""
    np.savetxt(folder / "C.csv", damping, delimiter=",")
    np.savetxt(folder / "K.csv", stiffness, delimiter=",")
    names = [f"u{i + 1}" for i in range(storeys)]
    text = ["[units]", 'force = "N"', 'length = "m"', 'time = "s"', "[model]",
            f"dofs = {names}".replace("'", '"'),
            f"mass = {{diagonal = {[MASS] * storeys}}}",
            'damping = "C.csv"', 'stiffness = "K.csv"']
    for at in springs(storeys):
        below = "ground" if at == 0 else names[at - 1]
        text += ["[[element]]", f'name = "cubic{at}"', 'type = "cubic"',
                 f'between = ["{below}", "{names[at]}"]',
                 f"parameters.k3 = {{initial = {CUBIC}, free = false}}"]
    text += ["[[record]]", 'name = "sweep"', "sampling_rate_hz = 50", 'start = "rest"',
             'file = "load.csv"', 'interpolation = "linear"', "[[record.force]]", f'dof = "{names[-1]}"', 'column = "f"', 'unit = "N"']
    for name in (names[0], names[storeys // 2], names[-1]):
        text += ["[[record.channel]]", f'column = "{name}"', 'quantity = "displacement"',
                 f'dof = "{name}"', 'unit = "m"']
    (folder / "load.csv").write_text("f\n" + "0\n" * 50)
    path = folder / "tower.toml"
    path.write_text("\n".join(text) + "\n")
    return path


def half_ranges(omega, storeys, damping, stiffness):
    """Half ranges of three storeys in the periodic response at an angular frequency, by shooting
    with the linear building's motion as the derivative."""
    at = np.array(springs(storeys))
    linear = np.block([[np.zeros((storeys, storeys)), np.eye(storeys)],
                       [-stiffness / MASS, -damping / MASS]])

    def rate(t, h):
        x = h[:storeys]
        force = np.zeros(storeys)
        for i in at:
            d = x[i] - (x[i - 1] if i > 0 else 0.0)
            force[i] -= CUBIC * d**3
            if i > 0:
                force[i - 1] += CUBIC * d**3
        force[-1] += LOAD * np.cos(omega * t)
        result = linear @ h
        result[storeys:] += force / MASS
        return result

    period = 2 * np.pi / omega
    newton = np.linalg.inv(np.eye(2 * storeys) - expm(linear * period))
    state = np.zeros(2 * storeys)
    times = np.linspace(0.0, period, 513)
    for _ in range(200):
        run = solve_ivp(rate, (0.0, period), state, "DOP853", times, rtol=1e-10, atol=1e-13)
        gap = run.y[:, -1] - state
        if np.linalg.norm(gap) < 1e-9 * np.linalg.norm(state):
            break
        state = state + newton @ gap
    else:
        return None
    shown = run.y[[0, storeys // 2, storeys - 1]]
    return 0.5 * (shown.max(axis=1) - shown.min(axis=1))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--storeys", type=int, default=100)
    parser.add_argument("--points", type=int, default=200)
    arguments = parser.parse_args()
    storeys = arguments.storeys
    damping, stiffness, omega = matrices(storeys)
    low, high = 0.5 * omega[0] / 2 / np.pi, 1.2 * omega[2] / 2 / np.pi
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        case = write_case(folder, storeys, damping, stiffness)
        before = time.monotonic()
        subprocess.run([arguments.program, f"--case={case}", f"--output_dir={folder}/out",
                        f"--sweep=force_u{storeys}", f"--sweep_hz={low}:{high}",
                        f"--sweep_amplitude={LOAD}", f"--sweep_points={arguments.points}"],
                       check=True)
        seconds = time.monotonic() - before
        cpu = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(folder / "out" / "sweep.csv", newline="") as file:
            rows = [[float(x) if x else np.nan for x in row] for row in list(csv.reader(file))[1:]]
    rows = np.array(rows)
    print(f"{storeys} storeys, {len(rows)} points: {seconds:.1f} s, {cpu.ru_utime + cpu.ru_stime:.1f} CPU s")
    columns = (1, 4, 7)
    for row in rows[:: max(1, len(rows) // 8)]:
        reference = half_ranges(2 * np.pi * row[0], storeys, damping, stiffness)
        if reference is None:
            print(f"{row[0]:.4f} Hz: no periodic solution by this shooting")
            continue
        error = np.abs(row[list(columns)] / reference - 1).max()
        print(f"{row[0]:.4f} Hz: largest difference of a half range {error:.1e}, "
              f"multiplier {row[10]:.4f}, {int(row[11])} harmonics")


if __name__ == "__main__":
    main()
