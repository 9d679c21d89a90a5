#!/usr/bin/env python3
"""El Centro (1940, NS) as the force's history, held out for four_dof_forced.

Reads ground_motions/elcentro_1940_ns_peknold.csv (t_s, acc_g) in the folder of
measured data, scales it so that x1 stays inside the range of the training
records of this folder, and writes el_centro.csv and el_centro.toml, which
refers to the records of this folder by path.  Its output is not kept here.
"""

import argparse
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import generate  # noqa: E402

CASE = "four_dof_forced.toml"
MOTION = os.path.join("ground_motions", "elcentro_1940_ns_peknold.csv")


def write_case(output):
    """CASE with its records by path and El Centro as one more hold-out."""
    with open(os.path.join(HERE, CASE), encoding="utf-8") as file:
        head, *records = file.read().split("\n[[record]]\n")
    training = [r for r in records if 'role  = "train"' in r]
    assert len(training) == len(generate.TRAINING)
    here = os.path.relpath(HERE, output).replace(os.sep, "/")
    blocks = [r.replace('file  = "', f'file  = "{here}/') for r in records]
    name = next(iter(generate.TRAINING))
    blocks.append(training[0].replace(f'"{name}', '"el_centro').replace(
        'role  = "train"', 'role  = "holdout"'))
    with open(os.path.join(output, "el_centro.toml"), "w",
              encoding="utf-8", newline="\n") as file:
        file.write("\n[[record]]\n".join([head] + blocks))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "measured", nargs="?", default=os.environ.get("PINODE_MEASURED_DATA"),
        help="folder of measured data, or the CSV itself; default: the "
        "environment variable PINODE_MEASURED_DATA")
    parser.add_argument("--output", required=True, help="folder to write into")
    arguments = parser.parse_args()
    if not arguments.measured:
        parser.error("no measured data: give the folder or set "
                     "PINODE_MEASURED_DATA")
    motion = arguments.measured
    if os.path.isdir(motion):
        motion = os.path.join(motion, MOTION)
    if not os.path.isfile(motion):
        parser.error(f"{motion}: no such file")

    times, shape = np.loadtxt(motion, delimiter=",", skiprows=1).T
    trained = generate.trained_ranges(HERE)
    force = generate.scaled_into_range(times, shape, trained["x1"])
    os.makedirs(arguments.output, exist_ok=True)
    states = generate.write_record(
        os.path.join(arguments.output, "el_centro.csv"), times, force)
    generate.check_inside("el_centro", generate.ranges_of(states), trained)
    write_case(arguments.output)


if __name__ == "__main__":
    main()
