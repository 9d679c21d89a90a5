#!/usr/bin/env python3
"""Lowest modes of a brick of linear hexahedra, one face held: pinode beside
SciPy's eigsh (shift-invert) in the same run, CPU times of one thread each.

    python3 tests/benchmarks/sparse_modes.py BUILD_DIR [--nodes=26] [--modes=20]

Needs NumPy and SciPy. Exits 1 if a mode's residual exceeds 1e-8, the memory
1.5 GiB, an eigenvalue differs by more than 1e-8, or pinode takes longer.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla


def element(size, poisson=0.3):
    """Stiffness and consistent mass of a cube, E = density = 1."""
    factor = 1.0 / ((1 + poisson) * (1 - 2 * poisson))
    law = np.zeros((6, 6))
    law[:3, :3] = factor * poisson
    law[range(3), range(3)] = factor * (1 - poisson)
    law[range(3, 6), range(3, 6)] = factor * (1 - 2 * poisson) / 2
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1)
                        for z in (-1, 1)])
    stiffness, mass = np.zeros((24, 24)), np.zeros((24, 24))
    for point in corners / np.sqrt(3.0):
        terms = 1 + corners * point
        shape = terms.prod(axis=1) / 8
        gradient = np.stack(
            [2 / size * corners[:, i] * terms[:, (i + 1) % 3]
             * terms[:, (i + 2) % 3] / 8 for i in range(3)])
        strain, motion = np.zeros((6, 24)), np.zeros((3, 24))
        for i in range(3):
            motion[i, i::3] = shape
            strain[i, i::3] = gradient[i]
            j, k = (i + 1) % 3, (i + 2) % 3
            strain[3 + i, j::3] = gradient[k]
            strain[3 + i, k::3] = gradient[j]
        stiffness += size**3 / 8 * strain.T @ law @ strain
        mass += size**3 / 8 * motion.T @ motion
    return (stiffness + stiffness.T) / 2, mass


def brick(nodes, size):
    """K and M of a solid of nodes[0] x nodes[1] x nodes[2] nodes and cubes of
    the given size; its face x = 0 is held."""
    stiffness, mass = element(size)
    number = np.arange(np.prod(nodes)).reshape(nodes)
    corners = [number[x:nodes[0] - 1 + x, y:nodes[1] - 1 + y,
                      z:nodes[2] - 1 + z].ravel()
               for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    dofs = (3 * np.stack(corners, axis=1)[:, :, None]
            + np.arange(3)).reshape(-1, 24)
    rows = np.repeat(dofs, 24, axis=1).ravel()
    columns = np.tile(dofs, (1, 24)).ravel()
    n = 3 * number.size
    held = 3 * number[0].size
    result = []
    for matrix in (stiffness, mass):
        values = np.tile(matrix.ravel(), len(dofs))
        whole = sp.csr_matrix((values, (rows, columns)), shape=(n, n))
        free = whole[held:, held:]
        # Sums over elements are rounded in different orders.
        result.append(sp.csr_matrix((free + free.T) / 2))
    return result


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--nodes", type=int, default=26)
    parser.add_argument("--modes", type=int, default=20)
    options = parser.parse_args()
    stiffness, mass = brick(3 * [options.nodes], 1.0 / (options.nodes - 1))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "brick.npz")
        parts = {}
        for name, matrix in (("K", stiffness), ("M", mass)):
            parts.update({name + "_data": matrix.data,
                          name + "_indices": matrix.indices,
                          name + "_indptr": matrix.indptr,
                          name + "_shape": matrix.shape})
        np.savez(path, **parts)
        program = os.path.join(options.build, "tests/benchmarks",
                               "pinode_sparse_modes")
        lines = subprocess.run([program, path, str(options.modes)], check=True,
                               capture_output=True, text=True).stdout.split("\n")
    measured = {}
    found = []
    for line in lines:
        name, _, value = line.partition(" ")
        if name == "eigenvalue":
            found.append(float(value))
        elif name:
            measured[name] = float(value)
    begin = time.process_time()
    exact = np.sort(sla.eigsh(stiffness.tocsc(), options.modes, mass.tocsc(),
                              sigma=0.0, which="LM")[0])
    seconds = time.process_time() - begin
    difference = np.max(np.abs(np.array(found) / exact - 1))
    print("%d DOFs, %d modes" % (measured["dofs"], options.modes))
    print("pinode  %8.1f s, residual %.1e, %.2f GiB"
          % (measured["seconds"], measured["residual"], measured["gibibytes"]))
    print("eigsh   %8.1f s; eigenvalues differ by %.1e"
          % (seconds, difference))
    good = (measured["residual"] < 1e-8 and measured["gibibytes"] < 1.5
            and difference < 1e-8 and measured["seconds"] <= seconds)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
