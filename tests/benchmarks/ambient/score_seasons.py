#!/usr/bin/env python3
"""score_seasons.py FOLDER: scores what seasons.sh has left in a folder."""

import glob
import json
import os
import sys

import numpy as np


def read(*parts):
    with open(os.path.join(*parts), encoding="utf-8") as file:
        return json.load(file)


def baseline(folders):
    names, errors, halves, usable = None, [], [], 0
    for folder in folders:
        result = read(folder, "result", "result.json")
        truth = read(folder, "truth.json")["groups"]
        found = {p["name"]: p for p in result["parameters"]}
        names = list(truth)
        errors.append([found[n]["value"] - truth[n] for n in names])
        halves.append([(found[n]["upper95"] - found[n]["lower95"]) / 2
                       for n in names])
        usable += result["usable"]
    errors, halves = np.array(errors), np.array(halves)
    print("baseline: %d, %d usable" % (len(errors), usable))
    for i, name in enumerate(names):
        print("  %-12s inside %5.1f %%, rmse %.2g, deviation %.2g" %
              (name, 100 * np.mean(np.abs(errors[:, i]) <= halves[:, i]),
               np.sqrt(np.mean(errors[:, i]**2)), halves[:, i].mean() / 1.96))


def changes(folders, truth):
    """`truth`: changes of groups that are not zero, as fractions."""
    inside, changed, alone, halves, values = {}, {}, 0, {}, {}
    least = []
    for folder in folders:
        result = read(folder, "result", "damage.json")
        groups = result["groups"]
        for group in groups:
            group["changed"] = group["p_value"] <= result["false_alarm_rate"]
            name = group["name"]
            right = group["lower95"] <= truth.get(name, 0) <= group["upper95"]
            inside.setdefault(name, []).append(right)
            changed.setdefault(name, []).append(group["changed"])
            halves.setdefault(name, []).append(
                (group["upper95"] - group["lower95"]) / 2)
            values.setdefault(name, []).append(group["change"])
        least.append(min(group["p_value"] for group in groups))
        alone += {g["name"] for g in groups if g["changed"]} == set(truth)
    print("%s: %d judged, exactly what is true found in %d, something in %d" %
          (os.path.basename(folders[0]), len(folders), alone,
           sum(any(calls) for calls in zip(*changed.values()))))
    if not truth:
        # Where nothing has changed and deviations are right, each as often as
        # it says.
        print("  least adjusted p-value at most " + ", ".join(
            "%g in %.1f %%" % (rate, 100 * np.mean(np.array(least) <= rate))
            for rate in (0.01, 0.05, 0.1, 0.2, 0.5)))
    for name, hits in inside.items():
        print("  %-12s inside %5.1f %%, called changed %d, mean %+.2f %%, "
              "half of the interval %.2f %%" %
              (name, 100 * np.mean(hits), sum(changed[name]),
               100 * np.mean(values[name]), 100 * np.mean(halves[name])))


def main():
    def folders(state, file):
        found = glob.glob(os.path.join(sys.argv[1], "*", state, "result", file))
        return [os.path.dirname(os.path.dirname(path)) for path in sorted(found)]

    baseline(folders("baseline", "result.json"))
    for state, truth in [("healthy", {}), ("damaged", {"k2": -0.02})]:
        judged = folders(state, "damage.json")
        if judged:
            changes(judged, truth)
        else:
            print(state + ": none judged")


if __name__ == "__main__":
    main()
