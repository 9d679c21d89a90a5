#!/usr/bin/env python3
"""Verdicts on measured modes alone: modes_board.py PINODE_UPDATE COUNT
[--first=N] [--keep=FOLDER]

Makes COUNT chains of storeys (structures.py, 5 to 10 storeys), five measured
modes of each with 0.2 % noise in frequencies and 0.01 in shapes, and one fault
of the measurement or none. The stiffness of every storey is unknown. Prints one
line a case and how often the fault is the first explanation.

Wrong is a result with a stiffness more than two half-widths off that is good,
or that is with_care and does not have the fault among the first two
explanations.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
from scipy import linalg

sys.dont_write_bytecode = True
import structures  # noqa: E402

MODES = 5
FREQUENCY_SIGMA = 0.002  # as a share of the frequency
SHAPE_SIGMA = 0.01       # of a largest entry of one
FAULTS = ["nothing", "turned", "exchanged", "gain", "shapes_exchanged", "sign",
          "misread", "mass"]


class Chain(structures.Structure):
    """Without braces: each storey is a group."""

    def __init__(self, rng):
        super().__init__(rng, 5, 10)
        n = self.dofs
        self.springs = self.springs[:n]
        self.stiffness = self.stiffness[:n]
        self.scale_to(rng)


def measure(rng, chain, stiffness, mass, kind):
    """Frequencies, shapes, and kind and place of the explanation."""
    squares, shapes = linalg.eigh(chain.matrix(stiffness), np.diag(mass))
    hz = np.sqrt(squares[:MODES]) / (2 * np.pi)
    shapes = shapes[:, :MODES] / np.abs(shapes[:, :MODES]).max(axis=0)
    hz *= 1 + FREQUENCY_SIGMA * rng.standard_normal(MODES)
    shapes += SHAPE_SIGMA * rng.standard_normal(shapes.shape)
    one, two = sorted(int(i) for i in
                      rng.choice(chain.dofs, 2, replace=False))
    mode, other = sorted(int(i) for i in rng.choice(MODES, 2, replace=False))
    if kind == "turned":
        shapes[one] *= -1
        return hz, shapes, ("sensor_gain", f"u{one + 1}")
    if kind == "exchanged":
        shapes[[one, two]] = shapes[[two, one]]
        return hz, shapes, ("sensors_exchanged", f"u{one + 1},u{two + 1}")
    if kind == "gain":
        shapes[one] *= rng.choice([0.75, 1.3])
        return hz, shapes, ("sensor_gain", f"u{one + 1}")
    if kind == "shapes_exchanged":
        shapes[:, [mode, other]] = shapes[:, [other, mode]]
        return hz, shapes, ("mode", f"m{mode + 1},m{other + 1}")
    if kind == "sign":
        shapes[np.abs(shapes[:, mode]).argmax(), mode] *= -1
        return hz, shapes, ("mode", f"m{mode + 1}")
    if kind == "misread":
        hz[mode] *= rng.choice([0.95, 1.05])
        return hz, shapes, ("mode", f"m{mode + 1}")
    return hz, shapes, None


def write(folder, seed, kind):
    rng = np.random.default_rng(seed)
    chain = Chain(rng)
    truth = rng.uniform(-0.2, 0.2, chain.dofs)
    mass = chain.mass.copy()
    named = None
    if kind == "mass":
        place = int(rng.integers(chain.dofs))
        mass[place] *= rng.choice([0.75, 1.25])
        named = ("mass", f"u{place + 1}")
    hz, shapes, fault = measure(rng, chain, chain.stiffness * (1 + truth), mass,
                                kind)
    lines = ["[model]", f"damping = {{ratios = [{chain.ratio:.6g}]}}",
             "dofs = [" + ", ".join(f'"{n}"' for n in chain.names) + "]",
             "[model.shear_building]",
             "masses = [" + ", ".join(f"{m:.12g}" for m in chain.mass) + "]",
             "stiffnesses = [" +
             ", ".join(f"{k:.12g}" for k in chain.stiffness) + "]"]
    for i in range(chain.dofs):
        lines += ["[[group]]", f'name = "k{i + 1}"', 'adds_to = "stiffness"',
                  f"storey = {i + 1}"]
    for j in range(MODES):
        shape = ", ".join(f"{n} = {v:.6g}"
                          for n, v in zip(chain.names, shapes[:, j]))
        lines += ["[[mode]]", f'name = "m{j + 1}"', f"frequency = {hz[j]:.8g}",
                  f"frequency_sigma = {FREQUENCY_SIGMA * hz[j]:.4g}",
                  f"shape = {{{shape}}}", f"shape_sigma = {SHAPE_SIGMA}"]
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "case.toml"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    return truth, fault or named


def run(program, folder, seed, kind):
    truth, fault = write(folder, seed, kind)
    output = os.path.join(folder, "out")
    subprocess.run([program, f"--case={folder}/case.toml",
                    f"--output_dir={output}", "--overwrite", "--threads=1",
                    "--progress=false"], check=False,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(os.path.join(output, "result.json"), encoding="utf-8") as file:
        result = json.load(file)
    worst = 0.0
    for estimate, true in zip(result["parameters"], truth):
        if estimate["lower95"] is None or estimate["upper95"] is None:
            continue
        half = 0.5 * (estimate["upper95"] - estimate["lower95"])
        worst = max(worst, abs(estimate["value"] - true) / max(half, 1e-12))
    names = [(e["kind"].split("+"), e["place"].split("+"))
             for e in result["explanations"][:2]]
    among = [fault in zip(*name) for name in names]
    first = bool(among) and among[0] and len(names[0][0]) == 1
    wrong = worst > 2 and (result["verdict"] == "good" or
                           (result["verdict"] == "with_care" and
                            not any(among)))
    return {"kind": kind, "verdict": result["verdict"], "worst": worst,
            "first": first, "wrong": wrong,
            "said": [e["what"] for e in result["explanations"][:1]]}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--keep")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(args.first, args.first + args.count):
            kind = FAULTS[seed % len(FAULTS)]
            row = run(args.program,
                      os.path.join(args.keep or folder, str(seed)), seed, kind)
            rows.append(row)
            print(f"{seed:4d} {kind:17s} {row['verdict']:12s} "
                  f"{row['worst']:8.1f} {'WRONG' if row['wrong'] else '':5s} "
                  f"{'named' if row['first'] else '':5s} "
                  f"{' | '.join(row['said'])[:80]}", flush=True)
    for kind in FAULTS:
        some = [r for r in rows if r["kind"] == kind]
        if some:
            print(f"{kind:17s} {len(some):3d}: "
                  f"{sum(r['verdict'] == 'good' for r in some)} good, "
                  f"{sum(r['wrong'] for r in some)} wrong, "
                  f"{sum(r['first'] for r in some)} named first")


if __name__ == "__main__":
    main()
