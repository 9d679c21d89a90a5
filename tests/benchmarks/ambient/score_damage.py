#!/usr/bin/env python3
"""score_damage.py FOLDER GROUP CHANGE: what damage.json files of damaged_*.json
and healthy_*.json say; GROUP alone changed in the damaged ones."""

import glob
import json
import os
import sys

import numpy as np

folder, group, truth = sys.argv[1], sys.argv[2], float(sys.argv[3])


def results(kind):
    for path in sorted(glob.glob(os.path.join(folder, kind + "_*.json"))):
        with open(path, encoding="utf-8") as file:
            yield json.load(file)


found = alone = covered = 0
estimates = []
damaged = list(results("damaged"))
for result in damaged:
    changed = [g["name"] for g in result["groups"] if g["p_value"] <=
               result["false_alarm_rate"]]
    own = next(g for g in result["groups"] if g["name"] == group)
    found += group in changed
    alone += changed == [group]
    covered += own["lower95"] <= truth <= own["upper95"]
    estimates.append(own["change"])
healthy = list(results("healthy"))
alarms = sum(any(g["p_value"] <= result["false_alarm_rate"]
                 for g in result["groups"]) for result in healthy)
inside = [g["lower95"] <= 0.0 <= g["upper95"]
          for result in healthy for g in result["groups"]]
print(f"{group} {100 * truth:+g} %: found in {found} of {len(damaged)}, alone in "
      f"{alone}; mean {100 * np.mean(estimates):.2f} %, standard deviation "
      f"{100 * np.std(estimates):.2f} %, interval holds it in {covered}")
print(f"false alarms: {alarms} of {len(healthy)}; 95 % intervals that hold zero: "
      f"{100 * np.mean(inside):.1f} %")
