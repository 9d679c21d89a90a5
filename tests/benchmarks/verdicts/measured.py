#!/usr/bin/env python3
"""Verdicts on measured frames: measured.py PROGRAMS DATA [--frames=stiff,...]
[--seconds=600]

Two frames on a shake table (DATA/mini_shake_table, see DATA/README.md), each as
a shear model of three storeys of unknown stiffness with damping proportional to
mass and to stiffness. PROGRAMS holds pinode_update and pinode_damage.

Each half of a test is a healthy record.  One line a pair: what pinode_damage
says with one of them as the baseline (nothing has changed: a loss is a false
alarm), and with the records of the other frame, whose walls are softer (a loss
is right).  Then how many intervals of one half hold the value of the other.
"""

import argparse
import itertools
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

STEP = 0.008333  # s
RECORDS = {"sine_1p5 a": ("sine_1p5", 0, 25), "sine_1p5 b": ("sine_1p5", 25, 50),
           "sine_1p0 a": ("sine_1p0", 0, 20), "northridge a": ("northridge", 0, 33)}
FIRST_HZ = {"stiff": 7.9, "flexible": 3.7}
MASS = 0.15  # kg of a floor; only stiffness over mass matters


def write_case(folder, data, frame, name, stiffness_of):
    """Writes case and record of a part of a test; returns the case's path."""
    test, begin, end = RECORDS[name]
    table = np.genfromtxt(
        os.path.join(data, "mini_shake_table", f"{frame}3story_{test}.csv"),
        delimiter=",", names=True)
    rows = slice(int(begin / STEP), int(end / STEP))
    columns = ["ground_ax", "floor1_ax", "floor2_ax", "floor3_ax"]
    values = np.array([(table[c] - table[c].mean())[rows] for c in columns])
    stem = os.path.join(folder, f"{frame} {name}".replace(" ", "_"))
    times = STEP * np.arange(values.shape[1])
    np.savetxt(stem + ".csv", np.column_stack([times, values.T]), "%.6f",
               delimiter=",", header="t,g,a1,a2,a3", comments="")
    # The first mode of three equal storeys.
    k = MASS * (2 * np.pi * FIRST_HZ[stiffness_of] / 0.445) ** 2
    text = [
        "[model]", "damping = {ratios = [0.01]}", "[model.shear_building]",
        f"masses = [{MASS}, {MASS}, {MASS}]",
        f"stiffnesses = [{k:.6g}, {k:.6g}, {k:.6g}]"]
    for storey in (1, 2, 3):
        text += ["[[group]]", f'name = "k{storey}"', 'adds_to = "stiffness"',
                 f"storey = {storey}"]
    for group, matrix in (("cm", "mass"), ("ck", "stiffness")):
        text += ["[[group]]", f'name = "{group}"', 'adds_to = "damping"',
                 f'proportional_to = "{matrix}"']
    text += ["[[record]]", 'name = "record"',
             f'file = "{os.path.basename(stem)}.csv"',
             f"sampling_rate_hz = {1 / STEP:.6f}", 'interpolation = "linear"',
             'ground = [{direction = "x", column = "g", unit = "m/s^2"}]',
             "channel = ["]
    text += [f'  {{column = "a{i}", quantity = "absolute_acceleration", '
             f'dof = "u{i}", unit = "m/s^2"}},' for i in (1, 2, 3)] + ["]"]
    with open(stem + ".toml", "w", encoding="utf-8") as file:
        file.write("\n".join(text) + "\n")
    return stem + ".toml"


def run(program, seconds, *flags):
    """The program's result file, or None."""
    out = next(f for f in flags if f.startswith("--output_dir=")).split("=")[1]
    try:
        subprocess.run([program, *flags, "--overwrite", "--progress=false"],
                       timeout=seconds, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, check=False)
        name = "damage.json" if "damage" in program else "result.json"
        with open(os.path.join(out, name), encoding="utf-8") as file:
            return json.load(file)
    except (OSError, subprocess.TimeoutExpired):
        return None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("data")
    parser.add_argument("--frames", default="stiff,flexible")
    parser.add_argument("--seconds", type=float, default=600)
    options = parser.parse_args()
    if not os.path.isdir(os.path.join(options.data, "mini_shake_table")):
        print(f"SKIPPED: no mini_shake_table in {options.data}")
        return 0
    alarms = pairs = found = losses = held = intervals = 0
    with tempfile.TemporaryDirectory() as folder:
        fits = {}
        for frame in options.frames.split(","):
            for name in RECORDS:
                case = write_case(folder, options.data, frame, name, frame)
                out = case.replace(".toml", "_out")
                result = run(os.path.join(options.programs, "pinode_update"),
                             options.seconds, f"--case={case}",
                             f"--output_dir={out}")
                fits[frame, name] = (case, out, result)
                print(f"{frame:9s}{name:13s}",
                      result["verdict"] if result else "no result", flush=True)
        for frame in options.frames.split(","):
            others = {"stiff": "flexible"}.get(frame)
            for first, second in itertools.permutations(RECORDS, 2):
                (_, base, a), (case, _, b) = fits[frame, first], fits[frame, second]
                if a and b and a["verdict"] == "with_care":
                    for p, q in zip(a["parameters"], b["parameters"]):
                        if p["free"]:
                            intervals += 1
                            held += p["lower95"] <= q["value"] <= p["upper95"]
            new = [(frame, second, False) for second in RECORDS if second != "sine_1p5 a"]
            if others:
                new.append((others, "sine_1p5 a", True))
            for other, second, is_loss in new:
                case = write_case(folder, options.data, other, second, frame)
                damage = run(os.path.join(options.programs, "pinode_damage"),
                             options.seconds, f"--case={case}",
                             f"--baseline={fits[frame, 'sine_1p5 a'][1]}",
                             f"--output_dir={case[:-5]}_damage")
                verdict = damage["verdict"] if damage else "no result"
                print(f"{frame:9s}sine_1p5 a -> {other:9s}{second:13s} {verdict}",
                      flush=True)
                is_alarm = verdict in ("damage", "nonlinear")
                pairs += not is_loss
                losses += is_loss
                alarms += is_alarm and not is_loss
                found += is_alarm and is_loss
    print(f"false alarms: {alarms} of {pairs}; losses found: {found} of {losses}")
    print(f"intervals that hold the other part's value: {held} of {intervals}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
