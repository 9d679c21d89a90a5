#!/usr/bin/env python3
"""A girder that is watched for years: one file an hour, and what it holds.

    generate.py --output W [--days 14] [--seconds 60] [--loss 0.05 --loss_day 7]

Writes W/watched_bridge.toml, a copy of the one beside this script, the records
W/records/girder_YYYYMMDD_HHMM.csv, and W/truth.json.

A steel girder of 40 m on two bearings, Euler's beam of three groups (left,
middle and right third), with a spring against rotation at the left bearing, so
that no mode is symmetric.  Its first four bending modes lie at 1.6 to 23 Hz.  Six
accelerometers stand along it, sampled at 50 Hz.  Wind and traffic excite all
modes by noise whose strength follows the hour.

Temperature: seasons, days, and weather with a memory of three days.  Stiffness
falls by 0.3 % per degree, and rises by another 0.4 % per degree below freezing.
A law that is not measured (the sun on one side) changes the groups differently,
with a memory of a day and the deviation --scatter of a frequency.

--loss takes this share of the stiffness from --group at --loss_day.
--stuck N freezes sensor N from --loss_day on.

`frequencies(...)` gives the same structure to tests/benchmarks/watch.py, which
needs frequencies of years and no records.
"""

import argparse
import datetime
import json
import pathlib
import shutil

import numpy as np
from scipy.linalg import eigh
from scipy.signal import lfilter

HERE = pathlib.Path(__file__).resolve().parent
START = datetime.datetime(2024, 1, 1)
RATE = 50.0  # Hz
LENGTH, ELEMENTS = 40.0, 24
STIFFNESS, MASS = 2.1e11 * 0.032, 3.2e3  # N m^2, kg/m
ROTATION = 2.0e8  # N m per rad, of the left bearing
PER_DEGREE, FREEZING = -0.003, -0.004
DAMPING = 0.01
SENSORS = [3, 7, 10, 13, 17, 21]  # nodes
MODES = 4
NOISE = 0.02  # of a channel's standard deviation
GROUPS = 3


