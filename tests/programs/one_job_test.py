#!/usr/bin/env python3
"""The main job gives one outcome, whoever calls it.

    one_job_test.py BUILD_DIR [CASE...]

Runs twelve cases through the program pinode_update, the C++ program identify_case
and the Python package, and compares every field of result.json, but for seconds,
and all other files that the two programs both write, up to rounding: where arrays
lie in memory decides the order of some sums. Some cases are made here:
steps that are too long, a bound that is wrong, a fit that is interrupted early,
candidates, a profile. PYTHONPATH must lead to the package.
"""

import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import pinode

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT / "data"
# Rounding moves no field of a result by more, relative; the largest seen was 4e-9, of
# the cosine that the gradient has left.
ROUNDING = 1e-7


def every_second_sample(source: pathlib.Path, target: pathlib.Path) -> None:
    lines = source.read_text().splitlines()
    target.write_text("\n".join([lines[0]] + lines[1::2]) + "\n")


def shortened(path: pathlib.Path, samples: int) -> None:
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:1 + samples]) + "\n")


def changed(folder: pathlib.Path, name: str, case: str, *changes: tuple[str, str]) -> pathlib.Path:
    """A copy of the case's folder under `name`, with texts of the case replaced."""
    source = DATA / case
    target = folder / name
    shutil.copytree(source.parent, target)
    path = target / source.name
    text = path.read_text()
    for old, new in changes:
        assert old in text, f"{case} has no {old!r}"
        text = text.replace(old, new)
    path.write_text(text)
    return path


def cases(folder: pathlib.Path) -> dict[str, pathlib.Path]:
    storeys = "three_storey/three_storey.toml"
    coarse = changed(folder, "coarse", storeys,
                     ('"train.csv"', '"train2.csv"\nsubsteps = 1'))
    every_second_sample(coarse.parent / "train.csv", coarse.parent / "train2.csv")
    # A quarter of the record, and few iterations of a network: whoever calls the
    # main job, it goes the same way, and each case is fitted three times.
    noisy = changed(folder, "noisy", "three_storey/noisy_ground.toml")
    shortened(noisy.parent / "train.csv", 750)
    networks = changed(folder, "networks", "four_dof_free/scheme3.toml",
                       ("[units]", "[options]\nmax_iterations = 15\n\n[units]"))
    return {
        "three_storey": DATA / storeys,
        "noisy_ground": noisy,
        "coarse": coarse,
        "wrong_bound": changed(folder, "bound", storeys,
                               ('name    = "k1"\n', 'name    = "k1"\nupper   = 0.05\n')),
        "few_iterations": changed(folder, "few", storeys,
                                  ("[units]", "[options]\nmax_iterations = 2\n\n[units]")),
        "candidate": changed(folder, "candidate", storeys,
                             ('type    = "cubic"', 'type    = "cubic"\noptional = true')),
        "networks": networks,
        "groups": DATA / "four_dof_free/scheme2_groups.toml",
        "ambient": DATA / "three_storey_ambient/three_storey_ambient.toml",
        "force": DATA / "three_storey_force/impact_pulse.toml",
        "temperature": DATA / "three_storey_force/temperature.toml",
        "frame": DATA / "frame/healthy_1.toml",
    }


def differences(one: object, other: object, path: str = "") -> list[str]:
    """Paths at which two JSON values differ; seconds are left out."""
    if isinstance(one, dict) and isinstance(other, dict):
        found = []
        for key in sorted(one.keys() | other.keys()):
            if key.endswith("seconds"):
                continue
            found += differences(one.get(key), other.get(key), f"{path}/{key}")
        return found
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return [d for i, pair in enumerate(zip(one, other))
                for d in differences(*pair, f"{path}[{i}]")]
    same = one == other or (isinstance(one, float) and isinstance(other, float)
                            and (math.isnan(one) and math.isnan(other) or
                                 math.isclose(one, other, rel_tol=ROUNDING)))
    return [] if same else [f"{path}: {one!r} and {other!r}"]


def same_numbers(one: pathlib.Path, other: pathlib.Path) -> bool:
    """Whether two text files have the same words, and numbers up to rounding."""
    words, others = (re.split(r"[\s,]+", file.read_text()) for file in (one, other))
    if len(words) != len(others):
        return False
    # Entries of a matrix that are nothing but rounding beside its others.
    largest = max((abs(v) for w in words if math.isfinite(v := as_number(w))), default=0.0)
    return all(a == b or math.isclose(as_number(a), as_number(b), rel_tol=ROUNDING,
                                      abs_tol=1e-12 * largest)
               for a, b in zip(words, others))


def as_number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan


def check(name: str, path: pathlib.Path, build: pathlib.Path, folder: pathlib.Path) -> list[str]:
    program, cpp = folder / f"{name}_program", folder / f"{name}_cpp"
    update = subprocess.run(
        [build / "apps/pinode_update", f"--case={path}", f"--output_dir={program}",
         "--threads=1", "--progress=false"], capture_output=True, text=True)
    identify = subprocess.run([build / "tests/identify_case", path, cpp],
                              capture_output=True, text=True)
    if update.returncode not in (0, 1) or not (cpp / "result.json").exists():
        return [f"{name}: {update.stderr}{identify.stderr}"]
    fit = pinode.Case.read(str(path)).identify(threads=1)
    found = []
    if update.returncode != identify.returncode:
        found.append(f"exit status {update.returncode} and {identify.returncode}")
    if fit.usable != (update.returncode == 0):
        found.append(f"exit status {update.returncode}, in Python usable = {fit.usable}")
    ours = json.loads((program / "result.json").read_text())
    found += ["C++: " + d for d in differences(ours, json.loads((cpp / "result.json").read_text()))]
    found += ["Python: " + d for d in differences(ours, fit.json)]
    if fit.findings != [] and fit.findings[0]["what"] != ours["findings"][0]["what"]:
        found.append("Python has other findings")
    for file in sorted(cpp.iterdir()):
        if file.suffix in (".csv", ".mtx") and file.name != "history.csv":
            if not same_numbers(file, program / file.name):
                found.append(f"{file.name} differs")
    print(f"{name}: {ours['verdict']}, {len(found)} differences")
    return [f"{name}: {text}" for text in found]


def main() -> int:
    build = pathlib.Path(sys.argv[1]).resolve()
    wanted = sys.argv[2:]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        all_cases = cases(folder)
        found = []
        verdicts = 0
        for name, path in all_cases.items():
            if not wanted or name in wanted:
                verdicts += 1
                found += check(name, path, build, folder)
    for text in found:
        print(text)
    print(f"{verdicts} cases, {len(found)} differences")
    return 1 if found or verdicts == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
