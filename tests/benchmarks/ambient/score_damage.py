#!/usr/bin/env python3
"""score_damage.py FOLDER WAY GROUP CHANGE: what the damage.json files
WAY_damaged_*.json and WAY_healthy_*.json say; GROUP alone changed in the damaged
ones.  *.none are runs that came to no verdict."""

import glob
import json
import os
import sys

import numpy as np

folder, way, group, truth = sys.argv[1:4] + [float(sys.argv[4])]


def results(kind):
    for path in sorted(
            glob.glob(os.path.join(folder, f"{way}_{kind}_*.json"))):
        with open(path, encoding="utf-8") as file:
            yield json.load(file)


def without(kind):
    return len(glob.glob(os.path.join(folder, f"{way}_{kind}_*.none")))


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
if damaged:
    print(f"{group} {100 * truth:+g} %: found in {found} of {len(damaged)} (and "
          f"{without('damaged')} without a verdict), alone in {alone}; mean "
          f"{100 * np.mean(estimates):.2f} %, standard deviation "
          f"{100 * np.std(estimates):.2f} %, interval holds it in {covered}")
if healthy:
    print(f"false alarms: {alarms} of {len(healthy)} (and {without('healthy')} "
          f"without a verdict); 95 % intervals that hold zero: "
          f"{100 * np.mean(inside):.1f} %")
