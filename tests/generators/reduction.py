#!/usr/bin/env python3
"""Reference values for pinode/structure/sparse/reduction_test.cc: a chain of 30
masses, reduced by hand with dense matrices. Prints them.

    python3 tests/generators/reduction.py
"""

import numpy as np
import scipy.linalg as la

N = 30
M = np.diag(np.linspace(1.0, 1.3, N))
K = np.zeros((N, N))
K[0, 0] = 1.0
for i in range(1, N):
    K[i - 1 : i + 1, i - 1 : i + 1] += [[1.0, -1.0], [-1.0, 1.0]]
KEPT = [9, 19, 29]
OTHERS = [i for i in range(N) if i not in KEPT]


def constraint(num_modes):
    basis = np.zeros((N, len(KEPT) + num_modes))
    basis[KEPT, range(len(KEPT))] = 1.0
    inside = np.ix_(OTHERS, OTHERS)
    basis[OTHERS, : len(KEPT)] = -la.solve(
        K[inside], K[np.ix_(OTHERS, KEPT)]
    )
    if num_modes:
        basis[OTHERS, len(KEPT) :] = la.eigh(K[inside], M[inside])[1][
            :, :num_modes
        ]
    return basis


def serep():
    shapes = la.eigh(K, M)[1][:, : len(KEPT)]
    return shapes @ la.inv(shapes[KEPT])


def frequencies(basis):
    values = la.eigh(basis.T @ K @ basis, basis.T @ M @ basis)[0]
    return np.sqrt(values) / (2 * np.pi)


def mac(a, b):
    return (a @ b) ** 2 / (a @ a) / (b @ b)


whole = la.eigh(K, M)
for name, basis in [
    ("Guyan", constraint(0)),
    ("Craig-Bampton, 2 modes", constraint(2)),
    ("SEREP", serep()),
]:
    values, shapes = la.eigh(basis.T @ K @ basis, basis.T @ M @ basis)
    exact = np.sqrt(whole[0][:3])
    print(name)
    print("  frequency errors", np.sqrt(values[:3]) / exact - 1)
    print(
        "  1 - MAC",
        [1 - mac(whole[1][:, i], basis @ shapes[:, i]) for i in range(3)],
    )
    print("  stiffness", (basis.T @ K @ basis)[:3, :3].ravel())
    print("  mass", (basis.T @ M @ basis)[:3, :3].ravel())
