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
    """Returns the first line that the program prints."""
    done = subprocess.run([program, *flags, "--overwrite", "--progress=false"],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    return (done.stdout.splitlines() or [f"status {done.returncode}"])[0]


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
    with tempfile.TemporaryDirectory() as folder:
        for first, second in PAIRS:
            out = os.path.join(folder, "baseline")
            case = write_case(folder, smooth, first)
            run(os.path.join(options.programs, "pinode_update"),
                f"--case={case}", f"--output_dir={out}")
            change = (PLATEAUS[second][2] / PLATEAUS[first][2]) ** 2 - 1
            print(f"{first} -> {second}: {100 * change:+.1f} %")
            for words, more in (("all kinds", ""), ("no mass", WITHOUT_MASS)):
                new = write_case(folder, smooth, second, more)
                result = os.path.join(folder, "damage")
                run(os.path.join(options.programs, "pinode_damage"),
                    f"--case={new}", f"--baseline={out}",
                    f"--output_dir={result}")
                try:
                    with open(os.path.join(result, "damage.json"),
                              encoding="utf-8") as file:
                        damage = json.load(file)
                    print(f"  {words}: {damage['verdict']}. "
                          f"{damage['message'][:110]}", flush=True)
                except OSError:
                    print(f"  {words}: no result", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
