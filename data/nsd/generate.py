#!/usr/bin/env python3
"""Three-storey frame without and with a negative stiffness device.

A twin of the rig in section 4 of Lai et al. (2021), whose records are not
public; kip, inch, s.  Writes M.csv K.csv C.csv (what the cases know),
ground.csv (a column per record, in/s^2) and, per record,

  phase1_a phase1_b .csv       measured x1..x3 (in) and v1..v3 (in/s), 20 s
  phase1_a_acc phase1_b_acc .csv    measured absolute accelerations, 20 s
  phase2_a phase2_b .csv       as phase1_a, with the device in the first storey
  *_next.csv, holdout.csv      x1..x3 without noise, 30 s

device.csv (the device's force, kip, against the drift, in) and truth.json.
Everything is sampled at 256 Hz, without a column of time.

The ground motions are synthetic; with --measured they are the records of that
folder (Takatori, Pacoima Dam; Rinaldi held out), under the same names.  The
seed changes the noise and nothing else.
"""

import argparse
import os
import sys

import numpy as np
from scipy.linalg import expm
from scipy.signal import butter, savgol_filter, sosfiltfilt

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
import reference  # noqa: E402

GRAVITY = 386.0  # in/s^2
# What the cases know: the paper's eq. (16b), its K as storeys.
MASS = np.array([9.2, 9.2, 9.0]) / GRAVITY  # floors, kip s^2/in
PRIOR_STOREY = np.array([9.10, 11.16, 9.17])  # kip/in
PRIOR_DAMPING = 0.015  # of each floor, kip s/in
STOREY = PRIOR_STOREY * np.array([1.10, 0.92, 1.12])
DAMPING_RATIO = np.array([0.022, 0.020, 0.020])  # modal
DEVICE = {"k": -5.95, "gap": 0.2}  # kip/in beyond the gap; in
RATE = 256.0  # Hz
DURATION = 30.0  # s
TRAINING = 20.0  # s, of each record but the one held out
DISPLACEMENT_NOISE = 0.002  # in
ACCELERATION_NOISE = 0.01  # of each channel's standard deviation
VELOCITY_CORNER = 15.0  # Hz, of the filter on the differentiated displacement

# Realisations of Kanai-Tajimi noise: seed, frequency of the ground in Hz.
SYNTHETIC = {"a": (11, 2.5), "b": (12, 7.0), "holdout": (13, 2.0)}
MEASURED = {"a": "kobe_1995_takatori_000.csv",
            "b": "pacoima_dam_1971_pul164.csv",
            "holdout": "northridge_1994_rinaldi_228.csv"}
# Record: motion, with the device, peak ground acceleration in g for the
# synthetic motions, scale of the measured ones.
RECORDS = {
    "phase1_a": ("a", False, 0.31, 0.17),
    "phase1_b": ("b", False, 0.57, 0.35),
    "phase2_a": ("a", True, 0.137, 0.132),
    "phase2_b": ("b", True, 0.31, 0.246),
    "holdout": ("holdout", True, 0.09, 0.08),
}
# Peak first storey drift with the device, in.  The record held out engages the
# device and stays inside what was trained.
DRIFT = {"phase2_a": (1.05, 1.25), "phase2_b": (1.05, 1.25),
         "holdout": (0.6, 1.0)}


def frequencies(stiffness):
    """Undamped frequencies in Hz and mass-normalised shapes."""
    root = np.sqrt(MASS)
    values, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    return np.sqrt(values) / (2 * np.pi), vectors / root[:, None]


def modal_damping(stiffness, ratios):
    """C with the given damping ratios in the modes of `stiffness`."""
    hertz, shapes = frequencies(stiffness)
    weighted = MASS[:, None] * shapes
    return weighted @ np.diag(4 * np.pi * ratios * hertz) @ weighted.T


STIFFNESS = reference.chain(STOREY)
DAMPING = modal_damping(STIFFNESS, DAMPING_RATIO)


def device_force(drift):
    """Resists the drift, kip; negative stiffness: it drives it."""
    gap = DEVICE["gap"]
    return DEVICE["k"] * (drift - np.clip(drift, -gap, gap))


def restoring_acceleration(h, device):
    """M^-1 times the forces on the floors: absolute acceleration."""
    force = STIFFNESS @ h[:3] + DAMPING @ h[3:]
    if device:
        force[0] += device_force(h[0])
    return -force / MASS


def linear_response(ground):
    """States from rest without the device, exact for linear ground."""
    step = 1.0 / RATE
    system = np.zeros((8, 8))
    system[:3, 3:6] = np.eye(3)
    system[3:6, :3] = -STIFFNESS / MASS[:, None]
    system[3:6, 3:6] = -DAMPING / MASS[:, None]
    system[3:6, 6] = -1.0
    system[6, 7] = 1.0  # the ground acceleration and its slope
    forward = expm(system * step)[:6]
    states = np.zeros((len(ground), 6))
    slopes = np.diff(ground) / step
    for i, slope in enumerate(slopes):
        states[i + 1] = forward @ np.concatenate(
            [states[i], [ground[i], slope]])
    return states


def response(times, ground, device, start=None):
    """States; ground linear between samples."""
    if not device and start is None:
        return linear_response(ground)
    ag = reference.linear_between(times, ground)
    return reference.trajectory(
        lambda i, t, h: np.concatenate(
            [h[3:], restoring_acceleration(h, device) - ag(i, t)]),
        np.zeros(6) if start is None else start, times)


