#!/usr/bin/env python3
"""Damage from frequency response functions, and what must not be called damage.

    tests/programs/frf_damage_test.py PROGRAM_DIR

Four masses in a row are hit at the first one, and all of them are measured, with
noise of 1 %. The functions are solutions of the equations of motion by NumPy.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

STIFFNESS = (4000.0, 3000.0, 2500.0, 2000.0)
LINES_HZ = np.arange(1.0, 25.0, 0.1)


def spring(storey, stiffness):
    """The stiffness matrix of one spring below a mass."""
    matrix = np.zeros((4, 4))
    matrix[storey, storey] = stiffness
    if storey > 0:
        matrix[storey - 1, storey - 1] = stiffness
        matrix[storey - 1, storey] = matrix[storey, storey - 1] = -stiffness
    return matrix


SPRINGS = [spring(storey, value) for storey, value in enumerate(STIFFNESS)]
DAMPING = 0.2 * np.eye(4) + 4e-4 * sum(SPRINGS)


def accelerance(mass=(1.0, 1.0, 1.0, 1.0), factors=(1.0, 1.0, 1.0, 1.0)):
    """Lines x masses, for a force on the first one."""
    stiffness = sum(factor * one for factor, one in zip(factors, SPRINGS))
    return np.array([
        -w ** 2 * np.linalg.inv(stiffness - w ** 2 * np.diag(mass) + 1j * w * DAMPING)[:, 0]
        for w in 2.0 * np.pi * LINES_HZ])


def turned(functions):
    return functions * np.array([1.0, -1.0, 1.0, 1.0])


def late(functions):
    return functions * np.exp(-2j * np.pi * LINES_HZ * 0.002)[:, None]


# A loss, and errors and changes that are none.
LOST = accelerance(factors=(1.0, 0.9, 1.0, 1.0))
OTHERS = {
    "a mass": accelerance(mass=(1.0, 1.0, 1.1, 1.0)),
    "exchanged sensors": accelerance()[:, [0, 2, 1, 3]],
    "a turned sensor": turned(accelerance()),
    "a wrong gain": accelerance() * np.array([1.0, 1.0, 1.2, 1.0]),
    "a wrong hammer": 1.1 * accelerance(),
    "late sensors": late(accelerance()),
}

# The explanations of the fit name these. One factor on all masses does the same as
# a wrong hammer, because all springs and dampers are free.
NAMED = {
    "exchanged sensors": ("sensors_exchanged", "u2,u3"),
    "a turned sensor": ("sensor_gain", "u2"),
    "a wrong gain": ("sensor_gain", "u3"),
    "a wrong hammer": ("excitation_scale", ""),
}


def write_case(folder, functions, seed):
    random = np.random.default_rng(seed)
    sigma = 0.01 * np.sqrt(np.mean(np.abs(functions) ** 2, axis=0)) / np.sqrt(2.0)
    measured = functions + sigma * (random.standard_normal(functions.shape) +
                                    1j * random.standard_normal(functions.shape))
    folder.mkdir()
    for i in range(4):
        rows = np.column_stack([LINES_HZ, measured[:, i].real, measured[:, i].imag])
        np.savetxt(folder / f"h{i + 1}.csv", rows, "%.9g", ",",
                   header="Frequency,Real,Imaginary", comments="")
    groups = [(f"k{i + 1}", "stiffness", one) for i, one in enumerate(SPRINGS)]
    groups += [("cm", "damping", 0.1 * np.eye(4)), ("ck", "damping", 1e-4 * sum(SPRINGS))]
    text = (f'[model]\ndofs = ["u1", "u2", "u3", "u4"]\nmass = {np.eye(4).tolist()}\n'
            f"damping = {(0.9 * DAMPING).tolist()}\nstiffness = {sum(SPRINGS).tolist()}\n")
    for name, adds_to, matrix in groups:
        text += (f'[[group]]\nname = "{name}"\nadds_to = "{adds_to}"\n'
                 f"matrix = {matrix.tolist()}\n")
    text += ('[[frf]]\nname = "hammer"\nfiles = ["h1.csv", "h2.csv", "h3.csv", "h4.csv"]\n'
             'responses = ["u1", "u2", "u3", "u4"]\nreferences = ["u1"]\n'
             'quantity = "acceleration"\n')
    (folder / "case.toml").write_text(text)
    return str(folder / "case.toml")


def main():
    programs = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)

        def run(program, name, functions, seed, *more):
            """Status, fit and judgement of one run."""
            case = write_case(scratch / name, functions, seed)
            output = scratch / (name + " out")
            done = subprocess.run(
                [programs / program, f"--case={case}", f"--output_dir={output}",
                 "--progress=false", *more], capture_output=True, text=True, check=False)
            assert done.returncode in (0, 1) and done.stderr == "", (name, done)
            damage = output / "damage.json"
            return (done.returncode, json.loads((output / "result.json").read_text()),
                    json.loads(damage.read_text()) if damage.exists() else None)

        status, baseline, _ = run("pinode_update", "baseline", accelerance(), 1)
        assert (status, baseline["verdict"]) == (0, "good"), baseline["message"]

        def compare(name, functions, seed):
            return run("pinode_damage", name, functions, seed,
                       f"--baseline={scratch / 'baseline out'}")

        status, _, damage = compare("the same", accelerance(), 7)
        assert (status, damage["verdict"]) == (0, "no_damage"), damage["message"]
        status, fit, damage = compare("a loss", LOST, 8)
        assert (status, damage["verdict"]) == (0, "damage"), damage["message"]
        assert damage["message"].startswith("Damage: k2 (-10"), damage["message"]
        value = next(p for p in fit["parameters"] if p["name"] == "k2")
        assert value["lower95"] < -0.1 < value["upper95"], value
        for seed, (name, functions) in enumerate(OTHERS.items()):
            _, fit, damage = compare(name, functions, 20 + seed)
            assert fit["verdict"] != "good", (name, fit["message"])
            assert damage["verdict"] == "cannot_tell", (name, damage["message"])
            _, fit, _ = run("pinode_update", name + " alone", functions, 20 + seed)
            if name in NAMED:
                causes = fit["explanations"]
                likely = [(cause["kind"], cause["place"]) for cause in causes
                          if cause["log_odds"] > causes[0]["log_odds"] - 3.0]
                assert NAMED[name] in likely, (name, causes)


main()