def matrices(factors):
    """M and K of the girder; factors of the stiffness of its groups."""
    size = 2 * (ELEMENTS + 1)
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    h = LENGTH / ELEMENTS
    k = STIFFNESS / h**3 * np.array(
        [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
         [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])
    m = MASS * h / 420 * np.array(
        [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
         [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]])
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        stiffness[at, at] += factors[e * GROUPS // ELEMENTS] * k
        mass[at, at] += m
    stiffness[1, 1] += ROTATION
    free = [d for d in range(size) if d not in (0, 2 * ELEMENTS)]
    return mass[np.ix_(free, free)], stiffness[np.ix_(free, free)], free


def modes(factors):
    """Frequencies in Hz, shapes at the sensors, and shares of the groups."""
    mass, stiffness, free = matrices(factors)
    values, shapes = eigh(stiffness, mass, subset_by_index=[0, MODES - 1])
    rows = [free.index(2 * node) for node in SENSORS]
    shares = np.empty((MODES, GROUPS))
    for g in range(GROUPS):
        raised = np.array(factors, float)
        raised[g] *= 1.01
        change = matrices(raised)[1] - stiffness
        shares[:, g] = np.einsum("im,ij,jm->m", shapes, change, shapes) / 0.01 / values
    return np.sqrt(values) / (2 * np.pi), shapes[rows], shares


def memory(rng, hours, days, step):
    """A series of deviation 1 with this memory, every `step` hours."""
    keep = np.exp(-step / (24 * days))
    noise = rng.standard_normal(len(hours)) * np.sqrt(1 - keep**2)
    noise[0] /= np.sqrt(1 - keep**2)
    return lfilter([1], [1, -keep], noise)


def weather(rng, hours, step, colder=0.0):
    """Temperature in degrees Celsius at these hours since the first of January."""
    day = hours / 24
    return (9 - 10 * np.cos(2 * np.pi * (day - 20) / 365.25)
            - 3 * np.cos(2 * np.pi * (hours - 3) / 24)
            + 3 * memory(rng, hours, 3, step) - colder)


def groups(rng, hours, step, temperature, scatter):
    """Factors of the groups over time, without a loss; `scatter` of a frequency."""
    common = 1 + PER_DEGREE * (temperature - 9) + FREEZING * np.minimum(temperature, 0)
    sides = np.stack([memory(rng, hours, 1, step) for _ in range(GROUPS)], 1)
    # A frequency has half of the stiffness' change, from three groups that
    # differ.
    return common[:, None] * (1 + 2 * np.sqrt(GROUPS) * scatter * sides)


def frequencies(rng, hours, step, scatter, noise, loss=None, colder=0.0):
    """Frequencies and temperature of the records.  `loss`: shares of the groups
    that are lost, hours x groups.  `noise`: relative deviation of an estimate."""
    temperature = weather(rng, hours, step, colder)
    factors = groups(rng, hours, step, temperature, scatter)
    if loss is not None:
        factors = factors * (1 - loss)
    base, _, shares = modes([1.0] * GROUPS)
    # First order, with the exact part of what all groups share.
    mean = factors.mean(1, keepdims=True)
    rotation = 1 - shares.sum(1)
    relative = mean * shares.sum(1) + rotation + (factors - mean) @ shares.T
    hz = base * np.sqrt(relative)
    return hz * (1 + noise * rng.standard_normal(hz.shape)), temperature


def record(rng, factors, seconds, strength):
    """Accelerations of the sensors, samples x 6."""
    hz, shapes, _ = modes(factors)
    count = int(seconds * RATE)
    # Sixteen steps a sample, from rest, twenty seconds earlier.
    fine, before = 16, int(20 * RATE)
    dt = 1 / (RATE * fine)
    total = np.zeros((count, len(SENSORS)))
    for m in range(MODES):
        omega = 2 * np.pi * hz[m]
        pole = np.exp(dt * omega * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2)))
        force = rng.standard_normal((before + count) * fine) / np.sqrt(dt)
        motion = lfilter([dt], [1, -2 * pole.real, abs(pole)**2], force)
        # An acceleration below the logger's filter is omega^2 times the motion.
        total += np.outer(omega * motion[before * fine::fine][:count], shapes[:, m])
    total *= strength / total.std()
    return total + NOISE * total.std(0) * rng.standard_normal(total.shape)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--output", required=True, type=pathlib.Path)
    parser.add_argument("--days", type=float, default=14)
    parser.add_argument("--step_hours", type=float, default=1)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--scatter", type=float, default=0.001)
    parser.add_argument("--loss", type=float, default=0)
    parser.add_argument("--loss_day", type=float, default=7)
    parser.add_argument("--group", type=int, default=0)
    parser.add_argument("--stuck", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    flags = parser.parse_args()
    rng = np.random.default_rng(flags.seed)
    folder = flags.output / "records"
    folder.mkdir(parents=True)
    shutil.copy(HERE / "watched_bridge.toml", flags.output)
    hours = np.arange(0, 24 * flags.days, flags.step_hours)
    temperature = weather(rng, hours, flags.step_hours)
    factors = groups(rng, hours, flags.step_hours, temperature, flags.scatter)
    header = ",".join(["t"] + [f"a{i + 1}" for i in range(len(SENSORS))] + ["T"])
    for i, hour in enumerate(hours):
        late = hour >= 24 * flags.loss_day
        factors[i, flags.group] *= 1 - (flags.loss if late else 0)
        samples = record(rng, factors[i], flags.seconds,
                         0.05 * (1.5 - np.cos(2 * np.pi * (hour - 3) / 24)))
        if flags.stuck and late:
            samples[:, flags.stuck - 1] = samples[0, flags.stuck - 1]
        table = np.column_stack([np.arange(len(samples)) / RATE, samples,
                                 np.full(len(samples), temperature[i])])
        time = START + datetime.timedelta(hours=float(hour))
        np.savetxt(folder / f"girder_{time:%Y%m%d_%H%M}.csv", table, "%.6g", ",",
                   header=header, comments="")
    base, _, shares = modes([1.0] * GROUPS)
    truth = {"frequencies_hz": base.tolist(), "shares": shares.tolist(),
             "loss": flags.loss, "group": flags.group, "loss_day": flags.loss_day}
    (flags.output / "truth.json").write_text(json.dumps(truth, indent=2) + "\n")


if __name__ == "__main__":
    main()
