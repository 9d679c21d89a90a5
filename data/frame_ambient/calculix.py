#!/usr/bin/env python3
"""The record of generate.py from CalculiX itself, and how far our sums over
modes are from it.

    calculix.py --output FOLDER [--seconds 600] [--seed N] [--runs FOLDER]

Here every node of a floor has its own history in each direction, and CalculiX
2.20 (`ccx`) runs *MODAL DYNAMIC with 80 modes of its own under them, from rest,
with steps of 2.5 ms, over which forces are linear.  Pieces of 20 s of the forces
are run apart, each with the 20 s in which it dies away, and added up.  The first
20 s of the sum are left out.  `--seconds` are the record's.

Accelerations are the derivatives of the velocities that CalculiX prints, taken
in the frequency domain and up to half of the record's rate.
"""

import argparse
import importlib.util
import os
import sys
import tempfile

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
SPEC = importlib.util.spec_from_file_location(
    "frame_ambient", os.path.join(HERE, "generate.py"))
AMBIENT = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(AMBIENT)
FRAME = AMBIENT.FRAME

STEP = 0.0025  # s
PIECE = 20.0  # s of forces a run, and as long again without
MODES = 80


def histories(rng, count, size, corner, samples):
    """Count x samples: flat below the corner, nothing above half of RATE."""
    frequency = np.fft.rfftfreq(samples, STEP)
    used = np.flatnonzero((frequency > 0) & (frequency < AMBIENT.RATE / 2))
    density = size / np.sqrt(corner * np.pi / 2) / np.sqrt(
        1 + (frequency[used] / corner)**2)
    spectrum = np.zeros((count, len(frequency)), dtype=complex)
    spectrum[:, used] = 0.5 * np.sqrt(samples / STEP) * density * (
        rng.standard_normal((count, len(used), 2)) @ [1, 1j])
    return np.fft.irfft(spectrum, samples, axis=1)


def forces(seed, samples):
    """Of the rows that modes_of has in `own`."""
    rng = np.random.default_rng(seed)
    loads = []
    for floor in FRAME.STOREYS:
        nodes = len(AMBIENT.floor_nodes(floor))
        for _ in range(3):
            loads.append(
                histories(rng, nodes, AMBIENT.OWN, AMBIENT.OWN_CORNER, samples)
                + histories(rng, 1, AMBIENT.SHARED, AMBIENT.SHARED_CORNER,
                            samples))
    return np.vstack(loads)


def deck(changes, load, first):
    """A piece of the forces from the sample `first` on; they begin and end at
    zero, a step before and after."""
    factors = {name: (1 + built) * (1 + changes.get(name, 0.0))
               for name, built in FRAME.AS_BUILT.items()}
    count = int(round(PIECE / STEP))
    piece = load[:, first:first + count]
    times = STEP * np.arange(1, piece.shape[1] + 1)
    lines = FRAME.model_lines(factors, False, False)
    places = [(node, direction) for floor in FRAME.STOREYS
              for direction in (1, 2, 3)
              for node in AMBIENT.floor_nodes(floor)]
    end = times[-1] + STEP
    for number, values in enumerate(piece):
        pairs = ["0,0"] + ["%.7g,%.8g" % pair for pair in zip(times, values)]
        pairs += ["%.7g,0" % end, "%.7g,0" % (10 * end)]
        lines.append(f"*AMPLITUDE,NAME=A{number}")
        lines += [",".join(pairs[i:i + 4]) for i in range(0, len(pairs), 4)]
    lines += ["*STEP", "*FREQUENCY,STORAGE=YES", "%d" % MODES, "*END STEP",
              "*STEP,INC=1000000", "*MODAL DYNAMIC",
              "%g,%.7g" % (STEP, 2 * PIECE), "*MODAL DAMPING,RAYLEIGH",
              ",,%g,%g" % FRAME.RAYLEIGH]
    for number, place in enumerate(places):
        lines += [f"*CLOAD,AMPLITUDE=A{number}", "%d,%d,1." % place]
    return lines + ["*NODE PRINT,NSET=SENSORS", "V", "*END STEP"]


def by_calculix(changes, load, total, folder):
    """Velocities (total samples x sensors)."""
    runs = FRAME.Runs(folder)
    velocities = np.zeros((total, len(FRAME.SENSORS)))
    for number, first in enumerate(
            range(0, load.shape[1], int(round(PIECE / STEP)))):
        name = f"piece_{number}"
        runs.run(name, deck(changes, load, first))
        times, printed = runs.printed(name)
        assert np.allclose(np.diff(times), STEP, rtol=1e-3)
        # Increment k is the time k STEP of the run; its second sample of the
        # forces is at STEP.
        rows = printed[:, :, :2].reshape(len(printed), -1)
        last = min(total, first + len(rows))
        velocities[first:last] += rows[:last - first]
    return velocities


def by_modes(changes, load, total, cache):
    """The same as sums over the modes that generate.py takes."""
    hertz, own, _, sensors = AMBIENT.modes_of(changes, cache)
    modal = np.zeros((total, len(hertz)))
    modal[:load.shape[1]] = load.T @ own
    frequency = np.fft.rfftfreq(total, STEP)
    w = 2 * np.pi * frequency[:, None]
    natural = 2 * np.pi * hertz
    a0, a1 = FRAME.RAYLEIGH
    force = np.fft.rfft(modal, axis=0) * np.sinc(frequency * STEP)[:, None]**2
    motion = force / (natural**2 - w**2 + 1j * w * (a0 + a1 * natural**2))
    return np.fft.irfft(1j * w * motion @ sensors.T, total, axis=0)


def accelerations(velocities):
    """At RATE, of what begins and ends at rest."""
    total = len(velocities)
    every = int(round(1 / (STEP * AMBIENT.RATE)))
    frequency = np.fft.rfftfreq(total, STEP)
    spectrum = 2j * np.pi * frequency[:, None] * np.fft.rfft(velocities, axis=0)
    kept = total // every // 2 + 1
    spectrum = spectrum[:kept] / every
    spectrum[-1] = 0
    return np.fft.irfft(spectrum, total // every, axis=0)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", required=True)
    parser.add_argument("--seconds", type=float, default=AMBIENT.DURATION)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", help="folder of CalculiX' files")
    parser.add_argument("--cache", help="folder that keeps modes")
    args = parser.parse_args()
    pieces = 1 + int(np.ceil(args.seconds / PIECE))
    load = forces(args.seed, pieces * int(round(PIECE / STEP)))
    total = (pieces + 1) * int(round(PIECE / STEP))
    changes = {}
    with tempfile.TemporaryDirectory() as scratch:
        theirs = accelerations(
            by_calculix(changes, load, total, args.runs or scratch))
    ours = accelerations(by_modes(changes, load, total, args.cache))
    first = int(round(PIECE * AMBIENT.RATE))
    part = slice(first, first + int(round(args.seconds * AMBIENT.RATE)))
    theirs, ours = theirs[part], ours[part]
    difference = np.linalg.norm(ours - theirs, axis=0) / np.linalg.norm(
        theirs, axis=0)
    print("sums over modes against CalculiX, relative, by sensor:",
          ", ".join("%.1e" % value for value in difference))
    rng = np.random.default_rng([args.seed, 1])
    sigma = AMBIENT.NOISE * theirs.std(axis=0)
    AMBIENT.write(args.output,
                  theirs + sigma * rng.standard_normal(theirs.shape))


if __name__ == "__main__":
    main()
