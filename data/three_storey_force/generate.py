#!/usr/bin/env python3
"""The three-storey frame of ../three_storey under forces that nobody measured.

Writes impact.csv (a blow on the top floor, a half-sine of 20 ms that begins
between two samples), sweep.csv, sweep_wide.csv and sweep_high.csv (a shaker on
the second floor from 2 to 8 Hz, from 1 to 12 Hz and from 3 to 12 Hz), gust.csv
(wind on the top floor), degrading.csv (ground motion; the first storey loses a
fifth of its stiffness during the record), temperature.csv and
temperature_holdout.csv (ground motion; all stiffnesses follow the temperature
in column T), C.csv and K.csv (damping and stiffness matrix) and truth.json.
Columns: a1 a2 a3 are the floors' absolute accelerations as read, x2 x3 the
second and third floor's displacement as read, F the force that acted.  The
model, cubic spring included, is that of ../three_storey and is known.
"""

import argparse
import importlib.util
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402


def load_frame():
    path = os.path.join(os.path.dirname(HERE), "three_storey", "generate.py")
    spec = importlib.util.spec_from_file_location("three_storey", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


frame = load_frame()

RATE = 100.0  # Hz
NOISE = 0.01  # of each channel's standard deviation
PULSE = {"dof": 2, "start": 0.5037, "duration": 0.02, "amplitude": 20000.0}
PULSE_RECORD = 2.0  # s
SHAKER = 1  # DOF
SWEEPS = {  # Hz, and the number of the noise
    "sweep": (2.0, 8.0, 1),
    "sweep_wide": (1.0, 12.0, 2),
    "sweep_high": (3.0, 12.0, 4),
}
SWEEP_RECORD = 8.0  # s
SWEEP_FORCE = 2000.0  # N
SWEEP_TAPER = 0.5  # s, at both ends
GUST = {"dof": 2, "peaks": [3000.0, -1800.0, 2400.0, 1200.0],
        "times": [1.2, 2.2, 3.4, 4.3], "widths": [0.3, 0.35, 0.25, 0.4]}
GUST_RECORD = 6.0  # s
LOSS = 0.20  # of the first storey's stiffness, over the record
REFERENCE_TEMPERATURE = 20.0  # deg C
PER_DEGREE = -0.004  # change of all stiffnesses
TEMPERATURES = {  # deg C, at the record's beginning and end
    "temperature": (30.0, -10.0),
    "temperature_holdout": (8.0, 12.0),
}


def half_sine(t):
    phase = (t - PULSE["start"]) / PULSE["duration"]
    inside = (phase > 0) & (phase < 1)
    return np.where(inside, PULSE["amplitude"] * np.sin(np.pi * phase), 0.0)


def swept_sine(t, first, last):
    phase = 2 * np.pi * (first * t + (last - first) * t**2 /
                         (2 * SWEEP_RECORD))
    edge = np.clip(np.minimum(t, SWEEP_RECORD - t) / SWEEP_TAPER, 0, 1)
    return SWEEP_FORCE * np.sin(phase) * 0.5 * (1 - np.cos(np.pi * edge))


def gust(t):
    """Gaussian humps, peak exp(-((t - time) / width)^2)."""
    return sum(peak * np.exp(-((t - time) / width) ** 2)
               for peak, time, width in zip(GUST["peaks"], GUST["times"],
                                            GUST["widths"]))


def response(times, dof, force, breaks=()):
    """States and accelerations under force(t) at a DOF, from rest."""
    stiffness = reference.chain(frame.STOREY)
    damping = frame.damping_matrix()
    # A kink of the force ends a step.
    nodes = np.unique(np.concatenate([times, breaks]))

    def acceleration(t, h):
        a = frame.restoring_acceleration(h, stiffness, damping, frame.CUBIC)
        a[dof] += force(t) / frame.MASS[dof]
        return a

    states = reference.trajectory(
        lambda i, t, h: np.concatenate([h[3:], acceleration(t, h)]),
        np.zeros(6), nodes)
    states = states[np.searchsorted(nodes, times)]
    return states, np.array(
        [acceleration(t, h) for t, h in zip(times, states)])


def shaken(times, ground, storeys):
    """Accelerations under a ground motion, the storeys' stiffness at t given by
    storeys(t)."""
    damping = frame.damping_matrix()
    ag = reference.linear_between(times, ground)

    def restoring(t, h):
        return frame.restoring_acceleration(h, reference.chain(storeys(t)),
                                            damping, frame.CUBIC)

    states = reference.trajectory(
        lambda i, t, h: np.concatenate([h[3:], restoring(t, h) - ag(i, t)]),
        np.zeros(6), times)
    return np.array([restoring(t, h) for t, h in zip(times, states)])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    parser.add_argument("--output", default=HERE, help="folder to write into")
    arguments = parser.parse_args()
    output = arguments.output
    reference.prepare_output(HERE, output)
    truth = {
        "noise_seed": arguments.seed,
        "pulse": dict(PULSE, impulse=PULSE["amplitude"] * PULSE["duration"] *
                      2 / np.pi),
        "sweeps": dict({name: {"first": band[0], "last": band[1]}
                        for name, band in SWEEPS.items()},
                       duration=SWEEP_RECORD, force=SWEEP_FORCE,
                       taper=SWEEP_TAPER),
        "gust": GUST,
        "sigma": {},
    }

    def read(name, number, clean):
        noise = np.random.default_rng([arguments.seed, number])
        sigma = NOISE * clean.std(axis=0)
        truth["sigma"][name] = sigma.tolist()
        return clean + sigma * noise.standard_normal(clean.shape)

    times = np.arange(int(PULSE_RECORD * RATE) + 1) / RATE
    edges = [PULSE["start"], PULSE["start"] + PULSE["duration"]]
    _, clean = response(times, PULSE["dof"], half_sine, edges)
    reference.write_csv(
        os.path.join(output, "impact.csv"), ["t", "a1", "a2", "a3", "F"],
        [times, *read("impact", 0, clean).T, half_sine(times)],
        ["%.4g"] + ["%.6f"] * 3 + ["%.10g"])

    times = np.arange(int(SWEEP_RECORD * RATE) + 1) / RATE
    for name, (first, last, number) in SWEEPS.items():
        band = (first, last)
        states, clean = response(times, SHAKER,
                                 lambda t, band=band: swept_sine(t, *band))
        channels = read(name, number,
                        np.column_stack([clean, states[:, SHAKER]]))
        reference.write_csv(
            os.path.join(output, name + ".csv"),
            ["t", "a1", "a2", "a3", "x2", "F"],
            [times, *channels.T, swept_sine(times, *band)],
            ["%.4g"] + ["%.6f"] * 3 + ["%.5e", "%.10g"])

    times = np.arange(int(GUST_RECORD * RATE) + 1) / RATE
    states, clean = response(times, GUST["dof"], gust)
    channels = read("gust", 5,
                    np.column_stack([clean, states[:, GUST["dof"]]]))
    reference.write_csv(
        os.path.join(output, "gust.csv"),
        ["t", "a1", "a2", "a3", "x3", "F"], [times, *channels.T, gust(times)],
        ["%.4g"] + ["%.6f"] * 3 + ["%.5e", "%.10g"])

    times, ground = frame.ground_motion("train")

    def degrading(t):
        storey = frame.STOREY.copy()
        storey[0] *= 1 - LOSS * t / times[-1]
        return storey

    clean = shaken(times, ground, degrading)
    truth["degrading"] = {"initial": 0.0, "rate": -LOSS / times[-1]}
    reference.write_csv(
        os.path.join(output, "degrading.csv"), ["t", "ag", "a1", "a2", "a3"],
        [times, ground, *read("degrading", 3, clean).T],
        ["%.4g", "%.5f"] + ["%.6f"] * 3)

    for number, name in enumerate(TEMPERATURES):
        motion = "train" if name == "temperature" else "holdout"
        times, ground = frame.ground_motion(motion)
        first, last = TEMPERATURES[name]
        temperature = first + (last - first) * times / times[-1]

        def warm(t, first=first, last=last, end=times[-1]):
            at = first + (last - first) * t / end
            return frame.STOREY * (1 + PER_DEGREE *
                                   (at - REFERENCE_TEMPERATURE))

        clean = shaken(times, ground, warm)
        reference.write_csv(
            os.path.join(output, name + ".csv"),
            ["t", "ag", "T", "a1", "a2", "a3"],
            [times, ground, temperature, *read(name, 6 + number, clean).T],
            ["%.4g", "%.5f", "%.6g"] + ["%.6f"] * 3)
    truth["temperature"] = {"per_degree": PER_DEGREE,
                            "reference": REFERENCE_TEMPERATURE}
    reference.write_matrix(os.path.join(output, "K.csv"),
                           reference.chain(frame.STOREY))
    reference.write_matrix(os.path.join(output, "C.csv"),
                           frame.damping_matrix())
    reference.write_json(os.path.join(output, "truth.json"), truth)


if __name__ == "__main__":
    main()
