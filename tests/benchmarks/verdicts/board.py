#!/usr/bin/env python3
"""Verdicts on random structures: board.py PINODE_UPDATE COUNT [--first=N]
[--faults=...] [--dofs=5-40] [--jobs=2] [--keep=FOLDER]

Makes COUNT structures (structures.py), runs the program on each, and prints one
line a structure and a table: verdicts that are wrong and good, causes that are
named, intervals that hold the truth.
"""

import argparse
import concurrent.futures
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.dont_write_bytecode = True
import structures  # noqa: E402

# Kinds of explanations that describe each fault.  Where all stiffness is free, a
# clock, all masses and all damping off by a factor are the same.
NAMES = {
    "damping": {"damping"}, "damping_modes": {"damping"}, "mass": {"mass"},
    "all_masses": {"mass", "damping", "excitation_scale", "clock_rate"},
    "stiffness": {"stiffness"}, "gain": {"sensor_gain"},
    "upside_down": {"sensor_gain"}, "delay": {"sensor_delay"},
    "exchange": {"sensors_exchanged"},
    "excitation_delay": {"excitation_delay"},
    "excitation_scale": {"excitation_scale", "mass"},
    "clock_rate": {"clock_rate", "damping", "mass", "excitation_scale"},
    "cubic": {"nonlinear"},
}
WITH_PLACE = {"mass", "stiffness", "gain", "upside_down", "delay", "exchange",
              "cubic"}
SEEN = 5.0  # deviations beyond which a fault has to be named


def is_named(fault, result):
    """True if one of the first two explanations, or a finding, names it."""
    for explanation in result.get("explanations", [])[:2]:
        kinds = explanation["kind"].split("+")
        places = explanation["place"].split("+")
        for kind, place in zip(kinds, places):
            if kind in NAMES[fault["kind"]] and (
                    fault["kind"] not in WITH_PLACE or
                    place == fault["place"]):
                return True
    words = " ".join(finding.get("text", "") for finding in
                     result.get("findings", [])) + " ".join(
                         str(r) for r in result.get("remarks", []))
    return (fault["kind"] == "upside_down" and
            f"'{fault['place']}'" in words and "upside down" in words)


def judge(truth, result):
    out = {"verdict": result.get("verdict", "none"), "worst": 0.0,
           "worst_name": "", "held": 0, "intervals": 0}
    for estimate in result["parameters"]:
        true = truth["values"].get(estimate["name"])
        if true is None:
            continue
        low, high = estimate["lower95"], estimate["upper95"]
        if low is None or high is None:
            continue
        half = 0.5 * (high - low)
        off = abs(estimate["value"] - true) / max(half, 1e-12)
        out["intervals"] += 1
        out["held"] += low <= true <= high
        if off > out["worst"]:
            out["worst"], out["worst_name"] = off, estimate["name"]
    out["wrong"] = out["worst"] > 2.0
    out["faults"] = [(f["kind"], f["place"], f["deviations"] > SEEN,
                      is_named(f, result)) for f in truth["faults"]]
    return out


def run(program, seed, args, folder):
    if args.faults == "random":
        kinds = structures.draw_kinds(np.random.default_rng([seed, 1]))
    else:
        kinds = [k for k in args.faults.split(",") if k != "none"]
    dofs = tuple(int(x) for x in args.dofs.split("-"))
    place = os.path.join(folder, str(seed))
    structures.Setup(seed, kinds, dofs).write(place)
    output = os.path.join(place, "out")
    began = time.time()
    with open(os.path.join(place, "log"), "w", encoding="utf-8") as log:
        status = subprocess.run(
            [program, f"--case={place}/case.toml", f"--output_dir={output}",
             "--overwrite", "--threads=1", "--progress=false"],
            stdout=log, stderr=log, check=False).returncode
    seconds = time.time() - began
    with open(os.path.join(place, "truth.json"), encoding="utf-8") as file:
        truth = json.load(file)
    try:
        with open(os.path.join(output, "result.json"),
                  encoding="utf-8") as file:
            result = json.load(file)
    except OSError:
        return seed, truth, {"verdict": f"status {status}", "wrong": False,
                             "worst": 0.0, "worst_name": "", "held": 0,
                             "intervals": 0, "faults": [], "seconds": seconds,
                             "first": []}
    scored = judge(truth, result)
    scored["seconds"] = seconds
    scored["first"] = [e["what"] for e in result.get("explanations", [])[:2]]
    return seed, truth, scored


def table(rows):
    def share(part, whole):
        part, whole = list(part), list(whole)
        return f"{len(part)} of {len(whole)}"

    faulty = [r for r in rows if r["truth"]["faults"]]
    right = [r for r in rows if not r["truth"]["faults"]]
    for name, some in (("with faults", faulty), ("nothing wrong", right)):
        if not some:
            continue
        print(f"{name}: {len(some)}")
        for verdict in sorted({r["verdict"] for r in some}):
            these = [r for r in some if r["verdict"] == verdict]
            wrong = [r for r in these if r["wrong"]]
            held = sum(r["held"] for r in these)
            count = sum(r["intervals"] for r in these)
            print(f"  {verdict:13s} {len(these):4d}, wrong "
                  f"{share(wrong, these)}, intervals hold {held} of {count}")
        hidden = [r for r in some if r["verdict"] == "with_care" and r["wrong"]
                  and not any(f[3] for f in r["faults"])]
        print(f"  with_care, wrong, no cause named: {share(hidden, some)}")
    seen = [f for r in faulty for f in r["faults"] if f[2]]
    first = [f for r in faulty for f in r["faults"][:1] if f[2] and
             len(r["faults"]) == 1]
    print("faults seen and named:", share([f for f in seen if f[3]], seen),
          " single ones:", share([f for f in first if f[3]], first))
    for kind in structures.KINDS:
        of = [f for f in seen if f[0] == kind]
        if of:
            print(f"  {kind:17s} {share([f for f in of if f[3]], of)}")
    print("seconds, median and largest:",
          f"{np.median([r['seconds'] for r in rows]):.1f}",
          f"{max(r['seconds'] for r in rows):.1f}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--faults", default="random")
    parser.add_argument("--dofs", default="5-40")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep")
    args = parser.parse_args()
    folder = args.keep or tempfile.mkdtemp()
    rows = []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        jobs = [pool.submit(run, args.program, seed, args, folder)
                for seed in range(args.first, args.first + args.count)]
        for job in jobs:
            seed, truth, row = job.result()
            row["truth"] = truth
            rows.append(row)
            faults = ", ".join(
                f"{kind} {place}{'' if seen else ' (unseen)'}"
                f"{' named' if named else ''}".replace("  ", " ")
                for kind, place, seen, named in row["faults"]) or "nothing"
            print(f"{seed:4d} {truth['dofs']:2d} DOFs {row['verdict']:12s} "
                  f"{row['worst']:8.1f} {row['worst_name']:11s} "
                  f"{row['seconds']:5.1f} s  {faults}  <- "
                  f"{' | '.join(row['first'])[:150]}", flush=True)
    table(rows)
    if not args.keep:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
