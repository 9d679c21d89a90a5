#!/usr/bin/env python3
"""The frame of three_storey_ambient at several temperatures.

    seasons.py --output FOLDER [--seed N] [--temperatures -5 8 21] [--loss 2 0.1]

At T deg C a storey has SLOPE (T - 20) times its stiffness in the model more
than at 20 deg C.  Writes a record of wind for each temperature, wind_1.csv.gz and so on with a column T, the
matrices of the case, truth.json, and seasons.toml: a case of all records, whose
groups are what the frame is at 20 deg C and `per_degree`, the change of all of it.
Over the ten minutes of a record the temperature rises by DRIFT in a straight
line, which T says twice a minute.

The forces are those of generate.py, with nothing above half the sampling rate;
the frame's motion is integrated at four times that rate, the stiffness being the
same over two seconds at a time.
"""

import argparse
import gzip
import importlib.util
import os
import sys

import numpy as np
from scipy.linalg import expm

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
SPEC = importlib.util.spec_from_file_location(
    "generate", os.path.join(HERE, "generate.py"))
WIND = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(WIND)

SLOPE = -0.003  # 1 / deg C
DRIFT = 2.0  # deg C
REFERENCE = 20.0  # deg C
FINER = 4
BEFORE = 40.0  # s
BLOCK = 2.0  # s
READ_EVERY = 30.0  # s


def forces(rng, samples):
    """On the floors, N, at FINER times the sampling rate."""
    period = 2 * samples
    frequency = np.fft.rfftfreq(period, 1 / WIND.RATE)[1:-1]
    normal = rng.standard_normal((len(frequency), 3, 2)) @ [1, 1j]
    lines = np.zeros((FINER * period // 2 + 1, 3), dtype=complex)
    lines[1:len(frequency) + 1] = 0.5 * FINER * np.sqrt(
        period * WIND.RATE) * np.einsum(
            "kij,kj->ki", WIND.force_root(frequency, False), normal)
    return np.fft.irfft(lines, FINER * period, axis=0)[:FINER * samples]


def step_matrices(storey):
    """h[k+1] = A h[k] + B0 f[k] + B1 f[k+1] of linear forces, and the rows of
    accelerations."""
    mass = np.diag(1 / WIND.FRAME.MASS)
    rate = np.block([[np.zeros((3, 3)), np.eye(3)],
                     [-mass @ WIND.reference.chain(storey),
                      -mass @ WIND.FRAME.damping_matrix()]])
    force = np.vstack([np.zeros((3, 3)), mass])
    step = 1 / (FINER * WIND.RATE)
    blocks = np.zeros((12, 12))
    blocks[:6, :6], blocks[:6, 6:9] = rate * step, force * step
    blocks[6:9, 9:] = np.eye(3)
    exponential = expm(blocks)
    late = exponential[:6, 9:]
    return exponential[:6, :6], exponential[:6, 6:9] - late, late, rate[3:], mass


def accelerations(force, storey, temperature):
    """Of the floors, where temperature(t) is that since the record's begin."""
    count = len(force)
    rate = FINER * WIND.RATE
    block = int(round(BLOCK * rate))
    motion = np.zeros((count, 3))
    h = np.zeros(6)
    for first in range(0, count - 1, block):
        last = min(first + block, count - 1)
        t = 0.5 * (first + last) / rate - BEFORE
        warmer = temperature(t) - REFERENCE
        a, early, late, rows, mass = step_matrices(
            storey + SLOPE * warmer * WIND.FRAME.PRIOR_STOREY)
        push = force[first:last] @ early.T + force[first + 1:last + 1] @ late.T
        states = np.empty((last - first, 6))
        for i in range(last - first):
            states[i] = h
            h = a @ h + push[i]
        motion[first:last] = states @ rows.T + force[first:last] @ mass
    return motion


def record(seed, storey, degrees):
    """Accelerations with noise, and temperatures, samples by four."""
    rng = np.random.default_rng(seed)
    samples = int(round(WIND.DURATION * WIND.RATE))
    before = int(round(BEFORE * WIND.RATE))

    def temperature(t):
        return degrees + DRIFT * (t / WIND.DURATION - 0.5)

    force = forces(rng, samples + before)
    values = accelerations(force, storey,
                           temperature)[FINER * before::FINER]
    values += WIND.NOISE * values.std(axis=0) * rng.standard_normal(values.shape)
    return np.column_stack([values,
                            temperature(np.arange(samples) / WIND.RATE)])


def write_record(path, values):
    every = int(round(READ_EVERY * WIND.RATE))
    lines = ["a1,a2,a3,T"]
    for i, row in enumerate(values):
        degrees = "%.3f" % row[3] if i % every == 0 else ""
        lines.append(",".join("%.5g" % v for v in row[:3]) + "," + degrees)
    data = ("\n".join(lines) + "\n").encode()
    with open(path, "wb") as file:
        file.write(gzip.compress(data, 6, mtime=0))


def case_text(count):
    """three_storey_ambient.toml with what follows the temperature, and the
    records."""
    with open(os.path.join(HERE, "three_storey_ambient.toml")) as file:
        head, record_table = file.read().split("[[record]]\n")
    text = head + """# How all of it changes: K + per_degree (T - 20) K, in 1 / deg C.
[[group]]
name    = "per_degree"
adds_to = "stiffness"
matrix  = "K.csv"
follows = {covariate = "temperature", reference = 20}

"""
    for i in range(1, count + 1):
        text += "[[record]]\n" + record_table.replace(
            'name = "wind"', 'name = "wind_%d"' % i).replace(
                "wind.csv.gz", "wind_%d.csv.gz" % i).rstrip() + """

  [[record.covariate]]
  name   = "temperature"
  column = "T"

"""
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--temperatures", type=float, nargs="+",
                        default=[-5, 8, 21])
    parser.add_argument("--loss", type=float, nargs=2, default=[1, 0.0])
    args = parser.parse_args()
    os.makedirs(args.output, exist_ok=True)
    frame, reference = WIND.FRAME, WIND.reference
    storey = frame.STOREY.copy()
    storey[int(args.loss[0]) - 1] *= 1 - args.loss[1]
    for i, degrees in enumerate(args.temperatures):
        write_record(os.path.join(args.output, "wind_%d.csv.gz" % (i + 1)),
                     record(1000 * args.seed + i, storey, degrees))
    a0, a1 = frame.rayleigh_coefficients()
    prior = frame.PRIOR_DAMPING_FACTOR
    nominal = reference.chain(frame.PRIOR_STOREY)
    for name, matrix in [("C_mass", prior * a0 * np.diag(frame.MASS)),
                         ("C_stiffness", prior * a1 * nominal),
                         ("K", nominal)]:
        reference.write_matrix(os.path.join(args.output, name + ".csv"), matrix)
    with open(os.path.join(args.output, "seasons.toml"), "w") as file:
        file.write(case_text(len(args.temperatures)))
    groups = dict(zip(["k1", "k2", "k3"], storey / frame.PRIOR_STOREY - 1.0))
    groups.update(c_mass=1 / prior - 1, c_stiffness=1 / prior - 1,
                  per_degree=SLOPE)
    reference.write_json(os.path.join(args.output, "truth.json"),
                         {"groups": groups})


if __name__ == "__main__":
    main()
