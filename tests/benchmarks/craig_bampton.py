#!/usr/bin/env python3
"""Craig-Bampton reduction of a slender solid by pinode_check, files included,
beside the same reduction in SciPy in the same run: CPU times of one thread.

    python3 tests/benchmarks/craig_bampton.py BUILD_DIR [--nodes=400,9,6]
        [--modes=20]

Needs NumPy and SciPy. Exits 1 if a frequency of the whole or of the reduced
model differs from SciPy's by more than what pinode_check prints.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from sparse_modes import brick

CASE = """[model]
damping = {{ratios = [0.02]}}
[model.finite_element]
mass = "M.npz"
stiffness = "K.npz"
dofs = "names.txt"
[model.reduction]
method = "craig_bampton"
keep = [{keep}]
modes = {modes}
[[group]]
name = "spring"
adds_to = "stiffness"
between = ["ground", {first}]
[[mode]]
frequency = 1.0
frequency_sigma = 0.01
"""


def run_check(program, case):
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    text = subprocess.run([program, "--case=" + case], check=True,
                          capture_output=True, text=True).stdout
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = (end.ru_utime - begin.ru_utime) + (end.ru_stime - begin.ru_stime)
    return text, seconds


def tables(text):
    """Frequencies of the whole and of the reduced model, as printed."""
    whole, reduced = [], []
    target = None
    for line in text.split("\n"):
        words = line.split()
        if words[:3] == ["Mode", "full", "Hz"]:
            target = whole
        elif words[:2] == ["Mode", "Hz"]:
            target = reduced
        elif target is not None and words and words[0].isdigit():
            target.append(words[1])
        else:
            target = None
    return whole, reduced


def scipy_reduction(stiffness, mass, keep, modes, compared):
    others = np.setdiff1d(np.arange(stiffness.shape[0]), keep)
    inner = stiffness[others][:, others].tocsc()
    inner_mass = mass[others][:, others].tocsc()
    factor = sla.splu(inner, permc_spec="MMD_AT_PLUS_A",
                      options={"SymmetricMode": True}, diag_pivot_thresh=0.0)
    inverse = sla.LinearOperator(inner.shape, factor.solve, dtype=float)
    shapes = sla.eigsh(inner, modes, inner_mass, sigma=0.0, which="LM",
                       OPinv=inverse)[1]
    basis = np.zeros((stiffness.shape[0], len(keep) + modes))
    basis[keep, np.arange(len(keep))] = 1.0
    coupling = stiffness[others][:, keep].toarray()
    basis[others, :len(keep)] = -factor.solve(coupling)
    basis[others, len(keep):] = shapes
    whole = sla.eigsh(stiffness.tocsc(), compared, mass.tocsc(), sigma=0.0,
                      which="LM", return_eigenvectors=False)
    reduced = la.eigh(basis.T @ (stiffness @ basis),
                      basis.T @ (mass @ basis), eigvals_only=True)
    return [np.sqrt(np.sort(values)) / (2 * np.pi)
            for values in (whole, reduced)]


def misses(printed, exact):
    """How many printed numbers are not the exact ones in their digits."""
    count = 0
    for text, value in zip(printed, exact):
        digits = len(text.split("e")[0].replace(".", "").lstrip("0"))
        # Half a digit, and what rounding of K leaves of a slender body.
        step = 0.51 * 10.0 ** (np.floor(np.log10(value)) - digits + 1)
        if abs(float(text) - value) > step + 1e-5 * value:
            count += 1
            print("printed %s, SciPy %.6g" % (text, value))
    return count


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--nodes", default="400,9,6")
    parser.add_argument("--modes", type=int, default=20)
    options = parser.parse_args()
    nodes = [int(n) for n in options.nodes.split(",")]
    stiffness, mass = brick(nodes, 0.05)
    stiffness, mass = 2.1e11 * stiffness, 7850.0 * mass
    plane = 3 * nodes[1] * nodes[2]
    middle = 3 * ((nodes[1] // 2) * nodes[2] + nodes[2] // 2)
    keep = [(x - 1) * plane + middle + direction
            for x in (nodes[0] - 1, nodes[0] // 2, nodes[0] // 4)
            for direction in (1, 2)]
    names = ["%d.%d" % (i // 3 + 1, i % 3 + 1)
             for i in range(stiffness.shape[0])]
    with tempfile.TemporaryDirectory() as folder:
        sp.save_npz(os.path.join(folder, "K.npz"), stiffness, compressed=False)
        sp.save_npz(os.path.join(folder, "M.npz"), mass, compressed=False)
        with open(os.path.join(folder, "names.txt"), "w") as file:
            file.write("\n".join(names) + "\n")
        case = os.path.join(folder, "solid.toml")
        quoted = ['"%s"' % names[dof] for dof in keep]
        with open(case, "w") as file:
            file.write(CASE.format(keep=", ".join(quoted), first=quoted[0],
                                   modes=options.modes))
        text, seconds = run_check(
            os.path.join(options.build, "apps", "pinode_check"), case)
    printed = tables(text)
    begin = time.process_time()
    exact = scipy_reduction(stiffness, mass, keep, options.modes,
                            len(printed[0]))
    reference = time.process_time() - begin
    print("%d DOFs, %d coordinates" % (len(names), len(keep) + options.modes))
    print("pinode_check %6.1f s, files included" % seconds)
    print("SciPy        %6.1f s" % reference)
    wrong = sum(misses(p, e) for p, e in zip(printed, exact))
    complete = (len(printed[0]) > 0
                and len(printed[1]) == len(keep) + options.modes)
    return 0 if complete and wrong == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
