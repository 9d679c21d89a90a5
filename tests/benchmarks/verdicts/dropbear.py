#!/usr/bin/env python3
"""Verdicts on a measured beam: dropbear.py PROGRAMS DATA

A roller under a clamped beam moves in steps and comes back
(DATA/dropbear/slow10_test0.csv.gz, see DATA/README.md).  Its place changes the
first frequency, and the move lets the beam vibrate.  Each plateau is a free
decay of one mass on a spring: the accelerometer below 80 Hz, at 500 Hz.
PROGRAMS holds pinode_update and pinode_damage.

One line a pair of plateaus: the true change of stiffness, that of the squared
frequencies in DATA/dropbear/reference_f1.json, and what pinode_damage says, with
options left alone and without masses among the kinds of change.

The unit is nominal: the scale of a free decay is that of its start.  Frequencies
are copied from reference_f1.json.
"""

import argparse
import gzip
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
from scipy.signal import filtfilt, firwin

RATE, EVERY = 5000, 10  # Hz, and samples of which one is taken
NOMINAL_HZ = 34.0
# Seconds after the roller has come to rest, and the first frequency.
PLATEAUS = {"2.08 up": (2.07, 2.87, 30.81), "2.50 up": (3.27, 4.07, 33.89),
            "2.93 up": (4.45, 5.15, 37.55), "2.93 down": (6.90, 7.65, 37.55),
            "2.50 down": (8.05, 8.75, 33.89), "2.08 down": (9.25, 9.95, 30.81),
            "1.65 down": (10.45, 11.10, 28.22)}
PAIRS = [("2.50 down", "2.08 down"), ("2.93 up", "2.08 up"),
         ("2.08 down", "1.65 down"), ("2.93 down", "2.50 down"),
         ("2.08 down", "2.08 up"), ("2.50 down", "2.50 up"),
         ("2.93 up", "2.93 down")]
WITHOUT_MASS = '[damage]\nkinds = ["damping", "stiffness", "nonlinear"]\n'


def write_case(folder, values, name, more=""):
    """Writes case and record of a plateau; returns the case's path."""
    begin, end, _ = PLATEAUS[name]
    rate = RATE / EVERY
    part = values[int(begin * rate):int(end * rate)]
    stem = os.path.join(folder, name.replace(" ", "_") + ("_k" if more else ""))
    np.savetxt(stem + ".csv",
               np.column_stack([np.arange(len(part)) / rate, part]), "%.7f",
               delimiter=",", header="t,a", comments="")
    text = f"""[model]
damping = {{ratios = [0.001]}}
[model.shear_building]
masses = [1]
stiffnesses = [{(2 * np.pi * NOMINAL_HZ) ** 2:.6g}]
[[group]]
name = "k"
adds_to = "stiffness"
storey = 1
[[group]]
name = "c"
adds_to = "damping"
proportional_to = "mass"
[[record]]
name = "decay"
file = "{os.path.basename(stem)}.csv"
time = "t"
start = "free"
[[record.channel]]
column = "a"
quantity = "absolute_acceleration"
dof = "u1"
unit = "m/s^2"
{more}"""
    with open(stem + ".toml", "w", encoding="utf-8") as file:
        file.write(text)
    return stem + ".toml"


def run(program, *flags):
    """Returns the program's status and the last line that it prints."""
    done = subprocess.run([program, *flags, "--progress=false"],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    lines = done.stdout.strip().splitlines() or ["no output"]
    return done.returncode, lines[-1]


def verdict_on(programs, values, pair, more):
    """Returns what pinode_damage says of a pair of plateaus, or who refuses."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "baseline")
        status, said = run(os.path.join(programs, "pinode_update"),
                           f"--case={write_case(folder, values, pair[0])}",
                           f"--output_dir={out}")
        if not os.path.isfile(os.path.join(out, "result.json")):
            return f"no baseline, status {status}: {said}"
        result = os.path.join(folder, "damage")
        status, said = run(os.path.join(programs, "pinode_damage"),
                           f"--case={write_case(folder, values, pair[1], more)}",
                           f"--baseline={out}", f"--output_dir={result}")
        path = os.path.join(result, "damage.json")
        if not os.path.isfile(path):
            return f"no result, status {status}: {said}"
        with open(path, encoding="utf-8") as file:
            damage = json.load(file)
        return f"{damage['verdict']}. {damage['message'][:110]}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("data")
    options = parser.parse_args()
    path = os.path.join(options.data, "dropbear", "slow10_test0.csv.gz")
    if not os.path.isfile(path):
        print(f"SKIPPED: no {path}")
        return 0
    with gzip.open(path, "rt") as file:
        volts = np.genfromtxt(file, delimiter=",", names=True)["acc_lowg_V"]
    smooth = filtfilt(firwin(801, 80, fs=RATE), 1, volts - volts.mean())[::EVERY]
    for first, second in PAIRS:
        change = (PLATEAUS[second][2] / PLATEAUS[first][2]) ** 2 - 1
        print(f"{first} -> {second}: {100 * change:+.1f} %")
        for words, more in (("all kinds", ""), ("no mass", WITHOUT_MASS)):
            said = verdict_on(options.programs, smooth, (first, second), more)
            print(f"  {words}: {said}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
