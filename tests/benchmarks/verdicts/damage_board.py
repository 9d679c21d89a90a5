#!/usr/bin/env python3
"""Verdicts of damage on random structures: damage_board.py PROGRAMS COUNT
[--first=N] [--change=KIND|random] [--hidden=KIND|none|random]
[--baselines=1] [--dofs=4-15] [--sensors=N] [--jobs=2] [--keep=FOLDER]

Makes COUNT pairs of states.  The healthy one is a case with one record (more
with --baselines) that pinode_update fits; the later one has another excitation,
of another level, and at most one change, and goes to pinode_damage.  Half of the
structures have an error of their model that no unknown of the user describes and
that is there in both states.  A third are beams, with full matrices and sensors
of translations; the others are the chains of structures.py.  With --sensors
only the N highest places are measured.

A verdict is wrong if it is "damage" where no stiffness is lost, or names a group
that has lost nothing, or gives the loss with an interval that misses it by more
than two half-widths.
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

CHANGES = ["none", "none", "loss", "loss", "loss", "damping", "mass", "gain",
           "upside_down", "exchange", "delay", "clock_rate", "temperature",
           "unlisted_loss"]
HIDDEN = ["stiffness", "mass", "all_masses", "damping_modes", "gain", "delay",
          "excitation_scale", "cubic"]
NO_LOSS = {"none", "damping", "mass", "gain", "upside_down", "exchange", "delay",
           "clock_rate"}


class Beam(structures.Structure):
    """A cantilever or a beam on two supports, one of them a spring for turns;
    a group is a part of its elements."""

    def __init__(self, rng, least, most):
        elements = max(3, int(round(least * (most / least)**rng.random())) // 2)
        self.cantilever = rng.random() < 0.5
        # Translations and turns of nodes; the supports go.
        count = 2 * (elements + 1)
        fixed = [0, 1] if self.cantilever else [0, count - 2]
        kept = [i for i in range(count) if i not in fixed]
        self.dofs = len(kept)
        self.position = {full: i for i, full in enumerate(kept)}
        self.names = [("w" if i % 2 == 0 else "r") + str(i // 2) for i in kept]
        self.moves = np.array([float(i % 2 == 0) for i in kept])
        mass = rng.uniform(0.8, 1.3) * 1000
        self.mass = np.where(self.moves > 0, mass, mass / 30.0)
        self.springs = [(i - 1, i) for i in range(elements)]
        self.parts = elements
        self.stiffness = rng.uniform(0.7, 1.4, elements)
        self.scale_to(rng)

    def matrix(self, stiffness):
        part = np.array([[12, 6, -12, 6], [6, 4, -6, 2],
                         [-12, -6, 12, -6], [6, 2, -6, 4]])
        k = np.zeros((self.dofs, self.dofs))
        for e, value in enumerate(stiffness):
            where = [self.position.get(2 * e + i, -1) for i in range(4)]
            for a in range(4):
                for b in range(4):
                    if where[a] >= 0 and where[b] >= 0:
                        k[where[a], where[b]] += value * part[a, b]
        return k


class State(structures.Setup):
    """The healthy state or, with a change, the later one."""

    def __init__(self, seed, hidden, dofs, sensors=0):
        shape = np.random.default_rng([seed, 2])
        self.is_beam = bool(shape.random() < 1 / 3) and hidden not in (
            "stiffness", "cubic")
        self.make = Beam if self.is_beam else structures.Structure
        super().__init__(seed, [] if hidden == "none" else [hidden], dofs)
        if sensors > 0:
            places = np.flatnonzero(self.structure.moves)
            self.sensors = [int(p) for p in places[-sensors:]]
        self.level = 1.0
        # Fixes a cubic spring for all states and levels.
        self.respond(self.alphas, self.damping_alphas, self.faults)

    def begin(self, seed, number):
        """Another excitation, and other noise."""
        self.rng = np.random.default_rng([seed, 10 + number])
        samples = int(structures.DURATION * structures.RATE)
        self.records = 1
        self.loads = [self.level * structures.excitation(self.rng, samples)]

    def change(self, seed, kind):
        """Makes this the later state; returns what is lost by group."""
        rng = np.random.default_rng([seed, 3])
        self.level = float(rng.choice([0.5, 1.0, 1.0, 2.0]))
        lost = {f"k{i + 1}": 0.0 for i, free in enumerate(self.free) if free}
        self.size = 0.0
        if kind == "loss":
            name = str(rng.choice(list(lost)))
            i = int(name[1:]) - 1
            self.size = lost[name] = -rng.uniform(0.05, 0.4)
            self.alphas = list(self.alphas)
            self.alphas[i] = (1 + self.alphas[i]) * (1 + lost[name]) - 1
        elif kind == "temperature":
            self.size = rng.uniform(-0.04, 0.04)
            self.alphas = [(1 + a) * (1 + self.size) - 1 for a in self.alphas]
            lost = {name: self.size for name in lost}
        elif kind != "none":
            fault = {"clock_rate": lambda: {
                "kind": kind, "place": "", "size": rng.uniform(-0.01, 0.01)},
                     "unlisted_loss": lambda: self.draw("stiffness")}.get(
                         kind, lambda: self.draw(kind))()
            self.size = fault["size"] if "size" in fault else 0.0
            self.place = fault["place"]
            self.faults = self.faults + [fault]
        return lost

    def write_case(self, folder):
        os.makedirs(folder, exist_ok=True)
        self.write(folder)


def run_program(program, log, *flags):
    with open(log, "a", encoding="utf-8") as file:
        try:
            return subprocess.run(
                [program, *flags, "--overwrite", "--threads=1",
                 "--progress=false"], stdout=file, stderr=file, check=False,
                timeout=900).returncode
        except subprocess.TimeoutExpired:
            return -1


def read(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except OSError:
        return None


def judge(kind, lost, damage):
    """Says what is wrong with a verdict, or that a loss was found."""
    out = {"verdict": damage["verdict"], "wrong": "", "found": False,
           "held": 0, "intervals": 0}
    groups = {g["name"]: g for g in damage["groups"]
              if g["target"] == "stiffness"}
    for name, loss in lost.items():
        g = groups.get(name)
        if g is None or g["lower95"] is None or g["upper95"] is None:
            continue
        half = max(0.5 * (g["upper95"] - g["lower95"]), 1e-12)
        out["intervals"] += 1
        out["held"] += g["lower95"] <= loss <= g["upper95"]
        off = max(g["lower95"] - loss, loss - g["upper95"]) / half
        called = (damage["verdict"] == "damage" and g["damaged"] and
                  g["change"] < 0 and g["reason"] == "beyond_threshold")
        if called and loss == 0.0:
            out["wrong"] += f"{name} called {g['change']:+.3f}; "
        elif called and off > 1.0:
            out["wrong"] += f"{name} {g['change']:+.3f} for {loss:+.3f}; "
        elif called:
            out["found"] = True
        if loss < -0.05 and -loss > 3 * half:
            out["seen"] = True
    first = damage["explanations"][0]["changes"] if damage["explanations"] else []
    out["named"] = any(change["target"] == "damping" for change in first)
    if damage["verdict"] == "nonlinear" or (
            damage["verdict"] == "damage" and
            (kind in NO_LOSS or kind == "temperature")):
        out["wrong"] += f"verdict {damage['verdict']}; "
    if damage["verdict"] == "no_damage" and out.get("seen"):
        out["wrong"] += "loss beyond three half-widths not called; "
    return out


def run(args, seed, folder):
    rng = np.random.default_rng([seed, 4])
    kind = str(rng.choice(CHANGES))
    hidden = str(rng.choice(HIDDEN)) if rng.random() < 0.5 else "none"
    kind = kind if args.change == "random" else args.change
    hidden = hidden if args.hidden == "random" else args.hidden
    dofs = tuple(int(x) for x in args.dofs.split("-"))
    place = os.path.join(folder, str(seed))
    log = os.path.join(place, "log")
    began = time.time()
    row = {"seed": seed, "kind": kind, "hidden": hidden, "verdict": "none",
           "wrong": "", "found": False, "held": 0, "intervals": 0,
           "sentence": "", "fit": ""}
    baselines = []
    for number in range(args.baselines):
        state = State(seed, hidden, dofs, args.sensors)
        state.level = [1.0, 1.6, 0.6][number % 3]
        state.begin(seed, number)
        state.write_case(os.path.join(place, f"healthy{number}"))
        output = os.path.join(place, f"healthy{number}", "out")
        run_program(os.path.join(args.programs, "pinode_update"), log,
                    f"--case={place}/healthy{number}/case.toml",
                    f"--output_dir={output}")
        baselines.append(output)
    later = State(seed, hidden, dofs, args.sensors)
    row["lost"] = later.change(seed, kind)
    row["size"] = later.size
    later.begin(seed, 100)
    row["dofs"], row["beam"] = later.structure.dofs, later.is_beam
    later.write_case(os.path.join(place, "later"))
    healthy = read(os.path.join(baselines[0], "result.json"))
    row["fit"] = healthy["verdict"] if healthy else "none"
    output = os.path.join(place, "later", "out")
    run_program(os.path.join(args.programs, "pinode_damage"), log,
                f"--case={place}/later/case.toml",
                "--baseline=" + ",".join(baselines), f"--output_dir={output}")
    damage = read(os.path.join(output, "damage.json"))
    if damage is not None:
        row.update(judge(kind, row["lost"], damage))
        row["sentence"] = damage["message"]
    row["seconds"] = time.time() - began
    return row


def table(rows):
    print(f"wrong verdicts: {sum(bool(r['wrong']) for r in rows)} of {len(rows)}")
    for kind in dict.fromkeys(CHANGES):
        some = [r for r in rows if r["kind"] == kind]
        if not some:
            continue
        verdicts = sorted({r["verdict"] for r in some})
        counts = ", ".join(
            f"{sum(r['verdict'] == v for r in some)} {v}" for v in verdicts)
        print(f"  {kind:14s} {len(some):3d}: {counts}")
    seen = [r for r in rows if r["kind"] == "loss" and r.get("seen")]
    print(f"losses above three half-widths called damage: "
          f"{sum(r['found'] for r in seen)} of {len(seen)}")
    damped = [r for r in rows if r["kind"] == "damping"]
    if damped:
        print(f"changed damping named: "
              f"{sum(r.get('named', False) for r in damped)} of {len(damped)}")
    print(f"intervals that hold the change: {sum(r['held'] for r in rows)} of "
          f"{sum(r['intervals'] for r in rows)}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--change", default="random")
    parser.add_argument("--hidden", default="random")
    parser.add_argument("--baselines", type=int, default=1)
    parser.add_argument("--dofs", default="4-15")
    parser.add_argument("--sensors", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--keep")
    args = parser.parse_args()
    folder = args.keep or tempfile.mkdtemp()
    rows = []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        jobs = [pool.submit(run, args, seed, folder)
                for seed in range(args.first, args.first + args.count)]
        for job in jobs:
            row = job.result()
            rows.append(row)
            lost = ", ".join(f"{n} {x:+.3f}" for n, x in row["lost"].items() if x)
            size = (f"{row['size']:+.3f}" if isinstance(row["size"], float)
                    else "")
            print(f"{row['seed']:4d} {'beam' if row['beam'] else 'chain':5s} "
                  f"{row['dofs']:2d} DOFs, hidden {row['hidden']:16s} "
                  f"{row['fit']:10s} {row['kind']} {size} {lost} "
                  f"{row.get('seconds', 0):.0f} s  {row['sentence'][:150]}"
                  f"{'  WRONG: ' + row['wrong'] if row['wrong'] else ''}",
                  flush=True)
    table(rows)
    if not args.keep:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