def assert_decays(state):
    """The structure with the device comes to rest when the ground does."""
    times = np.arange(int(20.0 * RATE) + 1) / RATE
    states = response(times, np.zeros(len(times)), True, state)
    first, last = np.abs(states[:256, 0]).max(), np.abs(states[-256:, 0]).max()
    assert last < 0.2 * max(first, DEVICE["gap"]), (first, last)


def motion(name, measured):
    """Ground acceleration in g at RATE; synthetic: peak 1."""
    count = int(DURATION * RATE) + 1
    times = np.arange(count) / RATE
    if measured:
        file = os.path.join(measured, "ground_motions", MEASURED[name])
        recorded, shape = np.loadtxt(file, delimiter=",", skiprows=1).T
        return np.interp(times, recorded, shape, right=0.0)
    seed, ground_hz = SYNTHETIC[name]
    return reference.kanai_tajimi(
        [seed, 0], DURATION, RATE, ground_hz=ground_hz, ground_damping=0.5,
        strong_until=18.0, decay=0.15)[1]


def measured_velocity(displacement):
    """Measured displacement, low-passed and differentiated.

    In this order the ends, where the difference is one-sided and noisier, do
    not spread.  Over five points it is exact to 2e-5 in the third mode.
    """
    sos = butter(4, VELOCITY_CORNER, fs=RATE, output="sos")
    return savgol_filter(sosfiltfilt(sos, displacement, axis=0), 5, 4, deriv=1,
                         delta=1.0 / RATE, axis=0)


def write(output, name, header, values, form):
    reference.write_csv(os.path.join(output, name + ".csv"), header,
                        list(values.T), [form] * values.shape[1])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the noise")
    parser.add_argument("--measured", help="folder of measured data")
    parser.add_argument("--output", default=HERE, help="folder to write into")
    arguments = parser.parse_args()
    if arguments.measured and os.path.realpath(
            arguments.output) == os.path.realpath(HERE):
        parser.error("--measured wants another --output")
    output = arguments.output
    reference.prepare_output(HERE, output)
    for name in os.listdir(HERE):
        if name.startswith("network_") and output != HERE:
            reference.shutil.copyfile(os.path.join(HERE, name),
                                      os.path.join(output, name))

    # With the device engaged the frame is still stable, and damped.
    softened = STIFFNESS + np.diag([DEVICE["k"], 0.0, 0.0])
    assert np.linalg.eigvalsh(softened)[0] > 0.0
    assert np.linalg.eigvalsh(DAMPING)[0] > 0.0
    prior = reference.chain(PRIOR_STOREY)
    reference.write_matrix(os.path.join(output, "M.csv"), np.diag(MASS))
    reference.write_matrix(os.path.join(output, "K.csv"), prior)
    reference.write_matrix(os.path.join(output, "C.csv"),
                           PRIOR_DAMPING * np.eye(3))
    drifts = np.array([-1.5, -DEVICE["gap"], DEVICE["gap"], 1.5])
    reference.write_csv(os.path.join(output, "device.csv"),
                        ["deformation", "force"],
                        [drifts, device_force(drifts)], ["%g", "%.6g"])

    times = np.arange(int(DURATION * RATE) + 1) / RATE
    trained = int(TRAINING * RATE) + 1
    displacements = ["x1", "x2", "x3"]
    truth = {
        "mass": MASS.tolist(),
        "stiffness": STIFFNESS.tolist(),
        "damping": DAMPING.tolist(),
        "prior_hertz": frequencies(prior)[0].tolist(),
        "hertz": frequencies(STIFFNESS)[0].tolist(),
        "hertz_with_device_engaged": frequencies(softened)[0].tolist(),
        "modal_damping_ratio": DAMPING_RATIO.tolist(),
        "elements": {"device": DEVICE},
        "noise_seed": arguments.seed,
        "records": {},
    }
    grounds = {}
    for number, (name, (source, device, peak, scale)) in enumerate(
            RECORDS.items()):
        factor = scale if arguments.measured else peak
        # Rounded before use: the file holds exactly what acted.
        ground = np.round(
            factor * GRAVITY * motion(source, arguments.measured), 4)
        grounds[name] = ground
        states = response(times, ground, device)
        absolute = np.array(
            [restoring_acceleration(h, device) for h in states])
        drift = np.max(np.abs(states[:, 0]))
        if device:
            low, high = DRIFT[name]
            assert low < drift < high, (name, drift)
            assert_decays(states[-1])

        holdout = name == "holdout"
        write(output, name if holdout else name + "_next", displacements,
              states[:, :3], "%.6f")
        scores = {"peak_ground_acceleration": np.max(np.abs(ground)),
                  "peak_first_storey_drift": drift}
        if not holdout:
            noise = np.random.default_rng([arguments.seed, number])
            x = np.round(states[:, :3] + DISPLACEMENT_NOISE *
                         noise.standard_normal((len(times), 3)), 5)
            # Measured to the end, of which the case sees the first part.
            v = measured_velocity(x)[:trained]
            write(output, name, displacements + ["v1", "v2", "v3"],
                  np.hstack([x[:trained], v]), "%.5f")
            scores["velocity_error"] = np.std(
                v - states[:trained, 3:], axis=0).tolist()
            if not device:
                clean = absolute[:trained]
                sigma = ACCELERATION_NOISE * clean.std(axis=0)
                write(output, name + "_acc", ["a1", "a2", "a3"],
                      clean + sigma * noise.standard_normal(clean.shape),
                      "%.4f")
                scores["acceleration_sigma"] = sigma.tolist()
        truth["records"][name] = scores
    reference.write_csv(os.path.join(output, "ground.csv"), list(grounds),
                        list(grounds.values()), ["%.4f"] * len(grounds))
    reference.write_json(os.path.join(output, "truth.json"), truth)


if __name__ == "__main__":
    main()
